//! The metric `pca-whitened` agrees with a reference; `displacement` and `shape` separate fitness from shape.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::f64::consts::PI;

use realgap_path::comparison::{Context, Pair, Spread, by_name};
use realgap_path::trajectory::{POINTS, Prepared};

/// The path with this number, as in tools/golden_whitened.py.
fn path(number: usize, scale: f64) -> Prepared {
    let k = number as f64;
    let xy_m = (0..POINTS).map(|index| {
        let t = index as f64 / (POINTS - 1) as f64;
        let wave = (2.0 * PI * t * (1 + number % 3) as f64).sin();
        let x = (0.5 + 0.03 * (1.7 * k).sin()) * t + 0.01 * wave;
        let y = 0.02 * (2.3 * k).cos() * (PI * t).sin() + 0.004 * k * t * (1.0 - t);
        [scale * x, scale * y]
    });
    Prepared::from_xy_m(xy_m.collect()).unwrap()
}

#[test]
fn whitened_distances_agree_with_a_dense_inverse_of_the_shrunk_covariance() {
    let golden = common::golden().join("whitened.json");
    let golden: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(golden).unwrap()).unwrap();
    for row in golden.as_array().unwrap() {
        let count = row["recordings"].as_u64().unwrap() as usize;
        let real: Vec<Prepared> = (0..count).map(|k| path(k, 1.0)).collect();
        let spread = Spread::of(&real.iter().collect::<Vec<_>>()).unwrap();
        let is_near = |value: f64, name: &str| {
            let expected = row[name].as_f64().unwrap();
            assert!(
                (value - expected).abs() <= 1e-6 * expected,
                "{count} recordings, {name}: {value}, {expected}"
            );
        };
        is_near(spread.shrinkage(), "shrinkage");
        is_near(spread.distance(&real[0], &path(100, 1.2)), "distance");
        is_near(spread.distance(&real[0], &real[1]), "between_recordings");
    }
}

#[test]
fn the_mean_square_distance_of_two_recordings_is_one_in_any_unit_of_length() {
    let real: Vec<Prepared> = (0..6).map(|k| path(k, 1.0)).collect();
    let spread = Spread::of(&real.iter().collect::<Vec<_>>()).unwrap();
    let mut squares = Vec::new();
    for (index, a) in real.iter().enumerate() {
        squares.extend(real[..index].iter().map(|b| spread.distance(a, b).powi(2)));
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!((mean - 1.0).abs() < 1e-9, "{mean}");
    let longer = spread.scaled(2.0).distance(&path(0, 2.0), &path(9, 2.0));
    let before = spread.distance(&path(0, 1.0), &path(9, 1.0));
    assert!((longer - before).abs() < 1e-9 * before);
}

#[test]
fn one_recording_has_no_spread() {
    let one = path(1, 1.0);
    for recordings in [vec![&one], vec![&one, &one]] {
        let error = Spread::of(&recordings).unwrap_err().to_string();
        assert!(error.contains("repeats"), "{error}");
    }
}

/// 182 points of a path in the unit interval of time.
fn prepared(at: impl Fn(f64) -> [f64; 2]) -> Prepared {
    let points = (0..POINTS).map(|index| at(index as f64 / (POINTS - 1) as f64));
    Prepared::from_xy_m(points.collect()).unwrap()
}

#[test]
fn fitness_and_shape_are_separated() {
    let bow = |length: f64, height: f64| prepared(move |t| [length * t, height * (PI * t).sin()]);
    let distance = |metric: &str, a: &Prepared, b: &Prepared| {
        // Metrics of positions use only the prepared paths.
        let motion = realgap_path::trajectory::Trajectory::new(
            vec![0.0, 1.0],
            vec![nalgebra::Vector3::zeros(), nalgebra::Vector3::x()],
        )
        .unwrap();
        let pair = Pair::new((&motion, a), (&motion, b));
        let metric = by_name(metric).unwrap();
        metric.compare(&pair, &Context::default()).unwrap().value
    };
    // `bent` goes as far as `flat` with another shape; `far` goes twice as far with the same shape.
    let (flat, bent, far) = (bow(1.0, 0.0), bow(1.0, 0.2), bow(2.0, 0.2));
    assert!(distance("displacement", &flat, &bent) < 1e-12);
    let expected = 0.2 * (0.5 * (POINTS - 1) as f64 / POINTS as f64).sqrt();
    assert!((distance("shape", &flat, &bent) - expected).abs() < 1e-12);
    assert!((distance("displacement", &bent, &far) - 1.0).abs() < 1e-12);
    assert!(distance("shape", &bent, &far) < 1e-12);
}
