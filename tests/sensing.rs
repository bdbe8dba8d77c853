//! Range sensors: what every form and model must do, whether known ones are found again, and what bad logs are told.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/fidelity/sensing.md"
)]

mod common;

use realgap::file::Source;
use realgap::random::Numbered;
use realgap::sensing::range::form::{FORMS, Form, Point, form_by_name};
use realgap::sensing::range::{
    Beam, Characterisation, Options, RangeModel, RangeSensor, ReadingLog, find_sensor,
    sensor_by_name, shipped_sensors,
};
use realgap::statistics::{Proportion, kolmogorov_smirnov, mean, standard_deviation};

/// Readings of a model at whole and half distances of its unit, as a log.
fn log_of(sensor: &RangeModel, readings: usize, seed: u64) -> ReadingLog {
    let mut text = String::from("distance_cm,reading\n");
    let (low, high) = sensor.range;
    for index in 0..=20_u64 {
        let distance = low + (high - low) * index as f64 / 20.0;
        let beam = Beam::straight(0.01 * distance);
        let mut rng = Numbered::SensorReading.generator(seed, index);
        for _ in 0..readings {
            let value = sensor
                .draw(&beam, &mut rng)
                .map_or(String::new(), |v| v.to_string());
            text += &format!("{distance},{value}\n");
        }
    }
    ReadingLog::parse("log.csv", &text).unwrap()
}

fn model(mean: (&str, &[f64]), spread: (&str, &[f64]), more: &str) -> RangeModel {
    let curve = |(form, values): (&str, &[f64])| {
        let knots = if form == "table" {
            "knots: [1.0, 5.0, 12.0, 21.0], "
        } else {
            ""
        };
        format!("(form: \"{form}\", {knots}values: {values:?})")
    };
    let text = format!(
        "(distance_unit: \"cm\", reading_unit: Own(\"\"), range: (1.0, 21.0), mean: {}, spread: {}, {more})",
        curve(mean),
        curve(spread)
    );
    RangeModel::parse(&Source::new("model.ron", text)).unwrap()
}

/// Parameters for every form that make sense between 1 and 21.
fn example(form: &dyn Form) -> Vec<f64> {
    match form.name() {
        "linear" => vec![0.5, 0.9],
        "power" => vec![900.0, -1.1],
        "exponential" => vec![40.0, -0.12],
        "table" => vec![2.0, 9.0, 11.0, 30.0],
        other => panic!("an example for {other}"),
    }
}

#[test]
fn every_form_knows_its_slopes_and_starts_at_the_data() {
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

#[test]
fn every_shipped_sensor_draws_what_its_density_says() {
    for name in shipped_sensors() {
        let sensor = sensor_by_name(name).unwrap();
        let (low_m, high_m) = sensor.range_m();
        for share in [0.0, 0.3, 1.0] {
            let beam = Beam::straight(low_m + share * (high_m - low_m));
            let (centre, sd) = (sensor.mean(&beam), sensor.sd(&beam));
            assert!(centre.is_finite() && sd > 0.0, "{name}");
            let mut rng = Numbered::SensorReading.generator(3, 0);
            let drawn: Vec<f64> = (0..4000)
                .filter_map(|_| sensor.draw(&beam, &mut rng))
                .collect();
            assert_eq!(drawn.len(), 4000, "{name}: no dropouts were stated");
            // Quantiles of the density by its integral, against the draws.
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
            assert!(test.p_value > 0.01, "{name} at {share}: {test:?}");
        }
    }
}

#[test]
fn dropouts_and_nonsense_are_drawn_as_often_as_they_are_stated_and_found_again() {
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
    // Nonsense that happens to lie near the truth cannot be told: about 5 sd each way of 200.
    let told = 0.02 * (1.0 - 10.0 * 0.6 / 200.0);
    assert!(
        found.outliers.low < told && told < found.outliers.high,
        "{:?}",
        found.outliers
    );
    let slope = &found.mean[1];
    assert!(slope.low < 0.9582 && 0.9582 < slope.high, "{slope:?}");
}

/// How often intervals hold the truth, by model and parameter (docs/fidelity/sensing.md).
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
                // The fit has knots of its own: the truth at those.
                let at = |curve: &realgap::sensing::range::form::Curve, of: &RangeModel| {
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
fn intervals_hold_known_parameters_as_often_as_they_promise() {
    let table = coverage(150);
    let mut by_model: std::collections::BTreeMap<String, (usize, usize)> =
        std::collections::BTreeMap::new();
    for (name, held) in &table {
        let (model, _) = name.rsplit_once(' ').unwrap();
        let sum = by_model.entry(model.to_owned()).or_default();
        *sum = (sum.0 + held.count, sum.1 + held.trials);
        // At the 99.9 % level some fifty parameters may all be asked.
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
    // No formula: the table is chosen, not the formula that misses least.
    let odd = model(
        ("table", &[2.0, 9.0, 11.0, 30.0]),
        ("linear", &[0.2, 0.01]),
        "",
    );
    let found = Characterisation::new(&log_of(&odd, 100, 1), &Options::default()).unwrap();
    assert_eq!(found.mean_form, "table");
    // Asked for a line all the same, it says that the line misses.
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

#[test]
fn a_bad_log_is_told_what_is_wrong_with_it() {
    for (text, said) in [
        ("distance_cm,reading_cm\n", "no readings"),
        ("reading_cm\n1\n", "no column `distance`"),
        ("distance_cm,value\n1,1\n", "no column `reading`"),
        ("distance_cm,reading_cm\n-1,1\n", "above 0"),
        ("distance_cm,reading_cm\n0,1\n", "above 0"),
        ("distance_cm,reading_cm\nnan,1\n", "not a finite number"),
        ("distance_cm,reading_cm\n1,abc\n", "not a number"),
        ("distance_cm,reading_cm\n1,2,3\n", "another number of cells"),
    ] {
        let error = ReadingLog::parse("log.csv", text).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("log.csv"),
            "{text:?}: {error}"
        );
    }
    let refused = |rows: &str| {
        let log = ReadingLog::parse("log.csv", &format!("distance_cm,reading_cm\n{rows}")).unwrap();
        Characterisation::new(&log, &Options::default())
            .unwrap_err()
            .to_string()
    };
    assert!(refused("5,5.1\n5,5.2\n5,4.9\n").contains("one distance"));
    assert!(refused("5,\n6,\n").contains("not a single reading"));
    assert!(refused("5,7\n6,7\n5,7\n").contains("all readings are the same"));
    // Nothing that came back: sensors say 0 or -1, and that is no length.
    let log = ReadingLog::parse(
        "log.csv",
        "distance_cm,reading_cm\n1,1.1\n1,0\n2,2.1\n2,-1\n",
    )
    .unwrap();
    assert_eq!(log.readings.iter().filter(|r| r.value.is_none()).count(), 2);
    assert_eq!(log.warnings[0].code.name(), "impossible-readings");
    let log = ReadingLog::parse(
        "log.csv",
        "distance_cm,reading_cm,material\n1,1.1,wood\n2,2.1,wool\n",
    )
    .unwrap();
    assert_eq!(log.warnings[0].code.name(), "several-materials");
}

#[test]
fn a_model_that_has_no_density_is_refused() {
    for (text, said) in [
        (
            "mean: (form: \"linear\", values: [0, 1]), spread: (form: \"linear\", values: [0.1, -0.05])",
            "no density",
        ),
        (
            "mean: (form: \"linear\", values: [0]), spread: (form: \"linear\", values: [1, 0])",
            "2: intercept, slope",
        ),
        (
            "mean: (form: \"liner\", values: [0, 1]), spread: (form: \"linear\", values: [1, 0])",
            "did you mean `linear`",
        ),
        (
            "mean: (form: \"table\", knots: [2, 1], values: [0, 1]), spread: (form: \"linear\", values: [1, 0])",
            "must increase",
        ),
        (
            "mean: (form: \"linear\", values: [0, 1]), spread: (form: \"linear\", values: [1, 0]), dropout: 2.0",
            "not a probability",
        ),
    ] {
        let text =
            format!("(distance_unit: \"cm\", reading_unit: Own(\"\"), range: (1.0, 21.0), {text})");
        let error = RangeModel::parse(&Source::new("model.ron", text))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(said) && error.contains("model.ron:1:"),
            "{error}"
        );
    }
    let error = find_sensor("ultrasonik").unwrap_err().to_string();
    assert!(error.contains("did you mean `ultrasonic`?"), "{error}");
}

/// A sensor of one's own is one implementation: everything else is given.
#[test]
fn own_sensors_draw_with_what_they_state() {
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

#[test]
fn the_command_makes_a_model_that_can_be_used() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = |args: &[&str]| {
        let output = common::realgap().args(args).output().unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        common::text(&output.stdout)
    };
    run(&[
        "sense",
        "ultrasonic",
        "-o",
        &path("log.csv"),
        "--readings",
        "100",
    ]);
    let json = run(&[
        "characterise",
        &path("log.csv"),
        "--model",
        "linear",
        "-o",
        &path("own.ron"),
        "--plot",
        &path("sensor.png"),
        "--histograms",
        &path("histograms.svg"),
        "--format",
        "json",
    ]);
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    let slope = &found["mean"][1];
    assert_eq!(slope["name"], "slope");
    assert!(slope["low"].as_f64().unwrap() < 0.9582 && slope["high"].as_f64().unwrap() > 0.9582);
    let own = find_sensor(&path("own.ron")).unwrap();
    assert_eq!(own.mean.values[1], slope["value"].as_f64().unwrap());
    assert!(
        folder.path().join("sensor.png").is_file()
            && folder.path().join("histograms.svg").is_file()
    );
    // What it made can be drawn from again, and beyond its range it says so.
    let output = common::realgap()
        .args([
            "sense",
            &path("own.ron"),
            "--distances",
            "30",
            "-o",
            &path("far.csv"),
        ])
        .output()
        .unwrap();
    assert!(common::text(&output.stderr).contains("[extrapolated]"));
    let twice = |name: &str| {
        run(&["sense", "infrared", "-o", &path(name)]);
        std::fs::read(path(name)).unwrap()
    };
    assert_eq!(twice("a.csv"), twice("b.csv"));
    let output = common::realgap()
        .args(["characterise", &path("log.csv"), "--model", "lines"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(common::text(&output.stderr).contains("did you mean `linear`?"));
}
