//! The contract test: properties that every form and every shipped sensor must have.

use realgap_core::random::Numbered;
use realgap_core::statistics::{Proportion, kolmogorov_smirnov, mean, standard_deviation};
use realgap_sensing::range::form::{FORMS, Point};
use realgap_sensing::range::{
    Beam, Characterisation, Options, RangeModel, RangeSensor, sensor_by_name, shipped_sensors,
};

use super::{example, log_of, model};

#[test]
fn every_form_has_correct_derivatives_and_starts_at_the_data() {
    for form in FORMS {
        let distances: Vec<f64> = (1..=21).map(f64::from).collect();
        let knots = if form.name() == "table" {
            vec![1.0, 5.0, 12.0, 21.0]
        } else {
            form.knots(&distances)
        };
        let values = example(form);
        assert_eq!(
            form.parameters(&knots).len(),
            values.len(),
            "{}",
            form.name()
        );
        for d in [1.0, 1.5, 7.3, 12.0, 20.9, 21.0] {
            let gradient = form.gradient(&knots, &values, d);
            for (index, slope) in gradient.iter().enumerate() {
                let step = 1e-6 * values[index].abs();
                let moved = |sign: f64| {
                    let mut moved = values.clone();
                    moved[index] += sign * step;
                    form.value(&knots, &moved, d)
                };
                let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                assert!(
                    (slope - difference).abs() < 1e-5 * (1.0 + slope.abs()),
                    "{} at {d}: {slope} {difference}",
                    form.name()
                );
            }
        }
        let points: Vec<Point> = distances
            .iter()
            .map(|d| Point {
                d: *d,
                y: form.value(&knots, &values, *d),
                weight: 1.0,
            })
            .collect();
        let start = form.start(&knots, &points).unwrap();
        for (found, known) in start.iter().zip(&values) {
            assert!(
                (found - known).abs() < 1e-6 * known.abs().max(1.0),
                "{}: {start:?}",
                form.name()
            );
        }
    }
}

/// Asserts that a model has a finite mean and standard deviation over its range, draws readings that follow its density, and has
/// dropouts as often as stated.
fn keeps_the_contract(name: &str, sensor: &RangeModel, draws: usize) {
    let (low_m, high_m) = sensor.range_m();
    for step in 0..=100 {
        let beam = Beam::straight(low_m + f64::from(step) / 100.0 * (high_m - low_m));
        let (mean, sd) = (sensor.mean(&beam), sensor.sd(&beam));
        assert!(mean.is_finite() && sd.is_finite() && sd > 0.0, "{name}");
    }
    for (index, share) in [0.0, 0.3, 1.0].into_iter().enumerate() {
        let beam = Beam::straight(low_m + share * (high_m - low_m));
        let (centre, sd) = (sensor.mean(&beam), sensor.sd(&beam));
        let mut rng = Numbered::SensorReading.generator(3, index as u64);
        let drawn: Vec<f64> = (0..draws)
            .filter_map(|_| sensor.draw(&beam, &mut rng))
            .collect();
        let missing = Proportion::new(draws - drawn.len(), draws, 0.9999);
        let stated = sensor.dropout(&beam);
        assert!(
            missing.low <= stated && stated <= missing.high,
            "{name}: {missing:?}"
        );
        // Quantiles from the integral of the density are compared with the drawn readings.
        let step = 0.005 * sd;
        let mut below = 0.0;
        let mut quantiles = Vec::new();
        for k in -1200..1200 {
            let reading = centre + f64::from(k) * step;
            below += step * sensor.log_density(reading, &beam).exp();
            if below * 400.0 >= quantiles.len() as f64 + 0.5 {
                quantiles.push(reading);
            }
        }
        assert!(
            (below - 1.0).abs() < 1e-6,
            "{name}: the density sums to {below}"
        );
        let test = kolmogorov_smirnov(&drawn, &quantiles).unwrap();
        assert!(test.p_value > 1e-3, "{name} at {share}: {test:?}");
    }
}

#[test]
fn every_shipped_sensor_draws_readings_that_follow_its_density() {
    for name in shipped_sensors() {
        let sensor = sensor_by_name(name).unwrap();
        assert_eq!(sensor.dropout, 0.0, "{name}: no dropouts were stated");
        keeps_the_contract(name, &sensor, 4000);
    }
}

/// Tests all registered forms, as the mean and as the standard deviation.
#[test]
fn every_registered_form_makes_a_model_that_keeps_the_contract() {
    for mean in FORMS {
        for spread in FORMS {
            let (values, widths) = (example(mean), example(spread));
            let sensor = model(
                (mean.name(), &values),
                (spread.name(), &widths),
                "dropout: 0.1",
            );
            let name = format!("{}, {}", mean.name(), spread.name());
            keeps_the_contract(&name, &sensor, 2000);
        }
    }
}

#[test]
fn dropouts_and_outliers_are_drawn_as_often_as_stated_and_recovered_by_a_fit() {
    let sensor = model(
        ("linear", &[0.7626, 0.9582]),
        ("linear", &[0.4878, 0.0093]),
        "dropout: 0.05, outliers: (share: 0.02, low: 0.0, high: 200.0)",
    );
    let beam = Beam::straight(0.1);
    let mut rng = Numbered::SensorReading.generator(1, 0);
    let drawn: Vec<Option<f64>> = (0..20_000).map(|_| sensor.draw(&beam, &mut rng)).collect();
    let missing = Proportion::new(
        drawn.iter().filter(|v| v.is_none()).count(),
        drawn.len(),
        0.999,
    );
    assert!(missing.low < 0.05 && 0.05 < missing.high, "{missing:?}");
    let found = Characterisation::new(&log_of(&sensor, 400, 5), &Options::default()).unwrap();
    assert!(
        found.dropouts.low < 0.05 && 0.05 < found.dropouts.high,
        "{:?}",
        found.dropouts
    );
    // Outliers that happen to be near the truth (about 5 sd to each side, of 200) cannot be detected.
    let detectable = 0.02 * (1.0 - 10.0 * 0.6 / 200.0);
    assert!(
        found.outliers.low < detectable && detectable < found.outliers.high,
        "{:?}",
        found.outliers
    );
    let slope = &found.mean[1];
    assert!(slope.low < 0.9582 && 0.9582 < slope.high, "{slope:?}");
}

/// A user's own sensor needs only an implementation of the required methods of the trait.
#[test]
fn a_users_own_sensor_draws_with_its_mean_deviation_and_dropouts() {
    struct Bumper;
    impl RangeSensor for Bumper {
        fn range_m(&self) -> (f64, f64) {
            (0.0, 0.2)
        }
        fn mean(&self, beam: &Beam) -> f64 {
            f64::from(u8::from(beam.distance_m < 0.1))
        }
        fn sd(&self, _: &Beam) -> f64 {
            0.1
        }
        fn dropout(&self, _: &Beam) -> f64 {
            0.25
        }
    }
    let mut rng = Numbered::SensorReading.generator(1, 0);
    let drawn: Vec<Option<f64>> = (0..4000)
        .map(|_| Bumper.draw(&Beam::straight(0.05), &mut rng))
        .collect();
    let came: Vec<f64> = drawn.iter().flatten().copied().collect();
    assert!((came.len() as f64 / 4000.0 - 0.75).abs() < 0.03);
    assert!((mean(&came) - 1.0).abs() < 0.01 && (standard_deviation(&came) - 0.1).abs() < 0.01);
}
