//! What a results folder says in two places is the same, and what it outlines is what its tables mark: over studies of every method
//! that are generated, run and written.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common;

use realgap::RunOptions;
use realgap::calibration::{
    Answer, INTERVAL_LEVEL, Method, Overrides, POSSIBLE_LEVEL, Study, TuneOptions,
};
use realgap::claim::{self, Conclusion};
use realgap::comparison::by_name;
use realgap::optimization::optimizer_by_name;
use realgap::results;
use realgap::unit::{Unit, number, quantity};

/// How the points of the generated studies are chosen, in turn.
const METHODS: [&str; 6] = [
    "sweep",
    "cma-es",
    "sweep",
    "nelder-mead",
    "bayesian",
    "random",
];
/// Studies in a long run, and otherwise.
const MANY: u64 = 102;
const FEW: u64 = 12;

/// A study with its own seed, grid, recordings and metric.
fn generated(folder: &Path, seed: u64) -> Study {
    let points = 3 + (seed % 4) as usize;
    let overrides = Overrides {
        metric: Some(by_name(if seed % 5 < 3 { "rms" } else { "pca" }).unwrap()),
        limit_recordings: Some(2 + (seed % 3) as usize),
        seed: Some(seed),
        ..Overrides::default()
    };
    Study::read(common::quick_study(folder, points), &overrides).unwrap()
}

fn answer(study: &Study, method: &str) -> Answer {
    let run = RunOptions::default();
    if method == "sweep" {
        return study.sweep(&run).unwrap();
    }
    let options = TuneOptions {
        optimizer: optimizer_by_name(method).unwrap(),
        budget: 72,
        patience: None,
    };
    study.tune(&options, &run).unwrap()
}

/// The columns of points.csv that are compared.
struct Row {
    values: Vec<f64>,
    score: Option<f64>,
    mean: Option<f64>,
    is_in: bool,
    runs: usize,
}

fn rows(folder: &Path, parameters: usize) -> Vec<Row> {
    let text = std::fs::read_to_string(folder.join("points.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|known| *known == name).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        Row {
            values: cells[..parameters]
                .iter()
                .map(|c| c.parse().unwrap())
                .collect(),
            score: cells[at("score")].parse().ok(),
            mean: cells[at("mean_score")].parse().ok(),
            is_in: cells[at("indistinguishable")] == "true",
            runs: cells[at("runs")].parse().unwrap(),
        }
    };
    lines.map(row).collect()
}

/// Of each cell of the page's map: the row of points.csv, and whether the page says that it is in the confidence set.
fn cells(page: &str) -> Vec<(usize, bool)> {
    let all = page.split("<rect class=\"cell").skip(1);
    let cell = |text: &str| {
        let row = text.split("data-point=\"").nth(1)?.split('"').next()?;
        let title = text.split("<title>").nth(1)?.split("</title>").next()?;
        Some((
            row.parse().unwrap(),
            title.contains("in the confidence set"),
        ))
    };
    all.filter_map(cell).collect()
}

/// The answers to the question whether a result may be trusted, by words that only they use.
const TRUSTS: [(&str, &str); 5] = [
    ("The answer holds on", "holds on others"),
    (
        "The model fits the recordings",
        "fits, not yet tested on others",
    ),
    (
        "does not explain the recordings",
        "does not explain the recordings",
    ),
    (
        "The fit does not carry over",
        "does not explain the recordings",
    ),
    ("Whether to trust this cannot be told", "cannot be told"),
];

/// Terminal, page and `summary.json` begin with one verdict, whose numbers and words are those of everything below it.
fn one_verdict(what: &str, out: &Path, answer: &Answer, page: &str) {
    let report = &answer.report;
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let text = report.to_string();
    let claims = claim::verdict(&report.claims);
    assert_eq!(claims.len(), 3, "{what}: {text}");
    for (index, (label, claim)) in claims.iter().enumerate() {
        let line = text.lines().nth(index).unwrap();
        assert_eq!(line, format!("{label}: {claim}"), "{what}");
        assert_eq!(summary["claims"][index]["text"], claim.text, "{what}");
        let shown = claim.text.replace('>', "&gt;").replace('<', "&lt;");
        assert!(page.contains(&shown), "{what}: {shown} is not on the page");
    }
    let [(_, gap), (_, parameters), (_, trust)] = claims.try_into().unwrap();

    // The gap is that of the best point, and in noise floors that of the fit and of the picture.
    let best = report.best.as_ref().unwrap();
    assert_eq!(gap.numbers["score"], best.score, "{what}");
    if let Some(error_m) = best.displacement_error_m {
        assert!(
            gap.text.contains(&quantity(error_m, Unit::Metre)),
            "{what}: {gap}"
        );
    }
    let floors = report.fit.as_ref().and_then(|fit| fit.noise_floors);
    assert_eq!(gap.numbers.get("noise_floors").copied(), floors, "{what}");
    for place in [&text, page] {
        for floors_said in place
            .split(" noise floors")
            .collect::<Vec<_>>()
            .split_last()
            .unwrap()
            .1
        {
            let said = floors_said.rsplit([' ', '>']).next().unwrap();
            if let (Ok(_), Some(floors)) = (said.parse::<f64>(), floors) {
                assert_eq!(said, number(floors), "{what}: {place}");
            }
        }
    }

    // Of every parameter the verdict says what its own sentence says.
    for verdict in &report.verdicts {
        let known = format!("{} is not determined", verdict.parameter);
        let is_open = parameters.text.contains(&known);
        assert_eq!(is_open, !verdict.identified, "{what}: {parameters}");
    }

    // One answer on trust in every place, and nothing that speaks against it.
    let picture = std::fs::read_to_string(out.join("heatmap.svg")).unwrap();
    let explains = report.fit.as_ref().is_none_or(|fit| fit.explains);
    let fails = trust.conclusion == Conclusion::Rejected;
    assert!(explains || fails || !report.complete, "{what}: {trust}");
    for place in [&text, page] {
        for (words, word) in TRUSTS {
            assert!(
                !place.contains(words) || trust.word == word,
                "{what}: {words}, and the verdict is {trust}"
            );
        }
        let rejects = place.contains("No parameters of this model");
        assert_eq!(rejects, !explains, "{what}: {trust}");
    }
    assert_eq!(
        picture.contains("NOT EXPLAINED"),
        !explains,
        "{what}: {trust}"
    );
}

fn check(seed: u64, method: &str) {
    let folder = tempfile::tempdir().unwrap();
    let study = generated(folder.path(), seed);
    let answer = answer(&study, method);
    let out = folder.path().join("results");
    let page = results::write(&out, &study, &answer).unwrap();
    let what = format!("seed {seed}, {method}");
    let ranges = study.definition().grid.ranges();
    let rows = rows(&out, ranges.len());
    let report = &answer.report;
    let best = report.best.as_ref().unwrap();

    // A point is outlined exactly if its row says so, and the picture counts the cells that the table counts.
    let picture = std::fs::read_to_string(out.join("heatmap.svg")).unwrap();
    let said = picture.split("95 % confidence set (").nth(1).unwrap();
    let said: usize = said.split(' ').next().unwrap().parse().unwrap();
    let uncertainty = answer.uncertainty.as_ref().unwrap();
    if answer.method == Method::Sweep {
        let on_grid = study.definition().grid.len();
        let marked = rows.iter().take(on_grid).filter(|row| row.is_in).count();
        assert_eq!(said, marked, "{what}");
        let outlined = cells(&page.html(None, "realgap"));
        assert!(outlined.len() >= on_grid, "{what}: {}", outlined.len());
        for (row, is_in) in outlined {
            assert_eq!(rows[row].is_in, is_in, "{what}, row {row}");
        }
    } else {
        let cells = uncertainty.cells.iter().filter(|is_in| **is_in).count();
        assert_eq!(said, cells, "{what}");
    }

    // The best point is the lowest mean over all settings, in the report, in the table, and first of all rows by rank.
    let settings = study.setting_count();
    let values: Vec<f64> = ranges
        .iter()
        .map(|r| best.parameters[r.parameter.name])
        .collect();
    let own = rows.iter().find(|row| row.values == values).unwrap();
    assert_eq!(
        (own.score, own.mean),
        (Some(best.score), Some(best.score)),
        "{what}"
    );
    for row in rows.iter().filter(|row| row.runs >= settings) {
        assert!(row.mean.unwrap() >= best.score, "{what}");
    }
    // A run with one setting is no mean over all of them.
    for row in rows.iter().filter(|row| row.runs < settings) {
        assert!(row.mean.is_none() || row.mean != row.score, "{what}");
    }
    let results::RankedPoints {
        header,
        rows: ranked,
    } = results::ranked_points(&out).unwrap().unwrap();
    let score = header.iter().position(|name| name == "mean_score").unwrap();
    assert_eq!(
        ranked[0][score].parse::<f64>().unwrap(),
        best.score,
        "{what}"
    );
    assert_eq!(ranked.len(), rows.len(), "{what}");

    one_verdict(&what, &out, &answer, &page.html(None, "realgap"));

    // Every interval is a quantile of the draws, and holds the best, or the sentence says why it does not.
    let draws = answer.draws.as_ref().unwrap();
    for (axis, verdict) in report.verdicts.iter().enumerate() {
        let parts = draws.intervals(axis, INTERVAL_LEVEL);
        let said = match verdict.interval {
            Some(one) => vec![one],
            None => verdict.intervals.clone(),
        };
        assert_eq!(said, parts, "{what}");
        let (low, high) = draws.interval(axis, POSSIBLE_LEVEL);
        assert!(verdict.low <= low && verdict.high >= high, "{what}");
        assert_eq!(verdict.best, values[axis], "{what}");
        let is_inside = parts
            .iter()
            .any(|(low, high)| (*low..=*high).contains(&verdict.best));
        let is_told =
            verdict.text.contains("lies outside of it") || verdict.text.contains("leaves out");
        assert!(
            is_inside || is_told || !verdict.identified,
            "{what}: {}",
            verdict.text
        );
    }
}

#[test]
fn what_a_folder_outlines_ranks_and_tells_is_what_its_tables_hold() {
    let studies = match common::is_long_run("a hundred generated studies; a dozen are run") {
        true => MANY,
        false => FEW,
    };
    for seed in 0..studies {
        check(seed, METHODS[seed as usize % METHODS.len()]);
    }
}
