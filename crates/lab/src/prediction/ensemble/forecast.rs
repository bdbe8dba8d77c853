//! The forecast of an ensemble: all of its summaries.

use serde::Serialize;

use super::{Behaviours, Ensemble, Envelope, Motion, Quantiles, behaviours};
use realgap_core::statistics::Proportion;
use realgap_core::{Code, Result, Warning};
use realgap_simulation::Noise;

/// Confidence level of the intervals.
const LEVEL: f64 = 0.95;

/// The summaries of an ensemble.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Forecast {
    /// Repeats simulated.
    pub repeats: usize,
    /// Repeats asked for.
    pub repeats_asked: usize,
    /// Whether all of them are here.
    pub complete: bool,
    /// Seed of all draws.
    pub seed: u64,
    /// Length of each run, seconds.
    pub duration_s: f64,
    /// Edge length of the tracked module, metres.
    pub body_length_m: f64,
    /// Net displacement, metres; `None` where every repeat diverged.
    pub displacement_m: Option<Quantiles>,
    /// Net displacement per time, m/s.
    pub speed_m_s: Option<Quantiles>,
    /// Length of the path, metres.
    pub path_length_m: Option<Quantiles>,
    /// Change of the heading, radians.
    pub turned_rad: Option<Quantiles>,
    /// Net displacement of the run without noise, metres.
    pub noise_free_displacement_m: Option<f64>,
    /// Repeats that diverged.
    pub diverged: Proportion,
    /// Clusters of repeats with similar paths.
    pub behaviours: Behaviours,
    /// Central regions, each for its own time; `None` where every repeat diverged.
    pub envelope: Option<Envelope>,
    /// The band in which whole paths stay; `None` for too few repeats.
    pub band: Option<Envelope>,
    /// How the repeats differ.
    pub noise: Noise,
    /// CPU seconds of all runs; not written, so that equal runs give equal files.
    #[serde(skip)]
    pub cpu_s: f64,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Forecast {
    /// Summarises an ensemble.
    ///
    /// # Errors
    /// None for an ensemble of [`run`](super::run()).
    pub fn new(ensemble: &Ensemble) -> Result<Self> {
        let spread = |value: &dyn Fn(&Motion) -> f64| {
            let values: Vec<f64> = ensemble.motions().map(|(_, m)| value(m)).collect();
            Quantiles::of(&values)
        };
        let paths: Vec<_> = ensemble.motions().map(|(_, m)| &m.path).collect();
        let (duration_s, body_length_m) = (ensemble.duration_s, ensemble.body_length_m);
        let repeats = ensemble.repeats.len();
        let envelope = match paths.is_empty() {
            true => None,
            false => Some(Envelope::new(&paths, duration_s, body_length_m)?),
        };
        let displacement_m = spread(&Motion::net_displacement_m);
        let noise_free_displacement_m = ensemble.noise_free.get().map(Motion::net_displacement_m);
        let mut warnings = ensemble.warnings.clone();
        if let (Some(spread), Some(alone_m)) = (&displacement_m, noise_free_displacement_m)
            && !ensemble.noise.is_zero()
            && !(spread.q05..=spread.q95).contains(&alone_m)
        {
            warnings.push(Code::AtypicalPrediction.warning(format!(
                "without noise the robot gets {alone_m:.3} m far, outside what 90 % of its repeats do ({:.3} to {:.3} m): \
                     the one run without noise does not predict them",
                spread.q05,
                spread.q95
            )));
        }
        Ok(Self {
            repeats,
            repeats_asked: ensemble.asked,
            complete: ensemble.is_complete(),
            seed: ensemble.seed,
            duration_s,
            body_length_m,
            displacement_m,
            speed_m_s: spread(&|m| m.net_displacement_m() / ensemble.duration_s),
            path_length_m: spread(&|m| m.path.path_length_m()),
            turned_rad: spread(&|m| m.turned_rad),
            noise_free_displacement_m,
            diverged: Proportion::new(repeats - paths.len(), repeats, LEVEL),
            behaviours: behaviours(ensemble),
            envelope,
            band: Envelope::of_whole_paths(&paths, duration_s, body_length_m)?,
            noise: ensemble.noise,
            cpu_s: ensemble.cpu.as_secs_f64(),
            warnings,
        })
    }
}

impl Ensemble {
    /// The share of repeats that move at least `least_m`; diverged repeats do not count as such.
    pub fn success(&self, least_m: f64) -> Proportion {
        let far = self
            .motions()
            .filter(|(_, m)| m.net_displacement_m() >= least_m);
        Proportion::new(far.count(), self.repeats.len(), LEVEL)
    }
}
