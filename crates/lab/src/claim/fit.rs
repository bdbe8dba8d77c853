//! Does the model explain the recordings, where is it nearest, and what is as near?

use super::parameter::NAMED;
use super::{About, Claim, Conclusion, listed};
use crate::calibration::{Best, BestPointUncertainty, Change, EngineWish, Fit, Misfit};
use realgap_core::unit::{Unit, counted, number, quantity};

/// Whether any parameters explain the recordings.
pub(crate) fn model(fit: &Fit, recordings: usize) -> Claim {
    let alike = fit.p_value.map_or_else(String::new, |p| {
        format!("; drawn alike? p = {} (energy test)", number(p))
    });
    let neighbours = fit.neighbours_p_value.map_or_else(String::new, |p| {
        format!("; like repeats of runs near them? p = {} (rank)", number(p))
    });
    let (says, word, rest) = match fit.explains {
        true => (Conclusion::Supported, "explained", ""),
        false => (
            Conclusion::Rejected,
            "NOT explained",
            ": NO PARAMETERS OF THIS MODEL EXPLAIN THESE RECORDINGS; intervals are widened by what is left",
        ),
    };
    let floors = number(fit.noise_floors);
    let of = fit
        .engine
        .map_or_else(String::new, |engine| format!(" (runs of {engine})"));
    let worst = fit.misfit.as_ref().map_or_else(String::new, worst);
    let text =
        format!("the best is {floors} noise floors away{of}{alike}{neighbours}{rest}{worst}");
    let numbers = [
        ("noise_floors", fit.noise_floors),
        ("p_value", fit.p_value.unwrap_or(f64::NAN)),
        (
            "neighbours_p_value",
            fit.neighbours_p_value.unwrap_or(f64::NAN),
        ),
        ("discrepancy", fit.discrepancy),
    ];
    Claim::new(About::Model, says, word, text).resting_on(recordings, &numbers)
}

/// A change that takes less of the misfit away does not say what is wrong.
const TELLING: f64 = 0.5;

/// Where the run that comes nearest is worst, and what to look at.
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
                format!("turned by {deg} degrees more along the way"),
                "contacts and servo zeros",
            )
        }
    };
    let share = number(100.0 * misfit.share);
    let hint = match misfit.share >= TELLING {
        true => format!("{changed} it would lose {share} % of its square distance: look at {look} first"),
        false => "no mirroring, scaling, pace or turning takes half of its square distance away: look at the robot and its contacts first".to_owned(),
    };
    format!(
        ". The nearest run of all is farthest off from {from_s} to {to_s} s, by {deviations} standard deviations; {hint}"
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
        0 | 1 => " in one run each, numerical luck included".to_owned(),
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

/// Whether the best point of two engines is one that each of them allows; `None` for one engine.
pub(crate) fn engines(
    wishes: &[EngineWish],
    (metric, unit): (&str, Unit),
    recordings: usize,
) -> Option<Claim> {
    if wishes.is_empty() {
        return None;
    }
    let there = wishes.iter().map(|wish| {
        let score = quantity(wish.score, unit);
        format!("{score} in {} (mean of {})", wish.engine, wish.settings)
    });
    let there = listed(&there.collect::<Vec<_>>());
    let wants = |wish: &EngineWish| {
        let values = wish.parameters.iter();
        let values = values.map(|(name, value)| format!("{name} = {}", number(*value)));
        let values = values.collect::<Vec<_>>().join(", ");
        let expected = quantity(wish.expected, unit);
        format!(
            "{} by itself wants {values} ({expected} expected)",
            wish.engine
        )
    };
    let against = wishes.iter().filter(|wish| !wish.allows());
    let against: Vec<String> = against.map(wants).collect();
    let (says, word, text) = match against.is_empty() {
        true => (
            Conclusion::Supported,
            "holds in both engines",
            format!("both engines allow this point: {metric} {there}"),
        ),
        false => (
            Conclusion::Rejected,
            "the engines differ",
            format!(
                "THE ENGINES DIFFER by more than what is unknown: {metric} {there}; {}",
                listed(&against)
            ),
        ),
    };
    let mut claim = Claim::new(About::Engines, says, word, text);
    for wish in wishes {
        let of = |what: &str| format!("{}_{what}", wish.engine);
        let numbers = [
            (of("score"), wish.score),
            (of("implausibility"), wish.implausibility),
            (of("expected_at_its_best"), wish.expected),
        ];
        let finite = numbers.into_iter().filter(|(_, value)| value.is_finite());
        claim.numbers.extend(finite);
        let own = wish.parameters.iter();
        claim
            .numbers
            .extend(own.map(|(name, value)| (of(name), *value)));
    }
    Some(claim.of(metric).resting_on(recordings, &[]))
}

/// What cannot be told from the best.
pub(crate) fn set(sure: &BestPointUncertainty, recordings: usize) -> Claim {
    let BestPointUncertainty {
        indistinguishable,
        points,
        ..
    } = *sure;
    let text = format!(
        "{indistinguishable} of {} cannot be told apart from the best at {:.0} % ({})",
        counted(points, "simulated point"),
        100.0 * sure.level,
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
