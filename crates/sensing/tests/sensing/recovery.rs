//! Tests that fits recover known models, and that their intervals contain the truth as often as stated.

use realgap_core::random::Numbered;
use realgap_core::statistics::Proportion;
use realgap_sensing::range::form::form_by_name;
use realgap_sensing::range::{
    Beam, Characterisation, Options, RangeModel, RangeSensor, ReadingLog, sensor_by_name,
};

use super::{log_of, model};

/// How often intervals contain the truth, for each model and parameter (docs/validation/sensing.md).
fn coverage(logs: u64) -> Vec<(String, Proportion)> {
    let models = [
        (
            "linear, linear",
            model(
                ("linear", &[0.7626, 0.9582]),
                ("linear", &[0.4878, 0.0093]),
                "",
            ),
        ),
        (
            "power, exponential",
            model(
                ("power", &[14001.0, -1.005]),
                ("exponential", &[3.78, 0.157]),
                "",
            ),
        ),
        (
            "exponential, power",
            model(("exponential", &[40.0, -0.12]), ("power", &[2.0, -0.5]), ""),
        ),
        (
            "table, table",
            model(
                ("table", &[2.0, 9.0, 11.0, 30.0]),
                ("table", &[0.3, 0.5, 0.9, 0.4]),
                "",
            ),
        ),
    ];
    let mut table = Vec::new();
    for (name, sensor) in models {
        let options = Options {
            mean: Some(sensor.mean.form),
            spread: Some(sensor.spread.form),
            ..Options::default()
        };
        let is_table = sensor.mean.form.name() == "table";
        let mut held = vec![0_usize; if is_table { 0 } else { 4 }];
        for seed in 0..logs {
            let found = Characterisation::new(&log_of(&sensor, 60, seed), &options).unwrap();
            let truth: Vec<f64> = if is_table {
                // The fit chooses its own knots, so the truth is evaluated at those.
                let at = |curve: &realgap_sensing::range::form::Curve, of: &RangeModel| {
                    of.mean
                        .knots
                        .iter()
                        .map(|d| curve.at(*d))
                        .collect::<Vec<_>>()
                };
                [
                    at(&sensor.mean, &found.model),
                    at(&sensor.spread, &found.model),
                ]
                .concat()
            } else {
                [sensor.mean.values.clone(), sensor.spread.values.clone()].concat()
            };
            held.resize(truth.len(), 0);
            for ((value, truth), held) in found
                .mean
                .iter()
                .chain(&found.spread)
                .zip(truth)
                .zip(&mut held)
            {
                *held += usize::from(value.low <= truth && truth <= value.high);
            }
        }
        for (index, held) in held.into_iter().enumerate() {
            table.push((
                format!("{name} {index}"),
                Proportion::new(held, logs as usize, 0.999),
            ));
        }
    }
    table
}

#[test]
fn intervals_contain_known_parameters_as_often_as_stated() {
    let table = coverage(150);
    let mut by_model: std::collections::BTreeMap<String, (usize, usize)> =
        std::collections::BTreeMap::new();
    for (name, held) in &table {
        let (model, _) = name.rsplit_once(' ').unwrap();
        let sum = by_model.entry(model.to_owned()).or_default();
        *sum = (sum.0 + held.count, sum.1 + held.trials);
        // The level is 99.9 % because about fifty parameters are tested.
        assert!(held.high > 0.95, "{name}: {held:?}");
    }
    for (model, (held, of)) in by_model {
        println!(
            "| {model} | {held} of {of} | {:.1} % |",
            100.0 * held as f64 / of as f64
        );
    }
}

#[test]
fn the_form_that_made_the_log_is_chosen() {
    for (mean, spread, values) in [
        ("linear", "linear", [vec![0.7626, 0.9582], vec![0.2, 0.1]]),
        (
            "power",
            "exponential",
            [vec![14001.0, -1.005], vec![3.78, 0.157]],
        ),
        ("exponential", "power", [vec![40.0, -0.12], vec![2.0, -0.9]]),
    ] {
        let sensor = model((mean, &values[0]), (spread, &values[1]), "");
        let right = (0..10)
            .filter(|seed| {
                let found =
                    Characterisation::new(&log_of(&sensor, 100, *seed), &Options::default())
                        .unwrap();
                (found.mean_form, found.spread_form) == (mean, spread)
            })
            .count();
        assert!(right >= 8, "{mean}, {spread}: {right} of 10");
    }
    // If no formula fits, the table is chosen instead of the formula with the smallest error.
    let odd = model(
        ("table", &[2.0, 9.0, 11.0, 30.0]),
        ("linear", &[0.2, 0.01]),
        "",
    );
    let found = Characterisation::new(&log_of(&odd, 100, 1), &Options::default()).unwrap();
    assert_eq!(found.mean_form, "table");
    // A fit of a line that is asked for explicitly gives a warning of lack of fit.
    let options = Options {
        mean: Some(form_by_name("linear").unwrap()),
        ..Options::default()
    };
    let found = Characterisation::new(&log_of(&odd, 100, 1), &options).unwrap();
    assert!(found.lack_of_fit_p.unwrap() < 1e-6);
    assert!(
        found
            .warnings
            .iter()
            .any(|w| w.code.name() == "lack-of-fit")
    );
}

#[test]
fn a_term_in_the_angle_of_incidence_is_found() {
    let infrared = sensor_by_name("infrared").unwrap();
    let mut text = String::from("distance_cm,reading_adc,incidence_deg\n");
    let mut rng = Numbered::SensorReading.generator(1, 0);
    for distance in 4..=12 {
        for incidence in [0.0, 20.0, 40.0] {
            for _ in 0..60 {
                let beam = Beam::straight(0.01 * f64::from(distance));
                let value = infrared.draw(&beam, &mut rng).unwrap() + 2.5 * incidence;
                text += &format!("{distance},{value},{incidence}\n");
            }
        }
    }
    let found = Characterisation::new(
        &ReadingLog::parse("log.csv", &text).unwrap(),
        &Options::default(),
    )
    .unwrap();
    let term = found.mean.last().unwrap();
    assert_eq!(term.name, "incidence per degree");
    assert!(
        term.low < 2.5 && 2.5 < term.high && term.standard_error < 0.1,
        "{term:?}"
    );
    assert_eq!(found.model.reading_unit.symbol(), "adc");
}

#[test]
fn the_study_of_sizes_finds_what_the_papers_eyes_found() {
    let sensor = sensor_by_name("ultrasonic").unwrap();
    let mut text = String::from("distance_cm,reading_cm\n");
    let mut rng = Numbered::SensorReading.generator(2, 0);
    for (distance, readings) in [(5.0_f64, 300), (10.0, 2500), (20.0, 300)] {
        for _ in 0..readings {
            text += &format!(
                "{distance},{}\n",
                sensor
                    .draw(&Beam::straight(0.01 * distance), &mut rng)
                    .unwrap()
            );
        }
    }
    let options = Options {
        bin: Some(0.1),
        ..Options::default()
    };
    let found =
        Characterisation::new(&ReadingLog::parse("log.csv", &text).unwrap(), &options).unwrap();
    let size = found.sample_size.unwrap();
    assert_eq!((size.distance, size.readings), (10.0, 2500));
    // Changes fall with the root of the readings.
    let change = |n: usize| size.steps.iter().find(|s| s.readings == n).unwrap().change;
    assert!(
        (change(100) / change(400) - 2.0).abs() < 0.3,
        "{:?}",
        size.steps
    );
    // The paper chose 200 by eye, with these bins.
    assert!((100..=400).contains(&size.enough), "{size:?}");
}
