//! The sentences of a report about reality. They are made in the crate `realgap-lab`; pages add none of their own.

use realgap_lab::claim::{About, Claim};

/// The sentences about these things, in this order, after each other.
pub(in crate::report) fn sentences(claims: &[Claim], about: &[About]) -> String {
    let ended = |claim: &Claim| match claim.text.ends_with('.') {
        true => claim.text.clone(),
        false => format!("{}.", claim.text),
    };
    let of_each = (about.iter()).flat_map(|about| claims.iter().filter(|c| c.about == *about));
    let all: Vec<String> = of_each.map(ended).collect();
    all.join(" ")
}

/// The short form of a claim, for the cell of a table; `None` where the report makes no such claim.
pub(in crate::report) fn word<'a>(
    claims: &'a [Claim],
    about: About,
    name: &str,
) -> Option<&'a str> {
    let mut found = claims
        .iter()
        .filter(|claim| claim.about == about && claim.name == name);
    found.next().map(|claim| claim.word.as_str())
}
