//! Tests of rolling and torsional friction: a ball, and a cube that tumbles.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::process::Command;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::State;
use realgap_robot::import::Options;
use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{Robot, format_named};
use realgap_simulation::{EngineChoice, Experiment, FrictionModel, RAPIER, Start, TREE, run};

use crate::change::Change as _;
use crate::common::python_with;

const RADIUS_M: f64 = 0.05;
const SPEED_M_S: f64 = 0.4;
/// Gravity of the experiments, m/s².
const G: f64 = 9.81;

/// A ball whose shape has these numbers.
fn robot(turning: &str) -> Morphology {
    let text = format!(
        "(name: \"ball\", bodies: [(name: \"ball\", mass_kg: 0.2, shapes: [(form: Sphere(radius_m: {RADIUS_M}){turning})])])"
    );
    let robot = Morphology::parse(&Source::new("ball.ron", text)).unwrap();
    // A written robot is read back to an equal value.
    let again = Morphology::parse(&Source::new("again.ron", robot.to_ron().unwrap()));
    assert_eq!(again.unwrap(), robot);
    robot
}

/// The ball rolls at 0.4 m/s and spins at 8 rad/s in the tree solver.
fn ball_with(turning: &str) -> Experiment {
    let mut experiment = Experiment::new(robot(turning).assemble());
    experiment.gravity_m_s2 = G;
    experiment.solver.engine = EngineChoice::new(&TREE);
    experiment.floor.friction = 0.8;
    experiment.floor.restitution = 0.0;
    experiment.duration_s = 3.0;
    experiment.start = Start::State(State {
        position_world_m: Vector3::z() * RADIUS_M,
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::x() * SPEED_M_S,
        angular_velocity_body_rad_s: Vector3::new(0.0, SPEED_M_S / RADIUS_M, 8.0),
    });
    experiment
}

pub fn ball() -> Experiment {
    ball_with("")
}

/// How far the ball goes.
fn way_m(experiment: &Experiment) -> f64 {
    let path = run(experiment).unwrap().outcome.completed().unwrap();
    path.positions_world_m().last().unwrap().x
}

/// How far a rolling ball goes until it stops.
fn right_m(rolling_m: f64) -> f64 {
    SPEED_M_S * SPEED_M_S * RADIUS_M * 1.4 / (2.0 * rolling_m * G)
}

#[test]
fn floor_and_shape_add_up_and_twice_the_number_is_half_the_way() {
    for (turning, floor_m, whole_m) in [
        ("", 0.002, 0.002),
        ("", 0.004, 0.004),
        (", turning: (rolling_m: 0.002)", 0.0, 0.002),
        (", turning: (rolling_m: 0.001)", 0.003, 0.004),
    ] {
        let found_m = way_m(&ball_with(turning).set("floor.rolling_m", floor_m));
        let share = found_m / right_m(whole_m);
        assert!((share - 1.0).abs() < 0.01, "{turning} {floor_m}: {share}");
    }
}

#[test]
fn numbers_of_zero_are_the_run_without_them() {
    let stated = ball()
        .set("floor.rolling_m", 0.0)
        .set("floor.torsional_m", 0.0);
    let [one, other] = [&ball(), &stated].map(|e| run(e).unwrap().outcome.completed().unwrap());
    assert_eq!(one, other);
}

#[test]
fn rapier_which_has_no_rolling_friction_says_that_another_engine_simulates() {
    for name in ["floor.rolling_m", "floor.torsional_m"] {
        let mut asked = ball().set(name, 0.002);
        let own = run(&asked).unwrap();
        asked.solver.engine = EngineChoice::new(&RAPIER);
        let answer = run(&asked).unwrap();
        let said = answer.warnings.iter().any(|w| w.message.contains(name));
        assert!(said, "{:?}", answer.warnings);
        assert_eq!(answer.outcome, own.outcome);
        assert!(asked.second_engine().is_none());
    }
    // A robot whose file states it starts in the engine that has it.
    let stated = ball_with(", turning: (torsional_m: 0.001)");
    assert_eq!(
        EngineChoice::suited_to(&stated.assembly),
        EngineChoice::new(&TREE)
    );
}

#[test]
fn what_no_engine_simulates_is_refused_by_name() {
    let mut relaxed = ball().set("floor.rolling_m", 0.001);
    relaxed.contact.friction_model = FrictionModel::Relaxed;
    let error = run(&relaxed).unwrap_err().to_string();
    assert!(
        error.contains("contact.friction_model") && error.contains("floor.rolling_m"),
        "{error}"
    );
    for (wrong, said) in [
        (", turning: (rolling_m: -0.001)", "turning.rolling_m"),
        (", turning: (torsional_m: 2)", "turning.torsional_m"),
        (", turning: (sliding: 1)", "sliding"),
    ] {
        let text = format!(
            "(name: \"ball\", bodies: [(name: \"ball\", mass_kg: 1, shapes: [(form: Sphere(radius_m: 0.1){wrong})])])"
        );
        let error = Morphology::parse(&Source::new("ball.ron", text)).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}

#[test]
fn the_energy_balance_counts_the_work_of_rolling_and_torsional_friction() {
    let mut experiment = ball()
        .set("floor.rolling_m", 0.002)
        .set("floor.torsional_m", 0.001);
    experiment.energy_from_s = Some(0.0);
    let energy = run(&experiment).unwrap().energy.unwrap();
    // m v² (1 + 2/5) / 2 and I w² / 2.
    let moves_j = 0.7 * 0.2 * SPEED_M_S * SPEED_M_S;
    let spins_j = 0.5 * 0.4 * 0.2 * RADIUS_M * RADIUS_M * 64.0;
    let lost_j = moves_j + spins_j;
    assert!(
        (energy.kinetic_j / -lost_j - 1.0).abs() < 1e-3,
        "{energy:?}"
    );
    assert!(
        (energy.friction_j / -lost_j - 1.0).abs() < 0.01,
        "{energy:?}"
    );
}

fn mjcf(turning: &str, experiment: &Experiment) -> String {
    let morphology = robot(turning);
    let robot = Robot::new(&morphology, experiment);
    format_named("mjcf").unwrap().render(&robot).text
}

#[test]
fn an_exported_mjcf_states_what_the_robot_has_on_the_floor_and_is_read_back() {
    let plain = mjcf("", &ball());
    assert!(!plain.contains("condim=\"6\"") && !plain.contains("condim=\"4\""));
    let turning = ", turning: (rolling_m: 0.001)";
    let experiment = ball_with(turning)
        .set("floor.rolling_m", 0.003)
        .set("floor.torsional_m", 0.002);
    let text = mjcf(turning, &experiment);
    assert!(text.contains("condim=\"6\""), "{text}");
    let source = Source::new("ball.xml", text);
    let (robot, notes) = Morphology::import(&source, &Options::default()).unwrap();
    let robot = robot.assemble();
    let said = notes
        .iter()
        .any(|note| note.what.contains("rolling friction 0.004 m"));
    assert!(said, "{notes:?}");
    assert_eq!(robot.surroundings.floor_torsional_m, Some(0.002));
    // The floor gets all that every shape has on it.
    let own_m = robot.parts[0].solids[0].turning.rolling_m;
    let whole_m = robot.surroundings.floor_rolling_m.unwrap() + own_m;
    assert!((whole_m - 0.004).abs() < 1e-12);
}

/// Rolls a ball in MuJoCo, and prints how far it goes.
const IN_MUJOCO: &str = r#"
import sys, mujoco
model = mujoco.MjModel.from_xml_string(sys.stdin.read())
data = mujoco.MjData(model)
radius, speed, seconds = map(float, sys.argv[1:])
data.qpos[2] = radius
data.qvel[0], data.qvel[4] = speed, speed / radius
while data.time < seconds:
    mujoco.mj_step(model, data)
print(data.qpos[0])
"#;

#[test]
fn a_rolling_ball_stops_where_it_stops_in_mujoco() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let mut experiment = ball().set("floor.rolling_m", 0.002);
    if let Start::State(state) = &mut experiment.start {
        state.angular_velocity_body_rad_s.z = 0.0;
    }
    experiment.duration_s = 2.0;
    let own_m = way_m(&experiment);
    let mut child = Command::new(python)
        .args(["-c", IN_MUJOCO, "0.05", "0.4", "2.0"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    std::io::Write::write_all(&mut pipe, mjcf("", &experiment).as_bytes()).unwrap();
    drop(pipe);
    let said = child.wait_with_output().unwrap();
    let found_m: f64 = String::from_utf8(said.stdout)
        .unwrap()
        .trim()
        .parse()
        .unwrap();
    let right = right_m(0.002);
    println!(
        "a rolling ball goes {own_m:.4} m here, {found_m:.4} m in MuJoCo, {right:.4} m by the formula"
    );
    assert!((own_m / found_m - 1.0).abs() < 0.03);
}
