//! Samples that are compared, and how they are compared.

use realgap_core::{Result, Warning};
use realgap_path::comparison::{Basis, ChannelSet, Components, Context, Metric, Pair};
use realgap_path::trajectory::{Prepared, Trajectory, prepare};

/// One run, real or simulated, raw and prepared.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its name.
    pub name: String,
    /// The motion.
    pub motion: Trajectory,
    /// The prepared motion.
    pub prepared: Prepared,
}

impl Sample {
    /// A run with its preparation.
    ///
    /// # Errors
    /// A path too long to be compared.
    pub fn new(name: impl Into<String>, motion: Trajectory) -> Result<Self> {
        let prepared = prepare(&motion)?;
        Ok(Self {
            name: name.into(),
            motion,
            prepared,
        })
    }
}

/// The simulations of one start, and which recordings share it.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseRuns {
    /// Indices of the recordings.
    pub recordings: Vec<usize>,
    /// The run without noise; `None` where it diverged.
    pub ideal: Option<Sample>,
    /// Repeats under noise that ended; empty without an ensemble.
    pub repeats: Vec<Sample>,
}

/// How distances are measured and resampled.
#[derive(Debug, Clone)]
pub struct Scoring {
    /// The metrics.
    pub metrics: Vec<&'static dyn Metric>,
    /// How many principal components the metric `pca` keeps.
    pub components: Components,
    /// Edge length of the robot's body, metres, for metrics that need it.
    pub body_length_m: Option<f64>,
    /// Channels of a study, for the metric that is made of them.
    pub channels: Option<ChannelSet>,
    /// Seed of the permutations.
    pub seed: u64,
}

impl Scoring {
    /// A basis of these runs, where a metric needs one.
    pub(super) fn basis<'a>(
        &self,
        runs: impl Iterator<Item = &'a Sample>,
    ) -> Result<Option<Basis>> {
        if !self.metrics.iter().any(|metric| metric.needs().basis) {
            return Ok(None);
        }
        let prepared: Vec<&Prepared> = runs.map(|run| &run.prepared).collect();
        Basis::fit(&prepared, self.components).map(Some)
    }

    pub(super) fn context<'a>(&'a self, basis: Option<&'a Basis>) -> Context<'a> {
        Context {
            basis,
            spread: None,
            body_length_m: self.body_length_m,
            channels: self.channels.as_ref(),
        }
    }
}

/// The distance of two runs, with its warnings added to `heard`.
pub(super) fn distance(
    metric: &dyn Metric,
    context: &Context<'_>,
    real: &Sample,
    other: &Sample,
    heard: &mut Heard,
) -> Result<f64> {
    let [real, other] = [real, other].map(|sample| (&sample.motion, &sample.prepared));
    let pair = Pair::new(real, other);
    let score = metric.compare(&pair, context)?;
    heard.add_warnings(score.warnings);
    Ok(score.value)
}

/// Warnings of many pairs: the first of each kind, and their number.
#[derive(Debug, Default)]
pub(super) struct Heard(Vec<(Warning, usize)>);

impl Heard {
    pub(super) fn add_warnings(&mut self, warnings: Vec<Warning>) {
        for warning in warnings {
            self.add(warning, 1);
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        for (warning, times) in other.0 {
            self.add(warning, times);
        }
    }

    fn add(&mut self, warning: Warning, times: usize) {
        match self.0.iter_mut().find(|(w, _)| w.code == warning.code) {
            Some((_, count)) => *count += times,
            None => self.0.push((warning, times)),
        }
    }

    /// `what` names the computation that gave the warnings, e.g. `noise floor`.
    pub(super) fn into_warnings(self, what: &str) -> Vec<Warning> {
        let said = self.0.into_iter().map(|(warning, times)| {
            let more = match times {
                1 => String::new(),
                _ => format!(" (and {} more like it)", times - 1),
            };
            warning
                .code
                .warning(format!("{what}: {}{more}", warning.message))
        });
        said.collect()
    }
}
