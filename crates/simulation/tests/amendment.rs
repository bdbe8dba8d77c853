//! Fitted parameters in the file from which the robot was read.

use realgap_core::file::Source;
use realgap_robot::import::Options;
use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{Calibrated, Fate, calibrate};
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{Experiment, run};

const ARM: &str = r#"<mujoco model="arm">
  <default><joint axis="0 1 0" damping="0.2" armature="0.01"/></default>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <inertial pos="0 0 -.1" mass="0.5" diaginertia="2e-3 2e-3 1e-3"/>
      <joint name="shoulder"/>
      <body name="lower" pos="0 0 -.3">
        <joint name="elbow"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 -.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="shoulder" kp="20" kv="1" forcerange="-5 5"/></actuator>
</mujoco>
"#;

fn set(values: &[(&str, f64)]) -> ParameterSet {
    let values = values.iter();
    values
        .map(|(name, value)| Assignment::new(name, *value).unwrap())
        .collect()
}

fn calibrated(values: &[(&str, f64)]) -> Calibrated {
    let source = Source::new("arm.xml", ARM);
    let remark = |value: &Assignment| format!("realgap: {}", value.parameter.name);
    calibrate(&source, &Options::default(), &set(values), remark).unwrap()
}

fn imported(text: &str) -> Experiment {
    let source = Source::new("arm.xml", text);
    let robot = Morphology::import(&source, &Options::default()).unwrap().0;
    Experiment::new(robot.assemble())
}

#[test]
fn a_robot_of_the_written_file_is_the_robot_with_the_fitted_values() {
    let values = [
        ("hinge.viscous_nm_s_rad", 0.3),
        ("hinge.elbow.dry_nm", 0.02),
        ("hinge.*er.armature_kg_m2", 0.03),
        ("servo.gain", 1.4),
        ("servo.max_torque_nm", 4.0),
        ("module.upper.mass_scale", 1.3),
        ("module.lower.com_offset_x_m", 0.01),
        ("module.lower.inertia_x_scale", 1.2),
    ];
    let written = calibrated(&values);
    for (value, fate) in &written.values {
        assert!(matches!(fate, Fate::Written(_)), "{value}: {fate:?}");
    }
    assert!(written.largest_difference < 1e-12);
    let (mut fitted, mut read) = (set(&values).apply(&imported(ARM)), imported(&written.text));
    for experiment in [&mut fitted, &mut read] {
        experiment.duration_s = 0.5;
    }
    let ends = [fitted, read].map(|experiment| {
        let motion = run(&experiment).unwrap().outcome.into_result().unwrap();
        let joints = motion.joints().iter();
        joints
            .map(|joint| *joint.angles_rad.last().unwrap())
            .collect::<Vec<f64>>()
    });
    for (a, b) in ends[0].iter().zip(&ends[1]) {
        assert!((a - b).abs() < 1e-9, "{ends:?}");
    }
}

#[test]
fn the_comment_names_the_parameters_that_a_number_comes_from() {
    let written = calibrated(&[
        ("hinge.viscous_nm_s_rad", 0.3),
        ("hinge.elbow.viscous_nm_s_rad", 0.4),
    ]);
    let lines: Vec<&str> = written.text.lines().map(str::trim).collect();
    assert!(
        lines.contains(&"<!-- realgap: hinge.viscous_nm_s_rad -->"),
        "{lines:?}"
    );
    assert!(
        lines.contains(&"<!-- realgap: hinge.elbow.viscous_nm_s_rad -->"),
        "{lines:?}"
    );
    assert!(
        written
            .text
            .contains("<joint name=\"elbow\" damping=\"0.4\"/>"),
        "{lines:?}"
    );
}

#[test]
fn what_no_file_says_is_named_with_the_reason_and_changes_nothing() {
    let written = calibrated(&[
        ("floor.friction", 0.3),
        ("joint.elbow.zero_rad", 0.02),
        ("servo.latency_s", 0.01),
        ("hinge.elbow.viscous_nm_s_rad", 0.2),
        ("sim.geom.floor.friction", 0.4),
    ]);
    assert_eq!(written.text, ARM);
    let fates: Vec<&Fate> = written.values.iter().map(|(_, fate)| fate).collect();
    let why = |fate: &Fate| match fate {
        Fate::Unsaid(why) => why.clone(),
        other => format!("{other:?}"),
    };
    assert!(why(fates[0]).contains("engine"), "{fates:?}");
    assert!(why(fates[1]).contains("encoders"), "{fates:?}");
    assert!(
        why(fates[2]).contains("actuators have no field"),
        "{fates:?}"
    );
    assert_eq!(*fates[3], Fate::Unchanged);
    assert!(why(fates[4]).contains("no geom"), "{fates:?}");
}
