//! Tests with the recorded tosses of a real cube; they are skipped where the data are absent.

use realgap_identification::{LengthReading, StartState, identify};
use realgap_lab::calibration::{Definition, Overrides, Part, Study, read_parameters};
use realgap_optimization::RunOptions;
use realgap_simulation::parameter::ParameterSet;

use super::standin::study;

/// The glob of the real tosses. Where they are absent, this prints that the test is skipped and returns `None`.
#[allow(clippy::print_stderr)]
fn recordings(test: &str) -> Option<String> {
    let folder = crate::common::project().join("../shared/data/cube_tosses");
    if folder.is_dir() {
        return Some(folder.join("*.csv").to_string_lossy().into_owned());
    }
    eprintln!("SKIPPED: {test}: no real tosses in {}", folder.display());
    None
}

#[test]
fn the_real_cube_has_a_low_centre_of_mass_and_recordings_with_a_length_scale_below_1() {
    let Some(glob) = recordings("identification of the real cube") else {
        return;
    };
    let overrides = Overrides {
        recordings: vec![glob],
        ..Overrides::default()
    };
    let definition = Definition::read(study(), &overrides).unwrap();
    let found = identify(
        &definition.experiment(),
        &definition.recordings,
        LengthReading::LengthScale,
        1,
    )
    .unwrap();
    let [x, y, z] = found.centre_of_mass_recorded_m;
    assert!(x.contains(0.0) && y.contains(0.0), "{x:?} {y:?}");
    assert!(
        z.contains(0.0059) && (z.value - 0.0059).abs() < 5e-4,
        "{z:?}"
    );
    assert!(
        (found.apparent_gravity_m_s2.value - 9.60).abs() < 0.01,
        "{:?}",
        found.apparent_gravity_m_s2
    );
    let rest = found.rest.height_ratio.unwrap();
    assert!(
        (rest.value - found.length_scale.value).abs() < 0.002,
        "{rest:?}"
    );
    let lag = found.velocity_lag_s.unwrap();
    assert!((lag.value - found.half_sample_s).abs() < 3e-4, "{lag:?}");
    let down = |name: &str| {
        found
            .rest
            .faces
            .iter()
            .find(|f| f.face == name)
            .unwrap()
            .down
    };
    assert!(down("PosZ") > 2 * down("NegZ"));
}

#[test]
fn the_committed_fit_reaches_the_goal_on_held_out_tosses() {
    let Some(glob) = recordings("held-out errors of the committed fit") else {
        return;
    };
    let best = study().with_file_name("cube_toss_best.ron");
    let errors = |start: StartState| {
        let overrides = Overrides {
            recordings: vec![glob.clone()],
            part: Some(Part::new(2, 1).unwrap()),
            start_state: Some(start),
            set: read_parameters(&best).unwrap(),
            ..Overrides::default()
        };
        let study = Study::read(study(), &overrides).unwrap();
        study
            .evaluate(&ParameterSet::new(), &RunOptions::default())
            .unwrap()
    };
    let first = errors(StartState::FirstSample);
    assert_eq!(first.recordings, 199);
    assert!(
        first.position_percent.mean <= 11.0 && first.rotation_deg.mean <= 12.0,
        "{:?} {:?}",
        first.position_percent,
        first.rotation_deg
    );
    let flight = errors(StartState::Flight);
    assert!(flight.position_percent.mean < first.position_percent.mean);
    assert!(flight.rotation_deg.mean < first.rotation_deg.mean);
}
