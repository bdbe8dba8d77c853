//! Parameters of a jointed robot from its flights, by the library and by the command.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap::identification::{LengthReading, identify_joints};
use realgap::trajectory::{self, Recording};

use crate::common;
use crate::elbow::{elbow, recorded, set, toss};

fn the_command_gives_the_same_values(recordings: &[Recording], residual_m: f64) {
    let folder = tempfile::tempdir().unwrap();
    for recording in recordings {
        let file = folder.path().join(format!("{}.csv", recording.name));
        trajectory::write(file, &recording.trajectory).unwrap();
    }
    let study = common::study(
        folder.path(),
        &format!(
            "morphology: \"{}/morphologies/elbow.ron\", recordings: [\"*.csv\"], start: FromRecording, metric: \"pose\",
            parameters: [(name: \"floor.friction\", from: 0.1, to: 0.2, points: 2)]",
            common::project().display()
        ),
    );
    let said = common::realgap()
        .args(["study", "identify", "--format", "json"])
        .arg(study)
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", common::text(&said.stderr));
    let said = common::schema::answer("identify-joints", &common::text(&said.stdout));
    assert!(
        (said["residual_m"].as_f64().unwrap() - residual_m).abs() < 1e-6,
        "{said}"
    );
}

#[test]
fn flight_identifies_the_robot_and_marks_what_it_cannot_determine() {
    if !common::is_long_run("a robot from its flights") {
        return;
    }
    let truth = [
        ("hinge.viscous_nm_s_rad", 8e-4),
        ("module.second.com_offset_x_m", 0.006),
        ("module.first.com_offset_z_m", -0.004),
    ];
    let flown = set(&elbow(), &truth);
    let recordings: Vec<Recording> = (1..=10)
        .map(|k| recorded(&format!("toss_{k}"), toss(flown.clone(), k, 0.26)))
        .collect();
    let found = identify_joints(&elbow(), &recordings, LengthReading::LengthScale, 1).unwrap();
    assert_eq!(found.flying, 10);
    the_command_gives_the_same_values(&recordings, found.residual_m);
    let of = |name: &str| found.verdicts.iter().find(|v| v.parameter == name).unwrap();
    for (name, value, within) in [
        ("hinge.viscous_nm_s_rad", 8e-4, 1e-4),
        ("module.second.com_offset_x_m", 0.006, 1.5e-3),
        ("module.first.com_offset_z_m", -0.004, 1.5e-3),
        ("recording.length_scale", 1.0, 0.003),
    ] {
        let verdict = of(name);
        let off = (verdict.estimate.value - value).abs();
        assert!(verdict.is_determined && off < within, "{verdict:?}");
    }
    // What was identified flies better than what was stated.
    assert!(found.predicted.rotation_deg < 0.3 * found.predicted_as_stated.rotation_deg);
    assert!(
        found.last_sample.position_m < 1e-3,
        "{:?}",
        found.last_sample
    );
}
