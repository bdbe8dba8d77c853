//! Tests that no two places say different things of one study, and that no sentence says more than its table. The numbers of
//! these studies are drawn at random, not simulated.

mod drawn;
mod rendered;
mod searched;
mod verdict;

use crate::report::ResultsPage;
use crate::report::document::picture::Pictures;
use crate::report::document::value::percent;
use crate::results::study::best::description;
use drawn::{Draw, Repeated, Swept};
use realgap_core::statistics::ends_of;
use realgap_core::unit::quantity;
use realgap_lab::calibration::POSSIBLE_LEVEL;
use realgap_lab::claim::{About, Claim, Conclusion};
use realgap_lab::prediction::ensemble::Reality;
use realgap_lab::prediction::gap::StudyGap;
use rendered::{RenderedTexts, plain, polarity, spans, whole_line};

/// Studies of each kind.
const STUDIES: u64 = 120;

/// Contradictions that were found, and how often each kind of answer came.
#[derive(Debug, Default)]
struct Tally {
    contradictions: Vec<String>,
    seen: std::collections::BTreeMap<&'static str, usize>,
}

impl Tally {
    fn see(&mut self, what: &'static str, is_so: bool) {
        *self.seen.entry(what).or_default() += usize::from(is_so);
    }

    fn hold(&mut self, study: &RenderedTexts, is_so: bool, what: impl FnOnce() -> String) {
        if !is_so {
            self.contradictions
                .push(format!("{}: {}", study.name, what()));
        }
    }

    /// Asserts that there were no contradictions, and that every kind of answer came often enough to be tested.
    fn close(self) {
        let (count, first) = (
            self.contradictions.len(),
            self.contradictions.iter().take(8),
        );
        let first: Vec<&String> = first.collect();
        assert!(count == 0, "{count} contradictions: {first:#?}");
        for (what, times) in self.seen {
            assert!(times >= 8, "{what}: only {times} of {STUDIES} studies");
        }
    }
}

/// Checks that every place says of every parameter what the table says.
fn parameters(found: &mut Tally, told: &RenderedTexts, drawn: &Swept) {
    for verdict in &drawn.report.verdicts {
        let name = verdict.parameter.as_str();
        let is_known = verdict.identified;
        let parts = verdict.parts();
        let axis = drawn.names().position(|known| known == name).unwrap();
        let is_widened = told
            .text
            .lines()
            .any(|line| line.trim().starts_with(name) && line.contains("widen"));
        found.see("determined", is_known);
        found.see("not determined", !is_known);
        found.see("to be widened", is_widened);
        found.see("several intervals", parts.len() > 1);
        for (place, text) in told.places() {
            let said = polarity(text, name);
            found.hold(told, said == [is_known].into(), || {
                format!("{place} says {said:?} of {name}, the table {is_known}: {text}")
            });
            let mentions = whole_line(text, name).any(|line| line.contains("widen"));
            found.hold(told, mentions == is_widened, || {
                format!("{place} drops or adds a caveat of {name}: {text}")
            });
            for spans in whole_line(text, name).filter_map(spans) {
                let alike = spans.len() == parts.len()
                    && spans.iter().zip(parts).all(|(said, part)| said.is(*part));
                found.hold(told, alike, || {
                    format!("{place}: {spans:?} of {name}, not {parts:?}")
                });
            }
        }
        // What is possible is what the draws say, and holds every interval.
        let (low, high) = (verdict.low, verdict.high);
        let (least, most) = drawn.draws.interval(axis, POSSIBLE_LEVEL);
        let ends = parts.iter().flat_map(|(from, to)| [*from, *to]);
        let (least, most) = ends_of(ends.chain([least, most]));
        found.hold(told, (low, high) == (least, most), || {
            format!("{low} to {high} of {name} are called possible, not {least} to {most}")
        });
        let bridged = |line: &str| line.contains("are possible") && !line.contains("except");
        let lines = || whole_line(&told.text, name);
        found.hold(told, parts.len() < 2 || !lines().any(bridged), || {
            format!(
                "what is possible bridges a rejected part of {name}: {}",
                told.text
            )
        });
        let best = verdict.best;
        let is_beside = !parts
            .iter()
            .any(|(low, high)| (*low..=*high).contains(&best));
        let named = format!("{name} = ");
        let names = |line: &str| line.trim().starts_with(&named) && line.contains("interval");
        found.see("best beside its interval", is_beside && is_known);
        found.hold(told, !is_beside || !lines().any(names), || {
            format!("{best} is named beside its interval: {}", told.text)
        });
    }
}

#[test]
fn a_sweep_says_one_thing_in_every_place() {
    let mut found = Tally::default();
    for seed in 0..STUDIES {
        let drawn = Swept::new(&mut Draw::new(seed));
        let report = &drawn.report;
        let page = ResultsPage::of_study(report, drawn.data(), Pictures::default()).unwrap();
        let told = RenderedTexts {
            name: format!("sweep {seed}"),
            text: report.to_string(),
            answer: page.answer(),
            page: plain(&page.html(None, "")),
            more: description(report, report.best.as_ref().unwrap(), 20),
            claims: report.claims.clone(),
        };
        parameters(&mut found, &told, &drawn);
        let explains = report.fit.as_ref().map(|fit| fit.explains);
        let is_rejected = explains == Some(false);
        found.see("model rejected", is_rejected);
        found.see("model explains", explains == Some(true));
        for (place, text) in told.places() {
            let says = text.contains("No parameters of this model");
            found.hold(&told, says == is_rejected, || {
                format!("{place} of the model: {text}")
            });
        }
        let engines = report.engines.iter();
        let one_explains = engines.clone().any(|preference| !preference.explains);
        let differ = one_explains || engines.clone().any(|preference| !preference.allows());
        found.see("engines differ", differ);
        found.see("one engine explains", one_explains);
        for (place, text) in told.places() {
            let says = text.contains("THE ENGINES DIFFER");
            found.hold(&told, says == differ, || {
                format!("{place} of engines: {text}")
            });
            let says = text.contains("explains the recordings better than");
            found.hold(&told, says == one_explains, || {
                format!("{place} of the engine that explains: {text}")
            });
        }
        let is_first = |text: &str| text.find("No parameters") < text.find("comes nearest");
        found.hold(&told, !is_rejected || is_first(&told.answer), || {
            told.answer.clone()
        });
        let (inside, points) = drawn.counted();
        let count = format!("confidence set holds {inside} of {points} simulated points");
        let score = quantity(report.best.as_ref().unwrap().score, report.unit);
        for (place, text) in [("terminal", &told.text), ("page", &told.page)] {
            found.hold(&told, text.contains(&count), || {
                format!("{place} does not say {count}: {text}")
            });
            found.hold(&told, text.contains(&score), || {
                format!("{place} does not say {score}")
            });
        }
        verdict::verdict(&mut found, &told, &json(report));
        let trust = verdict::of(&report.claims, About::Trust).unwrap();
        let fails = trust.conclusion == Conclusion::Rejected;
        found.hold(&told, !is_rejected || fails || !report.complete, || {
            format!("no parameters explain, and the verdict is {trust}")
        });
        // The page of an unfinished run says so, which is no claim about reality.
        if report.complete {
            told.only_claims(&mut found.contradictions);
        }
    }
    found.close();
}

/// Checks that every place says of the regions of an ensemble what their shares say.
fn regions(found: &mut Tally, told: &RenderedTexts, reality: &Reality) {
    let mut is_any = false;
    for level in &reality.coverage {
        let promised = level.level;
        let shares = std::iter::once(level.at_end).chain(level.whole_path);
        let ends: Vec<(f64, f64)> = shares.map(|share| (share.low, share.high)).collect();
        let narrow = ends.iter().any(|(_, high)| *high < promised);
        let wide = ends.iter().any(|(low, _)| *low > promised);
        is_any |= narrow || wide;
        found.see("too narrow", narrow);
        found.see("too wide", wide);
        found.hold(told, level.is_honest != (narrow || wide), || {
            format!("JSON of {promised}: {ends:?}")
        });
        let name = format!("{:.0} %", 100.0 * promised);
        for (place, text) in [("terminal", &told.text), ("page", &told.page)] {
            let mut rows = text.lines().filter(|line| line.trim().starts_with(&name));
            let says = |row: &str| {
                let contradicts = row.contains("NO:");
                contradicts == (narrow || wide)
                    && row.contains("too narrow") == narrow
                    && row.contains("too wide") == wide
            };
            found.hold(told, rows.any(says), || {
                format!("{place} of {name}, {ends:?}: {text}")
            });
        }
    }
    let p = reality.alike.map(|alike| alike.p_value);
    let is_other = p.is_some_and(|p| p < 0.05);
    found.see("not contradicted", !(is_any || is_other));
    for (place, text) in [("terminal", &told.text), ("page", &told.answer)] {
        let says = text.contains("CONTRADICTED");
        found.hold(told, says == (is_any || is_other), || {
            format!("{place}, p = {p:?}: {text}")
        });
        found.hold(told, says != text.contains("Nothing contradicts"), || {
            text.clone()
        });
    }
}

#[test]
fn repeats_of_a_study_say_one_thing_in_every_place() {
    let mut found = Tally::default();
    for seed in 0..STUDIES {
        let drawn = Repeated::new(&mut Draw::new(1000 + seed));
        let (of_gap, of_ensemble, of_card) = (&drawn.gap, &drawn.ensemble, &drawn.card);
        let reality = of_ensemble.reality.as_ref().unwrap();
        let success = percent(of_card.success.as_ref().unwrap().probability.share);
        let none = Pictures::default;
        let page = ResultsPage::of_gap(of_gap, none()).unwrap();
        let of_gap = rendered(of_gap, &of_gap.claims, format!("gap {seed}"), &page);
        let page = ResultsPage::of_ensemble(of_ensemble, none()).unwrap();
        let name = format!("ensemble {seed}");
        let of_ensemble = rendered(of_ensemble, &of_ensemble.claims, name, &page);
        let page = ResultsPage::of_prediction(of_card, none()).unwrap();
        let of_card = rendered(of_card, &of_card.claims, format!("card {seed}"), &page);
        regions(&mut found, &of_ensemble, reality);
        likeness(&mut found, (&of_gap, &drawn.gap), (&of_ensemble, reality));
        for text in [&of_card.text, &of_card.answer] {
            found.hold(&of_card, text.contains(&success), || {
                format!("{success}: {text}")
            });
        }
        let all = [
            (&of_gap, json(&drawn.gap)),
            (&of_ensemble, json(&drawn.ensemble)),
            (&of_card, json(&drawn.card)),
        ];
        for (told, json) in all {
            verdict::verdict(&mut found, told, &json);
            told.only_claims(&mut found.contradictions);
        }
    }
    found.close();
}

/// Gap and ensemble of one study agree with each other and with the energy test.
fn likeness(
    found: &mut Tally,
    (of_gap, gap): (&RenderedTexts, &StudyGap),
    (of_ensemble, reality): (&RenderedTexts, &Reality),
) {
    let mut rms = gap.metrics.iter().filter(|row| row.metric == "rms");
    let p = rms.next().unwrap().alike.unwrap().p_value;
    found.see("no difference found", p >= 0.05);
    found.see("another distribution", p < 0.05);
    let same = reality.alike.map(|alike| alike.p_value) == Some(p);
    found.hold(of_gap, same, || {
        format!("p = {p} is not that of the ensemble")
    });
    let text = of_gap.text.as_str();
    for (place, text) in [("terminal", text), ("page", &of_gap.answer)] {
        let other = text.contains("NOT have the distribution");
        found.hold(of_gap, other == (p < 0.05), || {
            format!("{place}, p = {p}: {text}")
        });
        found.hold(
            of_gap,
            other != text.contains("No difference is found"),
            || text.to_owned(),
        );
        let confidence = gap.confidence.as_ref().unwrap();
        let surely = confidence.surely_below_half_s.is_some();
        let below = confidence.below_half_s.is_some();
        found.hold(
            of_gap,
            text.contains("may be chance") == (below && !surely),
            || text.to_owned(),
        );
    }
    let claimed = verdict::of(&of_gap.claims, About::Gap).unwrap();
    let row = gap.metrics.iter().find(|row| row.metric == claimed.name);
    let row = row.and_then(|row| row.repeats).unwrap();
    let numbers = (claimed.numbers["gap"], claimed.numbers["noise_floors"]);
    let shown = (row.gap.value, row.ratio.unwrap().value);
    found.hold(of_gap, numbers == shown, || {
        format!("{claimed}, and the table {shown:?}")
    });
    let trust = verdict::of(&of_gap.claims, About::Trust).unwrap();
    let fails = trust.conclusion == Conclusion::Rejected;
    found.hold(of_gap, p >= 0.05 || fails, || {
        format!("p = {p}, and the verdict is {trust}")
    });
    let contradicts = of_ensemble.answer.contains("CONTRADICTED");
    found.hold(of_gap, p >= 0.05 || contradicts, || {
        format!("p = {p}, and the ensemble says: {}", of_ensemble.answer)
    });
    let first = gap.metrics[0].repeats.unwrap().ratio.unwrap();
    let ratio = realgap_core::unit::number(first.value);
    for text in [text, &of_gap.answer] {
        let said = format!("{ratio} noise floors away");
        found.hold(of_gap, text.contains(&said), || {
            format!("not {said}: {text}")
        });
    }
}

/// What a report is in a file.
fn json(report: &impl serde::Serialize) -> serde_json::Value {
    serde_json::to_value(report).unwrap()
}

/// The texts of a report in all of its places.
fn rendered(
    report: &impl std::fmt::Display,
    claims: &[Claim],
    name: String,
    page: &ResultsPage,
) -> RenderedTexts {
    RenderedTexts {
        name,
        text: report.to_string(),
        answer: page.answer(),
        page: plain(&page.html(None, "")),
        more: String::new(),
        claims: claims.to_vec(),
    }
}
