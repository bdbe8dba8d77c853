//! What the recordings say about each parameter, in plain language.

use std::fmt;

use serde::Serialize;

use super::posterior::{BestDraws, INTERVAL_LEVEL};
use super::score::Scores;
use super::study::Study;
use super::uncertainty::Uncertainty;
use crate::optimization::Range;

/// One parameter's best value and the range that fits as well.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Central 90 % interval of the best value when reality is sampled again (bootstrap over recordings).
    pub interval: Option<(f64, f64)>,
    /// False where the recordings do not determine the parameter within the searched range.
    pub identified: bool,
    /// One sentence.
    pub text: String,
}

/// Above this share of the searched range a parameter counts as not determined.
const UNIDENTIFIED_SHARE: f64 = 0.5;

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// One verdict per parameter; none where no point has a score.
pub(super) fn verdicts(
    study: &Study,
    scores: &Scores,
    uncertainty: Option<&Uncertainty>,
    draws: Option<&BestDraws>,
) -> Vec<Verdict> {
    let (Some(best), Some(uncertainty)) = (scores.best, uncertainty) else {
        return Vec::new();
    };
    let points = &scores.points;
    let ranges = study.definition().grid.ranges();
    ranges
        .iter()
        .enumerate()
        .map(|(dimension, range)| {
            let set = points
                .iter()
                .zip(&uncertainty.indistinguishable)
                .filter(|(_, is_in)| **is_in);
            let values: Vec<f64> = set.map(|(point, _)| point.values[dimension]).collect();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let interval = draws.map(|draws| draws.interval(dimension, INTERVAL_LEVEL));
            verdict(range, points[best].values[dimension], (low, high), interval)
        })
        .collect()
}

fn verdict(
    range: &Range,
    best: f64,
    (low, high): (f64, f64),
    interval: Option<(f64, f64)>,
) -> Verdict {
    let identified = high - low <= UNIDENTIFIED_SHARE * (range.to - range.from);
    // A grid cannot say more than its step.
    let digits = (1.0 - (range.step() / 2.0).log10().floor()).clamp(0.0, 9.0) as usize;
    let unit = range.parameter.unit.symbol();
    let sure = |unit: &str| match interval {
        Some((from, to)) => format!(
            " (90 % interval {from:.digits$} to {to:.digits$}{}{unit})",
            if unit.is_empty() { "" } else { " " }
        ),
        None => String::new(),
    };
    let show = |value: f64| format!("{value:.digits$} {unit}").trim_end().to_owned();
    let name = range.parameter.name;
    // At a bound of the parameter itself (restitution 0) there is nothing to widen.
    let (lowest, highest) = range.parameter.bounds;
    let at_edge =
        (best == range.from && range.from > lowest) || (best == range.to && range.to < highest);
    let text = match (identified, at_edge) {
        (false, _) => format!(
            "{name} is not determined by these recordings: values from {} to {} fit as well as the best, {}",
            show(low),
            show(high),
            show(best)
        ),
        (true, true) => format!(
            "{name} = {} lies at the edge of the searched range: widen it before you believe it ({} to {} fit as well)",
            show(best),
            show(low),
            show(high)
        ),
        (true, false) if low == high => {
            format!(
                "{name} = {}{}, known to within the grid's step of {}",
                show(best),
                sure(unit),
                show(range.step())
            )
        }
        (true, false) => format!(
            "{name} = {}{}; values from {} to {} fit as well",
            show(best),
            sure(unit),
            show(low),
            show(high)
        ),
    };
    Verdict {
        parameter: name.to_owned(),
        unit: range.parameter.unit.label().to_owned(),
        best,
        low,
        high,
        interval,
        identified,
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::parameter::by_name;

    fn friction() -> Range {
        Range::new(by_name("floor.friction").unwrap(), 0.05, 1.05, 21).unwrap()
    }

    #[test]
    fn a_parameter_that_the_data_do_not_determine_is_called_so() {
        let verdict = verdict(&friction(), 0.4, (0.05, 0.95), None);
        assert!(!verdict.identified);
        assert!(verdict.text.contains("not determined"), "{}", verdict.text);
    }

    #[test]
    fn a_best_value_at_the_edge_is_not_believed() {
        assert!(
            verdict(&friction(), 0.05, (0.05, 0.1), None)
                .text
                .contains("widen")
        );
    }

    #[test]
    fn a_determined_parameter_gets_its_interval() {
        let verdict = verdict(&friction(), 0.45, (0.4, 0.5), Some((0.41, 0.49)));
        assert!(verdict.identified);
        assert_eq!(
            verdict.text,
            "floor.friction = 0.450 (90 % interval 0.410 to 0.490); values from 0.400 to 0.500 fit as well"
        );
    }
}
