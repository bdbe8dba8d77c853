//! The hidden parameters of stand-in tosses are identified from the flight before contact.

use nalgebra::Vector3;
use realgap_identification::{Body, LengthReading, StartState, fit_flight, identify, refine};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Start};

use super::standin::{EXACT, RATE_HZ, Tracker, cube, tosses};

const HIDDEN_M: [f64; 3] = [0.0, -0.002, 0.006];

fn heavy_bottom() -> Experiment {
    let mut robot = cube();
    robot.adjustment.centre_of_mass_offset_m = Vector3::from(HIDDEN_M);
    robot
}

#[test]
fn offset_length_scale_and_lag_are_recovered_from_noisy_recordings() {
    let tracker = Tracker {
        length_scale: 0.97,
        noise_m: 5e-5,
        noise_rad: 1e-3,
    };
    let recordings: Vec<_> = tosses(&heavy_bottom(), &tracker, 60)
        .into_iter()
        .map(|toss| toss.recording)
        .collect();
    let found = identify(&cube(), &recordings, LengthReading::LengthScale, 1).unwrap();
    assert_eq!((found.recordings, found.flying), (60, 60));
    for (interval, hidden_m) in found.centre_of_mass_recorded_m.iter().zip(HIDDEN_M) {
        let truth = 0.97 * hidden_m;
        assert!(interval.low < interval.high && interval.high - interval.low < 2e-3);
        assert!(
            (interval.value - truth).abs() < interval.high - interval.low,
            "{interval:?} {truth}"
        );
    }
    assert!(
        (found.length_scale.value - 0.97).abs() < 0.002,
        "{:?}",
        found.length_scale
    );
    assert!((found.parameters["recording.length_scale"] - 0.97).abs() < 0.002);
    assert!((found.parameters["body.com_offset_z_m"] - 0.006).abs() < 5e-4);
    assert!((found.parameters["body.com_offset_y_m"] + 0.002).abs() < 5e-4);
    let lag = found.velocity_lag_s.unwrap();
    assert!((lag.value - 0.5 / RATE_HZ).abs() < 5e-4, "{lag:?}");
    let codes: Vec<_> = found.warnings.iter().map(|w| w.code.name()).collect();
    for code in [
        "centre-of-mass-contradicted",
        "gravity-contradicted",
        "velocities-late",
    ] {
        assert!(codes.contains(&code), "{codes:?}");
    }
}

#[test]
fn the_reading_gravity_identifies_gravity_instead_of_a_length_scale() {
    let mut moon = cube();
    moon.gravity_m_s2 = 8.0;
    let recordings: Vec<_> = tosses(&moon, &EXACT, 20)
        .into_iter()
        .map(|t| t.recording)
        .collect();
    let found = identify(&cube(), &recordings, LengthReading::Gravity, 1).unwrap();
    assert!((found.parameters["gravity_m_s2"] - 8.0).abs() < 0.01);
    assert!(!found.parameters.contains_key("recording.length_scale"));
}

#[test]
fn a_correct_model_is_not_contradicted() {
    let tracker = Tracker {
        length_scale: 1.0,
        noise_m: 5e-5,
        noise_rad: 1e-3,
    };
    let recordings: Vec<_> = tosses(&heavy_bottom(), &tracker, 40)
        .into_iter()
        .map(|t| t.recording)
        .collect();
    let found = identify(&heavy_bottom(), &recordings, LengthReading::LengthScale, 1).unwrap();
    // Each 95 % interval misses the truth one time in twenty, so one warning is allowed. The estimates below must still be exact
    // to 0.5 mm.
    let wrong = found
        .warnings
        .iter()
        .filter(|w| w.code.name() == "centre-of-mass-contradicted")
        .count();
    assert!(wrong <= 1, "{:?}", found.warnings);
    assert!((found.parameters["body.com_offset_z_m"] - 0.006).abs() < 5e-4);
    assert!((found.length_scale.value - 1.0).abs() < 2e-3);
}

#[test]
fn a_start_fitted_to_the_flight_is_nearer_to_the_truth_than_the_first_sample() {
    let robot = heavy_bottom();
    let tracker = Tracker {
        length_scale: 1.0,
        noise_m: 1e-4,
        noise_rad: 3e-3,
    };
    let body = Body::new(&robot).unwrap();
    let (mut fitted, mut recorded, mut turning) = (0.0, 0.0, 0.0);
    for toss in tosses(&robot, &tracker, 30) {
        let fit = fit_flight(&body, &toss.recording.trajectory).unwrap();
        let first = toss.recording.trajectory.velocities_world_m_s().unwrap()[0];
        fitted += (fit.state.velocity_world_m_s - toss.truth.velocity_world_m_s).norm();
        recorded += (first - toss.truth.velocity_world_m_s).norm();
        turning +=
            (fit.state.angular_velocity_body_rad_s - toss.truth.angular_velocity_body_rad_s).norm();
    }
    assert!(fitted < 0.3 * recorded, "{fitted} {recorded}");
    assert!(turning / 30.0 < 0.05, "{turning}");
}

#[test]
fn the_half_sample_correction_removes_the_gravity_error_of_a_backward_difference() {
    let toss = &tosses(&cube(), &EXACT, 1)[0];
    let motion = &toss.recording.trajectory;
    let mut experiment = cube();
    let mut first = toss.truth;
    first.velocity_world_m_s = motion.velocities_world_m_s().unwrap()[0];
    experiment.start = Start::State(first);
    let (refined, _) = refine(StartState::HalfSampleCorrected, experiment.clone(), motion).unwrap();
    let Start::State(state) = refined.start else {
        panic!("{refined:?}")
    };
    let (before, after) = (
        (first.velocity_world_m_s.z - toss.truth.velocity_world_m_s.z).abs(),
        (state.velocity_world_m_s.z - toss.truth.velocity_world_m_s.z).abs(),
    );
    // The remaining error is half a substep, by which the integrator's own positions lag its velocities.
    let solver = cube().solver;
    let integrator = 9.81 * (0.5 / RATE_HZ / solver.substeps as f64) / 2.0;
    let half_sample = 9.81 * 0.5 / RATE_HZ;
    assert!(
        (before - (half_sample - integrator)).abs() < 1e-4,
        "{before}"
    );
    assert!((after - integrator).abs() < 1e-4, "{after} {integrator}");
    let (same, _) = refine(StartState::FirstSample, experiment.clone(), motion).unwrap();
    assert_eq!(same, experiment);
}

#[test]
fn recordings_without_a_flight_are_reported_and_not_used() {
    let mut all: Vec<_> = tosses(&cube(), &EXACT, 10)
        .into_iter()
        .map(|t| t.recording)
        .collect();
    // The last half second of a toss, on the floor.
    let whole = &all[0].trajectory;
    let (from, to) = (whole.len() - 20, whole.len());
    let sliding = Trajectory::new(
        whole.times_s()[from..to].to_vec(),
        whole.positions_world_m()[from..to].to_vec(),
    )
    .unwrap()
    .with_orientations(whole.orientations_world_from_body().unwrap()[from..to].to_vec())
    .unwrap();
    all[0].trajectory = sliding;
    let found = identify(&cube(), &all, LengthReading::LengthScale, 1).unwrap();
    assert_eq!((found.flying, found.grounded.len()), (9, 1));
    assert!(found.warnings.iter().any(|w| w.code.name() == "no-flight"));

    let error = identify(&cube(), &all[..1], LengthReading::LengthScale, 1)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("none of the recordings has a flight"),
        "{error}"
    );

    let walker =
        Morphology::read(crate::common::project().join("morphologies/tripod.ron")).unwrap();
    let error = identify(
        &Experiment::new(walker.assemble()),
        &all,
        LengthReading::LengthScale,
        1,
    );
    assert!(error.unwrap_err().to_string().contains("servos"));
}
