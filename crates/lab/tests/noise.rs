//! The noise settings of studies.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use realgap_lab::calibration::{Definition, Overrides};
use realgap_simulation::Distribution;

#[test]
fn an_error_in_the_noise_of_a_study_has_its_line_number() {
    let folder = tempfile::tempdir().unwrap();
    let root = common::project().display();
    let path = common::study(
        folder.path(),
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",\nstart: Settled,\nparameters: [(name: \"floor.friction\", from: 0.1, to: 0.9)],\nnoise: Noise(\n    mass_relative: LogNormal(0.02),\n    start_tilt_rad: Normal(-1.0),\n),"
        ),
    );
    let error = Definition::read_without_recordings(&path, &Overrides::default()).unwrap_err();
    assert_eq!(
        error.line_column().map(|(line, _)| line),
        Some(7),
        "{error}"
    );
    assert!(error.to_string().contains("start_tilt_rad"), "{error}");
}

#[test]
fn shipped_studies_have_noise_settings() {
    for name in ["tripod_floor", "tripod_self"] {
        let path = common::project().join(format!("sweeps/{name}.ron"));
        let definition = Definition::read_without_recordings(path, &Overrides::default()).unwrap();
        let noise = definition.noise.unwrap();
        assert!(!noise.is_zero(), "{name}");
        assert_ne!(noise.start_heading_rad, Distribution::default(), "{name}");
    }
}
