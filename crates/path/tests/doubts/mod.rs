//! Doubts about recordings: nothing shipped is doubted wrongly, and shipped recordings that are distorted are doubted.

mod distortion;
mod servo;

use std::path::{Path, PathBuf};

use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::{Reading, Recording, parse_all, read_all};

use crate::common::{project, shared_data};

/// The codes of the doubts about the motion itself.
const CODES: [Code; 16] = [
    Code::Spike,
    Code::LostAsZero,
    Code::FrozenTracker,
    Code::JointDropout,
    Code::WrappedAngle,
    Code::ExchangedJoints,
    Code::FlippedSign,
    Code::DegreesAsRadians,
    Code::NormalisedAngles,
    Code::SeveralRobots,
    Code::ChangedUnit,
    Code::CoarseEncoder,
    Code::LostPackets,
    Code::SaturatedCommands,
    Code::SwitchedOff,
    Code::UnknownAxes,
];

/// All files with this extension below a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else if path.extension().is_some_and(|ending| ending == "csv") {
            all.push(path);
        }
    }
    all.sort();
    all
}

/// All recordings below a folder that can be read without further settings.
fn recordings(folder: &Path) -> Vec<Recording> {
    let all = files(folder).into_iter();
    all.filter_map(|path| read_all(path, Reading::default()).ok())
        .flatten()
        .collect()
}

fn shipped() -> Vec<Recording> {
    let all = recordings(&project().join("real_trajectories"));
    assert!(all.len() > 200, "{} recordings", all.len());
    all
}

fn doubts(warnings: &[Warning]) -> Vec<&Warning> {
    warnings
        .iter()
        .filter(|w| CODES.contains(&w.code))
        .collect()
}

/// The doubts about these recordings, one a line.
fn doubts_about(all: &[Recording]) -> String {
    let mut said = String::new();
    for recording in all {
        let doubts = doubts(&recording.warnings).into_iter();
        for doubt in doubts.filter(|doubt| !is_right(recording, doubt)) {
            said += &format!("{}: {doubt}\n", recording.path.display());
        }
    }
    said
}

/// The doubts that are right: single samples far off, seen with bare eyes in the files.
///
/// - `cube_pushes`: at 0.05 s the resting cube is 6 to 8 mm inside of the table for one sample, among samples with 0.1 mm of noise; in
///   `push_19` it is 1.3 mm above its place for one sample at 2.5 s.
/// - `elbow_tosses/toss_108`: the hinge is at -0.438 rad for two samples, between -0.300 and -0.285 rad.
fn is_right(recording: &Recording, doubt: &Warning) -> bool {
    let is_of = |folder: &str| recording.path.to_string_lossy().contains(folder);
    let is_push = is_of("cube_pushes")
        && ["0.0500 s", "2.50 s"]
            .iter()
            .any(|at| doubt.message.contains(&format!("at {at} for one sample")));
    let is_hinge = is_of("toss_108")
        && doubt
            .message
            .contains("`hinge` leaves its path at 0.0473 s");
    doubt.code == Code::Spike && (is_push || is_hinge)
}

#[test]
fn nothing_shipped_is_doubted_wrongly() {
    assert_eq!(doubts_about(&shipped()), "");
}

#[test]
fn the_whole_recorded_sets_are_not_doubted_wrongly() {
    let Some(folder) = shared_data("") else {
        return;
    };
    let all = recordings(&folder);
    assert!(all.len() > 800, "{} recordings", all.len());
    assert_eq!(doubts_about(&all), "");
}

/// A recording of positions at 50 Hz, as a file of TUM text; `place` gives the position of a sample.
fn tum(place: impl Fn(usize) -> [f64; 3], time_s: impl Fn(usize) -> f64) -> Vec<u8> {
    let line = |k: usize| {
        let [x, y, z] = place(k);
        format!("{} {x} {y} {z} 0 0 0 1\n", time_s(k))
    };
    (0..500).map(line).collect::<String>().into_bytes()
}

fn on_a_circle(k: usize) -> [f64; 3] {
    let a = 0.01 * k as f64;
    [1.0 + 0.5 * a.cos(), 0.5 * a.sin(), 0.1]
}

fn said_of(bytes: Vec<u8>) -> String {
    let read = parse_all("mine.tum", bytes, Reading::default()).unwrap();
    let said = read[0].warnings.iter().map(ToString::to_string);
    said.collect::<Vec<_>>().join("\n")
}

#[test]
fn doubts_hold_for_every_reader_and_say_where_and_what_was_seen() {
    let clock = |k: usize| 1.7e9 + 0.02 * k as f64;
    assert_eq!(said_of(tum(on_a_circle, clock)), "");
    let spike = |k: usize| {
        if k == 250 {
            [50.0, 50.0, 0.1]
        } else {
            on_a_circle(k)
        }
    };
    let said = said_of(tum(spike, clock));
    assert!(
        said.contains("leaves its path at 5.00 s for one sample by 70.1 m"),
        "{said}"
    );
    assert!(said.ends_with("[spike]"), "{said}");
    let lost = |k: usize| {
        if (300..340).contains(&k) {
            [0.0; 3]
        } else {
            on_a_circle(k)
        }
    };
    let said = said_of(tum(lost, clock));
    assert!(
        said.contains("exactly 0 from 6.00 s to 6.78 s (40 samples)"),
        "{said}"
    );
    let two = |k: usize| {
        let [x, y, z] = on_a_circle(k);
        if k.is_multiple_of(3) {
            [x + 4.0, y, z]
        } else {
            [x, y, z]
        }
    };
    let said = said_of(tum(two, clock));
    assert!(
        said.contains("between 2 places") && said.contains("[several-robots]"),
        "{said}"
    );
}

#[test]
fn a_robot_that_stays_level_on_y_or_falls_along_it_is_read_with_z_up_only_with_a_doubt() {
    let clock = |k: usize| 0.02 * k as f64;
    let on_the_ground = |k: usize| {
        let [x, y, _] = on_a_circle(k);
        let bumps = 0.002 * (0.7 * k as f64).sin();
        [x, y, 0.08 + bumps]
    };
    let turned = |[x, y, z]: [f64; 3]| [y, z, x - 1.0];
    let is_doubted = |said: &str| said.contains("[unknown-axes]");
    assert!(!is_doubted(&said_of(tum(on_the_ground, clock))));
    let said = said_of(tum(|k| turned(on_the_ground(k)), clock));
    assert!(
        said.contains("stays between 0.0780 and 0.0820 m on y"),
        "{said}"
    );
    assert!(is_doubted(&said), "{said}");
    // In a vertical plane above the ground, as a drone.
    let said = said_of(tum(|k| turned(on_the_ground(k)).map(|v| v + 2.0), clock));
    assert!(!is_doubted(&said), "{said}");
    // In a vertical plane above the ground, and turned about y as a robot on the ground is.
    let turning = |k: usize| {
        let [x, y, z] = turned(on_the_ground(k)).map(|v| v + 2.0);
        let half = 0.005 * k as f64;
        format!(
            "{} {x} {y} {z} 0 {} 0 {}\n",
            clock(k),
            half.sin(),
            half.cos()
        )
    };
    let text: String = (0..500).map(turning).collect();
    assert!(is_doubted(&said_of(text.into_bytes())));
    let thrown = |k: usize| {
        let t = clock(k);
        [0.3 * t, 0.1 * t, 1.0 + 3.0 * t - 4.905 * t * t]
    };
    assert!(!is_doubted(&said_of(tum(thrown, clock))));
    let said = said_of(tum(|k| turned(thrown(k)), clock));
    assert!(said.contains("it falls against y"), "{said}");
    let stated = Reading {
        axes: Some(realgap_path::trajectory::Axes::YUp),
        ..Reading::default()
    };
    for place in [on_the_ground, |k: usize| on_a_circle(k)] {
        let bytes = tum(|k| turned(place(k)), clock);
        let read = parse_all("mine.tum", bytes, stated.clone()).unwrap();
        let warnings = &read[0].warnings;
        assert!(warnings.iter().all(|w| w.code != Code::UnknownAxes));
    }
}

#[test]
fn a_robot_that_rests_is_not_frozen_and_one_that_jumps_afterwards_is() {
    let clock = |k: usize| 0.02 * k as f64;
    let at = |k: usize, rests: bool| match k {
        200..300 => on_a_circle(200),
        300.. if rests => on_a_circle(k - 99),
        _ => on_a_circle(k),
    };
    assert_eq!(said_of(tum(|k| at(k, true), clock)), "");
    assert_eq!(said_of(tum(|k| on_a_circle(k.min(300)), clock)), "");
    let said = said_of(tum(|k| at(k, false), clock));
    assert!(
        said.contains("repeats exactly from 4.00 s to 5.98 s (100 samples)"),
        "{said}"
    );
}

#[test]
fn a_robot_that_starts_abruptly_at_the_origin_is_not_in_another_unit() {
    let noise = |k: usize| 1e-5 * ((k * 7919 % 13) as f64 - 6.0);
    let starts = |k: usize| {
        let x = if k < 250 {
            0.0
        } else {
            0.01 * (k - 249) as f64
        };
        [x + noise(k), noise(k + 5), noise(k + 9)]
    };
    let said = said_of(tum(starts, |k| 0.02 * k as f64));
    assert!(!said.contains("changed-unit"), "{said}");
}

#[test]
fn a_clock_that_jumps_by_years_is_a_gap_and_a_time_without_a_number_is_refused() {
    let jumps = |k: usize| 0.02 * k as f64 + if k < 250 { 0.0 } else { 1e8 };
    let said = said_of(tum(on_a_circle, jumps));
    assert!(said.contains("[hole]"), "{said}");
    let without = |k: usize| if k == 250 { f64::NAN } else { 0.02 * k as f64 };
    let read = parse_all("mine.tum", tum(on_a_circle, without), Reading::default());
    assert!(read.unwrap_err().to_string().contains("mine.tum:251"));
}

/// A joint `elbow` with a command and these angles and speeds, at 50 Hz.
fn arm(angle: impl Fn(f64) -> f64, other: &str, value: impl Fn(f64) -> f64) -> String {
    let mut text = format!("t_s,elbow_rad,{other}\n");
    for k in 0..600 {
        let t = 0.02 * f64::from(k);
        text += &format!("{t},{},{}\n", angle(t), value(t));
    }
    let read = parse_all("arm.csv", text.into_bytes(), Reading::default()).unwrap();
    let said = read[0].warnings.iter().map(ToString::to_string);
    said.collect::<Vec<_>>().join("\n")
}

#[test]
fn small_degrees_are_seen_by_commands_speeds_and_steps_and_radians_are_not_doubted() {
    let wave = |t: f64| 0.04 * ((1.3 * t).sin() + 0.4 * (3.1 * t).sin());
    let speed = |t: f64| 0.04 * (1.3 * (1.3 * t).cos() + 1.24 * (3.1 * t).cos());
    let degrees = |t: f64| wave(t - 0.1).to_degrees();
    assert_eq!(arm(|t| wave(t - 0.1), "elbow_command_rad", wave), "");
    assert_eq!(arm(wave, "elbow_rad_s", speed), "");
    for said in [
        arm(degrees, "elbow_command_rad", wave),
        arm(
            |t| wave(t - 0.1),
            "elbow_command_rad",
            |t| wave(t).to_degrees(),
        ),
        arm(|t| wave(t).to_degrees(), "elbow_rad_s", speed),
        // Only the steps of its encoder tell: 4096 a turn.
        arm(
            |t| 0.087_890_625 * (degrees(t) / 0.087_890_625).round(),
            "supply_v",
            |_| 7.4,
        ),
    ] {
        assert!(said.contains("[degrees-as-radians]"), "{said}");
    }
    let said = arm(|t| -wave(t - 0.1), "elbow_command_rad", wave);
    assert!(said.contains("[flipped-sign]"), "{said}");
    // A slow sine may be late by half a period.
    let sine = |t: f64| 0.3 * (6.0 * t).sin();
    let said = arm(|t| -sine(t), "elbow_command_rad", sine);
    assert!(!said.contains("[flipped-sign]"), "{said}");
}
