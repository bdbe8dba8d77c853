//! Reports: a results folder as one page that shows the numbers of the folder and runs no foreign text.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;

use common::browser::Browser;
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
fn results_of_several_folders_stand_beside_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before", "after"].map(|name| folder.path().join(name));
    swept(&before);
    swept(&after);
    let page = folder.path().join("both.html");
    let mut report = realgap();
    report.arg("report").args([&before, &after]).arg("-o");
    report.arg(&page).assert().success();
    let html = std::fs::read_to_string(&page).unwrap();
    let summary: serde_json::Value =
        serde_json::from_str(&common::read(&before, "summary.json")).unwrap();
    let claims = summary["claims"].as_array().unwrap();
    for claim in &claims[..3] {
        let text = claim["text"].as_str().unwrap();
        assert_eq!(html.matches(text).count(), 2, "{text}");
    }
    for words in ["/before", "/after", "floor.friction", "floor.restitution"] {
        assert!(html.contains(words), "{words}: {html}");
    }
    // The page of a folder is not touched by a comparison.
    assert!(!folder.path().join("comparison.html").exists());
    let mut missing = realgap();
    missing
        .arg("report")
        .arg(&before)
        .arg(folder.path().join("none"));
    missing.assert().failure();
}

#[test]
fn a_sweeps_page_holds_its_answer_its_map_and_where_it_comes_from() {
    let folder = tempfile::tempdir().unwrap();
    swept(folder.path());
    // The sweep writes the page; `realgap report` writes the same page, but for the command that made it.
    let written = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let page = report(folder.path());
    let before_command = |page: &str| page.split("<dt>this page</dt>").next().unwrap().to_owned();
    assert!(written.starts_with(before_command(&page).trim_end_matches("</dl>")));
    assert!(page.contains("<dt>run it again</dt><dd>realgap sweep "));
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
    let without_names = page
        .replace("http://www.w3.org/", "")
        .replace("href=\"#", "");
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
    assert!(page.contains(hash) && page.contains("comes nearest to the stand-in for reality"));

    // Foreign content of the files stays text.
    let hostile =
        "</script><script>document.title='run'</script><img src=x onerror=alert(1)>\u{202e}";
    let mut changed = summary;
    changed["study"] = hostile.into();
    changed["verdicts"][0]["text"] = hostile.into();
    changed["provenance"][hostile] = hostile.into();
    std::fs::write(folder.path().join("summary.json"), changed.to_string()).unwrap();
    let refused = realgap().arg("report").arg(folder.path()).output().unwrap();
    let said = text(&refused.stderr);
    assert!(
        !refused.status.success() && said.contains("--accept"),
        "{said}"
    );
    let accepted = ["report", "--accept"];
    realgap()
        .args(accepted)
        .arg(folder.path())
        .assert()
        .success();
    let page = report(folder.path());
    assert!(!page.contains("<img src=x") && !page.contains("<script>document.title"));
    assert!(!page.contains('\u{202e}'));
    let own = written.matches("<script>").count();
    assert_eq!(
        page.matches("<script>").count(),
        own,
        "the page's own scripts"
    );
}

/// The page that a command writes into its folder, opened in a browser.
fn told(args: &[&str], browser: Option<&mut Browser>) -> String {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().join("out");
    let output = realgap()
        .args(args)
        .arg("-o")
        .arg(&folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{args:?}: {}",
        text(&output.stderr)
    );
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    // The page was made from what the command had in memory; the files of the folder say the same.
    let again = out.path().join("again.html");
    realgap()
        .arg("report")
        .arg(&folder)
        .arg("-o")
        .arg(&again)
        .assert()
        .success();
    let again = std::fs::read_to_string(again).unwrap();
    let before_command = again.split("<dt>this page</dt>").next().unwrap();
    let is_same = page.starts_with(before_command.trim_end_matches("</dl>"));
    assert!(is_same, "{args:?}: another page of the same folder");
    if let Some(browser) = browser {
        browser.open(&folder.join("report.html"), "");
        browser.wait("realgap.ready === true");
        let seen = "[...document.querySelectorAll('#replay')].map(e => e.scrollIntoView({ behavior: 'instant' })).length";
        if browser.value(seen) == 1 {
            browser.wait("typeof realgap.draw === 'function'");
        }
        browser.is_quiet(&args.join(" "));
        browser.is_legible(&args.join(" "));
        browser.are_legible(&folder);
    }
    // With --no-report no page is written, and an old page is removed.
    if args[0] == "gap" {
        let args = [args, &["--no-report"]].concat();
        realgap()
            .args(&args)
            .arg("-o")
            .arg(&folder)
            .assert()
            .success();
        assert!(!folder.join("report.html").exists() && !folder.join("page.json").exists());
    }
    page
}

#[test]
fn every_command_with_a_folder_writes_a_page_with_its_answer() {
    let file = tempfile::tempdir().unwrap();
    let study = common::quick_study(file.path(), 2).display().to_string();
    let search = common::search_file(file.path(), common::SMALL_SEARCH)
        .display()
        .to_string();
    let noise = file.path().join("noise.ron");
    std::fs::write(&noise, "(start_heading_rad: Normal(0.02))").unwrap();
    let noise = noise.to_str().unwrap();
    let repeats = ["--repeats", "5", "--noise", noise];
    let robot = "morphologies/tripod.ron";
    let recorded = "real_trajectories/tripod_standin/*.csv";
    let mut browser = Browser::start();
    for (args, more, says) in [
        (
            vec![
                "tune",
                &study,
                "--metric",
                "rms",
                "--budget",
                "12",
                "--optimizer",
                "random",
            ],
            &[][..],
            ["comes nearest", "id=\"convergence\"", "id=\"replay\""],
        ),
        (
            vec!["search", &search],
            &[],
            ["The best robot", "id=\"finalists\"", "id=\"history\""],
        ),
        (
            vec!["ensemble", &study, "--model-error", "off"],
            &repeats,
            ["nine of ten repeats", "id=\"behaviours\"", "id=\"reality\""],
        ),
        (
            vec!["gap", &study],
            &repeats,
            ["noise floors away", "id=\"metrics\"", "id=\"over-time\""],
        ),
        (
            vec!["gap", "--recordings", recorded],
            &[],
            ["Repeats of one recorded run", "id=\"sets\"", "run it again"],
        ),
        (
            vec!["predict", robot, "--duration", "1", "--model-error", "off"],
            &repeats,
            ["with a probability of", "id=\"distance\"", "id=\"replay\""],
        ),
    ] {
        let page = told(&[&args, more].concat(), browser.as_mut());
        for said in says {
            assert!(page.contains(said), "{args:?}: {said}");
        }
        assert!(
            page.contains("What to do: ") || !page.contains("id=\"warnings\""),
            "{args:?}"
        );
    }
}

#[test]
fn a_folder_without_results_is_an_error_that_says_what_it_should_hold() {
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

#[test]
fn a_command_without_a_folder_writes_a_page_with_report() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (page, plot) = (at("belief.html"), at("belief.png"));
    let args = [
        "sense", "belief", "infrared", "--trials", "3", "--plot", &plot,
    ];
    let output = realgap()
        .args(args)
        .args(["--report", &page])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let first = text(&output.stdout);
    let first = first.trim().lines().next().unwrap();
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("<p class=\"kicker\">belief</p>"));
    assert!(
        page.contains(&first.replace('&', "&amp;").replace('<', "&lt;")),
        "{first}"
    );
    assert!(page.contains("src=\"data:image/png;base64,") && page.contains("run it again"));
    let output = realgap()
        .args(args)
        .args(["--report", "page.txt"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}
