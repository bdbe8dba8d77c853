//! What a fit of a radio model found, and what speaks for it.

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
    /// Its name.
    pub name: String,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Where its 90 % interval begins.
    pub low: f64,
    /// Where that interval ends.
    pub high: f64,
    /// Whether the log says what it is: an interval narrower than the value (a loss, an exponent) or than 10 dB (a strength), and
    /// without 0.
    pub determined: bool,
    /// This says why it is not determined.
    pub why: Option<String>,
}

/// A model that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Its name.
    pub propagation: &'static str,
    /// Walls that count at most; `None` for models without walls.
    pub cap: Option<usize>,
    /// Root mean square error at places that were left out, dB.
    pub left_out_rmse_db: f64,
    /// Whether it cannot be told from the best: places' mean squares differ by less than two standard errors.
    pub as_good: bool,
}

/// A log as a radio model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedRadio {
    /// The model.
    #[serde(skip)]
    pub model: RadioModel,
    /// Its name.
    pub propagation: &'static str,
    /// Its formula.
    pub formula: &'static str,
    /// Base of the logarithm in it, `10` or `e`.
    pub log_base: &'static str,
    /// Distance at which its first parameter holds, metres.
    pub reference_distance_m: f64,
    /// Its parameters.
    pub parameters: Vec<FittedParameter>,
    /// C; `None` for models without walls.
    pub cap: Option<usize>,
    /// Everything that was tried, best first.
    pub candidates: Vec<Candidate>,
    /// Root mean square error at places that were left out, dB.
    pub left_out_rmse_db: f64,
    /// Root mean square error on the log itself, dB.
    pub rmse_db: f64,
    /// Standard deviation of what a place adds, dB.
    pub shadowing_sd_db: f64,
    /// Distance at which places share 1/e of it, metres.
    pub shadowing_distance_m: f64,
    /// Standard deviation of what a reading adds, dB.
    pub fading_sd_db: f64,
    /// Half width of the interval for 90 % of strengths at new places, dB.
    pub interval_90_db: f64,
    /// Strengths of the log.
    pub readings: usize,
    /// Strengths that are missing.
    pub missing: usize,
    /// Places (squares of one metre) of the log.
    pub places: usize,
    /// What the reader should know.
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
                ("error at places left out", Right, &|c| {
                    format!("{:.2} dB", c.left_out_rmse_db)
                }),
                ("", Left, &|c| match c.as_good {
                    true => "cannot be told from the best".to_owned(),
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
            "error {:.2} dB on the log, {:.2} dB at places left out; 90 % of strengths elsewhere within {:.1} dB",
            self.rmse_db, self.left_out_rmse_db, self.interval_90_db
        )?;
        write!(
            f,
            "a place adds {:.1} dB (alike within {:.1} m), a reading {:.1} dB",
            self.shadowing_sd_db, self.shadowing_distance_m, self.fading_sd_db
        )
    }
}
