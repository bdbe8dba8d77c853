//! Preparation removes start position, heading and sampling rate from a trajectory, and keeps the shape of its path.
#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use realgap_path::trajectory::{
    Alignment, POINTS, Prepared, Trajectory, prepare, prepare_as, resample,
};

fn trajectory(times_s: Vec<f64>, points: &[[f64; 2]]) -> Trajectory {
    let positions = points.iter().map(|p| Vector3::new(p[0], p[1], 0.0));
    Trajectory::new(times_s, positions.collect()).unwrap()
}

fn uniform(points: &[[f64; 2]]) -> Trajectory {
    trajectory((0..points.len()).map(|i| i as f64).collect(), points)
}

fn turned(points: &[[f64; 2]], angle: f64, shift: [f64; 2]) -> Vec<[f64; 2]> {
    let (sin, cos) = angle.sin_cos();
    let turn = |p: &[f64; 2]| {
        [
            cos * p[0] - sin * p[1] + shift[0],
            sin * p[0] + cos * p[1] + shift[1],
        ]
    };
    points.iter().map(turn).collect()
}

fn farthest(a: &Prepared, b: &Prepared) -> f64 {
    let pairs = a.xy_m().iter().zip(b.xy_m());
    pairs.fold(0.0, |m, (p, q)| m.max((p[0] - q[0]).hypot(p[1] - q[1])))
}

fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 2..40)
}

fn has_heading(prepared: &Prepared) -> bool {
    prepared.warnings().is_empty() && prepared.net_displacement_m() > 0.05
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_prepared_path_starts_at_the_origin_and_ends_on_the_x_axis(points in points()) {
        let prepared = prepare(&uniform(&points)).unwrap();
        prop_assume!(has_heading(&prepared));
        prop_assert_eq!(prepared.xy_m().len(), POINTS);
        prop_assert_eq!(prepared.xy_m()[0], [0.0, 0.0]);
        let end = prepared.xy_m()[POINTS - 1];
        prop_assert!((end[0] - prepared.net_displacement_m()).abs() < 1e-12 && end[1].abs() < 1e-12);
    }

    #[test]
    fn position_and_heading_do_not_matter(
        points in points(),
        angle in -PI..PI,
        shift in prop::array::uniform2(-10.0..10.0_f64),
    ) {
        let here = prepare(&uniform(&points)).unwrap();
        prop_assume!(has_heading(&here));
        let there = prepare(&uniform(&turned(&points, angle, shift))).unwrap();
        prop_assert!(farthest(&here, &there) < 1e-10);
        let turn = there.heading_rad() - here.heading_rad() - angle;
        prop_assert!((turn / (2.0 * PI) - (turn / (2.0 * PI)).round()).abs() < 1e-10);
    }

    #[test]
    fn position_and_heading_do_not_matter_without_net_displacement(
        points in points(),
        angle in -PI..PI,
    ) {
        // The path returns to its start; the way back is shorter in time, so the path is not its own mirror image.
        let mut closed = points.clone();
        closed.push([2.0, 0.3]);
        closed.push(points[0]);
        let here = prepare(&uniform(&closed)).unwrap();
        prop_assert_eq!(here.warnings()[0].code.name(), "undefined-heading");
        let there = prepare(&uniform(&turned(&closed, angle, [0.0, 0.0]))).unwrap();
        prop_assert!(farthest(&here, &there) < 1e-6);
    }

    #[test]
    fn the_sampling_rate_does_not_matter(points in points(), factor in 2_usize..6) {
        let coarse = uniform(&points);
        // The fine trajectory has more samples on the same segments.
        let fine = resample(&coarse, (points.len() - 1) * factor + 1).unwrap();
        prop_assert!(farthest(&prepare(&coarse).unwrap(), &prepare(&fine).unwrap()) < 1e-9
            || !has_heading(&prepare(&coarse).unwrap()));
    }

    #[test]
    fn preparing_a_prepared_path_changes_nothing(points in points()) {
        let once = prepare(&uniform(&points)).unwrap();
        prop_assume!(has_heading(&once));
        let twice = prepare(&uniform(once.xy_m())).unwrap();
        prop_assert!(farthest(&once, &twice) < 1e-10);
        let back = Prepared::from_xy_m(once.xy_m().to_vec()).unwrap();
        prop_assert_eq!(back.xy_m(), once.xy_m());
        prop_assert_eq!(back.net_displacement_m(), once.net_displacement_m());
    }
}

#[test]
fn a_motionless_trajectory_stays_at_the_origin_with_a_warning() {
    let prepared = prepare(&uniform(&[[3.0, 4.0]; 5])).unwrap();
    assert!(prepared.xy_m().iter().all(|p| *p == [0.0, 0.0]));
    assert_eq!(prepared.heading_rad(), 0.0);
    assert_eq!(prepared.warnings()[0].code.name(), "undefined-heading");
}

#[test]
fn below_a_millimetre_or_one_percent_of_the_length_the_heading_is_undefined() {
    let warned = |points: &[[f64; 2]]| !prepare(&uniform(points)).unwrap().warnings().is_empty();
    assert!(warned(&[[0.0, 0.0], [0.0009, 0.0]]));
    assert!(!warned(&[[0.0, 0.0], [0.0011, 0.0]]));
    assert!(warned(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.019]]));
    assert!(!warned(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.021]]));
}

#[test]
fn a_circle_points_from_its_start_to_its_centre() {
    for start in [0.0, 1.0, 4.0] {
        let circle: Vec<[f64; 2]> = (0..POINTS)
            .map(|i| {
                let angle = start + 2.0 * PI * i as f64 / (POINTS - 1) as f64;
                [angle.cos(), angle.sin()]
            })
            .collect();
        let prepared = prepare(&uniform(&circle)).unwrap();
        let x: f64 = prepared.xy_m().iter().map(|p| p[0]).sum();
        assert!(x / POINTS as f64 > 0.9);
    }
}

#[test]
fn orientation_turns_with_the_path() {
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.2);
    let line = Trajectory::new(vec![0.0, 1.0], vec![Vector3::zeros(), yaw * Vector3::x()])
        .unwrap()
        .with_orientations(vec![yaw; 2])
        .unwrap();
    let prepared = prepare(&line).unwrap();
    assert!(
        prepared
            .orientations()
            .unwrap()
            .iter()
            .all(|q| q.angle() < 1e-12)
    );
    assert_eq!(prepared.z_m().map(<[f64]>::len), Some(POINTS));
}

#[test]
fn extreme_numbers_are_refused() {
    for end in [1e13, 1e300] {
        assert!(prepare(&uniform(&[[0.0, 0.0], [end, -end]])).is_err());
    }
    assert!(prepare(&trajectory(vec![-1e308, 1e308], &[[0.0, 0.0], [1.0, 0.0]])).is_err());
    assert!(Prepared::from_xy_m(vec![[0.0, f64::NAN]; POINTS]).is_err());
    assert!(Prepared::from_xy_m(vec![[0.0, 0.0]; 3]).is_err());
}

#[test]
fn directions_in_the_world_stay_where_the_alignment_says_so() {
    let [uphill, downhill] = [1.0, -1.0].map(|end| uniform(&[[0.0, 0.0], [end, 0.0]]));
    // Turned to their own net displacement both are one path; in the world they lead apart.
    assert_eq!(prepare(&uphill).unwrap().xy_m()[181], [1.0, 0.0]);
    assert_eq!(prepare(&downhill).unwrap().xy_m()[181], [1.0, 0.0]);
    let in_world = |path: &Trajectory| prepare_as(path, Alignment::World).unwrap();
    assert_eq!(in_world(&downhill).xy_m()[181], [-1.0, 0.0]);
    assert_eq!(in_world(&downhill).heading_rad(), 0.0);
    assert_eq!(in_world(&downhill).alignment(), Alignment::World);
    // Without orientations there is no start heading, and the error says what to do.
    let error = prepare_as(&uphill, Alignment::StartHeading).unwrap_err();
    assert!(error.to_string().contains("align: World"), "{error}");
    // A body that looks along +y and moves along +x goes to its right.
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let sideways = uphill.with_orientations(vec![quarter; 2]).unwrap();
    let own = prepare_as(&sideways, Alignment::StartHeading).unwrap();
    let [x, y] = own.xy_m()[181];
    assert!(x.abs() < 1e-12 && (y + 1.0).abs() < 1e-12, "{x} {y}");
    assert!((own.heading_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}
