//! Who says what an engine outside of the program would do: MuJoCo itself, or a table of what it did with other robots.

mod ask;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use ask::Mujoco;

use super::OtherEngine;
use super::ensemble::Ensemble;
use super::other_engine::OwnEngines;
use realgap_core::unit::{Unit, quantity};
use realgap_core::{Error, Result};
use realgap_optimization::RunOptions;
use realgap_simulation::Experiment;

/// Who is asked what an engine outside of the program would do.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ThirdOpinion {
    /// The table of what MuJoCo did with other robots, which is part of the program.
    #[default]
    Table,
    /// MuJoCo itself; the table where it cannot answer.
    Mujoco(Mujoco),
    /// MuJoCo itself; an error where it cannot answer.
    OnlyMujoco(Mujoco),
}

/// Who said what another engine would do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Teller {
    /// MuJoCo, which ran this robot.
    Mujoco,
    /// The table of what MuJoCo did with other robots.
    Table,
}

/// Who said what another engine would do, and from what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OpinionSource {
    /// Who it was.
    pub by: Teller,
    /// Version of MuJoCo, where it was asked: another version may give other numbers.
    pub mujoco_version: Option<String>,
    /// Net displacements in MuJoCo, one for each of the first repeats, metres; empty where it was not asked.
    pub runs_m: Vec<f64>,
    /// Why MuJoCo did not answer; `None` where it did, and where nobody asked it.
    pub not_asked: Option<String>,
}

impl fmt::Display for OpinionSource {
    /// `asked MuJoCo 4.0.0: 12 runs of 29.4 cm to 30.7 cm`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.by {
            Teller::Mujoco => {
                let version = self.mujoco_version.as_deref().unwrap_or_default();
                let ends = self.runs_m.iter().copied();
                let [low, high] = [ends.clone().reduce(f64::min), ends.reduce(f64::max)]
                    .map(|m| quantity(m.unwrap_or_default(), Unit::Metre));
                let runs = self.runs_m.len();
                write!(f, "asked MuJoCo {version}: {runs} runs of {low} to {high}")
            }
            Teller::Table => {
                let robots = OtherEngine::robots();
                write!(f, "learned from {robots} other robots in MuJoCo")?;
                match &self.not_asked {
                    Some(why) => write!(f, "; {why}"),
                    None => Ok(()),
                }
            }
        }
    }
}

impl ThirdOpinion {
    /// What another engine would do with the robot of these repeats, and who says so.
    ///
    /// # Errors
    /// MuJoCo alone may answer and cannot, or the run is stopped.
    pub(super) fn of(
        &self,
        experiment: &Experiment,
        ensemble: &Ensemble,
        known: &OwnEngines,
        run: &RunOptions<'_>,
    ) -> Result<(OtherEngine, OpinionSource)> {
        let learned = |not_asked| {
            let source = OpinionSource {
                by: Teller::Table,
                mujoco_version: None,
                runs_m: Vec::new(),
                not_asked,
            };
            (OtherEngine::new(known), source)
        };
        let mujoco = match self {
            Self::Table => return Ok(learned(None)),
            Self::Mujoco(mujoco) | Self::OnlyMujoco(mujoco) => mujoco,
        };
        match (mujoco.ask(experiment, ensemble, run)?, self) {
            (Ok(asked), _) => {
                let other = OtherEngine::asked(known, &asked.runs_m);
                let source = OpinionSource {
                    by: Teller::Mujoco,
                    mujoco_version: Some(asked.version),
                    runs_m: asked.runs_m,
                    not_asked: None,
                };
                Ok((other, source))
            }
            (Err(why), Self::OnlyMujoco(_)) => Err(Error::invalid(why)
                .hint("install it (`python3 -m pip install mujoco`), name a Python that has it, or use the table of other robots")),
            (Err(why), _) => Ok(learned(Some(why))),
        }
    }
}
