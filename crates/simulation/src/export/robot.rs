//! The robot in the form that export formats use: parts with mass, names and frames.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::{Experiment, Floor, Ground, Mount, SceneBody};
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{
    Actuator, Assembly, Hinge, Morphology, Part, Role, ServoLaw, Shape, Solid,
};

/// A robot to be exported, with floor and gravity.
#[derive(Debug, Clone)]
pub struct Robot<'a> {
    /// Name of the morphology.
    pub name: &'a str,
    /// Free text, possibly empty.
    pub description: &'a str,
    /// Parts and hinges, with the experiment's adjustments applied.
    pub assembly: Assembly,
    /// The ground.
    pub floor: Floor,
    /// Regions of the floor and a height field.
    pub ground: Ground,
    /// Factor on the heights of the height field, and the pose of its middle in the world.
    pub heights: (f64, Isometry3<f64>),
    /// The steps on the floor.
    pub steps: Vec<SceneBody>,
    /// Gravity along −z, m/s².
    pub gravity_m_s2: f64,
    /// The spring by which a held robot is held.
    pub mount: Option<Mount>,
    /// Whether anything touches the robot.
    pub has_contacts: bool,
}

impl<'a> Robot<'a> {
    /// The robot of `experiment`, which was made from `morphology`.
    pub fn new(morphology: &'a Morphology, experiment: &Experiment) -> Self {
        Self {
            description: morphology.description(),
            ..Self::named(morphology.name(), experiment)
        }
    }

    /// The robot of `experiment`, by this name.
    pub fn named(name: &'a str, experiment: &Experiment) -> Self {
        Self {
            name,
            description: "",
            assembly: experiment.adjusted_assembly(),
            floor: experiment.floor,
            ground: experiment.ground.clone(),
            heights: (
                experiment.heights_scale,
                (experiment.ground.heights.as_ref()).map_or_else(Isometry3::identity, |field| {
                    experiment.world_from_heights(field)
                }),
            ),
            steps: experiment.steps(),
            gravity_m_s2: experiment.gravity_m_s2,
            mount: experiment.mount,
            has_contacts: experiment.contact.is_on,
        }
    }

    /// Comments at the head of an exported file: its origin, the text `remark`, and everything that the format cannot represent.
    pub(super) fn comments(&self, remark: &str, not_carried: &[Warning]) -> Vec<String> {
        let mut comments = vec![format!(
            "Robot {} exported by realgap {}. SI units, radians, z up.{remark}",
            self.name,
            env!("CARGO_PKG_VERSION")
        )];
        if !self.description.is_empty() {
            comments.push(self.description.to_owned());
        }
        comments.extend(
            not_carried
                .iter()
                .map(|w| format!("Not carried: {}", w.message)),
        );
        comments
    }

    /// The hinges that a part carries.
    pub(super) fn hinges_on(&self, part: usize) -> impl Iterator<Item = &Hinge> {
        self.assembly
            .hinges
            .iter()
            .filter(move |hinge| hinge.parent_part == part)
    }

    /// The hinges that a servo drives, each with its actuator.
    pub(super) fn driven_hinges(&self) -> impl Iterator<Item = (&Hinge, &Actuator)> {
        let hinges = self.assembly.hinges.iter();
        hinges.filter_map(|hinge| Some((hinge, hinge.actuator.as_ref()?)))
    }

    /// Warnings about tyres, and about commands that no format can state.
    pub(super) fn of_wheels(&self, throttles: &str) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.assembly.has_tyres() {
            warnings.push(Code::TyreNotExported.warning(
                "the slip of tyres (they have Coulomb's friction, which holds up to its limit)",
            ));
        }
        let mut driven = self.driven_hinges().map(|(_, actuator)| actuator);
        if driven.any(|actuator| actuator.servo.law == ServoLaw::Throttle) {
            warnings.push(Code::TyreNotExported.warning(throttles));
        }
        let mut driven = self.driven_hinges().map(|(_, actuator)| actuator.command);
        if driven.any(|command| !command.is_linear()) {
            warnings.push(Code::TyreNotExported.warning(
                "dead zone, bend, Ackermann steering, delay and lag of recorded commands (command.*): apply them before you set a command",
            ));
        }
        warnings
    }

    /// The solids that are hulls, each with its corners.
    pub(super) fn hulls(&self) -> impl Iterator<Item = (&Solid, &[Vector3<f64>])> {
        let solids = self.assembly.parts.iter().flat_map(|part| &part.solids);
        solids.filter_map(|solid| match &solid.shape {
            Shape::Hull { points_m } => Some((solid, &**points_m)),
            _ => None,
        })
    }

    /// Whether a part has neither mass nor shape: a link between two joints of one body.
    pub(super) fn is_empty_link(&self, part: usize) -> bool {
        let mut solids = self.assembly.parts[part].solids.iter();
        solids.all(|solid| solid.mass_kg == 0.0 && solid.shape == Shape::Nothing)
    }

    /// Whether a servo drives any hinge.
    pub(super) fn has_servos(&self) -> bool {
        self.driven_hinges().next().is_some()
    }

    /// Pairs of different parts that contain modules between which no contacts are computed.
    pub(super) fn excluded_part_pairs(&self) -> Vec<(usize, usize)> {
        let part_of = |module: usize| {
            let mut parts = self.assembly.parts.iter();
            parts.position(|part| {
                let is_of = |s: &Solid| s.module == module && s.role == Role::Cube;
                part.solids.iter().any(is_of)
            })
        };
        let mut pairs = Vec::new();
        for &(a, b) in &self.assembly.collision_exclude {
            if let (Some(a), Some(b)) = (part_of(a), part_of(b))
                && a != b
                && !pairs.contains(&(a, b))
            {
                pairs.push((a, b));
            }
        }
        pairs
    }

    /// Name of a box. Module names have no dot, so no two boxes share a name.
    pub(super) fn solid_name(&self, solid: &Solid) -> String {
        let module = &self.assembly.module_names[solid.module];
        match solid.role {
            Role::Cube if solid.number > 0 => format!("{module}.cube{}", solid.number + 1),
            Role::Cube => format!("{module}.cube"),
            Role::Plate => format!("{module}.plate"),
        }
    }

    /// Name of a part: that of its first module if its first solid is a cube, otherwise that of its first plate. No two parts
    /// share a solid, so names are unique.
    pub(super) fn part_name(&self, part: usize) -> String {
        match self.assembly.parts[part].solids.first() {
            Some(solid) if solid.role == Role::Cube => {
                self.assembly.module_names[solid.module].clone()
            }
            Some(solid) => self.solid_name(solid),
            None => format!("part.{part}"),
        }
    }

    /// Height of the root's centre above the floor at zero angles when the lowest box just touches it, metres.
    pub(super) fn clearance_m(&self) -> f64 {
        let normal = self.floor.normal_world();
        let lowest = self
            .assembly
            .parts
            .iter()
            .flat_map(|part| &part.solids)
            .filter(|solid| solid.has_surface())
            .map(|solid| {
                let along = solid.robot_from_solid.rotation.inverse() * normal;
                solid.robot_from_solid.translation.vector.dot(&normal)
                    - solid.shape.reach_m(&-along)
            })
            .fold(f64::INFINITY, f64::min);
        -lowest / normal.z
    }
}

/// Origin of a part's frame in the robot frame: the centre of its first box.
pub(super) fn origin_robot_m(part: &Part) -> Vector3<f64> {
    part.solids.first().map_or_else(Vector3::zeros, |solid| {
        solid.robot_from_solid.translation.vector
    })
}

/// A pose of the robot frame seen from a frame with the same axes at `origin_robot_m`.
pub(super) fn seen_from(origin_robot_m: &Vector3<f64>, pose: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(
        (pose.translation.vector - origin_robot_m).into(),
        pose.rotation,
    )
}

/// The quaternion as files write it: real part first.
pub(super) fn quaternion(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    [rotation.w, rotation.i, rotation.j, rotation.k]
}
