//! Probable mistakes in recordings get a warning with a remedy.

use std::fmt::Write as _;

use realgap::calibration::{Definition, Overrides, recording_warnings};
use realgap::trajectory::{Recording, read};
use realgap::unit::LengthUnit;
use realgap::warning::Code;

use super::common::{project, realgap, study, text};
use super::{codes, file, foreign_form, is_near, own_form, read_text, reading, said, walk};

#[test]
fn samples_that_only_repeat_the_one_before_are_left_out() {
    let csv = "t_s,x_m,y_m\n0,0,0\n0,0,0\n1,1,0\n1,1,0\n1,1,0\n2,2,0\n";
    let recording = read_text(csv, LengthUnit::Metre);
    assert_eq!(recording.trajectory.times_s(), [0.0, 1.0, 2.0]);
    assert_eq!(
        said(&recording, Code::DuplicateSamples),
        "3 samples that repeat the previous sample left out"
    );
}

#[test]
fn times_in_another_unit_are_doubted() {
    let times = |factor: f64| -> Vec<[f64; 4]> {
        walk()
            .iter()
            .map(|[t, x, y, a]| [t * factor, *x, *y, *a])
            .collect()
    };
    for (factor, unit) in [(1e3, "ms"), (1e6, "us"), (1e9, "ns")] {
        let csv = own_form(&times(factor));
        let recording = read_text(&csv, LengthUnit::Metre);
        let remedy = format!("columns: (t: \"t_s in {unit}\")");
        let said = said(&recording, Code::UnlikelyTime);
        assert!(
            said.contains(&remedy) && said.contains("makes it 50"),
            "{said}"
        );
        let cured = read_text(&csv, reading(&format!("({remedy})")));
        assert_eq!(codes(&cured), [Code::ReadAs], "{:?}", cured.warnings);
        assert!((cured.trajectory.duration_s() - 20.0).abs() < 1e-6);
    }
    // Seconds that are read as nanoseconds are as unlikely.
    let wrong = read_text(&own_form(&walk()), reading("(columns: (t: \"t_s in ns\"))"));
    assert!(codes(&wrong).contains(&Code::UnlikelyTime));
}

#[test]
fn a_study_that_cannot_last_so_long_says_which_unit_would_mend_it() {
    let folder = tempfile::tempdir().unwrap();
    let slow: Vec<[f64; 4]> = walk()
        .iter()
        .map(|[t, x, y, a]| [1e6 * t, *x, *y, *a])
        .collect();
    file(folder.path(), "run.csv", &own_form(&slow));
    let body = format!(
        "morphology: \"{}/morphologies/tripod.ron\", recordings: [\"run.csv\"], start: Settled,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
        project().display()
    );
    let path = study(folder.path(), &body);
    let out = realgap().arg("check").arg(&path).assert().code(1);
    let error = text(&out.get_output().stderr);
    assert!(
        error.contains("found:   20000000 s") && error.contains("columns: (t: \"t_s in us\")"),
        "{error}"
    );
}

#[test]
fn a_hole_is_not_filled_in_silence() {
    let holed = |from: f64, to: f64| -> Vec<[f64; 4]> {
        walk()
            .into_iter()
            .filter(|[t, ..]| *t <= from || *t >= to)
            .collect()
    };
    let csv = own_form(&holed(3.0, 7.0));
    let recording = read_text(&csv, LengthUnit::Metre);
    let message = said(&recording, Code::Hole);
    assert!(
        message.contains("no sample from 3.000 s to 7.000 s (200 usual intervals)"),
        "{message}"
    );
    assert!(
        message.contains("`crop: (from_s: 7.000)` begins after it"),
        "{message}"
    );
    let cured = read_text(&csv, reading("(crop: (from_s: 7.0))"));
    assert_eq!(codes(&cured), [Code::ReadAs], "{:?}", cured.warnings);
    let late = read_text(&own_form(&holed(15.0, 17.0)), LengthUnit::Metre);
    assert!(said(&late, Code::Hole).contains("`crop: (to_s: 15.000)` ends before it"));
    // A few lost samples are nothing.
    let few = read_text(&own_form(&holed(3.0, 3.09)), LengthUnit::Metre);
    assert!(codes(&few).is_empty(), "{:?}", few.warnings);
}

#[test]
fn waiting_before_the_start_is_seen() {
    let waits = |wait_s: f64, noise_m: f64| -> Vec<[f64; 4]> {
        let before = (0..(wait_s * 50.0) as i32).map(|i| {
            let tremble = noise_m * f64::from(i % 3 - 1);
            [f64::from(i) / 50.0, tremble, -tremble, 0.0]
        });
        let walk = walk().into_iter().map(|[t, x, y, a]| [t + wait_s, x, y, a]);
        before.chain(walk).collect()
    };
    let csv = own_form(&waits(3.0, 2e-5));
    let recording = read_text(&csv, LengthUnit::Metre);
    let message = said(&recording, Code::Standstill);
    let seconds: f64 = message
        .split("from_s: ")
        .nth(1)
        .unwrap()
        .split(')')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!((2.9..3.4).contains(&seconds), "{message}");
    let cured = read_text(&csv, reading(&format!("(crop: (from_s: {seconds}))")));
    assert_eq!(codes(&cured), [Code::ReadAs], "{:?}", cured.warnings);
    let short = read_text(&own_form(&waits(0.5, 2e-5)), LengthUnit::Metre);
    assert!(codes(&short).is_empty(), "{:?}", short.warnings);
    // Turning in place is no waiting, and standing all the time neither.
    let turns: Vec<[f64; 4]> = waits(3.0, 0.0)
        .into_iter()
        .map(|[t, x, y, a]| [t, x, y, a + 0.5 * t])
        .collect();
    assert!(codes(&read_text(&own_form(&turns), LengthUnit::Metre)).is_empty());
    let stands: Vec<[f64; 4]> = walk().iter().map(|[t, ..]| [*t, 0.0, 0.0, 0.0]).collect();
    assert!(codes(&read_text(&own_form(&stands), LengthUnit::Metre)).is_empty());
}

#[test]
fn quaternions_in_the_other_order_are_doubted() {
    let own = read_text(&own_form(&walk()), LengthUnit::Metre);
    // Real part last, under headings that say first.
    let mut csv = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    let mut tum = String::new();
    for [t, x, y, a] in walk() {
        let (c, s) = ((a / 2.0).cos(), (a / 2.0).sin());
        writeln!(csv, "{t},{x},{y},0.03,0,0,{s},{c}").unwrap();
        writeln!(tum, "{t} {x} {y} 0.03 {c} 0 0 {s}").unwrap();
    }
    let wrong = read_text(&csv, LengthUnit::Metre);
    assert!(
        said(&wrong, Code::QuaternionOrder).contains("as `quaternion: \"xyzw\"` it stays upright")
    );
    let cured = read_text(&csv, reading("(quaternion: \"xyzw\")"));
    assert_eq!(codes(&cured), [Code::ReadAs]);
    is_near(&cured, &own);
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "run.tum", &tum);
    let wrong = read(&path, LengthUnit::Metre).unwrap();
    assert!(
        said(&wrong, Code::QuaternionOrder).contains("as `quaternion: \"wxyz\"` it stays upright")
    );
    is_near(
        &read(&path, reading("(quaternion: \"wxyz\")")).unwrap(),
        &own,
    );
    // A body that rolls is not upright in either order.
    let mut rolls = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for [t, x, y, a] in walk() {
        writeln!(rolls, "{t},{x},{y},0.03,{},{},0,0", a.cos(), a.sin()).unwrap();
    }
    assert!(codes(&read_text(&rolls, LengthUnit::Metre)).is_empty());
}

#[test]
fn robots_beside_each_other_in_one_file_are_told_apart() {
    let how = reading("(columns: (t: \"%time in ns\", x: \"pose.x in mm\", y: \"pose.y in mm\"))");
    let both = read_text(&foreign_form(&walk()), how);
    let message = said(&both, Code::SeveralRobots);
    assert!(message.contains("`robot` changes (3, 4)"), "{message}");
    assert!(
        message.contains("only: (column: \"robot\", value: ...)"),
        "{message}"
    );
    // A column that only says what the robot does is none of robots.
    let mut csv = "t_s,x_m,y_m,state\n".to_owned();
    for (i, [t, x, y, _]) in walk().iter().enumerate() {
        writeln!(csv, "{t},{x},{y},{}", ["walk", "turn"][i / 40 % 2]).unwrap();
    }
    assert_eq!(
        codes(&read_text(&csv, LengthUnit::Metre)),
        [Code::ColumnsIgnored]
    );
}

#[test]
fn a_length_that_does_not_fit_the_robot_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let robot = project().join("morphologies/tripod.ron");
    let warned = |factor: f64, with: &str| {
        let poses: Vec<[f64; 4]> = walk()
            .iter()
            .map(|[t, x, y, a]| [*t, factor * x, factor * y, *a])
            .collect();
        file(folder.path(), "run.csv", &own_form(&poses));
        let body = format!(
            "morphology: \"{}\", recordings: [\"run.csv\"], start: Settled, {with}
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
            robot.display()
        );
        let definition =
            Definition::read(study(folder.path(), &body), &Overrides::default()).unwrap();
        let found = definition
            .warnings
            .into_iter()
            .find(|w| w.code == Code::UnlikelyLength);
        found.map(|warning| warning.message)
    };
    assert_eq!(warned(1.0, ""), None);
    for (factor, unit) in [(100.0, "cm"), (1000.0, "mm")] {
        let message = warned(factor, "").unwrap();
        assert!(
            message.contains("makes it") && message.contains(&format!("in {unit}\"")),
            "{message}"
        );
        // The remedy that is named works.
        let mut remedies = message.split('`').rev();
        let remedy = remedies
            .find(|part| part.contains(&format!("in {unit}")))
            .unwrap();
        assert_eq!(warned(factor, &format!("reading: ({remedy}),")), None);
    }
    // Metres that are read as millimetres.
    let wrong = "reading: (columns: (x: \"x_m in mm\", y: \"y_m in mm\")),";
    assert!(warned(1.0, wrong).is_some());
}

#[test]
fn compare_doubts_lengths_of_one_file_that_are_a_thousand_times_those_of_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let metres = file(folder.path(), "metres.csv", &own_form(&walk()));
    let scaled: Vec<[f64; 4]> = walk()
        .iter()
        .map(|[t, x, y, a]| [*t, 1e3 * x, 1e3 * y, *a])
        .collect();
    let other = file(
        folder.path(),
        "other.csv",
        &own_form(&scaled).replace("0.03,", "30,"),
    );
    let compare = |options: &[&str]| {
        let out = realgap()
            .arg("compare")
            .args([&metres, &other])
            .args(options)
            .output()
            .unwrap();
        (text(&out.stderr), out.status.code())
    };
    let (error, _) = compare(&[]);
    assert!(
        error.contains("other goes 1000 times as far as metres")
            && error.contains("x_m in mm")
            && error.contains("--unit UNIT"),
        "{error}"
    );
    // The names say metres, and a stated unit does not override them; a mapping does.
    let (error, _) = compare(&["--unit", "m", "--unit", "mm"]);
    assert!(
        error.contains("unit-in-name") && error.contains("unlikely-length"),
        "{error}"
    );
    let how = file(
        folder.path(),
        "mm.ron",
        "(columns: (x: \"x_m in mm\", y: \"y_m in mm\", z: \"z_m in mm\"))",
    );
    let how = how.to_str().unwrap();
    let (error, code) = compare(&["--reading", "-", "--reading", how]);
    assert!(
        !error.contains("unlikely-length") && code == Some(0),
        "{error}"
    );
    assert!(
        error.contains("other: recordings are read with x from `x_m in mm`"),
        "{error}"
    );
    let (error, code) = compare(&["--unit", "m", "--unit", "mm", "--unit", "m"]);
    assert!(
        code == Some(2) && error.contains("--unit") && error.contains("once, or 2 times"),
        "{error}"
    );
}

#[test]
fn many_recordings_alike_are_said_in_short() {
    let folder = tempfile::tempdir().unwrap();
    let holed: Vec<[f64; 4]> = walk()
        .into_iter()
        .filter(|[t, ..]| *t < 3.0 || *t > 7.0)
        .collect();
    let all: Vec<Recording> = (0..8)
        .map(|i| {
            read(
                file(folder.path(), &format!("run_{i}.csv"), &own_form(&holed)),
                LengthUnit::Metre,
            )
            .unwrap()
        })
        .collect();
    let warnings = recording_warnings(&all);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(
        warnings[2]
            .message
            .ends_with("(and 5 more recordings alike)")
    );
}
