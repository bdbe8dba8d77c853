//! The settings of engine and steps in which the repeats of a robot run.

use serde::{Deserialize, Serialize};

/// The settings of the repeats by which a robot is judged in a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SettingsChoice {
    /// All repeats run in the engine that explores, with the steps of the search.
    #[default]
    One,
    /// Every repeat has its own one of the equally valid settings: both engines take turns, and each has steps that are up to
    /// twice as fine. A robot that walks in one engine only gets a low fitness.
    EquallyValid,
}
