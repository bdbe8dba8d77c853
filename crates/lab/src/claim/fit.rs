//! Whether the model explains the recordings, where it is nearest to them, and which points are as near.

use super::parameter::NAMED;
use super::residual::{residuals, unknown};
use super::{About, Claim, Conclusion, SIGNIFICANT, listed};
use crate::calibration::{Best, BestPointUncertainty, Change, EnginePreference, Fit, Misfit};
use realgap_core::unit::{Unit, counted, number, quantity};

/// Whether any parameters explain the recordings.
pub(crate) fn model(fit: &Fit, recordings: usize) -> Claim {
    match &fit.residuals {
        Some(found) => return residuals(found, recordings),
        None if !fit.judged => return unknown(recordings),
        None => (),
    }
    let (says, word, verdict) = match (fit.explains, fit.p_value, fit.neighbours_p_value) {
        (false, ..) => (
            Conclusion::Rejected,
            "NOT explained",
            "No parameters of this model explain these recordings; intervals are widened by the remaining discrepancy",
        ),
        (true, None, None) => (
            Conclusion::Supported,
            "explained",
            "nothing speaks against it, because too few recordings or runs allow no test",
        ),
        (true, Some(p), _) if p < SIGNIFICANT => (
            Conclusion::Supported,
            "explained",
            "yes, though not by the best point's own runs: runs near it come as near to the recordings as one more recording would",
        ),
        (true, ..) => (Conclusion::Supported, "explained", "yes"),
    };
    let noise_floors = fit.noise_floors.unwrap_or(f64::NAN);
    let compared = match fit.noise_floors {
        Some(floors) => {
            let floors = number(floors);
            format!("The best point is {floors} noise floors away from the recordings")
        }
        None => "The recording was compared with repeats under the study's noise".to_owned(),
    };
    let engine = fit.engine.map(|engine| format!("runs of {engine}"));
    let energy = fit
        .p_value
        .map(|p| format!("energy test: p = {}", number(p)));
    let rank = fit.neighbours_p_value.map(|p| {
        format!(
            "rank test against repeats of runs near them: p = {}",
            number(p)
        )
    });
    let details: Vec<String> = engine.into_iter().chain(energy).chain(rank).collect();
    let details = match details.is_empty() {
        true => String::new(),
        false => format!(" ({})", details.join("; ")),
    };
    let worst = fit.misfit.as_ref().map_or_else(String::new, worst);
    let asked = match fit.explains {
        true => "fits within repeatability: ",
        false => "",
    };
    let text = format!("{asked}{verdict}. {compared}{details}{worst}");
    let numbers = [
        ("noise_floors", noise_floors),
        ("p_value", fit.p_value.unwrap_or(f64::NAN)),
        (
            "neighbours_p_value",
            fit.neighbours_p_value.unwrap_or(f64::NAN),
        ),
        ("discrepancy", fit.discrepancy),
    ];
    Claim::new(About::Model, says, word, text).resting_on(recordings, &numbers)
}

/// A change that removes a smaller share of the misfit does not show its cause.
const HALF: f64 = 0.5;

/// Where the nearest run deviates most, and what to check.
fn worst(misfit: &Misfit) -> String {
    let (from_s, to_s) = (number(misfit.from_s), number(misfit.to_s));
    let deviations = number(misfit.deviations);
    let size = number(misfit.size);
    let (changed, look) = match misfit.change {
        Change::Mirrored => ("mirrored".to_owned(), "axes"),
        Change::Lengths => (
            format!("with lengths times {size}"),
            "units, the robot's size, and contacts that let it slip",
        ),
        Change::Pace => (format!("{size} times as fast"), "the gait and its clock"),
        Change::Turning => {
            let deg = number(misfit.size.to_degrees());
            (
                format!("turned by {deg} degrees more along the path"),
                "contacts and servo zeros",
            )
        }
    };
    let share = number(100.0 * misfit.share);
    let hint = match misfit.share >= HALF {
        true => format!("{changed}, it would lose {share} % of its mean square distance: check {look} first"),
        false => "neither mirroring, nor other lengths, nor another pace, nor more turning removes half of its mean square distance: check the robot and its contacts first".to_owned(),
    };
    format!(
        ". The nearest run of all deviates most from {from_s} to {to_s} s, by {deviations} standard deviations; {hint}"
    )
}

/// Where the simulation is nearest to `reality`.
pub(crate) fn nearest(
    best: &Best,
    (metric, unit): (&str, Unit),
    (reality, recordings): (&str, usize),
) -> Claim {
    let values = best.parameters.iter();
    let values: Vec<String> = values
        .map(|(name, value)| format!("{name} = {}", number(*value)))
        .collect();
    let over = match best.settings {
        0 | 1 => " in a single run, which contains the chance of its numerical settings".to_owned(),
        settings => format!(" on average over {settings} equally valid numerical settings"),
    };
    let score = quantity(best.score, unit);
    let place = match values.len() {
        ..=NAMED => values.join(", "),
        many => format!("the best values of its {many} parameters"),
    };
    let text =
        format!("The simulation comes nearest to {reality} at {place}: {metric} {score}{over}.");
    let numbers = [("score", best.score), ("settings", best.settings as f64)];
    Claim::new(About::Best, Conclusion::Supported, score, text)
        .of(metric)
        .resting_on(recordings, &numbers)
}

/// Whether neither of two engines rejects their common best point, or which one alone explains the recordings; `None` for one engine.
pub(crate) fn engines(
    preferences: &[EnginePreference],
    (metric, unit): (&str, Unit),
    recordings: usize,
) -> Option<Claim> {
    if preferences.is_empty() {
        return None;
    }
    let there = preferences.iter().map(|preference| {
        let score = quantity(preference.score, unit);
        format!(
            "{score} in {} (mean of {} runs)",
            preference.engine, preference.settings
        )
    });
    let there = listed(&there.collect::<Vec<_>>());
    let wants = |preference: &EnginePreference| {
        let values = preference.parameters.iter();
        let values = values.map(|(name, value)| format!("{name} = {}", number(*value)));
        let values = values.collect::<Vec<_>>().join(", ");
        let expected = quantity(preference.expected, unit);
        format!(
            "{} alone is best at {values} (expected {expected})",
            preference.engine
        )
    };
    let against = preferences.iter().filter(|preference| !preference.allows());
    let against: Vec<String> = against.map(wants).collect();
    let rejected = preferences.iter().find(|preference| !preference.explains);
    let explaining = preferences.iter().find(|preference| preference.explains);
    let (says, word, text) = match (rejected.zip(explaining), against.is_empty()) {
        (Some((rejected, explaining)), _) => (
            Conclusion::Rejected,
            "one engine explains",
            format!(
                "THE ENGINES DIFFER, and {explains} explains the recordings better than {other} can ({other} has a probability of {probability} \
                 beside it): {metric} {there}; everything else here rests on {explains}; {wants}",
                explains = explaining.engine,
                other = rejected.engine,
                probability = number(rejected.weight),
                wants = wants(rejected),
            ),
        ),
        (None, true) => (
            Conclusion::Supported,
            "the engines agree",
            format!("the engines agree on this point within the uncertainty: {metric} {there}"),
        ),
        (None, false) => (
            Conclusion::Rejected,
            "the engines differ",
            format!(
                "THE ENGINES DIFFER by more than the uncertainty: {metric} {there}; {}; the answer holds the values of both",
                listed(&against)
            ),
        ),
    };
    let mut claim = Claim::new(About::Engines, says, word, text);
    for preference in preferences {
        let of = |what: &str| format!("{}_{what}", preference.engine);
        let numbers = [
            (of("probability"), preference.weight),
            (of("score"), preference.score),
            (of("implausibility"), preference.implausibility),
            (of("expected_at_its_best"), preference.expected),
        ];
        let finite = numbers.into_iter().filter(|(_, value)| value.is_finite());
        claim.numbers.extend(finite);
        let own = preference.parameters.iter();
        claim
            .numbers
            .extend(own.map(|(name, value)| (of(name), *value)));
    }
    Some(claim.of(metric).resting_on(recordings, &[]))
}

/// The confidence set.
pub(crate) fn set(sure: &BestPointUncertainty, recordings: usize) -> Claim {
    let BestPointUncertainty {
        indistinguishable,
        points,
        ..
    } = *sure;
    let text = format!(
        "the {:.0} % confidence set holds {indistinguishable} of {} (uncertainty of {})",
        100.0 * sure.level,
        counted(points, "simulated point"),
        sure.source.label()
    );
    let word = format!("{indistinguishable} of {points}");
    let numbers = [
        ("indistinguishable", indistinguishable as f64),
        ("points", points as f64),
    ];
    Claim::new(About::Set, Conclusion::Supported, word, text)
        .resting_on(recordings, &numbers)
        .at_level(sure.level)
}
