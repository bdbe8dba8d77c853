//! Sentences about parameters that recordings determine or leave open.

use super::{About, Claim, Conclusion};
use realgap_core::unit::counted;
use realgap_inference::{Determination, Marginal, POSSIBLE_LEVEL};
use realgap_optimization::Range;

/// What was found about one parameter.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    /// The value at the best point.
    pub best: f64,
    /// Whether the best point belongs to the confidence set by what the emulator says of it, and not by its score alone.
    pub set_holds_best: bool,
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
    /// Digits that tell a fiftieth of the range from its neighbours, and a tenth of the shortest interval.
    fn new(range: &Range, marginal: &Marginal) -> Self {
        let widths = marginal.intervals.iter().map(|(low, high)| high - low);
        let widths = widths.filter(|width| *width > 0.0);
        let step = widths.fold(0.02 * (range.to - range.from), f64::min);
        let step = step.log10().floor();
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

/// Whether, and how far, the recordings determine a parameter: it is determined where its intervals are together shorter than half of
/// the searched range and do not reach an end at which the search could be widened.
pub(crate) fn parameter(range: &Range, found: &Found) -> Claim {
    let shown = Shown::new(range, &found.marginal);
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
    let possible = format!("are possible ({:.0} %)", 100.0 * POSSIBLE_LEVEL);
    let fit = match intervals.len() {
        0 => "fit as well".to_owned(),
        1 => possible,
        _ => format!("{possible}, except for a part between the intervals"),
    };
    let holds_best = |(low, high): &(f64, f64)| (*low..=*high).contains(&found.best);
    // A best point outside of its own interval is not named as the estimate.
    let is_beside = !interval.is_empty() && !intervals.iter().any(holds_best);
    let beside = || {
        let why = match found.set_holds_best {
            true => format!(
                "is one of the {:.0} % of compatible values that the interval leaves out",
                100.0 * (1.0 - found.level)
            ),
            false => {
                "lies outside of it, with a lower score than the emulator expects there".to_owned()
            }
        };
        format!("the point with the lowest score, {best}, {why}")
    };
    let is = match (interval.as_str(), is_beside) {
        ("", _) => format!("{name} = {best}"),
        (_, false) => format!("{name} = {best} ({level} interval {interval})"),
        (_, true) => format!("{name} lies in {interval} ({level}); {}", beside()),
    };
    let within = match interval.as_str() {
        "" => format!("narrowed down to {fits_from} to {fits_to}"),
        _ => format!("narrowed down to {interval} ({level})"),
    };
    let bound = |side: &str, value: &str| {
        let known = match (interval.as_str(), is_beside) {
            ("", _) => format!("best {best}"),
            (_, false) => format!("best {best} ({level} interval {interval})"),
            (_, true) => format!("{level} interval {interval}; {}", beside()),
        };
        (
            format!("{side} {value}"),
            format!("{name} is {side} {value}; {known}"),
        )
    };
    let determination = found.marginal.determination(range);
    let is_at_edge =
        determination == Determination::EdgeOfSearch && found.marginal.reaches_end(range);
    let says = match (found.is_resolved, determination) {
        (false, _) | (_, Determination::Open | Determination::Wide) => Conclusion::Inconclusive,
        _ if is_at_edge => Conclusion::Inconclusive,
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
        Determination::Wide => {
            let covers = match interval.as_str() {
                "" => format!(
                    "values from {fits_from} to {fits_to} {fit}, half of the searched range or more"
                ),
                _ => format!(
                    "the {level} interval {interval} covers half of the searched range or more"
                ),
            };
            (
                format!("not determined: {covers}"),
                format!(
                    "{name} is not determined by these recordings: {covers}; the best is {best}"
                ),
            )
        }
        Determination::EdgeOfSearch => {
            let ends = format!(
                "the search ends at {} and {}",
                shown.value(range.from),
                shown.value(range.to)
            );
            let widen = "widen the range before you rely on this";
            let reaches =
                format!("values from {fits_from} to {fits_to} {fit}, and {ends}: {widen}");
            match is_at_edge {
                true => (
                    format!("not determined within the searched range: {reaches}"),
                    format!(
                        "{name} is not determined within the searched range: {reaches}; the best is {best}"
                    ),
                ),
                false => (
                    format!("{within}, but {reaches}"),
                    format!("{is}, but {reaches}"),
                ),
            }
        }
        Determination::AtMost => bound("at most", &fits_to),
        Determination::AtLeast => bound("at least", &fits_from),
        Determination::Inside => match &found.shaken_by {
            Some(shaken_by) if !interval.is_empty() => {
                let best = match is_beside {
                    true => beside(),
                    false => format!("best {best}"),
                };
                (
                    format!("{within}, no closer: numerical settings change the score more"),
                    format!(
                        "{name} lies in {interval} ({level}; {best}) and cannot be narrowed further: {shaken_by}, more than these values do; \
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
    // One run does not show what a repeat would change.
    let text = match (found.recordings, says) {
        (1, Conclusion::Supported) => {
            format!("{text}; this is of one run, and how repeats differ is assumed")
        }
        _ => text,
    };
    with_numbers(
        Claim::new(About::Parameter, says, word, text).of(name),
        found,
    )
}

/// The claim with the numbers that it rests on.
fn with_numbers(claim: Claim, found: &Found) -> Claim {
    let numbers = [
        ("best", found.best),
        ("fits_from", found.marginal.low),
        ("fits_to", found.marginal.high),
    ];
    claim
        .with_intervals(&found.marginal.intervals)
        .resting_on(found.recordings, &numbers)
        .at_level(found.level)
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
            set_holds_best: true,
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
    fn an_interval_at_the_edge_of_the_search_determines_nothing_and_asks_for_a_wider_one() {
        let verdict = parameter(&friction(), &found(0.1, 0.05, 0.2));
        assert_eq!(
            verdict.text,
            "floor.friction is not determined within the searched range: values from 0.050 to 0.200 are possible (99 %), and the search \
             ends at 0.050 and 1.050: widen the range before you rely on this; the best is 0.100"
        );
        assert!(verdict.conclusion == Conclusion::Inconclusive);
    }

    #[test]
    fn an_interval_off_the_edge_is_told_with_the_values_that_reach_the_edge() {
        let near = Found {
            marginal: Marginal {
                low: 0.07,
                high: 0.4,
                intervals: vec![(0.15, 0.3)],
            },
            ..found(0.2, 0.07, 0.4)
        };
        let verdict = parameter(&friction(), &near);
        assert_eq!(
            verdict.text,
            "floor.friction = 0.200 (90 % interval 0.150 to 0.300), but values from 0.070 to 0.400 are possible (99 %), and the search ends \
             at 0.050 and 1.050: widen the range before you rely on this"
        );
        assert!(verdict.conclusion == Conclusion::Supported);
    }

    #[test]
    fn an_interval_over_half_of_the_range_determines_nothing() {
        let verdict = parameter(&friction(), &found(0.4, 0.3, 0.9));
        assert!(verdict.conclusion == Conclusion::Inconclusive);
        let said = "floor.friction is not determined by these recordings: the 90 % interval 0.300 to 0.900 covers half";
        assert!(verdict.text.starts_with(said), "{}", verdict.text);
        let two = Found {
            marginal: Marginal {
                low: 0.15,
                high: 0.9,
                intervals: vec![(0.15, 0.45), (0.65, 0.9)],
            },
            ..found(0.4, 0.15, 0.9)
        };
        assert!(parameter(&friction(), &two).conclusion == Conclusion::Inconclusive);
        let short = parameter(&friction(), &found(0.4352, 0.43491, 0.43542));
        assert!(short.text.contains("0.43491 to 0.43542"), "{}", short.text);
    }

    #[test]
    fn what_one_run_tells_is_said_to_be_of_one_run() {
        let one = Found {
            recordings: 1,
            ..found(0.45, 0.4, 0.5)
        };
        let text = parameter(&friction(), &one).text;
        assert!(text.contains("of one run"), "{text}");
        let three = parameter(&friction(), &found(0.45, 0.4, 0.5)).text;
        assert!(!three.contains("one run"), "{three}");
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
            assert!(parameter(&range, &found(0.4, 0.2, 0.6)).conclusion == Conclusion::Supported);
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
            "floor.friction = 0.450 (90 % interval 0.400 to 0.500); values from 0.400 to 0.500 are possible (99 %)"
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
        let said = "floor.friction lies in 0.500 to 0.600 (90 %); the point with the lowest score, 0.400, is one of the 10 % of";
        assert!(text.starts_with(said), "{text}");
        // The set may hold the best point for its score alone.
        let lucky = Found {
            set_holds_best: false,
            ..beside
        };
        let text = parameter(&friction(), &lucky).text;
        assert!(
            text.contains("lower score than the emulator expects"),
            "{text}"
        );
    }

    #[test]
    fn the_short_form_keeps_every_caveat() {
        let edge = parameter(&friction(), &found(0.1, 0.05, 0.2));
        let open = parameter(&friction(), &found(0.4, 0.05, 1.05));
        let text = summary(&[edge, open]).unwrap().text;
        assert_eq!(
            text,
            "From 3 recordings: floor.friction is not determined within the searched range: values from 0.050 to 0.200 are possible (99 %), \
             and the search ends at 0.050 and 1.050: widen the range before you rely on this; floor.friction is not determined."
        );
    }
}
