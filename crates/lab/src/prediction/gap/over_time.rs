//! Errors over time, in the prepared frame.

use serde::{Deserialize, Serialize};

use super::{CaseRuns, Sample};
use realgap_path::trajectory::{POINTS, Prepared};

/// Gives the predicted position of a recording, from its case, its index and the number of a prepared time.
type Predicted<'a> = dyn Fn(&CaseRuns, usize, usize) -> Option<[f64; 2]> + 'a;

/// Root mean square distance from the recordings at each of the 182 prepared times (paper 000, section on the two-wheel robot,
/// figure 7 b: the error of ideal and simulated coordinates over time).
///
/// The distance is in the plane, and it is a mean over the recordings. All paths are in the prepared frame, so that only the
/// shape of a path over time matters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OverTime {
    /// Times, seconds from the start; those of a recording of mean duration where the durations differ.
    pub times_s: Vec<f64>,
    /// The run without noise, metres.
    pub ideal_m: Option<Vec<f64>>,
    /// The mean position of the repeats under noise, metres.
    pub simulated_mean_m: Option<Vec<f64>>,
    /// The mean position of the OTHER recordings, metres: the error of the best prediction that can be made from these
    /// recordings. `None` for one recording, or where each has its own start.
    pub real_mean_m: Option<Vec<f64>>,
}

impl OverTime {
    /// Errors over time of the simulations of `cases`.
    pub fn new(real: &[Sample], cases: &[CaseRuns]) -> Self {
        let rmse = |predicted: &Predicted<'_>| {
            (0..POINTS)
                .map(|at| {
                    let (mut sum, mut count) = (0.0, 0);
                    for case in cases {
                        for &recording in &case.recordings {
                            let p = predicted(case, recording, at)?;
                            let r = real[recording].prepared.xy_m()[at];
                            sum += (p[0] - r[0]).powi(2) + (p[1] - r[1]).powi(2);
                            count += 1;
                        }
                    }
                    (count > 0).then(|| (sum / f64::from(count)).sqrt())
                })
                .collect()
        };
        let one_start = cases.len() == 1;
        Self {
            times_s: times_s(real),
            ideal_m: rmse(&|case, _, at| Some(case.ideal.as_ref()?.prepared.xy_m()[at])),
            simulated_mean_m: rmse(&|case, _, at| {
                mean_xy_m(case.repeats.iter().map(|r| &r.prepared), at)
            }),
            real_mean_m: rmse(&|case, recording, at| {
                let others = case.recordings.iter().filter(|&&other| other != recording);
                one_start
                    .then(|| mean_xy_m(others.map(|&other| &real[other].prepared), at))
                    .flatten()
            }),
        }
    }
}

/// The prepared times, seconds; of the mean duration where the recordings' durations differ.
pub(super) fn times_s(real: &[Sample]) -> Vec<f64> {
    let durations = real.iter().map(|run| run.motion.duration_s());
    let duration_s = durations.sum::<f64>() / real.len() as f64;
    (0..POINTS)
        .map(|at| duration_s * at as f64 / (POINTS - 1) as f64)
        .collect()
}

fn mean_xy_m<'a>(paths: impl Iterator<Item = &'a Prepared>, at: usize) -> Option<[f64; 2]> {
    let (mut sum, mut count) = ([0.0; 2], 0);
    for path in paths {
        let point = path.xy_m()[at];
        sum = [sum[0] + point[0], sum[1] + point[1]];
        count += 1;
    }
    (count > 0).then(|| sum.map(|v| v / f64::from(count)))
}
