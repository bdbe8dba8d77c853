//! Sentences about parameters that recordings determine or leave open.

use super::{About, Claim, Conclusion};
use realgap_core::unit::{counted, number};
use realgap_inference::{Determination, LeastSquaresEstimate, Marginal};
use realgap_optimization::Range;

/// What was found about one parameter.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    /// The value at the best point.
    pub best: f64,
    /// The values that are compatible with the recordings.
    pub marginal: Marginal,
    /// Confidence level of the marginal's intervals.
    pub level: f64,
    /// False where other numerical settings change the score more than the parameter does over its whole range.
    pub is_resolved: bool,
    /// The numerical setting that changes the score more than the compatible values do, in words.
    pub shaken_by: Option<String>,
    /// Recordings that were fitted.
    pub recordings: usize,
}

/// Prints values of a parameter with its unit and a suitable number of digits.
struct Shown {
    name: &'static str,
    unit: &'static str,
    digits: usize,
}

impl Shown {
    fn new(range: &Range) -> Self {
        let step = (0.02 * (range.to - range.from)).log10().floor();
        Self {
            name: range.parameter.name,
            unit: range.parameter.unit.symbol(),
            digits: (1.0 - step).clamp(0.0, 9.0) as usize,
        }
    }

    fn value(&self, value: f64) -> String {
        let digits = self.digits;
        let text = format!("{value:.digits$} {}", self.unit);
        text.trim_end().to_owned()
    }

    fn span(&self, (low, high): (f64, f64)) -> String {
        let digits = self.digits;
        format!("{low:.digits$} to {}", self.value(high))
    }
}

/// Whether, and how far, the recordings determine a parameter.
pub(crate) fn parameter(range: &Range, found: &Found) -> Claim {
    let shown = Shown::new(range);
    let (name, best) = (shown.name, shown.value(found.best));
    let Marginal {
        low,
        high,
        intervals,
    } = &found.marginal;
    let (fits_from, fits_to) = (shown.value(*low), shown.value(*high));
    let level = format!("{:.0} %", 100.0 * found.level);
    let spans = intervals.iter().map(|span| shown.span(*span));
    let interval = spans.collect::<Vec<_>>().join(" or ");
    let fit = match intervals.len() {
        0 | 1 => "fit as well",
        _ => "fit as well, except for a part between the intervals",
    };
    let holds_best = |(low, high): &(f64, f64)| (*low..=*high).contains(&found.best);
    // A best point outside of its own interval is due to chance, so its value is not named as the estimate.
    let is_beside = !interval.is_empty() && !intervals.iter().any(holds_best);
    let is = match (interval.as_str(), is_beside) {
        ("", _) => format!("{name} = {best}"),
        (_, false) => format!("{name} = {best} ({level} interval {interval})"),
        (_, true) => format!(
            "{name} lies in {interval} ({level}); the point with the lowest score, {best}, lies outside of it by chance"
        ),
    };
    let within = match interval.as_str() {
        "" => format!("narrowed down to {fits_from} to {fits_to}"),
        _ => format!("narrowed down to {interval} ({level})"),
    };
    let bound = |side: &str, value: &str| {
        let known = match (interval.as_str(), is_beside) {
            ("", _) => format!("best {best}"),
            (_, false) => format!("best {best} ({level} interval {interval})"),
            (_, true) => format!(
                "{level} interval {interval}; the point with the lowest score, {best}, lies outside of it by chance"
            ),
        };
        (
            format!("{side} {value}"),
            format!("{name} is {side} {value}; {known}"),
        )
    };
    let determination = found.marginal.determination(range);
    let says = match (found.is_resolved, determination) {
        (false, _) | (_, Determination::Open) => Conclusion::Inconclusive,
        _ => Conclusion::Supported,
    };
    let (word, text) = match determination {
        _ if !found.is_resolved => (
            "not determined: other numerical settings change the score more".to_owned(),
            format!(
                "{name} is not determined: other numerical settings change the score more than its whole range does; \
                 use finer settings, another metric, or recordings of a motion that {name} changes more"
            ),
        ),
        Determination::Open => (
            "not determined".to_owned(),
            format!(
                "{name} is not determined by these recordings: values from {fits_from} to {fits_to} {fit}; the best is {best}"
            ),
        ),
        Determination::EdgeOfSearch => {
            let edge = "up to the edge of the searched range";
            let widen = "widen the range before you rely on this";
            (
                format!("{within}, {edge}: {widen}"),
                format!("{is}, but values {edge} {fit} ({fits_from} to {fits_to}): {widen}"),
            )
        }
        Determination::AtMost => bound("at most", &fits_to),
        Determination::AtLeast => bound("at least", &fits_from),
        Determination::Inside => match &found.shaken_by {
            Some(shaken_by) if !interval.is_empty() => {
                let where_best = if is_beside {
                    "outside of it by chance: "
                } else {
                    ""
                };
                (
                    format!("{within}, no closer: numerical settings change the score more"),
                    format!(
                        "{name} lies in {interval} ({level}; best {where_best}{best}) and cannot be narrowed further: {shaken_by}, more than these values do; \
                         finer numerical settings, another metric or another motion would narrow it"
                    ),
                )
            }
            _ => (
                within,
                format!("{is}; values from {fits_from} to {fits_to} {fit}"),
            ),
        },
    };
    with_numbers(
        Claim::new(About::Parameter, says, word, text).of(name),
        found,
    )
}

/// The claim with the numbers that it rests on.
fn with_numbers(mut claim: Claim, found: &Found) -> Claim {
    for (index, (low, high)) in found.marginal.intervals.iter().enumerate() {
        let part = index + 1;
        let ends = [
            (format!("interval_{part}_low"), *low),
            (format!("interval_{part}_high"), *high),
        ];
        claim.numbers.extend(ends);
    }
    let numbers = [
        ("best", found.best),
        ("fits_from", found.marginal.low),
        ("fits_to", found.marginal.high),
    ];
    claim
        .resting_on(found.recordings, &numbers)
        .at_level(found.level)
}

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
    let mut claim = Claim::new(
        About::Parameter,
        says,
        word,
        least_squares_sentence(known, &span, parts),
    );
    for (index, (low, high)) in parts.iter().enumerate() {
        let part = index + 1;
        let ends = [
            (format!("interval_{part}_low"), *low),
            (format!("interval_{part}_high"), *high),
        ];
        claim.numbers.extend(ends);
    }
    claim
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

/// Most parameters that are named in a sentence; more are counted, because a list of them would be too long to read.
pub(crate) const NAMED: usize = 6;

/// All parameters in one sentence, with the caveat of each that is named; `None` for none.
pub(crate) fn summary(parameters: &[Claim]) -> Option<Claim> {
    let first = parameters.first()?;
    let said = parameters
        .iter()
        .map(|c| format!("{} is {}", c.name, c.word));
    let mut said = said.collect::<Vec<_>>().join("; ");
    let known = parameters
        .iter()
        .filter(|c| c.conclusion == Conclusion::Supported)
        .count();
    let says = match known {
        0 => Conclusion::Inconclusive,
        _ => Conclusion::Supported,
    };
    let word = format!("{known} of {} determined", parameters.len());
    if parameters.len() > NAMED {
        let count = parameters.len();
        said = format!("{known} of {count} parameters are determined, each with its own verdict");
    }
    let text = format!("From {}: {said}.", counted(first.count, "recording"));
    let numbers = [
        ("determined", known as f64),
        ("parameters", parameters.len() as f64),
    ];
    Some(Claim::new(About::Parameters, says, word, text).resting_on(first.count, &numbers))
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_simulation::parameter::by_name;

    fn friction() -> Range {
        Range::new(by_name("floor.friction").unwrap(), 0.05, 1.05, 21).unwrap()
    }

    fn found(best: f64, low: f64, high: f64) -> Found {
        Found {
            best,
            marginal: Marginal {
                low,
                high,
                intervals: vec![(low, high)],
            },
            level: 0.9,
            is_resolved: true,
            shaken_by: None,
            recordings: 3,
        }
    }

    #[test]
    fn a_parameter_whose_both_ends_fit_as_well_is_not_determined() {
        let verdict = parameter(&friction(), &found(0.4, 0.05, 1.05));
        assert!(verdict.conclusion == Conclusion::Inconclusive);
        assert!(verdict.text.contains("not determined"), "{}", verdict.text);
    }

    #[test]
    fn a_set_that_reaches_the_edge_of_the_search_asks_for_a_wider_one() {
        let text = parameter(&friction(), &found(0.1, 0.05, 0.2)).text;
        assert!(text.contains("widen"), "{text}");
    }

    #[test]
    fn at_a_bound_of_the_parameter_there_is_nothing_to_widen() {
        let restitution = Range::new(by_name("floor.restitution").unwrap(), 0.0, 0.9, 10).unwrap();
        let text = parameter(&restitution, &found(0.1, 0.0, 0.3)).text;
        assert!(
            text.starts_with("floor.restitution is at most 0.30"),
            "{text}"
        );
    }

    #[test]
    fn how_far_somebody_searched_does_not_decide_what_is_determined() {
        let wide = Range::new(by_name("floor.friction").unwrap(), 0.05, 2.05, 41).unwrap();
        let narrow = Range::new(by_name("floor.friction").unwrap(), 0.05, 1.05, 21).unwrap();
        for range in [wide, narrow] {
            assert!(parameter(&range, &found(0.4, 0.15, 0.85)).conclusion == Conclusion::Supported);
        }
    }

    #[test]
    fn where_numerics_matter_more_than_the_parameter_nothing_is_claimed() {
        let unresolved = Found {
            is_resolved: false,
            ..found(0.45, 0.4, 0.5)
        };
        let verdict = parameter(&friction(), &unresolved);
        assert!(
            verdict.conclusion == Conclusion::Inconclusive && !verdict.text.contains('='),
            "{}",
            verdict.text
        );
    }

    #[test]
    fn no_single_value_is_named_where_numerics_change_more_than_the_values_that_fit() {
        let shaken = Found {
            shaken_by: Some("6 substeps instead of 3 changes the score by 2 cm".to_owned()),
            ..found(0.45, 0.4, 0.5)
        };
        let text = parameter(&friction(), &shaken).text;
        assert!(
            text.starts_with(
                "floor.friction lies in 0.400 to 0.500 (90 %; best 0.450) and cannot be narrowed further: 6 substeps"
            ),
            "{text}"
        );
    }

    #[test]
    fn a_determined_parameter_gets_its_interval() {
        let verdict = parameter(&friction(), &found(0.45, 0.4, 0.5));
        assert!(verdict.conclusion == Conclusion::Supported);
        assert_eq!(
            verdict.text,
            "floor.friction = 0.450 (90 % interval 0.400 to 0.500); values from 0.400 to 0.500 fit as well"
        );
    }

    #[test]
    fn no_interval_bridges_a_part_that_is_rejected() {
        let parted = Found {
            marginal: Marginal {
                low: 0.2,
                high: 0.7,
                intervals: vec![(0.2, 0.3), (0.6, 0.7)],
            },
            ..found(0.25, 0.2, 0.7)
        };
        let verdict = parameter(&friction(), &parted);
        let parts = "90 % interval 0.200 to 0.300 or 0.600 to 0.700";
        assert!(verdict.text.contains(parts), "{}", verdict.text);
    }

    #[test]
    fn no_value_is_named_that_lies_beside_its_own_interval() {
        let beside = Found {
            marginal: Marginal {
                low: 0.4,
                high: 0.6,
                intervals: vec![(0.5, 0.6)],
            },
            ..found(0.4, 0.4, 0.6)
        };
        let text = parameter(&friction(), &beside).text;
        let said = "floor.friction lies in 0.500 to 0.600 (90 %); the point with the lowest score, 0.400, lies outside";
        assert!(text.starts_with(said), "{text}");
    }

    #[test]
    fn the_short_form_keeps_every_caveat() {
        let edge = parameter(&friction(), &found(0.1, 0.05, 0.2));
        let open = parameter(&friction(), &found(0.4, 0.05, 1.05));
        let text = summary(&[edge, open]).unwrap().text;
        assert_eq!(
            text,
            "From 3 recordings: floor.friction is narrowed down to 0.050 to 0.200 (90 %), up to the edge of the searched range: \
             widen the range before you rely on this; floor.friction is not determined."
        );
    }
}
