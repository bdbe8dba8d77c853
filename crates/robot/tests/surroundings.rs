//! Tests of the world around the robot of an MJCF, and of the posture in which it starts.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use realgap_core::file::Source;
use realgap_robot::import::{Note, NoteKind, Options, PositionGains};
use realgap_robot::morphology::body::Surroundings;
use realgap_robot::morphology::{Assembly, Morphology, ServoLaw};

fn import_with(text: &str, options: &Options) -> (Assembly, Vec<Note>) {
    let (robot, notes) = Morphology::import(&Source::new("world.xml", text), options).unwrap();
    let ron = robot.to_ron().unwrap();
    let again = Morphology::parse(&Source::new("robot.ron", &ron)).unwrap();
    assert_eq!(robot.assemble(), again.assemble(), "{ron}");
    (robot.assemble(), notes)
}

fn import(text: &str) -> (Assembly, Vec<Note>) {
    import_with(text, &Options::default())
}

fn says(notes: &[Note], kind: NoteKind, part: &str) -> bool {
    notes
        .iter()
        .any(|note| note.kind == kind && note.what.contains(part))
}

fn world(inside: &str) -> String {
    format!("<mujoco>{inside}</mujoco>")
}

const CUBE: &str = r#"<body name="cube" pos="2 3 .3"><freejoint/><geom type="box" size=".05 .05 .05" mass="1" friction="0.05"/></body>"#;

#[test]
fn gravity_slope_height_and_friction_of_the_file_are_those_of_experiments() {
    let (robot, notes) = import(&world(&format!(
        r#"<option gravity="0 0 -1.62"/><worldbody>
        <geom type="plane" size="5 5 1" pos="0 0 0.1" euler="0 20 0" friction="0.03"/>{CUBE}</worldbody>"#
    )));
    let around = &robot.surroundings;
    assert_eq!(around.gravity_m_s2, Some(1.62));
    // Of two shapes MuJoCo takes the larger coefficient.
    assert_eq!(around.floor_friction, Some(0.05));
    assert!((around.floor_slope_rad.unwrap() - 20_f64.to_radians()).abs() < 1e-12);
    assert!((around.floor_height_m.unwrap() - 0.1).abs() < 1e-12);
    assert!(
        says(&notes, NoteKind::Assumed, "gravity of 1.62 m/s²"),
        "{notes:?}"
    );
    assert!(
        says(&notes, NoteKind::Assumed, "slopes by 20.00 degrees"),
        "{notes:?}"
    );
}

#[test]
fn the_friction_of_a_shape_with_priority_and_of_the_lowest_shape_counts() {
    let (robot, notes) = import(&world(
        r#"<worldbody><geom type="plane" size="5 5 1" friction="0.9"/>
        <body name="rover" pos="0 0 .3"><freejoint/><geom type="box" size=".1 .1 .05" mass="1"/>
        <geom type="sphere" size=".03" pos="0 0 -.1" friction="0.2" priority="1"/></body></worldbody>"#,
    ));
    assert_eq!(robot.surroundings.floor_friction, Some(0.2));
    assert!(
        says(&notes, NoteKind::Assumed, "shapes have 0.2 to 1 there"),
        "{notes:?}"
    );
}

#[test]
fn a_floor_that_leans_sideways_and_gravity_that_does_not_point_down_are_said() {
    let (robot, notes) = import(&world(&format!(
        r#"<option gravity="1 0 -9"/><worldbody><geom type="plane" size="5 5 1" euler="20 0 0"/>{CUBE}</worldbody>"#
    )));
    assert_eq!(robot.surroundings, Surroundings::default());
    assert!(
        says(&notes, NoteKind::LeftOut, "the floor leans"),
        "{notes:?}"
    );
    assert!(
        says(&notes, NoteKind::LeftOut, "gravity (1, 0, -9)"),
        "{notes:?}"
    );
}

#[test]
fn fixed_and_free_boxes_beside_the_robot_stand_where_they_stood_from_it() {
    let (robot, notes) = import(&world(&format!(
        r#"<worldbody><geom type="plane" size="5 5 1"/><geom type="box" name="wall" size=".1 1 .5" pos="3 3 .5"/>
        <body name="crate" pos="2 4 .1"><freejoint/><geom type="box" size=".1 .1 .1" mass="0.5"/></body>
        <body name="target" mocap="true" pos="1 0 .5"><geom size=".02" contype="0" conaffinity="0"/></body>{CUBE}</worldbody>"#
    )));
    let bodies = &robot.surroundings.bodies;
    let found: Vec<_> = bodies.iter().map(|b| (b.pose.at_m, b.mass_kg)).collect();
    // The cube starts at (2, 3) in the file, and above the origin here.
    assert_eq!(found[0].1, None);
    assert_eq!(bodies[0].boxes[0].sides_m, (0.2, 2.0, 1.0));
    assert_eq!(bodies[0].boxes[0].pose.at_m, (3.0, 3.0, 0.5));
    assert_eq!(found[0].0, (-2.0, -3.0, 0.0));
    assert_eq!(found[1], ((0.0, 1.0, 0.1), Some(0.5)));
    assert!(
        says(&notes, NoteKind::LeftOut, "(mocap) stand still: `target`"),
        "{notes:?}"
    );
}

#[test]
fn of_a_held_robot_the_end_of_its_longest_chain_is_tracked_and_not_the_world() {
    let (robot, notes) = import(&world(
        r#"<worldbody><body name="base"><geom type="box" size=".05 .05 .05" mass="1"/>
        <body name="arm"><joint name="a" axis="0 1 0"/><geom size=".02" mass="0.1"/>
        <body name="hand" pos=".2 0 0"><joint name="h" axis="0 1 0"/><geom size=".02" mass="0.1"/></body></body></body></worldbody>"#,
    ));
    assert_eq!(robot.track_part, 2);
    assert!(
        says(
            &notes,
            NoteKind::Assumed,
            "centre of mass of `hand` is recorded"
        ),
        "{notes:?}"
    );
}

const LEG: &str = r#"<worldbody><body name="hip"><geom size=".05" mass="1"/>
    <body name="leg"><joint name="knee" axis="0 1 0" range="-90 90"/><geom size=".02" pos="0 0 -.1" mass="0.1"/>
    <body name="foot" pos="0 0 -.2"><joint name="ankle" axis="0 1 0"/><geom size=".02" mass="0.1"/></body></body></body></worldbody>
    <actuator><position joint="knee" kp="20" kv="1"/></actuator>
    <keyframe><key name="low" qpos="-1.2 0"/><key name="home" qpos="0.5 0.25" ctrl="0.6"/></keyframe>"#;

#[test]
fn joints_start_in_the_keyframe_home_or_in_the_one_that_is_asked_for() {
    let start = |options: &Options| {
        let (robot, notes) = import_with(&world(LEG), options);
        let hold = robot.hinges[0].actuator.unwrap().gait.offset_rad;
        (hold, robot.hinges[1].start_rad, notes)
    };
    let (hold, ankle, notes) = start(&Options::default());
    assert_eq!((hold, ankle), (0.6, Some(0.25)));
    assert!(
        says(&notes, NoteKind::Assumed, "keyframe home; others are low"),
        "{notes:?}"
    );
    let low = Options {
        keyframe: Some("low".to_owned()),
        ..Options::default()
    };
    assert_eq!(start(&low).0, -1.2);
    let strange = Options {
        keyframe: Some("high".to_owned()),
        ..Options::default()
    };
    let error = Morphology::import(&Source::new("leg.xml", world(LEG)), &strange);
    let error = error.unwrap_err().to_string();
    assert!(error.contains("low, home"), "{error}");
}

#[test]
fn stated_gains_take_angles_where_the_motor_took_torques_before_its_gear() {
    let text = world(
        r#"<worldbody><body name="b"><geom size=".05" mass="1"/><body name="arm"><joint name="j" axis="0 1 0"/>
        <geom size=".02" pos=".1 0 0" mass=".1"/></body></body></worldbody>
        <actuator><motor joint="j" gear="150" ctrlrange="-1 1"/></actuator>"#,
    );
    let gains = PositionGains {
        stiffness_nm_rad: 20.0,
        damping_nm_s_rad: 1.0,
    };
    let options = Options {
        gains: [("j".to_owned(), gains)].into(),
        ..Options::default()
    };
    let (robot, _) = import_with(&text, &options);
    let actuator = robot.hinges[0].actuator.unwrap();
    assert!(matches!(actuator.servo.law, ServoLaw::Torque { .. }));
    assert!(actuator.command.is_none(), "{:?}", actuator.command);
    assert_eq!(actuator.servo.max_torque_nm, 150.0);
}

#[test]
fn a_servo_of_speeds_follows_them_by_its_damping_and_damping_without_end_is_bounded() {
    let (robot, notes) = import(&world(
        r#"<worldbody><body name="b"><geom size=".05" mass="1"/><body name="arm"><joint name="j" axis="0 1 0" damping="1e11"/>
        <geom size=".02" pos=".1 0 0" mass=".1"/></body></body></worldbody>
        <actuator><velocity joint="j" kv="3" gear="2"/></actuator>"#,
    ));
    let actuator = robot.hinges[0].actuator.unwrap();
    assert!(actuator.servo.law.follows_speeds());
    // kv gear² = 12, and a command of 1 is half a radian per second at the joint.
    let ServoLaw::Torque {
        damping_nm_s_rad, ..
    } = actuator.servo.law
    else {
        panic!("{:?}", actuator.servo.law);
    };
    assert_eq!((damping_nm_s_rad, actuator.command.factor), (12.0, 0.5));
    assert_eq!(robot.hinges[0].bearing.viscous_nm_s_rad, 1e9);
    assert!(
        says(&notes, NoteKind::Changed, "damping 100000000000"),
        "{notes:?}"
    );
}

#[test]
fn the_timestep_follows_a_stiff_servo_of_a_light_finger_and_says_so() {
    let finger = |kp: f64, kv: f64| {
        import(&world(&format!(
            r#"<worldbody><body name="palm"><geom size=".05" mass="1"/><body name="tip"><joint name="bend" axis="0 1 0"/>
            <geom size=".008" pos="0 0 -.02" mass=".002"/></body></body></worldbody>
            <actuator><position joint="bend" kp="{kp}" kv="{kv}"/></actuator>"#
        )))
    };
    let (usual, _) = finger(0.1, 0.0);
    assert_eq!(usual.surroundings.timestep_s, None);
    let (stiff, notes) = finger(1.0, 0.0);
    let inertia = 0.002 * (0.02_f64.powi(2) + 0.4 * 0.008_f64.powi(2));
    let expected_s = inertia.sqrt();
    assert!((stiff.surroundings.timestep_s.unwrap() - expected_s).abs() < 1e-6);
    assert!(
        says(&notes, NoteKind::Assumed, "joint `bend` vibrates"),
        "{notes:?}"
    );
    // With its damping, it does not vibrate.
    assert_eq!(finger(1.0, 0.01).0.surroundings.timestep_s, None);
}

#[test]
fn condim_decides_which_of_torsional_and_rolling_friction_count() {
    let stated = |condim: &str| {
        let (robot, notes) = import(&world(&format!(
            r#"<worldbody><geom type="plane" size="5 5 1" friction="0.9 0.01 0.003"/>
            <body name="rover" pos="0 0 .3"><freejoint/><geom type="sphere" size=".1" mass="1" friction="0.5 0.02 0.001" {condim}/>
            <geom type="sphere" size=".05" pos="0 0 .2" friction="0.5 0.03 0.001" {condim}/></body></worldbody>"#
        )));
        let around = robot.surroundings.clone();
        let own: Vec<_> = robot.parts[0].solids.iter().map(|s| s.turning).collect();
        (around.floor_torsional_m, around.floor_rolling_m, own, notes)
    };
    // MuJoCo takes the larger one of two shapes; the second shape has more than the floor's on it.
    for (condim, torsional_m, rolling_m, more_m) in [
        ("", None, None, 0.0),
        (r#"condim="3""#, None, None, 0.0),
        (r#"condim="4""#, Some(0.02), None, 0.01),
        (r#"condim="6""#, Some(0.02), Some(0.003), 0.01),
    ] {
        let (found_torsional_m, found_rolling_m, own, notes) = stated(condim);
        assert_eq!(found_torsional_m, torsional_m, "{condim}");
        assert_eq!(found_rolling_m, rolling_m, "{condim}");
        let most_m = own.iter().map(|own| own.torsional_m).fold(0.0, f64::max);
        assert!((most_m - more_m).abs() < 1e-12, "{condim}: {most_m}");
        assert!(own.iter().all(|own| own.rolling_m == 0.0));
        let is_said = says(&notes, NoteKind::Assumed, "torsional friction 0.02 m");
        assert_eq!(is_said, torsional_m.is_some(), "{notes:?}");
    }
}
