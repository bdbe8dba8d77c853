//! Tests of controlled robots: sensors, rules, callbacks, radio messages, and groups of robots.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common;

use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{
    Controller, Decision, EngineChoice, Experiment, Log, Run, RunHooks, Sampling, Steer,
    engine_by_name, run_with, steer, watch,
};

/// A wall across the way of a robot that walks towards -x from (2, 1).
const ARENA: &str = "Arena(name: \"hall\", size_m: (4.0, 2.0), boundary: Open, \
    boxes: [(centre_m: (1.4, 1.0), half_m: (0.05, 0.8))], start: (x_m: 2.0, y_m: 1.0))";
const RADIO: &str =
    "Radio(propagation: \"thickness\", values: [-40.0, 2.0, 0.0, 600.0], shadowing_sd_db: 0.0)";

/// The sensor of the chain points in its walking direction; the robot stops moving while an object, including the floor, is
/// nearer than 15 cm.
const RULES: &str =
    "sensors: [(name: \"front\", on: \"m0\", turn_deg: 180, model: \"ultrasonic\")],
    rules: [(when: (sensor: \"front\", below_m: 0.15), then: [HOLD])],";

fn chain() -> Experiment {
    let robot = Morphology::read(common::project().join("morphologies/chain5.ron")).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 10.0;
    experiment
}

/// Every servo held at zero.
fn hold(experiment: &Experiment) -> String {
    let hinges = experiment.assembly.hinges.iter();
    let driven = hinges.filter(|hinge| hinge.actuator.is_some());
    let all: Vec<String> = driven
        .map(|hinge| format!("(actuator: \"{}\", hold: 0.0)", hinge.name))
        .collect();
    all.join(", ")
}

fn first_module(experiment: &Experiment) -> &str {
    &experiment.assembly.module_names[0]
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hall.ron"), ARENA).unwrap();
    std::fs::write(folder.path().join("radio.ron"), RADIO).unwrap();
    folder
}

fn controller(
    folder: &Path,
    experiment: &Experiment,
    text: &str,
) -> realgap_core::Result<Controller> {
    let text = text
        .replace("HOLD", &hold(experiment))
        .replace("\"m0\"", &format!("{:?}", first_module(experiment)));
    let path = folder.join("controller.ron");
    std::fs::write(&path, format!("Controller(arena: \"hall.ron\", {text})")).unwrap();
    Controller::read(path, experiment)
}

fn steered(text: &str, seed: Option<u64>, engine: EngineChoice) -> (Run, Log) {
    let folder = folder();
    let mut experiment = chain();
    experiment.solver.engine = engine;
    experiment.perturbation.draw = seed.map(|seed| (seed, 0));
    let controller = controller(folder.path(), &experiment, text).unwrap();
    let experiment = experiment.with_controller(controller).unwrap();
    steer(&experiment, None, None).unwrap()
}

fn motion(run: &Run) -> &Trajectory {
    run.outcome.get().unwrap()
}

fn farthest_m(run: &Run) -> f64 {
    let positions = motion(run).positions_world_m().iter();
    positions.map(|p| -p.x).fold(0.0, f64::max)
}

/// A cube in the middle of the hall measures the distance to the wall, or to another cube in between.
#[test]
fn a_reading_is_the_distance_from_the_sensor_to_the_object_ahead() {
    let folder = folder();
    let robot = Morphology::read(common::project().join("morphologies/cube.ron")).unwrap();
    let half_m = 0.5 * robot.assemble().body_length_m;
    let module = robot.assemble().module_names[0].clone();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 0.2;
    for (others, expected_m) in [
        ("", 2.0 - half_m - 1.45),
        (
            "others: [(name: \"other\", x_m: 1.7, y_m: 1.0, heading_deg: 90)],",
            0.3 - 2.0 * half_m,
        ),
        (
            "others: [(name: \"beside\", x_m: 1.7, y_m: 1.5)],",
            2.0 - half_m - 1.45,
        ),
    ] {
        let text = format!(
            "rate_hz: 20, {others} sensors: [
                (name: \"laser\", on: {module:?}, at_m: ({}, 0, 0), turn_deg: 180, model: \"laser\"),
                (name: \"near\", on: {module:?}, turn_deg: 180, model: \"ultrasonic\")],",
            -half_m
        );
        let controller = controller(folder.path(), &experiment, &text).unwrap();
        let experiment = experiment.with_controller(controller).unwrap();
        let (_, log) = steer(&experiment, None, None).unwrap();
        let readings = &log.decisions[0].sensed.readings;
        let read_m = readings[0].unwrap();
        assert!(
            (read_m - expected_m).abs() < 1e-4,
            "{others}: {read_m}, {expected_m}"
        );
        // The ultrasonic sensor gives no reading beyond its range of 21 cm.
        let is_far = expected_m + half_m > 0.21;
        assert_eq!(readings[1].is_none(), is_far, "{readings:?}");
    }
}

/// A scanner whose four polynomials give its own x position for every heading.
#[test]
fn a_sensorgraph_is_read_at_the_place_of_the_scanner_in_the_arena() {
    let folder = folder();
    let polynomial = "(samples: 1, limits_m: (0.0, 9.0), terms: [(powers: (1, 0), value: 1.0)])";
    let graph = format!(
        "Sensorgraph(frame: World, segments_deg: [0.0], width_deg: 30.0, headings: 4, \
         centre_m: (0.0, 0.0), scale_m: 1.0, means_m: [1.0], polynomials: [{}], log: [])",
        [polynomial; 4].join(", ")
    );
    std::fs::write(folder.path().join("graph.ron"), graph).unwrap();
    let mut experiment = chain();
    experiment.duration_s = 1.0;
    let text = |segment: usize| {
        format!(
            "rate_hz: 20, sensors: [(name: \"scan\", on: \"m0\", graph: \"graph.ron\", segment: {segment})],"
        )
    };
    let controller_of = |segment| controller(folder.path(), &experiment, &text(segment));
    let steered = experiment
        .with_controller(controller_of(0).unwrap())
        .unwrap();
    let (_, log) = steer(&steered, None, None).unwrap();
    for decision in &log.decisions {
        let off_m = decision.sensed.readings[0].unwrap() - decision.sensed.position_m[0];
        assert!(off_m.abs() < 1e-9, "{off_m}");
    }
    let error = controller_of(1).unwrap_err().to_string();
    assert!(
        error.contains("no such segment") && error.contains("0 to 0"),
        "{error}"
    );
}

/// Paper 000's avoidance with a modular robot: it walks to the box, turns before it touches it, and walks away.
#[test]
fn a_modular_robot_avoids_the_box_of_paper_000_in_both_engines() {
    let path = common::project().join("controllers/tripod_avoid.ron");
    let robot = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    for name in ["rapier", "tree"] {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = 25.0;
        experiment.solver.engine = engine_by_name(name).unwrap();
        experiment.perturbation.draw = Some((1, 0));
        let seeing = Controller::read(&path, &experiment).unwrap();
        let blind = Controller {
            rules: Vec::new(),
            ..seeing.clone()
        };
        let ways = [seeing, blind].map(|controller| {
            let experiment = experiment.with_controller(controller).unwrap();
            let (run, log) = steer(&experiment, None, None).unwrap();
            assert!(run.outcome.is_completed());
            let ways = log.decisions.iter().map(|d| d.sensed.position_m[0]);
            ways.collect::<Vec<f64>>()
        });
        let [seeing, blind] = ways.map(|way| {
            let most = way.iter().copied().fold(0.0, f64::max);
            (most, way[way.len() - 1])
        });
        // The near face of the box is at 0.86 m, and the tripod's front is at least 5 cm ahead of its core.
        assert!(seeing.0 > 0.6 && seeing.0 < 0.8, "{name}: {seeing:?}");
        assert!(blind.0 > seeing.0 + 0.02, "{name}: {seeing:?} {blind:?}");
        assert!(seeing.1 < seeing.0 - 0.1, "{name}: {seeing:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    let text = format!("rate_hz: 20, {RULES}");
    let engine = EngineChoice::default();
    let first = steered(&text, Some(7), engine);
    let again = std::thread::spawn({
        let text = text.clone();
        move || steered(&text, Some(7), engine)
    });
    assert_eq!(first, {
        let mut again = again.join().unwrap();
        again.0.cpu = first.0.cpu;
        again
    });
    assert_ne!(first.1, steered(&text, Some(8), engine).1);
}

#[test]
fn a_callback_overrides_decisions_at_a_fixed_rate() {
    let folder = folder();
    let experiment = chain();
    let controller = controller(folder.path(), &experiment, "rate_hz: 10,").unwrap();
    let experiment = experiment.with_controller(controller).unwrap();
    let mut times_s = Vec::new();
    let (held, _) = steer(
        &experiment,
        None,
        Some(&mut |sensed, steering| {
            times_s.push(sensed.time_s);
            if sensed.time_s > 3.0 {
                steering.fill(Steer::Hold(0.0));
            }
            Ok(())
        }),
    )
    .unwrap();
    assert_eq!(times_s.len(), 100);
    assert!(times_s.windows(2).all(|w| (w[1] - w[0] - 0.1).abs() < 3e-3));
    let free = realgap_simulation::run(&experiment).unwrap();
    assert!(farthest_m(&held) < 0.6 * farthest_m(&free));
    let mut seen = 0;
    let run = watch(&experiment, &[], &mut |_| seen += 1).unwrap();
    assert_eq!((seen, run.outcome), (run.steps + 1, free.outcome));
    let refused = steer(
        &experiment,
        None,
        Some(&mut |_, _| Err(realgap_core::Error::invalid("no more"))),
    );
    assert!(refused.unwrap_err().to_string().contains("no more"));
}

/// With and without a controller.
#[test]
fn a_run_reports_its_progress_to_the_clock_and_ends_with_its_error() {
    let mut free = chain();
    free.duration_s = 1.0;
    let steered = free
        .clone()
        .with_controller(Controller::bare(10.0))
        .unwrap();
    for experiment in [free, steered] {
        let heard = |until: f64| {
            let mut shares = Vec::new();
            let mut clock = |share: f64| {
                shares.push(share);
                match share < until {
                    true => Ok(()),
                    false => Err(realgap_core::Error::interrupted("enough")),
                }
            };
            let hooks = RunHooks {
                clock: Some(&mut clock),
                ..RunHooks::default()
            };
            let run = run_with(&experiment, hooks).map(|(run, _)| run);
            (shares, run)
        };
        let (shares, run) = heard(1.0);
        let run = run.unwrap();
        let steps = run.steps as f64;
        let expected: Vec<f64> = (0..run.steps).map(|step| step as f64 / steps).collect();
        assert_eq!(shares, expected);
        let alone = realgap_simulation::run(&experiment).unwrap();
        assert_eq!(run.outcome, alone.outcome);
        let (shares, cut) = heard(0.3);
        assert!(cut.unwrap_err().to_string().contains("enough"));
        assert!((shares[shares.len() - 1] - 0.3).abs() < 1.5 / steps);
    }
}

#[test]
fn sensed_angles_are_those_of_the_time_of_the_decision() {
    let mut experiment = chain();
    experiment.duration_s = 1.0;
    experiment.records_joints = true;
    experiment.sampling = Sampling::Rate(1.0 / experiment.solver.timestep_s);
    let experiment = experiment.with_controller(Controller::bare(7.0)).unwrap();
    let (run, log) = steer(&experiment, None, None).unwrap();
    let way = motion(&run);
    assert_eq!(log.decisions.len(), 7);
    for Decision { sensed, .. } in &log.decisions {
        let row = (sensed.time_s / experiment.solver.timestep_s).round() as usize;
        let joints = way.joints().iter();
        let angles: Vec<f64> = joints.map(|joint| joint.angles_rad[row]).collect();
        // Samples are interpolated between two steps, so they differ by rounding errors.
        let place: [f64; 3] = way.positions_world_m()[row].into();
        let (known, seen) = (sensed.angles_rad.iter(), angles.iter());
        let pairs = known.zip(seen).chain(sensed.position_m.iter().zip(&place));
        assert!(
            pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12),
            "{sensed:?}"
        );
        assert_eq!(pairs.count(), 7);
    }
}

/// Two chains walk one behind the other: the rear one detects the front one and receives messages with its position at the time
/// of sending.
#[test]
fn robots_detect_each_other_and_receive_positions_of_the_others() {
    let text = "rate_hz: 20, name: \"behind\",
        sensors: [(name: \"front\", on: \"m0\", turn_deg: 180, model: \"laser\")],
        others: [(name: \"ahead\", x_m: 2.0, y_m: 1.6), (name: \"hidden\", x_m: 0.8, y_m: 1.0)],
        rules: [(when: (heard: \"ahead\", within_m: 0.4), for_s: 0.5, then: [HOLD])],
        radio: (model: \"radio.ron\", every_s: 0.5, latency_s: 0.2),";
    let (run, log) = steered(text, None, EngineChoice::default());
    assert!(run.outcome.is_completed());
    assert_eq!(log.others.len(), 2);
    let of = |robot: usize| {
        log.decisions
            .iter()
            .filter(move |d| d.sensed.robot == robot)
    };
    let ahead: Vec<&_> = of(1).collect();
    for decision in of(0).skip(8) {
        let heard: Vec<usize> = decision.sensed.heard.iter().map(|h| h.from).collect();
        // The wall is 0.1 m thick and attenuates by 60 dB: together with the distance the strength is below -92 dBm.
        assert_eq!(heard, [1]);
        let message = &decision.sensed.heard[0];
        assert!((message.arrived_s - message.sent_s - 0.2).abs() < 1e-9);
        assert!(decision.sensed.time_s >= message.arrived_s - 1e-9);
        // The message contains the position of the sender at the time of sending.
        let then = ahead
            .iter()
            .min_by(|a, b| {
                let off = |d: &&&Decision| (d.sensed.time_s - message.sent_s).abs();
                off(a).total_cmp(&off(b))
            })
            .unwrap();
        for axis in 0..2 {
            let off_m = then.sensed.position_m[axis] - message.position_m[axis];
            assert!(off_m.abs() < 0.02, "{off_m}");
        }
    }
    let near = |path: &Trajectory| path.positions_world_m()[0];
    assert!(
        (near(&log.others[0].1).y - 0.6).abs() < 0.01,
        "in the frame of the first robot"
    );
}

#[test]
fn an_invalid_controller_is_refused_with_the_reason() {
    let (folder, experiment) = (folder(), chain());
    for (text, said) in [
        ("rate_hz: 0,", "rate_hz"),
        ("rate_hz: -5,", "rate_hz"),
        ("rate_hz: 1e6,", "at most once a timestep"),
        (
            "rate_hz: 10, sensors: [(name: \"a\", on: \"nose\", model: \"ultrasonic\")],",
            "no mark, module or body",
        ),
        (
            "rate_hz: 10, sensors: [(name: \"a\", on: \"m0\", model: \"sonic\")],",
            "ultrasonic",
        ),
        (
            "rate_hz: 10, sensors: [(name: \"a\", on: \"m0\")],",
            "one of `model` and `graph`",
        ),
        (
            "rate_hz: 10, rules: [(when: (sensor: \"frnt\", below_m: 0.3), then: [])],",
            "sensor",
        ),
        (
            "rate_hz: 10, rules: [(when: (), then: [(actuator: \"leg\", hold: 0)])],",
            "servo",
        ),
        (
            "rate_hz: 10, rules: [(when: (heard: \"nobody\", within_m: 1), then: [])],",
            "nobody",
        ),
        (
            "rate_hz: 10, rules: [(when: (within_m: 1), then: [])],",
            "one condition",
        ),
        (
            "rate_hz: 10, others: [(name: \"b\", x_m: 1.4, y_m: 1.0)],",
            "cannot start here",
        ),
        ("rate_hz: 10, start: (x_m: 1.4, y_m: 1.0),", "1:51"),
        (
            "rate_hz: 10, start: (x_m: 1.37, y_m: 1.0),",
            "start: a robot cannot start here",
        ),
        (
            "rate_hz: 10, start: (x_m: inf, y_m: 1.0),",
            "start: a robot cannot start here",
        ),
        (
            "rate_hz: 10, start: (x_m: 2.0, y_m: NaN),",
            "start: a robot cannot start here",
        ),
        (
            "rate_hz: 10, start: (x_m: 2.0, y_m: 1.0, heading_deg: inf),",
            "not a heading",
        ),
        // The start position is free, but the robot's body overlaps the wall.
        (
            "rate_hz: 10, start: (x_m: 1.46, y_m: 1.0, heading_deg: 90),",
            "start: the robot starts in a wall",
        ),
        (
            "rate_hz: 10, others: [(name: \"b\", x_m: 1.46, y_m: 1.0, heading_deg: 90)],",
            "others[0]: the robot starts in a wall",
        ),
        (
            "rate_hz: 10, others: [(name: \"b\", x_m: 2.1, y_m: 1.0)],",
            "others[0]: the robot starts in another robot",
        ),
        (
            "rate_hz: 10, others: [(name: \"robot\", x_m: 3, y_m: 1)],",
            "names must be unique",
        ),
    ] {
        let error = controller(folder.path(), &experiment, text)
            .unwrap_err()
            .to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
}

/// The strength falls by equation 2 of paper 002, a wall attenuates by 30 dB, and messages weaker than -92 dBm do not arrive.
#[test]
fn messages_arrive_with_the_strength_and_delay_of_the_closed_form() {
    let folder = folder();
    let model = "Radio(propagation: \"walls\", values: [-90.0, 2.0, 30.0])";
    std::fs::write(folder.path().join("radio.ron"), model).unwrap();
    let experiment = chain();
    let text = "rate_hz: 20, start: (x_m: 2.0, y_m: 1.0), others: [
            (name: \"near\", x_m: 2.2, y_m: 1.7), (name: \"edge\", x_m: 3.24, y_m: 1.0),
            (name: \"hidden\", x_m: 0.9, y_m: 1.0)],
        radio: (model: \"radio.ron\", every_s: 0.5, latency_s: 0.23),";
    let controller = controller(folder.path(), &experiment, text).unwrap();
    let experiment = experiment.with_controller(controller).unwrap();
    let (_, log) = steer(&experiment, None, None).unwrap();
    let robots = 4;
    let rounds: Vec<_> = log.decisions.chunks(robots).collect();
    // The wall extends from x = 1.35 to 1.45 m, and every robot is beside its middle.
    let strength_dbm = |a: [f64; 3], b: [f64; 3]| {
        let distance_m = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        let is_between = (a[0] < 1.4) != (b[0] < 1.4);
        -90.0 - 20.0 * distance_m.log10() - if is_between { 30.0 } else { 0.0 }
    };
    let mut counts = [[0; 4]; 4];
    for (round, decisions) in rounds.iter().enumerate() {
        for to in 0..robots {
            let now_s = decisions[to].sensed.time_s;
            // Ten decisions from one sending to the next.
            let expected = (0..robots).filter(|from| *from != to).filter_map(|from| {
                let mut sent = (0..round + 1).step_by(10).rev();
                sent.find_map(|at| {
                    let [sender, receiver] = [from, to].map(|robot| &rounds[at][robot].sensed);
                    let dbm = strength_dbm(sender.position_m, receiver.position_m);
                    let arrived_s = sender.time_s + 0.23;
                    (arrived_s <= now_s && dbm >= -92.0).then_some((from, sender, arrived_s, dbm))
                })
            });
            let expected: Vec<_> = expected.collect();
            let heard = &decisions[to].sensed.heard;
            assert_eq!(heard.len(), expected.len(), "{to} at {now_s} s");
            for (heard, (from, sender, arrived_s, dbm)) in heard.iter().zip(expected) {
                assert_eq!((heard.from, heard.sent_s), (from, sender.time_s));
                assert_eq!(heard.position_m, sender.position_m);
                assert!((heard.arrived_s - arrived_s).abs() < 1e-12);
                assert!((heard.strength_dbm - dbm).abs() < 1e-9, "{heard:?} {dbm}");
                counts[to][from] += 1;
            }
        }
    }
    assert!(
        counts[0][1] > 180 && counts[1][0] == counts[0][1],
        "{counts:?}"
    );
    assert!(counts[0][2] > 0 && counts[2][3] == 0, "{counts:?}");
    assert_eq!(
        counts[0][3] + counts[1][3] + counts[3].iter().sum::<i32>(),
        0
    );
}

/// Two tripods walk towards each other, and stop when a message says that the other is near; without radio they walk through each
/// other.
#[test]
fn robots_stop_for_each_other_by_radio_messages() {
    let path = common::project().join("controllers/two_tripods.ron");
    let robot = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    for name in ["rapier", "tree"] {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = 20.0;
        experiment.solver.engine = engine_by_name(name).unwrap();
        experiment.perturbation.draw = Some((1, 0));
        let hearing = Controller::read(&path, &experiment).unwrap();
        let deaf = Controller {
            radio: None,
            ..hearing.clone()
        };
        let nearest_m = [hearing, deaf].map(|controller| {
            let experiment = experiment.with_controller(controller).unwrap();
            let (run, log) = steer(&experiment, None, None).unwrap();
            assert!(run.outcome.is_completed());
            let pairs = log.decisions.chunks(2).map(|both| {
                let [a, b] = [0, 1].map(|robot| both[robot].sensed.position_m);
                (a[0] - b[0]).hypot(a[1] - b[1])
            });
            pairs.fold(f64::INFINITY, f64::min)
        });
        assert!(nearest_m[0] > 0.3, "{name}: {nearest_m:?}");
        assert!(nearest_m[1] < 0.2, "{name}: {nearest_m:?}");
    }
}
