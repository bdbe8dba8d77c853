//! What tells robots apart in an archive: one line in [`DESCRIPTORS`] adds another.

use realgap_core::Result;
use realgap_core::file::look_up;
use realgap_core::statistics::mean;
use realgap_core::unit::Unit;
use realgap_robot::morphology::Morphology;

use super::objective::Travel;

/// A robot and what its repeats did.
#[derive(Debug, Clone, Copy)]
pub struct Behaviour<'a> {
    /// The robot.
    pub robot: &'a Morphology,
    /// What each repeat did.
    pub repeats: &'a [Travel],
    /// Edge length of the tracked module, metres.
    pub body_length_m: f64,
}

/// One number about a robot and its behaviour.
pub struct Descriptor {
    /// Name in files.
    pub name: &'static str,
    /// Unit of the number.
    pub unit: Unit,
    /// Whether it is a whole number of things.
    pub is_count: bool,
    /// What it is, in one line.
    pub doc: &'static str,
    value: fn(&Behaviour<'_>) -> f64,
}

impl Descriptor {
    /// The number.
    pub fn of(&self, behaviour: &Behaviour<'_>) -> f64 {
        (self.value)(behaviour)
    }
}

impl std::fmt::Debug for Descriptor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Descriptor({})", self.name)
    }
}

/// Every descriptor.
pub const DESCRIPTORS: &[Descriptor] = &[
    Descriptor {
        name: "modules",
        unit: Unit::One,
        is_count: true,
        doc: "number of modules",
        value: |b| b.robot.modules().len() as f64,
    },
    Descriptor {
        name: "active_faces",
        unit: Unit::One,
        is_count: true,
        doc: "number of driven faces",
        value: |b| {
            let driven = b.robot.modules().iter().filter(|m| m.drive.is_some());
            driven.count() as f64
        },
    },
    Descriptor {
        name: "mass_kg",
        unit: Unit::Kilogram,
        is_count: false,
        doc: "mass of the whole robot",
        value: |b| b.robot.summary().mass_kg,
    },
    Descriptor {
        name: "height_m",
        unit: Unit::Metre,
        is_count: false,
        doc: "height at zero servo angles",
        value: |b| b.robot.summary().size_m().z,
    },
    Descriptor {
        name: "footprint_m",
        unit: Unit::Metre,
        is_count: false,
        doc: "side of the square with the area of the bounding box seen from above",
        value: |b| {
            let size_m = b.robot.summary().size_m();
            (size_m.x * size_m.y).sqrt()
        },
    },
    Descriptor {
        name: "straightness",
        unit: Unit::One,
        is_count: false,
        doc: "net displacement per path length, mean over the repeats",
        value: |b| {
            let all = b.repeats.iter().map(|t| t.straightness(b.body_length_m));
            mean(&all.collect::<Vec<_>>())
        },
    },
    Descriptor {
        name: "turned_rad",
        unit: Unit::Radian,
        is_count: false,
        doc: "change of heading over the run, mean over the repeats, left positive",
        value: |b| mean(&b.repeats.iter().map(|t| t.turned_rad).collect::<Vec<_>>()),
    },
];

/// The descriptor of this name.
///
/// # Errors
/// An unknown name, with the known ones.
pub fn descriptor_named(name: &str) -> Result<&'static Descriptor> {
    look_up("descriptor", name, DESCRIPTORS, |descriptor| {
        descriptor.name
    })
}
