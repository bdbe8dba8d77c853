//! Objects of a robot's file, beside the robot.

use realgap_core::file::Source;
use realgap_robot::import::{NoteKind, Options};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, engine_by_name, film};

/// An arm that is fixed to the world beside a table, on which a block lies.
const BESIDE_A_TABLE: &str = r#"<mujoco model="arm">
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="table" pos="0.5 0 0.1"><geom type="box" size="0.2 0.2 0.1"/></body>
    <body name="arm" pos="0 0 0.6">
      <joint name="shoulder" axis="0 1 0"/><geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.3" mass="0.5"/>
    </body>
    <body name="block" pos="0.45 0.02 0.23"><freejoint/><geom type="box" size="0.03 0.02 0.03" mass="0.2"/></body>
  </worldbody>
  <actuator><position joint="shoulder" kp="20" kv="1" forcerange="-5 5"/></actuator>
</mujoco>
"#;

#[test]
fn a_block_on_the_table_of_a_held_arm_is_no_part_of_the_arm_and_stays_on_the_table() {
    let source = Source::new("arm.xml", BESIDE_A_TABLE);
    let (robot, notes) = Morphology::import(&source, &Options::default()).unwrap();
    let robot = robot.assemble();
    assert_eq!(robot.hinges.len(), 1, "the block has no joints");
    let taken = notes.iter().any(|note| {
        note.kind == NoteKind::Assumed
            && note.what.contains("stand in its `world` as boxes: `block`")
    });
    assert!(taken, "{notes:?}");
    for engine in ["rapier", "tree"].map(|name| engine_by_name(name).unwrap()) {
        let mut experiment = Experiment::new(robot.clone());
        experiment.solver.engine = engine;
        experiment.duration_s = 1.0;
        let film = film(&experiment).unwrap().1.unwrap();
        let poses = &film.scene[0];
        let (first, last) = (
            poses[0].translation.vector,
            poses[poses.len() - 1].translation.vector,
        );
        assert!((first.z - 0.23).abs() < 2e-3, "{engine:?}: {first}");
        assert!((last - first).norm() < 2e-3, "{engine:?}: {first} {last}");
    }
}

#[test]
fn objects_are_lifted_with_a_robot_that_would_start_in_the_floor_and_left_out_where_joints_alone_were_recorded()
 {
    let low = BESIDE_A_TABLE.replace("pos=\"0 0 0.6\"", "pos=\"0 0 0.2\"");
    let import = |options: &Options| {
        let source = Source::new("arm.xml", &low);
        let (robot, notes) = Morphology::import(&source, options).unwrap();
        (robot.assemble(), notes)
    };
    let (raised, _) = import(&Options::default());
    let height_m = raised.surroundings.bodies[0].pose.at_m.2 - 0.23;
    assert!(height_m > 0.1, "{height_m}");
    let (lifted, notes) = import(&Options {
        lifted: true,
        ..Options::default()
    });
    assert!(lifted.surroundings.bodies.is_empty());
    let said = |note: &realgap_robot::import::Note| note.what.contains("bodies beside the robot");
    assert!(notes.iter().any(said), "{notes:?}");
}
