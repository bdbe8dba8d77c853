//! Paper 001 in simulation: a random walk in an arena becomes a sensorgraph, and two ways that it has not seen are foretold.

use realgap::sensing::arena::Arena;
use realgap::sensing::graph::{Evaluation, Frame, GraphOptions, Logger, ScanLog, fit};
use realgap::sensing::range::sensor_by_name;
use realgap::statistics::{
    autocorrelation_time, independent_pairs, mean, spearman, spearman_worth,
};

use super::common;

/// The two ways of docs/fidelity/sensing.md: a bow through the middle, and a winding one.
const WAYS: [&[[f64; 2]]; 2] = [
    &[[1.0, 1.0], [4.6, 2.8], [5.3, 6.6], [6.0, 9.0]],
    &[
        [9.0, 9.0],
        [9.0, 5.0],
        [7.3, 3.4],
        [7.2, 0.7],
        [3.8, 0.8],
        [3.4, 4.2],
        [1.0, 5.2],
        [2.8, 6.8],
        [5.5, 7.5],
        [5.2, 9.2],
    ],
];

fn cartons() -> Arena {
    Arena::read(common::project().join("arenas/cartons.ron")).unwrap()
}

#[test]
fn a_random_walk_visits_the_arena_in_all_directions_and_hits_nothing() {
    let (arena, laser) = (cartons(), sensor_by_name("laser").unwrap());
    let logger = Logger::default();
    let log = logger.walk(&arena, &laser, 1400, 1).unwrap();
    assert_eq!(log, logger.walk(&arena, &laser, 1400, 1).unwrap());
    assert_ne!(log, logger.walk(&arena, &laser, 1400, 2).unwrap());
    assert_eq!((log.scans.len(), log.beams_rad.len()), (1400, 360));
    let (mut headings, mut quarters) = ([0; 12], [0; 16]);
    for scan in &log.scans {
        assert!(arena.clearance_m(scan.position_world_m) >= logger.radius_m);
        let turn = scan.heading_rad.rem_euclid(std::f64::consts::TAU);
        headings[(turn / std::f64::consts::TAU * 12.0) as usize % 12] += 1;
        let [x, y] = scan.position_world_m.map(|v| (v / 2.5) as usize);
        quarters[4 * y + x] += 1;
    }
    // A twelfth is 117, a sixteenth 88.
    assert!(headings.iter().all(|n| *n >= 40), "{headings:?}");
    assert!(
        quarters.iter().filter(|n| **n >= 15).count() >= 14,
        "{quarters:?}"
    );
    // What is written is read again, up to the rounding of a beam's direction in the header.
    let read = ScanLog::parse("log.csv", &log.to_csv()).unwrap();
    assert_eq!(read.scans, log.scans);
    let apart = read.beams_rad.iter().zip(&log.beams_rad);
    assert!(apart.into_iter().all(|(a, b)| (a - b).abs() < 1e-7));
}

#[test]
fn tables_1_to_3_of_the_paper_hold_in_the_simulated_arena() {
    let (arena, laser) = (cartons(), sensor_by_name("laser").unwrap());
    let logger = Logger::default();
    let log = logger.walk(&arena, &laser, 1400, 1).unwrap();
    let options = GraphOptions {
        frame: Some(Frame::Robot),
        ..GraphOptions::default()
    };
    let found = fit(&log, &options).unwrap();
    assert_eq!(found.polynomials, 72);
    for way in WAYS {
        let closer = Logger {
            interval_s: 0.25,
            ..logger.clone()
        };
        let run = closer.follow(&arena, &laser, way, 2).unwrap();
        let held = Evaluation::new(&found.model, &run, Some(&arena), 1).unwrap();
        println!("{held}\n");
        assert_eq!(held.segments.len(), 6);
        assert!(held.mean_absolute_error_m < held.baseline_constant_m);
        assert!(held.mann_whitney_p < 0.05 && held.spearman.unwrap() > 0.3);
        // Medians of beams with a spread of 1 cm miss those of ideal ones by millimetres.
        assert!(held.baseline_ray_casting_m.unwrap() < 0.01);
    }
}

#[test]
fn a_way_through_a_carton_or_with_another_sensor_is_refused() {
    let (arena, laser) = (cartons(), sensor_by_name("laser").unwrap());
    let logger = Logger::default();
    let follow = |way: &[[f64; 2]]| {
        let error = logger.follow(&arena, &laser, way, 1).unwrap_err();
        error.to_string()
    };
    assert!(follow(&[[1.0, 6.0], [1.6, 9.5]]).contains("0.3 m or more from every wall"));
    assert!(follow(&[[1.0, 6.0], [11.0, 6.0]]).contains("cannot start here"));
    assert!(follow(&[[1.0, 6.0]]).contains("two or more places"));
    let infrared = sensor_by_name("infrared").unwrap();
    let error = logger.walk(&arena, &infrared, 10, 1).unwrap_err();
    assert!(error.to_string().contains("reads lengths"), "{error}");
    let slow = Logger {
        speed_m_s: f64::NAN,
        ..logger
    };
    let error = slow.walk(&arena, &laser, 10, 1).unwrap_err();
    assert!(error.to_string().contains("speed"), "{error}");
}

/// Σ over an autoregressive series of first order is (1 + φ) / (1 − φ).
#[test]
fn neighbours_that_are_alike_count_as_fewer() {
    use rand::RngExt;
    use realgap::random::Numbered;
    let series = |stream: u64, phi: f64, n: usize| -> Vec<f64> {
        let mut rng = Numbered::SensorReading.generator(11, stream);
        let mut value = 0.0;
        (0..n)
            .map(|_| {
                value = phi * value + rng.random::<f64>() - 0.5;
                value
            })
            .collect()
    };
    for (phi, known) in [(0.0, 1.0), (0.5, 3.0), (0.8, 9.0)] {
        let times: Vec<f64> = (0..40)
            .map(|k| autocorrelation_time(&series(k, phi, 2000)))
            .collect();
        let time = mean(&times);
        assert!((time / known - 1.0).abs() < 0.25, "{phi}: {time}");
    }
    // Two slow series that have nothing to do with each other: as pairs they would often seem to.
    let (mut naive, mut worth) = (0, 0);
    for k in 0..200 {
        let (x, y) = (series(2 * k, 0.9, 200), series(2 * k + 1, 0.9, 200));
        naive += usize::from(spearman(&x, &y).unwrap().p_value < 0.05);
        let pairs = independent_pairs(&x, &y);
        worth += usize::from(spearman_worth(&x, &y, pairs).is_ok_and(|t| t.p_value < 0.05));
    }
    assert!(naive > 60, "{naive} of 200");
    assert!(worth < 24, "{worth} of 200");
}
