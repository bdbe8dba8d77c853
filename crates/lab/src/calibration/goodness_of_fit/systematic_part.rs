//! The systematic part of residuals: what is left of them in means over time, which noise of measurement does not have.
//!
//! Residuals are divided by the noise of their channel, freed from what another value of a parameter could explain, and averaged
//! in bins of time. For independent errors the square of a bin's mean times its number of samples is 1 on average; this is the
//! ratio of slow to fast variance of von Neumann (1941), at the time scale of the bins. A part that all recordings share is
//! averaged over the recordings first. Both are taken of the residuals themselves, and of what remains beside a straight line in
//! time for each recording: an error of a measured start moves a run along such a line.
//!
//! What these numbers are for a right model is not computed from formulas: imitated recordings say it
//! (`goodness_of_fit::residual`). The rank of the real recordings among them is the p-value (Besag & Clifford 1989).

use std::ops::Range;

use realgap_core::statistics::{mean, standard_deviation};

/// Where the residuals of one channel of one recording stand in the list of all residuals.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::calibration) struct Slot {
    /// Position of the recording among those that are judged.
    pub case: usize,
    /// Position of the channel.
    pub channel: usize,
    /// Its samples.
    pub samples: Range<usize>,
}

/// Most bins of a recording, and the samples that a bin should have.
const BINS: usize = 16;
const SAMPLES: usize = 4;

/// Which part of the residuals a number is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::calibration) struct Part {
    /// Position of the channel.
    pub channel: usize,
    /// Whether a straight line in time was removed from each recording.
    pub is_bent: bool,
    /// Whether it is the part that all recordings share.
    pub is_shared: bool,
}

/// The size of one part.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::calibration) struct Size {
    /// Which part.
    pub part: Part,
    /// Mean over the bins of the square of a bin's mean, in units in which independent errors have 1.
    pub ratio: f64,
    /// Root mean square of the systematic part, in standard deviations of the channel's noise.
    pub deviations: f64,
}

/// Removes from residuals what other parameter values could explain.
#[derive(Debug)]
pub(in crate::calibration) struct Projection<'a> {
    slots: &'a [Slot],
    straight: Directions,
    bent: Directions,
}

/// Directions that are removed: some of each recording alone, and then some of all recordings together.
#[derive(Debug)]
struct Directions {
    own: Vec<(Range<usize>, Vec<Vec<f64>>)>,
    common: Vec<Vec<f64>>,
}

impl Directions {
    fn new(recordings: &[Range<usize>], own: &[Vec<f64>], common: Vec<Vec<f64>>) -> Self {
        let own = recordings.iter().map(|samples| {
            let parts = own.iter().map(|change| change[samples.clone()].to_vec());
            (samples.clone(), orthonormal(parts.collect()))
        });
        let mut directions = Self {
            own: own.collect(),
            common: Vec::new(),
        };
        let rests = common.into_iter().map(|mut change| {
            directions.remove(&mut change);
            change
        });
        directions.common = orthonormal(rests.collect());
        directions
    }

    fn remove(&self, errors: &mut [f64]) {
        for (samples, own) in &self.own {
            own.iter()
                .for_each(|d| remove(&mut errors[samples.clone()], d));
        }
        self.common.iter().for_each(|d| remove(errors, d));
    }
}

/// A direction of which less than this share is new adds nothing but rounding errors.
const NEW: f64 = 1e-3;

impl<'a> Projection<'a> {
    /// The projection beside these changes of all residuals, one for each parameter, and those changes, one for each number of the
    /// start that each recording has for itself.
    pub fn new(slots: &'a [Slot], changes: &[Vec<f64>], of_starts: &[Vec<f64>]) -> Self {
        let mut recordings: Vec<Range<usize>> = Vec::new();
        for (number, slot) in slots.iter().enumerate() {
            match recordings.last_mut() {
                Some(last) if number > 0 && slots[number - 1].case == slot.case => {
                    last.end = slot.samples.end;
                }
                _ => recordings.push(slot.samples.clone()),
            }
        }
        let unlined = |all: &[Vec<f64>]| -> Vec<Vec<f64>> {
            all.iter()
                .map(|change| without_lines(slots, change))
                .collect()
        };
        let bent = Directions::new(&recordings, &unlined(of_starts), unlined(changes));
        Self {
            slots,
            straight: Directions::new(&recordings, of_starts, changes.to_vec()),
            bent,
        }
    }

    /// The residuals without the part that parameters could explain; `is_bent`: also without a line in time for each recording.
    pub fn rest(&self, errors: &[f64], is_bent: bool) -> Vec<f64> {
        let (mut rest, directions) = match is_bent {
            true => (without_lines(self.slots, errors), &self.bent),
            false => (errors.to_vec(), &self.straight),
        };
        directions.remove(&mut rest);
        rest
    }

    /// The sizes of all parts of these residuals.
    pub fn sizes(&self, errors: &[f64]) -> Vec<Size> {
        let channels = self.slots.iter().map(|slot| slot.channel + 1).max();
        let rests = [false, true].map(|is_bent| self.rest(errors, is_bent));
        let mut sizes = Vec::new();
        for channel in 0..channels.unwrap_or(0) {
            let slots = self.slots.iter().filter(|slot| slot.channel == channel);
            for (is_bent, rest) in [false, true].into_iter().zip(&rests) {
                let of_case = slots
                    .clone()
                    .map(|slot| binned(&rest[slot.samples.clone()]));
                let of_case: Vec<Vec<Bin>> = of_case.collect();
                let size = |is_shared: bool, bins: &[Bin]| Size {
                    part: Part {
                        channel,
                        is_bent,
                        is_shared,
                    },
                    ratio: mean(&bins.iter().map(Bin::ratio).collect::<Vec<_>>()),
                    deviations: mean(&bins.iter().map(Bin::systematic).collect::<Vec<_>>())
                        .max(0.0)
                        .sqrt(),
                };
                let all: Vec<Bin> = of_case.iter().flatten().copied().collect();
                if all.is_empty() {
                    continue;
                }
                sizes.push(size(false, &all));
                if let Some(shared) = shared(&of_case) {
                    sizes.push(size(true, &shared));
                }
            }
        }
        sizes
    }
}

/// The mean of some residuals that are near in time.
#[derive(Debug, Clone, Copy)]
struct Bin {
    mean: f64,
    /// How many residuals, of all recordings together.
    count: f64,
}

impl Bin {
    /// 1 on average for independent errors of size 1.
    fn ratio(&self) -> f64 {
        self.mean.powi(2) * self.count
    }

    /// Square of the mean without what independent errors of size 1 contribute to it.
    fn systematic(&self) -> f64 {
        self.mean.powi(2) - 1.0 / self.count
    }
}

/// The bins of one recording's channel.
fn binned(errors: &[f64]) -> Vec<Bin> {
    let bins = (errors.len() / SAMPLES).clamp(1, BINS);
    let end = |bin: usize| bin * errors.len() / bins;
    let all = (0..bins).map(|bin| {
        let inside = &errors[end(bin)..end(bin + 1)];
        Bin {
            mean: mean(inside),
            count: inside.len() as f64,
        }
    });
    all.collect()
}

/// The bins of the mean over recordings, where there are several with as many bins.
fn shared(of_case: &[Vec<Bin>]) -> Option<Vec<Bin>> {
    let bins = of_case.first()?.len();
    if of_case.len() < 2 || of_case.iter().any(|own| own.len() != bins) {
        return None;
    }
    let all = (0..bins).map(|bin| {
        let count: f64 = of_case.iter().map(|own| own[bin].count).sum();
        let sum: f64 = of_case
            .iter()
            .map(|own| own[bin].mean * own[bin].count)
            .sum();
        Bin {
            mean: sum / count,
            count,
        }
    });
    Some(all.collect())
}

/// The residuals without the best straight line of each recording and channel.
fn without_lines(slots: &[Slot], errors: &[f64]) -> Vec<f64> {
    let mut rest = errors.to_vec();
    for slot in slots {
        let own = &mut rest[slot.samples.clone()];
        let middle = 0.5 * (own.len() as f64 - 1.0);
        let level = mean(own);
        let square: f64 = (0..own.len()).map(|k| (k as f64 - middle).powi(2)).sum();
        let product: f64 = own
            .iter()
            .enumerate()
            .map(|(k, e)| (k as f64 - middle) * e)
            .sum();
        let slope = if square > 0.0 { product / square } else { 0.0 };
        for (k, error) in own.iter_mut().enumerate() {
            *error -= level + slope * (k as f64 - middle);
        }
    }
    rest
}

/// Removes the part along a direction of length 1.
fn remove(errors: &mut [f64], direction: &[f64]) {
    let part: f64 = errors.iter().zip(direction).map(|(e, d)| e * d).sum();
    for (error, d) in errors.iter_mut().zip(direction) {
        *error -= part * d;
    }
}

fn length(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum::<f64>().sqrt()
}

/// Orthonormal directions that span the same changes (Gram–Schmidt, twice for accuracy).
fn orthonormal(changes: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for mut change in changes {
        let whole = length(&change);
        for _ in 0..2 {
            directions
                .iter()
                .for_each(|known| remove(&mut change, known));
        }
        let rest = length(&change);
        if rest > NEW * whole && rest > 0.0 {
            change.iter_mut().for_each(|e| *e /= rest);
            directions.push(change);
        }
    }
    directions
}

/// The rank of the recordings among imitated ones.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::calibration) struct Rank {
    /// Probability that a right model's recordings have a part that stands out as much as the recordings' most unusual one.
    pub p_value: f64,
    /// That part: its position in the list of sizes.
    pub part: usize,
}

/// Ranks the recordings among imitated ones by the part that stands out most, of those parts that `counts` accepts. Each part is
/// compared on the scale of its own logarithm over recordings and imitations together, so that all of them are treated alike
/// (a Monte Carlo test). `None` where no part counts.
pub(in crate::calibration) fn rank(
    real: &[Size],
    imitated: &[Vec<Size>],
    counts: impl Fn(&Size) -> bool,
) -> Option<Rank> {
    let same = imitated.iter().filter(|sizes| sizes.len() == real.len());
    let all: Vec<&[Size]> = std::iter::once(real)
        .chain(same.map(Vec::as_slice))
        .collect();
    let logs = |part: usize| {
        all.iter()
            .map(move |sizes| libm::log(sizes[part].ratio + 1e-12))
    };
    let scaled: Vec<Vec<f64>> = (0..real.len())
        .map(|part| {
            let logs: Vec<f64> = logs(part).collect();
            let (middle, spread) = (mean(&logs), standard_deviation(&logs));
            let scale = if spread > 0.0 { spread } else { 1.0 };
            logs.iter().map(|log| (log - middle) / scale).collect()
        })
        .collect();
    let counted = (0..real.len()).filter(|part| counts(&real[*part]));
    let part = counted.max_by(|a, b| scaled[*a][0].total_cmp(&scaled[*b][0]))?;
    let most = |number: usize| scaled.iter().map(|of| of[number]).fold(f64::MIN, f64::max);
    let as_unusual = (1..all.len()).filter(|number| most(*number) >= scaled[part][0]);
    Some(Rank {
        p_value: (1 + as_unusual.count()) as f64 / all.len() as f64,
        part,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    const LENGTH: usize = 80;

    fn slots(cases: usize) -> Vec<Slot> {
        let slot = |case: usize| Slot {
            case,
            channel: 0,
            samples: case * LENGTH..(case + 1) * LENGTH,
        };
        (0..cases).map(slot).collect()
    }

    fn noise(count: usize, rng: &mut Generator) -> Vec<f64> {
        (0..count).map(|_| StandardNormal.sample(rng)).collect()
    }

    #[test]
    fn independent_errors_have_ratio_one_and_no_systematic_part() {
        let mut rng = Generator::seed_from_u64(2);
        let slots = slots(3);
        let projection = Projection::new(&slots, &[], &[]);
        let (mut ratios, mut largest) = (vec![0.0; 4], 0.0_f64);
        for _ in 0..200 {
            for (sum, size) in ratios
                .iter_mut()
                .zip(projection.sizes(&noise(3 * LENGTH, &mut rng)))
            {
                *sum += size.ratio / 200.0;
                largest = largest.max(size.deviations);
            }
        }
        // A straight line takes two of sixteen bins' freedom: 14 of 16 are left.
        for (ratio, expected) in ratios.iter().zip([1.0, 1.0, 0.875, 0.875]) {
            assert!((ratio - expected).abs() < 0.05, "{ratios:?}");
        }
        assert!(largest < 0.5, "{largest}");
    }

    #[test]
    fn what_a_parameter_or_a_wrong_start_explains_is_no_misfit_and_a_bend_is() {
        let slots = slots(3);
        let over = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..3 * LENGTH)
                .map(|k| of((k % LENGTH) as f64 / LENGTH as f64))
                .collect()
        };
        let square = over(&|t| t * t);
        let projection = Projection::new(&slots, std::slice::from_ref(&square), &[]);
        let bent = |errors: &[f64]| {
            let sizes = projection.sizes(errors);
            let bent = sizes.into_iter().filter(|size| size.part.is_bent);
            bent.map(|size| size.deviations).fold(0.0, f64::max)
        };
        assert_eq!(bent(&square), 0.0);
        assert_eq!(bent(&over(&|t| 3.0 - 7.0 * t)), 0.0);
        assert!(bent(&over(&|t| 5.0 * libm::sin(9.0 * t))) > 2.0);
    }

    #[test]
    fn a_start_that_each_recording_has_for_itself_explains_its_own_part_of_any_size() {
        let slots = slots(3);
        let swing = |k: usize| libm::sin(0.2 * (k % LENGTH) as f64);
        let change: Vec<f64> = (0..3 * LENGTH).map(swing).collect();
        let sizes = [3.0, -5.0, 0.5];
        let errors = (0..3 * LENGTH)
            .map(|k| sizes[k / LENGTH] * swing(k))
            .collect::<Vec<f64>>();
        let largest = |projection: &Projection<'_>| {
            let sizes = projection.sizes(&errors);
            sizes.iter().map(|size| size.deviations).fold(0.0, f64::max)
        };
        let change = std::slice::from_ref(&change);
        assert_eq!(largest(&Projection::new(&slots, &[], change)), 0.0);
        assert!(largest(&Projection::new(&slots, change, &[])) > 1.0);
    }

    #[test]
    fn a_right_model_is_seldom_rejected_and_a_small_shared_pattern_is_found() {
        let mut rng = Generator::seed_from_u64(4);
        let slots = slots(4);
        let projection = Projection::new(&slots, &[], &[]);
        let rejected = |amplitude: f64, rng: &mut Generator| {
            let mut sizes = |amplitude: f64| {
                let mut errors = noise(4 * LENGTH, rng);
                for (k, error) in errors.iter_mut().enumerate() {
                    *error += amplitude * libm::sin(0.1 * (k % LENGTH) as f64);
                }
                projection.sizes(&errors)
            };
            let real = sizes(amplitude);
            let imitated: Vec<Vec<Size>> = (0..39).map(|_| sizes(0.0)).collect();
            rank(&real, &imitated, |_| true).unwrap().p_value < 0.05
        };
        // One rank of forty is below 0.05, so that 2.5 % are expected; more than 11 of 200 have a probability of 1 %.
        let alarms = (0..200).filter(|_| rejected(0.0, &mut rng)).count();
        assert!(alarms <= 11, "{alarms}");
        let found = (0..50).filter(|_| rejected(0.6, &mut rng)).count();
        assert!(found >= 45, "{found}");
    }
}
