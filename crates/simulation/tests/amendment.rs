//! Fitted parameters in the file from which the robot was read.

use realgap_core::file::Source;
use realgap_robot::import::Options;
use realgap_robot::morphology::Morphology;
use realgap_robot::morphology::amendment::largest_difference;
use realgap_simulation::export::{Calibrated, Fate, calibrate};
use realgap_simulation::parameter::{Assignment, ParameterSet, all, by_name, families};
use realgap_simulation::{Experiment, Solver, run};

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

/// The robot of an experiment as engines see it, and the world around it.
fn seen(experiment: &Experiment) -> Experiment {
    let mut seen = experiment.clone();
    let mut robot = experiment.adjusted_assembly();
    for (index, hinge) in robot.hinges.iter_mut().enumerate() {
        if let Some(actuator) = &mut hinge.actuator {
            actuator.servo.delay_s += experiment.hinge_adjustment(index).latency_s;
        }
    }
    robot.surroundings = Default::default();
    seen.assembly = std::sync::Arc::new(robot);
    seen.adjustment = Default::default();
    (seen.hinge_adjustments, seen.module_adjustments) = (Vec::new(), Default::default());
    seen
}

#[test]
fn every_parameter_of_shipped_robots_is_in_their_file_or_named_with_the_reason() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../morphologies");
    let mut counts = (0, 0);
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let source = Source::read(&path, "robot").unwrap();
        // The largest ones take seconds, and have no other kinds of parts.
        if source.text().len() > 8000 {
            continue;
        }
        let robot = Morphology::parse(&source).unwrap();
        let before = Experiment::new(robot.assemble());
        let module = before.assembly.module_names.last().unwrap().clone();
        let all = all().map(|parameter| parameter.name.to_owned());
        let members = families().map(|parameter| parameter.name.replace("NAME", &module));
        for name in all.chain(members) {
            let parameter = by_name(&name).unwrap();
            let Some(value) = parameter.value(&before) else {
                continue;
            };
            let moved = parameter.nudged(if value == 0.0 { 0.01 } else { 1.25 * value });
            let Some(to) = moved.into_iter().flatten().next_back() else {
                continue;
            };
            let set = set(&[(&name, to)]);
            let after = set.apply(&before);
            if after == before {
                continue;
            }
            let remark = |value: &Assignment| format!("realgap: {} = 1", value.parameter.name);
            let calibrated = calibrate(&source, &Options::default(), &set, remark).unwrap();
            let read = Source::new(&path, calibrated.text.clone());
            let again = Experiment::new(Morphology::parse(&read).unwrap().assemble());
            let label = format!("{} of {}", name, path.display());
            match &calibrated.values[0].1 {
                Fate::Written(written) => {
                    counts.0 += 1;
                    assert!(!written.is_empty(), "{label}");
                    let (again, after) = (seen(&again), seen(&after));
                    let apart = largest_difference(&again.assembly, &after.assembly);
                    assert!(apart < 1e-9, "{label}: {apart:e}");
                    // A robot whose file states rolling friction begins in the engine that has it.
                    let solver = Solver {
                        engine: after.solver.engine,
                        ..again.solver
                    };
                    let rest = Experiment {
                        assembly: after.assembly.clone(),
                        solver,
                        ..again
                    };
                    assert!(rest == after, "{label}");
                }
                Fate::Unsaid(why) if why.starts_with("only in part") => counts.1 += 1,
                Fate::Unsaid(_) => {
                    counts.1 += 1;
                    assert_eq!(calibrated.text, source.text(), "{label}");
                }
                Fate::Unchanged => panic!("{label}"),
            }
        }
    }
    assert!(counts.0 > 150 && counts.1 > 100, "{counts:?}");
}
