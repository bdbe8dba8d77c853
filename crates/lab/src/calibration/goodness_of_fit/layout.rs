//! Where the residuals of every channel and recording stand in one list, and by what they are divided.

use crate::calibration::goodness_of_fit::channel::{Quantity, Series};
use crate::calibration::goodness_of_fit::imitation::MeasurementNoise;
use crate::calibration::goodness_of_fit::pattern::{Difference, Pattern};
use crate::calibration::goodness_of_fit::residual::{ChannelFit, NoiseSource, ResidualMisfit};
use crate::calibration::goodness_of_fit::systematic_part::{Part, Projection, Size, Slot};
use crate::calibration::goodness_of_fit::visible_noise::{FEWEST, LEAST};
use realgap_core::statistics::ends_of;
use realgap_path::trajectory::Trajectory;

/// Systematic parts below this share of the motion's range do not matter.
const PRACTICAL: f64 = 1e-3;
/// A right model may differ from reality by so many times what half the timestep changes: with errors of first order, all of the
/// model's own numerical error.
const NUMERICS: f64 = 2.0;
/// Where an encoder rounds, so many of its steps are no misfit: a joint that stands still keeps the same rounding error, one step from
/// end to end, and a start that is read from a rounded angle adds half of a step.
const ROUNDED_STEPS: f64 = 1.5;
const QUARTERS: usize = 4;

/// The channels that are judged, and where their residuals stand.
pub(super) struct Layout {
    pub quantities: Vec<Quantity>,
    /// Standard deviation by which the residuals of each channel are divided.
    scales: Vec<f64>,
    sources: Vec<NoiseSource>,
    pub slots: Vec<Slot>,
}

impl Layout {
    /// The channels with noise of a known size: what the recordings show, and what is used. Where the study states noise, a channel
    /// that shows none is judged, too.
    pub fn new(
        series: &[Vec<Series>],
        (visible, used): (&MeasurementNoise, &MeasurementNoise),
        has_stated: bool,
    ) -> Self {
        let mut quantities: Vec<Quantity> = series
            .iter()
            .flatten()
            .map(|own| own.quantity.clone())
            .collect();
        quantities.sort();
        quantities.dedup();
        let mut layout = Self {
            quantities: Vec::new(),
            scales: Vec::new(),
            sources: Vec::new(),
            slots: Vec::new(),
        };
        for quantity in quantities {
            let own = series
                .iter()
                .flatten()
                .filter(|own| own.quantity == quantity);
            let (low, high) = ends_of(own.flat_map(|own| own.motion.iter().copied()));
            let (size, source) = size_of(&quantity, used);
            let known = match (size > LEAST, has_stated) {
                (true, true) if size > size_of(&quantity, visible).0 => (size, NoiseSource::Stated),
                (true, _) => (size, source),
                (false, true) => (PRACTICAL * (high - low), NoiseSource::Stated),
                (false, false) => continue,
            };
            if known.0 > 0.0 {
                layout.quantities.push(quantity);
                layout.scales.push(known.0);
                layout.sources.push(known.1);
            }
        }
        let mut end = 0;
        for (case, own) in series.iter().enumerate() {
            for (channel, quantity) in layout.quantities.iter().enumerate() {
                let known = own.iter().find(|own| own.quantity == *quantity);
                let Some(known) = known.filter(|own| own.residual.len() >= FEWEST) else {
                    continue;
                };
                let samples = end..end + known.residual.len();
                end = samples.end;
                layout.slots.push(Slot {
                    case,
                    channel,
                    samples,
                });
            }
        }
        layout
    }

    fn series_at<'a>(&self, slot: &Slot, series: &'a [Vec<Series>]) -> Option<&'a Series> {
        let quantity = &self.quantities[slot.channel];
        series[slot.case]
            .iter()
            .find(|own| own.quantity == *quantity)
    }

    /// All residuals in one list, each divided by the noise of its channel.
    pub fn errors(&self, series: &[Vec<Series>]) -> Vec<f64> {
        let slots = self.slots.iter();
        let errors = slots.filter_map(|slot| {
            let scale = self.scales[slot.channel];
            let own = self.series_at(slot, series)?.residual.iter();
            Some(own.map(move |error| error / scale))
        });
        errors.flatten().collect()
    }

    /// The smallest systematic part that matters in this part of the residuals, in standard deviations of its noise. `numerics` is
    /// what half of the timestep changes beside what parameters can make good.
    pub fn least(&self, series: &[Vec<Series>], channel: usize, numerics: &[f64]) -> f64 {
        let slots = || self.slots.iter().filter(|slot| slot.channel == channel);
        let moved = slots().flat_map(|slot| &numerics[slot.samples.clone()]);
        let moved: Vec<f64> = moved.copied().collect();
        let motions = slots().filter_map(|slot| self.series_at(slot, series));
        let (low, high) = ends_of(motions.flat_map(|own| own.motion.iter().copied()));
        let range = (high - low) / self.scales[channel];
        (NUMERICS * root_mean_square(&moved))
            .max(PRACTICAL * range)
            .max(match self.sources[channel] {
                NoiseSource::Resolution => ROUNDED_STEPS * 12f64.sqrt(),
                NoiseSource::HighFrequencies | NoiseSource::Stated => 1.0,
            })
    }

    pub fn channels(&self, series: &[Vec<Series>], real: &[Size]) -> Vec<ChannelFit> {
        let errors = self.errors(series);
        let channels = self
            .quantities
            .iter()
            .enumerate()
            .map(|(channel, quantity)| {
                let slots = self.slots.iter().filter(|slot| slot.channel == channel);
                let own = slots.flat_map(|slot| &errors[slot.samples.clone()]);
                let sizes = real.iter().filter(|size| size.part.channel == channel);
                ChannelFit {
                    channel: quantity.name(),
                    unit: quantity.unit(),
                    noise: self.scales[channel],
                    noise_source: self.sources[channel],
                    residual: self.scales[channel]
                        * root_mean_square(&own.copied().collect::<Vec<f64>>()),
                    systematic: sizes.map(|size| size.deviations).fold(0.0, f64::max),
                }
            });
        channels.collect()
    }

    /// Describes a part of the residuals.
    pub fn misfit(
        &self,
        recorded: &[Trajectory],
        series: &[Vec<Series>],
        part: Part,
        projection: &Projection<'_>,
    ) -> ResidualMisfit {
        let channel = part.channel;
        let rest = projection.rest(&self.errors(series), part.is_bent);
        let slots: Vec<&Slot> = self
            .slots
            .iter()
            .filter(|slot| slot.channel == channel)
            .collect();
        let since_start = |slot: &&Slot| -> Vec<f64> {
            let times_s = recorded[slot.case].times_s();
            times_s.iter().map(|t| t - times_s[0]).collect()
        };
        let times_s: Vec<Vec<f64>> = slots.iter().map(since_start).collect();
        let of_slots = slots.iter().zip(&times_s);
        let differences: Vec<Difference<'_>> = of_slots
            .filter_map(|(slot, times_s)| {
                let own = self.series_at(slot, series)?;
                Some(Difference {
                    times_s,
                    residual: &own.residual,
                    motion: &own.motion,
                })
            })
            .collect();
        let rest_of_channel = |own: &[f64]| {
            let mut all = vec![0.0; rest.len()];
            let mut from = 0;
            for slot in &slots {
                let count = slot.samples.len();
                all[slot.samples.clone()].copy_from_slice(&own[from..from + count]);
                from += count;
            }
            let left = projection.rest(&all, part.is_bent);
            let left = slots
                .iter()
                .flat_map(|slot| left[slot.samples.clone()].to_vec());
            left.collect::<Vec<f64>>()
        };
        let (pattern, size, share) = Pattern::of(&differences, &rest_of_channel);
        let in_quarter = |quarter: usize| -> f64 {
            let squares = slots.iter().map(|slot| {
                let own = &rest[slot.samples.clone()];
                let end = |quarter: usize| quarter * own.len() / QUARTERS;
                let inside = &own[end(quarter)..end(quarter + 1)];
                root_mean_square(inside).powi(2)
            });
            squares.sum()
        };
        let quarter = (0..QUARTERS)
            .max_by(|a, b| in_quarter(*a).total_cmp(&in_quarter(*b)))
            .unwrap_or(0);
        let (_, longest_s) = ends_of(times_s.iter().filter_map(|times| times.last().copied()));
        let at_s = |quarter: usize| longest_s * quarter as f64 / QUARTERS as f64;
        ResidualMisfit {
            channel,
            from_s: at_s(quarter),
            to_s: at_s(quarter + 1),
            pattern,
            size,
            share,
        }
    }
}

/// Standard deviation of a channel's noise of measurement, and where it is known from.
fn size_of(quantity: &Quantity, noise: &MeasurementNoise) -> (f64, NoiseSource) {
    match quantity {
        Quantity::Along | Quantity::Left => (noise.plane_m, NoiseSource::HighFrequencies),
        Quantity::Up => (noise.height_m, NoiseSource::HighFrequencies),
        Quantity::Roll | Quantity::Pitch | Quantity::Heading => {
            (noise.turn_rad, NoiseSource::HighFrequencies)
        }
        Quantity::Joint(name) => {
            let known = noise.joints.get(name).copied().unwrap_or_default();
            let source = match known.angle_rad.independent > 0.0 {
                true => NoiseSource::HighFrequencies,
                false => NoiseSource::Resolution,
            };
            (known.angle_rad.size(), source)
        }
    }
}

fn root_mean_square(all: &[f64]) -> f64 {
    let squares: f64 = all.iter().map(|value| value * value).sum();
    (squares / all.len().max(1) as f64).sqrt()
}
