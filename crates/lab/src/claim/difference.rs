//! Sentences about a parameter that two sets of recordings have each their own value of: one floor or two?

use super::{About, Claim, Conclusion};
use crate::calibration::{DIFFERENCE_LEVEL, Difference};
use realgap_core::unit::number;

/// Whether a parameter differs between two sets of recordings. A fit that has not converged tells nothing.
pub(crate) fn difference(known: &Difference, has_converged: bool, recordings: usize) -> Claim {
    let (first, second) = (known.first, known.second);
    let (value, low, high) = (known.value, known.low, known.high);
    let (says, word, text) = match (has_converged, known.is_told()) {
        (true, true) => {
            let (more, less) = match value > 0.0 {
                true => (first, second),
                false => (second, first),
            };
            let ends = [low.abs().min(high.abs()), low.abs().max(high.abs())];
            let by = format!("{} to {}", number(ends[0]), number(ends[1]));
            (
                Conclusion::Supported,
                format!("they differ by {by} (95 %)"),
                format!(
                    "{more} is larger than {less} by {} (95 % {by})",
                    number(value.abs())
                ),
            )
        }
        (true, false) => (
            Conclusion::Inconclusive,
            "cannot tell whether they differ".to_owned(),
            format!(
                "whether {first} and {second} differ cannot be told: the difference is {} to {} (95 %)",
                number(low),
                number(high)
            ),
        ),
        (false, _) => (
            Conclusion::Inconclusive,
            "cannot tell whether they differ".to_owned(),
            format!(
                "whether {first} and {second} differ cannot be told: the fit has not converged"
            ),
        ),
    };
    Claim::new(About::Difference, says, word, text)
        .with_intervals(&[(low, high)])
        .of(format!("{first} - {second}"))
        .resting_on(recordings, &[("difference", value)])
        .at_level(DIFFERENCE_LEVEL)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(low: f64, high: f64, has_converged: bool) -> Claim {
        let known = Difference {
            first: "run.a.floor.friction",
            second: "run.b.floor.friction",
            value: 0.5 * (low + high),
            low,
            high,
        };
        difference(&known, has_converged, 4)
    }

    #[test]
    fn two_floors_differ_where_the_interval_leaves_zero_out_and_the_larger_is_named_first() {
        let larger = said(0.2, 0.4, true);
        assert_eq!(
            larger.text,
            "run.a.floor.friction is larger than run.b.floor.friction by 0.300 (95 % 0.200 to 0.400)"
        );
        let smaller = said(-0.4, -0.2, true);
        assert_eq!(
            smaller.text,
            "run.b.floor.friction is larger than run.a.floor.friction by 0.300 (95 % 0.200 to 0.400)"
        );
        assert_eq!(said(-0.1, 0.4, true).conclusion, Conclusion::Inconclusive);
        assert_eq!(said(0.2, 0.4, false).conclusion, Conclusion::Inconclusive);
    }
}
