//! Which parameters the recordings of joints determine, before anything is fitted, and which further motion would tell most.
//!
//! The errors of the joints are linearised around the point of the robot's own values. Their noise is what a linear fit leaves, with fewer
//! independent errors where neighbours are alike. Every parameter is known beforehand to lie in its range, and not more: prior knowledge of
//! the study does not count, so that only the recordings speak. Information of recordings and of motions that nobody recorded yet is
//! compared by D-optimality (Atkinson & Donev 1992).

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

use crate::calibration::exploration::information_gain::{FitPrecision, LogInformation};
use crate::calibration::exploration::tune_problem::own_values;
use crate::calibration::{InformationGain, Study};
use realgap_core::unit::{Unit, counted, number};
use realgap_core::{Error, Result};
use realgap_inference::added_information;
use realgap_optimization::{ErrorBlock, RunOptions, UnitPoint, slopes};
use realgap_simulation::Experiment;
use realgap_store::Trial;

/// The step of a coordinate, as a share of its range, from which slopes are computed.
const STEP: f64 = 5e-3;
/// Precision of a coordinate of which only the range is known: the inverse of the variance of an even distribution.
const OF_RANGE: f64 = 12.0;
/// Half of the width of a 95 % interval in standard deviations.
const HALF_WIDTH: f64 = 1.96;
/// A parameter is determined if its interval is narrower than this share of its range, as after a fit.
const DETERMINED: f64 = 0.5;
/// Correlations from this on are trades.
const TRADES: f64 = 0.8;
/// The smallest standard deviation of an error, radians.
const LEAST_RAD: f64 = 1e-6;

/// What the recordings of a study tell about its parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Determination {
    /// Simulated points.
    pub points: usize,
    /// Every parameter, from the one with the narrowest interval as a share of its range.
    pub parameters: Vec<Determined>,
    /// What each recording tells that the others do not, from the most.
    pub recordings: Vec<InformationGain>,
    /// What further recordings would tell in addition to all recordings, from the most.
    pub further: Vec<FurtherMotion>,
}

/// How well a parameter is determined.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Determined {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// The value around which errors were linearised.
    pub value: f64,
    /// Half of the width of its 95 % interval, in its unit.
    pub half_width: f64,
    /// The width of this interval as a share of its range.
    pub share_of_range: f64,
    /// Whether the recordings determine it: the interval is narrower than half of its range.
    pub is_determined: bool,
    /// The parameter with which it trades, if there is one: the recordings tell a combination of both better than each.
    pub trade: Option<Trade>,
    /// The recording that tells most of it.
    pub told_by: Option<String>,
}

/// Two parameters of which a combination is known better than each.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Trade {
    /// The other parameter.
    pub parameter: &'static str,
    /// Correlation of both, -1 to 1.
    pub correlation: f64,
}

/// A motion that was not recorded.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FurtherMotion {
    /// What it is.
    pub motion: &'static str,
    /// Information in addition to all recordings: one bit halves the volume of the confidence region.
    pub bits: f64,
    /// The same for each parameter by itself: one bit halves the length of its interval.
    pub parameters: BTreeMap<&'static str, f64>,
}

/// Motions that are tried: what they are, how fast commands are played and how far from the first one, in relation to the recorded ones.
const MOTIONS: [(&str, f64, f64); 5] = [
    ("all recordings once more", 1.0, 1.0),
    ("with commands half as far", 1.0, 0.5),
    ("with commands 1.5 times as far", 1.0, 1.5),
    ("half as fast", 0.5, 1.0),
    ("twice as fast", 2.0, 1.0),
];

impl Study {
    /// What the recordings of joints tell about the parameters, around the robot's own values.
    ///
    /// # Errors
    /// A metric that is not made of the errors of joints, a run that diverges, or the work was stopped.
    pub fn determination(&self, run: &RunOptions<'_>) -> Result<Determination> {
        if !self.definition().metric.needs().joints {
            return Err(Error::usage(
                "only recordings of joints tell single parameters before a fit",
            )
            .field("metric")
            .found(self.definition().metric.name())
            .allowed("joints"));
        }
        run.install(|| determination(self, run))?
    }

    fn trials_around(
        &self,
        points: &[UnitPoint],
        change: impl Fn(&mut Experiment) + Sync,
        count: impl Fn() + Sync,
    ) -> Result<Vec<Trial>> {
        let grid = &self.definition().grid;
        let trials = points.par_iter().map(|point| {
            let trial = self.simulate_changed(&grid.values_at(point), &change, true);
            count();
            trial
        });
        trials.collect()
    }
}

fn determination(study: &Study, run: &RunOptions<'_>) -> Result<Determination> {
    let at = own_values(study);
    let mut points = vec![at.clone()];
    for axis in 0..at.len() {
        let mut moved = at.clone();
        moved[axis] += if at[axis] + STEP <= 1.0 { STEP } else { -STEP };
        points.push(moved);
    }
    let new_motions = MOTIONS.iter().filter(|motion| is_new(motion)).count();
    let step = run.step(
        "points around the robot's own values",
        points.len() * (1 + new_motions),
    );
    let count = || step.count();
    let trials = study.trials_around(&points, |_| {}, count)?;
    let Some((errors, blocks)) = study.errors_of(&trials[0]) else {
        return Err(
            Error::invalid("the run with the robot's own values diverges").hint(
                "use a shorter timestep (`timestep_s`), or check masses and inertias of the robot",
            ),
        );
    };
    let there: Vec<Option<Vec<f64>>> = trials[1..]
        .iter()
        .map(|trial| study.errors_of(trial).map(|(errors, _)| errors))
        .collect();
    let moved = points[1..].iter().zip(there.iter().map(Option::as_deref));
    let jacobian = slopes(&at, &errors, moved);
    let variances = channel_variances(&jacobian, &errors, &blocks);
    let around: Vec<(&UnitPoint, &Trial)> = points.iter().zip(&trials).collect();
    let logs = study.informations(&variances, &around);
    let prior = DMatrix::identity(at.len(), at.len()) * OF_RANGE;
    let all = with_fitted(prior, &logs);
    let further = further(study, (&points, &variances), (&all, &logs), count)?;
    let known = FitPrecision {
        channel_variances: variances,
        prior: vec![OF_RANGE; at.len()],
    };
    let recordings = study.motions(&known, &around);
    Ok(Determination {
        points: points.len() * (1 + new_motions),
        parameters: ranked(study, &at, &all, &recordings),
        recordings,
        further,
    })
}

/// This information, and that of all recordings that are fitted.
fn with_fitted(known: DMatrix<f64>, logs: &[LogInformation]) -> DMatrix<f64> {
    let fitted = logs.iter().filter(|(_, is_fitted, _)| *is_fitted);
    fitted.fold(known, |sum, (_, _, own)| sum + own)
}

/// Whether a motion differs from the recorded ones, so that it has to be simulated.
fn is_new((_, rate, gain): &(&str, f64, f64)) -> bool {
    (*rate, *gain) != (1.0, 1.0)
}

/// The variance of the errors of each channel that counts as one independent error: what a linear fit leaves, times the number of errors to
/// each independent one if neighbours are alike as in a process of first order, and not less than rounding.
fn channel_variances(
    jacobian: &DMatrix<f64>,
    errors: &[f64],
    blocks: &[ErrorBlock],
) -> Vec<Option<f64>> {
    let errors = DVector::from_column_slice(errors);
    let ridge = DMatrix::identity(jacobian.ncols(), jacobian.ncols()) * 1e-9;
    let solved = (jacobian.tr_mul(jacobian) + ridge).cholesky();
    let step = solved.map(|solved| solved.solve(&jacobian.tr_mul(&errors)));
    let left = match step {
        Some(step) => &errors - jacobian * step,
        None => errors,
    };
    let channels = blocks.iter().map(|block| block.channel + 1).max();
    let mut sums = vec![(0.0, 0.0, 0.0, 0usize); channels.unwrap_or(0)];
    let mut first = 0;
    for block in blocks {
        let own = &left.as_slice()[first..first + block.count];
        let sum = &mut sums[block.channel];
        sum.0 += own.iter().map(|error| error * error).sum::<f64>();
        sum.1 += own.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        sum.2 = f64::max(sum.2, block.resolution.powi(2) / 12.0);
        sum.3 += block.count;
        first += block.count;
    }
    let variance = |(square, product, rounding, count): (f64, f64, f64, usize)| {
        (count > 0).then(|| {
            let variance = (square / count as f64).max(rounding).max(LEAST_RAD.powi(2));
            let alike = (product / square.max(f64::MIN_POSITIVE)).clamp(0.0, 0.99);
            variance * (1.0 + alike) / (1.0 - alike)
        })
    };
    sums.into_iter().map(variance).collect()
}

/// The information of motions that were not recorded, added to all recordings that are fitted.
fn further(
    study: &Study,
    (points, variances): (&[UnitPoint], &[Option<f64>]),
    (all, logs): (&DMatrix<f64>, &[LogInformation]),
    count: impl Fn() + Sync + Copy,
) -> Result<Vec<FurtherMotion>> {
    let names = study.definition().grid.ranges().iter();
    let names: Vec<&'static str> = names.map(|range| range.parameter.name).collect();
    let total = |logs: &[LogInformation]| with_fitted(all * 0.0, logs);
    let mut further = Vec::new();
    for motion in &MOTIONS {
        let (what, rate, gain) = *motion;
        let own = if is_new(motion) {
            let played = |experiment: &mut Experiment| {
                for track in experiment.commands.values_mut() {
                    *track = std::sync::Arc::new(track.played(rate, gain));
                }
            };
            let trials = study.trials_around(points, played, count)?;
            let around: Vec<(&UnitPoint, &Trial)> = points.iter().zip(&trials).collect();
            let informations = study.informations(variances, &around);
            if informations.is_empty() {
                // A motion that diverges is none that one could record.
                continue;
            }
            total(&informations)
        } else {
            total(logs)
        };
        let added = added_information(&[(own, false)], all).pop().flatten();
        further.extend(added.map(|added| FurtherMotion {
            motion: what,
            bits: added.bits,
            parameters: names.iter().copied().zip(added.parameters).collect(),
        }));
    }
    further.sort_by(|a, b| b.bits.total_cmp(&a.bits));
    Ok(further)
}

/// The parameters from the best known.
fn ranked(
    study: &Study,
    at: &UnitPoint,
    information: &DMatrix<f64>,
    recordings: &[InformationGain],
) -> Vec<Determined> {
    let grid = &study.definition().grid;
    let Some(covariance) = information.clone().cholesky().map(|known| known.inverse()) else {
        return Vec::new();
    };
    let sd = |axis: usize| covariance[(axis, axis)].sqrt();
    let values = grid.values_at(at);
    let ranges = grid.ranges();
    let told_by = |name: &str| {
        let bits = |gain: &InformationGain| gain.parameters.get(name).copied().unwrap_or(0.0);
        let fitted = recordings.iter().filter(|gain| gain.is_fitted);
        let most = fitted.max_by(|a, b| bits(a).total_cmp(&bits(b)))?;
        (recordings.len() > 1).then(|| most.recording.clone())
    };
    let mut all: Vec<Determined> = (0..ranges.len())
        .map(|axis| {
            let correlation = |other: usize| covariance[(axis, other)] / (sd(axis) * sd(other));
            let others = (0..ranges.len()).filter(|other| *other != axis);
            let partner =
                others.max_by(|a, b| correlation(*a).abs().total_cmp(&correlation(*b).abs()));
            let trade = partner.filter(|other| correlation(*other).abs() >= TRADES);
            let range = &ranges[axis];
            let wide = HALF_WIDTH * sd(axis);
            let ends = [at[axis] - wide, at[axis] + wide].map(|x| range.at(x.clamp(0.0, 1.0)));
            let share_of_range = (2.0 * wide).min(1.0);
            Determined {
                parameter: range.parameter.name,
                unit: range.parameter.unit,
                value: values[axis],
                half_width: 0.5 * (ends[1] - ends[0]),
                share_of_range,
                is_determined: share_of_range < DETERMINED,
                trade: trade.map(|other| Trade {
                    parameter: ranges[other].parameter.name,
                    correlation: correlation(other),
                }),
                told_by: told_by(range.parameter.name),
            }
        })
        .collect();
    all.sort_by(|a, b| a.share_of_range.total_cmp(&b.share_of_range));
    all
}

impl Determination {
    /// The parameters that the recordings do not determine.
    pub fn open(&self) -> impl Iterator<Item = &Determined> {
        self.parameters.iter().filter(|one| !one.is_determined)
    }
}

impl fmt::Display for FurtherMotion {
    /// What the motion tells, with the parameters of which it tells most.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {:.1} bits", self.motion, self.bits)?;
        let mut most: Vec<(&&str, &f64)> = self.parameters.iter().collect();
        most.sort_by(|a, b| b.1.total_cmp(a.1));
        let shown = most.iter().take(2).filter(|(_, bits)| **bits >= 0.05);
        let shown: Vec<String> = shown
            .map(|(name, bits)| format!("{bits:.1} of {name}"))
            .collect();
        match shown.is_empty() {
            true => Ok(()),
            false => write!(f, ", most: {}", shown.join(", ")),
        }
    }
}

impl fmt::Display for Determination {
    /// The summary under the table of parameters.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let open = self.open().count();
        write!(
            f,
            "{} of {} determined, from {} around the robot's own values; nothing was fitted",
            self.parameters.len() - open,
            counted(self.parameters.len(), "parameter"),
            counted(self.points, "point")
        )?;
        for trade in self.parameters.iter().filter(|one| !one.is_determined) {
            if let Some(other) = &trade.trade {
                write!(
                    f,
                    "\n  {} trades with {} (correlation {}): fix one of them",
                    trade.parameter,
                    other.parameter,
                    number(other.correlation)
                )?;
            }
        }
        if self.recordings.len() > 1 {
            write!(f, "\nwhat each recording tells that the others do not:")?;
            for gain in &self.recordings {
                write!(f, "\n  {gain}")?;
            }
        }
        write!(
            f,
            "\nwhat further recordings would tell (if the robot may move so):"
        )?;
        for motion in &self.further {
            write!(f, "\n  {motion}")?;
        }
        Ok(())
    }
}
