//! Noise floors, gaps, ratios and confidences agree with values calculated by hand, and have their nominal coverage where the
//! truth is known.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use nalgebra::Vector3;
use realgap_core::unit::Unit;
use realgap_lab::prediction::gap::{
    CaseRuns, Confidence, Distances, Fitness, OverTime, Sample, Scoring, distances, noise_floor,
};
use realgap_path::comparison::{Components, Context, Measurement, Metric, Needs, Pair, by_name};
use realgap_path::trajectory::Trajectory;

const BODY_M: f64 = 0.06;

/// Interval of a hand-made gap and of its floor, each end as a factor.
const GAP_FACTOR: f64 = 3.199679;
const FLOOR_FACTOR: f64 = 6.402_51;

/// A path along x that ends at `far_m`, swung sideways by `bend_m` in its middle.
fn path(far_m: f64, bend_m: f64) -> Sample {
    let times: Vec<f64> = (0..182).map(|i| f64::from(i) * 0.1).collect();
    let positions = (0..182)
        .map(|i| {
            let share = f64::from(i) / 181.0;
            let side = bend_m * (std::f64::consts::PI * share).sin();
            Vector3::new(far_m * share, side, 0.0)
        })
        .collect();
    Sample::new("path", Trajectory::new(times, positions).unwrap()).unwrap()
}

fn straight(lengths: &[f64]) -> Vec<Sample> {
    lengths.iter().map(|far_m| path(*far_m, 0.0)).collect()
}

fn scoring(metrics: &[&str]) -> Scoring {
    Scoring {
        metrics: metrics.iter().map(|name| by_name(name).unwrap()).collect(),
        components: Components::default(),
        body_length_m: Some(BODY_M),
        channels: None,
        seed: 1,
    }
}

fn one_case(real: &[Sample], ideal: Option<Sample>, repeats: Vec<Sample>) -> Vec<CaseRuns> {
    vec![CaseRuns {
        recordings: (0..real.len()).collect(),
        ideal,
        repeats,
    }]
}

fn codes(found: &Distances) -> Vec<&str> {
    found.warnings.iter().map(|w| w.code.name()).collect()
}

#[test]
fn floor_gap_and_ratio_of_a_small_set_agree_with_values_calculated_by_hand() {
    let real = straight(&[1.0, 2.0, 4.0]);
    let cases = one_case(&real, Some(path(3.0, 0.0)), straight(&[3.0, 5.0]));
    let found = distances(&real, &cases, &scoring(&["displacement"])).unwrap();
    let row = found.metrics[0];
    // Distances between the recordings: 1, 3, 2. Distances of the path of 3 m to them: 2, 1, 1; of the path of 5 m: 4, 3, 1.
    let (ideal, repeats) = (row.ideal.unwrap(), row.repeats.unwrap());
    for (value, expected) in [
        (row.floor.unwrap().value, 2.0),
        (ideal.gap.value, 4.0 / 3.0),
        (ideal.ratio.unwrap().value, 2.0 / 3.0),
        (repeats.gap.value, 2.0),
        (repeats.ratio.unwrap().value, 1.0),
    ] {
        assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    }
    // By numpy and scipy.stats.t.ppf(0.975, 2): without each recording the gap is 1, 3/2, 3/2 and the floor 2, 3, 1, and t times
    // the root of the variance is 4.302653 times 0.270310 (the jackknife's of the logarithms) and 0.431510 (a quarter of the
    // jackknife's 0.411472, and that of a pair over the square of the mean, 1 / 4, over 3).
    let (gap, floor) = (ideal.gap, row.floor.unwrap());
    for (found, expected) in [
        (gap.high.unwrap() / gap.value, GAP_FACTOR),
        (gap.value / gap.low.unwrap(), GAP_FACTOR),
        (floor.high.unwrap() / floor.value, FLOOR_FACTOR),
        (floor.value / floor.low.unwrap(), FLOOR_FACTOR),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
    assert!(codes(&found).contains(&"few-recordings"));
}

#[test]
fn two_recordings_have_a_noise_floor_and_no_interval() {
    let floor = noise_floor(&straight(&[1.0, 1.5]), &scoring(&["displacement"])).unwrap();
    let found = floor.metrics[0].floor;
    assert!((found.value - 0.5).abs() < 1e-12, "{found:?}");
    assert_eq!((found.low, found.high), (None, None));
    assert_eq!((floor.recordings, floor.pairs), (2, 1));
    assert_eq!(floor.warnings[0].code.name(), "few-recordings");
}

/// A metric that is not symmetric: the net displacement of the first path, whatever the second is.
struct First;

impl Metric for First {
    fn name(&self) -> &'static str {
        "first"
    }
    fn column(&self) -> &'static str {
        "first_m"
    }
    fn unit(&self) -> Unit {
        Unit::Metre
    }
    fn doc(&self) -> &'static str {
        "net displacement of the first"
    }
    fn needs(&self) -> Needs {
        Needs::POINTS
    }
    fn is_symmetric(&self) -> bool {
        false
    }
    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> realgap_core::Result<Measurement> {
        let far_m = pair.real_prepared.net_displacement_m();
        Ok(Measurement::new(far_m, 182))
    }
}

#[test]
fn an_asymmetric_metric_is_measured_both_ways() {
    let scoring = Scoring {
        metrics: vec![&First],
        ..scoring(&[])
    };
    // The metric is 1 in one direction and 3 in the other, so that the mean is 2.
    let floor = noise_floor(&straight(&[1.0, 3.0]), &scoring).unwrap();
    let value = floor.metrics[0].floor.value;
    assert!((value - 2.0).abs() < 1e-12, "{value}");
}

#[test]
fn the_floor_does_not_depend_on_the_simulation() {
    let real = drawn(8, 3, 1.0);
    let floor = |ideal: Sample| {
        let cases = one_case(&real, Some(ideal), Vec::new());
        let found = distances(&real, &cases, &scoring(&["pca", "rms"])).unwrap();
        [0, 1].map(|index| found.metrics[index].floor.unwrap())
    };
    assert_eq!(floor(path(1.1, 0.1)), floor(path(9.0, 3.0)));
}

/// Independent repeats of a random length and bend.
fn drawn(count: usize, seed: u64, longer: f64) -> Vec<Sample> {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let mut uniform = || rng.random_range(0.0..1.0_f64) + rng.random_range(0.0..1.0_f64);
            let far_m = longer + 0.2 * uniform();
            path(far_m, 0.3 * uniform())
        })
        .collect()
}

#[test]
fn a_simulation_of_the_same_distribution_has_ratio_1_and_its_nominal_confidence() {
    let sets = 100;
    let (mut ratios, mut covered, mut confidences) = (Vec::new(), 0, Vec::new());
    for seed in 0..sets {
        let real = drawn(20, 1000 + seed, 1.0);
        let cases = one_case(&real, None, drawn(200, seed, 1.0));
        let found = distances(&real, &cases, &scoring(&["rms"])).unwrap();
        let ratio = found.metrics[0].repeats.unwrap().ratio.unwrap();
        covered += usize::from(ratio.low.unwrap() <= 1.0 && 1.0 <= ratio.high.unwrap());
        ratios.push(ratio.value);
        let confidence = Confidence::new(&real, &cases, BODY_M).unwrap().unwrap();
        confidences.push(confidence.over_time);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    // Single ratios scatter by about 0.1, so their mean over 100 sets by 0.01.
    assert!((mean(&ratios) - 1.0).abs() < 0.04, "{}", mean(&ratios));
    // The intervals are 95 % intervals: 89 or fewer of 100 hold the truth with a probability of about 1 %.
    assert!(covered >= 89, "{covered} of {sets} intervals hold 1");
    // The mean over 2000 recordings has a standard error of 0.007.
    assert!(
        (mean(&confidences) - 0.9).abs() < 0.02,
        "{}",
        mean(&confidences)
    );
}

#[test]
fn a_shifted_simulation_has_a_large_ratio_and_its_confidence_drops() {
    let real = drawn(12, 1, 1.0);
    let cases = one_case(&real, Some(path(2.2, 0.3)), drawn(60, 2, 2.0));
    let found = distances(&real, &cases, &scoring(&["rms", "pca"])).unwrap();
    for row in &found.metrics {
        for side in [row.ideal.unwrap(), row.repeats.unwrap()] {
            assert!(side.ratio.unwrap().low.unwrap() > 3.0, "{row:?}");
        }
    }
    let confidence = Confidence::new(&real, &cases, BODY_M).unwrap().unwrap();
    let first_s = confidence.below_half_s.unwrap();
    assert!(first_s > 0.0 && first_s < 9.0, "{first_s}");
    assert_eq!(confidence.inside[181].count, 0);
    assert_eq!(confidence.inside[0].count, 12);
    let fitness = Fitness::new(&real, &cases).unwrap().unwrap();
    assert!(fitness.mann_whitney.p_value < 1e-4);
    assert!(fitness.kolmogorov_smirnov.p_value < 1e-4);
}

#[test]
fn errors_over_time_agree_with_values_calculated_by_hand() {
    let real = straight(&[1.0, 2.0, 4.0]);
    let cases = one_case(&real, Some(path(3.0, 0.0)), straight(&[3.0, 5.0]));
    let over = OverTime::new(&real, &cases);
    // At the end the ideal run is at 3 and the recordings are at 1, 2, 4. The mean of the repeats is at 4. Each recording is also
    // compared with the mean of the other recordings (3, 2.5, 1.5).
    let at_end = [
        (over.ideal_m.unwrap(), (4.0 + 1.0 + 1.0_f64) / 3.0),
        (over.simulated_mean_m.unwrap(), (9.0 + 4.0 + 0.0_f64) / 3.0),
        (over.real_mean_m.unwrap(), (4.0 + 0.25 + 6.25_f64) / 3.0),
    ];
    for (curve, squared) in at_end {
        assert_eq!(curve.len(), 182);
        assert_eq!(curve[0], 0.0);
        assert!((curve[181] - squared.sqrt()).abs() < 1e-12);
    }
    assert!((over.times_s[181] - 18.1).abs() < 1e-9);
    let alone = straight(&[1.0]);
    let over = OverTime::new(&alone, &one_case(&alone, None, Vec::new()));
    assert!(over.real_mean_m.is_none() && over.ideal_m.is_none());
}

#[test]
fn one_recording_or_recordings_with_different_starts_have_no_floor() {
    let alone = straight(&[1.0]);
    let cases = one_case(&alone, Some(path(2.0, 0.0)), Vec::new());
    let found = distances(&alone, &cases, &scoring(&["displacement"])).unwrap();
    let row = found.metrics[0];
    assert!(row.floor.is_none() && row.ideal.unwrap().ratio.is_none());
    assert_eq!(row.ideal.unwrap().gap.value, 1.0);
    assert_eq!(row.ideal.unwrap().gap.low, None);
    assert!(codes(&found).contains(&"one-recording"));

    let two = straight(&[1.0, 3.0]);
    let cases: Vec<CaseRuns> = [(0, 1.5), (1, 2.0)]
        .into_iter()
        .map(|(recording, far_m)| CaseRuns {
            recordings: vec![recording],
            ideal: Some(path(far_m, 0.0)),
            repeats: straight(&[far_m]),
        })
        .collect();
    let found = distances(&two, &cases, &scoring(&["displacement"])).unwrap();
    let row = found.metrics[0];
    assert!(row.floor.is_none() && row.ideal.unwrap().ratio.is_none());
    assert!((row.ideal.unwrap().gap.value - 0.75).abs() < 1e-12);
    assert!(codes(&found).contains(&"no-repeats"));
    assert!(Fitness::new(&two, &cases).unwrap().is_none());
    assert!(OverTime::new(&two, &cases).real_mean_m.is_none());
    assert!(distances(&[], &[], &scoring(&["rms"])).is_err());
}
