//! Tests of the errors for bad logs of readings and bad models.

use realgap_core::file::Source;
use realgap_sensing::range::{Characterisation, Options, RangeModel, ReadingLog, find_sensor};

#[test]
fn a_bad_log_gives_an_error_that_names_the_problem() {
    for (text, said) in [
        ("distance_cm,reading_cm\n", "no readings"),
        ("reading_cm\n1\n", "no column `distance`"),
        ("distance_cm,value\n1,1\n", "no column `reading`"),
        ("distance_cm,reading_cm\n-1,1\n", "above 0"),
        ("distance_cm,reading_cm\n0,1\n", "above 0"),
        ("distance_cm,reading_cm\nnan,1\n", "not a finite number"),
        ("distance_cm,reading_cm\n1,abc\n", "not a number"),
        ("distance_cm,reading_cm\n1,2,3\n", "number of cells differs"),
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
    assert!(refused("5,\n6,\n").contains("only dropouts"));
    assert!(refused("5,7\n6,7\n5,7\n").contains("all readings are the same"));
    // Sensors report 0 or -1 if they receive no echo; these values are not lengths.
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
