//! Tests of the Bayes filter over distances against closed forms, and of its errors.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap_core::random::Numbered;
use realgap_sensing::belief::{Belief, BeliefOptions, BeliefReport};
use realgap_sensing::range::{Beam, RangeSensor, sensor_by_name};

/// After ten readings, the standard deviation of the belief is σ(d) / (0.9582 √10).
#[test]
fn the_belief_after_ten_readings_has_the_standard_deviation_of_the_closed_form() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let options = BeliefOptions {
        distances: vec![2.0, 20.0],
        ..BeliefOptions::default()
    };
    let found = BeliefReport::new(&ultrasonic, None, &options).unwrap();
    for (side, expected) in found.distances.iter().zip([0.17, 0.22]) {
        let set = &side.simulated;
        assert!(
            (set.belief_sd - expected).abs() < 0.01,
            "{}: {}",
            side.distance,
            set.belief_sd
        );
        assert!((side.kalman_sd.unwrap() - expected).abs() < 0.01);
        assert!((0.82..=0.97).contains(&set.held), "{}", set.held);
        assert!((set.mean.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn beliefs_from_a_log_of_the_same_sensor_overlap_and_those_of_another_sensor_do_not() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let log = |shift: f64| {
        let mut text = String::from("distance_cm,reading_cm\n");
        let mut rng = Numbered::SensorReading.generator(99, 0);
        for _ in 0..2000 {
            text += &format!(
                "20,{}\n",
                shift + ultrasonic.draw(&Beam::straight(0.2), &mut rng).unwrap()
            );
        }
        realgap_sensing::range::ReadingLog::parse("log.csv", &text).unwrap()
    };
    let overlap = |shift: f64| {
        let options = BeliefOptions {
            distances: vec![20.0],
            ..BeliefOptions::default()
        };
        BeliefReport::new(&ultrasonic, Some(&log(shift)), &options)
            .unwrap()
            .distances[0]
            .overlap
            .unwrap()
    };
    assert!(overlap(0.0) > 0.9, "{}", overlap(0.0));
    assert!(overlap(0.5) < 0.6, "{}", overlap(0.5));
    let mut wrong = log(0.0);
    wrong.distance_unit = realgap_core::unit::LengthUnit::Metre;
    let options = BeliefOptions {
        distances: vec![20.0],
        ..BeliefOptions::default()
    };
    let error = BeliefReport::new(&ultrasonic, Some(&wrong), &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("different units"), "{error}");
}

#[test]
fn a_belief_survives_impossible_readings_and_follows_a_motion() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let mut belief = Belief::uniform(0.01, 0.21, 201);
    // The product of these densities is far below the smallest floating-point number.
    for _ in 0..5000 {
        belief.observe(&ultrasonic, 3.0e3);
    }
    let sum: f64 = belief.probabilities().iter().sum();
    assert!((sum - 1.0).abs() < 1e-9 && belief.restarts() == 0);
    belief.observe(&ultrasonic, f64::INFINITY);
    assert_eq!(belief.restarts(), 1);
    assert!(
        belief
            .probabilities()
            .iter()
            .all(|p| (p - 1.0 / 201.0).abs() < 1e-12)
    );
    let options = BeliefOptions {
        distances: vec![20.0],
        approach: 1.0,
        approach_sd: 0.1,
        ..BeliefOptions::default()
    };
    let found = BeliefReport::new(&ultrasonic, None, &options).unwrap();
    let side = &found.distances[0];
    assert!((side.distance - 11.0).abs() < 1e-9);
    assert!(
        side.simulated.bias.abs() < 0.1 && side.simulated.belief_sd < 0.35,
        "{:?}",
        side.simulated.bias
    );
}

/// Figure 6a of paper 000: the sensor resolves distances that differ by thousandths of a cell. The belief must not depend on where the
/// true distance is between the middles of cells, or on the number of cells.
#[test]
fn the_belief_of_a_sensor_that_resolves_less_than_a_cell_has_the_right_width() {
    let infrared = sensor_by_name("infrared").unwrap();
    for cells in [21, 401] {
        let options = BeliefOptions {
            distances: vec![1.1, 2.0, 2.037, 15.0],
            cells,
            trials: 500,
            ..BeliefOptions::default()
        };
        let found = BeliefReport::new(&infrared, None, &options).unwrap();
        for side in &found.distances {
            let set = &side.simulated;
            // The standard deviation of a reading divided by the slope of the mean, for ten readings.
            let d = 0.01 * side.distance;
            let slope = (infrared.mean(&Beam::straight(d + 1e-6))
                - infrared.mean(&Beam::straight(d - 1e-6)))
                / 2e-4;
            let expected = (infrared.sd(&Beam::straight(d)) / slope).abs() / 10f64.sqrt();
            assert!(
                (0.86..=0.945).contains(&set.held),
                "{cells} cells, {}: {}",
                side.distance,
                set.held
            );
            let ratio = set.belief_sd / expected;
            assert!(
                (0.8..1.2).contains(&ratio),
                "{cells} cells, {}: {ratio}",
                side.distance
            );
            assert!(
                set.bias.abs() < 0.5 * expected,
                "{}: {}",
                side.distance,
                set.bias
            );
        }
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
}

#[test]
fn a_distance_outside_of_the_sensors_range_is_on_the_grid_and_gives_a_warning() {
    let mut maker = sensor_by_name("infrared").unwrap();
    maker.range = (4.0, 30.0);
    let options = BeliefOptions {
        distances: vec![2.0],
        ..BeliefOptions::default()
    };
    let found = BeliefReport::new(&maker, None, &options).unwrap();
    let set = &found.distances[0].simulated;
    assert!(set.held > 0.8 && set.bias.abs() < 0.01, "{set:?}");
    assert_eq!(found.warnings[0].code.name(), "extrapolated");
}
