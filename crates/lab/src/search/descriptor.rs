//! Behaviour descriptors, which separate robots in an archive; one line in [`DESCRIPTORS`] adds another.

use realgap_core::Result;
use realgap_core::file::look_up;
use realgap_core::statistics::mean_of;
use realgap_core::unit::Unit;
use realgap_robot::morphology::Morphology;

use super::Travel;

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
    /// Whether it counts things.
    pub is_count: bool,
    /// Description in one line.
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

/// One row per descriptor: name, unit, whether it counts things, description, and computation.
macro_rules! descriptors {
    ($($name:ident $unit:ident, $is_count:literal, $doc:literal, $value:expr;)*) => {
        /// Every descriptor.
        pub const DESCRIPTORS: &[Descriptor] = &[$(Descriptor {
            name: stringify!($name),
            unit: Unit::$unit,
            is_count: $is_count,
            doc: $doc,
            value: $value,
        }),*];
    };
}

descriptors! {
    modules One, true, "number of modules", |b| b.robot.modules().len() as f64;
    active_faces One, true, "number of driven faces", |b| {
        b.robot.modules().iter().filter(|m| m.drive.is_some()).count() as f64
    };
    mass_kg Kilogram, false, "mass of the whole robot", |b| b.robot.summary().mass_kg;
    height_m Metre, false, "height at zero servo angles", |b| b.robot.summary().size_m().z;
    footprint_m Metre, false, "side of the square with the area of the bounding box seen from above", |b| {
        let size_m = b.robot.summary().size_m();
        (size_m.x * size_m.y).sqrt()
    };
    straightness One, false, "net displacement per path length, mean over the repeats", |b| {
        mean_of(b.repeats.iter().map(|t| t.straightness(b.body_length_m)))
    };
    turned_rad Radian, false, "change of heading over the run, mean over the repeats, left positive", |b| {
        mean_of(b.repeats.iter().map(|t| t.turned_rad))
    };
}

/// The descriptor of this name.
///
/// # Errors
/// An unknown name, with the known ones.
pub fn descriptor_named(name: &str) -> Result<&'static Descriptor> {
    look_up("descriptor", name, DESCRIPTORS, |descriptor| {
        descriptor.name
    })
}
