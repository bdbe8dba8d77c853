//! The model of a world: links, joints, shapes, fixtures and solver settings, in SI units and in the frames that the caller
//! defines.

use std::fmt;
use std::sync::Arc;

use parry3d_f64::math::{Mat3, Pose, Vec3};
use parry3d_f64::shape::SharedShape;

use crate::mount::MountSpring;
use crate::turning::TurningFriction;
use crate::tyre::Tyre;

/// Everything that a [`World`](crate::World) is built from.
#[derive(Clone, Default)]
pub struct Model {
    /// Gravitational acceleration, world frame, m/s².
    pub gravity_world_m_s2: Vec3,
    /// Links of all robots and free bodies; a parent precedes its children.
    pub links: Vec<Link>,
    /// Shapes that are at rest or move at a prescribed velocity.
    pub fixtures: Vec<Fixture>,
    /// Pairs of marks between whose shapes no contacts are computed. Links that a joint connects are always excluded.
    pub collision_exclude: Vec<(u64, u64)>,
    /// Settings of time step, solver and contacts.
    pub settings: Settings,
}

/// A rigid body.
#[derive(Clone)]
pub struct Link {
    /// How the link is attached.
    pub attachment: Attachment,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame.
    pub centre_link_m: Vec3,
    /// Inertia about the centre of mass, along the link's axes, kg m².
    pub inertia_link_kg_m2: Mat3,
    /// Mass whose weight a force upwards compensates, kg, and the place in the link's frame where that force acts.
    pub compensated: (f64, Vec3),
    /// Collision shapes.
    pub colliders: Vec<Collider>,
}

/// How a link is attached.
#[derive(Debug, Clone, PartialEq)]
pub enum Attachment {
    /// Not attached: the root of a tree that moves freely, starting at this pose.
    Free {
        /// Pose at the start.
        world_from_link: Pose,
    },
    /// Fixed to the world, or led by the caller: the root of a mounted tree.
    Mounted {
        /// Pose at the start, and for ever unless [`World::lead_root`](crate::World::lead_root) is called.
        world_from_link: Pose,
    },
    /// The root of a tree on a spring, which exerts no force but the weight at this pose.
    Sprung {
        /// Pose at the start, at which the tree is at rest.
        world_from_link: Pose,
        /// The spring.
        spring: MountSpring,
    },
    /// Connected to another link by a joint.
    Joint(Joint),
}

/// A joint between a link and its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Index of the parent, smaller than the link's own.
    pub parent: usize,
    /// Which motions it allows.
    pub kind: JointType,
    /// The joint's frame, in the parent's.
    pub parent_from_joint: Pose,
    /// The joint's frame, in the link's frame. At position 0 both joint frames coincide.
    pub link_from_joint: Pose,
    /// Axis of turning or sliding, in the joint's frame.
    pub axis_joint: Vec3,
    /// Smallest and largest position, rad or m; a continuous joint has no limits.
    pub limits: Option<(f64, f64)>,
    /// Position at the start, rad or m.
    pub start: f64,
    /// Torque against the motion per speed, N m s/rad or N s/m.
    pub viscous_friction: f64,
    /// Largest torque or force of dry (Coulomb) friction, N m or N.
    pub dry_friction: f64,
    /// Inertia of a rotor at the output, kg m² or kg.
    pub armature: f64,
    /// Stiffness of a spring towards [`Self::rest`], N m/rad or N/m.
    pub stiffness: f64,
    /// Position at which the spring exerts no force, rad or m.
    pub rest: f64,
}

impl Joint {
    /// A joint without friction, spring, limits and rotor.
    pub fn new(parent: usize, kind: JointType, axis_joint: Vec3) -> Self {
        Self {
            parent,
            kind,
            parent_from_joint: Pose::identity(),
            link_from_joint: Pose::identity(),
            axis_joint,
            limits: None,
            start: 0.0,
            viscous_friction: 0.0,
            dry_friction: 0.0,
            armature: 0.0,
            stiffness: 0.0,
            rest: 0.0,
        }
    }
}

/// Which motions a joint allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointType {
    /// No motion: both links are one body.
    Fixed,
    /// Rotation about the axis, with optional limits.
    Revolute,
    /// Rotation about the axis without limits.
    Continuous,
    /// Translation along the axis.
    Prismatic,
}

/// A collision shape with its surface properties.
#[derive(Clone)]
pub struct Collider {
    /// The shape.
    pub shape: SharedShape,
    /// The shape's frame in its owner's (link or fixture).
    pub owner_from_shape: Pose,
    /// Friction coefficient; that of a pair is the product of both.
    pub friction: f64,
    /// Friction coefficient of any pair with this shape, in place of the product.
    pub pair_friction: Option<f64>,
    /// Factor on the friction of a [`Spot`] of a fixture.
    pub spot_factor: f64,
    /// Restitution coefficient; that of a pair is the product of both.
    pub restitution: f64,
    /// Friction against rolling and spinning; those of a pair are the sums of both.
    pub turning: TurningFriction,
    /// The law of a tyre, if the shape is one: its friction against fixtures grows with the slip. Friction against other links
    /// is Coulomb's.
    pub tyre: Option<Tyre>,
    /// No contacts are computed between shapes of the same group; 0 stands for no group.
    pub group: u32,
    /// A number that the caller chooses; it is returned in every [`Contact`](crate::Contact) of the shape.
    pub mark: u64,
}

impl Collider {
    /// A shape at its owner's origin with this friction, without restitution.
    pub fn new(shape: SharedShape, friction: f64) -> Self {
        Self {
            shape,
            owner_from_shape: Pose::identity(),
            friction,
            pair_friction: None,
            spot_factor: 1.0,
            restitution: 0.0,
            turning: TurningFriction::default(),
            tyre: None,
            group: 0,
            mark: 0,
        }
    }
}

/// What a fixture is like at a point of its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spot {
    /// As its collider says.
    Plain,
    /// Friction and restitution of its own, those of a pair with a shape whose [`Collider::spot_factor`] is 1. Without a
    /// restitution, the collider's holds.
    Own {
        /// Friction coefficient.
        friction: f64,
        /// Restitution coefficient.
        restitution: Option<f64>,
    },
    /// There is nothing at this point.
    Hole,
}

/// What a fixture is like at a contact point, world frame.
pub type SpotMap = Arc<dyn Fn(Vec3) -> Spot + Send + Sync>;

/// A shape that contacts do not move: floor, wall, or an object on a prescribed path.
#[derive(Clone)]
pub struct Fixture {
    /// Shape and surface.
    pub collider: Collider,
    /// Pose at the start.
    pub world_from_fixture: Pose,
    /// Velocity of its origin, world frame, m/s; the fixture moves with this velocity until the caller sets another pose.
    pub velocity_world_m_s: Vec3,
    /// Angular velocity, world frame, rad/s.
    pub angular_velocity_world_rad_s: Vec3,
    /// How the surface differs from place to place, if it does.
    pub spots: Option<SpotMap>,
}

impl Fixture {
    /// A shape at rest.
    pub fn at_rest(collider: Collider, world_from_fixture: Pose) -> Self {
        Self {
            collider,
            world_from_fixture,
            velocity_world_m_s: Vec3::ZERO,
            angular_velocity_world_rad_s: Vec3::ZERO,
            spots: None,
        }
    }
}

/// Coupling of friction and normal force: the friction cone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cone {
    /// Coulomb's cone: sliding surfaces stay in contact.
    Exact,
    /// Relaxed to a convex problem (Anitescu 2006), as MuJoCo's is (Todorov 2014): sliding surfaces are separated at a speed of
    /// the friction coefficient times the slip, so that a sliding body hops, and friction reduces the slip as slowly as the
    /// spring and damper act. Contacts act only when surfaces overlap, and there is no restitution.
    Relaxed,
}

/// Settings of time step, solver and contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, s.
    pub timestep_s: f64,
    /// Largest number of sweeps over all rows in a step.
    pub sweeps: usize,
    /// Largest number of sweeps in a step with an impact.
    pub impact_sweeps: usize,
    /// A sweep that changes no velocity by more than this times the step is the last, m/s².
    pub tolerance_m_s2: f64,
    /// Natural frequency ω / 2 π of contacts, Hz: a contact is a spring of stiffness m ω² and a damper of 2 ζ m ω, where m is the
    /// effective mass at the contact.
    pub contact_frequency_hz: f64,
    /// Damping ratio ζ of contacts.
    pub contact_damping_ratio: f64,
    /// Friction cone.
    pub cone: Cone,
    /// Largest speed at which contacts reduce penetration, m/s; not used with a relaxed cone.
    pub most_recovery_m_s: f64,
    /// Contacts are computed for surfaces that are closer than this, m; for fast bodies at larger distances, too.
    pub prediction_m: f64,
    /// A step in which a link would turn by more than this is divided into parts, rad.
    pub max_turn_rad: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            timestep_s: 1.0 / 480.0,
            sweeps: 4,
            impact_sweeps: 50,
            tolerance_m_s2: 1e-4,
            contact_frequency_hz: 300.0,
            contact_damping_ratio: 3.0,
            cone: Cone::Exact,
            most_recovery_m_s: 3.0,
            prediction_m: 0.002,
            max_turn_rad: 0.25,
        }
    }
}

impl Collider {
    /// Friction coefficient of a pair.
    pub(crate) fn friction_with(&self, other: &Self) -> f64 {
        let stated = self.pair_friction.or(other.pair_friction);
        stated.unwrap_or(self.friction * other.friction)
    }
}

/// The error of an invalid model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelError {
    /// The place in the model, the value found, and the allowed values.
    pub message: String,
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for ModelError {}

impl Model {
    /// Checks the conditions that the solver relies on.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let fail = |message: String| Err(ModelError { message });
        for (index, link) in self.links.iter().enumerate() {
            if !(link.mass_kg >= 0.0 && link.mass_kg.is_finite()) {
                return fail(format!(
                    "link {index}: mass {} kg; it has to be finite and not negative",
                    link.mass_kg
                ));
            }
            if let Attachment::Sprung { spring, .. } = &link.attachment
                && !spring.is_sound()
            {
                return fail(format!(
                    "link {index}: stiffness and damping of its mount have to be finite and not negative"
                ));
            }
            let mut tyres = link.colliders.iter().filter_map(|collider| collider.tyre);
            if let Some(tyre) = tyres.find(|tyre| !tyre.is_sound()) {
                return fail(format!(
                    "link {index}: slip stiffness {} and shape {} of its tyre; the stiffness has to be positive and finite, the shape from 1 to 2",
                    tyre.slip_stiffness_1_rad, tyre.shape
                ));
            }
            let Attachment::Joint(joint) = &link.attachment else {
                continue;
            };
            if joint.parent >= index {
                return fail(format!(
                    "link {index}: its parent is {}; a parent has to stand before its children",
                    joint.parent
                ));
            }
            if joint.kind != JointType::Fixed && (joint.axis_joint.length() - 1.0).abs() > 1e-6 {
                return fail(format!(
                    "link {index}: its axis has length {}; it has to be 1",
                    joint.axis_joint.length()
                ));
            }
            if joint.limits.is_some_and(|(low, high)| low > high) {
                return fail(format!(
                    "link {index}: the lower limit is above the upper limit"
                ));
            }
            let least = [
                joint.viscous_friction,
                joint.dry_friction,
                joint.armature,
                joint.stiffness,
            ];
            if !least.iter().all(|value| *value >= 0.0) {
                return fail(format!(
                    "link {index}: friction, armature and stiffness must not be negative"
                ));
            }
        }
        let on_links = self.links.iter().flat_map(|link| &link.colliders);
        let on_fixtures = self.fixtures.iter().map(|fixture| &fixture.collider);
        let mut turning = on_links.chain(on_fixtures).map(|collider| collider.turning);
        if let Some(wrong) = turning.clone().find(|turning| !turning.is_sound()) {
            return fail(format!(
                "rolling friction {} m and torsional friction {} m of a shape; both have to be finite and not negative",
                wrong.rolling_m, wrong.torsional_m
            ));
        }
        if self.settings.cone == Cone::Relaxed && turning.any(|turning| !turning.is_none()) {
            return fail(
                "rolling and torsional friction need the exact friction cone, not the relaxed one"
                    .into(),
            );
        }
        let tyred = |collider: &Collider| collider.tyre.is_some();
        if self.fixtures.iter().any(|fixture| tyred(&fixture.collider)) {
            return fail("a fixture cannot be a tyre; give the tyre to a link".into());
        }
        let mut colliders = self.links.iter().flat_map(|link| &link.colliders);
        if self.settings.cone == Cone::Relaxed && colliders.any(tyred) {
            return fail("a tyre needs the exact friction cone, not the relaxed one".into());
        }
        let s = &self.settings;
        let positive = [s.timestep_s, s.contact_frequency_hz, s.max_turn_rad];
        if !positive.iter().all(|value| *value > 0.0) || s.sweeps == 0 {
            return fail(
                "settings: timestep, contact frequency, turn and sweeps have to be positive".into(),
            );
        }
        Ok(())
    }
}
