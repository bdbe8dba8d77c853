//! Logs of scans: what is read, and what is refused.

use realgap::sensing::graph::{Frame, GraphOptions, ScanLog, fit};

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
fn a_bad_log_of_scans_is_told_what_is_wrong_with_it() {
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
            "must not fall",
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
            .contains("not a single beam")
    );
    // Only some headings: said, and the mean stands in.
    let log = ScanLog::parse("a.csv", &room(60, true)).unwrap();
    let options = GraphOptions {
        frame: Some(Frame::Robot),
        headings: 90,
        ..GraphOptions::default()
    };
    let found = fit(&log, &options).unwrap();
    assert_eq!(found.warnings[0].code.name(), "empty-headings");
    assert!(found.model.range_m([0.0, 0.0], 0.1, 0).is_finite());
}
