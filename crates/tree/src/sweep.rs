//! Projected Gauss–Seidel over a tree in a time proportional to the number of bodies and contacts.
//!
//! A sweep walks around the tree (an Euler tour). A body's velocity is exact while the walk is there: going up, the parent hears of
//! the impulses below; going down, the child hears of what its parent's velocity has changed by since. That is the articulated-body
//! response (Featherstone 2008, section 7.3) taken in small pieces, so no row ever needs the other end of a chain.

use crate::contact::{Group, Point, Side};
use crate::forest::{Forest, Move, NONE, Tree};
use crate::joint::{Actor, speed_between};
use crate::kinematics::Node;
use crate::spatial::Spatial;

/// All rows of a step.
#[derive(Default)]
pub(crate) struct Rows {
    pub points: Vec<Point>,
    /// Second sides of contacts between bodies.
    pub sides: Vec<Side>,
    pub groups: Vec<Group>,
    /// First group that meets at each body.
    pub first_group: Vec<usize>,
    /// First group between trees.
    pub first_between: usize,
}

/// A joint's row is in rad/s: the lever that makes it comparable with contacts, m.
const LEVER_M: f64 = 0.05;

/// The child hears of its parent's velocity.
#[inline]
fn down(forest: &Forest, nodes: &mut [Node], index: usize) {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&above[forest.bodies[index].parent], &mut below[0]);
    let news = parent.velocity - node.heard;
    node.velocity += news;
    let follows = -node.lean.dot(&news);
    node.velocity.add_scaled(&node.axis, follows);
    node.heard = parent.velocity;
}

/// The parent hears of impulses in the child's subtree.
#[inline]
fn up(forest: &Forest, nodes: &mut [Node], index: usize) {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&mut above[forest.bodies[index].parent], &mut below[0]);
    if node.pending != Spatial::ZERO {
        let mut passed = node.pending;
        passed.add_scaled(&node.lean, -node.axis.dot(&node.pending));
        parent.pending += passed;
        parent.velocity += parent.response.times(&passed);
        node.pending = Spatial::ZERO;
    }
    node.heard = parent.velocity;
}

/// Rows of the joint above a body of which both have heard; returns the largest change of speed.
#[inline]
fn joint(forest: &Forest, nodes: &mut [Node], actor: &mut Actor, index: usize) -> f64 {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&mut above[forest.bodies[index].parent], &mut below[0]);
    let more = actor.solve(speed_between(node, &parent.velocity), node.give);
    if more == 0.0 {
        return 0.0;
    }
    parent.velocity.add_scaled(&node.recoil, -more);
    parent.pending.add_scaled(&node.lean, -more);
    node.velocity.add_scaled(&node.recoil, -more);
    node.velocity.add_scaled(&node.axis, more * node.give);
    node.heard = parent.velocity;
    (more * node.give).abs() * LEVER_M
}

/// The response of bodies along the paths from `a` and `b` up to `meeting` to an impulse on each; fills `change` of these.
///
/// With different trees each path has its own root: then call it for one body at a time, `b` being [`NONE`].
pub(crate) fn respond(
    forest: &Forest,
    nodes: &mut [Node],
    meeting: usize,
    ends: [(usize, Spatial); 2],
) -> Spatial {
    let mut at_meeting = Spatial::ZERO;
    for (end, mut impulse) in ends {
        let mut index = end;
        while index != NONE && index != meeting {
            let node = &mut nodes[index];
            node.speed_change = node.axis.dot(&impulse);
            let left = node.speed_change;
            impulse.add_scaled(&node.lean, -left);
            index = forest.bodies[index].parent;
        }
        at_meeting += impulse;
    }
    nodes[meeting].change = nodes[meeting].response.times(&at_meeting);
    for (end, _) in ends {
        if end != NONE {
            descend(forest, nodes, meeting, end);
        }
    }
    at_meeting
}

/// Changes of velocity from below `meeting` to `end`.
fn descend(forest: &Forest, nodes: &mut [Node], meeting: usize, end: usize) {
    if end == meeting {
        return;
    }
    let parent = forest.bodies[end].parent;
    descend(forest, nodes, meeting, parent);
    let (above, below) = nodes.split_at_mut(end);
    let (parent, node) = (&above[parent], &mut below[0]);
    let speed = node.speed_change * node.inverse_d - node.lean.dot(&parent.change);
    node.change = parent.change;
    node.change.add_scaled(&node.axis, speed);
}

/// Lets all bodies from below `meeting` to `end` hear of it.
fn hear(forest: &Forest, nodes: &mut [Node], meeting: usize, end: usize) {
    if end != meeting {
        hear(forest, nodes, meeting, forest.bodies[end].parent);
        down(forest, nodes, end);
    }
}

/// Takes over the changes that [`respond`] found.
fn take(forest: &Forest, nodes: &mut [Node], meeting: usize, end: usize) {
    if end == meeting {
        return;
    }
    let parent = forest.bodies[end].parent;
    take(forest, nodes, meeting, parent);
    let change = nodes[end].change;
    let heard = nodes[parent].velocity;
    // Bodies that both paths share do not exist below their meeting.
    nodes[end].velocity += change;
    nodes[end].heard = heard;
}

impl Rows {
    /// One sweep over a tree; returns the largest change of a velocity, m/s.
    pub fn sweep(
        &mut self,
        tree: &Tree,
        forest: &Forest,
        nodes: &mut [Node],
        actors: &mut [Actor],
    ) -> f64 {
        let mut worst = self.meet(tree.root, forest, nodes);
        for step in &forest.tour[tree.tour_start..tree.tour_end] {
            match *step {
                Move::Down(index) => {
                    down(forest, nodes, index);
                    if actors[index].has_rows() {
                        worst = worst.max(joint(forest, nodes, &mut actors[index], index));
                    }
                    worst = worst.max(self.meet(index, forest, nodes));
                }
                Move::Up(index) => up(forest, nodes, index),
            }
        }
        worst
    }

    /// Contacts whose paths meet at a body.
    fn meet(&mut self, body: usize, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let mut worst = 0.0_f64;
        let mut next = self.first_group[body];
        while next != NONE {
            let group = self.groups[next];
            worst = worst.max(if group.b == NONE {
                self.alone(&group, nodes)
            } else {
                self.together(&group, forest, nodes)
            });
            next = group.next;
        }
        worst
    }

    /// Contacts between trees.
    pub fn between(&mut self, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let mut worst = 0.0_f64;
        let mut next = self.first_between;
        while next != NONE {
            let group = self.groups[next];
            worst = worst.max(self.together(&group, forest, nodes));
            next = group.next;
        }
        worst
    }

    /// Contacts of one body with a fixture.
    #[inline]
    fn alone(&mut self, group: &Group, nodes: &mut [Node]) -> f64 {
        let node = &mut nodes[group.a];
        let mut worst = 0.0_f64;
        for point in &mut self.points[group.first..group.end] {
            let more = point.solve(&mut node.velocity, None);
            if more != [0.0; 3] {
                worst = worst.max(point.speed_of(&more));
                for (read, change) in point.a.reads.iter().zip(more) {
                    node.pending.add_scaled(read, change);
                }
            }
        }
        worst
    }

    /// Contacts of two bodies.
    fn together(&mut self, group: &Group, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let tops = tops(group, forest);
        hear(forest, nodes, tops[0], group.a);
        hear(forest, nodes, tops[1], group.b);
        let (mut a, mut b) = (nodes[group.a].velocity, nodes[group.b].velocity);
        let mut impulses = [Spatial::ZERO; 2];
        let mut worst = 0.0_f64;
        for point in &mut self.points[group.first..group.end] {
            let side = &self.sides[point.b];
            let more = point.solve(&mut a, Some((side, &mut b)));
            worst = worst.max(point.speed_of(&more));
            for (k, change) in more.into_iter().enumerate() {
                impulses[0].add_scaled(&point.a.reads[k], change);
                impulses[1].add_scaled(&side.reads[k], change);
            }
        }
        if worst > 0.0 {
            push(forest, nodes, group, tops, impulses);
        }
        worst
    }

    /// Links the groups to the bodies where their paths meet.
    pub fn link(&mut self, bodies: usize) {
        self.first_group.clear();
        self.first_group.resize(bodies, NONE);
        self.first_between = NONE;
        for index in (0..self.groups.len()).rev() {
            let meeting = self.groups[index].meeting;
            let head = if meeting == NONE {
                &mut self.first_between
            } else {
                &mut self.first_group[meeting]
            };
            self.groups[index].next = *head;
            *head = index;
        }
    }
}

/// Where the paths of both bodies of a group end: where they meet, or at their roots.
pub(crate) fn tops(group: &Group, forest: &Forest) -> [usize; 2] {
    if group.meeting == NONE {
        [forest.bodies[group.a].root, forest.bodies[group.b].root]
    } else {
        [group.meeting; 2]
    }
}

/// Gives an impulse to each body of a group and lets all on the way know.
fn push(
    forest: &Forest,
    nodes: &mut [Node],
    group: &Group,
    tops: [usize; 2],
    impulses: [Spatial; 2],
) {
    let nobody = (NONE, Spatial::ZERO);
    let (one, two) = ((group.a, impulses[0]), (group.b, impulses[1]));
    if group.meeting != NONE {
        at_meeting(forest, nodes, tops[0], [one, two]);
    } else {
        at_meeting(forest, nodes, tops[0], [one, nobody]);
        at_meeting(forest, nodes, tops[1], [two, nobody]);
    }
}

fn at_meeting(forest: &Forest, nodes: &mut [Node], top: usize, ends: [(usize, Spatial); 2]) {
    let passed = respond(forest, nodes, top, ends);
    let change = nodes[top].change;
    nodes[top].velocity += change;
    nodes[top].pending += passed;
    for (end, _) in ends {
        if end != NONE {
            take(forest, nodes, top, end);
        }
    }
}

/// Before the first sweep: all have heard of all.
pub(crate) fn open(forest: &Forest, nodes: &mut [Node]) {
    for (index, body) in forest.bodies.iter().enumerate() {
        nodes[index].pending = Spatial::ZERO;
        if !body.is_root() {
            nodes[index].heard = nodes[body.parent].velocity;
        }
    }
}

/// After the last sweep: all hear of all, and joints have the speeds that came of it.
pub(crate) fn close(forest: &Forest, nodes: &mut [Node]) {
    for (index, body) in forest.bodies.iter().enumerate() {
        if body.is_root() {
            continue;
        }
        down(forest, nodes, index);
        let parent = nodes[body.parent].velocity;
        nodes[index].speed = speed_between(&nodes[index], &parent);
    }
}
