//! What the recordings say about each parameter, in plain language.

use std::fmt;

use serde::Serialize;

use super::audit::Audit;
use super::definition::Definition;
use super::method::Estimated;
use super::posterior::{BestDraws, INTERVAL_LEVEL};
use super::score::Scores;
use super::study::Study;
use super::uncertainty::Uncertainty;
use realgap_core::unit::quantity;
use realgap_optimize::Range;

/// One parameter's best value and the range that fits as well.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// Name of the parameter.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Best value.
    pub best: f64,
    /// Smallest value in the indistinguishable set.
    pub low: f64,
    /// Largest value in the indistinguishable set.
    pub high: f64,
    /// Central 90 % interval; `None` where there are several.
    pub interval: Option<(f64, f64)>,
    /// The parts of the 90 % interval where values between them are rejected; else empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub intervals: Vec<(f64, f64)>,
    /// False where the recordings do not determine the parameter within the searched range.
    pub identified: bool,
    /// One sentence.
    pub text: String,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Verdict {
    /// What least squares know: the ends of the 90 % interval stand for what fits as well.
    pub(super) fn of_least_squares(definition: &Definition, known: &[Estimated]) -> Vec<Self> {
        let verdict = |(known, range): (&Estimated, &Range)| Self {
            parameter: known.parameter.to_owned(),
            unit: range.parameter.unit.label().to_owned(),
            best: known.value,
            low: known.low,
            high: known.high,
            interval: Some((known.low, known.high)),
            intervals: Vec::new(),
            identified: known.is_told,
            text: known.to_string(),
        };
        let ranges = definition.grid.ranges();
        known.iter().zip(ranges).map(verdict).collect()
    }
}

/// One verdict per parameter; none where no point has a score.
pub(super) fn verdicts(
    study: &Study,
    scores: &Scores,
    uncertainty: Option<&Uncertainty>,
    draws: Option<&BestDraws>,
    audit: Option<&Audit>,
) -> Vec<Verdict> {
    let (Some(best), Some(uncertainty)) = (scores.best, uncertainty) else {
        return Vec::new();
    };
    let ranges = study.definition().grid.ranges();
    ranges
        .iter()
        .enumerate()
        .map(|(dimension, range)| {
            let points = scores.points.iter().zip(&uncertainty.indistinguishable);
            let visited = points.map(|(point, is_in)| (&point.values, *is_in));
            let unvisited = uncertainty.unvisited.iter();
            let all =
                visited.chain(unvisited.map(|place| (&place.values, place.indistinguishable)));
            let set = all.filter(|(_, is_in)| *is_in);
            let values: Vec<f64> = set.map(|(values, _)| values[dimension]).collect();
            let intervals = draws.map(|draws| draws.intervals(dimension, INTERVAL_LEVEL));
            let intervals = intervals.unwrap_or_default();
            // What the interval holds fits as well: many places that are each hardly likely are likely together.
            let ends = intervals.iter().flat_map(|(low, high)| [*low, *high]);
            let all = || values.iter().copied().chain(ends.clone());
            let low = all().fold(f64::INFINITY, f64::min);
            let high = all().fold(f64::NEG_INFINITY, f64::max);
            let name = range.parameter.name;
            let named = |names: &[String]| names.iter().any(|other| other == name);
            let shaken = audit.filter(|audit| named(&audit.shaken));
            let found = Found {
                best: scores.points[best].values[dimension],
                low,
                high,
                intervals,
                is_resolved: !audit.is_some_and(|audit| named(&audit.unresolved)),
                shaken_by: shaken.and_then(Audit::worst).map(|(setting, change)| {
                    format!(
                        "{setting} changes the score by {}",
                        quantity(change.abs(), scores.unit)
                    )
                }),
            };
            verdict(range, &found)
        })
        .collect()
}

/// What was found about one parameter.
#[derive(Debug, Clone)]
struct Found {
    best: f64,
    low: f64,
    high: f64,
    intervals: Vec<(f64, f64)>,
    /// False where other numerics change the score more than the parameter does over its whole range.
    is_resolved: bool,
    /// What changes the score more than the values that fit do.
    shaken_by: Option<String>,
}

/// A set that comes this near to an end of the searched range, as a share of it, reaches it.
const AT_THE_END: f64 = 0.05;

fn verdict(range: &Range, found: &Found) -> Verdict {
    let Found {
        best, low, high, ..
    } = *found;
    let digits = (1.0 - (0.02 * (range.to - range.from)).log10().floor()).clamp(0.0, 9.0) as usize;
    let unit = range.parameter.unit.symbol();
    let name = range.parameter.name;
    let show = |value: f64| format!("{value:.digits$} {unit}").trim_end().to_owned();
    let span = |(from, to): &(f64, f64)| format!("{from:.digits$} to {}", show(*to));
    let spans: Vec<String> = found.intervals.iter().map(span).collect();
    let interval = spans.join(" or ");
    let sure = if spans.is_empty() {
        String::new()
    } else {
        format!(" (90 % interval {interval})")
    };
    let low_end = range.coordinate(low) <= AT_THE_END;
    let high_end = range.coordinate(high) >= 1.0 - AT_THE_END;
    // At a bound of the parameter itself (restitution 0) there is nothing to widen.
    let (lowest, highest) = range.parameter.bounds;
    let widen = (low_end && range.from > lowest) || (high_end && range.to < highest);
    let is_determined = found.is_resolved && !(low_end && high_end);
    let text = if !found.is_resolved {
        format!(
            "{name} is not determined: other numerical settings change the score more than its whole range does; \
             use finer settings, another metric, or recordings of a motion that {name} changes more"
        )
    } else if !is_determined {
        format!(
            "{name} is not determined by these recordings: values from {} to {} fit as well as the best, {}",
            show(low),
            show(high),
            show(best)
        )
    } else if widen {
        format!(
            "{name} = {}{sure}, but values up to the edge of the searched range fit as well ({} to {}): widen it \
             before you believe it",
            show(best),
            show(low),
            show(high)
        )
    } else if low_end {
        format!(
            "{name} is at most {}; best {}{sure}",
            show(high),
            show(best)
        )
    } else if high_end {
        format!(
            "{name} is at least {}; best {}{sure}",
            show(low),
            show(best)
        )
    } else if let (Some(shaken_by), false) = (&found.shaken_by, spans.is_empty()) {
        format!(
            "{name} lies in {interval} (90 %; best {}), no nearer: {shaken_by}, more than these values do; finer settings, \
             another metric or gait would tell more",
            show(best)
        )
    } else {
        format!(
            "{name} = {}{sure}; values from {} to {} fit as well",
            show(best),
            show(low),
            show(high)
        )
    };
    let (interval, intervals) = match found.intervals[..] {
        [one] => (Some(one), Vec::new()),
        _ => (None, found.intervals.clone()),
    };
    Verdict {
        parameter: name.to_owned(),
        unit: range.parameter.unit.label().to_owned(),
        best,
        low,
        high,
        interval,
        intervals,
        identified: is_determined,
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_engine::parameter::by_name;

    fn friction() -> Range {
        Range::new(by_name("floor.friction").unwrap(), 0.05, 1.05, 21).unwrap()
    }

    fn found(best: f64, low: f64, high: f64) -> Found {
        Found {
            best,
            low,
            high,
            intervals: vec![(low, high)],
            is_resolved: true,
            shaken_by: None,
        }
    }

    #[test]
    fn a_parameter_whose_both_ends_fit_as_well_is_not_determined() {
        let verdict = verdict(&friction(), &found(0.4, 0.05, 1.05));
        assert!(!verdict.identified);
        assert!(verdict.text.contains("not determined"), "{}", verdict.text);
    }

    #[test]
    fn a_set_that_reaches_the_edge_of_the_search_asks_for_a_wider_one() {
        let text = verdict(&friction(), &found(0.1, 0.05, 0.2)).text;
        assert!(text.contains("widen"), "{text}");
    }

    #[test]
    fn at_a_bound_of_the_parameter_there_is_nothing_to_widen() {
        let restitution = Range::new(by_name("floor.restitution").unwrap(), 0.0, 0.9, 10).unwrap();
        let text = verdict(&restitution, &found(0.1, 0.0, 0.3)).text;
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
            assert!(verdict(&range, &found(0.4, 0.15, 0.85)).identified);
        }
    }

    #[test]
    fn where_numerics_matter_more_than_the_parameter_nothing_is_claimed() {
        let unresolved = Found {
            is_resolved: false,
            ..found(0.45, 0.4, 0.5)
        };
        let verdict = verdict(&friction(), &unresolved);
        assert!(
            !verdict.identified && !verdict.text.contains('='),
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
        let text = verdict(&friction(), &shaken).text;
        assert!(
            text.starts_with(
                "floor.friction lies in 0.400 to 0.500 (90 %; best 0.450), no nearer: 6 substeps"
            ),
            "{text}"
        );
    }

    #[test]
    fn a_determined_parameter_gets_its_interval() {
        let verdict = verdict(&friction(), &found(0.45, 0.4, 0.5));
        assert!(verdict.identified);
        assert_eq!(
            verdict.text,
            "floor.friction = 0.450 (90 % interval 0.400 to 0.500); values from 0.400 to 0.500 fit as well"
        );
    }

    #[test]
    fn no_interval_bridges_a_part_that_is_rejected() {
        let parted = Found {
            intervals: vec![(0.2, 0.3), (0.6, 0.7)],
            ..found(0.25, 0.2, 0.7)
        };
        let verdict = verdict(&friction(), &parted);
        assert_eq!((verdict.interval, verdict.intervals.len()), (None, 2));
        let parts = "90 % interval 0.200 to 0.300 or 0.600 to 0.700";
        assert!(verdict.text.contains(parts), "{}", verdict.text);
    }
}
