//! Scores of probability forecasts: Brier score and reliability diagram.

use serde::Serialize;

use super::proportion::Proportion;

/// Brier's score of one forecast (Brier 1950): the squared difference of each event's probability from 1 if the event happened and from 0 if
/// it did not, summed over all events. It is from 0 to 2; a certain forecast that is wrong has 2.
///
/// ```
/// use realgap_core::statistics::brier;
///
/// assert_eq!(brier(&[0.0, 1.0, 0.0], 1), 0.0);
/// assert_eq!(brier(&[0.0, 1.0, 0.0], 2), 2.0);
/// assert_eq!(brier(&[0.5, 0.5], 0), 0.5);
/// ```
pub fn brier(probabilities: &[f64], happened: usize) -> f64 {
    let terms = probabilities
        .iter()
        .enumerate()
        .map(|(event, probability)| {
            let truth = if event == happened { 1.0 } else { 0.0 };
            (probability - truth).powi(2)
        });
    terms.sum()
}

/// The observed frequency of events that were forecast with about the same probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReliabilityBin {
    /// Mean of the forecast probabilities.
    pub probability: f64,
    /// The observed frequency of the events, with its 95 % interval (Wilson).
    pub observed: Proportion,
}

/// Level of the intervals of [`reliability`].
const LEVEL: f64 = 0.95;

/// Groups forecasts into ten bins of equal width; a forecast is a probability, and whether the event happened. Empty bins are left out.
pub fn reliability(forecasts: &[(f64, bool)]) -> Vec<ReliabilityBin> {
    let bin_of = |probability: f64| ((10.0 * probability) as usize).min(9);
    let bins = (0..10).filter_map(|bin| {
        let own: Vec<&(f64, bool)> = forecasts.iter().filter(|f| bin_of(f.0) == bin).collect();
        let happened = own.iter().filter(|f| f.1).count();
        (!own.is_empty()).then(|| ReliabilityBin {
            probability: own.iter().map(|f| f.0).sum::<f64>() / own.len() as f64,
            observed: Proportion::new(happened, own.len(), LEVEL),
        })
    });
    bins.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_count_the_events_forecast_with_their_probability() {
        let bins = reliability(&[(0.05, false), (0.08, true), (1.0, true)]);
        assert_eq!(bins.len(), 2);
        assert!((bins[0].probability - 0.065).abs() < 1e-12);
        assert_eq!((bins[0].observed.count, bins[0].observed.trials), (1, 2));
        assert_eq!((bins[1].observed.count, bins[1].observed.trials), (1, 1));
    }
}
