//! Property tests of random robots, and of parsing arbitrary text.

use std::collections::HashSet;

use nalgebra::Vector3;
use proptest::prelude::*;
use realgap_core::file::Source;
use realgap_robot::morphology::{
    Actuator, Assembly, Attachment, Blueprint, CommandScale, Drive, DriveAxis, Face, Gait, Module,
    Morphology, Plate, Role, Servo, ServoLaw,
};

/// Random numbers for one step of growing a robot: they select module, faces and drive.
type Seed = (prop::sample::Index, u8, u8, u8, u8, f64, f64);

fn seeds() -> impl Strategy<Value = Vec<Seed>> {
    let seed = (
        any::<prop::sample::Index>(),
        0..6_u8,
        0..6_u8,
        0..4_u8,
        0..12_u8,
        1e-6..1000.0_f64,
        -1000.0..1000.0_f64,
    );
    prop::collection::vec(seed, 1..40)
}

fn module(index: usize, seed: &Seed) -> Module {
    let &(_, _, _, turns, kind, mass_kg, angle) = seed;
    let face = Face::ALL[usize::from(kind % 6)];
    let mut module = Module::passive(format!("m{index}"), 0.06, mass_kg);
    if angle > 0.0 {
        module.inertia_kg_m2 = Some([angle, angle * 1.5, angle * 2.0]);
        module.centre_of_mass_m = Some(Vector3::new(0.01, -0.02, angle * 1e-5));
    }
    if kind >= 6 {
        return module;
    }
    module.drive = Some(Drive {
        face,
        axis: match face.perpendicular().nth(turns.into()) {
            Some(axis) if angle < 300.0 => DriveAxis::Tangent { axis },
            _ => DriveAxis::Normal {
                plate: Some(Plate {
                    side_m: 0.066,
                    thickness_m: 0.006,
                    mass_kg: 0.012,
                }),
            },
        },
        actuator: Actuator {
            servo: Servo {
                law: if turns == 0 {
                    ServoLaw::Velocity {
                        gain_per_s: mass_kg,
                    }
                } else {
                    ServoLaw::Torque {
                        stiffness_nm_rad: mass_kg,
                        damping_nm_s_rad: 0.1,
                    }
                },
                max_torque_nm: mass_kg,
                max_speed_rad_s: if angle < 0.0 { f64::INFINITY } else { mass_kg },
                delay_s: 0.0,
            },
            gait: Gait {
                offset_rad: angle,
                amplitude_rad: -angle,
                frequency_hz: 1.0 / 3.0,
                phase_rad: angle / 7.0,
            },
            command: CommandScale::default(),
        },
    });
    module
}

/// Grows a valid robot: a step that the crate refuses is skipped, and a servo that moves nothing is removed.
fn grow(seeds: &[Seed]) -> Morphology {
    let mut blueprint = Blueprint {
        name: "random".to_owned(),
        description: "grown \"at\" random, \\ with quotes".to_owned(),
        modules: vec![Module {
            drive: None,
            ..module(0, &seeds[0])
        }],
        attachments: Vec::new(),
        pivots: Vec::new(),
        collision_exclude: Vec::new(),
        mount_world_m: None,
        track: None,
    };
    for seed in &seeds[1..] {
        let child = blueprint.modules.len();
        let mut bigger = blueprint.clone();
        let parent = seed.0.index(child);
        bigger.modules.push(module(child, seed));
        let mut face = Face::ALL[usize::from(seed.1)];
        if let Some(drive) = blueprint.modules[parent].drive.filter(|_| seed.4 % 2 == 0) {
            face = drive.face;
        }
        bigger.attachments.push(Attachment {
            parent,
            face,
            child,
            child_face: Face::ALL[usize::from(seed.2)],
            quarter_turns: seed.3,
        });
        bigger.track = Some(seed.0.index(child + 1));
        // A bending module needs a module on its driven face, which a later step may add.
        let passive = |blueprint: &Blueprint| {
            let mut relaxed = blueprint.clone();
            for (index, module) in relaxed.modules.iter_mut().enumerate() {
                let moves = |drive: &Drive| {
                    matches!(drive.axis, DriveAxis::Normal { .. })
                        || blueprint.attachments.iter().any(|g| {
                            (g.parent, g.face) == (index, drive.face)
                                || (g.child, g.child_face) == (index, drive.face)
                        })
                };
                module.drive = module.drive.filter(moves);
            }
            relaxed
        };
        if Morphology::new(passive(&bigger)).is_ok() {
            blueprint = passive(&bigger);
        }
    }
    Morphology::new(blueprint).expect("grown step by step")
}

fn corners(assembly: &Assembly) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    assembly
        .parts
        .iter()
        .flat_map(|part| &part.solids)
        .filter(|solid| solid.collides)
        .map(|solid| {
            let half = (solid.robot_from_solid.rotation * solid.half_extents_m()).abs();
            let centre = solid.robot_from_solid.translation.vector;
            (centre - half, centre + half)
        })
        .collect()
}

proptest! {
    #[test]
    fn a_valid_robot_assembles_to_connected_parts_of_the_same_mass(seeds in seeds()) {
        let morphology = grow(&seeds);
        let assembly = morphology.assemble();

        // Every part but the first is the child of exactly one hinge, whose parent precedes it.
        prop_assert_eq!(assembly.hinges.len() + 1, assembly.parts.len());
        for (index, hinge) in assembly.hinges.iter().enumerate() {
            prop_assert_eq!(hinge.child_part, index + 1);
            prop_assert!(hinge.parent_part < hinge.child_part);
            prop_assert!((hinge.axis_robot.norm() - 1.0).abs() < 1e-12);
        }
        let drives = morphology.modules().iter().filter(|module| module.drive.is_some()).count();
        prop_assert_eq!(assembly.hinges.len(), drives);

        // Every module and every plate is in exactly one part.
        prop_assert!(assembly.parts.iter().all(|part| !part.solids.is_empty()));
        let mut seen = HashSet::new();
        for solid in assembly.parts.iter().flat_map(|part| &part.solids) {
            let fresh = seen.insert((solid.module, solid.role == Role::Cube));
            prop_assert!(fresh);
        }
        let expected: f64 = morphology
            .modules()
            .iter()
            .map(|module| module.mass_kg + module.plate().map_or(0.0, |plate| plate.mass_kg))
            .sum();
        let summary = morphology.summary();
        prop_assert!((summary.mass_kg / expected - 1.0).abs() < 1e-12);

        let boxes = corners(&assembly);
        for (index, (lower, upper)) in boxes.iter().enumerate() {
            for (other_lower, other_upper) in &boxes[..index] {
                let depth = upper.inf(other_upper) - lower.sup(other_lower);
                prop_assert!(depth.min() <= 1.1e-6, "boxes overlap by {} m", depth.min());
            }
            prop_assert!((summary.lower_robot_m - lower).max() < 1e-9);
            prop_assert!((upper - summary.upper_robot_m).max() < 1e-9);
        }
    }

    #[test]
    fn a_written_robot_is_read_back_equal(seeds in seeds()) {
        let morphology = grow(&seeds);
        let text = morphology.to_ron().expect("writable");
        let back = Morphology::parse(&Source::new("back.ron", text)).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!(back, morphology);
    }

    #[test]
    fn no_bytes_make_the_parser_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(source) = Source::from_bytes("x.ron", bytes, "morphology") {
            let _ = Morphology::parse(&source).map_err(|error| error.to_string());
        }
    }

    #[test]
    fn no_random_ron_tokens_make_the_parser_panic(text in "([(){}\\[\\],:\"'/*\\\\#rb \n-]|name|modules|kind|Passive|r#\"|0x1|1e9|é|\u{feff}){0,80}") {
        let source = Source::new("x.ron", text);
        let _ = Morphology::parse(&source).map_err(|error| error.to_string());
        let _ = source.locate("modules[3].kind.side_m");
    }

    #[test]
    fn no_mutation_of_a_good_file_makes_the_parser_panic(
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0..3_u8, prop::sample::select(vec![
                "(", ")", "[", "]", ",", ":", "\"", "-", "0", "9", ".", "e", "NaN", "inf", "/*", "//", "'", "core", "PosX", " ", "\n", "ü",
            ])),
            1..8,
        )
    ) {
        let mut text: Vec<char> = include_str!("../../../../morphologies/tripod.ron").chars().collect();
        for (place, kind, piece) in edits {
            let at = place.index(text.len());
            match kind {
                0 => { text.remove(at); }
                1 => { text.splice(at..at, piece.chars()); }
                _ => { let end = (at + 12).min(text.len()); text.splice(at..end, piece.chars()); }
            }
        }
        let source = Source::new("x.ron", text.into_iter().collect::<String>());
        match Morphology::parse(&source) {
            Ok(morphology) => {
                morphology.assemble();
            }
            Err(error) => {
                let (line, _) = error.line_column().expect("every error of a file has a line");
                prop_assert!(line >= 1 && line <= source.text().lines().count() + 1);
            }
        }
    }
}
