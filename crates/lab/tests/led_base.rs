//! Studies whose robot stands on something that moves: its root follows the recorded pose, and its joints are compared.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::Code;
use realgap_core::file::Source;
use realgap_lab::calibration::{Overrides, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{CommandTrack, Experiment, JointState, Quantity, Sampling, run};

use crate::joint_log::{SPRING, robot};

/// The hidden inertia of the rotors and stiffness of the first servo.
const TRUTH: [&str; 2] = [
    "hinge.*.armature_kg_m2=0.01",
    "servo.pitch.stiffness_nm_rad=10",
];

fn times() -> Vec<f64> {
    (0..300).map(|k| 0.01 * f64::from(k)).collect()
}

/// The place and the orientation of a stand that is shaken and tilted.
fn stand(t: f64) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let place = Vector3::new(
        0.5 + 0.1 * (11.0 * t).sin(),
        -0.2,
        1.0 + 0.02 * (7.0 * t).cos(),
    );
    let turn = Vector3::y() * (0.1 * (5.0 * t).sin());
    (place, UnitQuaternion::from_scaled_axis(turn))
}

/// Writes the robot and a log of it on that stand; `far` multiplies the recorded shift of the stand.
fn recorded(folder: &Path, far: f64, with_pose: bool) {
    std::fs::write(folder.join("arm.ron"), robot(SPRING)).unwrap();
    let assembly = Morphology::parse(&Source::new("arm", robot(SPRING))).unwrap();
    let mut experiment = Experiment::new(assembly.assemble());
    let poses: Vec<_> = times().into_iter().map(stand).collect();
    let (places, turns): (Vec<_>, Vec<_>) = poses.iter().copied().unzip();
    let motion = Trajectory::new(times(), places).unwrap();
    let motion = motion.with_orientations(turns).unwrap();
    experiment.lead_base(&motion).unwrap();
    let command = |t: f64| 0.3 * (2.0 * t).sin();
    for name in ["pitch", "elbow"] {
        let values = times().into_iter().map(command).collect();
        let track = CommandTrack::new(times(), values, None).unwrap();
        experiment
            .commands
            .insert(name.to_owned(), Arc::new(track.of(Quantity::Position)));
    }
    experiment.start_joints = vec![JointState::default(); 2];
    experiment.sampling = Sampling::Times(times().into());
    experiment.duration_s = 2.99;
    experiment.solver.timestep_s = 0.0025;
    let set: ParameterSet = TRUTH.iter().map(|one| one.parse().unwrap()).collect();
    let path = run(&set.apply(&experiment))
        .unwrap()
        .outcome
        .completed()
        .unwrap();
    let pose = if with_pose {
        ",x_m,y_m,z_m,qw,qx,qy,qz"
    } else {
        ""
    };
    let mut text = format!("t_s{pose},pitch_command_rad,elbow_command_rad,pitch_rad,elbow_rad\n");
    for (k, t) in times().into_iter().enumerate() {
        text += &t.to_string();
        if with_pose {
            let (place, turn) = stand(t);
            let first = stand(0.0).0;
            let p = first + (place - first) * far;
            text += &format!(
                ",{},{},{},{},{},{},{}",
                p.x, p.y, p.z, turn.w, turn.i, turn.j, turn.k
            );
        }
        // Encoder noise of 0.5 mrad, a fixed sequence; none where the run starts.
        let noise = |joint: usize| 5e-4 * ((k * (7919 + joint * 104_729)) as f64).sin();
        let angle = |joint: usize| path.joints()[joint].angles_rad[k] + noise(joint);
        text += &format!(",{},{},{},{}\n", command(t), command(t), angle(0), angle(1));
    }
    std::fs::write(folder.join("log.csv"), text).unwrap();
}

fn study(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("study.ron");
    let text = format!(
        r#"Study(morphology: "arm.ron", recordings: ["log.csv"], start: FromRecording, timestep_s: 0.0025,
            metric: "joints", score: Single, commands: Commands(), set: {{"solver.engine": 1}},
            parameters: [(name: "hinge.*.armature_kg_m2", from: 0.0001, to: 0.1),
                (name: "servo.pitch.stiffness_nm_rad", from: 4, to: 20)], {more})"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn error_mrad(folder: &Path, more: &str) -> f64 {
    let study = Study::read(study(folder, more), &Overrides::default()).unwrap();
    let set: ParameterSet = TRUTH.iter().map(|one| one.parse().unwrap()).collect();
    let found = study.evaluate_joints(&set, &RunOptions::default());
    found.unwrap().angle_mrad.mean
}

#[test]
fn joints_on_a_stand_that_moves_are_explained_where_the_base_is_led_and_fitted_with_their_hidden_values()
 {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), 1.0, true);
    let led = error_mrad(folder.path(), "base: Recorded");
    let held = error_mrad(folder.path(), "");
    assert!(led < 0.5, "{led}");
    assert!(held > 5.0, "{held}");
    let path = study(folder.path(), "base: Recorded");
    let read = || Study::read(&path, &Overrides::default()).unwrap();
    let answer = read().tune(
        &TuneOptions {
            optimizer: optimizer_by_name("gauss-newton").unwrap(),
            budget: 40,
            patience: None,
        },
        &RunOptions::default(),
    );
    let fit = answer.unwrap().report.tuning.unwrap().least_squares;
    for (estimate, truth) in fit.iter().zip([0.01, 10.0]) {
        let off = (estimate.value / truth - 1.0).abs();
        assert!(estimate.is_told && off < 0.1, "{truth}: {estimate:?}");
    }
    // Doubling what was recorded of the stand is another run.
    recorded(folder.path(), 2.0, true);
    let doubled = error_mrad(folder.path(), "base: Recorded");
    assert!(doubled > 5.0, "{doubled}");
    let used = read().unused_columns().unwrap();
    assert!(used.is_empty(), "{used:?}");
}

#[test]
fn a_base_that_cannot_be_led_is_refused_and_a_held_robot_that_moves_is_doubted_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let said = |more: &str| {
        let read = Study::read(study(folder.path(), more), &Overrides::default());
        read.unwrap_err().to_string()
    };
    recorded(folder.path(), 1.0, false);
    let without = said("base: Recorded");
    assert!(
        without.contains("log.csv") && without.contains("orientations"),
        "{without}"
    );
    recorded(folder.path(), 20.0, true);
    let refined = said("base: Recorded, start_state: Flight");
    assert!(refined.contains("start_state"), "{refined}");
    let text = std::fs::read_to_string(study(folder.path(), "base: Recorded")).unwrap();
    for (from, to, hint) in [
        ("FromRecording", "Settled", "start: FromRecording"),
        (r#"metric: "joints""#, r#"metric: "rms""#, "joints"),
    ] {
        let path = folder.path().join("wrong.ron");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let error = Study::read(&path, &Overrides::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains(hint), "{error}");
    }
    let doubts = |more: &str| {
        let study = Study::read(study(folder.path(), more), &Overrides::default()).unwrap();
        let all = study
            .warnings()
            .iter()
            .filter(|w| w.code == Code::OtherRobot);
        all.map(|w| w.message.clone()).collect::<Vec<_>>()
    };
    assert!(doubts("")[0].contains("base: Recorded"), "{:?}", doubts(""));
    assert!(doubts("base: Recorded").is_empty());
}
