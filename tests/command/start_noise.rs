//! The noise that `start` writes into a new study.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::PathBuf;

use crate::common;
use crate::start::{CUBE, foreign_tosses, start};

#[test]
fn a_new_study_states_the_noise_that_its_recordings_show_or_says_that_it_is_a_guess() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let robot = common::project().join("morphologies/tripod.ron");
    // A sum of three even numbers per error: a fixed sequence, the same in every run of the test, with standard deviation 1.
    let mut state = 7_u64;
    let mut error = || {
        let mut even = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
        };
        even() + even() + even()
    };
    let mut walks = |camera_m: f64| -> Vec<PathBuf> {
        let walk = |number: i32| {
            let rows = (0..240).map(|i| {
                let t = f64::from(i) / 30.0;
                let (x, y) = (0.08 * t, 0.02 * (0.8 * t).sin() + 0.001 * f64::from(number));
                format!(
                    "{t},{},{}\n",
                    x + camera_m * error(),
                    y + camera_m * error()
                )
            });
            let path = folder.path().join(format!("walk_{camera_m}_{number}.csv"));
            std::fs::write(&path, format!("t_s,x_m,y_m\n{}", rows.collect::<String>())).unwrap();
            path
        };
        let mut files: Vec<PathBuf> = (0..3).map(walk).collect();
        files.push(robot.clone());
        files
    };
    let (code, said) = start(&[], &walks(0.002), &study);
    assert!(
        code == 0 && said.contains("high frequencies of 3 recordings"),
        "{code} {said}"
    );
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(written.contains("the camera was measured"), "{written}");
    let camera = written
        .split("camera: (position_m: Normal(")
        .nth(1)
        .unwrap();
    let position_m: f64 = camera.split(')').next().unwrap().parse().unwrap();
    assert!((0.0015..0.0026).contains(&position_m), "{written}");
    // The robot has servos, whose zeros no recording shows.
    assert!(written.contains("servo_zero_rad: Normal("), "{written}");
    std::fs::remove_file(&study).unwrap();
    let (code, said) = start(&[], &walks(0.0), &study);
    assert!(
        code == 0 && said.contains("(`noise`) is a careful guess"),
        "{code} {said}"
    );
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(
        written.contains("careful guesses: replace them"),
        "{written}"
    );
    assert!(written.contains("position_m: Normal(0.001)"), "{written}");
    std::fs::remove_file(&study).unwrap();
    // A thrown cube starts from its recordings, so that only the camera's errors are left.
    let (code, said) = start(&CUBE, &foreign_tosses(folder.path()), &study);
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(
        code == 0 && !written.contains("start_position_m"),
        "{said} {written}"
    );
    assert!(written.contains("camera: (position_m:"), "{written}");
}
