//! Settings of a study without an effect are errors that say what lacks.

use crate::common::{project, realgap, study, text};

/// The error of a study with these lines; empty if it is sound.
fn said(lines: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let root = project();
    let path = study(
        folder.path(),
        &format!(
            "morphology: \"{0}/morphologies/tripod.ron\",
    recordings: [\"{0}/real_trajectories/tripod_standin/run_00.csv\"],
    {lines}
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
            root.display()
        ),
    );
    let checked = realgap().arg("check").arg(&path).output().unwrap();
    match checked.status.success() {
        true => String::new(),
        false => text(&checked.stderr),
    }
}

#[test]
fn a_setting_that_nothing_uses_is_an_error_that_says_what_lacks() {
    for (lines, field, remedy) in [
        (
            "start: FromRecording, windows: (from_m_s: 0.2),",
            "windows",
            "horizon: (LENGTH_S, EVERY_S)",
        ),
        (
            "start: Settled, horizon: (0.2, 0.2),",
            "horizon",
            "start: FromRecording",
        ),
        (
            "start: Settled, left_out: [\"knee\"],",
            "left_out",
            "start: FromRecording",
        ),
        (
            "start: Settled, metric: \"rms\", basis: Recordings,",
            "basis",
            "metric: \"pca\"",
        ),
        (
            "start: FromRecording, metric: \"joints\", align: World,",
            "align",
            "metric: \"pose\"",
        ),
        (
            "start: Settled, metric: \"rms\", condition: \"wet\",",
            "condition",
            "leave `condition` out",
        ),
    ] {
        let error = said(lines);
        assert!(
            error.contains(field) && error.contains(remedy),
            "{lines}: {error}"
        );
    }
    assert_eq!(said("start: Settled, metric: \"rms\","), "");
    assert_eq!(
        said("start: FromRecording, windows: (), metric: \"rms\","),
        ""
    );
}
