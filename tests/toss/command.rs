//! The commands: identify writes what evaluate reads; parts of the recordings keep fitting and checking apart.

use assert_cmd::Command;
use nalgebra::Vector3;
use serde_json::Value;

use super::standin::{Tracker, cube, study, tosses, write};

fn realgap(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("realgap")
        .unwrap()
        .args(arguments)
        .assert()
}

fn json(arguments: &[&str]) -> Value {
    let output = realgap(arguments).success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

#[test]
fn identify_feeds_evaluate() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = cube();
    robot.adjustment.centre_of_mass_offset_m = Vector3::new(0.0, 0.0, 0.008);
    robot.floor.friction = 0.2;
    robot.floor.restitution = 0.2;
    let tracker = Tracker {
        length_scale: 0.95,
        noise_m: 2e-5,
        noise_rad: 5e-4,
    };
    let glob = write(folder.path(), &tosses(&robot, &tracker, 24));
    let study = study().to_string_lossy().into_owned();
    let body = folder
        .path()
        .join("body.ron")
        .to_string_lossy()
        .into_owned();
    let found = json(&[
        "identify",
        &study,
        "--recordings",
        &glob,
        "--every",
        "2",
        "-o",
        &body,
        "--format",
        "json",
    ]);
    assert_eq!(found["recordings"], 12);
    realgap(&["check", &body]).success();

    let contact = [
        "--set",
        "floor.friction=0.2",
        "--set",
        "floor.restitution=0.2",
    ];
    let evaluate = |extra: &[&str]| {
        let base = [
            "evaluate",
            &study,
            "--recordings",
            &glob,
            "--every",
            "2",
            "--offset",
            "1",
            "--format",
            "json",
        ];
        json(&[&base, &contact[..], extra].concat())
    };
    let ignorant = evaluate(&[]);
    let informed = evaluate(&["--parameters", &body]);
    let flown = evaluate(&["--parameters", &body, "--start", "flight", "--rows"]);
    let mean = |value: &Value| value["position_percent"]["mean"].as_f64().unwrap();
    assert!(
        mean(&informed) < 0.6 * mean(&ignorant),
        "{} {}",
        mean(&informed),
        mean(&ignorant)
    );
    assert!(
        mean(&flown) < mean(&informed),
        "{} {}",
        mean(&flown),
        mean(&informed)
    );
    assert_eq!(flown["recordings"], 12);
    assert_eq!(flown["rows"].as_array().unwrap().len(), 12);
    assert_eq!(flown["rows"][0]["recording"], "toss_01");
    for key in [
        "position_percent",
        "rotation_deg",
        "final_position_percent",
        "final_rotation_deg",
    ] {
        for statistic in ["mean", "median", "standard_error"] {
            assert!(flown[key][statistic].is_f64(), "{key}.{statistic}");
        }
    }
    assert!(flown["over_45_deg"].is_u64() && informed.get("rows").is_none());
    // A start that has seen the flight is labelled, wherever the numbers go.
    assert!(flown["start"].as_str().unwrap().contains("flight"));
    assert!(flown["warnings"].to_string().contains("refined-start"));
    assert!(!informed["warnings"].to_string().contains("refined-start"));
}

#[test]
fn the_answer_does_not_depend_on_the_threads() {
    let folder = tempfile::tempdir().unwrap();
    let tracker = Tracker {
        length_scale: 1.0,
        noise_m: 1e-4,
        noise_rad: 1e-3,
    };
    let glob = write(folder.path(), &tosses(&cube(), &tracker, 8));
    let study = study().to_string_lossy().into_owned();
    let with = |jobs: &str| {
        let mut value = json(&[
            "evaluate",
            &study,
            "--recordings",
            &glob,
            "--jobs",
            jobs,
            "--format",
            "json",
        ]);
        value.as_object_mut().unwrap().remove("cpu_ms_per_s");
        value
    };
    assert_eq!(with("1"), with("3"));
}

#[test]
fn an_impossible_part_is_wrong_usage() {
    let study = study().to_string_lossy().into_owned();
    let error = realgap(&[
        "evaluate",
        &study,
        "--recordings",
        "*.csv",
        "--every",
        "2",
        "--offset",
        "2",
    ])
    .code(2)
    .get_output()
    .stderr
    .clone();
    assert!(String::from_utf8_lossy(&error).contains("offsets from 0"));
}
