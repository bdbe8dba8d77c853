//! The noise of a new study, as it stands in its text.

use realgap::calibration::{ExpectedNoise, RunStart};
use realgap::trajectory::Recording;

use super::super::kit::*;

/// The line of the study that states how repeats differ, and the assumption with its evidence.
pub(super) fn section(
    recordings: &[Recording],
    start: RunStart,
    robot: &Morphology,
) -> (String, (&'static str, String)) {
    let mut hinges = robot.assemble().hinges.into_iter();
    let has_servos = hinges.any(|hinge| hinge.actuator.is_some());
    let expected = ExpectedNoise::of(recordings, start, has_servos);
    let fields = expected.noise.fields();
    let stated = fields.iter().filter(|(_, field)| !field.is_zero());
    let (camera, others): (Vec<_>, Vec<_>) = stated.partition(|(name, _)| name.starts_with(CAMERA));
    let text = |(name, field): &&(&str, realgap::simulation::Distribution)| {
        format!("{}: {field}", name.trim_start_matches(CAMERA))
    };
    let mut all: Vec<String> = others.iter().map(text).collect();
    if !camera.is_empty() {
        let camera: Vec<String> = camera.iter().map(text).collect();
        all.push(format!("camera: ({})", camera.join(", ")));
    }
    let said = match expected.measured.is_empty() {
        true => "how repeats differ (`noise`) is a careful guess",
        false => "how repeats differ (`noise`)",
    };
    let line = format!(
        "    noise: Noise( // {}\n        {},\n    ),\n",
        match expected.measured.is_empty() {
            true => "careful guesses: replace them by what you measured",
            false => "the camera was measured, guesses are careful",
        },
        all.join(",\n        ")
    );
    (line, (said, expected.because()))
}

/// The field of a study whose repeats differ by the camera alone.
pub(super) fn camera_section(expected: &ExpectedNoise) -> String {
    let fields = expected.noise.fields();
    let camera = fields
        .iter()
        .filter(|(name, field)| name.starts_with(CAMERA) && !field.is_zero());
    let camera =
        camera.map(|(name, field)| format!("{}: {field}", name.trim_start_matches(CAMERA)));
    match camera.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => String::new(),
        camera => format!("    noise: (camera: ({camera})),\n"),
    }
}

const CAMERA: &str = "camera.";
