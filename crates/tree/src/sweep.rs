//! Projected Gauss–Seidel over a tree in a time proportional to the number of bodies and contacts.
//!
//! A sweep walks around the tree (an Euler tour). The velocity of a body is exact while the walk is at that body: on the way up,
//! the impulses in a subtree are passed to the parent; on the way down, the change of the parent's velocity is passed to the
//! child. This is the articulated-body response (Featherstone 2008, section 7.3) in small steps, so that no row has to update the
//! whole chain.

use parry3d_f64::math::Vec3;

use crate::contact::{Group, Point, Side};
use crate::forest::{Forest, Move, NONE, Tree};
use crate::joint::{JointForces, speed_between};
use crate::kinematics::Node;
use crate::spatial::Spatial;
use crate::turning::{Couple, LEVER_M, ROUNDS, SETTLED_M_S};

/// All rows of a step.
#[derive(Default)]
pub(crate) struct Rows {
    pub points: Vec<Point>,
    /// The sides of the second bodies of contacts between two bodies.
    pub sides: Vec<Side>,
    /// Couples against rolling and spinning, of those contacts that have one.
    pub couples: Vec<Couple>,
    pub groups: Vec<Group>,
    /// For each body the first group of contacts whose last common ancestor is that body.
    pub first_group: Vec<usize>,
    /// First group of contacts between different trees.
    pub first_between: usize,
}

/// Passes the change of the parent's velocity to the child.
#[inline]
fn down(forest: &Forest, nodes: &mut [Node], index: usize) {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&above[forest.bodies[index].parent], &mut below[0]);
    let news = parent.velocity - node.known_parent_velocity;
    node.velocity += news;
    let follows = -node.u_over_d.dot(&news);
    node.velocity.add_scaled(&node.axis, follows);
    node.known_parent_velocity = parent.velocity;
}

/// Passes the pending impulses of the child's subtree to the parent.
#[inline]
fn up(forest: &Forest, nodes: &mut [Node], index: usize) {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&mut above[forest.bodies[index].parent], &mut below[0]);
    if node.pending != Spatial::ZERO {
        let mut passed = node.pending;
        passed.add_scaled(&node.u_over_d, -node.axis.dot(&node.pending));
        parent.pending += passed;
        parent.velocity += parent.response.times(&passed);
        node.pending = Spatial::ZERO;
    }
    node.known_parent_velocity = parent.velocity;
}

/// Solves the rows of the joint above a body, whose velocity and whose parent's velocity are up to date; returns the largest
/// change of speed.
#[inline]
fn joint(forest: &Forest, nodes: &mut [Node], actor: &mut JointForces, index: usize) -> f64 {
    let (above, below) = nodes.split_at_mut(index);
    let (parent, node) = (&mut above[forest.bodies[index].parent], &mut below[0]);
    let more = actor.solve(speed_between(node, &parent.velocity), node.give);
    if more == 0.0 {
        return 0.0;
    }
    parent.velocity.add_scaled(&node.recoil, -more);
    parent.pending.add_scaled(&node.u_over_d, -more);
    node.velocity.add_scaled(&node.recoil, -more);
    node.velocity.add_scaled(&node.axis, more * node.give);
    node.known_parent_velocity = parent.velocity;
    (more * node.give).abs() * LEVER_M
}

/// The response of bodies along the paths from both bodies of `ends` up to `meeting` to an impulse on each; stores it in `change`
/// of these bodies.
///
/// If the bodies belong to different trees, each path ends at its own root: then call the function for one body at a time, with
/// [`NONE`] as the other.
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
            impulse.add_scaled(&node.u_over_d, -left);
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
    let speed = node.speed_change * node.inverse_d - node.u_over_d.dot(&parent.change);
    node.change = parent.change;
    node.change.add_scaled(&node.axis, speed);
}

/// Updates the velocities of all bodies on the path from below `meeting` to `end`.
fn update_path(forest: &Forest, nodes: &mut [Node], meeting: usize, end: usize) {
    if end != meeting {
        update_path(forest, nodes, meeting, forest.bodies[end].parent);
        down(forest, nodes, end);
    }
}

/// Applies the changes that [`respond`] computed.
fn apply_changes(forest: &Forest, nodes: &mut [Node], meeting: usize, end: usize) {
    if end == meeting {
        return;
    }
    let parent = forest.bodies[end].parent;
    apply_changes(forest, nodes, meeting, parent);
    let change = nodes[end].change;
    let known_parent_velocity = nodes[parent].velocity;
    // The two paths share no body below their common ancestor, so no change is applied twice.
    nodes[end].velocity += change;
    nodes[end].known_parent_velocity = known_parent_velocity;
}

impl Rows {
    /// One sweep over a tree; returns the largest change of a velocity, m/s.
    pub fn sweep(
        &mut self,
        tree: &Tree,
        forest: &Forest,
        nodes: &mut [Node],
        actors: &mut [JointForces],
    ) -> f64 {
        let mut worst = self.solve_groups_of(tree.root, forest, nodes);
        for step in &forest.tour[tree.tour_start..tree.tour_end] {
            match *step {
                Move::Down(index) => {
                    down(forest, nodes, index);
                    if actors[index].has_rows() {
                        worst = worst.max(joint(forest, nodes, &mut actors[index], index));
                    }
                    worst = worst.max(self.solve_groups_of(index, forest, nodes));
                }
                Move::Up(index) => up(forest, nodes, index),
            }
        }
        worst
    }

    /// Solves the contacts whose last common ancestor is this body.
    fn solve_groups_of(&mut self, body: usize, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let mut worst = 0.0_f64;
        let mut next = self.first_group[body];
        while next != NONE {
            let group = self.groups[next];
            worst = worst.max(if group.b == NONE {
                self.solve_with_fixture(&group, nodes)
            } else {
                self.solve_between_bodies(&group, forest, nodes)
            });
            next = group.next;
        }
        worst
    }

    /// Solves the contacts between different trees.
    pub fn between(&mut self, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let mut worst = 0.0_f64;
        let mut next = self.first_between;
        while next != NONE {
            let group = self.groups[next];
            worst = worst.max(self.solve_between_bodies(&group, forest, nodes));
            next = group.next;
        }
        worst
    }

    /// Solves the contacts of one body with a fixture.
    #[inline]
    fn solve_with_fixture(&mut self, group: &Group, nodes: &mut [Node]) -> f64 {
        let node = &mut nodes[group.a];
        let mut worst = 0.0_f64;
        for point in &mut self.points[group.first..group.end] {
            for _ in 0..ROUNDS {
                let more = point.solve(&mut node.velocity, None);
                if more != [0.0; 3] {
                    worst = worst.max(point.speed_of(&more));
                    for (row, change) in point.a.jacobian.iter().zip(more) {
                        node.pending.add_scaled(row, change);
                    }
                }
                if point.couple == NONE {
                    break;
                }
                let couple = &mut self.couples[point.couple];
                let more = couple.solve(point.impulse[0], &mut node.velocity, None);
                for (row, change) in couple.a.jacobian.iter().zip(more) {
                    node.pending.add_scaled(row, change);
                }
                let speed_m_s = couple.speed_of(&more);
                worst = worst.max(speed_m_s);
                if speed_m_s < SETTLED_M_S {
                    break;
                }
            }
        }
        worst
    }

    /// Solves the contacts of two bodies.
    fn solve_between_bodies(&mut self, group: &Group, forest: &Forest, nodes: &mut [Node]) -> f64 {
        let tops = tops(group, forest);
        update_path(forest, nodes, tops[0], group.a);
        update_path(forest, nodes, tops[1], group.b);
        let (mut a, mut b) = (nodes[group.a].velocity, nodes[group.b].velocity);
        let mut impulses = [Spatial::ZERO; 2];
        let mut worst = 0.0_f64;
        for point in &mut self.points[group.first..group.end] {
            let side = &self.sides[point.b];
            for _ in 0..ROUNDS {
                let more = point.solve(&mut a, Some((side, &mut b)));
                worst = worst.max(point.speed_of(&more));
                for (k, change) in more.into_iter().enumerate() {
                    impulses[0].add_scaled(&point.a.jacobian[k], change);
                    impulses[1].add_scaled(&side.jacobian[k], change);
                }
                if point.couple == NONE {
                    break;
                }
                let couple = &mut self.couples[point.couple];
                let more = couple.solve(point.impulse[0], &mut a, Some(&mut b));
                for (k, change) in more.into_iter().enumerate() {
                    impulses[0].add_scaled(&couple.a.jacobian[k], change);
                    impulses[1].add_scaled(&couple.b.jacobian[k], change);
                }
                let speed_m_s = couple.speed_of(&more);
                worst = worst.max(speed_m_s);
                if speed_m_s < SETTLED_M_S {
                    break;
                }
            }
        }
        if worst > 0.0 {
            push(forest, nodes, group, tops, impulses);
        }
        worst
    }

    /// The angular impulse against rolling and spinning at a contact point on its first body, world frame, N m s.
    pub fn couple_world(&self, point: &Point) -> Vec3 {
        let couple = self.couples.get(point.couple);
        couple.map_or(Vec3::ZERO, Couple::impulse_world)
    }

    /// Sorts the groups into linked lists by the last common ancestor of their bodies.
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

/// The ends of the paths of both bodies of a group: their last common ancestor, or their roots.
pub(crate) fn tops(group: &Group, forest: &Forest) -> [usize; 2] {
    if group.meeting == NONE {
        [forest.bodies[group.a].root, forest.bodies[group.b].root]
    } else {
        [group.meeting; 2]
    }
}

/// Applies an impulse to each body of a group and updates all bodies on the way to the ends of the paths.
fn push(
    forest: &Forest,
    nodes: &mut [Node],
    group: &Group,
    tops: [usize; 2],
    impulses: [Spatial; 2],
) {
    let no_body = (NONE, Spatial::ZERO);
    let (one, two) = ((group.a, impulses[0]), (group.b, impulses[1]));
    if group.meeting != NONE {
        at_meeting(forest, nodes, tops[0], [one, two]);
    } else {
        at_meeting(forest, nodes, tops[0], [one, no_body]);
        at_meeting(forest, nodes, tops[1], [two, no_body]);
    }
}

fn at_meeting(forest: &Forest, nodes: &mut [Node], top: usize, ends: [(usize, Spatial); 2]) {
    let passed = respond(forest, nodes, top, ends);
    let change = nodes[top].change;
    nodes[top].velocity += change;
    nodes[top].pending += passed;
    for (end, _) in ends {
        if end != NONE {
            apply_changes(forest, nodes, top, end);
        }
    }
}

/// Before the first sweep: marks the velocities of all bodies as up to date.
pub(crate) fn begin_sweeps(forest: &Forest, nodes: &mut [Node]) {
    for (index, body) in forest.bodies.iter().enumerate() {
        nodes[index].pending = Spatial::ZERO;
        if !body.is_root() {
            nodes[index].known_parent_velocity = nodes[body.parent].velocity;
        }
    }
}

/// After the last sweep: updates the velocities of all bodies, and computes the speeds of the joints from them.
pub(crate) fn finish_sweeps(forest: &Forest, nodes: &mut [Node]) {
    for (index, body) in forest.bodies.iter().enumerate() {
        if body.is_root() {
            continue;
        }
        down(forest, nodes, index);
        let parent = nodes[body.parent].velocity;
        nodes[index].speed = speed_between(&nodes[index], &parent);
    }
}
