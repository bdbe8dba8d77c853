//! Tests of reading logs of scans, and of the errors for bad logs.

use realgap_sensing::graph::regression::Stop;
use realgap_sensing::graph::{Frame, GraphOptions, Polynomial, ScanLog, fit};

use super::room;

#[test]
fn a_carmen_log_is_read_as_its_csv() {
    let text = "# CARMEN Logfile\nPARAM robot_length 1\nODOM 0 0 0 0 0 0 0.1 host 0.1\n\
        FLASER 5 1.0 2.0 3.0 81.83 5.0 0.5 -0.5 3.5 0 0 0 12.5 host 12.5\n\
        FLASER 5 1.5 2.5 3.5 4.5 5.5 0.6 -0.5 -1.0 0 0 0 12.75 host 12.75\n";
    let log = ScanLog::parse("log.clf", text).unwrap();
    assert_eq!(log.scans.len(), 2);
    let degrees: Vec<f64> = log
        .beams_rad
        .iter()
        .map(|b| b.to_degrees().round())
        .collect();
    assert_eq!(degrees, [-90.0, -45.0, 0.0, 45.0, 90.0]);
    let first = &log.scans[0];
    assert_eq!((first.position_world_m, first.time_s), ([0.5, -0.5], 12.5));
    assert!((first.heading_rad - (3.5 - std::f64::consts::TAU)).abs() < 1e-12);
    assert_eq!(
        first.ranges_m,
        [Some(1.0), Some(2.0), Some(3.0), None, Some(5.0)]
    );
    for (bad, said) in [
        ("FLASER 5 1 2 3\n", "ends too early"),
        ("FLASER x 1\n", "number of beams"),
        (
            "FLASER 2 1 2 0 0 0 0 0 0 1 h 1\nFLASER 3 1 2 3 0 0 0 0 0 0 1 h 1\n",
            "same number of beams",
        ),
        ("ODOM 0 0 0 0 0 0 0 h 0\n", "no scans"),
    ] {
        let error = ScanLog::parse("log.clf", bad).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_bad_log_of_scans_gives_an_error_that_names_the_problem() {
    for (text, said) in [
        ("t_s,x_m,y_m,heading_rad\n0,0,0,0\n", "no ranges"),
        (
            "t_s,x_m,y_m,range_000_m\n0,0,0,1\n",
            "no column `heading_rad`",
        ),
        ("t_s,x_m,y_m,heading_rad,range_000_m\n", "no scans"),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n0,0,0,0,-1\n",
            "cannot be negative",
        ),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n0,nan,0,0,1\n",
            "not a finite number",
        ),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n1,0,0,0,1\n0,0,0,0,1\n",
            "must not decrease",
        ),
    ] {
        let error = ScanLog::parse("scans.csv", text).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("scans.csv"),
            "{error}"
        );
    }
    let still = ScanLog::parse(
        "a.csv",
        &format!(
            "t_s,x_m,y_m,heading_rad,range_000_m\n{}",
            "0,1,1,0,2\n".repeat(20)
        ),
    )
    .unwrap();
    assert!(
        fit(&still, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("never moved")
    );
    let few = ScanLog::parse("a.csv", &room(5, true)).unwrap();
    assert!(
        fit(&few, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("too few scans")
    );
    let seeing = room(30, true);
    let blind = seeing.lines().enumerate().map(|(k, line)| {
        let pose: Vec<&str> = line.split(',').take(4).collect();
        if k == 0 {
            format!("{line}\n")
        } else {
            format!("{}{}\n", pose.join(","), ",".repeat(36))
        }
    });
    let blind = ScanLog::parse("a.csv", &blind.collect::<String>()).unwrap();
    assert!(
        fit(&blind, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("no beam of the log returned")
    );
    // A log that contains only some headings: there is a warning, and means are used for the others.
    let log = ScanLog::parse("a.csv", &room(60, true)).unwrap();
    let options = GraphOptions {
        frame: Some(Frame::Robot),
        headings: 90,
        ..GraphOptions::default()
    };
    let found = fit(&log, &options).unwrap();
    assert_eq!(found.warnings[0].code.name(), "empty-headings");
    assert!(found.model.range_m([0.0, 0.0], 0.1, 0).is_finite());
    // More terms than the samples allow: there is a warning, and the number of terms is reduced.
    let options = GraphOptions {
        stop: Stop::Terms(15),
        headings: 12,
        ..options
    };
    let found = fit(&log, &options).unwrap();
    assert!(
        found
            .warnings
            .iter()
            .any(|w| w.code.name() == "fewer-terms")
    );
    let sound = |p: &&Polynomial| p.terms.len() <= (p.samples / 3).max(1);
    assert!(found.model.polynomials.iter().all(|p| sound(&p)));
}

/// If the poses of a log are in a separate file with other times than the scans, the log is restored by interpolation.
#[test]
fn poses_in_a_separate_file_are_interpolated_at_the_times_of_the_scans() {
    let folder = tempfile::tempdir().unwrap();
    let whole = ScanLog::parse("room.csv", &room(200, true)).unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let scans = write(
        "scans.csv",
        room(200, true)
            .lines()
            .map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                format!("{},{}\n", cells[0], cells[4..].join(","))
            })
            .collect(),
    );
    // Ten poses between two scans, from after the first to before the last scan.
    let tum = (20..1900).map(|k| {
        let share = f64::from(k) / 10.0;
        let t = share / 200.0;
        let (sin, cos) = (20.0 * t).sin_cos();
        let (x, y) = (3.0 * (9.0 * t).sin(), 3.0 * (14.0 * t).cos());
        format!("{} {x} {y} 0 0 0 {sin} {cos}\n", 0.25 * share)
    });
    let poses = write("poses.tum", tum.collect());
    let (log, warning) = ScanLog::read_with_poses(&scans, &poses).unwrap();
    assert_eq!(warning.unwrap().code.name(), "scans-without-pose");
    assert_eq!(log.scans.len(), 188);
    for (found, known) in log.scans.iter().zip(&whole.scans[2..]) {
        assert_eq!(found.ranges_m, known.ranges_m);
        for axis in 0..2 {
            let off_m = found.position_world_m[axis] - known.position_world_m[axis];
            assert!(off_m.abs() < 1e-6, "{off_m}");
        }
        let off_rad = (found.heading_rad - known.heading_rad).sin().abs();
        assert!(off_rad < 1e-6, "{off_rad}");
    }
    let refused = |name: &str, text: &str| {
        let poses = write(name, text.to_owned());
        let error = ScanLog::read_with_poses(&scans, &poses).unwrap_err();
        error.to_string()
    };
    assert!(refused("late.tum", "900 0 0 0 0 0 0 1\n901 1 0 0 0 0 0 1\n").contains("same clock"));
    assert!(refused("flat.csv", "t_s,x_m,y_m\n0,0,0\n9,1,1\n").contains("need orientations"));
}
