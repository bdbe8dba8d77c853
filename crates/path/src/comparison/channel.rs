//! Scored channels: recorded columns that are compared with the simulation, each in units of its own noise.

use std::f64::consts::TAU;

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::{
    COMMAND, COMMAND_SIGNALS, Interpolator, MeasuredQuantity, Trajectory, sensor_noise,
};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::statistics::autocorrelation_time;
use realgap_core::unit::Unit;

/// What a channel holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelQuantity {
    /// Angle of a joint, radians.
    Angle,
    /// Speed of a joint, rad/s.
    Speed,
    /// What another sensor measured.
    Measured(MeasuredQuantity),
    /// A column with a name of its own, which only a study's own simulator can know.
    Signal,
}

impl ChannelQuantity {
    /// What this is called, without its unit.
    pub fn word(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Speed => "speed",
            Self::Measured(quantity) => quantity.word(),
            Self::Signal => "signal",
        }
    }

    /// Symbol of the unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Speed => "rad/s",
            Self::Measured(quantity) => quantity.unit(),
            Self::Signal => "",
        }
    }
}

/// A recorded column that is compared, with its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name of the column as in realgap's own files, with its unit.
    pub column: String,
    /// What it holds.
    pub quantity: ChannelQuantity,
    /// Standard deviation of the sensor's noise, in the unit of the column.
    pub noise: f64,
    /// Whether the noise was stated. The relative weights of such channels are then fixed; other channels weigh by what the fit
    /// leaves of them.
    pub is_stated: bool,
    /// Standard deviation of the recorded values, in the unit of the column.
    pub spread: f64,
}

/// The values that a trajectory has of a column of this quantity.
fn values<'a>(motion: &'a Trajectory, column: &str, of: ChannelQuantity) -> Option<&'a [f64]> {
    match of {
        ChannelQuantity::Angle => {
            let joint = motion.joint(column.strip_suffix("_rad")?)?;
            Some(&joint.angles_rad)
        }
        ChannelQuantity::Speed => {
            let joint = motion.joint(column.strip_suffix("_rad_s")?)?;
            joint.speeds_rad_s.as_deref()
        }
        ChannelQuantity::Measured(_) | ChannelQuantity::Signal => {
            Some(&motion.signal(column)?.values)
        }
    }
}

impl Channel {
    /// The columns of a recording that can be channels, with what they hold.
    pub fn columns_of(motion: &Trajectory) -> Vec<(String, ChannelQuantity)> {
        let joints = motion.joints().iter();
        let joints = joints.filter(|joint| !joint.name.ends_with(COMMAND));
        let joints = joints.flat_map(|joint| {
            let angle = (format!("{}_rad", joint.name), ChannelQuantity::Angle);
            let speed = joint.speeds_rad_s.as_ref();
            let speed = speed.map(|_| (format!("{}_rad_s", joint.name), ChannelQuantity::Speed));
            std::iter::once(angle).chain(speed)
        });
        let signals = motion.signals().iter().filter_map(|signal| {
            let (_, quantity) = MeasuredQuantity::of_column(&signal.name)?;
            Some((signal.name.clone(), ChannelQuantity::Measured(quantity)))
        });
        joints.chain(signals).collect()
    }

    /// The columns of a recording with names of their own, which are no commands.
    pub fn signals_of(motion: &Trajectory) -> Vec<(String, ChannelQuantity)> {
        let names = motion.signals().iter().map(|signal| &signal.name);
        let is_command = |name: &str| {
            let mut endings = COMMAND_SIGNALS.iter().chain([&COMMAND]);
            endings.any(|ending| name.ends_with(ending))
        };
        let own = names.filter(|name| MeasuredQuantity::of_column(name).is_none());
        own.filter(|name| !is_command(name))
            .map(|name| (name.clone(), ChannelQuantity::Signal))
            .collect()
    }

    /// The channel of a column with stated noise, or with the noise that these recordings show (the median over them).
    ///
    /// # Errors
    /// A noise that is not a positive number, or a column that never changes and states none.
    pub fn new(
        (column, quantity): (&str, ChannelQuantity),
        stated: Option<f64>,
        motions: &[&Trajectory],
    ) -> Result<Self> {
        let all = motions.iter().filter_map(|m| values(m, column, quantity));
        let all: Vec<&[f64]> = all.collect();
        let unit = quantity.unit();
        let count = all.iter().map(|values| values.len()).sum::<usize>() as f64;
        let mean = all.iter().flat_map(|v| v.iter()).sum::<f64>() / count;
        let squares = all
            .iter()
            .flat_map(|v| v.iter())
            .map(|v| (v - mean).powi(2));
        let spread = (squares.sum::<f64>() / count).sqrt();
        let noise = match stated {
            Some(noise) if noise > 0.0 && noise.is_finite() => noise,
            Some(noise) => {
                return Err(Error::invalid("not a noise of a channel")
                    .field(column)
                    .found(noise)
                    .allowed(format!("a standard deviation above 0 {unit}")));
            }
            None => {
                let mut found: Vec<f64> = all.iter().filter_map(|v| sensor_noise(v)).collect();
                found.sort_by(f64::total_cmp);
                *found.get(found.len() / 2).ok_or_else(|| {
                    Error::invalid("a channel never changes, so that its noise cannot be measured")
                        .field(column)
                        .hint("state its `noise`, or do not name it in `channels`")
                })?
            }
        };
        Ok(Self {
            column: column.to_owned(),
            quantity,
            noise,
            is_stated: stated.is_some(),
            spread,
        })
    }

    fn is_in(&self, motion: &Trajectory) -> bool {
        values(motion, &self.column, self.quantity).is_some()
    }

    /// Recorded and simulated values of this channel.
    fn both<'a>(&self, real: &'a Trajectory, simulated: &'a Trajectory) -> Result<[&'a [f64]; 2]> {
        let of = |motion: &'a Trajectory| values(motion, &self.column, self.quantity);
        match (of(real), of(simulated)) {
            (Some(recorded), Some(simulated)) => Ok([recorded, simulated]),
            _ => Err(Error::invalid("the simulation has no such channel").field(&self.column)),
        }
    }

    /// Simulated value minus recorded value; angles are wrapped to half a turn.
    fn difference(
        &self,
        [recorded, simulated]: [&[f64]; 2],
        at: &mut Interpolator<'_>,
        since_start_s: f64,
        sample: usize,
    ) -> f64 {
        let error = at.number(simulated, since_start_s) - recorded[sample];
        match self.quantity {
            ChannelQuantity::Angle => error - TAU * (error / TAU).round(),
            _ => error,
        }
    }

    /// Standard deviation of rounding to steps of this size is the channel's noise.
    fn step(&self) -> f64 {
        12.0_f64.sqrt() * self.noise
    }
}

/// The channels of a study, in the order of their errors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChannelSet(Vec<Channel>);

/// The errors of one channel among those of [`ChannelSet::errors`], which come channel after channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelSeries {
    /// Number of the channels that share a scale.
    pub group: usize,
    /// Number of errors.
    pub count: usize,
    /// Step between recorded values whose rounding would be the channel's noise, in the unit of the errors.
    pub step: f64,
}

impl ChannelSet {
    /// These channels.
    pub fn new(channels: Vec<Channel>) -> Self {
        Self(channels)
    }

    /// The channels.
    pub fn all(&self) -> &[Channel] {
        &self.0
    }

    /// The channels that this recording has.
    fn of<'a>(&'a self, recorded: &'a Trajectory) -> impl Iterator<Item = (usize, &'a Channel)> {
        let all = self.0.iter().enumerate();
        all.filter(|(_, channel)| channel.is_in(recorded))
    }

    /// The unit of a channel's errors for least squares, in the unit of the column. Channels whose noise was measured have that of
    /// their spread, because each gets a scale of its own. Channels whose noise was stated have a multiple of their noise that is
    /// the same for all of them.
    fn error_unit(&self, channel: &Channel) -> f64 {
        if !channel.is_stated {
            return channel.spread.max(channel.step());
        }
        let stated = self.0.iter().filter(|channel| channel.is_stated);
        let ratios = stated.map(|c| (c.spread.max(c.step()) / c.noise).ln());
        let (sum, count) =
            ratios.fold((0.0, 0.0), |(sum, count), ratio| (sum + ratio, count + 1.0));
        channel.noise * (sum / count).exp()
    }

    /// The single errors for least squares, about `most`, each channel in its own unit ([`ChannelSet::series`] says which are
    /// whose).
    ///
    /// # Errors
    /// A simulation without one of the recorded channels.
    pub fn errors(&self, pair: &Pair<'_>, most: usize) -> Result<Vec<f64>> {
        let times_s = pair.real.times_s();
        let mut at = Interpolator::new(pair.simulated);
        let mut errors = Vec::new();
        let count = self.of(pair.real).count();
        for (_, channel) in self.of(pair.real) {
            let (both, unit) = (
                channel.both(pair.real, pair.simulated)?,
                self.error_unit(channel),
            );
            for sample in super::joint::samples(times_s.len(), count, most) {
                let since_start_s = times_s[sample] - times_s[0];
                errors.push(channel.difference(both, &mut at, since_start_s, sample) / unit);
            }
        }
        Ok(errors)
    }

    /// How the errors of a recording are ordered.
    pub fn series(&self, recorded: &Trajectory, most: usize) -> Vec<ChannelSeries> {
        let channels: Vec<(usize, &Channel)> = self.of(recorded).collect();
        let first_stated = self.0.iter().position(|channel| channel.is_stated);
        let count = super::joint::samples(recorded.times_s().len(), channels.len(), most).count();
        let series = channels.into_iter().map(|(index, channel)| ChannelSeries {
            group: match channel.is_stated {
                true => first_stated.unwrap_or(index),
                false => index,
            },
            count,
            step: channel.step() / self.error_unit(channel),
        });
        series.collect()
    }

    /// The error of every channel that was recorded, over the recorded samples within the simulation.
    ///
    /// # Errors
    /// A simulation without one of the recorded channels.
    pub fn compare(&self, real: &Trajectory, simulated: &Trajectory) -> Result<Vec<ChannelError>> {
        let samples = self.samples(real, simulated)?;
        let error = |samples: ChannelSamples| {
            // The first sample is that from which the run starts.
            let own = samples.recorded.iter().zip(&samples.simulated).skip(1);
            let off: Vec<f64> = own
                .map(|(recorded, simulated)| simulated - recorded)
                .collect();
            let count = off.len().max(1) as f64;
            let noise = samples.channel.noise;
            let absolute = off.iter().map(|off| off.abs()).sum::<f64>() / count;
            ChannelError {
                channel: samples.channel,
                mean: absolute,
                rms: (off.iter().map(|off| off * off).sum::<f64>() / count).sqrt(),
                bias: off.iter().sum::<f64>() / count,
                in_noise: absolute / noise,
                samples: off.len(),
                independent: off.len() as f64 / autocorrelation_time(&off),
            }
        };
        Ok(samples.into_iter().map(error).collect())
    }

    /// Recorded and simulated values of every channel that was recorded, at the recorded samples within the simulation.
    ///
    /// # Errors
    /// A simulation without one of the recorded channels.
    pub fn samples(
        &self,
        real: &Trajectory,
        simulated: &Trajectory,
    ) -> Result<Vec<ChannelSamples>> {
        let end_s = simulated.duration_s() * (1.0 + 1e-9) + 1e-9;
        let since_start = real.times_s().iter().map(|t| t - real.times_s()[0]);
        let times_s: Vec<f64> = since_start.take_while(|t| *t <= end_s).collect();
        let one = |channel: &Channel| -> Result<ChannelSamples> {
            let [recorded, there] = channel.both(real, simulated)?;
            let mut at = Interpolator::new(simulated);
            let places = times_s.iter().enumerate();
            let simulated = places
                .map(|(k, t)| recorded[k] + channel.difference([recorded, there], &mut at, *t, k));
            Ok(ChannelSamples {
                channel: channel.clone(),
                simulated: simulated.collect(),
                recorded: recorded[..times_s.len()].to_vec(),
                times_s: times_s.clone(),
            })
        };
        self.of(real).map(|(_, channel)| one(channel)).collect()
    }
}

/// The error of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelError {
    /// The channel.
    pub channel: Channel,
    /// Mean absolute error, in the unit of the column.
    pub mean: f64,
    /// Root mean square error, in the unit of the column.
    pub rms: f64,
    /// Mean of simulated minus recorded values, in the unit of the column.
    pub bias: f64,
    /// Mean absolute error in standard deviations of the channel's noise.
    pub in_noise: f64,
    /// Number of samples.
    pub samples: usize,
    /// So many independent errors tell as much as these, because neighbouring errors are alike.
    pub independent: f64,
}

/// The values of one channel over time.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSamples {
    /// The channel.
    pub channel: Channel,
    /// Times since the start of the recording, seconds.
    pub times_s: Vec<f64>,
    /// Recorded values, in the unit of the column.
    pub recorded: Vec<f64>,
    /// Simulated values, in the unit of the column; angles are wrapped to within half a turn of the recorded ones.
    pub simulated: Vec<f64>,
}

/// Mean over the channels of a study of the mean absolute error in standard deviations of the channel's noise. The study names the
/// channels ([`Context::channels`]); no other comparison can use this metric.
#[derive(Debug, Clone, Copy)]
pub struct Channels;

impl Metric for Channels {
    constant_methods! {
        name: &'static str = "channels";
        column: &'static str = "channels_sd";
        unit: Unit = Unit::One;
        doc: &'static str = "mean error of the channels that a study names, each in standard deviations of its noise";
        needs: Needs = Needs {
            joints: true,
            ..Needs::default()
        };
        is_symmetric: bool = false;
        has_errors: bool = true;
    }

    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement> {
        let none = || {
            Error::invalid("the recording has none of the channels of its study")
                .allowed("columns that `channels` of the study names")
        };
        let set = context.channels.ok_or_else(none)?;
        let errors = set.compare(pair.real, pair.simulated)?;
        let samples = errors.first().ok_or_else(none)?.samples;
        let sum: f64 = errors.iter().map(|error| error.in_noise).sum();
        Ok(Measurement::new(sum / errors.len() as f64, samples))
    }
}
