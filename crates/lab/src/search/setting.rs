//! In which settings of engine and steps the repeats of a robot run.

use serde::{Deserialize, Serialize};

/// The settings of the repeats that a robot is judged by in a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SettingsChoice {
    /// All repeats run in the engine that explores, with the steps of the search.
    #[default]
    One,
    /// Every repeat has its own of the settings that nobody can choose between by reason: both engines in turn, and in each steps that
    /// are up to twice as fine. Who walks in one of them only is no walker.
    EquallyValid,
}
