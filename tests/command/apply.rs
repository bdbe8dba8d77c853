//! `realgap apply`: the answer of a study in the user's own file, as draws, and on a card.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fmt::Write as _;
use std::path::Path;

use realgap::file::Source;
use realgap::robot::import::Options;
use realgap::robot::morphology::Morphology;
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::simulation::{Experiment, JointState, Sampling, run};

use crate::common::{realgap, schema::answer, text};

const PENDULUM: &str = r#"<mujoco model="pendulum">
  <!-- of the drawing, 2024 -->
  <compiler angle="degree"/>
  <worldbody>
    <body name="stand" pos="0 0 1">
      <geom type="box" size=".05 .05 .05"/>
      <body name="bob">
        <joint name="pivot" axis="0 1 0" range="-170 170"/>  <!-- damping: not known -->
        <inertial pos="0 0 -.3" mass="0.5" diaginertia="1e-3 1e-3 1e-3"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

/// Two recordings of the pendulum with a known damping.
fn record(folder: &Path) {
    let source = Source::new("pendulum.xml", PENDULUM);
    let options = Options {
        mounted: true,
        ..Options::default()
    };
    let robot = Morphology::import(&source, &options).unwrap().0;
    std::fs::write(folder.join("pendulum.ron"), robot.to_ron().unwrap()).unwrap();
    std::fs::write(folder.join("pendulum.xml"), PENDULUM).unwrap();
    let truth: ParameterSet = [Assignment::new("hinge.pivot.viscous_nm_s_rad", 0.013).unwrap()]
        .into_iter()
        .collect();
    let mut experiment = truth.apply(&Experiment::new(robot.assemble()));
    experiment.duration_s = 2.0;
    experiment.sampling = Sampling::Rate(50.0);
    for (index, angle_rad) in [0.5, -0.8].into_iter().enumerate() {
        experiment.start_joints = vec![JointState {
            angle_rad,
            speed_rad_s: 0.0,
        }];
        let motion = run(&experiment).unwrap().outcome.into_result().unwrap();
        let mut table = "t_s,pivot_rad\n".to_owned();
        let angles = &motion.joint("pivot").unwrap().angles_rad;
        for (k, (t, angle)) in motion.times_s().iter().zip(angles).enumerate() {
            let noise = 1e-3 * (12.9898 * k as f64).sin();
            let _ = writeln!(table, "{t},{}", angle + noise);
        }
        std::fs::write(folder.join(format!("run_{index}.csv")), table).unwrap();
    }
}

#[test]
fn a_fit_ends_in_the_user_s_file_and_a_diff_shows_only_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| folder.path().join(name);
    record(folder.path());
    std::fs::write(
        here("study.ron"),
        r#"(morphology: "pendulum.ron", recordings: ["run_*.csv"], start: FromRecording, metric: "joints",
            parameters: [(name: "hinge.pivot.viscous_nm_s_rad", from: 0.001, to: 0.04, points: 14)])"#,
    )
    .unwrap();
    let at = |name: &str| here(name).display().to_string();
    let run = |words: &[&str]| {
        let output = realgap().args(words).output().unwrap();
        assert!(
            output.status.success(),
            "{words:?}: {}",
            text(&output.stderr)
        );
        (text(&output.stdout), text(&output.stderr))
    };
    run(&["sweep", &at("study.ron"), "-o", &at("out"), "--no-report"]);
    let (model, written) = (at("pendulum.xml"), at("calibrated.xml"));
    let (ranges, table, card) = (at("draws.json"), at("draws.csv"), at("card.md"));
    let (said, _) = run(&[
        "apply",
        &at("out"),
        &model,
        "-o",
        &written,
        "--ranges",
        &ranges,
        "--card",
        &card,
    ]);
    run(&["apply", &at("out"), "--ranges", &table]);
    // The same as JSON, whose numbers are those of the file.
    let again = at("again.xml");
    let (json, _) = run(&[
        "apply",
        &at("out"),
        &model,
        "-o",
        &again,
        "--format",
        "json",
    ]);
    let json = answer("apply", &json);
    let value = &json["values"][0];
    assert_eq!(value["parameter"], "hinge.pivot.viscous_nm_s_rad");
    let number = &value["numbers"][0];
    assert_eq!(
        (&number["line"], &number["attribute"]),
        (&8.into(), &"damping".into())
    );
    assert!(
        number["before"].is_null() && value["unsaid"].is_null(),
        "{json}"
    );
    let now = number["now"].as_str().unwrap();
    let same = std::fs::read_to_string(&again).unwrap();
    assert!(same.contains(&format!("damping=\"{now}\"")), "{json}");
    assert!(
        json["largest_difference"].as_f64().unwrap() < 1e-6,
        "{json}"
    );
    assert!(
        said.contains("joint pivot") && said.contains("damping"),
        "{said}"
    );
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let calibrated = read(&written);
    let known: Vec<&str> = PENDULUM.lines().collect();
    let new: Vec<&str> = calibrated
        .lines()
        .filter(|line| !known.contains(line))
        .collect();
    assert_eq!(new.len(), 2, "{new:?}");
    assert!(
        new[0].contains("<!-- realgap: hinge.pivot.viscous_nm_s_rad = 0.013"),
        "{new:?}"
    );
    assert!(
        new[0].contains("90 % interval 0.0") && new[0].ends_with("study study -->"),
        "{new:?}"
    );
    let own = "        <joint name=\"pivot\" axis=\"0 1 0\" range=\"-170 170\" damping=\"0.013";
    assert!(new[1].starts_with(own), "{new:?}");
    let draws: serde_json::Value = serde_json::from_str(&read(&ranges)).unwrap();
    let rows = draws["draws"].as_array().unwrap();
    assert!(rows.len() > 50 && rows[0].as_array().unwrap().len() == 1);
    let range = &draws["parameters"][0];
    let (low, high) = (
        range["q05"].as_f64().unwrap(),
        range["q95"].as_f64().unwrap(),
    );
    assert!(low <= 0.013 && 0.013 <= high, "{range}");
    assert_eq!(read(&table).lines().count(), rows.len() + 1);
    let card = read(&card);
    for part in [
        "# Fitted parameters: study",
        "| `hinge.pivot.viscous_nm_s_rad` | 0.013",
        "recording 0",
        "not measured",
    ] {
        assert!(card.contains(part), "{part}: {card}");
    }
}

#[test]
fn apply_says_what_it_needs_and_never_replaces_the_user_s_file() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("pendulum.xml");
    std::fs::write(&model, PENDULUM).unwrap();
    let at = model.display().to_string();
    let out = folder.path().display().to_string();
    for (words, part) in [
        (vec!["apply", &out], "nothing to write"),
        (vec!["apply", &out, &at, "-o", &at], "exists already"),
        (vec!["apply", &out, &at], "no fitted parameters"),
        (
            vec!["apply", &out, &at, "--format", "json"],
            "add -o calibrated.xml",
        ),
        (
            vec!["apply", &out, "--ranges", "draws.txt"],
            ".json or .csv",
        ),
    ] {
        let output = realgap().args(&words).output().unwrap();
        assert!(!output.status.success());
        assert!(
            text(&output.stderr).contains(part),
            "{words:?}: {}",
            text(&output.stderr)
        );
    }
}
