//! Bands of predictions: where recordings that the fit has not seen should lie, and how many of their samples do.
//!
//! A draw of the posterior is a model of the robot, and no model is right: what a fit leaves of a recording that it has not seen (its
//! noise, and what the model lacks) is there in recordings to come, too. So a prediction is a run of a draw plus one of these rests:
//! those of each fitted recording, or part of one, without which the fit is made again to first order (Stone 1974). Where
//! many fitted runs show how rests grow with the time since a run's start, each part of a run has its own. Whether a sample lies
//! within the central band of its predictions follows from its errors alone: the share of predictions above it is between the tails
//! (probability integral transform; Dawid 1984).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::calibration::exploration::information_gain::LogErrors;
use crate::calibration::{PosteriorDraws, Study};
use realgap_core::Result;
use realgap_core::statistics::quantile;
use realgap_core::unit::{Unit, counted};
use realgap_inference::{INTERVAL_LEVEL, LeastSquaresPosterior};
use realgap_optimization::RunOptions;
use realgap_path::comparison::PoseQuantity;

/// Bands of predictions and the samples within them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bands {
    /// Share of the predictions within a band.
    pub level: f64,
    /// Draws of the posterior that were run.
    pub draws: usize,
    /// Share of the samples of recordings that were held out which lie within their bands.
    pub held_out_share: f64,
    /// The same of the recordings that were fitted.
    pub fitted_share: f64,
    /// Runs that were held out: recordings, or windows of them.
    pub held_out_runs: usize,
    /// Each joint, or each direction of a path and its rotation.
    pub channels: Vec<ChannelBand>,
}

/// What predictions of one channel leave open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelBand {
    /// The column that is predicted.
    pub channel: String,
    /// Unit of the rests.
    pub unit: String,
    /// What fitted recordings have more than the best run: the lower end of the central 90 %.
    pub rest_low: f64,
    /// The upper end.
    pub rest_high: f64,
    /// Share of the held-out samples within their bands.
    pub held_out_share: f64,
    /// Number of held-out samples.
    pub held_out_samples: usize,
}

/// Draws that are run.
const DRAWS: usize = 40;
/// Recordings from which on whole ones are left out.
const SEVERAL: usize = 3;
/// Parts of a run that have rests of their own, and the fitted runs from which on they do.
const PARTS: usize = 8;
const MANY_RUNS: usize = 10;

/// The rests of one channel in one part of a run: runs less recordings, sorted.
type Rests = BTreeMap<(usize, usize), Vec<f64>>;

/// Counts of samples, and of those within their bands.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    all: usize,
    within: usize,
}

impl Count {
    fn share(self) -> f64 {
        self.within as f64 / self.all.max(1) as f64
    }
}

/// The errors of each block of these logs: number of the log, channel, part of the run, position in the log's errors.
fn samples(logs: &[LogErrors<'_>], parts: usize) -> Vec<(usize, usize, usize, usize)> {
    let mut all = Vec::new();
    for (number, log) in logs.iter().enumerate() {
        let mut first = 0;
        for block in &log.blocks {
            let own = (0..block.count).map(|k| {
                let part = k * parts / block.count;
                (number, block.channel, part, first + k)
            });
            all.extend(own);
            first += block.count;
        }
    }
    all
}

/// For every error of the fitted recordings, the number of what is left out together: a recording where there are several, else a
/// window, or else an eighth of a recording.
fn groups(logs: &[LogErrors<'_>]) -> Vec<usize> {
    let fitted: Vec<&LogErrors<'_>> = logs.iter().filter(|log| log.is_fitted).collect();
    let mut groups = Vec::new();
    let mut first = 0;
    for log in &fitted {
        let mut windows: BTreeMap<usize, usize> = BTreeMap::new();
        let is_cut = log
            .blocks
            .iter()
            .skip(1)
            .any(|block| block.channel == log.blocks[0].channel);
        let mut most = 0;
        for block in &log.blocks {
            let window = windows.entry(block.channel).or_insert(0);
            let own = (0..block.count).map(|k| match (fitted.len() >= SEVERAL, is_cut) {
                (true, _) => 0,
                (false, true) => *window,
                (false, false) => k * PARTS / block.count,
            });
            for part in own {
                groups.push(first + part);
                most = most.max(part + 1);
            }
            *window += 1;
        }
        first += most;
    }
    groups
}

/// The share of the rests below an error; those equal to it count half, because encoders make many of them.
fn share_below(rests: &[f64], error: f64) -> f64 {
    let below = rests.partition_point(|rest| *rest < error);
    let up_to = rests.partition_point(|rest| *rest <= error);
    (below + up_to) as f64 / (2.0 * rests.len().max(1) as f64)
}

impl Bands {
    /// `None` where nothing is held out, where channels are scored, and where a run diverges.
    ///
    /// # Errors
    /// Experiments that cannot be simulated.
    pub(in crate::calibration) fn new(
        (study, run): (&Study, &RunOptions<'_>),
        (best, draws): (&[f64], &PosteriorDraws),
        posterior: &LeastSquaresPosterior,
    ) -> Result<Option<Self>> {
        let recordings = study.definition().recordings.len();
        let is_parted = (0..recordings).any(|number| study.is_held_out(number));
        if !is_parted || study.scored_channels().is_some() {
            return Ok(None);
        }
        let trial = study.simulate_changed(best, |_| (), true)?;
        let Some(here) = study.logs_of(&trial) else {
            return Ok(None);
        };
        let rows = draws.rows();
        let chosen =
            (0..DRAWS.min(rows.len())).map(|k| &rows[k * rows.len() / DRAWS.min(rows.len())]);
        let step = run.step("predicting what was held out", chosen.len());
        let mut drawn: Vec<Vec<Vec<f64>>> = Vec::new();
        for values in chosen {
            let trial = study.simulate_changed(values, |_| (), true)?;
            step.count();
            let Some(logs) = study.logs_of(&trial) else {
                continue;
            };
            let errors: Vec<Vec<f64>> = logs.into_iter().map(|log| log.errors).collect();
            let is_whole = errors.len() == here.len();
            if is_whole
                && errors
                    .iter()
                    .zip(&here)
                    .all(|(a, b)| a.len() == b.errors.len())
            {
                drawn.push(errors);
            }
        }
        let joints = study.simulator().joints(&study.cases()[0].experiment);
        let joints = joints.into_iter().map(|name| format!("{name}_rad"));
        let pose = PoseQuantity::ALL.map(|quantity| quantity.column().to_owned());
        let names: Vec<String> = joints.chain(pose).collect();
        let left_out = posterior.left_out_errors(&groups(&here));
        Ok(Self::of(&here, &left_out, &drawn, &names))
    }

    /// How many samples lie within their bands, as a sentence.
    pub fn sentence(&self) -> String {
        format!(
            "{:.0} % bands of predictions (draws of the posterior, and what the fit leaves) hold {:.1} % of the samples of {} that were not fitted",
            100.0 * self.level,
            100.0 * self.held_out_share,
            counted(self.held_out_runs, "run")
        )
    }

    /// From the errors of the best point, those of fitted recordings as if the fit had not seen them, and those of draws; `names` are
    /// those of the channels.
    fn of(
        here: &[LogErrors<'_>],
        left_out: &[f64],
        drawn: &[Vec<Vec<f64>>],
        names: &[String],
    ) -> Option<Self> {
        let runs = |is_fitted: bool| -> usize {
            let logs = here.iter().filter(|log| log.is_fitted == is_fitted);
            let most = logs.map(|log| {
                let channels = log.blocks.iter().map(|block| block.channel);
                let first = log.blocks.first().map(|block| block.channel);
                channels.filter(|channel| Some(*channel) == first).count()
            });
            most.sum()
        };
        if drawn.is_empty() || runs(true) == 0 || runs(false) == 0 {
            return None;
        }
        let parts = if runs(true) < MANY_RUNS { 1 } else { PARTS };
        let samples = samples(here, parts);
        let mut rests = Rests::new();
        let fitted = samples.iter().filter(|(log, ..)| here[*log].is_fitted);
        for ((_, channel, part, _), error) in fitted.zip(left_out) {
            rests.entry((*channel, *part)).or_default().push(*error);
        }
        rests
            .values_mut()
            .for_each(|own| own.sort_by(f64::total_cmp));
        let tail = 0.5 * (1.0 - INTERVAL_LEVEL);
        let (mut seen, mut held_out) = (Count::default(), BTreeMap::<usize, Count>::new());
        for (log, channel, part, at) in &samples {
            let Some(own) = rests.get(&(*channel, *part)) else {
                continue;
            };
            let shares = drawn
                .iter()
                .map(|errors| share_below(own, errors[*log][*at]));
            let share = shares.sum::<f64>() / drawn.len() as f64;
            let count = match here[*log].is_fitted {
                true => &mut seen,
                false => held_out.entry(*channel).or_default(),
            };
            count.all += 1;
            count.within += usize::from((tail..=1.0 - tail).contains(&share));
        }
        let total = held_out.values().fold(Count::default(), |sum, one| Count {
            all: sum.all + one.all,
            within: sum.within + one.within,
        });
        let channels = held_out.iter().map(|(channel, count)| {
            let own = rests.iter().filter(|((of, _), _)| of == channel);
            // A recording has more than the run where the run's error is negative.
            let more: Vec<f64> = own
                .flat_map(|(_, own)| own.iter().map(|rest| -rest))
                .collect();
            let channel = names.get(*channel).map_or("", String::as_str);
            let unit = match channel.ends_with("_m") {
                true => Unit::Metre,
                false => Unit::Radian,
            };
            ChannelBand {
                channel: channel.to_owned(),
                unit: unit.label().to_owned(),
                rest_low: quantile(&more, tail),
                rest_high: quantile(&more, 1.0 - tail),
                held_out_share: count.share(),
                held_out_samples: count.all,
            }
        });
        Some(Self {
            level: INTERVAL_LEVEL,
            draws: drawn.len(),
            held_out_share: total.share(),
            fitted_share: seen.share(),
            held_out_runs: runs(false),
            channels: channels.collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;
    use realgap_optimization::ErrorBlock;
    use std::path::Path;

    const COUNT: usize = 400;

    /// Errors that grow with the time since a run's start, by this factor until its end, plus those of a wrong parameter.
    fn log(
        is_fitted: bool,
        runs: usize,
        (growth, wrong): (f64, f64),
        rng: &mut Generator,
    ) -> LogErrors<'static> {
        let errors = (0..runs * COUNT).map(|k| {
            let share = (k % COUNT) as f64 / COUNT as f64;
            let normal: f64 = StandardNormal.sample(rng);
            (1.0 + growth * share) * normal + wrong
        });
        LogErrors {
            path: Path::new("log.csv"),
            name: "log",
            is_fitted,
            errors: errors.collect(),
            blocks: vec![
                ErrorBlock {
                    channel: 0,
                    log: 0,
                    count: COUNT,
                    resolution: 0.0
                };
                runs
            ],
        }
    }

    fn bands(growth: f64, wrong: f64, spread: f64) -> Bands {
        let mut rng = Generator::seed_from_u64(4);
        let here = [
            log(true, 12, (growth, 0.0), &mut rng),
            log(false, 12, (growth, wrong), &mut rng),
        ];
        let drawn = (0..40).map(|_| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            let moved = |log: &LogErrors<'_>| {
                let sign = if log.is_fitted { 0.0 } else { spread * normal };
                log.errors
                    .iter()
                    .map(|error| error + sign)
                    .collect::<Vec<f64>>()
            };
            here.iter().map(moved).collect()
        });
        let drawn: Vec<Vec<Vec<f64>>> = drawn.collect();
        Bands::of(&here, &here[0].errors, &drawn, &["hip_rad".to_owned()]).unwrap()
    }

    #[test]
    fn nine_of_ten_samples_to_come_lie_in_the_band_of_a_right_model_and_fewer_in_that_of_a_wrong_one()
     {
        let right = bands(0.0, 0.0, 0.0);
        assert!((0.88..0.92).contains(&right.held_out_share), "{right:?}");
        assert_eq!(right.channels[0].channel, "hip_rad");
        assert!(
            (-1.8..-1.5).contains(&right.channels[0].rest_low),
            "{right:?}"
        );
        let wrong = bands(0.0, 1.5, 0.0);
        assert!(wrong.held_out_share < 0.7, "{wrong:?}");
        // A posterior that knows how little it knows has wider bands.
        let unsure = bands(0.0, 1.5, 1.5);
        assert!(unsure.held_out_share > 0.85, "{unsure:?}");
    }

    #[test]
    fn rests_that_grow_with_time_have_bands_that_do() {
        let growing = bands(5.0, 0.0, 0.0);
        assert!(
            (0.88..0.92).contains(&growing.held_out_share),
            "{growing:?}"
        );
    }
}
