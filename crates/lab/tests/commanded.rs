//! Recorded commands drive a robot that settles first, too, or the study says that they do not.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common;

use realgap_lab::calibration::{Overrides, Study};

/// A recording of a robot with two wheels whose commanded angles grow by so many radians a second.
fn record(folder: &Path, name: &str, speed_rad_s: f64) {
    let rows = (0..41).map(|k| {
        let time_s = 0.05 * f64::from(k);
        let angle_rad = speed_rad_s * time_s;
        let along_m = 0.066 * time_s;
        format!("{time_s},{along_m},0,0,{angle_rad},{angle_rad}\n")
    });
    let rows: String = rows.collect();
    let text = format!("t_s,x_m,y_m,z_m,left_command_rad,right_command_rad\n{rows}");
    std::fs::write(folder.join(name), text).unwrap();
}

fn study(folder: &Path, commands: &str) -> Study {
    let robot = common::project().join("morphologies/turtlebot3_burger.ron");
    let text = format!(
        "Study(morphology: {robot:?}, recordings: [\"*.csv\"], reading: (axes: \"world\"), start: Settled, {commands}
            parameters: [(name: \"floor.friction\", from: 0.5, to: 1.0, points: 2)], metric: \"rms\", score: Single)"
    );
    std::fs::write(folder.join("study.ron"), text).unwrap();
    Study::read(folder.join("study.ron"), &Overrides::default()).unwrap()
}

/// How far the first run goes, metres.
fn far_m(study: &Study) -> f64 {
    let trial = study.simulate(1).unwrap();
    trial.cases[0].completed().unwrap().net_displacement_m
}

#[test]
fn twice_the_recorded_commands_drive_a_settled_robot_twice_as_far() {
    let folder = tempfile::tempdir().unwrap();
    let of = |speed_rad_s: f64| {
        record(folder.path(), "run.csv", speed_rad_s);
        far_m(&study(folder.path(), "commands: Commands(),"))
    };
    let (still, once, twice) = (of(0.0), of(2.0), of(4.0));
    assert!(still < 0.01, "{still}");
    // Wheels of 33 mm turn by 4 rad in 2 s, less what the servos lag behind.
    assert!((0.08..0.14).contains(&once), "{once}");
    assert!(twice / once > 1.6, "{once} {twice}");
}

#[test]
fn recordings_that_were_commanded_differently_have_runs_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "run_0.csv", 2.0);
    record(folder.path(), "run_1.csv", 2.0);
    record(folder.path(), "run_2.csv", 4.0);
    let study = study(folder.path(), "commands: Commands(),");
    let shared: Vec<usize> = study
        .cases()
        .iter()
        .map(|case| case.targets.len())
        .collect();
    assert_eq!(shared, [2, 1]);
}

#[test]
fn commands_that_a_study_does_not_use_are_said_to_be_unused() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "run.csv", 2.0);
    let said = |commands: &str| {
        let study = study(folder.path(), commands);
        let warnings = study.warnings().iter();
        warnings
            .map(|w| w.message.clone())
            .collect::<Vec<_>>()
            .join("\n")
    };
    let unused = said("");
    assert!(unused.contains("commands are not used") && unused.contains("commands: Commands()"));
    assert!(!said("commands: Commands(),").contains("not used"));
}
