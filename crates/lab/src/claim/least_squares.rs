//! Sentences about parameters that least squares estimated.

use super::{About, Claim, Conclusion};
use realgap_core::unit::number;
use realgap_inference::LeastSquaresEstimate;

/// Whether least squares determine a parameter; `parts` are the parts of its interval, one for each mode of the posterior.
pub(crate) fn least_squares(
    known: &LeastSquaresEstimate,
    parts: &[(f64, f64)],
    recordings: usize,
) -> Claim {
    let parts = match parts {
        [] => &[(known.low, known.high)],
        parts => parts,
    };
    let spans = parts.iter();
    let spans = spans.map(|(low, high)| format!("{} to {}", number(*low), number(*high)));
    let span = spans.collect::<Vec<_>>().join(" or ");
    let (says, word) = match known.is_told {
        true => (
            Conclusion::Supported,
            format!("narrowed down to {span} (90 %)"),
        ),
        false => (Conclusion::Inconclusive, "not determined".to_owned()),
    };
    let claim = Claim::new(
        About::Parameter,
        says,
        word,
        least_squares_sentence(known, &span, parts),
    );
    claim
        .with_intervals(parts)
        .of(known.parameter)
        .resting_on(recordings, &[("best", known.value)])
        .at_level(0.9)
}

/// The sentence about a parameter that least squares estimated.
fn least_squares_sentence(
    known: &LeastSquaresEstimate,
    span: &str,
    parts: &[(f64, f64)],
) -> String {
    let (name, value) = (known.parameter, number(known.value));
    let holds = |(low, high): &(f64, f64)| (*low..=*high).contains(&known.value);
    let beside = match (parts.iter().any(holds), known.is_told) {
        (true, _) => "",
        (false, false) => " (one of many values that fit as well)",
        (false, true) => " (the best run, at the edge of what fits)",
    };
    let determined = match known.is_told {
        true => "",
        false => ": not determined by these recordings",
    };
    let combination = match &known.combination {
        Some(known) => format!(
            "; they determine {} = {} (90 % {} to {})",
            known.name,
            number(known.value),
            number(known.low),
            number(known.high)
        ),
        None => String::new(),
    };
    let partner = match known.partner {
        Some((other, correlation)) if combination.is_empty() && correlation.abs() > 0.9 => {
            format!("; correlated with {other} ({correlation:.2})")
        }
        _ => String::new(),
    };
    format!("{name} = {value}{beside}, 90 % {span}{determined}{combination}{partner}")
}
