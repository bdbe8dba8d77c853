//! Simulation confidence over time: the share of recordings inside of a region of the repeats.

use serde::{Deserialize, Serialize};

use super::over_time::times_s;
use super::{CaseRuns, Sample};
use crate::prediction::ensemble::{Envelope, LEVELS};
use realgap_core::Result;
use realgap_core::statistics::{Proportion, mean_of};
use realgap_path::trajectory::{POINTS, Prepared};

/// Index of the region's level in the ensemble's [`LEVELS`]: 90 %.
pub(crate) const LEVEL_INDEX: usize = 2;
/// Below this share of real runs more recordings lie outside of the region than inside.
const HALF: f64 = 0.5;
/// Level of the intervals.
const INTERVAL: f64 = 0.95;

/// Simulation confidence C(t): the probability that a real run lies, at time t, inside the region that should hold 90 % of
/// further repeats of the simulated ensemble.
///
/// For a calibrated ensemble, C(t) is near 0.9 at all times; C(t) drops where the ensemble is biased or too narrow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Confidence {
    /// Stated probability of the region.
    pub level: f64,
    /// Times, seconds from the start.
    pub times_s: Vec<f64>,
    /// At each time, which share of the recordings lies inside, with its 95 % Wilson interval.
    pub inside: Vec<Proportion>,
    /// Mean of C(t) over time.
    pub over_time: f64,
    /// Its 95 % interval, with each recording as one trial, because the samples of one recording are strongly correlated.
    pub over_time_interval: (f64, f64),
    /// First time at which fewer than half of the recordings lie inside; `None` for never. With few recordings C(t) may be low at
    /// one time by chance.
    pub below_half_s: Option<f64>,
    /// First time at which the whole interval lies below one half; `None` for never.
    pub surely_below_half_s: Option<f64>,
}

impl Confidence {
    /// Lower ends, C(t) and upper ends over time.
    pub fn curves(&self) -> [Vec<f64>; 3] {
        let of = |value: fn(&Proportion) -> f64| self.inside.iter().map(value).collect();
        [of(|p| p.low), of(|p| p.share), of(|p| p.high)]
    }

    /// The time at which it drops, in words.
    pub fn drop_in_words(&self) -> String {
        match (self.below_half_s, self.surely_below_half_s) {
            (None, _) => "never under 50 %".to_owned(),
            (Some(first_s), None) => {
                format!("under 50 % first at {first_s:.2} s, which may be chance")
            }
            (Some(first_s), Some(surely_s)) => {
                format!("under 50 % first at {first_s:.2} s, surely at {surely_s:.2} s")
            }
        }
    }

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
            let here = case.recordings.iter().map(|&r| &real[r].prepared);
            let here: Vec<&Prepared> = here.collect();
            trials += here.len();
            for (count, inside) in counts.iter_mut().zip(envelope.inside(LEVEL_INDEX, &here)) {
                *count += inside;
            }
        }
        let inside = counts
            .iter()
            .map(|&count| Proportion::new(count, trials, INTERVAL));
        let inside: Vec<Proportion> = inside.collect();
        let times_s = times_s(real);
        let over_time = mean_of(inside.iter().map(|p| p.share));
        let first_s = |of: &dyn Fn(&Proportion) -> f64| {
            let at = inside.iter().position(|p| of(p) < HALF)?;
            Some(times_s[at])
        };
        Ok(Some(Self {
            level: LEVELS[LEVEL_INDEX],
            below_half_s: first_s(&|p| p.share),
            surely_below_half_s: first_s(&|p| p.high),
            times_s,
            over_time,
            over_time_interval: Proportion::interval_of(over_time, trials, INTERVAL),
            inside,
        }))
    }
}
