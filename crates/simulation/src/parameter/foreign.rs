//! Parameters that a simulator of somebody else declares: `sim.NAME`.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex};

use super::{Nudge, Parameter, Scale};
use realgap_core::unit::Unit;

/// What stands before the name of a simulator's own parameter.
pub const FOREIGN: &str = "sim";

/// The own name of a simulator's parameter; `None` for a parameter of this crate.
pub(super) fn own_name(name: &str) -> Option<&str> {
    let own = name.strip_prefix(FOREIGN)?.strip_prefix('.')?;
    let is_letter = |c: char| !c.is_control() && !c.is_whitespace() && !",=\"'".contains(c);
    (!own.is_empty() && own.len() <= LONGEST && own.chars().all(is_letter)).then_some(own)
}

/// Longest name of a simulator's own parameter, in bytes.
const LONGEST: usize = 200;
/// Change by which sensitivity studies move a simulator's parameter: a share of its range where it has one, else of its value.
const NUDGE: f64 = 0.01;

/// A parameter as its simulator declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Declared {
    /// Its name in the simulator.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Smallest and largest allowed value.
    pub bounds: (f64, f64),
    /// Whether a search varies it on a logarithmic scale.
    pub is_logarithmic: bool,
    /// Its meaning, in one sentence.
    pub about: String,
}

impl Declared {
    /// A parameter of which nothing but the name is known, because its simulator was not asked.
    pub fn unknown(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            unit: Unit::One,
            bounds: (f64::MIN, f64::MAX),
            is_logarithmic: false,
            about: "A parameter of the study's own simulator.".to_owned(),
        }
    }
}

/// Parameters are stored by reference, so each declaration gets one parameter that lives as long as the program.
static KNOWN: LazyLock<Mutex<BTreeMap<String, &'static Parameter>>> = LazyLock::new(Mutex::default);

/// The parameter `sim.NAME` of a simulator, with these properties.
pub fn foreign_parameter(declared: &Declared) -> &'static Parameter {
    let mut known = KNOWN
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    known
        .entry(format!("{declared:?}"))
        .or_insert_with(|| Box::leak(Box::new(new_parameter(declared))))
}

fn new_parameter(declared: &Declared) -> Parameter {
    let leaked = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let (low, high) = declared.bounds;
    Parameter {
        name: leaked(format!("{FOREIGN}.{}", declared.name)),
        unit: declared.unit,
        bounds: declared.bounds,
        whole: false,
        scale: match declared.is_logarithmic {
            true => Scale::Log,
            false => Scale::Linear,
        },
        nudge: match (high - low).is_finite() {
            true => Nudge::Absolute(NUDGE * (high - low)),
            false => Nudge::Share(NUDGE),
        },
        doc: leaked(declared.about.clone()),
        subject: leaked(declared.name.clone()),
        get: |experiment, own| experiment.foreign.values.get(own).copied(),
        set: |experiment, own, value| {
            experiment.foreign.values.insert(own.to_owned(), value);
        },
    }
}
