//! Tests of the two engines: agreement, reproducibility, and experiments that one of them cannot simulate.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{ENGINES, EngineChoice, Experiment, FrictionModel, engine_by_name, run};

fn shipped(name: &str) -> Experiment {
    let file = common::project().join(format!("morphologies/{name}.ron"));
    Experiment::new(Morphology::read(file).unwrap().assemble())
}

fn motion(experiment: &Experiment, engine: EngineChoice) -> Trajectory {
    let mut chosen = experiment.clone();
    chosen.solver.engine = engine;
    let done = run(&chosen).unwrap();
    assert!(
        done.warnings
            .iter()
            .all(|w| w.code.name() != "engine-fallback")
    );
    done.outcome.into_result().unwrap()
}

/// Largest distance of two motions at equal times, metres.
fn distance_m(a: &Trajectory, b: &Trajectory) -> f64 {
    let pairs = a.positions_world_m().iter().zip(b.positions_world_m());
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn both_engines_move_a_walker_along_the_same_path() {
    let tree = engine_by_name("tree").unwrap();
    for (name, most_m) in [("chain3", 0.003), ("spider8", 0.002)] {
        let mut experiment = shipped(name);
        experiment.duration_s = 4.0;
        let far_m = distance_m(
            &motion(&experiment, EngineChoice::default()),
            &motion(&experiment, tree),
        );
        assert!(far_m < most_m, "{name}: {far_m} m");
    }
}

#[test]
fn every_engine_gives_the_same_bits_twice() {
    let mut experiment = shipped("tripod");
    experiment.duration_s = 1.0;
    for engine in ENGINES {
        assert_eq!(motion(&experiment, *engine), motion(&experiment, *engine));
    }
}

#[test]
fn a_servo_with_a_gear_swings_its_weight_the_same_way_in_both_engines() {
    let mut experiment = shipped("servo_pendulum");
    experiment.duration_s = 2.0;
    let tree = engine_by_name("tree").unwrap();
    let last_rad = |engine| {
        let motion = motion(&experiment, engine);
        motion.joints()[0].angles_rad.last().copied().unwrap()
    };
    let (one, other) = (last_rad(EngineChoice::default()), last_rad(tree));
    assert!((one - other).abs() < 0.02, "{one} {other}");
}

#[test]
fn the_error_of_an_unknown_engine_lists_the_known_ones() {
    let error = engine_by_name("tee").unwrap_err().to_string();
    assert!(
        error.contains("rapier") && error.contains("tree"),
        "{error}"
    );
}

#[test]
fn only_the_tree_solver_has_a_relaxed_cone_and_the_error_in_rapier_names_it() {
    let mut experiment = shipped("two_module");
    experiment.duration_s = 1.0;
    let tree = engine_by_name("tree").unwrap();
    let relaxed = experiment.relaxed().unwrap();
    assert!(distance_m(&motion(&experiment, tree), &motion(&relaxed, tree)) > 1e-3);
    assert!(relaxed.relaxed().is_none(), "it is relaxed already");

    experiment.contact.friction_model = FrictionModel::Relaxed;
    let error = experiment.check().unwrap_err().to_string();
    for words in ["contact.friction_model", "rapier", "`tree`"] {
        assert!(error.contains(words), "{words}: {error}");
    }
    experiment.solver.engine = tree;
    experiment.check().unwrap();
}
