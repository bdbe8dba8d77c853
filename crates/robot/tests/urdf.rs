//! Tests of the URDF import of robots of boxes and hinges.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap_core::file::Source;
use realgap_robot::import::Options;
use realgap_robot::morphology::Morphology;

fn import(urdf: &str) -> (Morphology, Vec<String>) {
    let source = Source::new("robot.urdf", urdf);
    let (robot, notes) = Morphology::import(&source, &Options::default()).unwrap();
    (robot, notes.iter().map(ToString::to_string).collect())
}

const LINK: &str = r#"<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="2e-4" izz="3e-4"/></inertial>
    <collision><geometry><box size="0.1 0.06 0.04"/></geometry></collision>"#;

#[test]
fn an_imported_pendulum_has_the_axis_limits_and_inertia_of_its_file() {
    let urdf = format!(
        r#"<robot name="swing"><link name="world"/><link name="bob">{LINK}</link><link name="arm">{LINK}</link>
        <joint name="fix" type="fixed"><origin xyz="0 0 1"/><parent link="world"/><child link="bob"/></joint>
        <joint name="pivot" type="revolute"><origin xyz="0 0 -0.1" rpy="0 0 1.5707963267948966"/><parent link="bob"/><child link="arm"/>
        <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="0.5" velocity="3"/><dynamics damping="0.01" friction="0.002"/></joint></robot>"#
    );
    let (robot, left_out) = import(&urdf);
    let assembly = robot.assemble();
    let hinge = &assembly.hinges[0];
    // The joint's frame is rotated by a quarter turn: its x axis is the robot's y axis.
    assert!(
        (hinge.axis_robot.y - 1.0).abs() < 1e-9,
        "{:?}",
        hinge.axis_robot
    );
    assert_eq!(hinge.bearing.limits_rad, Some((-1.0, 1.0)));
    assert!((hinge.bearing.viscous_nm_s_rad - 0.01).abs() < 1e-12);
    assert!(
        left_out
            .iter()
            .any(|note| note.contains("the servos of 1 joints")),
        "{left_out:?}"
    );
    // The moments of inertia are rotated with the frame.
    let arm = assembly.parts[hinge.child_part].mass(&nalgebra::Isometry3::identity());
    assert!(
        (arm.inertia_kg_m2[(0, 0)] - 2e-4).abs() < 1e-9,
        "{}",
        arm.inertia_kg_m2
    );
    assert!(assembly.world_from_mount.is_some());
}

#[test]
fn links_that_are_fixed_to_each_other_are_one_body() {
    let (robot, _) = import(&format!(
        r#"<robot name="two"><link name="a">{LINK}</link><link name="b">{LINK}</link>
        <joint name="j" type="fixed"><origin xyz="0.1 0 0"/><parent link="a"/><child link="b"/></joint></robot>"#
    ));
    let assembly = robot.assemble();
    assert_eq!(assembly.parts.len(), 1);
    let mass = assembly.parts[0].mass(&nalgebra::Isometry3::identity());
    assert!((mass.mass_kg - 0.4).abs() < 1e-12);
    // Steiner: two masses of 0.2 kg, each 5 cm from the middle.
    let expected = 2.0 * 2e-4 + 0.4 * 0.05 * 0.05;
    assert!(
        (mass.inertia_kg_m2[(1, 1)] - expected).abs() < 1e-9,
        "{}",
        mass.inertia_kg_m2
    );
}
