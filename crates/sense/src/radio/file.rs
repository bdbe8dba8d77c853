//! The RON form of a radio model.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::model::{LogBase, RadioModel, SENSITIVITY_DBM};
use super::propagation::propagation_by_name;
use realgap_core::error::Result;
use realgap_core::file::{Source, parse_ron, write_ron};

/// A radio model as its file states it.
#[derive(Debug, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Radio")]
pub struct RadioFile {
    /// Where its numbers come from.
    #[serde(default)]
    description: String,
    /// How strength falls, by name; `realgap radio fit --help` lists the models.
    propagation: String,
    /// Its parameters, in the order in which the fit prints them.
    values: Vec<f64>,
    /// Distance d0 of P(d0), metres.
    #[serde(default = "one")]
    reference_distance_m: f64,
    /// Base of the logarithm.
    #[serde(default)]
    log_base: LogBase,
    /// C: walls beyond so many do not count.
    #[serde(default = "unlimited")]
    cap: usize,
    /// Materials that have a loss of their own; none for models that do not ask.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    materials: Vec<String>,
    /// Height of a robot's antenna above the floor, metres.
    #[serde(default)]
    robot_height_m: f64,
    /// Standard deviation of what a place adds, dB: the same for all readings there.
    #[serde(default)]
    shadowing_sd_db: f64,
    /// Distance at which two places share 1/e of it, metres.
    #[serde(default = "one")]
    shadowing_distance_m: f64,
    /// Standard deviation of what one reading adds, dB.
    #[serde(default)]
    fading_sd_db: f64,
    /// Half width of the interval that holds 90 % of the strengths at new places, dB.
    #[serde(default)]
    interval_90_db: f64,
    /// Mean of all strengths of the log, dBm: the guess that knows nothing.
    #[serde(default)]
    mean_dbm: f64,
    /// The weakest signal that is received, dBm.
    #[serde(default = "sensitivity")]
    sensitivity_dbm: f64,
    /// Fits of the other models to the same log.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    others: Vec<OtherFile>,
}

/// A fit of another model to the same log.
#[derive(Debug, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct OtherFile {
    /// How strength falls, by name.
    propagation: String,
    /// Its parameters.
    values: Vec<f64>,
    /// C: walls beyond so many do not count.
    #[serde(default = "unlimited")]
    cap: usize,
    /// Materials that have a loss of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    materials: Vec<String>,
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

impl RadioModel {
    /// Reads a model's file.
    ///
    /// # Errors
    /// A missing file, anything that is not a radio model, and as [`RadioModel::check`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "radio model")?)
    }

    /// The model in a text.
    ///
    /// # Errors
    /// As [`RadioModel::read`].
    pub fn parse(source: &Source) -> Result<Self> {
        let file: RadioFile = parse_ron(source)?;
        let named = |name: &str| {
            propagation_by_name(name).map_err(|e| source.at("propagation", e.field("propagation")))
        };
        let mut model = Self {
            description: file.description,
            propagation: named(&file.propagation)?,
            values: file.values,
            reference_distance_m: file.reference_distance_m,
            log_base: file.log_base,
            cap: file.cap,
            materials: file.materials,
            robot_height_m: file.robot_height_m,
            shadowing_sd_db: file.shadowing_sd_db,
            shadowing_distance_m: file.shadowing_distance_m,
            fading_sd_db: file.fading_sd_db,
            interval_90_db: file.interval_90_db,
            mean_dbm: file.mean_dbm,
            sensitivity_dbm: file.sensitivity_dbm,
            others: Vec::new(),
        };
        model.others = file
            .others
            .into_iter()
            .map(|other| {
                Ok(Self {
                    propagation: named(&other.propagation)?,
                    values: other.values,
                    cap: other.cap,
                    materials: other.materials,
                    ..model.clone()
                })
            })
            .collect::<Result<_>>()?;
        model.check().map_err(|e| {
            let field = e.field_name().unwrap_or_default().to_owned();
            source.at(&field, e)
        })?;
        Ok(model)
    }

    /// The model as a file's text.
    ///
    /// # Errors
    /// None for a model of ours.
    pub fn to_ron(&self) -> Result<String> {
        write_ron(&RadioFile {
            description: self.description.clone(),
            propagation: self.propagation.name().to_owned(),
            values: self.values.clone(),
            reference_distance_m: self.reference_distance_m,
            log_base: self.log_base,
            cap: self.cap,
            materials: self.materials.clone(),
            robot_height_m: self.robot_height_m,
            shadowing_sd_db: self.shadowing_sd_db,
            shadowing_distance_m: self.shadowing_distance_m,
            fading_sd_db: self.fading_sd_db,
            interval_90_db: self.interval_90_db,
            mean_dbm: self.mean_dbm,
            sensitivity_dbm: self.sensitivity_dbm,
            others: self
                .others
                .iter()
                .map(|other| OtherFile {
                    propagation: other.propagation.name().to_owned(),
                    values: other.values.clone(),
                    cap: other.cap,
                    materials: other.materials.clone(),
                })
                .collect(),
        })
    }
}
