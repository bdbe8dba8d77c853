//! A held robot on a stand that gives, and without contacts.

#![allow(clippy::unwrap_used)] // a test may fail loudly

use realgap_core::file::Source;
use realgap_core::warning::Code;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{Robot, format_named};
use realgap_simulation::{Experiment, run};

use crate::change::Change as _;

/// An arm of 1 kg, 0.3 m long, that is let go beside its hinge on a stand.
const ARM: &str = r#"(name: "arm", mount: (at_m: (0, 0, 2)), bodies: [
    (name: "stand", mass_kg: 2, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
    (name: "arm", mass_kg: 1, shapes: [(form: Box(sides_m: (0.05, 0.05, 0.05)), pose: (at_m: (0.3, 0, 0)))]),
], joints: [(name: "shoulder", parent: "stand", child: "arm", kind: Turn(axis: (0, 1, 0)))], track: "stand")"#;

fn arm() -> (Morphology, Experiment) {
    let morphology = Morphology::parse(&Source::new("arm", ARM.to_owned())).unwrap();
    let mut experiment = Experiment::new(morphology.assemble());
    experiment.duration_s = 1.0;
    (morphology, experiment)
}

fn path_of(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

#[test]
fn a_stand_that_gives_moves_with_its_robot_and_the_tree_solver_says_that_it_simulates_it() {
    let (_, experiment) = arm();
    let still = path_of(&experiment);
    assert!(still.extent_m() < 1e-12);
    let soft = experiment.set("mount.stiffness_n_m", 2000.0);
    let done = run(&soft).unwrap();
    assert!(done.warnings.iter().any(|w| w.code == Code::EngineFallback));
    let moved = done.outcome.completed().unwrap();
    assert!(moved.extent_m() > 1e-3, "{}", moved.extent_m());
    let stiffer = path_of(&soft.clone().set("mount.stiffness_n_m", 4000.0));
    assert!(stiffer.extent_m() < 0.8 * moved.extent_m());
    assert_eq!(soft.second_engine(), None);
}

#[test]
fn a_robot_that_is_not_held_has_no_stand_and_needs_contacts() {
    let (_, experiment) = arm();
    let mut free = experiment;
    std::sync::Arc::make_mut(&mut free.assembly).world_from_mount = None;
    for (name, value) in [("mount.stiffness_n_m", 1e3), ("contact.on", 0.0)] {
        let said = free
            .clone()
            .set(name, value)
            .check()
            .unwrap_err()
            .to_string();
        assert!(said.contains("mount"), "{said}");
    }
}

#[test]
fn without_contacts_a_held_arm_swings_through_the_floor_in_both_engines_and_this_is_said() {
    for engine in [0.0, 1.0] {
        let (_, experiment) = arm();
        let low = experiment
            .set("floor.height_m", 1.9)
            .set("solver.engine", engine);
        let angle = |experiment: &Experiment| {
            let joints = path_of(experiment).joints().to_vec();
            joints[0]
                .angles_rad
                .iter()
                .fold(0.0_f64, |most, a| most.max(a.abs()))
        };
        let off = low.clone().set("contact.on", 0.0);
        assert!(angle(&low) < 0.6, "{}", angle(&low));
        assert!(angle(&off) > 2.0, "{}", angle(&off));
        let said = off.warnings();
        assert!(said.iter().any(|w| w.code == Code::ContactsOff), "{said:?}");
    }
}

#[test]
fn the_stand_and_missing_contacts_are_exported_or_their_absence_is_said() {
    let (morphology, experiment) = arm();
    let soft = experiment
        .set("mount.stiffness_n_m", 2000.0)
        .set("mount.stiffness_nm_rad", 50.0)
        .set("contact.on", 0.0);
    let robot = Robot::new(&morphology, &soft);
    let text = format_named("mjcf").unwrap().render(&robot).text;
    for part in [
        r#"name="stand.z" type="slide""#,
        r#"stiffness="2000""#,
        r#"type="ball""#,
        r#"contact="disable""#,
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let urdf = format_named("urdf").unwrap().render(&robot);
    let said: String = urdf.warnings.iter().map(|w| w.message.clone()).collect();
    assert!(
        said.contains("spring of the stand") && said.contains("contacts are off"),
        "{said}"
    );
}
