//! A world that steps: the one way in and out of the crate.

use parry3d_f64::math::{Pose, Vec3};

use crate::articulated::{factor, free_velocities, weight};
use crate::collision::{Collision, Touch};
use crate::contact::{Group, Point, Side, Softness, Step};
use crate::forest::{Forest, Freedom, NONE};
use crate::joint::{Actor, Command, JointImpulse, limit_reach};
use crate::kinematics::{self, Node};
use crate::model::{Model, ModelError, Settings};
use crate::spatial::Spatial;
use crate::sweep::{Rows, close, open, respond, tops};

/// Most times that a step is solved because a servo turned out to be at its limit.
const MOST_ATTEMPTS: usize = 4;
/// Most parts that one step is taken in.
const MOST_PARTS: usize = 64;

/// Bodies, what acts on them, and time.
pub struct World {
    forest: Forest,
    nodes: Vec<Node>,
    actors: Vec<Actor>,
    collision: Collision,
    rows: Rows,
    touches: Vec<Touch>,
    given: Vec<Spatial>,
    stiff: Vec<f64>,
    wrenches: Vec<Spatial>,
    /// Velocities and speeds before the step.
    before: Vec<(Spatial, f64)>,
    centres_link_m: Vec<Vec3>,
    earlier: Vec<Contact>,
    gravity_world_m_s2: Vec3,
    settings: Settings,
    /// Whether velocities belong to the beginning of the step to come, as given, and not to the middle of the one before.
    fresh: bool,
    last_time_s: f64,
    sweeps_done: usize,
}

/// Where a link is and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkState {
    /// Its frame.
    pub world_from_link: Pose,
    /// Its centre of mass, m.
    pub centre_world_m: Vec3,
    /// Velocity of its centre of mass, m/s.
    pub velocity_world_m_s: Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity_world_rad_s: Vec3,
}

/// Whom a link touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Partner {
    /// Another link.
    Link(usize),
    /// A fixture.
    Fixture(usize),
}

/// A contact during the last step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The link that the normal points to.
    pub link: usize,
    /// Mark of its shape.
    pub mark: u64,
    /// Whom it touches.
    pub partner: Partner,
    /// Mark of the partner's shape.
    pub partner_mark: u64,
    /// Where.
    pub point_world_m: Vec3,
    /// Away from the partner.
    pub normal_world: Vec3,
    /// Distance of the surfaces before the step, negative inside.
    pub distance_m: f64,
    /// Impulse on the link, N s; that on the partner is opposite.
    pub impulse_world_n_s: Vec3,
}

impl World {
    /// Builds a world in its start state.
    ///
    /// # Errors
    ///
    /// A model that has no meaning, e.g. a moving link without mass.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let forest = Forest::new(model)?;
        let mut nodes = kinematics::start(&forest);
        let many = nodes.len();
        let actors: Vec<Actor> = forest.bodies.iter().map(Actor::new).collect();
        let stiff: Vec<f64> = actors.iter().map(|actor| actor.armature).collect();
        if !factor(&forest, &mut nodes, &stiff) {
            let message =
                "a joint or a root without inertia; give its link a mass that has an extent";
            return Err(ModelError {
                message: message.into(),
            });
        }
        Ok(Self {
            collision: Collision::new(model, &forest),
            actors,
            rows: Rows::default(),
            touches: Vec::new(),
            given: vec![Spatial::ZERO; many],
            stiff,
            before: Vec::with_capacity(many),
            wrenches: vec![Spatial::ZERO; many],
            centres_link_m: model.links.iter().map(|link| link.centre_link_m).collect(),
            earlier: Vec::new(),
            gravity_world_m_s2: model.gravity_world_m_s2,
            settings: model.settings,
            fresh: true,
            last_time_s: model.settings.timestep_s,
            sweeps_done: 0,
            forest,
            nodes,
        })
    }

    /// One timestep; in parts where something would turn too far for one.
    pub fn step(&mut self) {
        self.earlier.clear();
        for actor in &mut self.actors {
            actor.done = JointImpulse::default();
        }
        let time_s = self.settings.timestep_s;
        let turn = kinematics::fastest_turn(&self.forest, &self.nodes) * time_s;
        let parts = ((turn / self.settings.max_turn_rad).ceil() as usize).clamp(1, MOST_PARTS);
        for part in 0..parts {
            self.part(time_s / parts as f64);
            if part + 1 < parts {
                let points = &self.rows.points;
                let contacts = points.iter().map(|point| self.contact(point));
                let mut earlier: Vec<Contact> = contacts.collect();
                self.earlier.append(&mut earlier);
            }
        }
        self.wrenches.fill(Spatial::ZERO);
    }

    fn part(&mut self, time_s: f64) {
        self.touches.clear();
        self.collision.find(&self.nodes, time_s, &mut self.touches);
        self.before.clear();
        let state = self.nodes.iter().map(|node| (node.velocity, node.speed));
        self.before.extend(state);
        let mut ratio = time_s / self.last_time_s;
        // A servo that turns out to be at its limit becomes a row, and the step is solved again: rare, as most stay what they are.
        for attempt in 0..MOST_ATTEMPTS {
            self.solve(time_s, ratio);
            let mut again = false;
            for (actor, node) in self.actors.iter_mut().zip(&self.nodes) {
                again |= actor.exceeds(node.speed);
            }
            if !again {
                break;
            }
            if attempt + 2 == MOST_ATTEMPTS {
                self.actors.iter_mut().for_each(Actor::unfold);
            }
            for (node, (velocity, speed)) in self.nodes.iter_mut().zip(&self.before) {
                (node.velocity, node.speed) = (*velocity, *speed);
            }
            ratio = 1.0;
        }
        for point in &self.rows.points {
            self.collision.remember(point.memory, point.impulse_world());
        }
        for (index, actor) in self.actors.iter_mut().enumerate() {
            let (body, node) = (&self.forest.bodies[index], &self.nodes[index]);
            if !body.is_root() {
                actor.finish(body, node.speed, time_s);
            }
        }
        kinematics::advance(&self.forest, &mut self.nodes, time_s);
        self.collision.lead(time_s);
        self.last_time_s = time_s;
        self.fresh = false;
    }

    /// Velocities at the end of a step, from those at its beginning.
    fn solve(&mut self, time_s: f64, ratio: f64) {
        let bodies = &self.forest.bodies;
        for (index, actor) in self.actors.iter_mut().enumerate() {
            self.stiff[index] = if bodies[index].is_root() {
                0.0
            } else {
                actor.prepare(&bodies[index], &self.nodes[index], time_s, ratio)
            };
        }
        factor(&self.forest, &mut self.nodes, &self.stiff);
        // What acts steadily over the first step has had half of it when velocities are those of its middle (leapfrog).
        let kick_s = if self.fresh { 0.5 * time_s } else { time_s };
        for (index, body) in bodies.iter().enumerate() {
            let node = &self.nodes[index];
            self.given[index] = weight(body, node, self.gravity_world_m_s2, kick_s);
            self.given[index].add_scaled(&self.wrenches[index], kick_s);
        }
        let step = Step {
            time_s,
            gravity_world_m_s2: self.gravity_world_m_s2,
            softness: Softness::new(&self.settings, time_s),
        };
        let impact = self.build_rows(&step, ratio);
        for (index, actor) in self.actors.iter_mut().enumerate() {
            let (body, node) = (&self.forest.bodies[index], &mut self.nodes[index]);
            if !body.is_root() {
                let reach = limit_reach(body, node, time_s);
                actor.approach(body, node, &step.softness, reach);
                node.effort = actor.effort(body, node, time_s);
            }
        }
        for tree in &self.forest.trees {
            free_velocities(tree, &self.forest, &mut self.nodes, kick_s, &self.given);
        }
        self.sweep(impact);
    }

    /// Contact rows, warm started: what they did in the step before is part of what acts now. True if something hits.
    fn build_rows(&mut self, step: &Step, ratio: f64) -> bool {
        let (forest, rows) = (&self.forest, &mut self.rows);
        rows.points.clear();
        rows.sides.clear();
        rows.groups.clear();
        let mut impact = false;
        for (index, touch) in self.touches.iter_mut().enumerate() {
            touch.impulse_world_n_s *= ratio;
            let (mut point, hits) = Point::new(touch, index, forest, &self.nodes, step);
            impact |= hits;
            let same =
                rows.groups.last().is_some_and(|group| {
                    group.a == touch.a && group.b == touch.b && touch.b != NONE
                }) || rows
                    .groups
                    .last()
                    .is_some_and(|group| group.b == NONE && touch.b == NONE && group.a == touch.a);
            if !same {
                rows.groups.push(Group {
                    a: touch.a,
                    b: touch.b,
                    meeting: touch.meeting,
                    first: index,
                    end: index,
                    next: NONE,
                });
            }
            let Some(group) = rows.groups.last_mut() else {
                continue;
            };
            group.end = index + 1;
            if touch.b == NONE {
                let response = &self.nodes[touch.a].response;
                point.a.gives = point.a.reads.map(|read| response.times(&read));
                point.weigh(None);
            } else {
                let mut side = Side {
                    reads: point.basis.map(|axis| -Spatial::at(point.arm_b, axis)),
                    ..Side::default()
                };
                give(&mut point, &mut side, group, forest, &mut self.nodes);
                point.weigh(Some(&mut side));
                point.b = rows.sides.len();
                for (read, impulse) in side.reads.iter().zip(point.impulse) {
                    self.given[touch.b].add_scaled(read, impulse);
                }
                rows.sides.push(side);
            }
            for (read, impulse) in point.a.reads.iter().zip(point.impulse) {
                self.given[touch.a].add_scaled(read, impulse);
            }
            rows.points.push(point);
        }
        rows.link(forest.bodies.len());
        impact
    }

    fn sweep(&mut self, impact: bool) {
        let (forest, rows) = (&self.forest, &mut self.rows);
        let no_rows = rows.points.is_empty() && !self.actors.iter().any(Actor::has_rows);
        let most = match (no_rows, impact) {
            (true, _) => 0,
            (false, true) => self.settings.impact_sweeps.max(self.settings.sweeps),
            (false, false) => self.settings.sweeps,
        };
        open(forest, &mut self.nodes);
        for _ in 0..most {
            let mut worst = 0.0_f64;
            for tree in &forest.trees {
                worst = worst.max(rows.sweep(tree, forest, &mut self.nodes, &mut self.actors));
            }
            worst = worst.max(rows.between(forest, &mut self.nodes));
            self.sweeps_done += 1;
            if worst < self.settings.tolerance_m_s {
                break;
            }
        }
        close(forest, &mut self.nodes);
    }

    fn contact(&self, point: &Point) -> Contact {
        let touch = &self.touches[point.touch];
        let (link, mark) = self.collision.owner(touch.shape_a);
        let (partner, partner_mark) = if touch.b == NONE {
            let fixture = &self.collision.fixtures[touch.shape_b].fixture;
            (Partner::Fixture(touch.shape_b), fixture.collider.mark)
        } else {
            let (link, mark) = self.collision.owner(touch.shape_b);
            (Partner::Link(link), mark)
        };
        Contact {
            link,
            mark,
            partner,
            partner_mark,
            point_world_m: touch.point_world_m,
            normal_world: touch.normal_world,
            distance_m: touch.distance_m,
            impulse_world_n_s: point.impulse_world(),
        }
    }

    /// All contacts of the last step; those of a step in parts once for each part.
    pub fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        let last = self.rows.points.iter().map(|point| self.contact(point));
        self.earlier.iter().copied().chain(last)
    }

    /// Where a link is and how it moves: poses after the last step, velocities in its middle.
    pub fn link(&self, link: usize) -> LinkState {
        let place = &self.forest.places[link];
        let node = &self.nodes[place.body];
        let world_from_link = node.world_from_body() * place.body_from_link;
        let centre_world_m = world_from_link * self.centres_link_m[link];
        let arm_m = centre_world_m - node.reference_world_m;
        LinkState {
            world_from_link,
            centre_world_m,
            velocity_world_m_s: node.velocity.velocity_at(arm_m),
            angular_velocity_world_rad_s: node.velocity.angular(),
        }
    }

    /// Position (rad or m) and speed of the joint above a link; zeros for roots and fixed joints.
    pub fn joint(&self, link: usize) -> (f64, f64) {
        let place = &self.forest.places[link];
        let node = &self.nodes[place.body];
        if place.leads && !self.forest.bodies[place.body].is_root() {
            (node.position, node.speed)
        } else {
            (0.0, 0.0)
        }
    }

    /// What acted along the joint above a link during the last step.
    pub fn joint_impulse(&self, link: usize) -> JointImpulse {
        let place = &self.forest.places[link];
        if place.leads {
            self.actors[place.body].done
        } else {
            JointImpulse::default()
        }
    }

    /// What the motor of the joint above a link does from now on.
    pub fn command(&mut self, link: usize, command: Command) {
        if let Some(actor) = self.actor(link) {
            actor.command = command;
        }
    }

    /// Dry friction (N m or N) and viscous friction (N m s/rad or N s/m) of the joint above a link from now on.
    pub fn set_friction(&mut self, link: usize, dry: f64, viscous: f64) {
        if let Some(actor) = self.actor(link) {
            (actor.dry, actor.viscous) = (dry, viscous);
        }
    }

    /// Inertia of the rotor of the joint above a link from now on, kg m² or kg.
    pub fn set_armature(&mut self, link: usize, armature: f64) {
        if let Some(actor) = self.actor(link) {
            actor.armature = armature;
        }
    }

    fn actor(&mut self, link: usize) -> Option<&mut Actor> {
        let place = &self.forest.places[link];
        place.leads.then(|| &mut self.actors[place.body])
    }

    /// Adds a force at a point and a torque on a link during the next step, all in the world's frame.
    pub fn push(&mut self, link: usize, force_n: Vec3, point_world_m: Vec3, torque_nm: Vec3) {
        let body = self.forest.places[link].body;
        let arm_m = point_world_m - self.nodes[body].reference_world_m;
        self.wrenches[body] += Spatial::at(arm_m, force_n) + Spatial::new(torque_nm, Vec3::ZERO);
    }

    /// Puts the root of a tree elsewhere; the velocity is that of its centre of mass. Contacts start anew.
    ///
    /// Any link that is fixed to the root will do.
    pub fn set_root(
        &mut self,
        link: usize,
        world_from_link: Pose,
        velocity_world_m_s: Vec3,
        angular_velocity_world_rad_s: Vec3,
    ) {
        let place = self.forest.places[link];
        let body = &self.forest.bodies[place.body];
        let node = &mut self.nodes[place.body];
        let world_from_body = world_from_link * place.body_from_link.inverse();
        node.rotation = world_from_body.rotation.normalize();
        node.origin_world_m = world_from_body.translation;
        if body.freedom == Freedom::Free {
            // From the centre of the link to that of all that is fixed to it.
            let to_m = node.rotation * body.centre_body_m
                - node.rotation * (place.body_from_link * self.centres_link_m[link]);
            let velocity = velocity_world_m_s + angular_velocity_world_rad_s.cross(to_m);
            node.velocity = Spatial::new(angular_velocity_world_rad_s, velocity);
        }
        self.restart();
    }

    /// Sets position and speed of the joint above a link. Contacts start anew.
    pub fn set_joint(&mut self, link: usize, position: f64, speed: f64) {
        let place = self.forest.places[link];
        if place.leads && !self.forest.bodies[place.body].is_root() {
            let node = &mut self.nodes[place.body];
            (node.position, node.speed) = (position, speed);
            self.restart();
        }
    }

    fn restart(&mut self) {
        kinematics::update(&self.forest, &mut self.nodes);
        self.collision.forget();
        for actor in &mut self.actors {
            actor.forget();
        }
        self.fresh = true;
    }

    /// Puts a fixture elsewhere and says how it moves from there.
    pub fn lead(
        &mut self,
        fixture: usize,
        world_from_fixture: Pose,
        velocity_world_m_s: Vec3,
        angular_velocity_world_rad_s: Vec3,
    ) {
        let placed = &mut self.collision.fixtures[fixture];
        placed.fixture.velocity_world_m_s = velocity_world_m_s;
        placed.fixture.angular_velocity_world_rad_s = angular_velocity_world_rad_s;
        placed.put(world_from_fixture);
    }

    /// Where a fixture is.
    pub fn fixture(&self, fixture: usize) -> Pose {
        self.collision.fixtures[fixture].fixture.world_from_fixture
    }

    /// Kinetic energy of all links and rotors, J.
    pub fn kinetic_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes).zip(&self.actors);
        each.map(|((body, node), actor)| kinematics::kinetic_energy(body, node, actor.armature))
            .sum()
    }

    /// Energy in gravity's field, J, 0 at the world's origin.
    pub fn potential_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes);
        each.map(|(body, node)| -body.mass_kg * self.gravity_world_m_s2.dot(node.centre_world_m()))
            .sum()
    }

    /// Energy in the springs of joints, J.
    pub fn spring_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes);
        each.map(|(body, node)| 0.5 * body.stiffness * (node.position - body.rest).powi(2))
            .sum()
    }

    /// Change of velocity (linear, of the point, and angular) of a link by an impulse on it there, the whole tree following and
    /// servos as stiff as in the last step: a column of J M⁻¹ Jᵀ.
    pub fn response(&self, link: usize, impulse_n_s: Vec3, point_world_m: Vec3) -> (Vec3, Vec3) {
        let node = &self.nodes[self.forest.places[link].body];
        let arm_m = point_world_m - node.reference_world_m;
        let change = node.response.times(&Spatial::at(arm_m, impulse_n_s));
        (change.velocity_at(arm_m), change.angular())
    }

    /// Whether all numbers are still numbers.
    pub fn is_finite(&self) -> bool {
        let fine = |node: &Node| node.origin_world_m.is_finite() && node.velocity.0[0].is_finite();
        self.nodes.iter().all(fine)
    }

    /// Sweeps since the beginning: what the solver had to do.
    pub fn sweeps_done(&self) -> usize {
        self.sweeps_done
    }

    /// How time passes and how contacts give.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}

/// What impulses of a contact between two bodies give to both.
fn give(point: &mut Point, side: &mut Side, group: &Group, forest: &Forest, nodes: &mut [Node]) {
    let tops = tops(group, forest);
    for k in 0..3 {
        if group.meeting == NONE {
            point.a.gives[k] = nodes[group.a].response.times(&point.a.reads[k]);
            side.gives[k] = nodes[group.b].response.times(&side.reads[k]);
        } else {
            let ends = [(group.a, point.a.reads[k]), (group.b, side.reads[k])];
            respond(forest, nodes, tops[0], ends);
            point.a.gives[k] = nodes[group.a].change;
            side.gives[k] = nodes[group.b].change;
        }
    }
}
