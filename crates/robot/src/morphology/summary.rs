//! Summary of a robot: counts, masses and sizes.

use nalgebra::Vector3;

use super::Morphology;
use super::assembly::Solid;
use super::layout::blocks;

/// The summary that the command `check` prints. Robot frame: origin at the centre of the root module, zero servo angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Number of modules.
    pub modules: usize,
    /// Number of rigid parts.
    pub parts: usize,
    /// Number of joints.
    pub hinges: usize,
    /// Number of joints that a servo drives.
    pub servos: usize,
    /// Mass of cubes and plates, kg.
    pub mass_kg: f64,
    /// Centre of mass, robot frame, m.
    pub centre_of_mass_robot_m: Vector3<f64>,
    /// Lower corner of the bounding box of everything that can touch, robot frame, m.
    pub lower_robot_m: Vector3<f64>,
    /// Upper corner of the same box, robot frame, m.
    pub upper_robot_m: Vector3<f64>,
    /// Longest edge of the tracked module, m.
    pub body_length_m: f64,
}

impl Summary {
    /// Edges of the bounding box, m.
    pub fn size_m(&self) -> Vector3<f64> {
        self.upper_robot_m - self.lower_robot_m
    }
}

pub(super) fn summarise(morphology: &Morphology) -> Summary {
    let assembly = morphology.assemble();
    let mut mass_kg = 0.0;
    let mut moment = Vector3::zeros();
    for solid in assembly.parts.iter().flat_map(|part| &part.solids) {
        mass_kg += solid.mass_kg;
        let centre = solid.robot_from_solid * nalgebra::Point3::from(solid.centre_of_mass_solid_m);
        moment += centre.coords * solid.mass_kg;
    }
    let nothing = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    let (lower_robot_m, upper_robot_m) = if assembly.is_modular {
        box_of_modules(morphology, nothing)
    } else {
        let solids = assembly.parts.iter().flat_map(|part| &part.solids);
        let surfaces = solids.filter(|solid| solid.has_surface());
        let bounds = surfaces.map(Solid::bounds_robot_m);
        let bounds = bounds.reduce(|(a, b), (low, high)| (a.inf(&low), b.sup(&high)));
        bounds.unwrap_or_default()
    };
    Summary {
        modules: morphology.modules().len(),
        parts: assembly.parts.len(),
        hinges: assembly.hinges.len(),
        servos: assembly
            .hinges
            .iter()
            .filter(|hinge| hinge.actuator.is_some())
            .count(),
        mass_kg,
        centre_of_mass_robot_m: moment / mass_kg,
        lower_robot_m,
        upper_robot_m,
        body_length_m: assembly.body_length_m,
    }
}

/// The bounding box of all boxes of modules that take part in contacts.
fn box_of_modules(
    morphology: &Morphology,
    nothing: (Vector3<f64>, Vector3<f64>),
) -> (Vector3<f64>, Vector3<f64>) {
    let all = blocks(
        morphology.modules(),
        morphology.attachments(),
        &morphology.placements,
    );
    all.iter().fold(nothing, |(lower, upper), block| {
        (
            lower.inf(&(block.centre_robot_m - block.half_robot_m)),
            upper.sup(&(block.centre_robot_m + block.half_robot_m)),
        )
    })
}
