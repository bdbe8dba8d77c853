//! Simulation confidence over time.

use serde::Serialize;

use super::over_time::times_s;
use super::sample::{CaseRuns, Sample};
use crate::ensemble::{Envelope, LEVELS};
use crate::error::Result;
use crate::statistic::{Proportion, mean};
use crate::trajectory::{POINTS, Prepared};

/// Which of the ensemble's [`LEVELS`] the region has: 90 %.
pub const LEVEL_INDEX: usize = 2;
/// Below this share of real runs a simulation predicts less than it misses.
const HALF: f64 = 0.5;
/// Level of the intervals.
const INTERVAL: f64 = 0.95;

/// Simulation confidence C(t): the probability that a real run lies, at time t, inside the region that should hold 90 % of further
/// repeats of the simulated ensemble.
///
/// An ensemble that tells the truth has C(t) near 0.9 at all times; one that is off, or too sure of itself, drops.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confidence {
    /// What the region promises.
    pub level: f64,
    /// Times, seconds from the start.
    pub times_s: Vec<f64>,
    /// At each time, which share of the recordings lies inside, with its 95 % Wilson interval.
    pub inside: Vec<Proportion>,
    /// Mean of C(t) over time.
    pub over_time: f64,
    /// First time at which fewer than half of the recordings lie inside; `None`: never.
    pub below_half_s: Option<f64>,
}

impl Confidence {
    /// C(t) of the repeats of `cases`; `None` where a start has no repeats.
    ///
    /// # Errors
    /// A body length that is not positive.
    pub fn new(real: &[Sample], cases: &[CaseRuns], body_length_m: f64) -> Result<Option<Self>> {
        if cases.is_empty() || cases.iter().any(|case| case.repeats.is_empty()) {
            return Ok(None);
        }
        let mut counts = vec![0; POINTS];
        let mut trials = 0;
        for case in cases {
            let repeats: Vec<&Prepared> = case.repeats.iter().map(|r| &r.prepared).collect();
            let duration_s = case.repeats[0].motion.duration_s();
            let envelope = Envelope::new(&repeats, duration_s, body_length_m)?;
            let here: Vec<&Prepared> = case
                .recordings
                .iter()
                .map(|&recording| &real[recording].prepared)
                .collect();
            trials += here.len();
            for (count, inside) in counts.iter_mut().zip(envelope.inside(LEVEL_INDEX, &here)) {
                *count += inside;
            }
        }
        let inside: Vec<Proportion> = counts
            .iter()
            .map(|&count| Proportion::new(count, trials, INTERVAL))
            .collect();
        let times_s = times_s(real);
        let shares: Vec<f64> = inside.iter().map(|p| p.share).collect();
        let below_half_s = shares
            .iter()
            .position(|share| *share < HALF)
            .map(|at| times_s[at]);
        Ok(Some(Self {
            level: LEVELS[LEVEL_INDEX],
            times_s,
            over_time: mean(&shares),
            inside,
            below_half_s,
        }))
    }
}
