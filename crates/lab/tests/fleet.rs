//! Studies of many robots: the score of all is that of each, the weights count, and leaving one out leaves it out.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap_core::file::Source;
use realgap_lab::calibration::{Answer, Overrides, Study};
use realgap_optimize::RunOptions;

use crate::common::project;

/// A study of the shipped tripod with these robots, or this robot's fields.
fn parse(robots: &str) -> realgap_core::Result<Study> {
    let text = format!(
        "Study({robots} start: Settled, duration_s: 2.0, metric: \"rms\", score: Single,
        parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 5)])"
    );
    Study::parse(
        &Source::new(project().join("sweeps/fleet.ron"), text),
        &Overrides::default(),
    )
}

fn answer(robots: &str) -> Answer {
    parse(robots)
        .unwrap()
        .sweep(&RunOptions::default())
        .unwrap()
}

/// A robot with those of its recordings whose numbers match.
fn robot(numbers: &str, more: &str) -> String {
    format!(
        "morphology: \"../morphologies/tripod.ron\", recordings: [\"../real_trajectories/tripod_standin/run_{numbers}.csv\"], {more}"
    )
}

fn two(first: &str, second: &str) -> String {
    format!(
        "robots: [({}), ({})],",
        robot("00", first),
        robot("0[2-3]", second)
    )
}

/// Scores of the recordings at every point.
fn scores(answer: &Answer) -> Vec<Vec<f64>> {
    let points = answer.scores.points.iter();
    points.map(|point| point.recordings.clone()).collect()
}

#[test]
fn what_many_robots_score_is_what_each_scores_alone() {
    let (first, second) = (answer(&robot("00", "")), answer(&robot("0[2-3]", "")));
    let both = answer(&two("", ""));
    let alone = scores(&first).into_iter().zip(scores(&second));
    let joined: Vec<Vec<f64>> = alone.map(|(a, b)| [a, b].concat()).collect();
    assert_eq!(scores(&both), joined);
    assert!(first.report.transfer.is_none());

    // Who is left out is answered for by the other alone.
    let transfer = both.report.transfer.unwrap();
    let best = |answer: &Answer| answer.scores.points[answer.scores.best.unwrap()].clone();
    assert_eq!(transfer.robots.len(), 2);
    assert_eq!(transfer.robots[0].without_it, best(&second).values);
    assert_eq!(transfer.robots[1].without_it, best(&first).values);
    assert_eq!(transfer.robots[0].own, best(&first).score.unwrap());
    assert_eq!(transfer.robots[1].recordings, 2);
    // Nobody closes more than everybody's own best, and the default friction is a point of the grid.
    assert!(transfer.closed <= transfer.closable && transfer.closable <= 1.0);
    assert_eq!(transfer.untuned, [0.5]);
}

#[test]
fn weights_count_and_each_robot_has_what_is_fixed_for_it() {
    let plain = scores(&answer(&two("", "")));
    let weighed = scores(&answer(&two("weight: 4.0,", "")));
    for (before, after) in plain.iter().zip(&weighed) {
        for (index, weight) in [2.0, 0.5, 0.5].into_iter().enumerate() {
            assert!((after[index] - weight * before[index]).abs() < 1e-15);
        }
    }
    let changed = scores(&answer(&two("set: {\"servo.gain\": 0.5},", "")));
    for (before, after) in plain.iter().zip(&changed) {
        assert_ne!(before[0], after[0]);
        assert_eq!(before[1..], after[1..]);
    }
}

#[test]
fn one_robot_or_many_but_not_both() {
    let error = |text: &str| parse(text).unwrap_err().to_string();
    let both = format!("{} {}", robot("00", ""), two("", ""));
    assert!(error(&both).contains("of many"), "{}", error(&both));
    let light = error(&two("weight: 0.0,", ""));
    assert!(
        light.contains("weight") && light.contains("robots[0]"),
        "{light}"
    );
}
