//! File formats of trajectories: written files are read back unchanged, and errors name file, line and column.
#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;
use realgap_core::Warning;
use realgap_core::unit::LengthUnit;
use realgap_core::warning::Code;
use realgap_path::trajectory::{
    Axes, FORMATS, InferredReading, Reading, Trajectory, read, read_all, read_groups, write,
};

fn refuse(name: &str, text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let error = read(&path, LengthUnit::Metre).unwrap_err().to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

fn accept(text: &str, unit: LengthUnit) -> realgap_path::trajectory::Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, text).unwrap();
    read(&path, unit).unwrap()
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -10.0..10.0_f64,
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
    ]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(number()).prop_map(Vector3::from)
}

prop_compose! {
    fn any_trajectory()(samples in prop::collection::vec(
        (1e-6..10.0_f64, vector(), prop::array::uniform4(-1.0..1.0_f64), vector(), vector()), 2..20),
        turns: bool, speeds: bool, planar: bool,
    ) -> Trajectory {
        let mut time_s = -3.0;
        let times = samples.iter().map(|s| { time_s += s.0; time_s }).collect();
        let position = |p: Vector3<f64>| if planar { Vector3::new(p.x, p.y, 0.0) } else { p };
        let mut trajectory = Trajectory::new(times, samples.iter().map(|s| position(s.1)).collect()).unwrap();
        if turns {
            let unit = |q: [f64; 4]| UnitQuaternion::new_normalize(Quaternion::new(q[0] + 2.0, q[1], q[2], q[3]));
            trajectory = trajectory.with_orientations(samples.iter().map(|s| unit(s.2)).collect()).unwrap();
        }
        if speeds {
            trajectory = trajectory
                .with_velocities(samples.iter().map(|s| s.3).collect(), samples.iter().map(|s| s.4).collect())
                .unwrap();
        }
        if planar { trajectory.planar() } else { trajectory }
    }
}

/// The bits of every number of a trajectory, because `==` does not distinguish −0 from 0.
fn bits(t: &Trajectory) -> Vec<u64> {
    let mut all: Vec<f64> = t.times_s().to_vec();
    let columns = [
        Some(t.positions_world_m()),
        t.velocities_world_m_s(),
        t.angular_velocities_body_rad_s(),
    ];
    for v in columns.into_iter().flatten().flatten() {
        all.extend(v.iter());
    }
    for q in t.orientations_world_from_body().into_iter().flatten() {
        all.extend(q.coords.iter());
    }
    all.into_iter().map(f64::to_bits).collect()
}

/// Checks that all data that no warning of `render` names are the same; positions are always the same.
fn same_but_for_warnings(
    back: &Trajectory,
    written: &Trajectory,
    warnings: &[Warning],
) -> Result<(), TestCaseError> {
    let is_named = |what: &str| warnings.iter().any(|w| w.message.contains(what));
    // Formats whose times start at 0 move the times to 0.
    let moved_s = if is_named("times before 0") {
        written.times_s()[0]
    } else {
        0.0
    };
    prop_assert_eq!(back.positions_world_m(), written.positions_world_m());
    if is_named("finer than a nanosecond") {
        for (a, b) in back.times_s().iter().zip(written.times_s()) {
            prop_assert!((a - (b - moved_s)).abs() < 0.6e-9, "{a} {b}");
        }
    } else if !is_named("times;") && !is_named("times before 0") {
        prop_assert_eq!(back.times_s(), written.times_s());
    }
    let Some(turns) = written.orientations_world_from_body() else {
        return Ok(());
    };
    for (a, b) in back
        .orientations_world_from_body()
        .unwrap()
        .iter()
        .zip(turns)
    {
        if is_named("times;") {
            // KITTI files hold orientations as matrices, so they are rounded.
            prop_assert!(a.angle_to(b) < 1e-7, "{a} {b}");
        } else {
            prop_assert_eq!(a, b);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_format_reads_its_own_files_back(trajectory in any_trajectory()) {
        let reading = Reading { rate_hz: Some(50.0), axes: Some(Axes::World), ..Reading::default() };
        for format in FORMATS {
            let written = format.render(&trajectory);
            prop_assert_eq!(written.is_ok(), format.writes(), "{}", format.name());
            let Ok(written) = written else { continue };
            let text = format.decode(written.bytes, &reading).unwrap().text;
            let back = format.parse(&text, &format.applied(&text, &reading)).unwrap();
            let (back, warnings) = (back.trajectory, back.warnings);
            prop_assert!(warnings.is_empty(), "{}: {warnings:?}", format.name());
            if written.warnings.is_empty() {
                prop_assert_eq!(bits(&back), bits(&trajectory), "{}", format.name());
                prop_assert_eq!(&back, &trajectory);
            }
            same_but_for_warnings(&back, &trajectory, &written.warnings)?;
        }
    }

    #[test]
    fn csv_files_hold_all_data_of_a_trajectory(trajectory in any_trajectory()) {
        prop_assert!(FORMATS[0].render(&trajectory).unwrap().warnings.is_empty());
    }

    #[test]
    fn no_text_makes_a_parser_panic(text in "(t_s,x_m,y_m(,q[wxyz]){0,4}\n)?[-0-9.,e \"#\nnaif\u{e9}]{0,200}") {
        for format in FORMATS {
            let _either = format.parse(&text, &LengthUnit::Metre.into());
        }
    }

    #[test]
    fn no_text_makes_splitting_or_inference_panic(
        text in "(#|%)?(t_s,x_m,y_m|time;x;y|sec nanosec x y yaw|t,a.x,a.y,b.x,b.y)\n(s,m,m\n)?([-0-9.,;: TZe\"#\n+/\u{b0}]{0,40}\n){0,6}",
        rows in prop::collection::vec((0..9_i32, -9..9_i32, -9..9_i32), 0..60),
    ) {
        let split = Reading { split: Some(true), ..Reading::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("any.csv");
        let table: String = rows.iter().map(|(t, x, y)| format!("{t},{x},{y}\n")).collect();
        for text in [text, format!("t_s,x_m,y_m\n{table}")] {
            for format in FORMATS {
                let _either = format.parse_split(&text, &split);
            }
            std::fs::write(&path, text).unwrap();
            for known in [&split, &Reading::default()] {
                let _either = InferredReading::of_file(&path, known);
                let _either = InferredReading::infer(std::slice::from_ref(&path), known, Some(0.1));
            }
        }
    }
}

#[test]
fn errors_name_file_line_column_and_what_to_do() {
    for (text, start, contains) in [
        ("", "run.csv:1:1: ", "the file is empty"),
        ("t_s,x_m,y_m\n", "run.csv:1:1: ", "too few points"),
        ("t_s,x_m,y_m\n0,0,0\n", "run.csv:2:1: ", "1 sample"),
        (
            "t_s,x_m\n0,0\n1,1\n",
            "run.csv:1:1: y_m: ",
            "found:   t_s, x_m",
        ),
        (
            "t_s,x_px,y_px\n0,0,0\n",
            "run.csv:1:1: x_m: ",
            "say which column is which",
        ),
        (
            "0,0,0\n1,1,1\n",
            "run.csv:1:1: t_s: ",
            "first line must name",
        ),
        ("t_s,x_m,x_m,y_m\n", "run.csv:1:9: ", "same name"),
        (
            "t_s,x_m,y_m\n0,0,0\n1,nan,0\n",
            "run.csv:3:3: x_m: ",
            "not a finite number",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n1,0,-inf\n",
            "run.csv:3:5: y_m: ",
            "not a finite number",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n1,0,1e999\n",
            "run.csv:3:5: y_m: ",
            "not a finite number",
        ),
        (
            "t_s,x_m,y_m\n0,0,zero\n",
            "run.csv:2:5: y_m: ",
            "not a number",
        ),
        (
            "t_s,x_m,y_m\n0,,0\n",
            "run.csv:2:3: x_m: ",
            "found:   nothing",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n\n0,1,1\n",
            "run.csv:4:1: t_s: ",
            "0 after 0",
        ),
        (
            "t_s,x_m,y_m\n0,0,0,7\n",
            "run.csv:2:7: ",
            "found:   4 columns",
        ),
        ("t_s,x_m,y_m\n0,0\n", "run.csv:2:3: ", "found:   2 columns"),
        (
            "t_s,x_m,y_m,qw,qx\n0,0,0,1,0\n",
            "run.csv:1:1: qy, qz: ",
            "missing column",
        ),
        (
            "t_s,x_m,y_m,qw,qx,qy,qz\n0,0,0,1,1,0,0\n",
            "run.csv:2:7: ",
            "length 1.41",
        ),
        (
            "t_s,x_m,y_m,run\n0,0,0,1\n1,0,0,1\n0,0,0,2\n",
            "run.csv:4:1: t_s: ",
            "several recordings",
        ),
    ] {
        let error = refuse("run.csv", text);
        assert!(error.starts_with(start), "{text:?}:\n{error}");
        assert!(error.contains(contains), "{text:?}:\n{error}");
    }
    let error = refuse("run.tum", "# comment\n0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n");
    assert!(
        error.starts_with("run.tum:3:13: wrong number of columns"),
        "{error}"
    );
    let error = refuse("run.abc", "");
    assert!(
        error.contains(".csv, .tsv, .tum, .txt, .euroc, .kitti, .mcap, .db3, .ulg, .ulog, .parquet, .yaml, .yml, .jsonl, .ndjson, .json, .npy, .npz"),
        "{error}"
    );
}

#[test]
fn columns_may_have_any_order_and_extra_columns_are_named_in_a_warning() {
    let recording = accept(
        "\u{feff}\"y_m\", t_s ,battery,x_m\r\n2,0,99,1\r\n4,1,98,3\r\n",
        LengthUnit::Metre,
    );
    assert_eq!(recording.name, "run");
    assert!(recording.trajectory.is_planar());
    assert_eq!(
        recording.trajectory.positions_world_m()[1],
        Vector3::new(3.0, 4.0, 0.0)
    );
    assert_eq!(recording.warnings[0].message, "columns not used: battery");
}

#[test]
fn lengths_are_scaled_and_angles_are_not() {
    let names = [
        "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s",
        "x_cm,y_cm,z_cm,vx_cm_s,vy_cm_s,vz_cm_s",
        "x,y,z,vx,vy,vz",
    ];
    let metres = Vector3::new(100.0, 200.0, 300.0);
    for (names, place) in names
        .into_iter()
        .zip([metres, metres / 100.0, metres / 100.0])
    {
        let text = format!(
            "t_s,{names},wx_rad_s,wy_rad_s,wz_rad_s\n0,0,0,0,0,0,0,0,0,0\n1,100,200,300,10,20,30,1,2,3\n"
        );
        let recording = accept(&text, LengthUnit::Centimetre);
        let trajectory = &recording.trajectory;
        assert!((trajectory.positions_world_m()[1] - place).norm() < 1e-12);
        assert!((trajectory.velocities_world_m_s().unwrap()[1].y - 0.1 * place.y).abs() < 1e-12);
        // A unit in a name has priority over a stated unit, and this is said.
        let is_said = recording
            .warnings
            .iter()
            .any(|w| w.code == Code::UnitInName);
        assert_eq!(
            is_said,
            names.starts_with("x_m"),
            "{:?}",
            recording.warnings
        );
        assert_eq!(
            trajectory.angular_velocities_body_rad_s().unwrap()[1].y,
            2.0
        );
    }
}

#[test]
fn quaternions_of_few_digits_are_renormalised() {
    let text = |qw: &str| format!("t_s,x_m,y_m,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,{qw},0,0,0\n");
    for (qw, warnings) in [("1.0005", 0), ("1.005", 1)] {
        let recording = accept(&text(qw), LengthUnit::Metre);
        assert_eq!(
            recording.trajectory.orientations_world_from_body().unwrap()[1].w,
            1.0
        );
        assert_eq!(recording.warnings.len(), warnings);
    }
}

#[test]
fn a_file_can_hold_several_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("runs.csv");
    std::fs::write(&path, "condition,run,sample,t_s,x_m,y_m\nir,1,0,0,0,0\nir,1,1,1,1,0\nus,1,0,0,0,0\nir,2,0,0,5,0\nir,2,1,1,6,0\nus,1,1,1,2,0\n").unwrap();
    let all = read_all(&path, LengthUnit::Metre).unwrap();
    let names: Vec<&str> = all
        .iter()
        .map(|recording| recording.name.as_str())
        .collect();
    assert_eq!(names, ["runs/ir/1", "runs/us/1", "runs/ir/2"]);
    assert_eq!(all[1].trajectory.net_displacement_world_m().x, 2.0);
    let by_column = |columns: &[&str]| read_groups(&path, LengthUnit::Metre, columns);
    assert_eq!(
        by_column(&["run", "condition"]).unwrap()[1].name,
        "runs/1/us"
    );
    let error = by_column(&["robot"]).unwrap_err().to_string();
    assert!(
        error.contains("runs.csv:1:1: robot: missing column"),
        "{error}"
    );
}

#[test]
fn metadata_beside_the_file_is_attached_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "t_s,x_m,y_m\n0,0,0\n1,1,0\n").unwrap();
    assert_eq!(read(&path, LengthUnit::Metre).unwrap().meta, None);
    let meta =
        "(robot: \"cube\", source: StandIn, description: \"d\", frame: \"f\", licence: \"l\")";
    std::fs::write(folder.path().join("meta.ron"), meta).unwrap();
    let recording = read(&path, LengthUnit::Metre).unwrap();
    assert_eq!(recording.meta.unwrap().robot, "cube");
    std::fs::write(folder.path().join("meta.ron"), "(\n  robt: \"cube\",\n)").unwrap();
    let error = read(&path, LengthUnit::Metre).unwrap_err();
    assert!(error.file().is_some_and(|file| file.ends_with("meta.ron")));
    assert_eq!(
        error.line_column().map(|(line, _)| line),
        Some(2),
        "{error}"
    );
}

#[test]
fn a_file_is_written_completely_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let line = Trajectory::new(
        vec![0.0, 0.1],
        vec![Vector3::zeros(), Vector3::new(0.1, -0.0, 1e-20)],
    )
    .unwrap();
    let path = folder.path().join("out.csv");
    assert!(write(&path, &line).unwrap().is_empty());
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "t_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0.1,-0,1e-20\n"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(
        !write(folder.path().join("out.tum"), &line)
            .unwrap()
            .is_empty()
    );
    assert!(write(folder.path().join("missing/out.csv"), &line).is_err());
    assert!(write(folder.path().join("out.bin"), &line).is_err());
    assert!(
        read(
            Path::new("/dev/null").with_extension("csv"),
            LengthUnit::Metre
        )
        .is_err()
    );
}

#[test]
fn commanded_speeds_in_other_units_are_read_in_radians_per_second() {
    let folder = tempfile::tempdir().unwrap();
    let motion = |name: &str, header: &str, value: f64| {
        let rows = (0..4).map(|k| format!("{},{},0,{value}\n", 0.1 * f64::from(k), k));
        let file = folder.path().join(name);
        std::fs::write(
            &file,
            format!("t_s,x_m,y_m,{header}\n{}", rows.collect::<String>()),
        )
        .unwrap();
        read(&file, Reading::default()).unwrap()
    };
    let radians = motion("a.csv", "left_command_rad_s", std::f64::consts::TAU);
    let turns = motion("b.csv", "left_command_rpm", 60.0);
    let degrees = motion("c.csv", "left_command_deg_s", 360.0);
    let speed = |of: &realgap_path::trajectory::Recording| {
        let signal = of.trajectory.signal("left_command_rad_s").unwrap();
        assert!(of.warnings.iter().all(|w| !w.message.contains("left")));
        signal.values[2]
    };
    let all = [&radians, &turns, &degrees].map(speed);
    assert!(
        all.iter()
            .all(|value| (value - std::f64::consts::TAU).abs() < 1e-12),
        "{all:?}"
    );
}
