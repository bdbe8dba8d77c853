//! From a genome to a robot on the command line.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::{realgap, text};

#[test]
fn a_random_genome_becomes_a_robot_that_check_and_simulate_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let random = ["robot", "genome", "random", "--modules", "3", "--seed", "1"];
    let out = realgap().args(random).assert().success();
    realgap()
        .args(random)
        .arg("-o")
        .arg(path("g.ron"))
        .assert()
        .success();
    let written = std::fs::read_to_string(path("g.ron")).unwrap();
    let (head, genome) = written.split_once('\n').unwrap();
    assert!(head.starts_with("// Written by realgap"), "{head}");
    assert_eq!(
        text(&out.get_output().stdout),
        genome,
        "same seed, same genome"
    );

    realgap()
        .args(["robot", "develop"])
        .arg(path("g.ron"))
        .arg("-o")
        .arg(path("robot.ron"))
        .arg("--plot")
        .arg(path("robot.png"))
        .assert()
        .success();
    assert!(std::fs::metadata(path("robot.png")).unwrap().len() > 5000);
    let out = realgap()
        .arg("check")
        .args([path("g.ron"), path("robot.ron")])
        .assert()
        .success();
    let report = text(&out.get_output().stdout);
    assert!(
        report.contains("genome \"random_3_1\": 3 modules"),
        "{report}"
    );
    assert!(
        report.contains("morphology \"random_3_1\": 3 modules"),
        "{report}"
    );
    realgap()
        .arg("simulate")
        .arg(path("robot.ron"))
        .args(["--duration", "1"])
        .assert()
        .success();

    let out = realgap()
        .args(["robot", "develop"])
        .arg(path("g.ron"))
        .args(["--format", "json"])
        .assert()
        .success();
    let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(
        (&report["develops"], &report["modules"]),
        (&true.into(), &3.into())
    );
    assert!(report["genes"][0]["phase"].is_f64() && report["at_rest"].is_boolean());
}

#[test]
fn a_genome_that_does_not_develop_says_why_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("clash.ron");
    let genes = "[[1, 0, 0, 0.7, 0, 0, 1, 1, 0, 0], [1, 0, 0, 0.9, 0, 0, 1, 1, 0, 0]]";
    std::fs::write(&path, format!("Genome(modules: 2, genes: {genes})")).unwrap();
    let out = realgap()
        .args(["robot", "develop"])
        .arg(&path)
        .args(["--format", "json"])
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert!(
        error.contains("clash.ron") && error.contains("driven face of module 0"),
        "{error}"
    );
    let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(report["reason"], "servo-on-servo");
    let out = realgap().arg("check").arg(&path).assert().success();
    assert!(text(&out.get_output().stdout).contains("does not develop"));
}

#[test]
fn check_draws_a_robot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tripod.svg");
    realgap()
        .args(["check", "morphologies/tripod.ron", "--plot"])
        .arg(&path)
        .assert()
        .success();
    let svg = std::fs::read_to_string(path).unwrap();
    assert!(svg.contains("4 modules, 3 servos"), "the title is missing");
}

#[test]
fn wrong_use_exits_with_2() {
    for arguments in [
        &["robot", "genome", "random", "--modules", "0"][..],
        &["robot", "genome", "random", "--modules", "201"],
        &["robot", "genome", "conquer"],
        &[
            "check",
            "morphologies/cube.ron",
            "morphologies/tripod.ron",
            "--plot",
            "x.png",
        ],
    ] {
        realgap().args(arguments).assert().code(2);
    }
    realgap()
        .args(["robot", "develop", "x.ron", "--plot", "x.pdf"])
        .assert()
        .failure();
}
