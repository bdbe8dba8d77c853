//! Comparison by the clock: the numbers of evo, and what is refused.
//!
//! The reference numbers were computed with evo 1.38.1 and numpy 2 on 2026-11-28, from the same formulas:
//! `sync.associate_trajectories(a, b)`, then `main_ape.ape` and `main_rpe.rpe` (delta 1 frame) with `align` and `correct_scale`.

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::warning::Code;
use realgap_path::comparison::{
    Association, Offset, Score, TimeBase, Timing, Umeyama, compare, compare_in_time,
};
use realgap_path::trajectory::Trajectory;

/// Evo's numbers and ours differ by less, relative to values above 1.
const SAME: f64 = 1e-9;

/// A path in space with a heading: `count` samples every `step_s` from `start_s`, by a clock that is `late_s` late, with a part `bend` of
/// fast side steps, in a frame that is turned by `turn` and whose lengths are `scale` times as long.
#[derive(Clone, Copy)]
struct Path {
    start_s: f64,
    step_s: f64,
    count: u32,
    late_s: f64,
    bend: f64,
    scale: f64,
    turn: f64,
}

impl Path {
    const WHOLE: Self = Self {
        start_s: 0.0,
        step_s: 0.02,
        count: 1001,
        late_s: 0.0,
        bend: 0.0,
        scale: 1.0,
        turn: 0.0,
    };

    fn trajectory(self) -> Trajectory {
        let stamps = (0..self.count).map(|i| self.start_s + f64::from(i) * self.step_s);
        let stamps: Vec<f64> = stamps.collect();
        let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let at = |stamp: &f64| {
            let t = stamp - self.late_s;
            let along = 0.4 * t + 0.3 * (0.9 * t).sin();
            let beside = (0.5 * t).sin() + self.bend * (3.0 * t).sin();
            self.scale * (about_z(self.turn) * Vector3::new(along, beside, 0.1 * (1.3 * t).cos()))
        };
        let turned = |stamp: &f64| about_z((stamp - self.late_s).sin() + self.turn);
        Trajectory::new(stamps.clone(), stamps.iter().map(at).collect())
            .unwrap()
            .with_orientations(stamps.iter().map(turned).collect())
            .unwrap()
    }
}

fn by_the_clock(a: &Trajectory, b: &Trajectory, metric: &str, alignment: Umeyama) -> Score {
    let timing = Timing {
        alignment,
        ..Timing::default()
    };
    compare_in_time(a, b, metric, &timing).unwrap()
}

/// Pairs with evo's number of matched samples, its APE without alignment, with SE(3) and with Sim(3), its RPE without alignment and with
/// Sim(3), and its mean angle without alignment and with SE(3).
fn pairs() -> [(&'static str, Path, Path, usize, [f64; 7]); 4] {
    let later = Path {
        start_s: 7.0,
        step_s: 0.033,
        count: 300,
        bend: 0.02,
        ..Path::WHOLE
    };
    [
        (
            "start apart, other rates",
            Path::WHOLE,
            later,
            299,
            [
                0.014360852119117582,
                0.014320385812203306,
                0.01432001951797483,
                0.005583458987629694,
                0.005583494617661932,
                0.18094242236555771,
                0.20973967702237664,
            ],
        ),
        (
            "other frame and scale",
            Path::WHOLE,
            Path {
                scale: 0.5,
                turn: 0.7,
                ..later
            },
            299,
            [
                3.499126573638173,
                0.6921221471134686,
                0.014320019517974842,
                0.010806389527941006,
                0.005583494617661994,
                40.10209051359863,
                0.20973967702235596,
            ],
        ),
        (
            "a late clock",
            Path::WHOLE,
            Path {
                start_s: 0.5,
                late_s: 0.5,
                ..Path::WHOLE
            },
            976,
            [
                0.28162041502713486,
                0.20403505672733485,
                0.20343597000410504,
                0.004450702903414574,
                0.004434816270970621,
                18.23034880288551,
                18.25957267260154,
            ],
        ),
        (
            "the other is the longer one",
            Path {
                start_s: 3.0,
                step_s: 0.1,
                count: 100,
                ..Path::WHOLE
            },
            Path {
                step_s: 0.007,
                count: 2000,
                bend: 0.02,
                scale: 0.8,
                turn: -0.4,
                ..Path::WHOLE
            },
            100,
            [
                1.3932909734315684,
                0.27186424826063726,
                0.013963021591706313,
                0.011497012920893045,
                0.004638044495149246,
                22.91833613503974,
                0.07972345573265506,
            ],
        ),
    ]
}

#[test]
fn errors_of_matched_samples_are_those_of_evo() {
    use Umeyama::{None, Se3, Sim3};
    let asked = [
        ("ape", None),
        ("ape", Se3),
        ("ape", Sim3),
        ("rpe", None),
        ("rpe", Sim3),
        ("rotation", None),
        ("rotation", Se3),
    ];
    for (name, a, b, matched, expected) in pairs() {
        let (a, b) = (a.trajectory(), b.trajectory());
        for ((metric, alignment), expected) in asked.into_iter().zip(expected) {
            let found = by_the_clock(&a, &b, metric, alignment);
            assert!(
                (found.value - expected).abs() <= SAME * expected.max(1.0),
                "{name}: {metric} {alignment}: {} should be {expected}",
                found.value
            );
            let steps = usize::from(metric == "rpe");
            assert_eq!(found.samples, matched - steps, "{name}: {metric}");
        }
        // The metric with its own alignment is the same as the option.
        let own = by_the_clock(&a, &b, "umeyama-ape", None).value;
        let asked = by_the_clock(&a, &b, "ape", Se3).value;
        assert!((own - asked).abs() < 1e-12, "{name}: {own} {asked}");
    }
}

#[test]
fn an_offset_of_clocks_is_taken_away_and_its_estimate_is_as_good_as_stated() {
    let whole = Path::WHOLE.trajectory();
    let late = whole.later(0.5).unwrap();
    let ape = |offset| {
        let timing = Timing {
            offset,
            ..Timing::default()
        };
        compare_in_time(&whole, &late, "ape", &timing).unwrap()
    };
    let doubted = ape(Offset::Unstated);
    assert!(doubted.value > 0.1);
    let codes: Vec<Code> = doubted.warnings.iter().map(|w| w.code).collect();
    assert_eq!(codes, [Code::ClockOffset]);
    for offset in [Offset::Stated(0.5), Offset::Estimated] {
        let found = ape(offset);
        assert!(found.value < 1e-3 && found.warnings.is_empty(), "{found:?}");
    }
    let timing = Timing {
        offset: Offset::Estimated,
        ..Timing::default()
    };
    let found = timing.synchronise(&whole, &late).unwrap().summary;
    let (offset_s, deviation_s) = (found.offset_s.unwrap(), found.offset_deviation_s.unwrap());
    assert!((offset_s - 0.5).abs() < 3.0 * deviation_s && deviation_s < 0.01);
    // Clocks of two epochs: the starts are laid together first.
    let epoch = whole.later(1.7e9).unwrap();
    let found = timing.synchronise(&whole, &epoch).unwrap().summary;
    assert!((found.offset_s.unwrap() - 1.7e9).abs() < 0.01);
}

#[test]
fn paths_are_compared_in_the_common_time() {
    let whole = Path::WHOLE.trajectory();
    let middle = Path {
        start_s: 5.013,
        step_s: 0.05,
        count: 120,
        ..Path::WHOLE
    };
    let middle = middle.trajectory();
    for metric in ["rms", "shape", "displacement", "ape"] {
        let found = compare_in_time(&whole, &middle, metric, &Timing::default()).unwrap();
        // Chords of 0.05 s leave their curve by 0.1 mm; the nearest sample is up to 0.01 s away.
        let least = if metric == "ape" { 0.01 } else { 5e-4 };
        assert!(found.value < least, "{metric}: {found:?}");
        assert!(compare(&whole, &middle, metric).unwrap().value > 0.1);
    }
    // Interpolation has no such error, and uses every sample of the reference in the common time.
    let timing = Timing {
        association: Association::Interpolated,
        ..Timing::default()
    };
    let found = compare_in_time(&whole, &middle, "ape", &timing).unwrap();
    assert!(found.value < 2e-4, "{found:?}");
    assert_eq!(found.samples, 298);
    let unmatched = timing.synchronise(&whole, &middle).unwrap().summary;
    assert_eq!(unmatched.unmatched_reference, Some(1001 - 298));
    assert_eq!(unmatched.unmatched, Some(0));
    let codes: Vec<Code> = found.warnings.iter().map(|w| w.code).collect();
    assert_eq!(codes, [Code::UnmatchedSamples]);
}

#[test]
fn what_has_no_common_time_is_refused_with_a_remedy() {
    let whole = Path::WHOLE.trajectory();
    let one_in_common = whole.later(whole.duration_s()).unwrap();
    for (other, said) in [
        (whole.later(1.7e9).unwrap(), "no common time"),
        (whole.later(25.0).unwrap(), "no common time"),
        (one_in_common, "no common time"),
        (whole.later(19.992).unwrap(), "one sample in common"),
    ] {
        let error = compare_in_time(&whole, &other, "ape", &Timing::default()).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        // Since each start, all of them are the same.
        let start = Timing::of(TimeBase::Start);
        let found = compare_in_time(&whole, &other, "ape", &start).unwrap();
        assert!(found.value < 1e-6, "{found:?}");
    }
    // Stamps between those of the other, farther than the largest difference.
    let coarse = Path {
        step_s: 0.1,
        count: 100,
        ..Path::WHOLE
    };
    let (coarse, between) = (
        coarse.trajectory(),
        coarse.trajectory().later(0.05).unwrap(),
    );
    let error = compare_in_time(&coarse, &between, "ape", &Timing::default()).unwrap_err();
    assert!(error.to_string().contains("no sample in common"), "{error}");
    assert!(compare_in_time(&coarse, &between, "rms", &Timing::default()).is_ok());
}

#[test]
fn years_between_two_samples_are_borne() {
    let whole = Path::WHOLE.trajectory();
    let jumping = whole.times_s().iter().map(|t| match *t < 15.0 {
        true => *t,
        false => t + 1.0e9,
    });
    let jumping = Trajectory::new(jumping.collect(), whole.positions_world_m().to_vec()).unwrap();
    let found = compare_in_time(&whole, &jumping, "ape", &Timing::default()).unwrap();
    assert!(found.value < 1e-9, "{found:?}");
    assert_eq!(found.samples, 750);
    let codes: Vec<Code> = found.warnings.iter().map(|w| w.code).collect();
    assert_eq!(codes, [Code::UnmatchedSamples]);
}

#[test]
fn equal_fractions_match_no_samples() {
    let whole = Path::WHOLE.trajectory();
    let fraction = Timing::of(TimeBase::Fraction);
    let found = compare_in_time(&whole, &whole, "ape", &fraction).unwrap();
    assert_eq!((found.value, found.samples), (0.0, 182));
    for timing in [
        Timing {
            offset: Offset::Estimated,
            ..fraction
        },
        Timing {
            alignment: Umeyama::Se3,
            ..fraction
        },
        Timing {
            association: Association::Interpolated,
            ..fraction
        },
    ] {
        let error = compare_in_time(&whole, &whole, "ape", &timing).unwrap_err();
        assert!(
            error.to_string().contains("no samples are matched"),
            "{error}"
        );
    }
}
