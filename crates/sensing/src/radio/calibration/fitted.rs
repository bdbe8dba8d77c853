//! The result of fitting a radio model, with intervals and the candidates that were tried.

use std::fmt;

use serde::Serialize;

use crate::radio::model::RadioModel;
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::unit::{counted, number};
use realgap_core::warning::Warning;

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedParameter {
    /// Name of the parameter.
    pub name: String,
    /// Unit of the parameter; empty for a parameter without unit.
    pub unit: &'static str,
    /// Value of the parameter.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Whether the log determines the parameter: its interval does not contain 0 and is narrower than the value (for a loss or an
    /// exponent) or than 10 dB (for a strength).
    pub determined: bool,
    /// The reason why the parameter is not determined.
    pub why: Option<String>,
}

/// A propagation model that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Name of the propagation model.
    pub propagation: &'static str,
    /// Largest number of walls that count; `None` for models without walls.
    pub cap: Option<usize>,
    /// Root mean square error at left-out places, dB.
    pub left_out_rmse_db: f64,
    /// Whether the model is not significantly worse than the best: the mean squares at places differ by less than two standard
    /// errors.
    pub as_good: bool,
}

/// A radio model that was fitted to a log, with the statistics of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedRadio {
    /// The model.
    #[serde(skip)]
    pub model: RadioModel,
    /// Name of the propagation model.
    pub propagation: &'static str,
    /// Formula of the propagation model.
    pub formula: &'static str,
    /// Base of the logarithm in the formula, `10` or `e`.
    pub log_base: &'static str,
    /// Reference distance, at which the first parameter is the strength, metres.
    pub reference_distance_m: f64,
    /// Parameters of the propagation model.
    pub parameters: Vec<FittedParameter>,
    /// C, the largest number of walls that count; `None` for models without walls.
    pub cap: Option<usize>,
    /// All models that were tried, best first.
    pub candidates: Vec<Candidate>,
    /// Root mean square error at left-out places, dB.
    pub left_out_rmse_db: f64,
    /// Root mean square error on the log itself, dB.
    pub rmse_db: f64,
    /// Standard deviation of shadowing, dB.
    pub shadowing_sd_db: f64,
    /// Correlation distance of shadowing, at which its correlation is 1/e, metres.
    pub shadowing_distance_m: f64,
    /// Standard deviation of fading, dB.
    pub fading_sd_db: f64,
    /// Half width of the interval that contains 90 % of strengths at new places, dB.
    pub interval_90_db: f64,
    /// Number of strengths of the log.
    pub readings: usize,
    /// Number of missing strengths.
    pub missing: usize,
    /// Number of places (squares of one metre) of the log.
    pub places: usize,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

impl fmt::Display for FittedRadio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} at {} ({} missing)\n",
            counted(self.readings, "strength"),
            counted(self.places, "place"),
            self.missing
        )?;
        let tried = TextTable::of(
            &self.candidates,
            &[
                ("model", Left, &|c| c.propagation.to_owned()),
                ("walls that count", Right, &|c| {
                    c.cap.map_or(String::new(), |cap| cap.to_string())
                }),
                ("error at left-out places", Right, &|c| {
                    format!("{:.2} dB", c.left_out_rmse_db)
                }),
                ("", Left, &|c| match c.as_good {
                    true => "not significantly worse than the best".to_owned(),
                    false => String::new(),
                }),
            ],
        );
        writeln!(f, "{}", tried.render(false))?;
        writeln!(
            f,
            "{}: {}\n  (log to base {}, d0 = {} m{})\n",
            self.propagation,
            self.formula,
            self.log_base,
            self.reference_distance_m,
            self.cap.map_or(String::new(), |cap| format!(", C = {cap}"))
        )?;
        let table = TextTable::of(
            &self.parameters,
            &[
                ("parameter", Left, &|p| p.name.clone()),
                ("value", Right, &|p| {
                    format!("{} {}", number(p.value), p.unit)
                        .trim_end()
                        .to_owned()
                }),
                ("90 % interval", Left, &|p| {
                    format!("{} to {}", number(p.low), number(p.high))
                }),
                ("", Left, &|p| match &p.why {
                    Some(why) => format!("not determined: {why}"),
                    None => "determined".to_owned(),
                }),
            ],
        );
        writeln!(f, "{}", table.render(false))?;
        writeln!(
            f,
            "error {:.2} dB on the log, {:.2} dB at left-out places; 90 % of the strengths at new places within {:.1} dB",
            self.rmse_db, self.left_out_rmse_db, self.interval_90_db
        )?;
        write!(
            f,
            "shadowing {:.1} dB (correlation distance {:.1} m), fading {:.1} dB",
            self.shadowing_sd_db, self.shadowing_distance_m, self.fading_sd_db
        )
    }
}
