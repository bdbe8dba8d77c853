//! `realgap start --engine mujoco`: from a model that MuJoCo loads to a study of its own fields, without a line of Python.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{project, python_with, realgap, text};

const ARM: &str = r#"<mujoco>
  <option timestep="0.002"/>
  <default><joint axis="0 1 0" damping="0.02" armature="0.001"/></default>
  <worldbody>
    <body name="upper">
      <joint name="left_hip"/><geom name="rod" type="capsule" size=".01" fromto="0 0 0 0 0 -.3" mass=".2"/>
      <body name="lower" pos="0 0 -.3">
        <joint name="left_knee"/><geom type="capsule" size=".01" fromto="0 0 0 0 0 -.2" mass=".1"/>
      </body>
    </body>
    <body name="other" pos="0 1 0">
      <joint name="right_hip"/><geom type="capsule" size=".01" fromto="0 0 0 0 0 -.3" mass=".2"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="hip_motor" joint="left_hip" forcerange="-.3 .3"/><position name="knee_servo" joint="left_knee" kp="2"/><motor joint="right_hip" forcerange="-.3 .3"/>
  </actuator>
  <keyframe><key name="raised" qpos="0.5 0 0.5"/></keyframe>
</mujoco>"#;

/// Records the arm with other damping, by bare MuJoCo: 1 s, 100 samples a second.
const RECORD: &str = r#"
import sys, math, mujoco
model = mujoco.MjModel.from_xml_path(sys.argv[1]); data = mujoco.MjData(model)
model.dof_damping[[0, 2]] = 0.05
data.qpos[:] = [0.4, -0.2, 0.3]
names = ["left_hip", "left_knee", "right_hip"]
rows = ["t_s," + ",".join(n + "_rad" for n in names) + "," + ",".join(n + "_command_rad" for n in names)]
for k in range(501):
    want = [0.4 * math.sin(0.06 * (k // 5)), 0.3, 0.2 * math.cos(0.08 * (k // 5))]
    if k % 5 == 0:
        rows.append(",".join(f"{v:.9g}" for v in [k * 0.002, *data.qpos, *want]))
    for act, joint in ((0, 0), (2, 2)):
        data.ctrl[act] = 3.0 * (want[joint] - data.qpos[joint]) - 0.1 * data.qvel[joint]
    data.ctrl[1] = want[1]
    mujoco.mj_step(model, data)
open(sys.argv[2], "w").write("\n".join(rows) + "\n")
"#;

/// The Python files of the package that simulators need, in a folder of their own: the tests of the program do not build the package.
pub(crate) fn package(folder: &Path) -> PathBuf {
    let own = folder.join("packages/realgap");
    std::fs::create_dir_all(&own).unwrap();
    std::fs::write(
        own.join("__init__.py"),
        "from ._simulator import Question, serve\n",
    )
    .unwrap();
    for name in ["mujoco.py", "_simulator.py"] {
        let from = project().join("python/realgap").join(name);
        std::fs::copy(from, own.join(name)).unwrap();
    }
    folder.join("packages")
}

/// Runs the program in a folder with that package: whether it succeeded, and what it said.
pub(crate) fn run(folder: &Path, words: &[&str]) -> (bool, String) {
    let said = realgap()
        .current_dir(folder)
        .env("PYTHONPATH", folder.join("packages"))
        .args(words)
        .write_stdin("")
        .output()
        .unwrap();
    (
        said.status.success(),
        text(&said.stdout) + &text(&said.stderr),
    )
}

#[test]
fn a_model_of_mujoco_and_a_log_become_a_study_that_finds_a_changed_damping() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    package(here);
    std::fs::write(here.join("arm.xml"), ARM).unwrap();
    let recorded = Command::new(&python)
        .args(["-c", RECORD, "arm.xml", "run.csv"])
        .current_dir(here)
        .status();
    assert!(recorded.unwrap().success());
    let start = [
        "start", "run.csv", "arm.xml", "--engine", "mujoco", "--python", &python,
    ];
    // Motors that get angles need gains, and one pair for all.
    let (done, said) = run(here, &start);
    assert!(
        !done && said.contains("2 motors without gains") && said.contains("--pd KP,KD"),
        "{said}"
    );
    let single = [&start[..], &["--pd", "*_hip=3,0.1"]].concat();
    let (done, said) = run(here, &single);
    assert!(!done && said.contains("one pair of gains"), "{said}");
    let (done, said) = run(here, &[&start[..], &["--pd", "3,0.1"]].concat());
    assert!(done, "{said}");
    assert!(
        said.contains("which is valid; next: realgap tune study.ron"),
        "{said}"
    );
    let study = std::fs::read_to_string(here.join("study.ron")).unwrap();
    for words in [
        "pd: (3.0, 0.1)",
        "keyframe: \"raised\"",
        "start: FromRecording",
        "metric: \"joints\"",
        // Both hips have one damping in the model and share it; the knee has a value of its own.
        "(name: \"joint.*_hip.damping\", from: 0.0,",
        "(name: \"joint.left_knee.damping\"",
        "(name: \"actuator.knee_servo.kp\", from: 0.2, to: 8.0,",
        "(name: \"joint.left_knee.zero\", from: -0.1, to: 0.1,",
        "(name: \"pd.kp\", from: 1.5, to: 6.0,",
        "(name: \"command.delay\", from: 0.0, to: 0.1,",
    ] {
        assert!(study.contains(words), "{words}: {study}");
    }
    assert!(!study.contains("hold: true"), "{study}");
    // Ranges hold what a joint carries, and half of the torque that its drive exerts.
    let described = Command::new(&python)
        .args(["-m", "realgap.mujoco", "arm.xml", "--describe"])
        .env("PYTHONPATH", here.join("packages"))
        .current_dir(here)
        .output();
    let described = text(&described.unwrap().stdout);
    let described: serde_json::Value = serde_json::from_str(&described).unwrap();
    let carried = |joint: usize| {
        described["joints"][joint]["inertia_kg_m2"]
            .as_f64()
            .unwrap()
    };
    let of_rod = |mass_kg: f64, length_m: f64| mass_kg * length_m * length_m / 3.0;
    // Capsules of 2 cm are a little more than rods.
    assert!(
        (carried(2) / of_rod(0.2, 0.3) - 1.0).abs() < 0.05,
        "{described}"
    );
    assert!(
        (carried(1) / of_rod(0.1, 0.2) - 1.0).abs() < 0.05,
        "{described}"
    );
    assert!(carried(0) > 3.0 * carried(2), "{described}");
    assert_eq!(
        described["joints"][1]["gains"],
        serde_json::json!([2.0, 0.0])
    );
    let most = |name: &str| -> f64 {
        let line = study
            .lines()
            .find(|line| line.contains(&format!("\"{name}\"")))
            .unwrap();
        let to = line.split("to: ").nth(1).unwrap().split(',').next();
        to.unwrap().parse().unwrap()
    };
    let armature = most("joint.*_hip.armature");
    assert!(
        (armature / carried(0) - 1.0).abs() < 0.01,
        "{armature}: {described}"
    );
    // By the limit of the motor alone, 0.3 N m, it would be 0.045 N m.
    let dry_nm = most("joint.*_hip.frictionloss");
    assert!((0.1..0.15).contains(&dry_nm), "{dry_nm}");
    let tune = [
        "tune",
        "study.ron",
        "--optimizer",
        "gauss-newton",
        "--budget",
        "90",
        "--allow-command",
        "--no-report",
        "-o",
        "out",
    ];
    let (done, said) = run(here, &tune);
    assert!(done, "{said}");
    let best = common::read(&here.join("out"), "best.ron");
    let damping: f64 = best
        .lines()
        .find_map(|line| line.trim().strip_prefix("\"sim.joint.*_hip.damping\": "))
        .and_then(|value| value.trim_end_matches(',').parse().ok())
        .unwrap();
    assert!((damping - 0.05).abs() < 0.01, "{damping}: {best}");
    // Names of files hold no letters that a shell or another system takes for its own.
    let strange = common::files(&here.join("out"));
    let strange = strange
        .keys()
        .filter(|path| path.to_string_lossy().contains('*'));
    assert_eq!(strange.count(), 0);
}

#[test]
fn a_tossed_body_starts_as_recorded_and_its_named_contacts_are_fitted() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    package(here);
    let cube = |name: &str| {
        format!(
            r#"<mujoco><worldbody><geom {name} type="plane" size="5 5 1"/><body name="cube" pos="0 0 1"><freejoint/>
            <geom {name}2 type="box" size=".0524 .0524 .0524" mass=".37"/></body></worldbody></mujoco>"#
        )
        .replace("\"2", "2\"")
    };
    let toss = project().join("real_trajectories/cube_tosses/toss_003.csv");
    std::fs::copy(toss, here.join("toss.csv")).unwrap();
    std::fs::write(here.join("cube.xml"), cube("name=\"floor\"")).unwrap();
    let start = [
        "start", "toss.csv", "cube.xml", "--engine", "mujoco", "--python", &python,
    ];
    let (done, said) = run(here, &start);
    assert!(done, "{said}");
    let study = std::fs::read_to_string(here.join("study.ron")).unwrap();
    for words in [
        "metric: \"pose\"",
        "(name: \"geom.*.friction\", from: 0.05, to: 1.5, points: 11)",
        "(name: \"geom.*.solref\", from: 0.004, to: 0.1, points: 11)",
        "noise: (camera: (",
    ] {
        assert!(study.contains(words), "{words}: {study}");
    }
    // The size of the body in the model makes errors shares of its length: a metre long, it would be 3 % off.
    let values = ["--set", "sim.geom.*.friction=0.2", "--allow-command"];
    let (done, said) = run(here, &[&["evaluate", "study.ron"][..], &values].concat());
    assert!(done, "{said}");
    let line = said
        .lines()
        .find(|line| line.starts_with("position, % of body length"))
        .unwrap();
    let percent: f64 = line.split_whitespace().nth(5).unwrap().parse().unwrap();
    assert!((15.0..60.0).contains(&percent), "{said}");
    // Geoms without names cannot be fitted, and a path needs a body that is free.
    std::fs::write(here.join("cube.xml"), cube("").replace("2 type", " type")).unwrap();
    let (done, said) = run(here, &start);
    assert!(
        !done && said.contains("no geom of the model has a name"),
        "{said}"
    );
    std::fs::write(
        here.join("cube.xml"),
        cube("name=\"floor\"").replace("<freejoint/>", ""),
    )
    .unwrap();
    let (done, said) = run(here, &start);
    assert!(
        !done && said.contains("no body of the model is free"),
        "{said}"
    );
    // A Python without the packages is named with the remedy.
    let (done, said) = run(
        here,
        &[&start[..5], &["--python", "no_such_python"]].concat(),
    );
    assert!(
        !done && said.contains("no_such_python cannot be started") && said.contains("--python"),
        "{said}"
    );
}
