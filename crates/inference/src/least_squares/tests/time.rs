//! What a log tells alone, and whether its own blocks of time agree about it.

use super::*;

/// Windows of the log that alone tells of the first parameter, and errors in each.
const WINDOWS: usize = 24;
const EACH: usize = 6;
const LOGS: usize = 4;
const NOISE: f64 = 0.05;

/// Fits two parameters. The first log is cut into windows and reads the first parameter, which is off its mean by `drift` times a
/// normal number in each of six spans of time; the other logs read the second one. Returns the 90 % interval of the first.
fn first_of_a_log_that_drifts(seed: u64, drift: f64) -> (f64, f64) {
    let grid = grid(&[("told_once", 0.0, 1.0), ("told_often", 0.0, 1.0)]);
    let mut random = Generator::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let own = WINDOWS * EACH;
    let model = |values: &[f64]| -> Vec<f64> {
        let weight = |k: usize| 1.0 + 0.1 * (k % EACH) as f64;
        let read = |k: usize| values[usize::from(k >= own)] * weight(k);
        (0..own + (LOGS - 1) * own).map(read).collect()
    };
    let off: Vec<f64> = (0..6).map(|_| drift * normal()).collect();
    let mut recorded = model(&[0.5, 0.4]);
    for (k, value) in recorded.iter_mut().enumerate() {
        let span = (k < own).then(|| off[6 * k / own]);
        *value += span.unwrap_or(0.0) + NOISE * normal();
    }
    let windows = (0..WINDOWS * LOGS).map(|window| ErrorBlock {
        channel: 0,
        log: window / WINDOWS,
        count: EACH,
        resolution: 0.0,
    });
    let (estimates, _) = fitted(&grid, &model, &recorded, windows.collect(), 80);
    (estimates[0].low, estimates[0].high)
}

#[test]
fn a_log_that_alone_tells_of_a_parameter_and_contradicts_itself_over_time_leaves_it_open() {
    let fits = 24;
    let held = |drift: f64| {
        let all = (0..fits).map(|seed| first_of_a_log_that_drifts(seed, drift));
        let all: Vec<(f64, f64)> = all.collect();
        let inside = all.iter().filter(|(low, high)| *low <= 0.5 && 0.5 <= *high);
        let width = all.iter().map(|(low, high)| high - low).sum::<f64>() / fits as f64;
        (inside.count(), width)
    };
    let (steady, narrow) = held(0.0);
    let (drifting, wide) = held(0.1);
    // 90 % of 24 are 21.6, with a standard deviation of 1.5.
    assert!(steady >= 18, "{steady} of {fits}, width {narrow}");
    assert!(drifting >= 18, "{drifting} of {fits}, width {wide}");
    // The mean of six spans has a standard deviation of 0.04, without the drift that of 144 readings is 0.004.
    assert!(wide > 3.0 * narrow, "{wide} and {narrow}");
}
