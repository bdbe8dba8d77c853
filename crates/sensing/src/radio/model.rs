//! The radio model: a propagation model with its parameters, and the variation of strengths about it.

use serde::{Deserialize, Serialize};

use super::link::Link;
use super::propagation::{Parameter, Propagation, Terms, Walls};
use realgap_core::error::{Error, Result};
use realgap_core::range::Range;

/// Base of the logarithm of distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LogBase {
    /// Base 10, which is common.
    #[default]
    Ten,
    /// Base e, which is needed for the numbers of paper 002.
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

/// A model of the strength of received signals. Its file has the same fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Radio")]
pub struct RadioModel {
    /// Source of the numbers.
    #[serde(default)]
    pub description: String,
    /// Name of the propagation model; `realgap sense radio fit --help` lists the models.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub propagation: &'static dyn Propagation,
    /// Parameters of the propagation model, in the order in which the fit prints them.
    pub values: Vec<f64>,
    /// Reference distance d0 of P(d0), metres.
    #[serde(default = "one")]
    pub reference_distance_m: f64,
    /// Base of the logarithm.
    #[serde(default)]
    pub log_base: LogBase,
    /// C, the largest number of walls that count.
    #[serde(default = "unlimited")]
    pub cap: usize,
    /// Materials whose losses are parameters; empty for propagation models that do not use materials.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<String>,
    /// Height of a robot's antenna above the floor, metres.
    #[serde(default)]
    pub robot_height_m: f64,
    /// Standard deviation of shadowing, dB; shadowing is the same for all readings at a place.
    #[serde(default)]
    pub shadowing_sd_db: f64,
    /// Correlation distance of shadowing, at which its correlation is 1/e, metres.
    #[serde(default = "one")]
    pub shadowing_distance_m: f64,
    /// Standard deviation of fading, which differs between readings, dB.
    #[serde(default)]
    pub fading_sd_db: f64,
    /// Half width of the interval that contains 90 % of the strengths at new places, dB.
    #[serde(default)]
    pub interval_90_db: f64,
    /// Mean of all strengths of the log, dBm: the baseline that uses neither distance nor walls.
    #[serde(default)]
    pub mean_dbm: f64,
    /// The weakest signal that is received, dBm.
    #[serde(default = "sensitivity")]
    pub sensitivity_dbm: f64,
    /// Fits of the other models to the same log.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<OtherFit>,
}

/// A fit of another model to the same log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct OtherFit {
    /// Name of the propagation model.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub propagation: &'static dyn Propagation,
    /// Parameters of the propagation model.
    pub values: Vec<f64>,
    /// C, the largest number of walls that count.
    #[serde(default = "unlimited")]
    pub cap: usize,
    /// Materials whose losses are parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<String>,
}

fn one() -> f64 {
    1.0
}

fn unlimited() -> usize {
    1000
}

fn sensitivity() -> f64 {
    SENSITIVITY_DBM
}

/// Weakest signal of commercial receivers, dBm (paper 002, section IV).
pub(super) const SENSITIVITY_DBM: f64 = -92.0;

realgap_core::ron_file!(RadioModel, "radio model");

impl RadioModel {
    /// This model with the propagation model and parameters of another fit to the same log.
    pub(super) fn with(&self, other: &OtherFit) -> Self {
        Self {
            propagation: other.propagation,
            values: other.values.clone(),
            cap: other.cap,
            materials: other.materials.clone(),
            others: Vec::new(),
            ..self.clone()
        }
    }

    /// Table I of paper 002: WAF 7 dB, C 4, n 1, −50 dBm at 2 m; logarithm to base e, with which the strengths of its table II correspond
    /// to distances of 8.5 to 11.5 m (with base 10, to 55 to 100 m). The paper states no shadowing or fading, so both are 0.
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

    /// The quantities of a link that the propagation model needs.
    pub(super) fn terms(&self, link: &Link) -> Terms<'_> {
        let ratio = link.distance_m / self.reference_distance_m;
        Terms {
            log_distance: self.log_base.log(ratio),
            log10_distance: LogBase::Ten.log(ratio),
            cap: self.cap,
            materials: &self.materials,
        }
    }

    /// The factor of each parameter, and the term that does not depend on parameters, dB.
    pub(super) fn row(&self, link: &Link) -> (Vec<f64>, f64) {
        let terms = self.terms(link);
        (
            self.propagation.factors(link, &terms),
            self.propagation.fixed_db(link, &terms),
        )
    }

    /// Mean strength of the received signal, dBm.
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

    /// The position of a robot's antenna, for a robot at this position.
    pub fn robot_at(&self, [x_m, y_m]: [f64; 2]) -> [f64; 3] {
        [x_m, y_m, self.robot_height_m]
    }

    /// Checks that the numbers of the model are consistent.
    ///
    /// # Errors
    /// Numbers that are not finite, negative standard deviations, a reference distance that is not positive, a number of values that
    /// differs from the number of parameters.
    pub fn check(&self) -> Result<()> {
        let names: Vec<String> = self.parameters().into_iter().map(|p| p.name).collect();
        if names.len() != self.values.len() {
            return Err(Error::invalid(format!(
                "wrong number of values for the model {}",
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
        let of = |low: f64, unit: &'static str| Range::within(low, 1e9, unit);
        let length = Range::above(0.0, 1e9, "m");
        for (field, value, range) in [
            ("reference_distance_m", self.reference_distance_m, length),
            ("robot_height_m", self.robot_height_m, of(0.0, "m")),
            ("shadowing_sd_db", self.shadowing_sd_db, of(0.0, "dB")),
            ("shadowing_distance_m", self.shadowing_distance_m, length),
            ("fading_sd_db", self.fading_sd_db, of(0.0, "dB")),
            ("interval_90_db", self.interval_90_db, of(0.0, "dB")),
            ("mean_dbm", self.mean_dbm, of(-1e9, "dBm")),
            ("sensitivity_dbm", self.sensitivity_dbm, of(-1e9, "dBm")),
        ] {
            range.check(value, field)?;
        }
        self.others.iter().try_for_each(|o| self.with(o).check())
    }
}
