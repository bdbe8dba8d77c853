//! Whether every place shows one verdict, and says nothing against it.

use std::collections::BTreeSet;

use serde_json::Value;

use super::Tally;
use super::rendered::RenderedTexts;
use realgap_lab::claim::{self, About, Claim, Conclusion};

/// Words by which a text takes one of the four answers to the question whether it may be trusted.
const TRUSTS: [(&str, &str); 6] = [
    ("The answer holds on", "holds on others"),
    ("The values hold on", "holds on others"),
    ("fits the recordings", "fits, not yet tested on others"),
    (
        "not explain the recordings",
        "does not explain the recordings",
    ),
    (
        "The fit does not carry over",
        "does not explain the recordings",
    ),
    ("Whether to trust this cannot be told", "cannot be told"),
];

/// Words that contradict an answer that may be trusted.
const AGAINST: [&str; 5] = [
    "No parameters of this model",
    "CONTRADICTED",
    "NOT have the distribution",
    "leave the region of its repeats",
    "NOT EXPLAINED",
];

/// The answers that a text gives to the question whether it may be trusted.
fn trusts(text: &str) -> BTreeSet<&'static str> {
    let said = TRUSTS.iter().filter(|(words, _)| text.contains(words));
    said.map(|(_, word)| *word).collect()
}

/// The claim about `about`, where there is one.
pub(super) fn of(claims: &[Claim], about: About) -> Option<&Claim> {
    claims.iter().find(|claim| claim.about == about)
}

/// Checks that terminal, page and JSON begin with one verdict, and that nothing below contradicts it.
pub(super) fn verdict(found: &mut Tally, told: &RenderedTexts, json: &Value) {
    let parts = claim::verdict(&told.claims);
    let mut lines = told.text.lines();
    for (label, claim) in &parts {
        let line = lines.next().unwrap_or_default();
        found.hold(told, line == format!("{label}: {claim}"), || {
            format!("the terminal has {line} in place of {label}: {claim}")
        });
        let own = format!("{label}\n{claim}");
        found.hold(told, told.page.contains(&own), || {
            format!("the page does not say {own}")
        });
        let written = json["claims"].as_array().into_iter().flatten();
        let mut written = written.filter_map(|claim| claim["text"].as_str());
        found.hold(told, written.any(|text| text == claim.text), || {
            format!("JSON does not say {claim}")
        });
    }
    let trust = of(&told.claims, About::Trust);
    found.hold(told, trust.is_some(), || "no word on trust".to_owned());
    let Some(trust) = trust else { return };
    let word = trust.word.as_str();
    for answer in TRUSTS.map(|(_, answer)| answer) {
        if answer == word {
            found.see(answer, true);
        }
    }
    for (place, text) in [("terminal", &told.text), ("page", &told.page)] {
        let said = trusts(text);
        found.hold(told, said == [word].into(), || {
            format!("{place} says {said:?}, the verdict {word}: {text}")
        });
        let against = AGAINST.iter().find(|words| text.contains(*words));
        let may_be = trust.conclusion == Conclusion::Supported;
        found.hold(told, !may_be || against.is_none(), || {
            format!("{place} says {against:?}, the verdict {word}: {text}")
        });
    }
}
