//! The page that a run renews while it goes on.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;
use std::time::{Duration, Instant};

use crate::common::{self, realgap, text};

/// What the page says of how far the run is.
fn so_far(page: &Path) -> Option<String> {
    let text = std::fs::read_to_string(page).ok()?;
    let (_, after) = text.split_once("id=\"so-far\">")?;
    Some(after.split_once("</p>")?.0.to_owned())
}

/// Single runs of the tripod one after another, which last long enough to be watched.
const SHORT: [&str; 9] = [
    "sweeps/tripod_floor.ron",
    "--metric",
    "rms",
    "--duration",
    "10",
    "--score",
    "single",
    "--jobs=1",
    "--no-audit",
];

/// The pages that a command leaves while it runs, each text once, and the last page.
fn watched(words: &[&str]) -> (Vec<String>, String) {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("live.html");
    let (out, file) = (folder.path().join("out"), page.to_str().unwrap());
    let places = ["-o", out.to_str().unwrap(), "--live", file];
    let mut child = common::start(&[words, &SHORT, &places].concat());
    let (begun, mut seen) = (Instant::now(), Vec::new());
    let status = loop {
        let is_renewed = std::fs::read_to_string(&page)
            .is_ok_and(|text| text.contains("http-equiv=\"refresh\" content=\"2\""));
        if is_renewed
            && let Some(said) = so_far(&page)
            && seen.last() != Some(&said)
        {
            seen.push(said);
        }
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(begun.elapsed() < Duration::from_secs(300), "{seen:?}");
        std::thread::sleep(Duration::from_millis(100));
    };
    assert!(status.success(), "{seen:?}");
    (seen, std::fs::read_to_string(&page).unwrap())
}

#[test]
fn a_sweep_renews_a_page_with_its_map_and_ends_with_the_place_of_the_answer() {
    let (seen, last) = watched(&["sweep", "--points", "5"]);
    assert!(seen[0].contains("The run begins"), "{seen:?}");
    assert!(seen.len() >= 2, "{seen:?}");
    assert!(
        seen.iter().any(|said| said.contains(" of 25 points")),
        "{seen:?}"
    );
    assert!(
        seen.iter().any(|said| said.contains("The best so far: ")),
        "{seen:?}"
    );
    assert!(!last.contains("http-equiv=\"refresh\""), "the run is over");
    assert!(last.contains("the answer is in"), "{:?}", so_far_of(&last));
    // The map, the trace and the table of the best points.
    for id in ["map", "trace", "points"] {
        assert!(last.contains(&format!("id=\"{id}\"")), "{id}");
    }
    assert!(last.contains("floor.restitution"));
}

fn so_far_of(page: &str) -> Option<&str> {
    Some(page.split_once("id=\"so-far\">")?.1.split_once("</p>")?.0)
}

#[test]
fn a_tuning_renews_a_page_with_its_trace() {
    let (seen, last) = watched(&["tune", "--optimizer", "nelder-mead", "--budget", "24"]);
    assert!(
        seen.iter().any(|said| said.contains(" of 24 points")),
        "{seen:?}"
    );
    assert!(last.contains("id=\"trace\"") && !last.contains("id=\"map\""));
}

#[test]
fn a_live_page_that_cannot_be_written_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut sweep = realgap();
    sweep.args([
        "sweep",
        "sweeps/tripod_floor.ron",
        "--live",
        "live.txt",
        "-o",
    ]);
    let refused = sweep.arg(folder.path().join("out")).output().unwrap();
    let said = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("a page is an HTML file") && said.contains(".html"),
        "{said}"
    );
}
