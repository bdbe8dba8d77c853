//! The verdict: the few claims with which every answer begins, and what they are called.

use super::{About, Claim};

/// The parts of a verdict, in order. An answer has those that it can give: a fit has gap, parameters and trust, a search has the
/// best robot, its odds and trust.
pub const VERDICT: [(&str, About); 6] = [
    ("gap", About::Gap),
    ("best", About::Winner),
    ("motion", About::Reach),
    ("odds", About::Success),
    ("parameters", About::Parameters),
    ("trust", About::Trust),
];

/// The parts of the verdict that these claims give, with what they are called.
pub fn verdict(claims: &[Claim]) -> Vec<(&'static str, &Claim)> {
    let of = |about| claims.iter().filter(move |claim| claim.about == about);
    let parts = VERDICT.iter();
    let parts = parts.flat_map(|(label, about)| of(*about).map(|claim| (*label, claim)));
    parts.collect()
}

/// The verdict for a terminal, a line for each part, each with a line break at its end.
pub fn verdict_lines(claims: &[Claim]) -> String {
    let parts = verdict(claims).into_iter();
    parts
        .map(|(label, claim)| format!("{label}: {claim}\n"))
        .collect()
}

/// The claims below the verdict: what it rests on.
pub fn evidence(claims: &[Claim]) -> impl Iterator<Item = &Claim> {
    let is_of_verdict = |claim: &Claim| VERDICT.iter().any(|(_, about)| *about == claim.about);
    claims.iter().filter(move |claim| !is_of_verdict(claim))
}
