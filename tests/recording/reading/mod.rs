//! Files as users have them: other columns, units and orders, several robots, holes, waiting. They are read with a note, or refused
//! or doubted with a remedy in this tool; correct files get no warnings.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
mod doubt;
mod lean;
mod mapping;
mod real;
mod time;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use realgap::file::Source;
use realgap::trajectory::{Reading, Recording, read};
use realgap::warning::Code;

/// Poses of a robot that walks a bow to the left for 20 s, at 50 Hz: t, x, y, heading.
fn walk() -> Vec<[f64; 4]> {
    (0..=1000)
        .map(|i| {
            let t = f64::from(i) / 50.0;
            let angle = 0.08 * t;
            [t, 0.5 * angle.sin(), 0.5 * (1.0 - angle.cos()), angle]
        })
        .collect()
}

/// The same in this project's own form.
fn own_form(poses: &[[f64; 4]]) -> String {
    let mut csv = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for [t, x, y, a] in poses {
        writeln!(
            csv,
            "{t},{x},{y},0.03,{},0,0,{}",
            (a / 2.0).cos(),
            (a / 2.0).sin()
        )
        .unwrap();
    }
    csv
}

/// The same as somebody's logger wrote it, beside a second robot that stands half a metre away.
fn foreign_form(poses: &[[f64; 4]]) -> String {
    let mut csv = "%time,robot,pose.x,pose.y,yaw\n".to_owned();
    for [t, x, y, a] in poses {
        let ns = 1_700_000_000_000_000_000_i64 + (t * 1e9) as i64;
        writeln!(csv, "{ns},3,{},{},{}", 1e3 * x, 1e3 * y, a.to_degrees()).unwrap();
        writeln!(csv, "{},4,500,500,0", ns + 7_000_000).unwrap();
    }
    csv
}

const FOREIGN: &str = r#"(
    columns: (t: "%time in ns", x: "pose.x in mm", y: "pose.y in mm", heading: "yaw in deg"),
    only: (column: "robot", value: "3"),
)"#;

fn reading(ron: &str) -> Reading {
    Reading::parse(&Source::new("reading.ron", ron)).unwrap()
}

fn file(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn read_text(text: &str, how: impl Into<Reading>) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    read(file(folder.path(), "run.csv", text), how).unwrap()
}

fn refuse(text: &str, how: impl Into<Reading>) -> String {
    let folder = tempfile::tempdir().unwrap();
    read(file(folder.path(), "run.csv", text), how)
        .unwrap_err()
        .to_string()
}

fn codes(recording: &Recording) -> Vec<Code> {
    recording.warnings.iter().map(|w| w.code).collect()
}

/// The message of the warning with this code.
fn said(recording: &Recording, code: Code) -> &str {
    let found = recording.warnings.iter().find(|w| w.code == code);
    &found
        .unwrap_or_else(|| panic!("no {code} in {:?}", recording.warnings))
        .message
}

fn is_near(a: &Recording, b: &Recording) {
    let (a, b) = (&a.trajectory, &b.trajectory);
    assert_eq!(a.len(), b.len());
    let since = |t: &[f64]| -> Vec<f64> { t.iter().map(|time| time - t[0]).collect() };
    for (i, (s, t)) in since(a.times_s())
        .iter()
        .zip(since(b.times_s()))
        .enumerate()
    {
        // Nanoseconds since 1970 have steps of 0.24 µs as a number.
        assert!((s - t).abs() < 1e-6, "{i}: {s} {t}");
        let d = a.positions_world_m()[i].xy() - b.positions_world_m()[i].xy();
        assert!(d.norm() < 1e-12, "{i}: {d}");
        let q =
            |of: &realgap::trajectory::Trajectory| of.orientations_world_from_body().unwrap()[i];
        assert!(q(a).angle_to(&q(b)) < 1e-9, "{i}");
    }
}
