//! Tests of the assembly: which modules move together, and in which direction hinges turn.

use nalgebra::{Point3, Unit, UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_robot::morphology::{Assembly, Morphology, Role};

fn assemble(modules: &str, glue: &str) -> Assembly {
    let text = format!(
        "(name: \"x\",
        defaults: (side_m: 0.1, mass_kg: 1, servo: (law: Velocity(gain_1_s: 9), max_torque_nm: 1)),
        modules: [{modules}], glue: [{glue}])"
    );
    Morphology::parse(&Source::new("x.ron", text))
        .unwrap_or_else(|error| panic!("{error}"))
        .assemble()
}

const PLATE: &str = "plate: (side_m: 0.08, thickness_m: 0.02, mass_kg: 0.1)";

fn close(a: Vector3<f64>, b: Vector3<f64>) {
    assert!((a - b).norm() < 1e-12, "{a} is not {b}");
}

#[test]
fn a_module_on_the_driven_face_moves_with_it_and_the_plate_has_mass_but_no_contacts() {
    let assembly = assemble(
        &format!(
            "(name: \"a\", kind: Active(face: PosX, axis: Normal({PLATE}))),
             (name: \"b\", kind: Passive()), (name: \"c\", kind: Passive())"
        ),
        "(parent: \"a\", face: PosX, child: \"b\"), (parent: \"b\", face: PosY, child: \"c\")",
    );
    assert_eq!((assembly.parts.len(), assembly.hinges.len()), (2, 1));
    let moved: Vec<_> = assembly.parts[1]
        .solids
        .iter()
        .map(|solid| (solid.module, solid.role, solid.collides))
        .collect();
    assert_eq!(
        moved,
        [
            (0, Role::Plate, false),
            (1, Role::Cube, true),
            (2, Role::Cube, true)
        ]
    );
    // There is no gap for the plate.
    close(
        assembly.parts[1].solids[1]
            .robot_from_solid
            .translation
            .vector,
        Vector3::new(0.1, 0.0, 0.0),
    );
}

#[test]
fn a_plate_has_the_inertia_of_a_uniform_slab() {
    let assembly = assemble(
        &format!("(name: \"a\", kind: Active(face: PosZ, axis: Normal({PLATE})))"),
        "",
    );
    let inertia = assembly.parts[1].solids[0].inertia_kg_m2;
    assert!((inertia[(2, 2)] - 0.1 * (0.08_f64.powi(2) * 2.0) / 12.0).abs() < 1e-15);
    assert!((inertia[(0, 0)] - 0.1 * (0.08_f64.powi(2) + 0.02_f64.powi(2)) / 12.0).abs() < 1e-15);
}

#[test]
fn a_cube_attached_by_its_driven_face_turns_in_the_opposite_direction() {
    // The same two bodies, once with a and once with b as the root; b drives the face between them.
    let drive = format!("Active(face: NegX, axis: Normal({PLATE}))");
    let modules = format!("(name: \"a\", kind: Passive()), (name: \"b\", kind: {drive})");
    let from_a = assemble(&modules, "(parent: \"a\", face: PosX, child: \"b\")");
    let from_b = assemble(&modules, "(parent: \"b\", face: NegX, child: \"a\")");
    for assembly in [&from_a, &from_b] {
        assert_eq!(
            (
                assembly.hinges[0].parent_part,
                assembly.hinges[0].child_part
            ),
            (0, 1)
        );
        assert_eq!(assembly.hinges[0].module, 1);
    }
    // b's outward normal is −x; a turns about it relative to b, so b turns about +x relative to a.
    close(from_b.hinges[0].axis_robot.into_inner(), -Vector3::x());
    close(from_a.hinges[0].axis_robot.into_inner(), Vector3::x());
    let angle = 0.3;
    let turned = |assembly: &Assembly| {
        UnitQuaternion::from_axis_angle(&assembly.hinges[0].axis_robot, angle)
    };
    let b_from_a_described_from_a = turned(&from_a).inverse();
    let b_from_a_described_from_b = turned(&from_b);
    assert!(b_from_a_described_from_a.angle_to(&b_from_a_described_from_b) < 1e-12);
    // The plate belongs to the part of module a in both cases.
    let plate_part = |assembly: &Assembly| {
        assembly
            .parts
            .iter()
            .position(|part| part.solids.iter().any(|s| s.role == Role::Plate))
    };
    assert_eq!(
        (plate_part(&from_a), plate_part(&from_b)),
        (Some(0), Some(1))
    );
}

#[test]
fn the_child_face_points_at_the_parent_and_quarter_turns_are_right_handed() {
    let child = |extra: &str| {
        let assembly = assemble(
            "(name: \"a\", kind: Passive()), (name: \"b\", kind: Passive(centre_of_mass_m: (0.01, 0.02, 0.03)))",
            &format!("(parent: \"a\", face: PosX, child: \"b\"{extra})"),
        );
        assembly.parts[0].solids[1].robot_from_solid
    };
    assert!(child("").rotation.angle() < 1e-12);
    close(child("").translation.vector, Vector3::new(0.1, 0.0, 0.0));
    // A quarter turn about +x brings the child's y onto the robot's z.
    close(
        child(", quarter_turns: 1").rotation * Vector3::y(),
        Vector3::z(),
    );
    // The same face on both sides: half a turn about z, so the z axis keeps its direction.
    close(
        child(", child_face: PosX").rotation * Vector3::x(),
        -Vector3::x(),
    );
    close(
        child(", child_face: PosX").rotation * Vector3::z(),
        Vector3::z(),
    );
    // The child's top points at the parent: a quarter turn about y.
    close(
        child(", child_face: PosZ").rotation * Vector3::z(),
        -Vector3::x(),
    );
    close(
        child(", child_face: PosZ").rotation * Vector3::y(),
        Vector3::y(),
    );
}

#[test]
fn a_bending_axis_turns_with_its_module() {
    let assembly = assemble(
        "(name: \"a\", kind: Passive()),
         (name: \"b\", kind: Active(face: PosX, axis: Tangent(axis: PosY))),
         (name: \"c\", kind: Passive())",
        "(parent: \"a\", face: PosX, child: \"b\", quarter_turns: 1), (parent: \"b\", face: PosX, child: \"c\")",
    );
    let hinge = &assembly.hinges[0];
    close(hinge.axis_robot.into_inner(), Vector3::z());
    close(hinge.anchor_robot_m, Vector3::new(0.15, 0.0, 0.0));
    // Positive angles about +z swing the child towards +y.
    let swing = UnitQuaternion::from_axis_angle(&Unit::new_normalize(Vector3::z()), 0.1);
    assert!((swing * Point3::new(0.05, 0.0, 0.0)).y > 0.0);
}

#[test]
fn modules_of_different_size_touch() {
    let assembly = assemble(
        "(name: \"a\", kind: Passive()), (name: \"b\", kind: Passive(side_m: 0.04))",
        "(parent: \"a\", face: NegZ, child: \"b\")",
    );
    close(
        assembly.parts[0].solids[1]
            .robot_from_solid
            .translation
            .vector,
        Vector3::new(0.0, 0.0, -0.07),
    );
}

#[test]
fn the_tracked_module_gives_the_point_and_the_body_length() {
    let text = "(name: \"x\", modules: [
            (name: \"a\", kind: Passive(side_m: 0.1, mass_kg: 1)),
            (name: \"b\", kind: Passive(side_m: 0.06, mass_kg: 1)),
        ], glue: [(parent: \"a\", face: PosY, child: \"b\")], track: \"b\")";
    let assembly = Morphology::parse(&Source::new("x.ron", text))
        .unwrap()
        .assemble();
    assert_eq!((assembly.track_part, assembly.body_length_m), (0, 0.06));
    close(
        assembly.robot_from_track.translation.vector,
        Vector3::new(0.0, 0.08, 0.0),
    );
}
