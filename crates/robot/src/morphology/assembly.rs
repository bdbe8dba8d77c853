//! The assembly of a robot: rigid parts of any shape, connected by revolute joints (hinges) and prismatic joints (slides).
//!
//! All quantities are given in the robot frame with all joint coordinates at zero. For a modular robot this is the frame of the
//! root module (origin at its centre, x, y, z along its faces), for a robot of bodies the frame of the root body.

use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::absent::{is_unlimited, is_zero, limit, unlimited};
use super::body::Surroundings;
use super::command_scale::CommandScale;
use super::law::ServoLaw;
use super::turning::TurningFriction;
use super::tyre::Tyre;
use realgap_solid::Shape;

/// The role of a solid in its module or body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A solid of the module or body itself: in most cases its only cube.
    Cube,
    /// The face plate of an active module, which moves with the driven face.
    Plate,
}

/// One shape, part of a rigid cluster. Its density is uniform unless its module or body states otherwise. A body with a stated
/// mass has one solid without a surface that carries the mass, and shapes without mass.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Index of the module or body that the solid belongs to.
    pub module: usize,
    /// Whether the solid is a cube or a plate.
    pub role: Role,
    /// Number of the shape in its module or body, from 0.
    pub number: usize,
    /// The shape, in the solid's own frame.
    pub shape: Shape,
    /// Pose in the robot frame at zero servo angles, metres.
    pub robot_from_solid: Isometry3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the solid's own frame, metres (zero for a uniform box).
    pub centre_of_mass_solid_m: Vector3<f64>,
    /// Inertia about the solid's own centre of mass, along its own axes, kg m².
    pub inertia_kg_m2: Matrix3<f64>,
    /// Share of the weight that a force upwards at the centre of mass compensates.
    pub gravity_compensation: f64,
    /// False if the solid has mass but takes part in no contacts (a plate with a module attached to it).
    pub collides: bool,
    /// The law of its friction, if it is a tyre.
    pub tyre: Option<Tyre>,
    /// Friction against rolling and spinning, in addition to that of what it touches.
    pub turning: TurningFriction,
}

impl Solid {
    /// Half extents of the bounding box along the solid's own axes, metres.
    pub fn half_extents_m(&self) -> Vector3<f64> {
        self.shape.half_extents_m()
    }

    /// Lower and upper corner of the bounding box along the robot's axes, metres.
    pub fn bounds_robot_m(&self) -> (Vector3<f64>, Vector3<f64>) {
        let turn = self.robot_from_solid.rotation.to_rotation_matrix();
        let half_m = turn.matrix().abs() * self.half_extents_m();
        let centre_m = self.robot_from_solid.translation.vector;
        (centre_m - half_m, centre_m + half_m)
    }

    /// Whether the solid can be in contact with anything.
    pub fn has_surface(&self) -> bool {
        self.collides && self.shape != Shape::Nothing
    }
}

/// A rigid cluster of solids: one body of the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The solids of the part, at least one. The origin of the part's frame is that of the first solid, its axes are those of the
    /// robot.
    pub solids: Vec<Solid>,
}

/// Mass, centre of mass and inertia of a rigid cluster, in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterMass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, metres.
    pub centre_m: Vector3<f64>,
    /// Inertia about the centre of mass, along the frame's axes, kg m².
    pub inertia_kg_m2: Matrix3<f64>,
}

impl Part {
    /// Mass of all its solids, kg.
    pub fn mass_kg(&self) -> f64 {
        self.solids.iter().map(|solid| solid.mass_kg).sum()
    }

    /// Mass whose weight is compensated, kg, and its centre of mass in the robot frame, metres; `None` if no weight is compensated.
    pub fn compensated(&self) -> Option<(f64, Vector3<f64>)> {
        let each = self.solids.iter().map(|solid| {
            let centre = solid.robot_from_solid * Point3::from(solid.centre_of_mass_solid_m);
            (solid.mass_kg * solid.gravity_compensation, centre.coords)
        });
        let (mass_kg, moment) = each
            .fold((0.0, Vector3::zeros()), |(mass, moment), (kg, centre)| {
                (mass + kg, moment + centre * kg)
            });
        (mass_kg != 0.0).then(|| (mass_kg, moment / mass_kg))
    }

    /// Mass properties of the cluster in a frame given by its pose: the sum over the solids, moved to the common
    /// centre by the parallel-axes rule (Steiner).
    pub fn mass(&self, frame_from_robot: &Isometry3<f64>) -> ClusterMass {
        let pose = |solid: &Solid| frame_from_robot * solid.robot_from_solid;
        let centre_of =
            |solid: &Solid| (pose(solid) * Point3::from(solid.centre_of_mass_solid_m)).coords;
        let mass_kg = self.mass_kg();
        let moment: Vector3<f64> = self
            .solids
            .iter()
            .map(|solid| centre_of(solid) * solid.mass_kg)
            .sum();
        // An intermediate link between two joints of one body has no mass.
        let centre_m = match self.solids.first() {
            Some(first) if mass_kg == 0.0 => centre_of(first),
            _ => moment / mass_kg,
        };
        let mut inertia_kg_m2 = Matrix3::zeros();
        for solid in &self.solids {
            let turn = pose(solid).rotation.to_rotation_matrix();
            let d = centre_of(solid) - centre_m;
            inertia_kg_m2 += turn * solid.inertia_kg_m2 * turn.transpose()
                + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * solid.mass_kg;
        }
        ClusterMass {
            mass_kg,
            centre_m,
            inertia_kg_m2,
        }
    }
}

/// Open-loop command of a servo: offset + amplitude·sin(2π·frequency·t + phase).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "gait")]
pub struct Gait {
    /// Mean angle, radians.
    #[serde(default)]
    pub offset_rad: f64,
    /// Amplitude, radians.
    pub amplitude_rad: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase, radians.
    #[serde(default)]
    pub phase_rad: f64,
}

impl Gait {
    /// The gait of a servo that holds an angle.
    pub(crate) const fn hold(offset_rad: f64) -> Self {
        Self {
            offset_rad,
            amplitude_rad: 0.0,
            frequency_hz: 0.0,
            phase_rad: 0.0,
        }
    }

    /// The commanded angle at time `t_s`, radians.
    pub fn angle_rad(&self, t_s: f64) -> f64 {
        self.offset_rad
            + self.amplitude_rad
                * (std::f64::consts::TAU * self.frequency_hz * t_s + self.phase_rad).sin()
    }
}

/// A servo: control law and limits.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "servo")]
pub struct Servo {
    /// Control law.
    pub law: ServoLaw,
    /// Largest torque, N m.
    pub max_torque_nm: f64,
    /// Largest commanded speed, rad/s; without this field there is no limit.
    #[serde(
        default = "unlimited",
        deserialize_with = "limit",
        skip_serializing_if = "is_unlimited"
    )]
    pub max_speed_rad_s: f64,
    /// Delay between a command and the servo's reaction to it, seconds.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub delay_s: f64,
    /// Torque at the joint per current of the motor, N m/A, for commanded and measured currents. A law `Motor` states its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_constant_nm_a: Option<f64>,
}

impl Servo {
    /// Torque at the joint per current of the motor, N m/A: that of the law `Motor`, or the stated one.
    pub fn torque_per_current_nm_a(&self) -> Option<f64> {
        let motor = self.law.motor().map(|motor| motor.torque_constant_nm_a);
        motor.or(self.torque_constant_nm_a)
    }
}

/// The actuator of a hinge: a servo and its open-loop command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Control law and limits.
    pub servo: Servo,
    /// Open-loop command.
    pub gait: Gait,
    /// How recorded commands become commands of the joint.
    pub command: CommandScale,
}

/// Passive properties of a hinge. For a slide, read metres for radians and newtons for newton metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bearing {
    /// Torque against the motion per speed, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Largest torque of dry (Coulomb) friction, N m.
    pub dry_nm: f64,
    /// Smallest and largest angle, radians; `None` for a hinge without limits.
    pub limits_rad: Option<(f64, f64)>,
    /// Inertia that resists only the motion of this joint, e.g. of a geared rotor, kg m². The armature of a
    /// [`Motor`](super::Motor) is added to it.
    pub armature_kg_m2: f64,
    /// A spring that acts in addition to the actuator.
    pub spring: Option<Spring>,
    /// Compliance in the directions that the joint should constrain.
    pub compliance: Compliance,
}

/// Compliance of a bearing in the directions that it constrains: one spring and one damper per direction. The spring is so stiff
/// that the two connected parts alone would oscillate at this frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compliance {
    /// Natural frequency, Hz; 0 for a rigid bearing.
    pub frequency_hz: f64,
    /// Damping ratio, dimensionless.
    pub damping_ratio: f64,
}

impl Default for Compliance {
    fn default() -> Self {
        Self {
            frequency_hz: 0.0,
            damping_ratio: 1.0,
        }
    }
}

/// A spring at a joint: torque `stiffness · (rest − angle)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Torque per angle, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Angle at which the spring exerts no torque, radians.
    pub rest_rad: f64,
}

/// The degree of freedom of a joint. Bodies that are fixed to each other form one part and need no joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Freedom {
    /// Rotation about the axis, with or without limits.
    #[default]
    Turn,
    /// Translation along the axis. For such a joint every angle is a distance in metres, and every torque is a force in newtons.
    Slide,
}

impl Bearing {
    /// Whether the bearing has friction, viscous or dry.
    pub fn has_friction(&self) -> bool {
        self.viscous_nm_s_rad > 0.0 || self.dry_nm > 0.0
    }

    /// Whether the bearing is compliant.
    pub fn is_compliant(&self) -> bool {
        self.compliance.frequency_hz > 0.0
    }
}

/// A joint between two parts; with a positive coordinate the child turns right-handed about the axis relative to the parent, or
/// slides along it.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinge {
    /// Name of the active module that drives the hinge, or the name that the file states for the hinge.
    pub name: String,
    /// Index of the active module that contains the servo; for a hinge that the file states, index of the module that the hinge
    /// moves.
    pub module: usize,
    /// Index of the part nearer to the root. It contains the servo's cube, unless the module is attached to its parent by its
    /// driven face; in that case the axis is reversed, so that the sign convention above holds in both cases.
    pub parent_part: usize,
    /// Index of the part further from the root: the part that the driven face carries, or the part with the servo's cube.
    pub child_part: usize,
    /// A point on the axis (the centre of a driven face), robot frame at zero angles, metres.
    pub anchor_robot_m: Vector3<f64>,
    /// The axis, robot frame at zero angles.
    pub axis_robot: Unit<Vector3<f64>>,
    /// Whether the joint turns or slides.
    pub freedom: Freedom,
    /// The actuator; `None` for a passive hinge.
    pub actuator: Option<Actuator>,
    /// Passive properties: friction, limits, spring, armature and compliance.
    pub bearing: Bearing,
    /// Whether the robot's file states this hinge by anchor and axis.
    pub is_stated: bool,
    /// Coordinate at the start of a run, where the file states it.
    pub start_rad: Option<f64>,
}

impl Hinge {
    /// The rigid motion of the child relative to the parent at a joint coordinate, in the robot frame.
    pub fn motion(&self, coordinate: f64) -> Isometry3<f64> {
        if self.freedom == Freedom::Slide {
            return Translation3::from(self.axis_robot.into_inner() * coordinate).into();
        }
        let there = Translation3::from(self.anchor_robot_m);
        let rotation = UnitQuaternion::from_axis_angle(&self.axis_robot, coordinate);
        there * rotation * there.inverse()
    }
}

/// A named frame that is fixed to a part: it can be tracked or carry a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Name of the frame.
    pub name: String,
    /// Index of the part to which the frame is fixed.
    pub part: usize,
    /// Pose in the robot frame at zero angles.
    pub robot_from_mark: Isometry3<f64>,
}

/// Rigid parts and hinges of one robot. Part 0 contains the root module; the hinges form a tree in which every parent part
/// precedes its children.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The robot's name.
    pub name: String,
    /// Names of the modules or bodies, by index.
    pub module_names: Vec<String>,
    /// Rigid clusters.
    pub parts: Vec<Part>,
    /// Joints, exactly one per part other than part 0.
    pub hinges: Vec<Hinge>,
    /// Whether the robot is built of modules; otherwise it is built of bodies that its file states.
    pub is_modular: bool,
    /// Pairs of modules or bodies between which no contacts are computed.
    pub collision_exclude: Vec<(usize, usize)>,
    /// Pose in the world at which the robot frame is fixed; `None` for a robot that moves freely.
    pub world_from_mount: Option<Isometry3<f64>>,
    /// Named frames.
    pub marks: Vec<Mark>,
    /// The part whose motion is recorded.
    pub track_part: usize,
    /// Robot-frame pose of the tracked module at zero angles: its centre is the tracked point, its axes the body frame.
    pub robot_from_track: Isometry3<f64>,
    /// Longest edge of the tracked module, metres: the "body length" of the `pose` metric.
    pub body_length_m: f64,
    /// The world that the robot's file states, with which an experiment begins.
    pub surroundings: Surroundings,
}

impl Assembly {
    /// An assembly without parts: for experiments and default values that need no robot.
    pub fn empty() -> Self {
        Self {
            name: String::new(),
            module_names: Vec::new(),
            parts: Vec::new(),
            hinges: Vec::new(),
            is_modular: true,
            collision_exclude: Vec::new(),
            world_from_mount: None,
            marks: Vec::new(),
            track_part: 0,
            robot_from_track: Isometry3::identity(),
            body_length_m: 1.0,
            surroundings: Surroundings::default(),
        }
    }

    /// Displacement of each part from its pose at zero joint coordinates, robot frame, for the given joint coordinates; that of
    /// part 0 is the identity.
    pub fn moved(&self, coordinates: &[f64]) -> Vec<Isometry3<f64>> {
        let mut moved = vec![Isometry3::identity(); self.parts.len()];
        for (hinge, &coordinate) in self.hinges.iter().zip(coordinates) {
            moved[hinge.child_part] = moved[hinge.parent_part] * hinge.motion(coordinate);
        }
        moved
    }

    /// Whether an actuated joint moves this part of a robot of bodies; always false for a modular robot.
    pub fn drives(&self, part: usize) -> bool {
        let mut hinges = self.hinges.iter();
        !self.is_modular && hinges.any(|hinge| hinge.child_part == part && hinge.actuator.is_some())
    }

    /// Whether any hinge has a compliant bearing.
    pub fn is_compliant(&self) -> bool {
        self.hinges.iter().any(|hinge| hinge.bearing.is_compliant())
    }

    /// Whether any shape is a tyre.
    pub fn has_tyres(&self) -> bool {
        let mut solids = self.parts.iter().flat_map(|part| &part.solids);
        solids.any(|solid| solid.tyre.is_some())
    }

    /// Whether the robot's file states friction against rolling or spinning, of a shape or of the floor.
    pub fn states_turning_friction(&self) -> bool {
        let around = &self.surroundings;
        let of_floor = around.floor_rolling_m.is_some() || around.floor_torsional_m.is_some();
        of_floor || self.has_turning_shapes()
    }

    /// Whether a shape has friction against rolling or spinning of its own.
    pub fn has_turning_shapes(&self) -> bool {
        let mut solids = self.parts.iter().flat_map(|part| &part.solids);
        solids.any(|solid| !solid.turning.is_none())
    }

    /// Whether the robot's file excludes contacts between two modules.
    pub(crate) fn is_collision_excluded(&self, a: usize, b: usize) -> bool {
        self.collision_exclude.contains(&(a, b)) || self.collision_exclude.contains(&(b, a))
    }
}
