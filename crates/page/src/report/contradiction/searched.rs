//! Whether every place says one thing of a search.

use super::drawn::Draw;
use super::rendered::plain;
use super::{STUDIES, json};
use crate::report::ResultsPage;
use crate::report::document::picture::Pictures;
use crate::results::table::CsvTable;
use crate::results::{BestRobot, History, SearchSummary};
use realgap_core::unit::{Unit, quantity};
use realgap_lab::claim;
use realgap_lab::search::Baseline;

/// A robot whose numbers are drawn at random.
fn robot(draw: &mut Draw, rank: usize, survives: bool) -> BestRobot {
    let fitness = draw.is(0.9).then(|| draw.within(0.1, 3.0));
    BestRobot {
        rank,
        index: draw.below(100),
        file: format!("{rank:02}_robot_{:05}", draw.below(10_000)),
        modules: 3,
        servos: 2,
        search_fitness: Some(draw.within(0.1, 3.0)),
        fitness,
        median_displacement_m: fitness,
        displacement_q05_q95_m: fitness.map(|m| [0.8 * m, 1.2 * m]),
        success_m: fitness.map(|m| 0.5 * m),
        success: Some(draw.within(0.0, 1.0)),
        joules_per_metre: None,
        cost_of_transport: None,
        survives,
        largest_change: Some(draw.within(0.0, 1.0)),
        worst_rerun: Some("half the timestep".to_owned()),
    }
}

fn drawn(draw: &mut Draw) -> SearchSummary {
    let complete = draw.is(0.8);
    let count = if complete { draw.below(4) } else { 0 };
    let survivors = draw.below(count + 1);
    // Survivors come first.
    let best = (0..count).map(|k| robot(draw, k + 1, k < survivors));
    let best: Vec<BestRobot> = best.collect();
    let start = draw.is(0.5).then(|| draw.within(0.1, 3.0));
    let summary = SearchSummary {
        search: "drawn".to_owned(),
        strategy: "evolution".to_owned(),
        objective: "net displacement, median".to_owned(),
        unit: "m".to_owned(),
        complete,
        robots: 40,
        robots_total: 40,
        repeats: 3,
        duration_s: 10.0,
        seed: 1,
        failures: Default::default(),
        best_fitness: best
            .iter()
            .filter_map(|b| b.search_fitness)
            .reduce(f64::max),
        archive: None,
        baseline: start.map(|fitness| Baseline {
            robot: "tripod".to_owned(),
            fitness: Some(fitness),
            median_displacement_m: None,
            displacement_q05_q95_m: None,
            failure: None,
        }),
        parameters: Vec::new(),
        posterior_page: None,
        parameter_share: None,
        best,
        claims: Vec::new(),
        engine: "tree".to_owned(),
        version: "0".to_owned(),
        warnings: Vec::new(),
    };
    summary.with_claims(&[])
}

#[test]
fn a_search_says_one_thing_in_every_place() {
    let (mut fails, mut holds, mut open, mut beaten) = (0, 0, 0, 0);
    for seed in 0..STUDIES {
        let found = drawn(&mut Draw::new(5000 + seed));
        let (history, archive) = (History::default(), CsvTable::default());
        let page = ResultsPage::of_search(&found, history, archive, &[], Pictures::default());
        let page = plain(&page.unwrap().html(None, ""));
        // The terminal begins with these lines (`realgap search`).
        let text = claim::verdict_lines(&found.claims);
        let json = json(&found);
        let parts = claim::verdict(&found.claims);
        for (index, (label, claim)) in parts.iter().enumerate() {
            let own = format!("{label}\n{claim}");
            assert_eq!(
                page.matches(&own).count(),
                1,
                "search {seed}: {own}\n{page}"
            );
            assert!(
                text.contains(&format!("{label}: {claim}\n")),
                "search {seed}: {text}"
            );
            assert_eq!(json["claims"][index]["text"], claim.text.as_str());
        }
        let Some(best) = found.best.first() else {
            open += 1;
            assert!(
                text.starts_with("trust: ") && page.contains("cannot be told"),
                "{text}"
            );
            continue;
        };
        for place in [&text, &page] {
            assert!(place.contains(&best.file), "search {seed}: {place}");
            let is_against = place.contains("NOT walk the same");
            assert_eq!(is_against, !best.survives, "search {seed}: {place}");
        }
        let score = best.fitness.map(|fitness| quantity(fitness, Unit::Metre));
        if let Some(score) = score {
            assert!(
                text.contains(&score) && page.contains(&score),
                "{score}: {page}"
            );
        }
        let start = found.baseline.as_ref().and_then(|start| start.fitness);
        if let (Some(start), Some(own)) = (start, best.fitness) {
            let is_beaten = text.contains("was beaten");
            assert_eq!(is_beaten, own > start, "search {seed}: {text}");
            beaten += usize::from(is_beaten);
        }
        match best.survives {
            true => holds += 1,
            false => fails += 1,
        }
    }
    let seen = [fails, holds, open, beaten];
    assert!(seen.iter().all(|times| *times >= 8), "{seen:?}");
}
