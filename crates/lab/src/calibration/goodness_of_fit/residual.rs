//! Goodness of fit of runs that start from recordings: whether what is left between the best runs and the recordings is noise.
//!
//! Every recording has its own start here, so there are no repeats to compare with. The noise of the recordings is known from what
//! they show themselves (high frequencies, resolution) and from what the study states. If the model is right, residuals are that
//! noise, and what grows from the noise of the measured start. So recordings are imitated: runs of the best point at half of its
//! timestep are recorded with that noise, and the study's runs start from the imitations (`goodness_of_fit::imitation`). The
//! systematic parts of the real residuals are ranked among those of the imitations (`goodness_of_fit::systematic_part`), which
//! is a posterior predictive check at the best point.
//!
//! A part counts only where it is larger than the noise of one sample, than twice what half the timestep changes, and than a
//! thousandth of the motion: smaller misfits are real but do not matter.

use rayon::prelude::*;
use serde::Serialize;

use crate::calibration::answer::score::Scores;
use crate::calibration::goodness_of_fit::bench::{Bench, Truths, engine, half_step};
use crate::calibration::goodness_of_fit::channel::Series;
use crate::calibration::goodness_of_fit::imitation::MeasurementNoise;
use crate::calibration::goodness_of_fit::layout::Layout;
use crate::calibration::goodness_of_fit::pattern::Pattern;
use crate::calibration::goodness_of_fit::refit::Refit;
use crate::calibration::goodness_of_fit::systematic_part::{Projection, Size, rank};
use crate::calibration::goodness_of_fit::two_sample::JUDGING;
use crate::calibration::study::Study;
use crate::claim::SIGNIFICANT;
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_optimization::{RunOptions, Step};
use realgap_simulation::Noise;

/// Where the noise of a channel is known from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// From the high frequencies of the recordings.
    HighFrequencies,
    /// From the steps of their resolution.
    Resolution,
    /// From the study's `noise`.
    Stated,
}

/// Comparison of the residuals of one channel with the noise of the recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelFit {
    /// What was compared.
    pub channel: String,
    /// Unit of the noise and of the residuals.
    pub unit: Unit,
    /// Standard deviation of the noise of one sample.
    pub noise: f64,
    /// Where it is known from.
    pub noise_source: NoiseSource,
    /// Root mean square of the residuals at the best values nearby.
    pub residual: f64,
    /// Root mean square of their systematic part, in standard deviations of the noise: of the part that is largest.
    pub systematic: f64,
}

/// What the residuals of the best point say, where runs start from recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResidualFit {
    /// Probability that residuals of a right model have a systematic part that stands out as much: the rank of the recordings
    /// among imitated ones.
    pub p_value: f64,
    /// Number of imitations.
    pub imitations: usize,
    /// Each channel whose noise is known.
    pub channels: Vec<ChannelFit>,
    /// The systematic part that stands out most; `None` where no part is large enough to matter, and where the model explains
    /// the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub misfit: Option<ResidualMisfit>,
}

/// The systematic part of residuals that stands out most.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResidualMisfit {
    /// Position of its channel.
    pub channel: usize,
    /// Beginning of the quarter of the motion in which it is largest, seconds.
    pub from_s: f64,
    /// Its end, seconds.
    pub to_s: f64,
    /// What it looks like.
    pub pattern: Pattern,
    /// The size of that pattern, in the unit that the pattern says.
    pub size: f64,
    /// Share of the mean square of the channel's residuals that the pattern takes away.
    pub share: f64,
}

/// Imitations, of which one in 20 (40) may be more unusual than a right model's recordings at a level of 5 % (2.5 %), and the
/// number of runs of a study from which on there are as many as the second.
const FEW: usize = 20;
const MANY: usize = 39;
const RUNS_FOR_MANY: usize = 300;
/// What can be said about the residuals of a study.
pub(in crate::calibration) enum Judgement {
    /// No run, or no comparable channel.
    Nothing,
    /// The noise of no channel is known.
    Unknown,
    /// The residuals were compared with the noise.
    Fit(ResidualFit),
}

impl Judgement {
    /// Judges the best point.
    ///
    /// # Errors
    /// Experiments that cannot be simulated.
    pub fn new((study, run): (&Study, &RunOptions<'_>), scores: &Scores) -> Result<Self> {
        let Some(best) = scores.best else {
            return Ok(Self::Nothing);
        };
        let values = scores.points[best].values.clone();
        let bench = Bench::new(study, engine(study, scores, best));
        let Some(runs) = bench.runs(study, &values, &|_| ())? else {
            return Ok(Self::Nothing);
        };
        let recorded = bench.recorded(study, &values)?;
        let series = bench.series(&recorded, &runs);
        if series.iter().all(Vec::is_empty) {
            return Ok(Self::Nothing);
        }
        let visible = bench.visible_noise(&recorded, &runs);
        let (noise, stated) = bench.noise(&visible);
        let layout = Layout::new(&series, (&visible, &noise), stated.is_some());
        if layout.slots.is_empty() {
            return Ok(Self::Unknown);
        }
        let refit = bench.refit(&values, &layout, &series)?;
        let imitations = match scores.runs.len() >= RUNS_FOR_MANY {
            true => MANY,
            false => FEW,
        };
        let step = run.step(JUDGING, imitations);
        let judged = bench.judge(
            &layout,
            refit,
            (&noise, stated.as_ref()),
            (imitations, &step),
        )?;
        Ok(judged.map_or(Self::Nothing, Self::Fit))
    }
}

impl Bench<'_> {
    fn refit(&self, values: &[f64], layout: &Layout, series: &[Vec<Series>]) -> Result<Refit> {
        let grid = &self.study.definition().grid;
        let errors_at = |place: &[f64]| {
            let values = grid.values_at(place);
            let Some(runs) = self.runs(self.study, &values, &|_| ())? else {
                return Ok(None);
            };
            let series = self.series(&self.recorded(self.study, &values)?, &runs);
            Ok(Some(layout.errors(&series)))
        };
        Refit::new(grid.place_of(values), layout.errors(series), errors_at)
    }

    /// Ranks the residuals of the refitted point among those of imitated recordings; `None` where its runs diverge.
    fn judge(
        &self,
        layout: &Layout,
        refit: Refit,
        (noise, stated): (&MeasurementNoise, Option<&Noise>),
        (imitations, step): (usize, &Step<'_>),
    ) -> Result<Option<ResidualFit>> {
        let values = self.study.definition().grid.values_at(&refit.place);
        let own = self.runs(self.study, &values, &|_| ())?;
        let finer = self.runs(self.study, &values, &half_step)?;
        let Some((own, finer)) = own.zip(finer) else {
            return Ok(None);
        };
        let recorded = self.recorded(self.study, &values)?;
        let series = self.series(&recorded, &own);
        let of_starts = self.changed_starts(&values, &own)?;
        let of_starts = of_starts
            .iter()
            .map(|runs| layout.errors(&self.series(&own, runs)));
        let of_starts: Vec<Vec<f64>> = of_starts.collect();
        let projection = Projection::new(&layout.slots, &refit.changes, &of_starts);
        let real = projection.sizes(&layout.errors(&series));
        let numerics = layout.errors(&self.series(&finer, &own));
        let truths = Truths {
            own: &own,
            finer: &finer,
        };
        let imitate = |number: usize| -> Result<Option<Vec<Size>>> {
            let truth = match stated.filter(|noise| !noise.is_zero()) {
                None => Some(truths.number(number)?),
                Some(noise) => self.perturbed(&values, noise, number)?,
            };
            let Some(truth) = truth else {
                return Ok(None);
            };
            let study = self.imitation(&values, &truth, noise, number)?;
            let Some(runs) = self.runs(&study, &values, &|_| ())? else {
                return Ok(None);
            };
            let series = self.series(&self.recorded(&study, &values)?, &runs);
            Ok(Some(projection.sizes(&layout.errors(&series))))
        };
        let imitated: Vec<Option<Vec<Size>>> = (0..imitations)
            .into_par_iter()
            .map(|number| {
                let imitated = imitate(number);
                step.count();
                imitated
            })
            .collect::<Result<_>>()?;
        let imitated: Vec<Vec<Size>> = imitated.into_iter().flatten().collect();
        let numerics = [false, true].map(|is_bent| projection.rest(&numerics, is_bent));
        let matters = |size: &Size| {
            let numerics = &numerics[usize::from(size.part.is_bent)];
            size.deviations >= layout.least(&series, size.part.channel, numerics)
        };
        if imitated.len() < FEW {
            return Ok(None);
        }
        let found = rank(&real, &imitated, matters);
        let is_misfit = found
            .as_ref()
            .is_some_and(|found| found.p_value < SIGNIFICANT);
        let misfit = found
            .as_ref()
            .filter(|_| is_misfit)
            .map(|found| layout.misfit(&recorded, &series, real[found.part].part, &projection));
        let of_all = || rank(&real, &imitated, |_| true);
        Ok(found.or_else(of_all).map(|found| ResidualFit {
            p_value: found.p_value,
            imitations: imitated.len(),
            channels: layout.channels(&series, &real),
            misfit,
        }))
    }
}
