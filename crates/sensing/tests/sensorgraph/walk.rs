//! Repeats paper 001 in simulation: a sensorgraph is fitted to a random walk in an arena and evaluated on two other paths.

use realgap_core::statistics::{
    autocorrelation_time, independent_pairs, mean, spearman, spearman_effective,
};
use realgap_sensing::arena::Arena;
use realgap_sensing::graph::{Evaluation, Frame, GraphOptions, Logger, ScanLog, fit};
use realgap_sensing::range::sensor_by_name;

use super::common;

/// The two paths of docs/validation/sensing.md in each arena: a short one, and a winding one.
const AMONG_CARTONS: [&[[f64; 2]]; 2] = [
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
const IN_THE_PEN: [&[[f64; 2]]; 2] = [
    &[[3.2, 3.2], [4.4, 4.6], [5.6, 5.2], [6.8, 6.6]],
    &[
        [6.9, 6.7],
        [6.9, 4.2],
        [5.4, 3.5],
        [3.3, 3.3],
        [3.5, 5.0],
        [5.2, 4.6],
        [6.1, 5.8],
        [4.6, 6.3],
        [3.2, 6.7],
    ],
];

fn arena(name: &str) -> Arena {
    Arena::read(common::project().join(format!("arenas/{name}.ron"))).unwrap()
}

#[test]
fn a_random_walk_visits_the_arena_in_all_directions_and_hits_nothing() {
    let (arena, laser) = (arena("cartons"), sensor_by_name("laser").unwrap());
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
    // An even distribution would have 117 scans in each of twelve headings and 88 in each of sixteen squares.
    assert!(headings.iter().all(|n| *n >= 40), "{headings:?}");
    assert!(
        quarters.iter().filter(|n| **n >= 15).count() >= 14,
        "{quarters:?}"
    );
    // A written log is read back unchanged, up to the rounding of a beam's direction in the header.
    let read = ScanLog::parse("log.csv", &log.to_csv()).unwrap();
    assert_eq!(read.scans, log.scans);
    let beams = read.beams_rad.iter().zip(&log.beams_rad);
    assert!(beams.into_iter().all(|(a, b)| (a - b).abs() < 1e-7));
}

/// Fits 72 polynomials to a random walk of 1400 scans and evaluates them on both paths.
fn held(name: &str, ways: [&[[f64; 2]]; 2]) -> [Evaluation; 2] {
    let (arena, laser) = (arena(name), sensor_by_name("laser").unwrap());
    let logger = Logger::default();
    let log = logger.walk(&arena, &laser, 1400, 1).unwrap();
    let options = GraphOptions {
        frame: Some(Frame::Robot),
        ..GraphOptions::default()
    };
    let found = fit(&log, &options).unwrap();
    assert_eq!(found.polynomials, 72);
    let closer = Logger {
        interval_s: 0.25,
        ..logger
    };
    ways.map(|way| {
        let run = closer.follow(&arena, &laser, way, 2).unwrap();
        let held = Evaluation::new(&found.model, &run, Some(&arena), 1).unwrap();
        println!("{name}: {held}\n");
        // Medians of beams with a standard deviation of 1 cm differ from those of ideal beams by millimetres.
        assert!(held.baseline_ray_casting_m.unwrap() < 0.01);
        assert_eq!(held.segments.len(), 6);
        held
    })
}

/// The paper has mean errors of 17 to 66 cm, rank correlations of 0.30 to 0.98, and errors below random ones at a level of 5 %.
#[test]
fn tables_1_to_3_of_the_paper_hold_in_a_pen_of_cartons() {
    let ways = held("pen", IN_THE_PEN);
    for way in &ways {
        assert!(way.mean_absolute_error_m < 0.5 * way.baseline_constant_m);
        assert!(way.mann_whitney_p < 0.05 && way.p.unwrap() < 0.05);
        for segment in &way.segments {
            assert!(segment.mean_absolute_error_m < 0.65, "{segment:?}");
            assert!(segment.spearman.unwrap() > 0.3, "{segment:?}");
            assert!(segment.p.unwrap() < 0.05, "{segment:?}");
        }
    }
    // The short path has the information of three independent scans, too few for a test of each segment.
    let [_, winding] = ways;
    assert!(winding.segments.iter().all(|s| s.mann_whitney_p < 0.05));
}

/// Cartons in the middle cause steps in the ranges that a polynomial of fourth degree cannot represent, so the model is only somewhat
/// better than constants.
#[test]
fn ranges_among_cartons_are_predicted_better_than_by_constants() {
    for way in held("cartons", AMONG_CARTONS) {
        assert!(way.mean_absolute_error_m < way.baseline_constant_m);
        assert!(way.mann_whitney_p < 0.05 && way.spearman.unwrap() > 0.3);
    }
}

#[test]
fn a_way_through_a_carton_or_with_another_sensor_is_refused() {
    let (arena, laser) = (arena("cartons"), sensor_by_name("laser").unwrap());
    let logger = Logger::default();
    let follow = |way: &[[f64; 2]]| {
        let error = logger.follow(&arena, &laser, way, 1).unwrap_err();
        error.to_string()
    };
    assert!(follow(&[[1.0, 6.0], [1.6, 9.5]]).contains("0.3 m or more from every wall"));
    assert!(follow(&[[1.0, 6.0], [11.0, 6.0]]).contains("out of the field"));
    assert!(follow(&[[1.0, 6.0]]).contains("two or more places"));
    let infrared = sensor_by_name("infrared").unwrap();
    let error = logger.walk(&arena, &infrared, 10, 1).unwrap_err();
    assert!(
        error.to_string().contains("whose readings are lengths"),
        "{error}"
    );
    let slow = Logger {
        speed_m_s: f64::NAN,
        ..logger
    };
    let error = slow.walk(&arena, &laser, 10, 1).unwrap_err();
    assert!(error.to_string().contains("speed"), "{error}");
}

/// An arena that does not belong to the log is detected because scans are inside of its walls.
#[test]
fn a_log_with_scans_inside_of_a_wall_gives_a_warning() {
    let (cartons, laser) = (arena("cartons"), sensor_by_name("laser").unwrap());
    let log = Logger::default().walk(&cartons, &laser, 200, 1).unwrap();
    let model = fit(&log, &GraphOptions::default()).unwrap().model;
    let codes = |arena: &Arena| -> Vec<&str> {
        let held = Evaluation::new(&model, &log, Some(arena), 1).unwrap();
        held.warnings.iter().map(|w| w.code.name()).collect()
    };
    assert!(!codes(&cartons).contains(&"inside-wall"));
    assert!(codes(&arena("paper000")).contains(&"inside-wall"));
}

/// The autocorrelation time of an autoregressive series of first order is (1 + φ) / (1 − φ).
#[test]
fn correlated_neighbours_count_as_fewer_samples() {
    use rand::RngExt;
    use realgap_core::random::Numbered;
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
    // Two independent series with strong autocorrelation often seem correlated if all pairs are counted as independent.
    let (mut naive, mut effective) = (0, 0);
    for k in 0..200 {
        let (x, y) = (series(2 * k, 0.9, 200), series(2 * k + 1, 0.9, 200));
        naive += usize::from(spearman(&x, &y).unwrap().p_value < 0.05);
        let pairs = independent_pairs(&x, &y);
        effective += usize::from(spearman_effective(&x, &y, pairs).is_ok_and(|t| t.p_value < 0.05));
    }
    assert!(naive > 60, "{naive} of 200");
    assert!(effective < 24, "{effective} of 200");
}
