//! The verdict on values that are given, not fitted: how far runs with them are from recordings, where the values come from, and
//! whether to trust them.

use std::collections::BTreeMap;

use super::headline::cannot;
use super::parameter::NAMED;
use super::{About, Claim, Conclusion, listed};
use crate::prediction::gap::MetricGap;
use realgap_core::statistics::mean_of;
use realgap_core::unit::{Unit, counted, number, quantity};

/// Fewer recordings than this contradict hardly anything.
pub(crate) const FEW: usize = 3;

/// The row of the metric by which a gap is told: the first in a unit that people use, else the first.
pub(crate) fn told(rows: &[MetricGap]) -> Option<&MetricGap> {
    let compared = |row: &&MetricGap| row.repeats.is_some() || row.ideal.is_some();
    let mut known = rows.iter().filter(compared);
    let first = known.clone().next();
    known.find(|row| row.unit != Unit::One).or(first)
}

/// How far repeats, or the run without noise where there are none, are from `reality` by a metric.
pub(crate) fn measured(row: &MetricGap, (reality, recordings): (&str, usize)) -> Option<Claim> {
    let (what, found) = match (row.repeats, row.ideal) {
        (Some(found), _) => ("Simulated repeats are", found),
        (None, Some(found)) => ("The simulation without noise is", found),
        (None, None) => return None,
    };
    let distance = quantity(found.gap.value, row.unit);
    let ratio = found.ratio.map(|ratio| ratio.value);
    let floors = ratio.map_or_else(String::new, |ratio| {
        format!(
            ", and {} noise floors (1: as far as repeats are from each other)",
            number(ratio)
        )
    });
    let text = format!(
        "{what} {distance} away from {reality} by {}, on average over {}{floors}.",
        row.metric,
        counted(recordings, "recording")
    );
    let numbers = [
        ("gap", found.gap.value),
        ("noise_floors", ratio.unwrap_or(f64::NAN)),
    ];
    Some(
        Claim::new(About::Gap, Conclusion::Supported, distance, text)
            .of(row.metric)
            .resting_on(recordings, &numbers),
    )
}

/// How far recorded paths are from the repeats of the behaviour that is nearest to each; `None` without recordings.
pub(crate) fn beside(distances_m: &[f64], reality: &str) -> Option<Claim> {
    let recordings = distances_m.len();
    if recordings == 0 {
        return None;
    }
    let mean_m = mean_of(distances_m.iter().copied());
    let distance = quantity(mean_m, Unit::Metre);
    let text = format!(
        "Paths of {reality} are {distance} away from simulated repeats of the nearest behaviour, on average over {}.",
        counted(recordings, "recording")
    );
    Some(
        Claim::new(About::Gap, Conclusion::Supported, distance, text)
            .of("rms")
            .resting_on(recordings, &[("distance_m", mean_m)]),
    )
}

/// The values of a simulation that nothing was fitted for, and whether an earlier fit has seen the `recordings`.
pub(crate) fn values(
    given: &BTreeMap<String, f64>,
    seen_by_fit: Option<usize>,
    recordings: usize,
) -> Claim {
    let named = given.iter();
    let named = named.map(|(name, value)| format!("{name} = {}", number(*value)));
    let said = match given.len() {
        0 => "all of them those of the robot's and the study's files".to_owned(),
        1..=NAMED => named.collect::<Vec<_>>().join(", "),
        many => format!("{many} of them set"),
    };
    let from = match seen_by_fit {
        None => String::new(),
        Some(0) => ", from a fit that has not seen these recordings".to_owned(),
        Some(seen) => format!(", from a fit to {seen} of these {recordings} recordings"),
    };
    let text = format!("Values are as given, not fitted here: {said}{from}.");
    let numbers = [("given", given.len() as f64)];
    Claim::new(
        About::Parameters,
        Conclusion::Inconclusive,
        "as given",
        text,
    )
    .resting_on(recordings, &numbers)
}

/// What a comparison of runs with recordings found, for the question whether to trust the runs.
#[derive(Debug, Clone)]
pub(crate) struct Comparison {
    /// Whether the runs came to their end.
    pub complete: bool,
    /// What contradicts the simulation, as parts of a sentence.
    pub against: Vec<String>,
    /// What was tested and did not contradict it; `None` where nothing could.
    pub tested: Option<String>,
    /// What would tell where nothing was tested.
    pub would_tell: String,
    /// How many of the recordings the values were fitted on; `None` where no fit is known.
    pub seen_by_fit: Option<usize>,
    /// Recordings that the runs were compared with.
    pub recordings: usize,
}

/// Whether runs with given values may be trusted, by the same four answers as a fit.
pub(crate) fn trust_of(comparison: &Comparison) -> Claim {
    let recordings = comparison.recordings;
    let counted = counted(recordings, "recording");
    let untested = "fits, not yet tested on others";
    let (says, word, text) = match (&comparison.tested, comparison.seen_by_fit) {
        _ if !comparison.complete => cannot("the run is unfinished; finish it"),
        _ if !comparison.against.is_empty() => (
            Conclusion::Rejected,
            "does not explain the recordings",
            format!(
                "The simulation does not explain the recordings: {}.",
                listed(&comparison.against)
            ),
        ),
        (None, _) => cannot(&comparison.would_tell),
        (Some(tested), Some(0)) => (
            Conclusion::Supported,
            "holds on others",
            format!("The values hold on {counted} that their fit has not seen: {tested}."),
        ),
        (Some(tested), Some(seen)) => (
            Conclusion::Supported,
            untested,
            format!(
                "The simulation fits the recordings: {tested}; the values were fitted on {seen} of them, so compare with recordings that the fit has not seen."
            ),
        ),
        (Some(tested), None) => (
            Conclusion::Supported,
            untested,
            format!(
                "The simulation fits the recordings: {tested}; whether its values were chosen by these recordings is not known, so compare with others, too."
            ),
        ),
    };
    let seen = comparison.seen_by_fit;
    let numbers = [
        ("contradictions", comparison.against.len() as f64),
        ("seen_by_fit", seen.map_or(f64::NAN, |seen| seen as f64)),
    ];
    Claim::new(About::Trust, says, word, text).resting_on(recordings, &numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison() -> Comparison {
        Comparison {
            complete: true,
            against: Vec::new(),
            tested: Some("no difference is found".to_owned()),
            would_tell: "record repeats".to_owned(),
            seen_by_fit: None,
            recordings: 8,
        }
    }

    #[test]
    fn only_recordings_that_no_fit_has_seen_show_that_values_hold_on_others() {
        let of = |seen_by_fit| {
            let found = Comparison {
                seen_by_fit,
                ..comparison()
            };
            trust_of(&found).word
        };
        assert_eq!(of(Some(0)), "holds on others");
        for seen in [None, Some(1), Some(8)] {
            assert_eq!(of(seen), "fits, not yet tested on others");
        }
    }

    #[test]
    fn a_contradiction_outweighs_every_test_and_an_unfinished_run_tells_nothing() {
        let against = Comparison {
            against: vec!["repeats differ".to_owned()],
            seen_by_fit: Some(0),
            ..comparison()
        };
        let said = trust_of(&against);
        assert_eq!(said.word, "does not explain the recordings");
        assert!(said.text.contains("repeats differ"), "{}", said.text);
        let unfinished = Comparison {
            complete: false,
            ..against
        };
        assert_eq!(trust_of(&unfinished).word, "cannot be told");
    }

    #[test]
    fn where_nothing_was_tested_the_verdict_says_what_would_tell() {
        let untested = Comparison {
            tested: None,
            ..comparison()
        };
        let said = trust_of(&untested);
        assert_eq!(said.word, "cannot be told");
        assert!(said.text.contains("record repeats"), "{}", said.text);
    }
}
