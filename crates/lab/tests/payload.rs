//! A payload is fitted from two sets of logs of one study: with it and without it.

use realgap_lab::calibration::{Overrides, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_simulation::Quantity;

use crate::joint_log::{POSITIONS, SPRING, record, robot};

/// The arm of the other tests, with a body of 0.1 kg at its end.
fn loaded() -> String {
    let body = r#"(name: "payload", mass_kg: 0.1, centre_of_mass_m: (0, 0, 0), inertia_kg_m2: (xx: 4e-5, yy: 4e-5, zz: 4e-5))],
        joints: [
            (name: "grip", parent: "lower", child: "payload", pose: (at_m: (0.2, 0, 0)), kind: Fixed),"#;
    let loaded = robot(SPRING).replacen(
        "],\n        joints: [",
        &format!(",\n            {body}"),
        1,
    );
    loaded.replacen(r#"name: "arm""#, r#"name: "arm_loaded""#, 1)
}

#[test]
fn mass_and_centre_of_mass_of_a_payload_follow_from_logs_with_and_without_it() {
    let folder = tempfile::tempdir().unwrap();
    let of_both = [
        ("hinge.pitch.viscous_nm_s_rad", 0.03),
        ("hinge.elbow.viscous_nm_s_rad", 0.02),
        ("body.lower.mass_scale", 1.2),
    ];
    let of_payload = [
        ("body.payload.mass_scale", 1.8),
        ("body.payload.com_offset_x_m", 0.03),
    ];
    let spring = (Quantity::Position, [1.0; 2]);
    record(
        folder.path(),
        "empty.csv",
        &robot(SPRING),
        spring,
        &of_both,
        POSITIONS,
    );
    std::fs::write(folder.path().join("empty.ron"), robot(SPRING)).unwrap();
    let truth = [&of_both[..], &of_payload[..]].concat();
    record(
        folder.path(),
        "loaded.csv",
        &loaded(),
        spring,
        &truth,
        POSITIONS,
    );
    std::fs::write(folder.path().join("loaded.ron"), loaded()).unwrap();
    let path = folder.path().join("study.ron");
    let text = r#"Study(
        robots: [
            (morphology: "empty.ron", recordings: ["empty.csv"]),
            (morphology: "loaded.ron", recordings: ["loaded.csv"]),
        ],
        start: FromRecording, commands: Commands(), timestep_s: 0.005, metric: "joints", score: Single,
        parameters: [
            (name: "hinge.pitch.viscous_nm_s_rad", from: 0, to: 0.1),
            (name: "hinge.elbow.viscous_nm_s_rad", from: 0, to: 0.1),
            (name: "body.lower.mass_scale", from: 0.5, to: 2),
            (name: "body.payload.mass_scale", from: 0.2, to: 5),
            (name: "body.payload.com_offset_x_m", from: -0.1, to: 0.1),
        ])"#;
    std::fs::write(&path, text).unwrap();
    let study = Study::read(path, &Overrides::default()).unwrap();
    let options = TuneOptions {
        optimizer: optimizer_by_name("gauss-newton").unwrap(),
        budget: 120,
        patience: None,
    };
    let answer = study.tune(&options, &RunOptions::default()).unwrap();
    let tuning = answer.report.tuning.unwrap();
    for (known, (name, value)) in tuning.least_squares.iter().zip(truth) {
        assert_eq!(known.parameter, name.replace("body.", "module."));
        let wide = known.high - known.low;
        assert!(
            (known.value - value).abs() < 1.5 * wide,
            "{known:?}: {value}"
        );
        assert!(known.is_told, "{known:?}");
    }
}
