//! The lines of the protocol (docs/simulator.md): questions, and answers.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::packed::Values;
use realgap_core::unit::Unit;
use realgap_core::{Error, Result};
use realgap_simulation::parameter::Declared;

/// Version of the protocol.
pub const PROTOCOL: u64 = 1;

/// The first question of every worker.
pub const HELLO: &str = r#"{"realgap":1,"ask":"hello"}"#;

/// Who a simulator is: the answer to the first question.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    /// Version of the protocol.
    realgap: u64,
    /// Name of the simulator.
    pub name: String,
    /// Its version, which is part of the fingerprint of results.
    #[serde(default)]
    pub version: String,
    /// Its parameters.
    pub parameters: Vec<ParameterDeclaration>,
    /// Settings that may be exchanged without changing the answer, e.g. timesteps; the first is its own.
    #[serde(default)]
    pub settings: Vec<serde_json::Map<String, serde_json::Value>>,
    /// Body length of the robot, metres, for the metric `pose`.
    pub body_length_m: Option<f64>,
}

/// A parameter of a simulator.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterDeclaration {
    /// Its name.
    pub name: String,
    /// Its unit; dimensionless where it is left out.
    #[serde(default)]
    pub unit: String,
    /// Lowest allowed value.
    pub from: f64,
    /// Highest allowed value.
    pub to: f64,
    /// Its value where the study states none.
    pub default: f64,
    /// What is known beforehand: median and standard deviation.
    pub prior: Option<(f64, f64)>,
    /// Whether ratios count and not differences: a search then takes equal ratios.
    #[serde(default)]
    pub log: bool,
    /// Its meaning, in one sentence.
    #[serde(default)]
    pub about: String,
}

impl Hello {
    /// Reads the answer to the first question.
    pub(crate) fn parse(line: &str) -> Result<Self> {
        let wrong = |why: String| {
            Error::invalid(format!("the simulator does not say who it is as the protocol asks: {why}"))
                .field("simulator")
                .allowed(r#"{"realgap": 1, "name": "...", "parameters": [{"name": "...", "unit": "...", "from": 0, "to": 1, "default": 0.5}]}"#)
        };
        let hello: Self = serde_json::from_str(line).map_err(|error| wrong(error.to_string()))?;
        if hello.realgap != PROTOCOL {
            return Err(
                Error::invalid("the simulator speaks another version of the protocol")
                    .field("simulator")
                    .found(hello.realgap)
                    .allowed(PROTOCOL),
            );
        }
        for (index, parameter) in hello.parameters.iter().enumerate() {
            parameter.check()?;
            if hello.parameters[..index]
                .iter()
                .any(|other| other.name == parameter.name)
            {
                return Err(wrong(format!(
                    "two parameters are called `{}`",
                    parameter.name
                )));
            }
        }
        if hello
            .body_length_m
            .is_some_and(|m| !(m > 0.0 && m.is_finite()))
        {
            return Err(wrong("body_length_m is not above 0".to_owned()));
        }
        Ok(hello)
    }
}

/// How exactly a shortened timestep has to be the asked share of the usual one.
const SAME_SHARE: f64 = 1e-6;

impl Hello {
    /// The setting that differs from the first one in a single number, which is shorter by this factor: a timestep.
    pub(crate) fn refined(&self, factor: f64) -> Option<usize> {
        let (first, others) = self.settings.split_first()?;
        let is_shorter = |setting: &serde_json::Map<String, serde_json::Value>| {
            let mut differing = first
                .iter()
                .filter(|(key, value)| setting.get(*key) != Some(value));
            let (Some((key, value)), None) = (differing.next(), differing.next()) else {
                return false;
            };
            let usual = value.as_f64();
            let own = setting.get(key).and_then(serde_json::Value::as_f64);
            let is_share = |(usual, own): (f64, f64)| {
                usual > 0.0 && (own / usual - factor).abs() < SAME_SHARE * factor
            };
            setting.len() == first.len() && usual.zip(own).is_some_and(is_share)
        };
        Some(1 + others.iter().position(is_shorter)?)
    }
}

impl ParameterDeclaration {
    fn check(&self) -> Result<()> {
        let wrong = |why: &str| {
            Error::invalid(format!("the simulator declares a parameter {why}"))
                .field(format!("simulator: {}", self.name))
        };
        if self.declared().name.is_empty()
            || realgap_simulation::parameter::by_name(&format!("sim.{}", self.name)).is_err()
        {
            return Err(wrong("whose name cannot be written in a study")
                .found(format!("{:?}", self.name))
                .allowed("letters, digits, `_`, `-`, `.`, `*`, at most 200"));
        }
        let is_finite = [self.from, self.to, self.default]
            .iter()
            .all(|v| v.is_finite());
        if !is_finite || self.from >= self.to || !(self.from..=self.to).contains(&self.default) {
            return Err(wrong("whose range or default is none")
                .found(format!(
                    "from {} to {}, default {}",
                    self.from, self.to, self.default
                ))
                .allowed("from < to, and a default between them"));
        }
        if self.log && self.from <= 0.0 {
            return Err(wrong("with ratios from 0 or below")
                .found(self.from)
                .allowed("from > 0"));
        }
        Ok(())
    }

    /// The declaration as the registry of parameters takes it.
    pub fn declared(&self) -> Declared {
        Declared {
            name: self.name.clone(),
            unit: Unit::named(&self.unit),
            bounds: (self.from, self.to),
            is_logarithmic: self.log,
            about: match self.about.is_empty() {
                true => "A parameter of the study's own simulator.".to_owned(),
                false => self.about.clone(),
            },
        }
    }
}

/// The question for a run.
#[derive(Debug, Serialize)]
pub(crate) struct RunQuestion<'a> {
    pub ask: &'static str,
    pub id: u64,
    pub parameters: BTreeMap<&'a str, f64>,
    pub units: BTreeMap<&'a str, &'a str>,
    pub seed: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setting: Option<&'a serde_json::Map<String, serde_json::Value>>,
    pub duration_s: f64,
    pub times_s: &'a [f64],
    pub recording: &'a str,
    pub start: BTreeMap<&'a str, f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commands: Option<CommandsAsked<'a>>,
}

/// The recorded commands of a run.
#[derive(Debug, Serialize)]
pub(crate) struct CommandsAsked<'a> {
    pub times_s: &'a [f64],
    pub channels: BTreeMap<&'a str, &'a [f64]>,
}

/// The answer to a run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunAnswer {
    #[expect(dead_code, reason = "the worker has looked at it")]
    id: u64,
    /// Times of the samples; the asked ones where they are left out.
    pub times_s: Option<Values>,
    /// Values of each channel at these times, by the names of recorded columns.
    #[serde(default)]
    pub channels: BTreeMap<String, Values>,
    /// A file with the channels in place of them.
    pub file: Option<PathBuf>,
    /// Why the run has no result.
    pub failed: Option<String>,
}
