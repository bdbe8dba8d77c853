//! The sentence about a parameter that was identified from free flights.

use super::{About, Claim, Conclusion};
use realgap_identification::{Interval, JointVerdict};

/// Whether flights determine a parameter.
pub fn flights(verdict: &JointVerdict) -> Claim {
    let Interval { value, low, high } = verdict.estimate;
    let name = verdict.parameter;
    let (says, word, text) = match verdict.is_determined {
        true => (
            Conclusion::Supported,
            "determined",
            format!("flights say {name} = {value:.5} ({low:.5} to {high:.5})"),
        ),
        false => (
            Conclusion::Inconclusive,
            "not determined: as stated",
            format!(
                "{name} is not determined by flights: {} as stated",
                verdict.stated
            ),
        ),
    };
    Claim::new(About::Parameter, says, word, text)
        .of(name)
        .resting_on(0, &[("value", value), ("low", low), ("high", high)])
        .at_level(0.95)
}
