//! Fitness as in the papers: the net displacement of the robot, in reality and in the simulated repeats.

use serde::{Deserialize, Serialize};

use super::{CaseRuns, Sample};
use realgap_core::Result;
use realgap_core::statistics::{SampleTest, kolmogorov_smirnov, mann_whitney, mean};

/// Net displacements of the recordings against those of the repeats under noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fitness {
    /// Mean of the recordings, metres.
    pub real_mean_m: f64,
    /// Mean of the repeats, metres.
    pub simulated_mean_m: f64,
    /// Mann–Whitney test: whether one displacement tends to be larger. (Recordings first.)
    pub mann_whitney: SampleTest,
    /// Kolmogorov–Smirnov test: whether the distributions differ.
    pub kolmogorov_smirnov: SampleTest,
}

impl Fitness {
    /// `None` without repeats, or where each recording has its own start.
    ///
    /// # Errors
    /// None for prepared runs.
    pub fn new(real: &[Sample], cases: &[CaseRuns]) -> Result<Option<Self>> {
        let [case] = cases else { return Ok(None) };
        if case.repeats.is_empty() {
            return Ok(None);
        }
        let far_m = |runs: &[Sample]| -> Vec<f64> {
            runs.iter()
                .map(|run| run.prepared.net_displacement_m())
                .collect()
        };
        let (real_m, simulated_m) = (far_m(real), far_m(&case.repeats));
        Ok(Some(Self {
            real_mean_m: mean(&real_m),
            simulated_mean_m: mean(&simulated_m),
            mann_whitney: mann_whitney(&real_m, &simulated_m)?,
            kolmogorov_smirnov: kolmogorov_smirnov(&real_m, &simulated_m)?,
        }))
    }
}
