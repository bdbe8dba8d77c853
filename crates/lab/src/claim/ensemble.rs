//! Whether the regions of an ensemble hold as many recordings as they state.

use super::{About, Claim, Conclusion, SIGNIFICANT, called, listed};
use realgap_core::statistics::{EnergyTest, Proportion};
use realgap_core::unit::{counted, number};
use realgap_path::trajectory::Source;

/// How the share of recordings in a region compares with its stated level: a smaller share means that the region is too narrow.
fn width(level: f64, held: &Proportion) -> Option<&'static str> {
    if held.high < level {
        Some("too narrow")
    } else if held.low > level {
        Some("too wide")
    } else {
        None
    }
}

/// Whether one region holds as many recordings as it states, at the end and as whole paths.
pub(crate) fn region(level: f64, at_end: &Proportion, whole_path: Option<&Proportion>) -> Claim {
    let at_the_end = width(level, at_end);
    let as_a_whole = whole_path.and_then(|held| width(level, held));
    let word = match (at_the_end, as_a_whole) {
        (None, None) => "not contradicted".to_owned(),
        (Some(end), Some(whole)) if end != whole => {
            format!("NO: region {end} at the end, {whole} along the path")
        }
        (Some(width), _) | (None, Some(width)) => format!("NO: region {width}"),
    };
    let says = match (at_the_end, as_a_whole) {
        (None, None) => Conclusion::Supported,
        _ => Conclusion::Rejected,
    };
    let share = |held: &Proportion| {
        let (count, trials) = (held.count, held.trials);
        let [low, high] = [held.low, held.high].map(|share| 100.0 * share);
        format!("{count} of {trials} (95 %: {low:.0} to {high:.0} %)")
    };
    let whole = whole_path.map_or_else(String::new, |held| {
        format!(", and {} stay whole in its band", share(held))
    });
    let percent = format!("{:.0} %", 100.0 * level);
    let end = share(at_end);
    let text = format!("The region of {percent} holds {end} at the end{whole}: {word}.");
    let none = f64::NAN;
    let numbers = [
        ("at_end", at_end.share),
        ("at_end_low", at_end.low),
        ("at_end_high", at_end.high),
        ("whole_path", whole_path.map_or(none, |held| held.share)),
        ("whole_path_low", whole_path.map_or(none, |held| held.low)),
        ("whole_path_high", whole_path.map_or(none, |held| held.high)),
    ];
    Claim::new(About::Region, says, word, text)
        .of(percent)
        .resting_on(at_end.trials, &numbers)
        .at_level(level)
}

/// Whether recordings contradict an ensemble: by its regions (at the end and as whole paths) or by the energy test.
/// `None` without a region.
pub(crate) fn recorded(
    regions: &[Claim],
    alike: Option<&EnergyTest>,
    source: Source,
) -> Option<Claim> {
    let last = regions.last()?;
    let against = contradictions(regions, alike, source);
    let test = alike.map(|test| format!("energy test by rms: p = {}", number(test.p_value)));
    let runs = counted(last.count, "recording");
    let evidence = test.map_or_else(String::new, |test| format!(" ({test})"));
    let (says, word, text) = if against.is_empty() {
        let text =
            format!("Nothing contradicts these confidences, as far as {runs} can show{evidence}.");
        (Conclusion::Supported, "not contradicted", text)
    } else {
        let text = format!(
            "These confidences are CONTRADICTED by {runs}: {}{evidence}.",
            listed(&against)
        );
        (Conclusion::Rejected, "CONTRADICTED", text)
    };
    let p_value = alike.map_or(f64::NAN, |test| test.p_value);
    Some(
        Claim::new(About::Ensemble, says, word, text)
            .resting_on(last.count, &[("p_value", p_value)]),
    )
}

/// What contradicts an ensemble, as parts of a sentence: regions that hold too few or too many recordings, and the energy test.
pub(crate) fn contradictions(
    regions: &[Claim],
    alike: Option<&EnergyTest>,
    source: Source,
) -> Vec<String> {
    let failed = regions
        .iter()
        .filter(|claim| claim.conclusion == Conclusion::Rejected);
    let mut against: Vec<String> = failed
        .map(|claim| {
            format!(
                "the {}",
                claim
                    .word
                    .replacen("NO: region", &format!("region of {} is", claim.name), 1)
            )
        })
        .collect();
    let reality = called(source);
    if alike.is_some_and(|test| test.p_value < SIGNIFICANT) {
        against.push(format!("repeats do NOT have the distribution of {reality}"));
    }
    against
}
