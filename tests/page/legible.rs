//! Legibility of pages and pictures in a real browser at three widths: no text overlaps another or is cut.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;

use common::browser::Browser;
use common::{realgap, text};
use serde_json::json;

fn run(args: &[&str]) {
    let output = realgap().args(args).output().unwrap();
    let said = text(&output.stderr);
    assert!(output.status.success(), "{args:?}: {said}");
}

/// A small study of a walking robot over some of three parameters.
fn study(folder: &Path, parameters: &[&str]) -> String {
    let root = common::project().display();
    let all = [
        ("floor.friction", 0.1, 0.9),
        ("floor.restitution", 0.0, 0.8),
        ("servo.gain_1_s", 5.0, 60.0),
    ];
    let wanted = all.iter().filter(|(name, ..)| parameters.contains(name));
    let varied: Vec<String> = wanted
        .map(|(name, from, to)| {
            format!("(name: \"{name}\", from: {from:?}, to: {to:?}, points: 3)")
        })
        .collect();
    let body = format!(
        "morphology: \"{root}/morphologies/tripod.ron\",
        recordings: [\"{root}/real_trajectories/tripod_standin/run_0[01].csv\"],
        start: Settled, duration_s: 0.5, {}
        parameters: [{}],",
        common::STANDIN_NUMERICS,
        varied.join(", ")
    );
    common::study(folder, &body).display().to_string()
}

/// Logs of an arm, over three parameters of one joint.
fn arm(folder: &Path) -> String {
    let root = common::project().display();
    let body = format!(
        "morphology: \"{root}/morphologies/so101_feetech.ron\",
        recordings: [\"{root}/real_trajectories/so101_arm/s*.csv\"],
        start: FromRecording, commands: Commands(), timestep_s: 0.01, duration_s: 1.5, set: {{\"solver.engine\": 1}},
        parameters: [
            (name: \"servo.elbow_flex.stiffness_nm_rad\", from: 10, to: 100),
            (name: \"servo.elbow_flex.latency_s\", from: 0, to: 0.08),
            (name: \"servo.elbow_flex.offset_rad\", from: -0.05, to: 0.05),
        ],
        metric: \"joints\", score: Single,"
    );
    common::study(folder, &body).display().to_string()
}

fn open(browser: &mut Browser, page: &Path) {
    browser.look([1440, 900], false);
    browser.open(page, "");
    browser.wait("typeof realgap === 'undefined' || realgap.ready === true");
}

#[test]
fn no_text_of_a_page_lies_on_another_or_is_cut() {
    if !common::is_long_run("texts of pages in a browser") {
        return;
    }
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let one = ["floor.friction"];
    let two = ["floor.friction", "floor.restitution"];
    let three = ["floor.friction", "floor.restitution", "servo.gain_1_s"];
    for (name, parameters) in [("one", &one[..]), ("two", &two), ("three", &three)] {
        let out = at(name);
        let study = study(folder.path(), parameters);
        run(&[
            "sweep",
            &study,
            "--metric",
            "rms",
            "-o",
            out.to_str().unwrap(),
        ]);
        open(&mut browser, &out.join("report.html"));
        browser.is_legible(name);
        // The charts are drawn again for every chosen point.
        browser.value("document.getElementById('heat')?.querySelector('[data-point]').dispatchEvent(new Event('click'))");
        browser.is_legible(&format!("{name}, the first point"));
        // The best point, alone or between others, has a path beside the recorded ones.
        assert_eq!(
            browser.value("document.querySelectorAll('#path .line.real').length"),
            json!(2)
        );
        assert_ne!(
            browser.value("document.querySelector('#path .line.sim').getAttribute('d')"),
            json!("")
        );
        // From two parameters on the page shows which values go together.
        let is_corner = browser.value("document.querySelectorAll('#corner img').length");
        assert_eq!(
            is_corner,
            json!(usize::from(parameters.len() > 1)),
            "{name}"
        );
        assert!(browser.are_legible(&out) >= 2, "{name}");
    }
    let study = study(folder.path(), &two);
    let page = at("evaluate.html");
    run(&["evaluate", &study, "--report", page.to_str().unwrap()]);
    open(&mut browser, &page);
    browser.is_legible("evaluate");
    let page = at("replay.html");
    let recorded = "real_trajectories/tripod_standin/run_00.csv";
    let robot = "morphologies/tripod.ron";
    let replay = ["replay", robot, "--duration", "1", "--against", recorded];
    run(&[&replay[..], &["-o", page.to_str().unwrap()]].concat());
    open(&mut browser, &page);
    browser.is_legible("replay");
}

#[test]
fn joints_are_shown_over_time_with_their_residuals() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("arm");
    let tune = [
        "tune",
        &arm(folder.path()),
        "--optimizer",
        "gauss-newton",
        "--budget",
        "30",
    ];
    run(&[&tune[..], &["-o", out.to_str().unwrap()]].concat());
    let table = common::read(&out, "joints.csv");
    let page = common::read(&out, "report.html");
    let joints = [
        "shoulder_pan",
        "shoulder_lift",
        "elbow_flex",
        "wrist_flex",
        "wrist_roll",
        "gripper",
    ];
    for joint in joints {
        assert!(table.contains(&format!(",{joint},")), "{joint}");
        assert!(page.contains(&format!("<h3>{joint}</h3>")), "{joint}");
    }
    assert!(out.join("joints.png").is_file() && out.join("corner.png").is_file());
    // The best values beat the first guess, and the table is of them: its mean error is the score.
    let (mut sum, mut count) = (0.0, 0.0);
    for line in table.lines().skip(1) {
        let cells: Vec<f64> = line
            .split(',')
            .skip(3)
            .map(|v| v.parse().unwrap())
            .collect();
        sum += (cells[1] - cells[0]).abs();
        count += 1.0;
    }
    let score = common::summary(&out)["best"]["score"].as_f64().unwrap();
    assert!(
        (sum / count - score).abs() < 1e-5,
        "{} {score}",
        sum / count
    );
    // A base that stands still has no path to be shown.
    assert!(!out.join("trajectories.png").exists() && !page.contains("id=\"path\""));

    let Some(mut browser) = Browser::start() else {
        return;
    };
    open(&mut browser, &out.join("report.html"));
    let charts = browser.value("document.querySelectorAll('#joints figure .chart').length");
    assert_eq!(charts, json!(2 * joints.len()));
    let kinds = "['real', 'sim', 'b1'].map(kind => document.querySelectorAll('#joints .line.' + kind).length)";
    assert_eq!(browser.value(kinds), json!([6, 6, 6]));
    assert_eq!(
        browser.value("document.querySelectorAll('#joints .band').length"),
        json!(6 + 1)
    );
    browser.is_quiet("the arm");
    browser.is_legible("the arm");
    assert!(browser.are_legible(&out) >= 5);
}

#[test]
fn the_answer_is_seen_without_scrolling_and_contents_stand_beside_it() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("gap");
    let study = study(folder.path(), &["floor.friction"]);
    let noise = folder.path().join("noise.ron");
    std::fs::write(&noise, "(start_heading_rad: Normal(0.02))").unwrap();
    let gap = [
        "gap",
        &study,
        "--repeats",
        "5",
        "--noise",
        noise.to_str().unwrap(),
    ];
    run(&[&gap[..], &["-o", out.to_str().unwrap()]].concat());
    open(&mut browser, &out.join("report.html"));
    // The test of whether both come from one distribution stands beside the name of the metric, on a phone, too.
    let seen = "[...document.querySelectorAll('#metrics td:nth-child(2)')].every(cell => { \
        const scroll = cell.closest('.scroll').getBoundingClientRect(), box = cell.getBoundingClientRect(); \
        return box.right <= Math.min(scroll.right, innerWidth) && box.left >= scroll.left; })";
    let head = "document.querySelector('#metrics th:nth-child(2)').textContent";
    assert_eq!(browser.value(head), json!("same distribution? p"));
    let beside = "document.querySelector('.contents').getBoundingClientRect().right <= document.querySelector('main').getBoundingClientRect().left";
    for width in [390, 1100, 1440] {
        browser.look([width, 900], false);
        assert_eq!(browser.value(seen), json!(true), "{width}");
        assert_eq!(browser.value(beside), json!(width > 960), "{width}");
    }
    // They stay there, and lead to every part.
    let parts = "[document.querySelectorAll('.contents a').length, document.querySelectorAll('main > section[id]').length]";
    let count = browser.value(parts);
    assert!(
        count[0] == count[1] && count[0].as_u64() > Some(3),
        "{count}"
    );
    browser.value("scrollTo({ top: 600, behavior: 'instant' })");
    let stays = "document.querySelector('.contents').getBoundingClientRect().top >= 0";
    assert_eq!(browser.value(stays), json!(true));
}

#[test]
fn no_text_of_a_picture_lies_on_another_or_is_cut() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let runs = ["00", "01", "02"].map(|k| format!("real_trajectories/tripod_standin/run_{k}.csv"));
    let [a, b, c] = runs.each_ref().map(String::as_str);
    let plots = ["overlay.svg", "time.svg"].map(at);
    run(&[
        "compare",
        a,
        b,
        c,
        "--plot",
        &plots[0],
        "--over-time",
        &plots[1],
    ]);
    run(&[
        "check",
        "morphologies/so101_arm.ron",
        "--plot",
        &at("arm.svg"),
    ]);
    run(&[
        "check",
        "morphologies/tripod.ron",
        "--plot",
        &at("robot.svg"),
    ]);
    let study = study(folder.path(), &["floor.friction", "servo.gain_1_s"]);
    run(&["study", "sensitivity", &study, "--plot", &at("bars.svg")]);
    run(&[
        "sense",
        "belief",
        "infrared",
        "--trials",
        "3",
        "--plot",
        &at("belief.svg"),
    ]);
    let log = at("log.csv");
    run(&[
        "sense",
        "draw",
        "ultrasonic",
        "--readings",
        "20",
        "-o",
        &log,
    ]);
    let plots = ["sensor.svg", "histograms.svg"].map(at);
    run(&[
        "sense",
        "fit",
        &log,
        "--plot",
        &plots[0],
        "--histograms",
        &plots[1],
    ]);
    let trials = "floor,duration_s,finished\nsmooth floor,3,1\nsmooth floor,4.5,1\nsmooth floor,8,0\nrough floor,5,1\nrough floor,7,1\n";
    let tasks = at("tasks.csv");
    std::fs::write(&tasks, trials).unwrap();
    let plots = ["times.svg", "curves.svg"].map(at);
    run(&[
        "sense", "tasks", "compare", &tasks, &tasks, "--plot", &plots[0], "--curves", &plots[1],
    ]);
    assert_eq!(browser.are_legible(folder.path()), 10);
}
