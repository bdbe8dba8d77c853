//! How far a simulation is from its recordings, whether its repeats have their distribution, and until which time.

use super::{About, Claim, Conclusion, SIGNIFICANT};
use crate::prediction::gap::{Confidence, MetricGap, SetFloor};
use realgap_core::statistics::EnergyTest;
use realgap_core::unit::{Unit, counted, number, quantity};
use realgap_path::trajectory::Source;

/// What the recordings stand for, in words.
pub(crate) fn called(source: Source) -> &'static str {
    match source {
        Source::StandIn => "the stand-in for reality",
        Source::Real => "reality",
    }
}

/// Whether simulated repeats have the distribution of the recordings, by a metric.
pub(crate) fn likeness(
    metric: &str,
    alike: &EnergyTest,
    (source, recordings): (Source, usize),
) -> Claim {
    let reality = called(source);
    let test = format!(
        "(energy test by {metric}, p = {}, {})",
        number(alike.p_value),
        counted(recordings, "recording")
    );
    let (says, word, text) = if alike.p_value < SIGNIFICANT {
        let text = format!("Simulated repeats do NOT have the distribution of {reality} {test}.");
        (Conclusion::Rejected, "distributions differ", text)
    } else {
        let text =
            format!("No difference is found between simulated repeats and {reality} {test}.");
        (Conclusion::Supported, "no difference found", text)
    };
    Claim::new(About::Likeness, says, word, text)
        .of(metric)
        .resting_on(recordings, &[("p_value", alike.p_value)])
}

/// How many noise floors the simulation is away from the recordings by a metric: its repeats, or the run without noise where there
/// are none. `None` where nothing was compared.
pub(crate) fn distance(row: &MetricGap, (source, recordings): (Source, usize)) -> Option<Claim> {
    let found = row.repeats.or(row.ideal)?;
    let (reality, metric) = (called(source), row.metric);
    let gap = quantity(found.gap.value, row.unit);
    let claim = |says, word: String, text| Claim::new(About::Distance, says, word, text).of(metric);
    let numbers = [("gap", found.gap.value)];
    let Some((ratio, floor)) = found.ratio.zip(row.floor) else {
        let text = format!(
            "How many noise floors the simulation is away is not determined: {metric} {gap} from {reality}, and there are no repeats of the recorded run."
        );
        return Some(
            claim(Conclusion::Inconclusive, "not determined".to_owned(), text)
                .resting_on(recordings, &numbers),
        );
    };
    let sure = match (ratio.low, ratio.high) {
        (Some(low), Some(high)) => format!("95 %: {} to {}", number(low), number(high)),
        _ => "too few recordings for an interval".to_owned(),
    };
    let value = number(ratio.value);
    let text = format!(
        "The simulation is {value} noise floors away from {reality} ({sure}; 1 means as far on average as repeats are from each other, which does not mean that the distributions are equal): {metric} {gap} where repeats of the recorded run are {} apart.",
        quantity(floor.value, row.unit)
    );
    let ends = [("low", ratio.low), ("high", ratio.high)];
    let ends = ends.map(|(name, end)| (name, end.unwrap_or(f64::NAN)));
    let claim = claim(Conclusion::Supported, format!("{value} noise floors"), text)
        .resting_on(recordings, &numbers)
        .resting_on(
            recordings,
            &[("ratio", ratio.value), ("floor", floor.value)],
        )
        .resting_on(recordings, &ends);
    Some(claim.at_level(0.95))
}

/// For how long the recordings stay in the regions of the repeats.
pub(crate) fn over_time(confidence: &Confidence) -> Claim {
    let recordings = confidence.inside.first().map_or(0, |inside| inside.trials);
    let drop = confidence.drop_in_words();
    let (low, high) = confidence.over_time_interval;
    let text = format!(
        "{:.0} % ({:.0} to {:.0} %) of {} are inside the region that should hold {:.0} %, mean over time; {drop}.",
        100.0 * confidence.over_time,
        100.0 * low,
        100.0 * high,
        counted(recordings, "recording"),
        100.0 * confidence.level,
    );
    let or_none = |time_s: Option<f64>| time_s.unwrap_or(f64::NAN);
    let says = match (confidence.below_half_s, confidence.surely_below_half_s) {
        _ if high < confidence.level => Conclusion::Rejected,
        (_, Some(_)) => Conclusion::Rejected,
        (Some(_), None) => Conclusion::Inconclusive,
        (None, None) => Conclusion::Supported,
    };
    let numbers = [
        ("over_time", confidence.over_time),
        ("over_time_low", low),
        ("over_time_high", high),
        ("below_half_s", or_none(confidence.below_half_s)),
        (
            "surely_below_half_s",
            or_none(confidence.surely_below_half_s),
        ),
    ];
    Claim::new(About::OverTime, says, drop, text)
        .resting_on(recordings, &numbers)
        .at_level(confidence.level)
}

/// What the claims about distribution and regions say against a simulation, and what for it, as parts of sentences.
pub(crate) fn tests(
    alike: Option<&Claim>,
    over_time: Option<&Claim>,
    reality: &str,
) -> (Vec<String>, Vec<String>) {
    let p = |claim: &Claim| claim.numbers.get("p_value").copied().unwrap_or(f64::NAN);
    let of_distribution = alike.map(|claim| {
        let p = number(p(claim));
        let said = match claim.conclusion {
            Conclusion::Rejected => {
                format!("its repeats do not have the distribution of {reality} (p = {p})")
            }
            _ => format!("no difference is found between its repeats and {reality} (p = {p})"),
        };
        (claim.conclusion, said)
    });
    let of_regions = over_time.map(|claim| {
        let said = match claim.conclusion {
            Conclusion::Rejected => "recordings leave the region of its repeats too often",
            _ => "recordings stay in the region of its repeats",
        };
        (claim.conclusion, format!("{said} ({})", claim.word))
    });
    let (mut against, mut passed) = (Vec::new(), Vec::new());
    for (conclusion, said) in [of_distribution, of_regions].into_iter().flatten() {
        match conclusion {
            Conclusion::Rejected => against.push(said),
            Conclusion::Supported => passed.push(said),
            Conclusion::Inconclusive => (),
        }
    }
    (against, passed)
}

/// Most sets of recordings that are named one by one.
const SETS: usize = 6;

/// The noise floor of each set of recordings; `None` where no set has repeats.
pub(crate) fn floor(sets: &[SetFloor], (metric, unit): (&str, Unit)) -> Option<Claim> {
    let floors = sets.iter().filter_map(|set| {
        let floor = set.floor.metrics.first()?.floor.value;
        Some((set, floor, quantity(floor, unit)))
    });
    let floors: Vec<_> = floors.collect();
    let said: Vec<String> = (floors.iter().take(SETS))
        .map(|(set, _, floor)| match floors.len() {
            1 => floor.clone(),
            _ => format!("{floor} ({})", set.set),
        })
        .collect();
    let word = said.join(", ");
    let text = format!(
        "Repeats of one recorded run are {word} apart in {metric}. A simulation cannot be shown to be nearer than that."
    );
    let recordings = floors.iter().map(|(set, ..)| set.floor.recordings).sum();
    let mut claim = Claim::new(About::Floor, Conclusion::Supported, word, text).of(metric);
    claim.numbers.extend(
        floors
            .iter()
            .map(|(set, floor, _)| (set.set.clone(), *floor)),
    );
    (!floors.is_empty()).then(|| claim.resting_on(recordings, &[]))
}
