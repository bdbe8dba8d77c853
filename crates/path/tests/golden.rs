//! All metrics agree with independent libraries (tests/golden/README.md) to a relative tolerance of 1e-6.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // a test may fail loudly

use crate::common;

use std::path::PathBuf;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::unit::LengthUnit;
use realgap_path::comparison::{Components, Row, compare_all};
use realgap_path::trajectory::{Recording, Trajectory, read, read_groups};
use serde_json::Value;

const RELATIVE: f64 = 1e-6;
/// Values below this count as zero: the reference libraries leave rounding errors of about 1e-16.
const ZERO: f64 = 1e-12;

fn golden_folder() -> PathBuf {
    common::golden()
}

/// Compares the table with the reference values; returns the largest relative deviation.
fn check(table: &str, rows: &[Row], name: impl Fn(&str) -> String) -> f64 {
    let text = std::fs::read_to_string(golden_folder().join(table)).unwrap();
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let expected: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), expected.len());
    let mut worst: (f64, String) = (0.0, String::new());
    for (row, expected) in rows.iter().zip(expected) {
        let json = serde_json::to_value(row).unwrap();
        let Value::Object(fields) = &json else {
            panic!("a row is an object");
        };
        // A metric that the reference libraries do not have is skipped.
        let unknown: Vec<&&str> = columns
            .iter()
            .filter(|c| !fields.contains_key(**c))
            .collect();
        assert!(unknown.is_empty(), "{unknown:?}");
        for (column, text) in columns.iter().zip(expected) {
            let place = format!("{table}: {} {column}", row.trajectory);
            match &fields[*column] {
                Value::String(found) => assert_eq!(name(found), text, "{place}"),
                found => {
                    let (found, expected) = (found.as_f64().unwrap(), text.parse::<f64>().unwrap());
                    if expected.abs() <= ZERO {
                        assert!(found.abs() <= ZERO, "{place}: {found:e} should be 0");
                    } else {
                        let relative = (found / expected - 1.0).abs();
                        assert!(
                            relative <= RELATIVE,
                            "{place}: {found} should be {expected}"
                        );
                        if relative > worst.0 {
                            worst = (relative, place);
                        }
                    }
                }
            }
        }
    }
    println!(
        "{table}: largest relative deviation {:.1e} ({})",
        worst.0, worst.1
    );
    worst.0
}

const CURVES: [&str; 9] = [
    "real",
    "scaled",
    "turned",
    "warped",
    "smooth",
    "coarse",
    "far",
    "fewer_than_182",
    "spin",
];
const TURNED: usize = 2;

fn curves() -> Vec<Recording> {
    let folder = golden_folder().join("curves");
    CURVES
        .map(|name| read(folder.join(format!("{name}.csv")), LengthUnit::Metre).unwrap())
        .to_vec()
}

/// `real` turned by 0.7 rad and shifted by (0.3, -0.2) m: the content of `turned.csv` before it was rounded to 12 decimals.
fn turned_exactly(real: &Trajectory) -> Trajectory {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
    let shift_m = Vector3::new(0.3, -0.2, 0.0);
    let positions = real.positions_world_m().iter();
    Trajectory::new(
        real.times_s().to_vec(),
        positions.map(|p| turn * p + shift_m).collect(),
    )
    .unwrap()
    .planar()
}

/// The reference values of `turned` (about 1e-16) were computed before the curves were rounded to 12 decimals. No program can reproduce
/// them from the rounded file, because distances from the start differ by 1.3e-12 m between the two files. So this
/// table uses the unrounded curve; the next test checks the rounded file.
#[test]
fn analytic_curves_agree_with_the_reference_libraries() {
    let mut curves = curves();
    let exact = turned_exactly(&curves[0].trajectory);
    for (p, q) in exact
        .positions_world_m()
        .iter()
        .zip(curves[TURNED].trajectory.positions_world_m())
    {
        // `real` is rounded too, and its rounding error is turned: half a unit times 1 + cos 0.7 + sin 0.7.
        assert!((p - q).amax() <= 1.21e-12, "turned.csv is this very curve");
    }
    curves[TURNED].trajectory = exact;
    // The reference is listed twice and must be used once.
    let rows = compare_all(&curves[0], &curves, Components::default()).unwrap();
    check("curves.csv", &rows, str::to_owned);
    let warned = rows.iter().flat_map(|row| &row.warnings);
    assert_eq!(
        warned
            .filter(|w| w.code.name() == "undefined-heading")
            .count(),
        0
    );
}

#[test]
fn the_turned_curve_differs_only_by_the_rounding_of_its_file() {
    let curves = curves();
    let row = &compare_all(&curves[0], &curves, Components::default()).unwrap()[TURNED];
    // The bound is half a unit of the 12th decimal in x and y, for a point and for the start, in both files.
    let point_m = 4.0 * 0.5e-12 * 2.0_f64.sqrt();
    for column in ["rms_m", "hausdorff_m", "discrete_frechet_m"] {
        let value_m = row.distance(column).unwrap();
        assert!(value_m <= point_m, "{column}: {value_m:e}");
    }
    assert!(row.distance("dtw_sum_m").unwrap() <= 182.0 * point_m);
    // These metrics average over the rounding errors, so they satisfy the strict bound.
    assert!(row.pca_4_coefficients_m <= ZERO);
    for column in [
        "pca_coefficients_m",
        "pca_cluster_m",
        "displacement_error_m",
        "umeyama_ape_rmse_m",
    ] {
        let value_m = row.distance(column).unwrap();
        assert!(value_m <= ZERO, "{column}: {value_m:e}");
    }
}

#[test]
fn recorded_runs_agree_with_the_reference_libraries() {
    let Some(folder) = common::shared_data("two_wheel_runs") else {
        return;
    };
    let path = folder.join("runs.csv");
    let all = read_groups(&path, LengthUnit::Metre, &["condition", "run"]).unwrap();
    assert_eq!(all.len(), 74);
    let us1: Vec<Recording> = all
        .into_iter()
        .filter(|recording| recording.name.starts_with("runs/us1/"))
        .collect();
    let rows = compare_all(&us1[0], &us1, Components::default()).unwrap();
    check("two_wheel_us1.csv", &rows, |name| {
        name.trim_start_matches("runs/").to_owned()
    });
}
