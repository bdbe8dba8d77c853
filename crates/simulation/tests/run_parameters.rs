//! Parameters that differ between runs.

use realgap_core::file::Source;
use realgap_robot::morphology::Morphology;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{ParameterSet, by_name};

fn experiment(run: Option<&str>) -> Experiment {
    let text = r#"(name: "cube", defaults: (side_m: 0.1, mass_kg: 0.3), modules: [(name: "body", kind: Passive())], glue: [])"#;
    let robot = Morphology::parse(&Source::new("cube.ron", text)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.run = run.map(Into::into);
    experiment
}

fn set(values: &[&str]) -> ParameterSet {
    values.iter().map(|value| value.parse().unwrap()).collect()
}

#[test]
fn a_run_has_its_own_value_and_an_unknown_run_the_median_of_the_others() {
    let values = set(&[
        "run.tiles_1.floor.friction=0.2",
        "floor.friction=0.9",
        "run.tiles_2.floor.friction=0.4",
        "run.tiles_3.floor.friction=1.1",
        "run.tiles_4.floor.friction=0.1",
    ]);
    let friction = |run| values.apply(&experiment(run)).floor.friction;
    assert_eq!(friction(Some("tiles_1")), 0.2);
    assert_eq!(friction(Some("tiles_2")), 0.4);
    for unknown in [Some("rubber"), None] {
        assert!((friction(unknown) - 0.3).abs() < 1e-12, "{unknown:?}");
    }
}

#[test]
fn runs_may_share_a_value_by_their_names_and_others_keep_what_holds_for_all() {
    let values = set(&[
        "run.tiles_*.floor.friction=0.2",
        "floor.friction=0.9",
        "run.tiles_3.floor.friction=0.25",
    ]);
    let friction = |run| values.apply(&experiment(run)).floor.friction;
    assert_eq!(friction(Some("tiles_1")), 0.2);
    assert_eq!(friction(Some("tiles_3")), 0.25);
    let floors = set(&["run.tiles_*.floor.friction=0.2", "floor.friction=0.9"]);
    for other in [Some("rubber"), None] {
        assert_eq!(floors.apply(&experiment(other)).floor.friction, 0.9);
    }
}

#[test]
fn names_of_runs_are_parts_of_names_of_parameters() {
    let parameter = by_name("run.2026-11-03_a.floor.friction").unwrap();
    assert_eq!(parameter.run(), Some("2026-11-03_a"));
    assert_eq!(parameter.robot(), None);
    assert_eq!(parameter.of_all().name, "floor.friction");
    assert!(parameter.of_run("b").is_err());
    assert!(by_name("run.a.robot.b.floor.friction").is_err());
    assert!(by_name("run..floor.friction").is_err());
    assert!(by_name("run.a.floor.frictoin").is_err());
}
