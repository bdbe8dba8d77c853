//! Tests of task times: survival statistics against scipy, and comparisons of real with simulated trials.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use rand::RngExt;
use realgap_core::random::Numbered;
use realgap_core::statistics::{Duration, KaplanMeier, log_rank};
use realgap_core::unit::LengthUnit;
use realgap_path::trajectory;
use realgap_sensing::task::{Goal, TaskComparison, TaskLog, time_to_reach};

#[derive(serde::Deserialize)]
struct Golden {
    x: Vec<(f64, bool)>,
    y: Vec<(f64, bool)>,
    times: Vec<f64>,
    shares: Vec<f64>,
    low: Vec<Option<f64>>,
    high: Vec<Option<f64>>,
    statistic: f64,
    p: f64,
}

fn durations(of: &[(f64, bool)]) -> Vec<Duration> {
    let one = |&(time_s, finished): &(f64, bool)| Duration { time_s, finished };
    of.iter().map(one).collect()
}

/// tools/golden_survival.py
#[test]
fn survival_curves_intervals_and_the_log_rank_test_agree_with_scipy() {
    let text = common::read(&common::golden(), "survival.json");
    let cases: Vec<Golden> = serde_json::from_str(&text).unwrap();
    assert_eq!(cases.len(), 4);
    for case in cases {
        let (x, y) = (durations(&case.x), durations(&case.y));
        let curve = KaplanMeier::new(&x).unwrap();
        let mut compared = 0;
        for (index, time) in case.times.iter().enumerate() {
            assert!(
                (curve.share(*time) - case.shares[index]).abs() < 1e-12,
                "{time}"
            );
            // scipy has no interval where all trials or no trials are finished.
            if let (Some(low), Some(high)) = (case.low[index], case.high[index])
                && case.shares[index] > 0.0
            {
                let found = curve.share_interval(*time, 0.9);
                assert!(
                    (found.0 - low).abs() < 1e-9 && (found.1 - high).abs() < 1e-9,
                    "{time}: {found:?} {low} {high}"
                );
                compared += 1;
            }
        }
        assert!(compared >= 4);
        let test = log_rank(&x, &y).unwrap();
        assert!(
            (test.statistic.abs() - case.statistic.abs()).abs() < 1e-9,
            "{} {}",
            test.statistic,
            case.statistic
        );
        assert!((test.p_value - case.p).abs() < 1e-9);
        assert_eq!(test.p_value, log_rank(&y, &x).unwrap().p_value);
    }
}

#[test]
fn intervals_contain_the_median_as_often_as_stated() {
    let (mut held, studies) = (0, 400);
    for seed in 0..studies {
        let mut rng = Numbered::SensorReading.generator(seed, 0);
        // Durations are exponential with mean 1; trials are given up at uniformly distributed times between 0.5 and 3.
        let own: Vec<Duration> = (0..40)
            .map(|_| {
                let time = -libm::log(1.0 - rng.random::<f64>());
                let limit = 0.5 + 2.5 * rng.random::<f64>();
                Duration {
                    time_s: time.min(limit).max(1e-9),
                    finished: time <= limit,
                }
            })
            .collect();
        let (low, high) = KaplanMeier::new(&own).unwrap().median_interval_s(0.9);
        let truth = std::f64::consts::LN_2;
        held += u32::from(low.is_none_or(|l| l <= truth) && high.is_none_or(|h| truth <= h));
    }
    let share = f64::from(held) / studies as f64;
    assert!((0.86..0.94).contains(&share), "{share}");
}

/// Trials of two robots in two modes; durations are base times factor, drawn with a seed.
fn log(seed: u64, factors: [f64; 2], limit_s: f64) -> TaskLog {
    let mut rng = Numbered::SensorReading.generator(seed, 1);
    let mut text = String::from("robot,mode,trial,duration_s,finished\n");
    for (robot, slow) in ["PER", "Pioneer"].iter().zip(factors) {
        for (mode, base_s) in [("waypoints", 20.0), ("teleoperation", 35.0)] {
            for trial in 0..15 {
                let time_s = slow * base_s * (0.7 + 0.6 * rng.random::<f64>());
                let finished = u8::from(time_s <= limit_s);
                text += &format!(
                    "{robot},{mode},{trial},{},{finished}\n",
                    time_s.min(limit_s)
                );
            }
        }
    }
    TaskLog::parse("log.csv", &text).unwrap()
}

#[test]
fn a_difference_between_real_and_simulated_trials_is_found_only_where_there_is_one() {
    let real = log(1, [1.0, 1.5], 1e3);
    let same = TaskComparison::new(&real, &log(2, [1.0, 1.5], 1e3), 1).unwrap();
    assert_eq!(same.conditions.len(), 4);
    assert_eq!(same.conditions[0].condition, "robot=PER, mode=waypoints");
    for c in &same.conditions {
        assert_eq!(c.test, "mann-whitney");
        assert!(
            c.p.unwrap() > 0.01 && c.effect_low < 0.3 && c.effect_high > -0.3,
            "{c:?}"
        );
    }
    assert!(
        same.factors
            .iter()
            .all(|f| f.same_order && f.same_order_share > 0.9)
    );
    assert_eq!(same.factors[1].real, ["waypoints", "teleoperation"]);
    assert!(same.spearman.unwrap() > 0.7);
    // The Pioneer is faster in the simulation.
    let other = TaskComparison::new(&real, &log(3, [1.0, 0.6], 1e3), 1).unwrap();
    let robot = &other.factors[0];
    assert!(
        !robot.same_order && robot.same_order_share < 0.1,
        "{robot:?}"
    );
    let pioneer = &other.conditions[2];
    assert!(
        pioneer.p.unwrap() < 1e-4 && pioneer.effect_high < -0.8,
        "{pioneer:?}"
    );
    assert!((pioneer.median_ratio.unwrap() - 0.4).abs() < 0.1);
}

#[test]
fn a_trial_that_was_given_up_counts_as_longer_than_its_duration() {
    let real = log(4, [1.0, 1.5], 45.0);
    let found = TaskComparison::new(&real, &log(5, [1.0, 1.5], 45.0), 1).unwrap();
    let slow = &found.conditions[3];
    assert!(
        slow.real.finished < 8 && slow.real.median_s.is_none(),
        "{slow:?}"
    );
    assert_eq!((slow.test, slow.median_ratio), ("log-rank", None));
    assert!(slow.p.unwrap() > 0.01);
    assert_eq!(found.factors[0].real, ["PER", "Pioneer"]);
    assert!(found.to_string().contains("fewer than half finished"));
}

#[test]
fn a_robot_reaches_a_place_between_two_samples_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "t_s,x_m,y_m\n5,0,0\n6,1,0\n7,2,0\n8,3,0\n").unwrap();
    let motion = trajectory::read(&path, LengthUnit::Metre)
        .unwrap()
        .trajectory;
    let at = |x: f64, y: f64| {
        let goal = Goal {
            position_world_m: [x, y],
            within_m: 0.25,
        };
        time_to_reach(&motion, &goal)
    };
    assert_eq!(
        at(2.5, 0.0).unwrap(),
        Duration {
            time_s: 2.25,
            finished: true
        }
    );
    assert_eq!(
        at(2.5, 1.0).unwrap(),
        Duration {
            time_s: 3.0,
            finished: false
        }
    );
    assert!(at(0.1, 0.0).is_err());
}
