//! The finalists of a search: compared with the robot that the search started from, and in another engine.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;
use std::process::Command;

use assert_cmd::assert::Assert;
use common::{SMALL_SEARCH, project, python_with, read, realgap, search_file, summary, text};

/// Runs the search into `folder`/out.
fn search(folder: &Path, body: &str, more: &[&str]) -> Assert {
    realgap()
        .arg("search")
        .arg(search_file(folder, body))
        .arg("-o")
        .arg(folder.join("out"))
        .args(more)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .assert()
}

#[test]
fn the_robot_that_a_search_starts_from_gets_the_draws_that_rank_the_finalists() {
    let folder = tempfile::tempdir().unwrap();
    let tripod = project().join("morphologies/tripod.ron");
    // Without amplitude nothing walks; the tripod with its own gait does.
    let body = format!(
        "strategy: Grid(genes: [(gene: \"amplitude\", values: [0.0])]), duration_s: 1.0, repeats: 2,
         start: Morphology(\"{}\"), finalists: (count: 1, repeats: 4),
         development: (amplitude_rad: (0.0, 1.0), frequency_hz: (0.1, 3.0), phase_rad: (-7.0, 7.0), offset_rad: (-2.0, 2.0)),",
        tripod.display()
    );
    let said = search(folder.path(), &body, &[]).success();
    let said = said.get_output();
    let printed = text(&said.stdout);
    assert!(printed.contains("started from tripod: "), "{printed}");
    let warned = text(&said.stderr);
    assert!(warned.contains("baseline-not-beaten"), "{warned}");
    let summary = summary(&folder.path().join("out"));
    let fitness = summary["baseline"]["fitness"].as_f64().unwrap();
    let still = summary["best"][0]["fitness"].as_f64().unwrap();
    assert!(still < 0.02 && fitness > 2.0 * still, "{still} {fitness}");
}

#[test]
fn a_search_without_a_start_robot_has_no_baseline_and_every_success_has_its_distance() {
    let folder = tempfile::tempdir().unwrap();
    let said = search(folder.path(), SMALL_SEARCH, &[]).success();
    assert!(!text(&said.get_output().stdout).contains("started from"));
    let summary = summary(&folder.path().join("out"));
    assert!(summary["baseline"].is_null());
    for robot in summary["best"].as_array().unwrap() {
        let (share, least_m) = (&robot["success"], &robot["success_m"]);
        assert_eq!(share.is_null(), least_m.is_null(), "{robot}");
    }
}

#[test]
fn a_robot_that_walks_differently_in_mujoco_does_not_survive() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    search(
        folder.path(),
        SMALL_SEARCH,
        &[&format!("--mujoco={python}")],
    )
    .success();
    let out = folder.path().join("out");
    let summary = summary(&out);
    let best = summary["best"].as_array().unwrap();
    assert_eq!(best.len(), 2);
    for robot in best {
        let name = format!("{}.json", robot["file"].as_str().unwrap());
        let card: serde_json::Value =
            serde_json::from_str(&read(&out.join("best"), &name)).unwrap();
        let reruns = card["reruns"].as_array().unwrap();
        let there = reruns.iter().find(|r| r["settings"] == "MuJoCo").unwrap();
        let change = there["change"].as_f64().unwrap();
        assert_eq!(there["survives"], change.abs() <= 0.25, "{there}");
        let all = reruns.iter().all(|rerun| rerun["survives"] == true);
        assert_eq!(robot["survives"], all, "{robot}");
    }
    let survives = |index: usize| best[index]["survives"] == true;
    assert!(survives(0) || !survives(1), "survivors first");
}

#[test]
fn without_mujoco_the_remedy_is_named_and_the_results_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let said = search(folder.path(), SMALL_SEARCH, &["--mujoco=no-such-python"]).code(1);
    let error = text(&said.get_output().stderr);
    assert!(error.contains("pip install mujoco"), "{error}");
    let summary = summary(&folder.path().join("out"));
    assert_eq!(summary["best"].as_array().unwrap().len(), 2);
}

#[test]
fn the_mujoco_tool_reruns_finalists_where_there_is_mujoco() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    search(folder.path(), SMALL_SEARCH, &[]).success();
    let out = folder.path().join("out");
    let done = Command::new(&python)
        .arg(project().join("tools/rerun_finalists.py"))
        .arg(&out)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", text(&done.stderr));
    let report: serde_json::Value =
        serde_json::from_str(&read(&out.join("best"), "mujoco.json")).unwrap();
    let robots = report["robots"].as_array().unwrap();
    assert_eq!(robots.len(), 2);
    assert!(
        robots
            .iter()
            .all(|r| r["mujoco_median_m"].as_f64().unwrap() < 1.0),
        "{report}"
    );
}

#[test]
fn a_tower_that_falls_over_once_gets_nowhere_after_that() {
    use realgap::search::Objective;
    use realgap::trajectory::{POINTS, Prepared};
    // 12 cm in the first second of ten, then nothing; and 12 cm in ten seconds.
    let path = |at: &dyn Fn(f64) -> f64| {
        let x_m = |index: usize| at(10.0 * index as f64 / (POINTS - 1) as f64);
        Prepared::from_xy_m((0..POINTS).map(|index| [x_m(index), 0.0]).collect()).unwrap()
    };
    let falls = path(&|t_s| 0.12 * t_s.min(1.0));
    let walks = path(&|t_s| 0.012 * t_s);
    let far_m = |from_s: f64, path: &Prepared| {
        let objective = Objective {
            from_s,
            ..Objective::default()
        };
        let travel = objective.travel(path, 0.0, None, 10.0);
        assert!((travel.displacement_m - travel.path_length_m).abs() < 1e-12);
        travel.displacement_m
    };
    assert!((far_m(0.0, &falls) - far_m(0.0, &walks)).abs() < 1e-12);
    assert!(far_m(5.0, &falls) < 1e-12);
    assert!((far_m(5.0, &walks) - 0.06).abs() < 0.001);
    let folder = tempfile::tempdir().unwrap();
    let body = SMALL_SEARCH.replace(
        "duration_s: 1.0,",
        "duration_s: 1.0, objective: (from_s: 1.0),",
    );
    let said = search(folder.path(), &body, &[]).code(1);
    let error = text(&said.get_output().stderr);
    assert!(error.contains("less than the duration"), "{error}");
}
