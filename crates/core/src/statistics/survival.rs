//! Survival analysis: durations of which some are censored, that is, only known to be longer than a time.

use serde::Serialize;
use statrs::function::erf::erfc;

use super::proportion::normal_quantile;
use super::significance::SampleTest;
use crate::error::{Error, Result};

/// The duration of a task, or a time that the task took longer than.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Duration {
    /// Seconds, above 0.
    pub time_s: f64,
    /// True if the task was finished at this time; false if it was given up at this time (censored).
    pub finished: bool,
}

/// The share of tasks that are not finished yet, over time (Kaplan & Meier 1958).
///
/// ```
/// use realgap_core::statistics::{Duration, KaplanMeier};
///
/// let of = |time_s, finished| Duration { time_s, finished };
/// let curve = KaplanMeier::new(&[of(1.0, true), of(2.0, false), of(3.0, true)])?;
/// assert!((curve.share(1.5) - 2.0 / 3.0).abs() < 1e-12);
/// assert_eq!(curve.share(3.0), 0.0);
/// assert_eq!(curve.median_s(), Some(3.0));
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KaplanMeier {
    /// Times at which a task was finished, seconds, increasing.
    pub times_s: Vec<f64>,
    /// The share that is not finished right after each of these times.
    pub shares: Vec<f64>,
    /// The sum Σ d / (n (n − d)) of Greenwood's formula up to each time; infinite if no task is left.
    greenwood: Vec<f64>,
}

fn check(durations: &[Duration]) -> Result<()> {
    if durations.is_empty() {
        return Err(Error::invalid("there are no durations"));
    }
    if let Some(wrong) = durations
        .iter()
        .find(|d| !(d.time_s > 0.0 && d.time_s.is_finite()))
    {
        return Err(Error::invalid("not a duration")
            .found(wrong.time_s)
            .allowed("seconds above 0"));
    }
    Ok(())
}

/// Each time at which tasks were finished, with the number of tasks finished then, and the number still running just before (at risk).
fn counts(durations: &[Duration]) -> Vec<(f64, f64, f64)> {
    let mut times: Vec<f64> = durations
        .iter()
        .filter(|d| d.finished)
        .map(|d| d.time_s)
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let of = |time: f64| {
        let finished = durations
            .iter()
            .filter(|d| d.finished && d.time_s == time)
            .count();
        let at_risk = durations.iter().filter(|d| d.time_s >= time).count();
        (time, finished as f64, at_risk as f64)
    };
    times.into_iter().map(of).collect()
}

impl KaplanMeier {
    /// The survival curve of some durations.
    ///
    /// # Errors
    /// No durations, a duration that is not above 0.
    pub fn new(durations: &[Duration]) -> Result<Self> {
        check(durations)?;
        let (mut share, mut sum) = (1.0, 0.0);
        let mut curve = Self {
            times_s: Vec::new(),
            shares: Vec::new(),
            greenwood: Vec::new(),
        };
        for (time, finished, at_risk) in counts(durations) {
            share *= 1.0 - finished / at_risk;
            sum += finished / (at_risk * (at_risk - finished));
            curve.times_s.push(time);
            curve.shares.push(share);
            curve.greenwood.push(sum);
        }
        Ok(curve)
    }

    /// The share that is not finished right after a time.
    pub fn share(&self, time_s: f64) -> f64 {
        match self.times_s.partition_point(|t| *t <= time_s) {
            0 => 1.0,
            after => self.shares[after - 1],
        }
    }

    /// The first time at which a share of `level` of the tasks is finished; `None` if the share is never reached.
    pub fn quantile_s(&self, level: f64) -> Option<f64> {
        let at = self
            .shares
            .iter()
            .position(|share| 1.0 - share >= level - 1e-12)?;
        Some(self.times_s[at])
    }

    /// The first time at which half of the tasks are finished.
    pub fn median_s(&self) -> Option<f64> {
        self.quantile_s(0.5)
    }

    /// An interval for the share right after a time: Greenwood's variance on the log(−log) scale, as in `scipy.stats.ecdf`.
    pub fn share_interval(&self, time_s: f64, level: f64) -> (f64, f64) {
        match self.times_s.partition_point(|t| *t <= time_s) {
            0 => (1.0, 1.0),
            after => self.interval(after - 1, level),
        }
    }

    fn interval(&self, index: usize, level: f64) -> (f64, f64) {
        let share = self.shares[index];
        if share <= 0.0 {
            return (0.0, 0.0);
        }
        let z = normal_quantile(0.5 * (1.0 + level));
        let log = libm::log(share);
        let half = z * self.greenwood[index].sqrt() / log.abs();
        let at = |sign: f64| libm::exp(log * libm::exp(sign * half));
        (at(1.0), at(-1.0))
    }

    /// An interval for the median: from the first time at which the share's interval reaches one half to the first time at which the whole
    /// interval is at or below one half (Brookmeyer & Crowley 1982). An end is `None` if the curve does not fall that far.
    pub fn median_interval_s(&self, level: f64) -> (Option<f64>, Option<f64>) {
        let first = |end: fn((f64, f64)) -> f64| {
            let at = |index: &usize| end(self.interval(*index, level)) <= 0.5;
            Some(self.times_s[(0..self.times_s.len()).find(at)?])
        };
        (first(|ends| ends.0), first(|ends| ends.1))
    }
}

/// The log-rank test (Mantel 1966), two-sided, as `scipy.stats.logrank`: do two samples of durations differ?
///
/// # Errors
/// An empty sample, durations that are not above 0, too few finished tasks.
pub fn log_rank(x: &[Duration], y: &[Duration]) -> Result<SampleTest> {
    check(x)?;
    check(y)?;
    let (mut off, mut variance) = (0.0, 0.0);
    for (time, finished, at_risk) in counts(&[x, y].concat()) {
        let own = x.iter().filter(|d| d.time_s >= time).count() as f64;
        let done = x.iter().filter(|d| d.finished && d.time_s == time).count() as f64;
        let share = own / at_risk;
        off += done - finished * share;
        if at_risk > 1.0 {
            variance += finished * share * (1.0 - share) * (at_risk - finished) / (at_risk - 1.0);
        }
    }
    if variance <= 0.0 {
        return Err(Error::invalid(
            "too few tasks were finished to compare two samples",
        ));
    }
    let statistic = off / variance.sqrt();
    let p_value = erfc(statistic.abs() / std::f64::consts::SQRT_2);
    Ok(SampleTest::asymptotic(statistic, p_value))
}
