//! Property tests of genomes and development, and tests of refused genome files.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::BTreeMap;

use crate::common;
use proptest::prelude::*;
use realgap_core::file::Source;
use realgap_core::random::Numbered;
use realgap_robot::genome::{Development, DevelopmentError, Gene, Genome, Individual, Locus};
use realgap_robot::morphology::Morphology;

fn genomes(most: usize) -> impl Strategy<Value = Genome> {
    // The ends of the range matter: 1 must select the last choice, not one beyond it.
    let number = prop_oneof![8 => 0.0..=1.0_f64, 1 => Just(0.0), 1 => Just(1.0)];
    let gene = prop::collection::vec(number, Gene::LEN)
        .prop_map(|values| Gene::new(values.try_into().unwrap()).unwrap());
    prop::collection::vec(gene, 1..=most).prop_map(|genes| Genome::new(genes).unwrap())
}

fn settings(max_modules: usize) -> Development {
    Development {
        max_modules,
        ..Development::default()
    }
}

fn gene(changes: &[(Locus, f64)]) -> Gene {
    let mut values = [0.0; Gene::LEN];
    for (locus, value) in changes {
        values[locus.index()] = *value;
    }
    Gene::new(values).unwrap()
}

proptest! {
    #[test]
    fn a_genome_develops_into_a_valid_robot_or_gives_a_reason(genome in genomes(12)) {
        let settings = settings(12);
        match settings.develop("robot", &genome) {
            Ok(robot) => {
                prop_assert_eq!(robot.modules().len(), genome.len());
                // The robot is connected: every module but the root is a child, and all are reached from the root.
                prop_assert_eq!(robot.attachments().len() + 1, genome.len());
                let solids: Vec<_> = robot.assemble().parts.into_iter().flat_map(|part| part.solids).collect();
                let boxes: Vec<_> = solids.iter().filter(|solid| solid.collides).map(|solid| {
                    let half = (solid.robot_from_solid.rotation * solid.half_extents_m()).abs();
                    let centre = solid.robot_from_solid.translation.vector;
                    (centre - half, centre + half)
                }).collect();
                for (index, (lower, upper)) in boxes.iter().enumerate() {
                    for (other_lower, other_upper) in &boxes[..index] {
                        let depth = (upper.inf(other_upper) - lower.sup(other_lower)).min();
                        prop_assert!(depth <= 1e-6, "boxes overlap by {} m", depth);
                    }
                }
                // The default plate is as large as its cube, which gives the warning `tied-plate`.
                let others: Vec<_> = robot.warnings().into_iter().filter(|w| w.code.name() != "tied-plate").collect();
                prop_assert!(others.is_empty(), "{:?}", others);
            }
            Err(error) => {
                prop_assert!(!matches!(error, DevelopmentError::Refused(_)), "{}", error);
                prop_assert!(!error.to_string().is_empty());
            }
        }
        prop_assert_eq!(settings.develop("robot", &genome), settings.develop("robot", &genome));
    }

    #[test]
    fn a_written_genome_and_its_robot_are_read_back_equal(genome in genomes(5), other in any::<bool>()) {
        let mut individual = Individual::new("writ_ten", genome);
        if other {
            individual.development.passive_share = 0.25;
            individual.development.amplitude_rad = (0.1, 1.0 / 3.0);
        }
        let text = individual.to_ron().unwrap();
        let back = Individual::parse(&Source::new("genome.ron", text)).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!(&back, &individual);
        if let Ok(robot) = individual.develop() {
            let back = Morphology::parse(&Source::new("robot.ron", robot.to_ron().unwrap()))
                .map_err(|e| TestCaseError::fail(e.to_string()))?;
            prop_assert_eq!(back, robot);
        }
    }

    #[test]
    fn a_plate_larger_than_the_cube_is_refused_or_fits_and_never_panics(genome in genomes(8), side_m in 0.01..0.2_f64) {
        let settings = Development { plate_side_m: side_m, ..settings(8) };
        if let Err(error) = settings.develop("robot", &genome) {
            prop_assert!(!error.to_string().is_empty());
        }
    }
}

#[test]
fn building_turns_the_part_and_places_the_module_on_top() {
    // Two modules form a tower that is laid on its side towards +x; a third module is added at the far end.
    let genome = Genome::new(vec![
        gene(&[]),
        gene(&[(Locus::Kind, 1.0), (Locus::FaceModule, 0.9)]), // faces -z, towards the module below
        gene(&[(Locus::PitchPart, 0.3), (Locus::PlaceX, 1.0)]),
    ])
    .unwrap();
    let robot = Development::default().develop("robot", &genome).unwrap();
    let attachments: Vec<_> = robot
        .attachments()
        .iter()
        .map(|g| (g.parent, g.face.name(), g.child))
        .collect();
    assert_eq!(attachments, [(0, "PosX", 1), (1, "PosZ", 2)]);
    // The module turned together with the part: it still faces the first module.
    assert_eq!(robot.modules()[1].driven_face().unwrap().name(), "NegX");
    assert_eq!(robot.assemble().parts.len(), 2);
}

#[test]
fn every_development_error_occurs_and_names_the_modules() {
    let active = |changes: &[(Locus, f64)]| {
        let mut all = vec![(Locus::Kind, 1.0)];
        all.extend_from_slice(changes);
        gene(&all)
    };
    let (up, down, pos_x) = (0.7, 0.9, 0.0);
    let develop = |genes: Vec<Gene>| {
        settings(4)
            .develop("robot", &Genome::new(genes).unwrap())
            .unwrap_err()
    };
    assert_eq!(
        develop(vec![
            active(&[(Locus::FaceModule, up)]),
            active(&[(Locus::FaceModule, down)])
        ]),
        DevelopmentError::ServoOnServo {
            module: 1,
            below: 0
        }
    );
    assert_eq!(
        develop(vec![gene(&[]); 5]),
        DevelopmentError::TooManyModules {
            found: 5,
            allowed: 4
        }
    );
    // An L of the cells (0,0,0), (1,0,0) and (1,0,1); the next module is placed on (0,0,0), beside (1,0,1).
    let l = |third: Gene| {
        vec![
            gene(&[]),
            gene(&[]),
            Gene::new({
                let mut values = *third.values();
                values[Locus::PitchPart.index()] = 0.3;
                values[Locus::PlaceX.index()] = 1.0;
                values
            })
            .unwrap(),
        ]
    };
    let with = |third: Gene, fourth: Gene| {
        let mut genes = l(third);
        genes.push(fourth);
        develop(genes)
    };
    assert_eq!(
        with(gene(&[]), active(&[(Locus::FaceModule, pos_x)])),
        DevelopmentError::NoRoomForPlate {
            module: 3,
            neighbour: 2
        }
    );
    // After the turn the second module faces up from (1,0,0), and the third faces the same cell from (0,0,1).
    assert_eq!(
        develop(vec![
            gene(&[]),
            active(&[(Locus::FaceModule, 0.2)]),
            active(&[(Locus::FaceModule, pos_x), (Locus::PitchPart, 0.3)]),
        ]),
        DevelopmentError::PlateOnPlate {
            module: 2,
            neighbour: 1
        }
    );
    assert_eq!(
        with(active(&[(Locus::FaceModule, 0.2)]), gene(&[])),
        DevelopmentError::PlateInTheWay {
            module: 3,
            neighbour: 2
        }
    );
}

#[test]
fn most_random_genomes_of_the_published_sizes_develop() {
    let mut outcomes: BTreeMap<&str, usize> = BTreeMap::new();
    for draw in 0..1000 {
        let mut rng = Numbered::SearchStep.generator(1, draw);
        let genome = Genome::random(1 + draw as usize % 5, &mut rng).unwrap();
        let outcome = Development::default().develop("robot", &genome);
        *outcomes
            .entry(outcome.map_or_else(|error| error.code(), |_| "developed"))
            .or_default() += 1;
    }
    assert!(outcomes["developed"] > 800, "{outcomes:?}");
}

#[test]
fn a_plate_that_hits_its_own_robot_is_found_if_it_turns_far_enough() {
    // The module in (0,0,0) drives a plate on its top; the module in (1,0,1) is beside that plate.
    let robot = |amplitude: f64| {
        let genome = Genome::new(vec![
            // The face points along -x, and up after the turn of the third module.
            gene(&[
                (Locus::Kind, 1.0),
                (Locus::FaceModule, 0.2),
                (Locus::Amplitude, amplitude),
                (Locus::Offset, 0.5),
            ]),
            gene(&[]),
            gene(&[(Locus::PitchPart, 0.3), (Locus::PlaceX, 1.0)]),
        ]);
        Development::default()
            .develop("robot", &genome.unwrap())
            .unwrap()
    };
    assert_eq!(
        robot(1.0).modules()[0].driven_face().unwrap().name(),
        "PosZ"
    );
    assert_eq!(robot(1.0).blocked_plates(), [(0, 2)]);
    assert_eq!(robot(0.0).blocked_plates(), []);
    let tripod = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    assert_eq!(tripod.blocked_plates(), []);
}

fn refusal(text: &str) -> String {
    Individual::parse(&Source::new("g.ron", text))
        .unwrap_err()
        .to_string()
}

#[test]
fn a_bad_genome_file_is_refused_with_line_and_reason() {
    let row = "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0]";
    for (text, parts) in [
        (
            format!("Genome(modules: 2, genes: [{row}])"),
            vec!["g.ron:1:", "genes", "1 genes", "one gene per module, 2"],
        ),
        (
            "Genome(modules: 1,\n genes: [[0, 0, 0]])".to_owned(),
            vec!["g.ron:2:", "genes[0]", "3 numbers", "10 numbers: kind"],
        ),
        (
            "Genome(modules: 1,\n genes: [[0, NaN, 0, 0, 0, 0, 0, 0, 0, 0]])".to_owned(),
            vec!["g.ron:2:", "genes[0][1]", "NaN", "roll_part"],
        ),
        (
            "Genome(modules: 1,\n genes: [[0, 0, 0, 0, 0, 0, 1.5, 0, 0, 0]])".to_owned(),
            vec!["genes[0][6]", "out of bounds", "1.5", "0 to 1"],
        ),
        (
            "Genome(modules: 0, genes: [])".to_owned(),
            vec!["without modules", "1 to 200"],
        ),
        (
            format!("Genome(modules: 2, genes: [{row}, {row}], development: (max_modules: 1))"),
            vec!["more modules than the settings allow", "max_modules"],
        ),
        (
            format!("Genome(modules: 1, genes: [{row}], development: (frequency_hz: (2, 1)))"),
            vec!["frequency_hz", "(2, 1) Hz", "low not above high"],
        ),
        (
            format!("Genome(modules: 1, genes: [{row}], developement: ())"),
            vec!["unknown field", "did you mean `development`?"],
        ),
    ] {
        let error = refusal(&text);
        for part in parts {
            assert!(error.contains(part), "{part:?} is missing from\n{error}");
        }
    }
}
