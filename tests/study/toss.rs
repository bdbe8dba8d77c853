//! The commands: identify writes what evaluate reads; parts of the recordings keep fitting and checking apart.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use assert_cmd::Command;
use nalgebra::Vector3;
use serde_json::Value;

use crate::common::{self, schema::answer};
use crate::standin::{EXACT, Tracker, cube, study, tosses, write};

fn realgap(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("realgap")
        .unwrap()
        .args(arguments)
        .assert()
}

/// The JSON output of the command, validated by its schema.
fn json(arguments: &[&str]) -> Value {
    let output = realgap(arguments).success().get_output().stdout.clone();
    let said = common::text(&output);
    match arguments[..2] {
        ["study", "identify"] => answer("identify", &said),
        _ => answer("evaluate", &said),
    }
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
        "study",
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
    simulated_odds_are_given_with_the_real_ones(&found);

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
    let page = folder.path().join("page.html");
    let ignorant = evaluate(&["--report", page.to_str().unwrap()]);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("<p class=\"kicker\">evaluation</p>") && page.contains("face down"));
    let informed = evaluate(&["--parameters", &body]);
    let flown = evaluate(&["--parameters", &body, "--start", "flight", "--rows"]);
    let mean = |value: &Value| value["position_percent"]["mean"].as_f64().unwrap();
    assert!(
        mean(&informed) < mean(&ignorant),
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
    // A start that was fitted to the flight is labelled in every output.
    assert!(flown["start"].as_str().unwrap().contains("flight"));
    assert!(flown["warnings"].to_string().contains("refined-start"));
    assert!(!informed["warnings"].to_string().contains("refined-start"));
}

fn simulated_odds_are_given_with_the_real_ones(found: &Value) {
    let odds = &found["resting_odds"];
    let counts = |face: &Value, key: &str| face[key].as_u64().unwrap();
    let faces = odds["faces"].as_array().unwrap();
    let sum = |key: &str| faces.iter().map(|face| counts(face, key)).sum::<u64>();
    let at_rest = found["rest"]["at_rest"].as_u64().unwrap();
    assert!(at_rest > 0 && odds["simulations"] == at_rest);
    // The same real counts, whichever way they were made.
    for (face, real) in faces.iter().zip(found["rest"]["faces"].as_array().unwrap()) {
        assert_eq!(
            (&face["face"], &face["real"]),
            (&real["face"], &real["down"])
        );
    }
    assert_eq!(sum("real"), at_rest);
    assert_eq!(
        sum("simulated") + odds["diverged"].as_u64().unwrap(),
        at_rest
    );
    assert_eq!(sum("both"), odds["same_face"].as_u64().unwrap());
    // The answer lists the simulated values: identified ones, fixed ones, and defaults of free parameters.
    assert_eq!(
        odds["values"]["recording.length_scale"],
        found["parameters"]["recording.length_scale"]
    );
    assert!(
        odds["identified"]
            .to_string()
            .contains("body.com_offset_z_m")
    );
    assert_eq!(odds["values"]["contact.prediction_m"], 0.001);
    assert!(odds["at_default"].to_string().contains("floor.friction"));
    assert!(odds["warnings"].to_string().contains("free-parameter"));
}

#[test]
fn with_the_true_contact_most_recordings_end_on_their_simulated_face() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = cube();
    robot.adjustment.centre_of_mass_offset_m = Vector3::new(0.0, 0.0, 0.008);
    robot.floor.friction = 0.2;
    robot.floor.restitution = 0.2;
    let glob = write(folder.path(), &tosses(&robot, &EXACT, 40));
    let study = study().to_string_lossy().into_owned();
    // Solver and contact as the stand-in has them; friction and restitution as its truth.
    let settings = [
        "floor.friction=0.2".to_owned(),
        "floor.restitution=0.2".to_owned(),
        "body.edge_radius_m=0".to_owned(),
        format!("contact.prediction_m={}", robot.contact.prediction_m),
        format!(
            "contact.natural_frequency_hz={}",
            robot.contact.natural_frequency_hz
        ),
        format!("contact.damping_ratio={}", robot.contact.damping_ratio),
        format!("solver.substeps={}", robot.solver.substeps),
        format!("solver.sweeps={}", robot.solver.sweeps),
        format!("solver.relaxations={}", robot.solver.relaxations),
    ];
    let identify = |extra: &[&str]| {
        let mut arguments = vec!["study", "identify", &study, "--recordings", &glob];
        arguments.extend(["--format", "json"]);
        for setting in &settings {
            arguments.extend(["--set", setting]);
        }
        json(&[&arguments, extra].concat())
    };
    let odds = &identify(&[])["resting_odds"];
    let share =
        |odds: &Value| odds["same_face"].as_f64().unwrap() / odds["simulations"].as_f64().unwrap();
    assert!(odds["simulations"].as_u64().unwrap() >= 10, "{odds}");
    assert!(share(odds) >= 0.75, "{odds}");
    // With other contact values, the runs differ: the listed values are those that are simulated.
    let bouncy = &identify(&[
        "--set",
        "floor.friction=0.9",
        "--set",
        "floor.restitution=0.7",
    ])["resting_odds"];
    assert!(bouncy["faces"] != odds["faces"]);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder
        .path()
        .join("no/such/body.ron")
        .to_string_lossy()
        .into_owned();
    let study = study().to_string_lossy().into_owned();
    // The recordings do not exist either: the output is what is looked at first.
    let error = realgap(&[
        "study",
        "identify",
        &study,
        "--recordings",
        "no_such_*.csv",
        "-o",
        &missing,
    ])
    .code(1)
    .get_output()
    .stderr
    .clone();
    let error = String::from_utf8_lossy(&error);
    assert!(
        error.contains("body.ron") && error.contains("cannot write the file"),
        "{error}"
    );
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

/// A toss is shown from where it was thrown, over its recording; values take the place of the best.
#[test]
fn a_toss_is_replayed_from_its_recorded_start() {
    let folder = tempfile::tempdir().unwrap();
    let glob = write(folder.path(), &tosses(&cube(), &EXACT, 3));
    let study = study().to_string_lossy().into_owned();
    let page = folder.path().join("toss.html");
    let file = page.to_str().unwrap();
    let show = |more: &[&str]| {
        let args = ["replay", &study, "--against", &glob, "-o", file];
        realgap(&[&args, more].concat())
    };
    show(&["--start", "toss_01", "--set", "floor.friction=0.3"]).success();
    let shown = std::fs::read_to_string(&page).unwrap();
    assert!(
        shown.contains("toss_01") && !shown.contains("toss_02"),
        "the recording of another"
    );
    let said = show(&["--start", "tos_01"])
        .code(2)
        .get_output()
        .stderr
        .clone();
    let said = common::text(&said);
    assert!(said.contains("did you mean `toss_01`"), "{said}");
}
