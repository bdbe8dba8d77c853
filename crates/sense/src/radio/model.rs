//! A radio model: a propagation model with its numbers, and how far strengths lie about it.

use serde::{Deserialize, Serialize};

use super::link::Link;
use super::propagation::{Parameter, Propagation, Terms, Walls};
use realgap_core::error::{Error, Result};

/// Base of the logarithm of distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LogBase {
    /// 10, as usual.
    #[default]
    Ten,
    /// e, which the numbers of paper 002 need.
    E,
}

impl LogBase {
    /// The logarithm.
    pub fn log(self, value: f64) -> f64 {
        match self {
            Self::Ten => libm::log10(value),
            Self::E => libm::log(value),
        }
    }

    /// `10` or `e`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ten => "10",
            Self::E => "e",
        }
    }
}

/// How strong a signal arrives.
#[derive(Debug, Clone)]
pub struct RadioModel {
    /// Where its numbers come from.
    pub description: String,
    /// How strength falls.
    pub propagation: &'static dyn Propagation,
    /// Its parameters, in the order of [`Propagation::parameters`].
    pub values: Vec<f64>,
    /// d₀, metres.
    pub reference_distance_m: f64,
    /// Base of the logarithm.
    pub log_base: LogBase,
    /// C: walls beyond so many do not count.
    pub cap: usize,
    /// Materials that have a loss of their own; empty for models that do not ask.
    pub materials: Vec<String>,
    /// Height of a robot's antenna above the floor, metres.
    pub robot_height_m: f64,
    /// Standard deviation of what a place adds, dB: the same for all readings there.
    pub shadowing_sd_db: f64,
    /// Distance at which two places share 1/e of it, metres.
    pub shadowing_distance_m: f64,
    /// Standard deviation of what one reading adds, dB.
    pub fading_sd_db: f64,
    /// Half width of the interval that holds 90 % of the strengths at new places, dB.
    pub interval_90_db: f64,
    /// Mean of all strengths of the log, dBm: the guess that knows nothing.
    pub mean_dbm: f64,
    /// The weakest signal that is received, dBm.
    pub sensitivity_dbm: f64,
    /// Fits of the other models to the same log.
    pub others: Vec<RadioModel>,
}

impl PartialEq for RadioModel {
    fn eq(&self, other: &Self) -> bool {
        self.propagation.name() == other.propagation.name()
            && self.description == other.description
            && self.values == other.values
            && self.log_base == other.log_base
            && (self.cap, &self.materials) == (other.cap, &other.materials)
            && self.others == other.others
            && self.numbers() == other.numbers()
    }
}

/// Weakest signal of commercial receivers, dBm (paper 002, section IV).
pub(super) const SENSITIVITY_DBM: f64 = -92.0;

impl RadioModel {
    /// Table I of paper 002: WAF 7 dB, C 4, n 1, −50 dBm at 2 m; logarithm to base e, with which its table II has distances of 8.5
    /// to 11.5 m (with base 10 they would be 55 to 100 m). The paper states no spread: 0.
    pub fn paper002() -> Self {
        Self {
            description: "paper 002, table I".to_owned(),
            propagation: &Walls,
            values: vec![-50.0, 1.0, 7.0],
            reference_distance_m: 2.0,
            log_base: LogBase::E,
            cap: 4,
            materials: Vec::new(),
            robot_height_m: 0.0,
            shadowing_sd_db: 0.0,
            shadowing_distance_m: 1.0,
            fading_sd_db: 0.0,
            interval_90_db: 0.0,
            mean_dbm: -50.0,
            sensitivity_dbm: SENSITIVITY_DBM,
            others: Vec::new(),
        }
    }

    /// What the propagation model asks of a link.
    pub(super) fn terms(&self, link: &Link) -> Terms<'_> {
        let ratio = link.distance_m / self.reference_distance_m;
        Terms {
            log_distance: self.log_base.log(ratio),
            log10_distance: LogBase::Ten.log(ratio),
            cap: self.cap,
            materials: &self.materials,
        }
    }

    /// What each parameter is multiplied with, and what is added, dB.
    pub(super) fn row(&self, link: &Link) -> (Vec<f64>, f64) {
        let terms = self.terms(link);
        (
            self.propagation.factors(link, &terms),
            self.propagation.fixed_db(link, &terms),
        )
    }

    /// Strength of the signal that arrives on average, dBm.
    pub fn strength_dbm(&self, link: &Link) -> f64 {
        let (factors, fixed_db) = self.row(link);
        fixed_db
            + factors
                .iter()
                .zip(&self.values)
                .map(|(factor, value)| factor * value)
                .sum::<f64>()
    }

    /// The parameters, in the order of `values`.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.propagation.parameters(&self.materials)
    }

    /// A place at the height of a robot's antenna.
    pub fn robot_at(&self, [x_m, y_m]: [f64; 2]) -> [f64; 3] {
        [x_m, y_m, self.robot_height_m]
    }

    fn numbers(&self) -> [(&'static str, f64); 8] {
        [
            ("reference_distance_m", self.reference_distance_m),
            ("robot_height_m", self.robot_height_m),
            ("shadowing_sd_db", self.shadowing_sd_db),
            ("shadowing_distance_m", self.shadowing_distance_m),
            ("fading_sd_db", self.fading_sd_db),
            ("interval_90_db", self.interval_90_db),
            ("mean_dbm", self.mean_dbm),
            ("sensitivity_dbm", self.sensitivity_dbm),
        ]
    }

    /// Checks what no single number says.
    ///
    /// # Errors
    /// Numbers that are not finite, negative spreads, a reference distance that is not positive, another number of values than the
    /// model has parameters.
    pub fn check(&self) -> Result<()> {
        let names: Vec<String> = self.parameters().into_iter().map(|p| p.name).collect();
        if names.len() != self.values.len() {
            return Err(Error::invalid(format!(
                "the model {} has other parameters",
                self.propagation.name()
            ))
            .field("values")
            .found(format!("{} values", self.values.len()))
            .allowed(format!("{}: {}", names.len(), names.join(", "))));
        }
        if let Some(value) = self.values.iter().find(|v| !v.is_finite()) {
            return Err(Error::invalid("not a finite number")
                .field("values")
                .found(value));
        }
        for (field, value) in self.numbers() {
            let (is_sound, allowed) = match field {
                "mean_dbm" | "sensitivity_dbm" => (value.is_finite(), "a finite number"),
                "reference_distance_m" | "shadowing_distance_m" => {
                    (value > 0.0 && value.is_finite(), "above 0")
                }
                _ => (value >= 0.0 && value.is_finite(), "0 or above"),
            };
            if !is_sound {
                return Err(Error::invalid("not a number of a radio model")
                    .field(field)
                    .found(value)
                    .allowed(allowed));
            }
        }
        self.others.iter().try_for_each(Self::check)
    }
}
