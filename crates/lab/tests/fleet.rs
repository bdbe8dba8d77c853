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

/// A study of two robots of the shipped fleet that share a floor, with what varies besides and what is fixed for the second.
fn of_fleet(varied: &str, second: &str) -> realgap_core::Result<Study> {
    let robot = |name: &str, more: &str| {
        let own = format!("../real_trajectories/fleet_mujoco/{name}");
        format!("(morphology: \"{own}/robot.ron\", recordings: [\"{own}/run_00.csv\"], {more})")
    };
    let robots = [robot("random_0005", ""), robot("random_0022", second)].join(", ");
    let text = format!(
        "Study(robots: [{robots}], start: Settled, duration_s: 2.0, metric: \"rms\", score: Single,
        parameters: [(name: \"floor.friction\", from: 0.2, to: 0.8, points: 3), {varied}])"
    );
    let source = Source::new(project().join("sweeps/fleet.ron"), text);
    Study::parse(&source, &Overrides::default())
}

#[test]
fn a_robot_may_vary_something_of_its_own_beside_what_all_share() {
    let swept = |study: Study| study.sweep(&RunOptions::default()).unwrap();
    let mass = "(name: \"robot.random_0022.body.mass_scale\", from: 0.5, to: 1.5, points: 3)";
    let own = swept(of_fleet(mass, "").unwrap());
    let values: Vec<_> = own.scores.points.iter().map(|p| p.values.clone()).collect();
    assert_eq!(values.len(), 9, "{values:?}");
    let grid = &own.scores.points;
    for (index, mass_scale) in [0.5, 1.0, 1.5].into_iter().enumerate() {
        let fixed = format!("set: {{\"body.mass_scale\": {mass_scale:?}}}");
        let alone = swept(of_fleet("", &fixed).unwrap());
        for point in alone.scores.points.iter().take(3) {
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            let mut same = grid.iter().filter(|other| {
                close(other.values[0], point.values[0]) && close(other.values[1], mass_scale)
            });
            let same = same.next();
            let same = same.unwrap_or_else(|| panic!("{:?} in {values:?}", point.values));
            assert_eq!(same.recordings, point.recordings, "{index}");
        }
    }
    let of = |robot: usize| {
        let scores = grid.iter().map(|point| point.recordings[robot].to_bits());
        scores.collect::<std::collections::BTreeSet<u64>>().len()
    };
    assert_eq!((of(0), of(1)), (3, 9), "the first feels the floor alone");
    let transfer = own.report.transfer.unwrap();
    assert!((transfer.untuned[0] - 0.5).abs() < 1e-9 && (transfer.untuned[1] - 1.0).abs() < 0.05);

    let nobody = mass.replace("0022", "0023");
    let error = of_fleet(&nobody, "").unwrap_err().to_string();
    assert!(error.contains("no robot of this name"), "{error}");
    assert!(error.contains("random_0005, random_0022"), "{error}");
    assert!(of_fleet(&mass.replace("mass_scale", "mas_scale"), "").is_err());
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
