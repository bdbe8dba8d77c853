//! What is simulated: rigid parts of any shape, joined by hinges and slides.
//!
//! Everything is given in the robot frame at zero joint coordinates: of cubes the frame of the root module (origin at its centre,
//! x, y, z along its faces), of bodies the frame of the root body.

use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::absent::{is_unlimited, is_zero, limit, unlimited};
use super::law::ServoLaw;
use realgap_solid::Shape;

/// What a solid stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// What a module or body itself consists of: mostly its one cube.
    Cube,
    /// The face plate of an active module: it moves with the driven face.
    Plate,
}

/// One shape of uniform density (unless its module or body says otherwise), part of a rigid cluster. A body with a stated mass
/// has a solid without a surface that carries it, and shapes that weigh nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Index of the module or body it belongs to.
    pub module: usize,
    /// Cube or plate.
    pub role: Role,
    /// Which shape of its module or body, from 0.
    pub number: usize,
    /// Its surface, in its own frame.
    pub shape: Shape,
    /// Pose in the robot frame at zero servo angles, metres.
    pub robot_from_solid: Isometry3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the solid's own frame, metres (zero for a uniform box).
    pub centre_of_mass_solid_m: Vector3<f64>,
    /// Inertia about the solid's own centre of mass, along its own axes, kg m².
    pub inertia_kg_m2: Matrix3<f64>,
    /// False where it has mass but must not touch anything (a plate with a module glued on it).
    pub collides: bool,
}

impl Solid {
    /// Half extents of the box around it, along its own axes, metres.
    pub fn half_extents_m(&self) -> Vector3<f64> {
        self.shape.half_extents_m()
    }

    /// Lower and upper corner of the box around it along the robot's axes, metres.
    pub fn bounds_robot_m(&self) -> (Vector3<f64>, Vector3<f64>) {
        let turn = self.robot_from_solid.rotation.to_rotation_matrix();
        let half_m = turn.matrix().abs() * self.half_extents_m();
        let centre_m = self.robot_from_solid.translation.vector;
        (centre_m - half_m, centre_m + half_m)
    }

    /// Whether anything can touch it.
    pub fn has_surface(&self) -> bool {
        self.collides && self.shape != Shape::Nothing
    }
}

/// A rigid cluster of solids: one body of the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What is glued together, at least one. The part's own frame is at the first one's origin, along the robot's axes.
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
        // A link between two joints of one body weighs nothing.
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
    pub(super) const fn hold(offset_rad: f64) -> Self {
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
    /// Largest commanded speed, rad/s; without it there is no limit.
    #[serde(
        default = "unlimited",
        deserialize_with = "limit",
        skip_serializing_if = "is_unlimited"
    )]
    pub max_speed_rad_s: f64,
    /// Age of the command that it acts on, seconds.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub delay_s: f64,
}

/// What moves a hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Control law and limits.
    pub servo: Servo,
    /// Open-loop command.
    pub gait: Gait,
}

/// What a hinge does by itself, with or without a servo. Of a slide read metres for radians and newtons for newton metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bearing {
    /// Torque against the motion per speed, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Largest torque of dry (Coulomb) friction, N m.
    pub dry_nm: f64,
    /// Smallest and largest angle, radians; `None` where the hinge turns all round.
    pub limits_rad: Option<(f64, f64)>,
    /// Inertia that only this joint's motion feels, e.g. of a geared rotor, kg m². That of a [`Motor`](super::Motor) comes on top.
    pub armature_kg_m2: f64,
    /// A spring beside whatever drives the joint.
    pub spring: Option<Spring>,
    /// How it gives way where it should hold.
    pub compliance: Compliance,
}

/// How a bearing gives way in the directions that it holds: by a spring and a damper each, so stiff that its two parts by themselves
/// would swing with this frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compliance {
    /// Natural frequency, Hz; 0 where the bearing is rigid.
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
    /// Where it is slack, radians.
    pub rest_rad: f64,
}

/// What a joint lets its child do. What is fixed is one part and needs no joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Freedom {
    /// Turn about the axis, with or without limits.
    #[default]
    Turn,
    /// Slide along the axis. Every angle of such a joint is a distance in metres, every torque a force in newtons.
    Slide,
}

impl Bearing {
    /// Whether it holds the hinge back at all, limits apart.
    pub fn has_friction(&self) -> bool {
        self.viscous_nm_s_rad > 0.0 || self.dry_nm > 0.0
    }

    /// Whether it gives way where it should hold.
    pub fn is_compliant(&self) -> bool {
        self.compliance.frequency_hz > 0.0
    }
}

/// A joint between two parts; the child turns by +angle about the axis relative to the parent (right-handed), or slides along it.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinge {
    /// Name: that of the active module, or the hinge's own.
    pub name: String,
    /// Index of the active module that owns the servo; of a stated hinge: of the module that it moves.
    pub module: usize,
    /// Index of the part nearer to the root. It carries the servo's cube, unless the module holds on to its
    /// parent by its driven face; the axis is reversed then, so that the sentence above holds for both.
    pub parent_part: usize,
    /// Index of the part further from the root: what the driven face carries, or else the servo's cube.
    pub child_part: usize,
    /// A point on the axis (the centre of a driven face), robot frame at zero angles, metres.
    pub anchor_robot_m: Vector3<f64>,
    /// The axis, robot frame at zero angles.
    pub axis_robot: Unit<Vector3<f64>>,
    /// Whether it turns or slides.
    pub freedom: Freedom,
    /// What moves it; `None` for a passive hinge.
    pub actuator: Option<Actuator>,
    /// Friction and limits.
    pub bearing: Bearing,
    /// Whether the robot's file states this hinge by anchor and axis.
    pub is_stated: bool,
}

impl Hinge {
    /// Turn about the axis, or slide along it, in the robot frame.
    pub fn motion(&self, coordinate: f64) -> Isometry3<f64> {
        if self.freedom == Freedom::Slide {
            return Translation3::from(self.axis_robot.into_inner() * coordinate).into();
        }
        let there = Translation3::from(self.anchor_robot_m);
        let rotation = UnitQuaternion::from_axis_angle(&self.axis_robot, coordinate);
        there * rotation * there.inverse()
    }
}

/// A frame that is fixed to a part, by name: what is tracked, or carries a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its name.
    pub name: String,
    /// The part that carries it.
    pub part: usize,
    /// Its pose in the robot frame at zero angles.
    pub robot_from_mark: Isometry3<f64>,
}

/// Rigid parts and hinges of one robot. Part 0 contains the root module; hinges form a tree in which
/// every parent part comes before its children.
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
    /// Whether it is built of modules; else of bodies that its file states.
    pub is_modular: bool,
    /// Pairs of modules or bodies that never touch each other.
    pub apart: Vec<(usize, usize)>,
    /// Where the robot frame is held in the world; `None` for a robot that moves freely.
    pub world_from_mount: Option<Isometry3<f64>>,
    /// Named frames.
    pub marks: Vec<Mark>,
    /// The part whose motion is recorded.
    pub track_part: usize,
    /// Robot-frame pose of the tracked module at zero angles: its centre is the tracked point, its axes the body frame.
    pub robot_from_track: Isometry3<f64>,
    /// Longest edge of the tracked module, metres: the "body length" of the `pose` metric.
    pub body_length_m: f64,
}

impl Assembly {
    /// No robot at all: for what an experiment is without one.
    pub fn empty() -> Self {
        Self {
            name: String::new(),
            module_names: Vec::new(),
            parts: Vec::new(),
            hinges: Vec::new(),
            is_modular: true,
            apart: Vec::new(),
            world_from_mount: None,
            marks: Vec::new(),
            track_part: 0,
            robot_from_track: Isometry3::identity(),
            body_length_m: 1.0,
        }
    }

    /// How each part has moved from its place at zero, robot frame, when the joints are at these coordinates; part 0 has not.
    pub fn moved(&self, coordinates: &[f64]) -> Vec<Isometry3<f64>> {
        let mut moved = vec![Isometry3::identity(); self.parts.len()];
        for (hinge, &coordinate) in self.hinges.iter().zip(coordinates) {
            moved[hinge.child_part] = moved[hinge.parent_part] * hinge.motion(coordinate);
        }
        moved
    }

    /// Whether a part of a robot of bodies hangs on a joint that is driven.
    pub fn drives(&self, part: usize) -> bool {
        let mut hinges = self.hinges.iter();
        !self.is_modular && hinges.any(|hinge| hinge.child_part == part && hinge.actuator.is_some())
    }

    /// Whether any hinge gives way where it should hold.
    pub fn is_compliant(&self) -> bool {
        self.hinges.iter().any(|hinge| hinge.bearing.is_compliant())
    }

    /// Whether two modules are stated never to touch.
    pub fn are_apart(&self, a: usize, b: usize) -> bool {
        self.apart.contains(&(a, b)) || self.apart.contains(&(b, a))
    }
}
