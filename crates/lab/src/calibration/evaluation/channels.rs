//! Errors of scored channels over the recordings of a study.

use serde::Serialize;

use realgap_path::comparison::ChannelError;

/// The error of one scored channel over all recordings that have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelSummary {
    /// Name of the column.
    pub column: String,
    /// What it holds: angle, speed, torque, current, turn rate or acceleration.
    pub quantity: String,
    /// Unit of the errors.
    pub unit: String,
    /// Mean absolute error over all samples.
    pub mean: f64,
    /// Root mean square error.
    pub rms: f64,
    /// Mean of simulated minus recorded values.
    pub bias: f64,
    /// Standard deviation of the sensor's noise.
    pub noise: f64,
    /// Whether the study states this noise; otherwise it was measured in the recordings.
    pub noise_is_stated: bool,
    /// Mean absolute error in standard deviations of the noise.
    pub in_noise: f64,
    /// Number of samples.
    pub samples: usize,
    /// So many independent errors tell as much as these, because neighbouring errors are alike.
    pub independent: f64,
}

impl ChannelSummary {
    /// One summary for each channel, in the order of their first recording.
    pub(super) fn all<'a>(errors: impl Iterator<Item = &'a ChannelError>) -> Vec<Self> {
        let mut channels: Vec<(&ChannelError, Vec<&ChannelError>)> = Vec::new();
        for error in errors {
            let mut known = channels.iter_mut();
            match known.find(|(first, _)| first.channel.column == error.channel.column) {
                Some((_, all)) => all.push(error),
                None => channels.push((error, vec![error])),
            }
        }
        let summary = |(first, all): (&ChannelError, Vec<&ChannelError>)| {
            let samples: usize = all.iter().map(|error| error.samples).sum();
            let mean_of = |of: &dyn Fn(&ChannelError) -> f64| {
                let sum: f64 = all.iter().map(|e| e.samples as f64 * of(e)).sum();
                sum / samples.max(1) as f64
            };
            let channel = &first.channel;
            Self {
                column: channel.column.clone(),
                quantity: channel.quantity.word().to_owned(),
                unit: channel.quantity.unit().to_owned(),
                mean: mean_of(&|error| error.mean),
                rms: mean_of(&|error| error.rms.powi(2)).sqrt(),
                bias: mean_of(&|error| error.bias),
                noise: channel.noise,
                noise_is_stated: channel.is_stated,
                in_noise: mean_of(&|error| error.in_noise),
                samples,
                independent: all.iter().map(|error| error.independent).sum(),
            }
        };
        channels.into_iter().map(summary).collect()
    }
}
