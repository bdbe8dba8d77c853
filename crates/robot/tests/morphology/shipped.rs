//! Tests that the robots in `morphologies/` have the masses, parts and hinges of their sources.

use nalgebra::Vector3;
use realgap_robot::morphology::{Assembly, Morphology, Role, ServoLaw};

fn shipped(name: &str) -> Morphology {
    let path = crate::common::project().join(format!("morphologies/{name}.ron"));
    Morphology::read(path).unwrap_or_else(|error| panic!("{error}"))
}

fn vector(json: &serde_json::Value) -> Vector3<f64> {
    Vector3::from_iterator((0..3).map(|i| json[i].as_f64().unwrap()))
}

fn close(a: Vector3<f64>, b: Vector3<f64>) {
    assert!((a - b).norm() < 1e-9, "{a} is not {b}");
}

/// Centre of all cubes of a part.
fn centre(assembly: &Assembly, part: usize) -> Vector3<f64> {
    let solids = &assembly.parts[part].solids;
    let sum: Vector3<f64> = solids
        .iter()
        .map(|s| s.robot_from_solid.translation.vector)
        .sum();
    sum / solids.len() as f64
}

#[test]
fn every_shipped_robot_is_valid_and_named_like_its_file() {
    let folder = crate::common::project().join("morphologies");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let morphology = Morphology::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(path.file_stem().unwrap().to_str(), Some(morphology.name()));
        assert!(!morphology.description().is_empty());
        count += 1;
    }
    assert!(count >= 7);
}

#[test]
fn the_benchmark_robots_equal_those_of_the_other_engines() {
    let golden: serde_json::Value =
        serde_json::from_str(include_str!("../golden/benchmark_robots.json")).unwrap();
    for name in ["chain3", "spider8", "chain30"] {
        let assembly = shipped(name).assemble();
        let robot = &golden["robots"][name];
        let bodies = robot["bodies"].as_array().unwrap();
        let hinges = robot["hinges"].as_array().unwrap();
        assert_eq!(
            (assembly.parts.len(), assembly.hinges.len()),
            (bodies.len(), hinges.len())
        );
        let golden_centre = |body: usize| -> Vector3<f64> {
            let cubes = bodies[body].as_array().unwrap();
            cubes.iter().map(vector).sum::<Vector3<f64>>() / cubes.len() as f64
        };
        let shift = golden_centre(0) - centre(&assembly, 0);
        for (index, part) in assembly.parts.iter().enumerate() {
            close(centre(&assembly, index) + shift, golden_centre(index));
            assert_eq!(part.solids.len(), bodies[index].as_array().unwrap().len());
            for solid in &part.solids {
                let inertia = 0.1 * 0.06 * 0.06 / 6.0;
                assert_eq!(
                    (solid.mass_kg, solid.role, solid.collides),
                    (0.1, Role::Cube, true)
                );
                assert!(
                    (solid.inertia_kg_m2 - nalgebra::Matrix3::from_diagonal_element(inertia))
                        .norm()
                        < 1e-12
                );
                let place = solid.robot_from_solid.translation.vector + shift;
                let cubes = bodies[index].as_array().unwrap();
                assert!(
                    cubes
                        .iter()
                        .any(|cube| (vector(cube) - place).norm() < 1e-9)
                );
            }
        }
        for (hinge, golden) in assembly.hinges.iter().zip(hinges) {
            assert_eq!(hinge.parent_part as u64, golden[0].as_u64().unwrap());
            assert_eq!(hinge.child_part as u64, golden[1].as_u64().unwrap());
            close(hinge.anchor_robot_m + shift, vector(&golden[2]));
            close(hinge.axis_robot.into_inner(), vector(&golden[3]));
            let actuator = hinge.actuator.unwrap();
            assert_eq!(actuator.gait.phase_rad, golden[4].as_f64().unwrap());
            assert_eq!(
                (
                    actuator.gait.offset_rad,
                    actuator.gait.amplitude_rad,
                    actuator.gait.frequency_hz
                ),
                (0.0, 0.7, 1.0)
            );
            assert_eq!(
                actuator.servo.law,
                ServoLaw::Torque {
                    stiffness_nm_rad: 5.0,
                    damping_nm_s_rad: 0.05
                }
            );
            assert_eq!(
                (actuator.servo.max_torque_nm, actuator.servo.max_speed_rad_s),
                (0.5, f64::INFINITY)
            );
        }
    }
}

#[test]
fn the_tripod_is_one_body_with_three_spinning_plates() {
    let morphology = shipped("tripod");
    let assembly = morphology.assemble();
    assert_eq!((assembly.parts.len(), assembly.hinges.len()), (4, 3));
    assert_eq!(assembly.parts[0].solids.len(), 4);
    let places = [[0.06, 0.0, 0.0], [0.0, 0.06, 0.0], [0.12, 0.0, 0.0]].map(Vector3::from);
    let normals = [-Vector3::y(), -Vector3::x(), Vector3::x()];
    for (hinge, (place, normal)) in assembly.hinges.iter().zip(places.into_iter().zip(normals)) {
        close(hinge.anchor_robot_m, place + normal * 0.03);
        close(hinge.axis_robot.into_inner(), normal);
        assert_eq!(hinge.parent_part, 0);
        let plate = &assembly.parts[hinge.child_part].solids[0];
        assert_eq!(
            (plate.role, plate.collides, plate.mass_kg),
            (Role::Plate, true, 0.012)
        );
        close(
            plate.robot_from_solid.translation.vector,
            place + normal * 0.035,
        );
        let half = Vector3::repeat(0.033) - normal.abs() * (0.033 - 0.005);
        close(plate.half_extents_m(), half);
    }
    let summary = morphology.summary();
    assert!((summary.mass_kg - (0.03 + 3.0 * 0.08)).abs() < 1e-12);
    close(summary.lower_robot_m, Vector3::new(-0.04, -0.04, -0.033));
    close(summary.upper_robot_m, Vector3::new(0.16, 0.093, 0.033));
    assert_eq!(
        (summary.modules, summary.hinges, summary.body_length_m),
        (4, 3, 0.06)
    );
    // 1.0447 rad at 1.25 Hz is a little more than 8 rad/s.
    let warnings = morphology.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].code.name(), "servo-too-slow");
    assert!(warnings[0].message.contains("leg_c"), "{}", warnings[0]);
}

#[test]
fn the_toss_cube_has_the_inertia_of_its_authors() {
    let assembly = shipped("cube").assemble();
    let cube = &assembly.parts[0].solids[0];
    assert!((cube.inertia_kg_m2[(1, 1)] / (0.2950 * 0.0524 * 0.0524) - 1.0).abs() < 1e-12);
    assert_eq!((cube.mass_kg, assembly.body_length_m), (0.37, 0.1048));
    assert!(assembly.hinges.is_empty());
}

#[test]
fn a_written_robot_is_readable() {
    insta::assert_snapshot!(shipped("two_module").to_ron().unwrap(), @r#"
    (
        name: "two_module",
        description: "two spinning face plates; its path tells friction above 0.15 and nothing of restitution: a test for what data cannot determine",
        modules: [
            (name: "front", kind: Active(side_m: 0.06, mass_kg: 0.068, face: NegX, axis: Normal(plate: (side_m: 0.062, thickness_m: 0.006, mass_kg: 0.012)), servo: (law: Velocity(gain_1_s: 30.0), max_torque_nm: 0.2, max_speed_rad_s: 8.0), gait: (offset_rad: -0.968, amplitude_rad: 1.731, frequency_hz: 1.0, phase_rad: 2.403))),
            (name: "rear", kind: Active(side_m: 0.06, mass_kg: 0.068, face: NegZ, axis: Normal(plate: (side_m: 0.062, thickness_m: 0.006, mass_kg: 0.012)), servo: (law: Velocity(gain_1_s: 30.0), max_torque_nm: 0.2, max_speed_rad_s: 8.0), gait: (offset_rad: 0.776, amplitude_rad: 1.719, frequency_hz: 1.0, phase_rad: 4.861))),
        ],
        glue: [
            (parent: "front", face: PosX, child: "rear"),
        ],
        track: "front",
    )
    "#);
}
