//! Tests of settling: robots made from genomes come to rest, or a warning says that they fell over.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap_robot::genome::{Development, Gene, Genome, Locus};
use realgap_simulation::{Experiment, settle};

fn gene(changes: &[(Locus, f64)]) -> Gene {
    let mut values = [0.0; Gene::LEN];
    for (locus, value) in changes {
        values[locus.index()] = *value;
    }
    Gene::new(values).unwrap()
}

#[test]
fn a_passive_cube_is_a_robot_and_lies_at_rest() {
    let genome = Genome::new(vec![gene(&[])]).unwrap();
    let robot = Development::default().develop("cube", &genome).unwrap();
    let rest = settle(&Experiment::new(robot.assemble())).unwrap();
    assert!(rest.is_at_rest() && !rest.is_toppled(), "{rest:?}");
    assert!(rest.warnings().is_empty());
}

#[test]
fn a_robot_that_falls_over_while_it_settles_is_flagged() {
    // A tower with an overhang at its top: the centre of mass is beyond the foot.
    let l = gene(&[(Locus::PitchPart, 0.3), (Locus::PlaceX, 1.0)]);
    let stand = gene(&[(Locus::PitchPart, 0.8), (Locus::PlaceX, 0.0)]);
    let heavy = Development {
        passive_mass_kg: 0.1,
        ..Development::default()
    };
    let genome = Genome::new(vec![gene(&[]), l, l, stand, gene(&[])]).unwrap();
    let robot = heavy.develop("leaner", &genome).unwrap();
    let rest = settle(&Experiment::new(robot.assemble())).unwrap();
    let low_x = robot.summary().centre_of_mass_robot_m.x;
    assert!(rest.is_toppled(), "{rest:?}, centre of mass at {low_x} m");
    assert!(
        rest.warnings()
            .iter()
            .any(|w| w.to_string().contains("toppled"))
    );
}
