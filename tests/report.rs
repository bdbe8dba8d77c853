//! Reports: a results folder as one page that holds the folder's own numbers and runs nothing of others.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::Path;

use common::browser::{browse, browser};
use common::{realgap, text};

/// A small sweep's folder.
fn swept(folder: &Path) {
    let file = tempfile::tempdir().unwrap();
    let root = common::project().display();
    let body = format!(
        r#"description: "a small one",
        morphology: "{root}/morphologies/tripod.ron",
        recordings: ["{root}/real_trajectories/tripod_standin/run_0[01].csv"],
        start: Settled,
        duration_s: 1.0,
        parameters: [
            (name: "floor.friction", from: 0.2, to: 0.8, points: 3),
            (name: "floor.restitution", from: 0.0, to: 0.6, points: 3),
        ],
        metric: "pca","#
    );
    let study = common::study(file.path(), &body);
    let out = folder.to_str().unwrap();
    let args = [
        "sweep",
        study.to_str().unwrap(),
        "--score",
        "single",
        "-o",
        out,
    ];
    realgap().args(args).assert().success();
}

fn report(folder: &Path) -> String {
    let output = realgap().arg("report").arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    std::fs::read_to_string(folder.join("report.html")).unwrap()
}

#[test]
fn a_sweeps_page_holds_its_answer_its_map_and_where_it_comes_from() {
    let folder = tempfile::tempdir().unwrap();
    swept(folder.path());
    let page = report(folder.path());
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
    let without_names = page.replace("http://www.w3.org/", "");
    for reference in ["http://", "https://", "href=\"", "url(", "@import"] {
        assert!(!without_names.contains(reference), "{reference}");
    }
    let sources = page.matches("src=\"").count();
    assert_eq!(sources, page.matches("src=\"data:image/").count());
    assert_eq!(page.matches("data-point=").count(), 9);
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    for verdict in summary["verdicts"].as_array().unwrap() {
        let parameter = verdict["parameter"].as_str().unwrap();
        assert!(page.matches(parameter).count() > 2, "{parameter}");
    }
    let hash = summary["provenance"]["morphology sha256"].as_str().unwrap();
    assert!(page.contains(hash) && page.contains("comes nearest to the recordings"));

    // A browser draws the path of the best point.
    if let Some(browser) = browser() {
        let profile = tempfile::tempdir().unwrap();
        let file = folder.path().join("report.html");
        let (dom, complaints) = browse(browser, &file, profile.path());
        assert_eq!(complaints, "", "the console");
        assert!(dom.contains("class=\"line sim faint\""), "no path");
        assert!(dom.contains("This is the best point."));
    }

    // Whatever others write into the folder's files is text.
    let hostile =
        "</script><script>document.title='run'</script><img src=x onerror=alert(1)>\u{202e}";
    let mut changed = summary;
    changed["study"] = hostile.into();
    changed["verdicts"][0]["text"] = hostile.into();
    changed["provenance"][hostile] = hostile.into();
    std::fs::write(folder.path().join("summary.json"), changed.to_string()).unwrap();
    let page = report(folder.path());
    assert!(!page.contains("<img src=x") && !page.contains("<script>document.title"));
    assert!(!page.contains('\u{202e}'));
    assert_eq!(
        page.matches("<script>").count(),
        2,
        "the page's own scripts"
    );
}

#[test]
fn a_folder_without_results_says_what_it_should_hold() {
    let folder = tempfile::tempdir().unwrap();
    let output = realgap().arg("report").arg(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("summary.json"),
        "{}",
        text(&output.stderr)
    );
    let output = realgap().args(["report", "nowhere"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}
