//! The public interface of the solver: building a world from a model, stepping it, and reading its state.

use parry3d_f64::math::{Pose, Vec3};

use crate::articulated::factor;
use crate::collision::Collision;
use crate::contact::Point;
use crate::forest::{Body, Forest, Freedom, NONE};
use crate::joint::{Command, JointForces, JointImpulse};
use crate::kinematics::{self, Node};
use crate::model::{Model, ModelError, Settings};
use crate::spatial::Spatial;
use crate::sweep::Rows;
use crate::touch::Touch;

/// The simulated system: bodies, joints, contacts and the present state.
pub struct World {
    pub(crate) forest: Forest,
    pub(crate) nodes: Vec<Node>,
    pub(crate) actors: Vec<JointForces>,
    pub(crate) collision: Collision,
    pub(crate) rows: Rows,
    pub(crate) touches: Vec<Touch>,
    pub(crate) given: Vec<Spatial>,
    pub(crate) stiff: Vec<f64>,
    pub(crate) wrenches: Vec<Spatial>,
    /// Force and torque that each mount with a spring carries since the first step, by body.
    pub(crate) carried: Vec<Option<(Vec3, Vec3)>>,
    /// Velocities and speeds before the step.
    pub(crate) before: Vec<(Spatial, f64)>,
    pub(crate) centres_link_m: Vec<Vec3>,
    pub(crate) earlier: Vec<Contact>,
    pub(crate) gravity_world_m_s2: Vec3,
    pub(crate) settings: Settings,
    /// Whether the velocities belong to the beginning of the next step, as the caller set them, and not to the middle of the
    /// previous step.
    pub(crate) fresh: bool,
    pub(crate) last_time_s: f64,
    pub(crate) sweeps_done: usize,
    pub(crate) frictionless_steps: usize,
    pub(crate) weight_n: f64,
}

/// Pose and velocity of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkState {
    /// Pose of the link's frame.
    pub world_from_link: Pose,
    /// Position of the link's centre of mass, m.
    pub centre_world_m: Vec3,
    /// Velocity of the link's centre of mass, m/s.
    pub velocity_world_m_s: Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity_world_rad_s: Vec3,
}

/// The other partner of a contact.
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
    /// The link towards which the normal points.
    pub link: usize,
    /// Mark of the link's shape.
    pub mark: u64,
    /// The other partner of the contact.
    pub partner: Partner,
    /// Mark of the partner's shape.
    pub partner_mark: u64,
    /// Contact point.
    pub point_world_m: Vec3,
    /// Normal, pointing from the partner to the link.
    pub normal_world: Vec3,
    /// Distance of the surfaces before the step, negative inside.
    pub distance_m: f64,
    /// Impulse on the link, N s; the impulse on the partner is the opposite.
    pub impulse_world_n_s: Vec3,
    /// Angular impulse against rolling and spinning on the link, N m s; that on the partner is the opposite.
    pub couple_world_n_m_s: Vec3,
}

impl World {
    /// Builds a world in its start state.
    ///
    /// # Errors
    ///
    /// An invalid model, e.g. one with a moving link without mass.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let forest = Forest::new(model)?;
        let mut nodes = kinematics::start(&forest);
        let many = nodes.len();
        let actors: Vec<JointForces> = forest.bodies.iter().map(JointForces::new).collect();
        let stiff: Vec<f64> = actors.iter().map(|actor| actor.armature).collect();
        if !factor(&forest, &mut nodes, &stiff, model.settings.timestep_s) {
            let message = "a joint or a root without inertia; give its link a mass and an inertia";
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
            carried: vec![None; many],
            centres_link_m: model.links.iter().map(|link| link.centre_link_m).collect(),
            earlier: Vec::new(),
            gravity_world_m_s2: model.gravity_world_m_s2,
            settings: model.settings,
            fresh: true,
            last_time_s: model.settings.timestep_s,
            sweeps_done: 0,
            frictionless_steps: 0,
            weight_n: model.gravity_world_m_s2.length()
                * model.links.iter().map(|link| link.mass_kg).sum::<f64>(),
            forest,
            nodes,
        })
    }

    pub(crate) fn contact(&self, point: &Point) -> Contact {
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
            couple_world_n_m_s: self.rows.couple_world(point),
        }
    }

    /// All contacts of the last step; if the step was divided, the contacts of each of its parts.
    pub fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        let last = self.rows.points.iter().map(|point| self.contact(point));
        self.earlier.iter().copied().chain(last)
    }

    /// Pose and velocity of a link: the pose after the last step, the velocity in its middle.
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

    /// Impulses along the joint above a link during the last step.
    pub fn joint_impulse(&self, link: usize) -> JointImpulse {
        let place = &self.forest.places[link];
        if place.leads {
            self.actors[place.body].done
        } else {
            JointImpulse::default()
        }
    }

    /// Sets the command of the motor of the joint above a link.
    pub fn command(&mut self, link: usize, command: Command) {
        if let Some(actor) = self.actor(link) {
            actor.command = command;
        }
    }

    /// Sets dry friction (N m or N) and viscous friction (N m s/rad or N s/m) of the joint above a link.
    pub fn set_friction(&mut self, link: usize, dry: f64, viscous: f64) {
        if let Some(actor) = self.actor(link) {
            (actor.dry, actor.viscous) = (dry, viscous);
        }
    }

    /// Sets the inertia of the rotor of the joint above a link, kg m² or kg.
    pub fn set_armature(&mut self, link: usize, armature: f64) {
        if let Some(actor) = self.actor(link) {
            actor.armature = armature;
        }
    }

    fn actor(&mut self, link: usize) -> Option<&mut JointForces> {
        let place = &self.forest.places[link];
        place.leads.then(|| &mut self.actors[place.body])
    }

    /// Applies a force at a point and a torque to a link during the next step, all in the world's frame.
    pub fn push(&mut self, link: usize, force_n: Vec3, point_world_m: Vec3, torque_nm: Vec3) {
        let body = self.forest.places[link].body;
        let arm_m = point_world_m - self.nodes[body].reference_world_m;
        self.wrenches[body] += Spatial::at(arm_m, force_n) + Spatial::new(torque_nm, Vec3::ZERO);
    }

    /// Sets pose and velocity of the root of a tree; the velocity is that of the link's centre of mass. The stored contact
    /// impulses are discarded. A mounted root has no velocity but that of [`World::lead_root`].
    ///
    /// `link` is the root or any link that is fixed to it.
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
            // Vector from the link's centre of mass to the centre of mass of the body that consists of all links fixed to it.
            let to_m = node.rotation * body.centre_body_m
                - node.rotation * (place.body_from_link * self.centres_link_m[link]);
            let velocity = velocity_world_m_s + angular_velocity_world_rad_s.cross(to_m);
            node.velocity = Spatial::new(angular_velocity_world_rad_s, velocity);
        }
        self.restart();
    }

    /// Has the mounted root of a tree move at this velocity, that of the link's origin, from the next step on. What hangs on the root
    /// feels the motion; nothing hinders it. The root of a free tree is not led.
    ///
    /// `link` is the root or any link that is fixed to it.
    pub fn lead_root(&mut self, link: usize, velocity_world_m_s: Vec3, turn_world_rad_s: Vec3) {
        let place = self.forest.places[link];
        let node = &mut self.nodes[place.body];
        if self.forest.bodies[place.body].freedom == Freedom::Mounted {
            // From the link's origin to that of the body that consists of all links fixed to it.
            let to_m = node.rotation * -place.body_from_link.translation;
            let velocity = velocity_world_m_s + turn_world_rad_s.cross(to_m);
            node.led = Spatial::new(turn_world_rad_s, velocity);
        }
    }

    /// As [`World::lead_root`], and the root moves at this velocity already, as everything that hangs on it does. Without this, the
    /// first step takes a root that is led from rest to its velocity. The stored contact impulses are discarded.
    pub fn start_led(&mut self, link: usize, velocity_world_m_s: Vec3, turn_world_rad_s: Vec3) {
        self.lead_root(link, velocity_world_m_s, turn_world_rad_s);
        let body = self.forest.places[link].body;
        if self.forest.bodies[body].freedom == Freedom::Mounted {
            self.nodes[body].velocity = self.nodes[body].led;
        }
        self.restart();
    }

    /// Sets position and speed of the joint above a link. The stored contact impulses are discarded.
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

    /// Sets pose and velocity of a fixture.
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

    /// Pose of a fixture.
    pub fn fixture(&self, fixture: usize) -> Pose {
        self.collision.fixtures[fixture].fixture.world_from_fixture
    }

    /// Kinetic energy of all links and rotors, J.
    pub fn kinetic_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes).zip(&self.actors);
        each.map(|((body, node), actor)| kinematics::kinetic_energy(body, node, actor.armature))
            .sum()
    }

    /// Potential energy in the gravitational field, J, 0 at the world's origin.
    pub fn potential_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes);
        let lifted = |body: &Body, node: &Node| {
            let (mass_kg, away_body_m) = body.compensated;
            (node.centre_world_m() + node.rotation * away_body_m) * mass_kg
        };
        each.map(|(body, node)| {
            let moment = node.centre_world_m() * body.mass_kg - lifted(body, node);
            -self.gravity_world_m_s2.dot(moment)
        })
        .sum()
    }

    /// Potential energy of the springs of joints and mounts, J; that of a mount is counted from where it carries the weight.
    pub fn spring_energy_j(&self) -> f64 {
        let each = self.forest.bodies.iter().zip(&self.nodes);
        each.map(|(body, node)| {
            let mount_j = body.mount.map_or(0.0, |mount| mount.energy_j(body, node));
            0.5 * body.stiffness * (node.position - body.rest).powi(2) + mount_j
        })
        .sum()
    }

    /// Change of velocity (linear velocity of the point, and angular velocity) of a link due to an impulse on the link at that
    /// point. All joints of the tree move freely, with the implicit stiffness of the servos of the last step: a column of J M⁻¹
    /// Jᵀ.
    pub fn response(&self, link: usize, impulse_n_s: Vec3, point_world_m: Vec3) -> (Vec3, Vec3) {
        let node = &self.nodes[self.forest.places[link].body];
        let arm_m = point_world_m - node.reference_world_m;
        let change = node.response.times(&Spatial::at(arm_m, impulse_n_s));
        (change.velocity_at(arm_m), change.angular())
    }

    /// Whether all positions and velocities are finite.
    pub fn is_finite(&self) -> bool {
        let fine = |node: &Node| node.origin_world_m.is_finite() && node.velocity.0[0].is_finite();
        self.nodes.iter().all(fine)
    }

    /// Number of solver sweeps since the world was built: a measure of the computing effort.
    pub fn sweeps_done(&self) -> usize {
        self.sweeps_done
    }

    /// Number of steps in which contacts were solved without friction, because with friction the solution would have created
    /// energy; 0 in normal operation.
    pub fn frictionless_steps(&self) -> usize {
        self.frictionless_steps
    }

    /// The settings of time step, solver and contacts.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
