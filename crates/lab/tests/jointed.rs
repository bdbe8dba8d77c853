//! Recordings with joints, tosses of two hinged boxes, and a driven pusher, from files to reports.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;
use crate::elbow::{elbow, set, toss};

use std::fmt::Write as _;

use realgap_core::unit::LengthUnit;
use realgap_identification::{LengthReading, StartState, identify_joints};
use realgap_lab::calibration::{Overrides, ScoreRule, Study};
use realgap_optimization::RunOptions;
use realgap_path::comparison::pose_errors;
use realgap_path::trajectory::{self};
use realgap_robot::morphology::Morphology;
use realgap_simulation::Start;
use realgap_simulation::parameter::ParameterSet;

#[test]
fn any_number_of_joints_is_read_by_name_written_back_and_compared_in_the_pose() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let mut text = String::from("t_s,x_m,y_m,z_m,qw,qx,qy,qz,knee_rad,elbow_rad,elbow_rad_s\n");
    for k in 0..4 {
        let t = 0.1 * f64::from(k);
        writeln!(text, "{t},0,0,{t},1,0,0,0,{},{},{}", 0.5 * t, 7.0 + t, 1.0).unwrap();
    }
    std::fs::write(&path, text).unwrap();
    let read = trajectory::read(&path, LengthUnit::Metre).unwrap();
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    let motion = read.trajectory;
    let names: Vec<&str> = motion
        .joints()
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["knee", "elbow"]);
    assert!(motion.joint("knee").unwrap().speeds_rad_s.is_none());
    let again = folder.path().join("again.csv");
    trajectory::write(&again, &motion).unwrap();
    assert_eq!(
        trajectory::read(&again, LengthUnit::Metre)
            .unwrap()
            .trajectory,
        motion
    );

    // An elbow angle that differs by a whole turn and 0.2 rad differs by 0.2 rad. The other motion has no knee, so the knee is left
    // out of the comparison.
    let mut other = motion.joint("elbow").unwrap().clone();
    for angle in &mut other.angles_rad {
        *angle += 0.2 - std::f64::consts::TAU;
    }
    let other = motion.clone().with_joints(vec![other]).unwrap();
    let errors = pose_errors(&motion, &other, 0.1).unwrap();
    assert!((errors.joint_rad_mean.unwrap() - 0.2).abs() < 1e-12);
    assert!((errors.score() - 0.2).abs() < 1e-12);
    let bare = motion.clone().with_joints(Vec::new()).unwrap();
    assert_eq!(
        pose_errors(&motion, &bare, 0.1).unwrap().joint_rad_mean,
        None
    );
}

#[test]
fn a_start_fitted_to_a_flight_is_the_true_start() {
    let folder = tempfile::tempdir().unwrap();
    let motion = toss(elbow(), 3, 0.3);
    trajectory::write(folder.path().join("toss.csv"), &motion).unwrap();
    let file = common::study(
        folder.path(),
        &format!(
            "morphology: \"{}/morphologies/elbow.ron\", recordings: [\"toss.csv\"], start: FromRecording, start_state: Flight,
            parameters: [(name: \"floor.friction\", from: 0.1, to: 0.2, points: 2)], metric: \"pose\"",
            common::project().display()
        ),
    );
    let study = Study::read(&file, &Overrides::default()).unwrap();
    assert_eq!(study.definition().start_state, StartState::Flight);
    let experiment = study.experiment_with(0, &ParameterSet::new()).unwrap();
    let Start::State(state) = experiment.start else {
        panic!("not a state")
    };
    let spin = motion.angular_velocities_body_rad_s().unwrap()[0];
    let speed = motion.velocities_world_m_s().unwrap()[0];
    assert!(
        (state.angular_velocity_body_rad_s - spin).norm() < 0.03,
        "{state:?} {spin}"
    );
    assert!(
        (state.velocity_world_m_s - speed).norm() < 0.01,
        "{state:?} {speed}"
    );
    let joint = motion.joint("hinge").unwrap();
    let started = experiment.start_joints[0];
    assert!((started.angle_rad - joint.angles_rad[0]).abs() < 2e-3);
    assert!((started.speed_rad_s - joint.speeds_rad_s.as_ref().unwrap()[0]).abs() < 0.05);
}

#[test]
fn a_body_of_the_scene_follows_its_columns_in_every_recording() {
    let folder = tempfile::tempdir().unwrap();
    for (name, far) in [("a", 0.05), ("b", 0.08)] {
        let mut text = String::from(
            "t_s,cube_x_m,cube_y_m,cube_z_m,cube_qw,cube_qx,cube_qy,cube_qz,tip_x_m,tip_y_m,tip_z_m,tip_qw,tip_qx,tip_qy,tip_qz\n",
        );
        for k in 0..=60 {
            let t = f64::from(k) / 30.0;
            let along = far * (t / 1.5).min(1.0);
            writeln!(
                text,
                "{t},{along},0,0.0375,1,0,0,0,{},0,0.03,1,0,0,0",
                along - 0.0475
            )
            .unwrap();
        }
        std::fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    let study = |scene: &str| {
        common::study(
            folder.path(),
            &format!(
                "morphology: \"{}/morphologies/push_cube.ron\", recordings: [\"*.csv\"], start: FromRecording,
                scene: [(name: \"{scene}\", friction: 0.2, motion: Recorded, boxes: [(sides_m: (0.02, 0.02, 0.02))])],
                parameters: [(name: \"pusher.friction\", from: 0.1, to: 0.2, points: 2)], metric: \"pose\"",
                common::project().display()
            ),
        )
    };
    let read = Study::read(study("tip"), &Overrides::default()).unwrap();
    assert!(
        read.definition()
            .recordings
            .iter()
            .all(|r| r.warnings.is_empty())
    );
    let found = read
        .evaluate(&ParameterSet::new(), &Default::default())
        .unwrap();
    assert!(
        found.final_position_percent.mean < 2.0,
        "{:?}",
        found.final_position_percent
    );
    assert!(found.final_rotation_deg.mean < 1.0);
    let error = Study::read(study("tap"), &Overrides::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("tap") && error.contains("tip"), "{error}");
}

#[test]
fn the_motion_after_an_impact_identifies_the_compliance_of_a_hinge() {
    let robot = Morphology::read(common::project().join("morphologies/elbow.ron")).unwrap();
    let mut builder = Study::builder("struck", robot);
    for k in 1..=6 {
        // The boxes are released at a height of 0.6 m and meet the floor after 0.4 s.
        let path = toss(set(&elbow(), &[("hinge.bearing_hz", 140.0)]), k, 0.5);
        builder = builder.trajectory(format!("toss_{k}"), path);
    }
    let study = builder
        .metric(realgap_path::comparison::by_name("pose").unwrap())
        .start_from_recordings(StartState::FirstSample)
        .score(ScoreRule::Single)
        .set("timestep_s", 1.0 / (148.0 * 16.0))
        .vary("hinge.bearing_hz", 50.0, 250.0, 5)
        .build()
        .unwrap();
    let answer = study.sweep(&RunOptions::default()).unwrap();
    let best = answer.report.best.as_ref().unwrap();
    assert!(
        (120.0..160.0).contains(&best.parameters["hinge.bearing_hz"]),
        "{best:?}"
    );
}

/// The free-flight model follows real tosses to 3 mm and 2 degrees up to the last sample before contact.
#[test]
fn the_flight_model_follows_real_tosses_of_hinged_boxes() {
    let Some(data) = common::shared_data("elbow_tosses") else {
        return;
    };
    let overrides = Overrides {
        recordings: vec![format!("{}/toss_00*.csv", data.display())],
        ..Overrides::default()
    };
    let study = Study::read(
        common::project().join("sweeps/elbow_toss_fit.ron"),
        &overrides,
    )
    .unwrap();
    let definition = study.definition();
    let found = identify_joints(
        &definition.experiment(),
        &definition.recordings,
        LengthReading::LengthScale,
        1,
    )
    .unwrap();
    let last = found.last_sample_as_stated;
    assert!(
        last.position_m < 3e-3 && last.rotation_deg < 2.0 && last.hinge_deg < 2.0,
        "{last:?}"
    );
}
