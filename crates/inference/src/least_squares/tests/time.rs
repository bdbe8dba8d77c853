//! Whether blocks of time of a log agree about what no other log tells.

use super::*;

/// Windows of a log, and errors in each.
const WINDOWS: usize = 24;
const EACH: usize = 6;
const NOISE: f64 = 0.05;

/// Fits two parameters. The first log is cut into windows and reads the first parameter, which is off its mean by `drift` times a
/// normal number in each of six spans of time; the second parameter is read by the other logs, or by the only one, too. Returns the
/// 90 % interval of the first.
fn first_of_a_log_that_drifts(seed: u64, logs: usize, drift: f64) -> (f64, f64) {
    let grid = grid(&[("told_once", 0.0, 1.0), ("other", 0.0, 1.0)]);
    let mut random = Generator::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let own = WINDOWS * EACH;
    let model = |values: &[f64]| -> Vec<f64> {
        let weight = |k: usize| 1.0 + 0.1 * (k % EACH) as f64;
        let read = |k: usize| match (logs, k < own) {
            (1, _) if k.is_multiple_of(2) => values[0] + values[1],
            (1, _) => values[0] - values[1],
            (_, true) => weight(k) * values[0],
            (_, false) => weight(k) * values[1],
        };
        (0..logs * own).map(read).collect()
    };
    let off: Vec<f64> = (0..6).map(|_| drift * normal()).collect();
    let mut recorded = model(&[0.5, 0.4]);
    for (k, value) in recorded.iter_mut().enumerate() {
        let span = (k < own).then(|| off[6 * k / own]);
        *value += span.unwrap_or(0.0) + NOISE * normal();
    }
    let windows = (0..WINDOWS * logs).map(|window| ErrorBlock {
        channel: 0,
        log: window / WINDOWS,
        count: EACH,
        resolution: 0.0,
    });
    let (estimates, _) = fitted(&grid, &model, &recorded, windows.collect(), 80);
    (estimates[0].low, estimates[0].high)
}

/// How many of 24 intervals hold the truth, and their mean width.
fn held(logs: usize, drift: f64) -> (usize, f64) {
    let all = (0..24).map(|seed| first_of_a_log_that_drifts(seed, logs, drift));
    let all: Vec<(f64, f64)> = all.collect();
    let inside = all.iter().filter(|(low, high)| *low <= 0.5 && 0.5 <= *high);
    let width = all.iter().map(|(low, high)| high - low).sum::<f64>() / 24.0;
    (inside.count(), width)
}

#[test]
fn a_log_that_alone_tells_of_a_parameter_and_contradicts_itself_over_time_leaves_it_open() {
    for logs in [4, 1] {
        let (steady, narrow) = held(logs, 0.0);
        let (drifting, wide) = held(logs, 0.1);
        // 90 % of 24 are 21.6, with a standard deviation of 1.5.
        assert!(steady >= 18, "{logs}: {steady} of 24, width {narrow}");
        assert!(drifting >= 18, "{logs}: {drifting} of 24, width {wide}");
        // The mean of six spans has a standard deviation of 0.04, without the drift that of 144 readings is 0.004.
        assert!(wide > 3.0 * narrow, "{logs}: {wide} and {narrow}");
    }
}
