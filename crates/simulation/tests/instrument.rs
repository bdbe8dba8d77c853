//! Sensors of a run beside pose and joints: torques and currents of motors, gyroscopes and accelerometers, against mechanics.

use std::sync::Arc;

use realgap_core::file::Source;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{
    CommandTrack, EngineChoice, Experiment, Instrument, JointState, Quantity, RAPIER, Sampling,
    TREE, run,
};

const INERTIA: f64 = 0.02;
const RADIUS_M: f64 = 0.3;

/// A link on a mounted base that turns about a vertical axis (no gravity acts), or a horizontal one. The servo is `servo`.
fn robot(axis: &str, servo: &str) -> String {
    format!(
        r#"(name: "arm", bodies: [
            (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
            (name: "link", mass_kg: 0.5, centre_of_mass_m: (0, 0, 0), inertia_kg_m2: (xx: 0.02, yy: 0.02, zz: 0.02))],
        joints: [(name: "elbow", parent: "base", child: "link", kind: Turn(axis: {axis}))],
        actuators: [(joint: "elbow", servo: ({servo}))],
        marks: [(name: "imu", body: "link", pose: (at_m: ({RADIUS_M}, 0, 0)))],
        mount: (at_m: (0, 0, 1)))"#
    )
}

fn experiment(robot: &str, engine: EngineChoice, columns: &[&str]) -> Experiment {
    let robot = Morphology::parse(&Source::new("arm.ron", robot)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.solver.engine = engine;
    experiment.solver.timestep_s = 0.002;
    experiment.duration_s = 1.0;
    experiment.sampling = Sampling::Rate(100.0);
    experiment.instruments = columns
        .iter()
        .map(|column| Instrument::of_column(column, &experiment.assembly).unwrap())
        .collect();
    experiment
}

fn commanded(mut experiment: Experiment, quantity: Quantity, value: f64) -> Experiment {
    let track = CommandTrack::new(vec![0.0], vec![value], None).unwrap();
    let track = Arc::new(track.of(quantity));
    experiment.commands.insert("elbow".to_owned(), track);
    experiment
}

fn signal(experiment: &Experiment, column: &str) -> Vec<f64> {
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    motion.signal(column).unwrap().values.clone()
}

const ENGINES: [EngineChoice; 2] = [EngineChoice::new(&RAPIER), EngineChoice::new(&TREE)];

#[test]
fn a_commanded_torque_is_read_by_both_engines_whatever_the_friction() {
    for engine in ENGINES {
        let robot = robot("(0, 0, 1)", "law: Direct, max_torque_nm: 1").replace(
            "axis: (0, 0, 1)",
            "axis: (0, 0, 1), dry_nm: 0.02, viscous_nm_s_rad: 0.01",
        );
        for (asked, exerted) in [(0.1, 0.1), (-0.3, -0.3), (4.0, 1.0)] {
            let experiment = experiment(&robot, engine, &["elbow_torque_nm"]);
            let experiment = commanded(experiment, Quantity::Torque, asked);
            let read = signal(&experiment, "elbow_torque_nm");
            assert!(
                read.iter().all(|nm| (nm - exerted).abs() < 1e-3),
                "{engine:?} {asked}: {read:?}"
            );
        }
    }
}

#[test]
fn a_spring_servo_reads_the_torque_that_accelerates_link_and_rotor() {
    let law = "law: Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.2), max_torque_nm: 5";
    let robot = robot("(0, 0, 1)", law)
        .replace("axis: (0, 0, 1)", "axis: (0, 0, 1), armature_kg_m2: 0.005");
    for engine in ENGINES {
        let experiment = experiment(&robot, engine, &["elbow_torque_nm"]);
        let experiment = commanded(experiment, Quantity::Position, 0.5);
        let motion = run(&experiment).unwrap().outcome.completed().unwrap();
        let torques = &motion.signal("elbow_torque_nm").unwrap().values;
        let speeds = motion.joints()[0].speeds_rad_s.as_ref().unwrap();
        // The mean torque between two samples is the change of momentum.
        for k in 5..60 {
            let mean_nm = 0.5 * (torques[k] + torques[k + 1]);
            let change = (INERTIA + 0.005) * (speeds[k + 1] - speeds[k]) / 0.01;
            assert!(
                (mean_nm - change).abs() < 0.05,
                "{engine:?} {k}: {mean_nm} {change}"
            );
        }
    }
}

#[test]
fn a_held_arm_reads_the_torque_of_its_weight_with_the_sign_that_holds_it() {
    let law = "law: Torque(stiffness_nm_rad: 400, damping_nm_s_rad: 4), max_torque_nm: 50";
    let robot = robot("(0, 1, 0)", law).replace(
        "centre_of_mass_m: (0, 0, 0)",
        "centre_of_mass_m: (0.2, 0, 0)",
    );
    let experiment = experiment(&robot, ENGINES[1], &["elbow_torque_nm"]);
    let experiment = commanded(experiment, Quantity::Position, 0.0);
    let read = signal(&experiment, "elbow_torque_nm");
    // A turn about +y lowers the centre at +x, so the motor has to turn it back.
    assert!((read[95] + 0.5 * 9.81 * 0.2).abs() < 0.01, "{}", read[95]);
}

#[test]
fn a_current_is_the_torque_over_the_torque_constant_and_is_commanded_by_it() {
    let servo = "law: Direct, max_torque_nm: 1, torque_constant_nm_a: 0.25";
    let experiment = experiment(
        &robot("(0, 0, 1)", servo),
        ENGINES[1],
        &["elbow_current_a", "elbow_torque_nm"],
    );
    let experiment = commanded(experiment, Quantity::Current, 0.8);
    let (current, torque) = (
        signal(&experiment, "elbow_current_a"),
        signal(&experiment, "elbow_torque_nm"),
    );
    assert!(
        current.iter().all(|a| (a - 0.8).abs() < 1e-3),
        "{current:?}"
    );
    assert!(
        torque.iter().all(|nm| (nm - 0.2).abs() < 1e-3),
        "{torque:?}"
    );
    let without = experiment_refusal("law: Direct, max_torque_nm: 1");
    assert!(without.contains("torque constant"), "{without}");
}

fn experiment_refusal(servo: &str) -> String {
    let robot = robot("(0, 0, 1)", servo);
    let robot = Morphology::parse(&Source::new("arm.ron", robot))
        .unwrap()
        .assemble();
    Instrument::of_column("elbow_current_a", &robot)
        .unwrap_err()
        .to_string()
}

#[test]
fn a_duty_gives_the_line_from_stall_to_free_speed_with_and_without_a_motor() {
    // Both have a stall torque of 0.4 N m and a free speed of 20 rad/s.
    let line = "law: Direct, max_torque_nm: 0.4, max_speed_rad_s: 20";
    let motor = "law: Motor(position_gain: 1, duty_1_rad: 1, supply_v: 8, torque_constant_nm_a: 0.4, resistance_ohm: 8), max_torque_nm: 10";
    for servo in [line, motor] {
        for duty in [0.5, -1.0] {
            let experiment =
                experiment(&robot("(0, 0, 1)", servo), ENGINES[1], &["elbow_torque_nm"]);
            let experiment = commanded(experiment, Quantity::Duty, duty);
            let motion = run(&experiment).unwrap().outcome.completed().unwrap();
            let speeds = motion.joints()[0].speeds_rad_s.as_ref().unwrap();
            let torques = &motion.signal("elbow_torque_nm").unwrap().values;
            // Speed approaches duty · 20 rad/s with the time constant inertia / (0.4 / 20).
            for (k, (speed, torque)) in speeds.iter().zip(torques).enumerate().skip(1) {
                let t = 0.01 * k as f64;
                let expected = duty * 20.0 * (1.0 - (-t * 0.02 / INERTIA).exp());
                assert!(
                    (speed - expected).abs() < 0.03,
                    "{servo} {k}: {speed} {expected}"
                );
                assert!(
                    (torque - (0.4 * duty - 0.02 * speed)).abs() < 2e-3,
                    "{k}: {torque}"
                );
            }
        }
    }
}

#[test]
fn a_gyroscope_and_an_accelerometer_read_what_their_mark_feels() {
    let columns = [
        "imu_gyro_z_rad_s",
        "imu_accel_x_m_s2",
        "imu_accel_y_m_s2",
        "imu_accel_z_m_s2",
    ];
    let robot = robot("(0, 0, 1)", "law: Direct, max_torque_nm: 1");
    for engine in ENGINES {
        let mut experiment = experiment(&robot, engine, &columns);
        experiment.start_joints = vec![JointState {
            angle_rad: 0.3,
            speed_rad_s: 2.0,
        }];
        let experiment = commanded(experiment, Quantity::Torque, 0.04);
        let motion = run(&experiment).unwrap().outcome.completed().unwrap();
        let of = |column: &str| motion.signal(column).unwrap().values.clone();
        let [gyro, x, y, z] = columns.map(of);
        let rate = 0.04 / INERTIA;
        for k in 3..95 {
            let speed = 2.0 + rate * 0.01 * k as f64;
            assert!(
                (gyro[k] - speed).abs() < 0.02,
                "{engine:?} {k}: {}",
                gyro[k]
            );
            // Towards the axis, along the motion, and against gravity.
            assert!(
                (x[k] + RADIUS_M * speed * speed).abs() < 0.05,
                "{engine:?} {k}: {}",
                x[k]
            );
            assert!(
                (y[k] - RADIUS_M * rate).abs() < 0.05,
                "{engine:?} {k}: {}",
                y[k]
            );
            assert!((z[k] - 9.81).abs() < 0.02, "{engine:?} {k}: {}", z[k]);
        }
    }
}

#[test]
fn instruments_do_not_change_the_run() {
    let robot = robot("(0, 1, 0)", "law: Direct, max_torque_nm: 1");
    for engine in ENGINES {
        let plain = commanded(experiment(&robot, engine, &[]), Quantity::Torque, 0.1);
        let measured = experiment(&robot, engine, &["elbow_torque_nm", "link_accel_x_m_s2"]);
        let measured = commanded(measured, Quantity::Torque, 0.1);
        let joints = |e: &Experiment| {
            run(e)
                .unwrap()
                .outcome
                .completed()
                .unwrap()
                .joints()
                .to_vec()
        };
        assert_eq!(joints(&plain), joints(&measured));
    }
}

#[test]
fn a_column_of_nothing_that_the_robot_has_is_refused_and_the_error_lists_what_it_has() {
    let robot = robot("(0, 0, 1)", "law: Direct, max_torque_nm: 1");
    let robot = Morphology::parse(&Source::new("arm.ron", robot))
        .unwrap()
        .assemble();
    for (column, listed) in [
        ("wrist_torque_nm", "elbow"),
        ("trunk_gyro_x_rad_s", "imu, base, link"),
        ("elbow_rad", "NAME_torque_nm"),
    ] {
        let error = Instrument::of_column(column, &robot)
            .unwrap_err()
            .to_string();
        assert!(error.contains(listed), "{error}");
    }
}
