//! Robots on the ground of the shipped arenas, on the command line.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::{realgap, text};

/// What a command prints and says beside it.
fn said(words: &[&str]) -> (String, String) {
    let out = realgap().args(words).output().unwrap();
    let said = text(&out.stderr).to_owned();
    assert!(out.status.success(), "{words:?}: {said}");
    (text(&out.stdout).to_owned(), said)
}

fn json(words: &[&str]) -> serde_json::Value {
    serde_json::from_str(&said(&[words, &["--format", "json"]].concat()).0).unwrap()
}

#[test]
fn the_tripod_climbs_the_shipped_step_by_its_height_and_a_picture_shows_it() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("step.html");
    let walk = [
        "simulate",
        "morphologies/tripod.ron",
        "--arena",
        "arenas/step.ron",
    ];
    let climbed = |more: &[&str]| {
        let all = [&walk[..], &["--duration", "10"], more].concat();
        json(&all)["net_displacement_world_m"][2].as_f64().unwrap()
    };
    let [usual, twice] = [
        climbed(&["--replay", page.to_str().unwrap()]),
        climbed(&["--set", "floor.plate.height_m=0.01"]),
    ];
    assert!((twice - usual - 0.005).abs() < 1e-3, "{usual} {twice}");
    assert!(
        std::fs::read_to_string(page)
            .unwrap()
            .contains("scene-data")
    );
    let (_, warned) = said(
        &[
            &walk[..],
            &["--duration", "1", "--set", "floor.rug.friction=1"],
        ]
        .concat(),
    );
    assert!(
        warned.contains("only the regions felt and the steps plate"),
        "{warned}"
    );
}

#[test]
fn arenas_with_a_ground_are_checked_predicted_and_exported() {
    let (checked, _) = said(&["check", "arenas/bumps.ron", "arenas/step.ron"]);
    for part in [
        "21 x 21 heights over 2 x 2 m",
        "floor.felt.friction",
        "floor.plate.height_m",
    ] {
        assert!(checked.contains(part), "{part}: {checked}");
    }
    let predicted = |more: &[&str]| {
        let usual = [
            "predict",
            "morphologies/two_module.ron",
            "--duration",
            "2",
            "--repeats",
            "3",
            "--model-error",
            "off",
        ];
        let card = json(&[&usual[..], more].concat());
        card["prediction"]["displacement_m"]["mean"]
            .as_f64()
            .unwrap()
    };
    let (flat, rough) = (predicted(&[]), predicted(&["--arena", "arenas/bumps.ron"]));
    assert!((flat - rough).abs() > 1e-4, "{flat} {rough}");
    let export = |arena: &str| {
        let robot = ["robot", "export", "morphologies/tripod.ron"];
        said(&[&robot[..], &["--format", "mjcf", "--arena", arena]].concat())
    };
    let (step, lost) = export("arenas/step.ron");
    assert!(
        step.contains("step.plate") && lost.contains("(felt)"),
        "{lost}"
    );
    let (bumps, _) = export("arenas/bumps.ron");
    assert!(bumps.contains("<hfield") && bumps.contains("nrow=\"21\""));
}
