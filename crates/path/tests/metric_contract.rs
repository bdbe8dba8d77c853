//! The contract of metrics, checked for every metric in the registry.
#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use realgap_core::unit::Unit;
use realgap_path::comparison::{
    Association, Basis, Components, Context, DEFAULT_METRIC, METRICS, Metric, Pair, Spread, Timing,
    by_name, compare, compare_in_time, pose_errors,
};
use realgap_path::trajectory::{JointTrack, Trajectory, prepare};

/// A smooth path in space with orientations, given by five numbers.
fn path(shape: [f64; 5], points: usize) -> Trajectory {
    let [a, b, c, d, e] = shape;
    let at = |index: usize| 4.0 * index as f64 / (points - 1) as f64;
    let positions = (0..points).map(|i| {
        let t = at(i);
        Vector3::new(
            0.2 * t + 0.1 * a * (2.0 * t).sin(),
            0.2 * b * (1.5 * t + c).sin(),
            0.1 + 0.05 * d * t.cos(),
        )
    });
    let turns = (0..points).map(|i| {
        UnitQuaternion::from_euler_angles(0.3 * e * at(i).sin(), 0.2 * a, 0.5 * b * at(i))
    });
    Trajectory::new((0..points).map(at).collect(), positions.collect())
        .unwrap()
        .with_orientations(turns.collect())
        .unwrap()
        .with_joints(vec![JointTrack {
            name: "elbow".to_owned(),
            angles_rad: (0..points).map(|i| a * (b * at(i)).sin()).collect(),
            speeds_rad_s: None,
        }])
        .unwrap()
}

fn moved(trajectory: &Trajectory, angle_rad: f64, shift_m: Vector3<f64>) -> Trajectory {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_rad);
    let positions = trajectory.positions_world_m().iter();
    let orientations = trajectory.orientations_world_from_body().unwrap().iter();
    Trajectory::new(
        trajectory.times_s().to_vec(),
        positions.map(|p| turn * p + shift_m).collect(),
    )
    .unwrap()
    .with_orientations(orientations.map(|q| turn * q).collect())
    .unwrap()
    .with_joints(trajectory.joints().to_vec())
    .unwrap()
}

fn score(metric: &dyn Metric, real: &Trajectory, simulated: &Trajectory) -> f64 {
    let (real_prepared, simulated_prepared) = (prepare(real).unwrap(), prepare(simulated).unwrap());
    let third = prepare(&path([0.3, -0.7, 0.2, 1.0, 0.1], 90)).unwrap();
    let basis = Basis::fit(
        &[&real_prepared, &simulated_prepared, &third],
        Components::default(),
    )
    .unwrap();
    let spread = Spread::of(&[&real_prepared, &simulated_prepared, &third]).unwrap();
    let context = Context {
        basis: Some(&basis),
        spread: Some(&spread),
        body_length_m: Some(0.1),
        channels: None,
    };
    let pair = Pair::new((real, &real_prepared), (simulated, &simulated_prepared));
    let score = metric.compare(&pair, &context).unwrap();
    assert_eq!(score.unit, metric.unit());
    assert!(score.samples > 0, "{}", metric.name());
    score.value
}

/// The score over the nearest samples, for the metrics that have one.
fn nearest_score(metric: &dyn Metric, real: &Trajectory, simulated: &Trajectory) -> Option<f64> {
    let of_samples = metric.is_of_samples();
    let score = || compare_in_time(real, simulated, metric.name(), &Timing::default()).unwrap();
    of_samples.then(|| score().value)
}

/// The score over interpolated samples, for the metrics that have one.
fn sample_score(metric: &dyn Metric, real: &Trajectory, simulated: &Trajectory) -> Option<f64> {
    if !metric.is_of_samples() {
        return None;
    }
    let timing = Timing {
        association: Association::Interpolated,
        ..Timing::default()
    };
    let score = compare_in_time(real, simulated, metric.name(), &timing).unwrap();
    assert_eq!(score.unit, metric.unit());
    Some(score.value)
}

fn shape() -> impl Strategy<Value = [f64; 5]> {
    prop::array::uniform5(-1.0..1.0_f64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_metric_is_finite_not_negative_and_zero_for_equal_trajectories(a in shape(), b in shape()) {
        let (a, b) = (path(a, 120), path(b, 75));
        for metric in METRICS {
            let distance = score(*metric, &a, &b);
            prop_assert!(distance.is_finite() && distance >= 0.0, "{} {distance}", metric.name());
            prop_assert!(score(*metric, &a, &a) <= 1e-7, "{}", metric.name());
            if let Some(distance) = sample_score(*metric, &a, &b) {
                prop_assert!(distance.is_finite() && distance >= 0.0, "{} {distance}", metric.name());
                prop_assert!(sample_score(*metric, &a, &a) <= Some(1e-7), "{}", metric.name());
            }
        }
    }

    #[test]
    fn symmetric_metrics_do_not_depend_on_the_order_of_the_trajectories(a in shape(), b in shape()) {
        let (a, b) = (path(a, 120), path(b, 75));
        for metric in METRICS.iter().filter(|metric| metric.is_symmetric()) {
            let (there, back) = (score(*metric, &a, &b), score(*metric, &b, &a));
            prop_assert!((there - back).abs() <= 1e-9 * (1.0 + there), "{}", metric.name());
            let (there, back) = (nearest_score(*metric, &a, &b), nearest_score(*metric, &b, &a));
            if let (Some(there), Some(back)) = (there, back) {
                prop_assert!((there - back).abs() <= 1e-9 * (1.0 + there), "{}", metric.name());
            }
        }
    }

    #[test]
    fn turning_and_shifting_both_changes_nothing(
        a in shape(),
        b in shape(),
        angle in -PI..PI,
        shift in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let (a, b) = (path(a, 120), path(b, 75));
        let shift = Vector3::from(shift);
        for metric in METRICS {
            let here = score(*metric, &a, &b);
            let there = score(*metric, &moved(&a, angle, shift), &moved(&b, angle, shift));
            prop_assert!((here - there).abs() <= 1e-8 * (1.0 + here), "{} {here} {there}", metric.name());
            let (a, b) = (&a, &b);
            if let (Some(here), Some(there)) = (
                sample_score(*metric, a, b),
                sample_score(*metric, &moved(a, angle, shift), &moved(b, angle, shift)),
            ) {
                prop_assert!((here - there).abs() <= 1e-8 * (1.0 + here), "{} {here} {there}", metric.name());
            }
        }
    }

    #[test]
    fn with_all_components_pca_is_the_root_mean_square_distance(a in shape(), b in shape(), c in shape()) {
        let prepared = [a, b, c].map(|shape| prepare(&path(shape, 120)).unwrap());
        let basis = Basis::fit(&prepared.each_ref(), Components::Count(usize::MAX)).unwrap();
        let (a, b) = (path(a, 120), path(b, 120));
        let rms = score(by_name("rms").unwrap(), &a, &b);
        let pca = basis.discrepancy_m(&prepared[0], &prepared[1]);
        prop_assert!((rms - pca).abs() <= 1e-12 + 1e-9 * rms, "{rms} {pca}");
        let shares: f64 = basis.shares(&prepared[0], &prepared[1]).iter().sum();
        prop_assert!((shares - 1.0).abs() <= 1e-9);
        let ratio: f64 = basis.explained_variance_ratio().iter().sum();
        prop_assert!((ratio - 1.0).abs() <= 1e-9);
    }
}

#[test]
fn names_and_columns_are_unique_and_units_are_in_the_columns() {
    for (index, metric) in METRICS.iter().enumerate() {
        assert!(!metric.doc().is_empty());
        let ending = match metric.unit() {
            Unit::One => String::new(),
            unit => format!("_{}", unit.symbol()),
        };
        assert!(metric.column().ends_with(&ending), "{}", metric.column());
        for other in &METRICS[index + 1..] {
            assert_ne!(metric.name(), other.name());
            assert_ne!(metric.column(), other.column());
        }
    }
    assert_eq!(METRICS[0].name(), DEFAULT_METRIC);
}

#[test]
fn an_unknown_metric_is_refused_with_the_list_of_known_metrics() {
    let Err(error) = by_name("euclid") else {
        panic!("there is no such metric");
    };
    for metric in METRICS {
        assert!(error.to_string().contains(metric.name()));
    }
}

#[test]
fn a_metric_without_the_data_that_it_needs_gives_an_error() {
    let line = Trajectory::new(vec![0.0, 1.0], vec![Vector3::zeros(), Vector3::x()]).unwrap();
    let prepared = prepare(&line).unwrap();
    let pair = Pair::new((&line, &prepared), (&line, &prepared));
    let missing = |name: &str| {
        let context = Context::default();
        by_name(name).unwrap().compare(&pair, &context).unwrap_err()
    };
    assert!(missing("pca").message().contains("basis"));
    assert!(missing("rotation").message().contains("orientations"));
    assert!(missing("pose").message().contains("body length"));
}

#[test]
fn one_call_gives_the_distance_by_every_metric_that_needs_two_trajectories_only() {
    let (a, b) = (path([0.2, 0.4, -0.3, 0.1, 0.5], 120), path([0.1; 5], 75));
    let mut compared = 0;
    for metric in METRICS {
        let needs = metric.needs();
        if needs.spread || needs.body_length {
            let error = compare(&a, &b, metric.name()).unwrap_err();
            assert!(error.message().contains(metric.name()), "{error}");
            continue;
        }
        let distance = compare(&a, &b, metric.name()).unwrap();
        assert_eq!(distance.unit, metric.unit());
        assert!(distance.value > 0.0, "{}", metric.name());
        assert!(compare(&a, &a, metric.name()).unwrap().value <= 1e-7);
        if !needs.basis {
            assert_eq!(distance.value, score(*metric, &a, &b), "{}", metric.name());
        }
        compared += 1;
    }
    assert!(compared >= 10, "{compared}");
    let error = compare(&a, &b, "euclid").unwrap_err();
    assert!(error.to_string().contains("rms"), "{error}");
}

#[test]
fn motionless_trajectories_are_compared_without_nan() {
    let still = Trajectory::new(vec![0.0, 1.0, 2.0], vec![Vector3::new(1.0, 2.0, 3.0); 3])
        .unwrap()
        .with_orientations(vec![UnitQuaternion::identity(); 3])
        .unwrap()
        .with_joints(vec![JointTrack {
            name: "elbow".to_owned(),
            angles_rad: vec![0.5; 3],
            speeds_rad_s: None,
        }])
        .unwrap();
    for metric in METRICS {
        assert_eq!(score(*metric, &still, &still), 0.0, "{}", metric.name());
        assert!(score(*metric, &still, &path([0.1; 5], 50)).is_finite());
    }
}

#[test]
fn a_saved_basis_gives_the_same_numbers() {
    let prepared = [[0.1; 5], [0.5; 5], [-0.7, 0.2, 0.9, 0.0, 0.3]]
        .map(|shape| prepare(&path(shape, 120)).unwrap());
    let basis = Basis::fit(&prepared.each_ref(), Components::Count(1)).unwrap();
    let text = serde_json::to_string(&basis).unwrap();
    let back: Basis = serde_json::from_str(&text).unwrap();
    assert_eq!(back.kept(), 1);
    assert_eq!(
        back.discrepancy_m(&prepared[0], &prepared[1]),
        basis.discrepancy_m(&prepared[0], &prepared[1])
    );
    assert_eq!(
        back.coefficients_m(&prepared[2]),
        basis.coefficients_m(&prepared[2])
    );
    assert!(back.keeping(Components::Count(2)).is_err());
    assert_eq!(basis.keeping(Components::Count(9)).unwrap().kept(), 2);
    assert!(
        serde_json::from_str::<Basis>(&text.replacen("\"mean_m\":[", "\"mean_m\":[0.0,", 1))
            .is_err()
    );
}

#[test]
fn an_invalid_choice_of_components_is_refused() {
    let prepared = prepare(&path([0.1; 5], 50)).unwrap();
    for choice in [
        Components::Count(0),
        Components::Variance(0.0),
        Components::Variance(1.5),
        Components::Variance(f64::NAN),
    ] {
        assert!(Basis::fit(&[&prepared], choice).is_err(), "{choice:?}");
    }
    assert!(Basis::fit(&[], Components::default()).is_err());
}

#[test]
fn pose_compares_at_the_recorded_times() {
    let turn = |angle: f64| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
    let along = |times: &[f64], speed: f64, spin: f64| {
        let start = times[0];
        let positions = times.iter().map(|t| Vector3::x() * speed * (t - start));
        Trajectory::new(times.to_vec(), positions.collect())
            .unwrap()
            .with_orientations(times.iter().map(|t| turn(spin * (t - start))).collect())
            .unwrap()
    };
    // The recording starts at 5 s; the simulation starts at 0 s, has another rate, and is 0.1 m/s and 0.2 rad/s too fast.
    let real = along(&[5.0, 6.0, 7.0], 1.0, 0.5);
    let simulated = along(&[0.0, 1.5, 2.0], 1.1, 0.7);
    let errors = pose_errors(&real, &simulated, 0.1).unwrap();
    assert!((errors.position_fraction_mean - 1.0).abs() < 1e-9);
    assert!((errors.position_fraction_final - 2.0).abs() < 1e-9);
    assert!((errors.rotation_rad_mean - 0.2).abs() < 1e-9);
    assert!((errors.rotation_rad_final - 0.4).abs() < 1e-9);
    assert!((errors.score() - 1.2).abs() < 1e-9);
    assert_eq!((errors.samples, errors.warnings.len()), (3, 0));
    // A simulation that ends early is compared up to its end, with a warning.
    let short = along(&[0.0, 1.0], 1.1, 0.7);
    let errors = pose_errors(&real, &short, 0.1).unwrap();
    assert_eq!(errors.samples, 2);
    assert_eq!(errors.warnings[0].code.name(), "shorter-simulation");
}
