//! Robots of bodies of any shape: the types of a file that states bodies, joints, actuators and named frames (marks).
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::morphology::Morphology;
//!
//! let text = r#"(
//!     name: "cart",
//!     bodies: [
//!         (name: "chassis", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.2, 0.1, 0.04)))]),
//!         (name: "left", mass_kg: 0.1, shapes: [(form: Cylinder(radius_m: 0.04, length_m: 0.02), pose: (rpy_rad: (1.5707963, 0, 0)))]),
//!     ],
//!     joints: [(name: "axle", parent: "chassis", child: "left", pose: (at_m: (0, 0.06, 0)), kind: Turn(axis: (0, 1, 0)))],
//!     actuators: [(joint: "axle", servo: (law: Velocity(gain_1_s: 20), max_torque_nm: 0.5))],
//!     marks: [(name: "nose", body: "chassis", pose: (at_m: (0.1, 0, 0)))],
//! )"#;
//! let robot = Morphology::parse(&Source::new("cart.ron", text))?.assemble();
//! assert_eq!((robot.parts.len(), robot.hinges.len(), robot.marks.len()), (2, 1, 1));
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! | field | meaning |
//! |---|---|
//! | `bodies` | name, mass, centre of mass, inertia tensor (of uniform shapes when left out), any number of posed shapes |
//! | `joints` | connections of two bodies, which form a tree: the pose of the child's frame in the parent's frame at coordinate 0, and `Fixed`, `Turn` or `Slide` |
//! | `actuators` | the actuator of a joint: a servo, and either its gait or another joint whose command it copies |
//! | `marks` | named frames; `track` names a frame or a body |
//! | `never_touch` | pairs of bodies between which no contacts are computed; bodies connected by a joint are excluded always |
//! | `mount` | pose at which the frame of the root is fixed in the world; without it the robot moves freely |
//! | `world` | gravity, floor, boxes beside the robot and the longest timestep, with which an experiment begins |
//!
//! Bodies that are fixed to each other become one rigid part. A body without mass may connect two joints.

mod assemble;
mod check;
mod motion;
mod piece;
mod surroundings;
mod tree;

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::absent::is_zero;
use super::assembly::{Assembly, Gait, Servo, Solid};
use super::command_scale::CommandScale;
use super::module::Module;
use super::turning::TurningFriction;
use super::tyre::Tyre;
use realgap_core::file::Source;

pub(crate) use assemble::MAX_BODIES;
pub use realgap_solid::{
    MAX_CORNERS, UniformMass, convex_hull, simplified, solid_surface, uniform,
};
pub use surroundings::{Beside, BesideBox, Surroundings};

/// Three numbers along x, y and z.
pub type Triple = (f64, f64, f64);

/// A robot of bodies, as its file states it.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "robot")]
pub struct Structure {
    /// Name of the robot: letters, digits, `_` and `-`.
    pub name: String,
    /// Free text that describes the robot.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The joints that connect the bodies; they form a tree.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<Joint>,
    /// The actuators of the joints.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actuators: Vec<Driver>,
    /// Named frames.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Frame>,
    /// Pairs of bodies between which no contacts are computed.
    #[serde(
        rename = "never_touch",
        alias = "collision_exclude",
        default,
        skip_serializing_if = "Vec::is_empty"
    )]
    pub collision_exclude: Vec<(String, String)>,
    /// Pose at which the root body is fixed in the world; without it the robot moves freely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mount: Option<Pose>,
    /// The body or mark whose motion is recorded; the root by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub track: Option<String>,
    /// The world around the robot, with which an experiment begins.
    #[serde(default, skip_serializing_if = "Surroundings::is_none")]
    pub world: Surroundings,
}

/// A rigid body.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "body")]
pub struct Body {
    /// Unique name: letters, digits, `_` and `-`.
    pub name: String,
    /// Mass, kg; 0 for a link between two joints.
    #[serde(default)]
    pub mass_kg: f64,
    /// Centre of mass in the body's frame, metres; by default that of uniform shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_of_mass_m: Option<Triple>,
    /// Inertia about the centre of mass, along the body's axes; by default that of uniform shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<Tensor>,
    /// Share of the body's weight that a force upwards at its centre of mass compensates: 0 for none, 1 for a body that floats.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub gravity_compensation: f64,
    /// The collision shapes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shapes: Vec<Piece>,
}

/// An inertia tensor, kg m2.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "inertia")]
pub struct Tensor {
    /// Moment about x.
    pub xx: f64,
    /// Moment about y.
    pub yy: f64,
    /// Moment about z.
    pub zz: f64,
    /// Element of the tensor in row x and column y: minus the integral of x y dm.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub xy: f64,
    /// Element in row x and column z.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub xz: f64,
    /// Element in row y and column z.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub yz: f64,
}

/// A shape of a body.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "shape")]
pub struct Piece {
    /// The geometric form.
    pub form: Form,
    /// Pose in the body's frame.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
    /// The shape is a tyre, whose friction against what does not move grows with the slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tyre: Option<Tyre>,
    /// Friction against rolling and spinning, in addition to that of what the shape touches.
    #[serde(default, skip_serializing_if = "TurningFriction::is_none")]
    pub turning: TurningFriction,
}

/// Geometric forms, centred at the origin of their own frame.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "form")]
pub enum Form {
    /// A box.
    Box {
        /// Edges along x, y and z, metres.
        sides_m: Triple,
    },
    /// A ball.
    Sphere {
        /// Radius, metres.
        radius_m: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, metres.
        radius_m: f64,
        /// Length, metres.
        length_m: f64,
    },
    /// A cylinder along z with half a ball on either end.
    Capsule {
        /// Radius, metres.
        radius_m: f64,
        /// Length between the centres of the balls, metres.
        length_m: f64,
    },
    /// An ellipsoid, approximated by the convex hull of points on its surface.
    Ellipsoid {
        /// Half axes along x, y and z, metres.
        radii_m: Triple,
    },
    /// The convex hull of points.
    Hull {
        /// The points, metres.
        points_m: Vec<Triple>,
    },
}

/// A position and an orientation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "pose")]
pub struct Pose {
    /// Position of the origin, metres.
    #[serde(default, skip_serializing_if = "is_origin")]
    pub at_m: Triple,
    /// Orientation as roll, pitch and yaw about fixed axes, radians.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy_rad: Option<Triple>,
    /// Orientation as a quaternion instead of `rpy_rad`: real part first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<(f64, f64, f64, f64)>,
}

/// A connection of two bodies.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "joint")]
pub struct Joint {
    /// Unique name; joint columns of recordings have it.
    pub name: String,
    /// The parent body, nearer to the root.
    pub parent: String,
    /// The child body, which the joint moves.
    pub child: String,
    /// The child's frame in the parent's, at coordinate 0.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
    /// The kind of joint and its properties.
    pub kind: JointKind,
    /// Coordinate at the start of a run, radians or metres; a joint whose servo follows angles starts at its first command.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
}

/// The kind of a joint: the motion of the child relative to the parent.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "kind")]
pub enum JointKind {
    /// No motion: both bodies are one rigid part.
    Fixed,
    /// Rotation about an axis.
    Turn {
        /// Direction of the axis in the child's frame; the child turns right-handed by the angle.
        axis: Triple,
        /// A point on the axis, in the child's frame, metres.
        #[serde(default, skip_serializing_if = "is_origin")]
        anchor_m: Triple,
        /// Smallest and largest angle, radians; without this field the joint has no limits.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        limits_rad: Option<(f64, f64)>,
        /// Torque against the motion per speed, N m s/rad.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_nm_s_rad: f64,
        /// Largest torque of dry friction, N m.
        #[serde(default, skip_serializing_if = "is_zero")]
        dry_nm: f64,
        /// Inertia of a rotor, reflected to the joint, kg m2.
        #[serde(default, skip_serializing_if = "is_zero")]
        armature_kg_m2: f64,
        /// A spring.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        spring: Option<TurnSpring>,
    },
    /// Translation along an axis.
    Slide {
        /// Direction of the axis in the child's frame.
        axis: Triple,
        /// Smallest and largest distance, metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        limits_m: Option<(f64, f64)>,
        /// Force against the motion per speed, N s/m.
        #[serde(default, skip_serializing_if = "is_zero")]
        viscous_n_s_m: f64,
        /// Largest force of dry friction, N.
        #[serde(default, skip_serializing_if = "is_zero")]
        dry_n: f64,
        /// Mass of a rotor, reflected to the joint, kg.
        #[serde(default, skip_serializing_if = "is_zero")]
        armature_kg: f64,
        /// A spring.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        spring: Option<SlideSpring>,
    },
}

/// A spring of a joint that turns.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "spring")]
pub struct TurnSpring {
    /// Torque per angle, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Angle at which the spring exerts no torque, radians.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rest_rad: f64,
}

/// A spring of a joint that slides.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "spring")]
pub struct SlideSpring {
    /// Force per distance, N/m.
    pub stiffness_n_m: f64,
    /// Distance at which the spring exerts no force, metres.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rest_m: f64,
}

/// An actuator of a joint. For a joint that slides, read metres for radians and newtons for newton metres.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "actuator")]
pub struct Driver {
    /// The joint.
    pub joint: String,
    /// Control law and limits.
    pub servo: Servo,
    /// The command that the servo follows; without a gait it holds 0, or the value nearest to 0 within the joint's limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gait: Option<Gait>,
    /// Another actuated joint whose command this actuator copies, instead of a gait.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub follows: Option<Follow>,
    /// How recorded commands become commands of the joint, for actuators whose commands are in other units, e.g. those of a motor
    /// before its gear.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<CommandScale>,
}

/// How a joint copies the command of another one.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "follow")]
pub struct Follow {
    /// The other joint.
    pub joint: String,
    /// Factor on the command of that joint.
    pub factor: f64,
    /// Angle that is added to the product, radians.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset_rad: f64,
}

/// A named frame.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "mark")]
pub struct Frame {
    /// Unique name, among bodies and marks.
    pub name: String,
    /// The body to which the frame is fixed.
    pub body: String,
    /// Pose in the body's frame.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
}

// serde passes fields by reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_origin(at_m: &Triple) -> bool {
    *at_m == (0.0, 0.0, 0.0)
}

/// The vector of three numbers.
pub(super) fn vector((x, y, z): Triple) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

impl Pose {
    /// Whether the pose is the identity.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The pose as a transformation.
    pub fn isometry(&self) -> Isometry3<f64> {
        let turn = match (self.rpy_rad, self.quaternion) {
            (_, Some((w, x, y, z))) => UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
            (Some((roll, pitch, yaw)), None) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            (None, None) => UnitQuaternion::identity(),
        };
        Isometry3::from_parts(Translation3::from(vector(self.at_m)), turn)
    }

    /// A transformation as files state it.
    pub fn of(pose: &Isometry3<f64>) -> Self {
        let (t, q) = (pose.translation.vector, pose.rotation);
        let is_turned = q.w.abs() != 1.0;
        Self {
            at_m: (t.x, t.y, t.z),
            rpy_rad: None,
            quaternion: is_turned.then_some((q.w, q.i, q.j, q.k)),
        }
    }
}

impl Tensor {
    /// The tensor as a matrix.
    pub fn matrix(&self) -> Matrix3<f64> {
        let Self {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        } = *self;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// The symmetric part of a matrix.
    pub fn of(m: &Matrix3<f64>) -> Self {
        Self {
            xx: m[(0, 0)],
            yy: m[(1, 1)],
            zz: m[(2, 2)],
            xy: 0.5 * (m[(0, 1)] + m[(1, 0)]),
            xz: 0.5 * (m[(0, 2)] + m[(2, 0)]),
            yz: 0.5 * (m[(1, 2)] + m[(2, 1)]),
        }
    }
}

impl Structure {
    /// Whether a text describes a robot of bodies.
    pub fn is_in(source: &Source) -> bool {
        match source.is_json() {
            true => source.text().contains("\"bodies\""),
            false => source.has("bodies"),
        }
    }
}

/// Index of the tracked body, or of the body that carries the tracked mark.
pub(super) fn tracked(structure: &Structure, assembly: &Assembly) -> usize {
    let root = assembly.parts[0].solids[0].module;
    let Some(name) = &structure.track else {
        return root;
    };
    let mark = structure.marks.iter().find(|mark| mark.name == *name);
    let body = mark.map_or(name, |mark| &mark.body);
    let found = structure.bodies.iter().position(|one| one.name == *body);
    found.unwrap_or(root)
}

/// Modules that represent the bodies in `Morphology::modules`: the bounding box of each body, with its mass.
pub(super) fn modules(structure: &Structure, assembly: &Assembly) -> Vec<Module> {
    let bodies = structure.bodies.iter().enumerate();
    bodies
        .map(|(index, body)| {
            let solids = assembly.parts.iter().flat_map(|part| &part.solids);
            let own = solids.filter(|solid| solid.module == index && solid.has_surface());
            let bounds = own.map(Solid::bounds_robot_m);
            let bounds = bounds.reduce(|(a, b), (low, high)| (a.inf(&low), b.sup(&high)));
            Module {
                sides_m: bounds.map_or(Vector3::zeros(), |(low, high)| high - low),
                ..Module::passive(&body.name, 0.0, body.mass_kg)
            }
        })
        .collect()
}
