//! Gains that fit neither the robot nor its recordings, e.g. numbers of a firmware's registers, are doubted with what would be asked of the
//! servo.

use realgap_core::Code;
use realgap_lab::calibration::{Overrides, Study};

use crate::joint_log::{SPRING, logged, robot, study};

/// The doubt about the gains of a study with these values, of a robot with such a limit of torque; the log is of gains 8 and 0.4.
fn doubt(max_torque: &str, set: &str, parameters: &str) -> Option<String> {
    let folder = logged(
        &robot(SPRING).replace("max_torque_nm: 3", max_torque),
        [1.0, 1.0],
    );
    let more = format!("commands: Commands(), set: {{{set}}}, parameters: [{parameters}]");
    let study = Study::read(study(folder.path(), &more), &Overrides::default()).unwrap();
    let mut all = study.warnings().iter();
    let found = all.find(|w| w.code == Code::ImplausibleGains);
    found.map(|w| w.message.clone())
}

const ZERO: &str = r#"(name: "joint.pitch.zero_rad", from: -0.1, to: 0.1)"#;
const PITCH: &str = r#""servo.pitch.stiffness_nm_rad": 4096"#;

#[test]
fn register_values_that_would_hold_a_servo_at_its_limit_are_doubted_and_the_true_gains_are_not() {
    assert_eq!(doubt("max_torque_nm: 3", "", ZERO), None);
    let own = r#""servo.pitch.stiffness_nm_rad": 8, "servo.elbow.stiffness_nm_rad": 8"#;
    assert_eq!(doubt("max_torque_nm: 3", own, ZERO), None);
    let said = doubt("max_torque_nm: 3", PITCH, ZERO).unwrap();
    for part in [
        "`pitch`",
        "4096",
        "limit of 3.00 N m",
        "% of the samples",
        "registers",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!said.contains("`elbow`"), "{said}");
    // What the study varies is not stated.
    let varied = r#"(name: "servo.pitch.stiffness_nm_rad", from: 1000, to: 5000)"#;
    assert_eq!(doubt("max_torque_nm: 3", PITCH, varied), None);
    for form in [
        "servo.p*h.stiffness_nm_rad",
        "servo.*.stiffness_nm_rad",
        "servo.stiffness_nm_rad",
    ] {
        let varied = format!(r#"(name: "{form}", from: 1000, to: 5000)"#);
        assert_eq!(doubt("max_torque_nm: 3", PITCH, &varied), None, "{form}");
    }
    let another = r#"(name: "servo.elb*.stiffness_nm_rad", from: 1, to: 50)"#;
    assert!(doubt("max_torque_nm: 3", PITCH, another).is_some());
}

#[test]
fn a_loop_faster_than_any_joint_and_one_that_lags_for_half_a_second_are_doubted_where_no_limit_says_so()
 {
    let fast = r#""servo.elbow.stiffness_nm_rad": 4096"#;
    let said = doubt("max_torque_nm: 10000", fast, ZERO).unwrap();
    // 1.4e-3 kg m² about the elbow: the lower link's own inertia and its mass 0.1 m away.
    let hz = (4096.0_f64 / 1.4e-3).sqrt() / std::f64::consts::TAU;
    assert!(
        said.contains(&format!("{hz:.0}")[..2]) && said.contains("Hz"),
        "{said} {hz}"
    );
    assert!(said.contains("armature_kg_m2"), "{said}");
    let with_rotor = r#""servo.elbow.stiffness_nm_rad": 4096, "hinge.elbow.armature_kg_m2": 0.02"#;
    assert_eq!(doubt("max_torque_nm: 10000", with_rotor, ZERO), None);
    let late = r#""servo.pitch.stiffness_nm_rad": 32, "servo.pitch.damping_nm_s_rad": 32"#;
    let said = doubt("max_torque_nm: 10000", late, ZERO).unwrap();
    assert!(said.contains("1.00 s behind"), "{said}");
    let varied = r#"(name: "servo.pi*.damping_nm_s_rad", from: 0.1, to: 50)"#;
    assert_eq!(doubt("max_torque_nm: 10000", late, varied), None);
}

#[test]
fn gains_that_are_negative_or_no_number_or_of_joints_that_do_not_exist_are_refused_by_name() {
    let folder = logged(&robot(SPRING), [1.0, 1.0]);
    for (set, part) in [
        (r#""servo.pitch.stiffness_nm_rad": -4"#, "stiffness_nm_rad"),
        (r#""servo.pitch.stiffness_nm_rad": NaN"#, "stiffness_nm_rad"),
        (r#""servo.pitch.damping_nm_s_rad": inf"#, "damping_nm_s_rad"),
    ] {
        let more = format!("commands: Commands(), set: {{{set}}}, parameters: [{ZERO}]");
        let error = Study::read(study(folder.path(), &more), &Overrides::default()).unwrap_err();
        let said = error.to_string();
        assert!(said.contains(part) && said.contains("study.ron"), "{said}");
    }
    let more = format!(
        r#"commands: Commands(), set: {{"servo.knee.stiffness_nm_rad": 4}}, parameters: [{ZERO}]"#
    );
    match Study::read(study(folder.path(), &more), &Overrides::default()) {
        Err(error) => assert!(error.to_string().contains("knee"), "{error}"),
        Ok(study) => {
            let said = study.warnings();
            assert!(said.iter().any(|w| w.message.contains("knee")), "{said:?}");
        }
    }
}
