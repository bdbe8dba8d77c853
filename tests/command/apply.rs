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

/// The same as a robot of bodies and as one of modules, as people write them.
const OF_BODIES: &str = r#"// A pendulum with a servo that gives way.
(
    name: "pendulum", description: r"of the drawing, 2024 // not of the build",
    bodies: [
        (name: "stand", mass_kg: 1, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
        (name: "bob", mass_kg: 0.5, centre_of_mass_m: (0, 0, -0.3), inertia_kg_m2: (xx: 1e-3, yy: 1e-3, zz: 1e-3)),
    ],
    joints: [
        (name: "pivot", parent: "stand", child: "bob", kind: Turn(axis: (0, 1, 0))), /* damping: not known */
    ],
    actuators: [(joint: "pivot", servo: (law: Torque(stiffness_nm_rad: 4e-1, damping_nm_s_rad: 0), max_torque_nm: 5))],
    never_touch: [("stand", "bob")],
    mount: (at_m: (0, 0, 1)),
)
"#;
const OF_MODULES: &str = r#"(name: "pendulum", mount_m: (0, 0, 1),
  modules: [
    (name: "stand", kind: Passive(sides_m: (0.04, 0.03, 0.04), mass_kg: 0.1)),
    (name: "bob", kind: Passive(side_m: 0.04, mass_kg: 0.5)), // weighed
  ],
  hinges: [
    (name: "pivot", parent: "stand", child: "bob", anchor_m: (0, 0.04, 0), child_anchor_m: (0, 0, 0.3), axis: (0, 1, 0),
      servo: (
        // of the data sheet
        max_torque_nm: 5,
        law: Torque(stiffness_nm_rad: 0.4, damping_nm_s_rad: 0)
      )
    )
  ])
"#;

/// Runs the program, which must succeed; returns what it printed and what it noted.
fn command(words: &[&str]) -> (String, String) {
    let output = realgap().args(words).output().unwrap();
    assert!(
        output.status.success(),
        "{words:?}: {}",
        text(&output.stderr)
    );
    (text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_robot_in_ron_gets_what_was_fitted_and_moves_as_the_fit_did() {
    for (robot, stated, fixed, count) in [
        (OF_BODIES, "stiffness_nm_rad: 4e-1", "", "2 of 3"),
        (
            OF_MODULES,
            "stiffness_nm_rad: 0.4",
            ", \"floor.friction\": 0.7",
            "2 of 4",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let here = |name: &str| folder.path().join(name);
        std::fs::write(here("pendulum.ron"), robot).unwrap();
        let parsed = Morphology::parse(&Source::new("pendulum.ron", robot)).unwrap();
        let truth = [
            ("hinge.pivot.viscous_nm_s_rad", 0.013),
            ("servo.pivot.stiffness_nm_rad", 0.55),
        ];
        record_of(&parsed, &truth, folder.path());
        let study = |robot: &str, more: &str| {
            format!(
                r#"(morphology: "{robot}", recordings: ["run_*.csv"], start: FromRecording, metric: "joints",
                    set: {{"recording.length_scale": 1.02{more}}},
                    parameters: [(name: "hinge.pivot.viscous_nm_s_rad", from: 0.001, to: 0.04),
                        (name: "servo.pivot.stiffness_nm_rad", from: 0.1, to: 1)])"#
            )
        };
        std::fs::write(here("study.ron"), study("pendulum.ron", fixed)).unwrap();
        let at = |name: &str| here(name).display().to_string();
        let tune = [
            "--optimizer",
            "gauss-newton",
            "--budget",
            "25",
            "--no-report",
        ];
        command(&[&["tune", &at("study.ron"), "-o", &at("out")][..], &tune].concat());
        let (said, noted) = command(&[
            "apply",
            &at("out"),
            &at("pendulum.ron"),
            "-o",
            &at("calibrated.ron"),
        ]);
        assert!(
            said.contains(&format!("{count} fitted values in 2 numbers")),
            "{said}"
        );
        // What the file cannot say is listed with the place where it belongs.
        let scale = "not in the file: recording.length_scale=1.02: it describes the recordings";
        assert!(
            noted.contains(scale) && noted.contains("under `set`"),
            "{noted}"
        );
        assert_eq!(
            noted.contains("not in the file: floor.friction"),
            !fixed.is_empty(),
            "{noted}"
        );
        // Nothing but the numbers and their comments is new.
        let calibrated = std::fs::read_to_string(here("calibrated.ron")).unwrap();
        let is_comment = |line: &&str| line.trim_start().starts_with("// realgap: ");
        let comments: Vec<&str> = calibrated.lines().filter(is_comment).collect();
        for name in [
            "hinge.pivot.viscous_nm_s_rad = 0.01",
            "servo.pivot.stiffness_nm_rad = 0.5",
        ] {
            let of_it = comments.iter().find(|line| line.contains(name));
            let of_it = of_it.unwrap_or_else(|| panic!("{name}: {calibrated}"));
            assert!(
                of_it.contains("90 % interval 0.") && of_it.ends_with("study study"),
                "{of_it}"
            );
        }
        let number = |key: &str| {
            let at = calibrated
                .find(key)
                .unwrap_or_else(|| panic!("{key}: {calibrated}"));
            let rest = &calibrated[at..];
            let end = rest.find([',', ')']).unwrap();
            (
                rest[..end].to_owned(),
                rest[key.len()..end].parse::<f64>().unwrap(),
            )
        };
        let ((viscous, _), (stiffness, value)) =
            (number("viscous_nm_s_rad: "), number("stiffness_nm_rad: "));
        assert!((value - 0.55).abs() < 0.01, "{value}");
        let plain: Vec<&str> = calibrated
            .lines()
            .filter(|line| !is_comment(line))
            .collect();
        let back = plain.join("\n").replace(&stiffness, stated) + "\n";
        let back = back
            .replace(&format!(", {viscous}"), "")
            .replace(&format!(",\n      {viscous},"), "");
        assert_eq!(back, robot);
        // The written file is the robot of the fit.
        std::fs::write(here("again.ron"), study("calibrated.ron", "")).unwrap();
        let error = |words: &[&str]| {
            let (json, _) = command(&[&["evaluate"], words, &["--format", "json"]].concat());
            let json = answer("evaluate-joints", &json);
            json["angle_mrad"]["mean"]
                .as_f64()
                .unwrap_or_else(|| panic!("{json}"))
        };
        let fitted = error(&[&at("study.ron"), "--parameters", &at("out/best.ron")]);
        let written = error(&[&at("again.ron")]);
        assert!(
            (written / fitted - 1.0).abs() < 0.01,
            "{written} against {fitted}"
        );
    }
}

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
    record_of(&robot, &[("hinge.pivot.viscous_nm_s_rad", 0.013)], folder);
}

/// Two recordings of a robot with these hidden values.
fn record_of(robot: &Morphology, truth: &[(&str, f64)], folder: &Path) {
    let truth = truth
        .iter()
        .map(|(name, value)| Assignment::new(name, *value).unwrap());
    let truth: ParameterSet = truth.collect();
    let mut experiment = truth.apply(&Experiment::new(robot.assemble()));
    experiment.duration_s = 2.0;
    experiment.sampling = Sampling::Rate(50.0);
    for (index, angle_rad) in [0.5, -0.8].into_iter().enumerate() {
        experiment.start_joints = vec![JointState {
            angle_rad,
            speed_rad_s: 0.0,
        }];
        let motion = run(&experiment).unwrap().outcome.into_result().unwrap();
        let mut table = "t_s,pivot_rad,pivot_rad_s\n".to_owned();
        let pivot = motion.joint("pivot").unwrap();
        let (angles, speeds) = (&pivot.angles_rad, pivot.speeds_rad_s.as_ref().unwrap());
        for (k, (t, angle)) in motion.times_s().iter().zip(angles).enumerate() {
            let noise = 1e-3 * (12.9898 * k as f64).sin();
            let _ = writeln!(table, "{t},{},{}", angle + noise, speeds[k]);
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
    command(&["sweep", &at("study.ron"), "-o", &at("out"), "--no-report"]);
    let (model, written) = (at("pendulum.xml"), at("calibrated.xml"));
    let (ranges, table, card) = (at("draws.json"), at("draws.csv"), at("card.md"));
    let (said, _) = command(&[
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
    command(&["apply", &at("out"), "--ranges", &table]);
    // The same as JSON, whose numbers are those of the file.
    let again = at("again.xml");
    let (json, _) = command(&[
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
