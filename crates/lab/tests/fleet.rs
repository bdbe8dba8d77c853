//! Studies of many robots: scores of the single robots, weights, leave-one-robot-out transfer, parameters of one robot,
//! controllers, and the report of which robots reproduce their recordings.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use realgap_core::file::Source;
use realgap_lab::calibration::{
    Answer, Likeness, Overrides, OwnParameters, PointScore, Study, TuneOptions,
};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_path::trajectory::{self, Trajectory};
use realgap_simulation::run;

use crate::common::project;

/// A study of the shipped tripod. The text is a list of robots, or the fields of one robot.
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

/// The fields of a robot with the recordings whose numbers match the pattern.
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
fn each_robot_of_many_has_the_scores_of_a_study_of_it_alone() {
    let (first, second) = (answer(&robot("00", "")), answer(&robot("0[2-3]", "")));
    let both = answer(&two("", ""));
    let alone = scores(&first).into_iter().zip(scores(&second));
    let joined: Vec<Vec<f64>> = alone.map(|(a, b)| [a, b].concat()).collect();
    assert_eq!(scores(&both), joined);
    assert!(first.report.transfer.is_none());

    // The values for a left-out robot come from the other robot alone.
    let transfer = both.report.transfer.unwrap();
    let best = |answer: &Answer| answer.scores.points[answer.scores.best.unwrap()].clone();
    assert_eq!(transfer.robots.len(), 2);
    assert_eq!(transfer.robots[0].without_it, best(&second).values);
    assert_eq!(transfer.robots[1].without_it, best(&first).values);
    assert_eq!(transfer.robots[0].own, best(&first).score.unwrap());
    assert_eq!(transfer.robots[1].recordings, 2);
    // Common values cannot close more of the gap than the best values of each robot, and the default friction is a point of the
    // grid.
    assert!(transfer.closed <= transfer.closable && transfer.closable <= 1.0);
    assert_eq!(transfer.untuned, [0.5]);
}

#[test]
fn weights_scale_the_scores_and_fixed_values_apply_to_their_robot_only() {
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

/// The motion of the tripod in six seconds on a floor of friction 0.5.
fn walk(fixed: &str) -> Trajectory {
    let study = format!("{} set: {{{fixed}}},", robot("00", ""));
    let text = study_text(&study, 6.0, "Single");
    let source = Source::new(project().join("sweeps/walk.ron"), text);
    let study = Study::parse(&source, &Overrides::default()).unwrap();
    let experiment = study.experiment(0, &[0.5]).unwrap();
    run(&experiment).unwrap().outcome.completed().unwrap()
}

fn study_text(robots: &str, duration_s: f64, score: &str) -> String {
    format!(
        "Study({robots} start: Settled, duration_s: {duration_s:?}, metric: \"rms\", score: {score},
        parameters: [(name: \"floor.friction\", from: 0.5, to: 0.9, points: 2)])"
    )
}

/// The answer of a study of tripods, each with its own recordings and further fields. The first one has such a large weight that it
/// decides which point is the best.
fn recorded(robots: &[(&[Trajectory], &str)], score: &str) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    let mut members = String::new();
    for (number, (motions, more)) in robots.iter().enumerate() {
        for (index, motion) in motions.iter().enumerate() {
            let name = format!("robot_{number}_{index}.csv");
            trajectory::write(folder.path().join(name), motion).unwrap();
        }
        let tripod = project().join("morphologies/tripod.ron");
        let weight = if number == 0 { 1000.0 } else { 1.0 };
        members += &format!(
            "(morphology: {tripod:?}, recordings: [\"robot_{number}_*.csv\"], weight: {weight:?}, {more}),"
        );
    }
    let text = study_text(&format!("robots: [{members}],"), 6.0, score);
    let source = Source::new(folder.path().join("many.ron"), text);
    let study = Study::parse(&source, &Overrides::default()).unwrap();
    study.sweep(&RunOptions::default()).unwrap()
}

#[test]
fn each_robot_is_classified_by_how_well_it_reproduces_its_recordings() {
    let walked = walk("");
    let stood = walk("\"gait.amplitude_scale\": 0.0");
    let sized = |sizes: [f64; 2]| sizes.map(|size| walked.scaled(size).unwrap());
    let answer = recorded(
        &[
            (&sized([1.0, 1.3]), ""),
            (&sized([1.1, 1.11]), ""),
            (&sized([1.0, 1.01]), "set: {\"gait.amplitude_scale\": 0.0}"),
            (&[stood], ""),
        ],
        "Single",
    );
    let text = answer.to_string();
    let found = answer.report.reproduction.unwrap();
    let likeness: Vec<Likeness> = found.robots.iter().map(|robot| robot.likeness).collect();
    use Likeness::*;
    assert_eq!(likeness, [WithinFloor, Alike, GoesNowhere, OtherPath]);
    for share in [found.within_floor, found.alike, found.goes_nowhere] {
        assert_eq!((share.count, share.trials), (1, 4));
        // Wilson's interval of one in four.
        assert!((share.low - 0.0456).abs() < 1e-4 && (share.high - 0.6994).abs() < 1e-4);
    }
    assert_eq!(found.other_path.count, 1);
    assert!(text.contains("1 of 4 (25 %, 95 %: 5 to 70)"), "{text}");

    // The run equals the first recording, and its distance from the second is the distance between both recordings.
    let first = &found.robots[0];
    let floor_m = first.floor_m.unwrap();
    assert!((first.distance_m / floor_m - 0.5).abs() < 1e-3, "{first:?}");
    let way_m = first.simulated_m;
    assert!((first.recorded_m / way_m - 1.15).abs() < 1e-3 && first.simulated_sd_m == 0.0);
    // The limit is a quarter of the way, or at least half of a cube of 6 cm.
    assert!((first.alike_m - (0.25 * first.recorded_m).max(0.03)).abs() < 2e-3);
    assert_eq!(found.robots[3].floor_m, None);
    // A robot with one recording has no noise floor, and is not counted where floors are counted.
    for of in &found.metrics {
        assert_eq!(of.within_floor.trials, 3, "{}", of.metric);
    }
    let names: Vec<&str> = found.metrics.iter().map(|of| of.metric.as_str()).collect();
    for name in ["displacement", "hausdorff", "frechet", "dtw", "pca-cluster"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(found.displacement_held.is_none());
}

#[test]
fn a_recorded_displacement_is_compared_with_those_of_equally_valid_runs() {
    let walked = walk("");
    let around = [0.999, 1.001].map(|size| walked.scaled(size).unwrap());
    let far = [1.9, 2.1].map(|size| walked.scaled(size).unwrap());
    let found = recorded(&[(&around, ""), (&far, "")], "Valid").report;
    let found = found.reproduction.unwrap();
    let held = found.displacement_held.unwrap();
    let of_robots: Vec<bool> = found.robots.iter().map(|robot| robot.held).collect();
    assert_eq!(of_robots, [true, false], "{found:?}");
    assert_eq!((found.runs, held.count, held.trials), (16, 1, 2));
    assert!((found.displacement_promise - 15.0 / 17.0).abs() < 1e-12);
    assert!(found.robots[0].simulated_sd_m > 0.0);
}

/// A study of two robots of the shipped fleet that share a floor, with further varied parameters and fields of the second robot.
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
fn a_robot_can_have_a_varied_parameter_of_its_own_besides_the_shared_ones() {
    let swept = |study: Study| study.sweep(&RunOptions::default()).unwrap();
    let mass = "(name: \"robot.random_0022.body.mass_scale\", from: 0.5, to: 1.5, points: 3)";
    let own = swept(of_fleet(mass, "").unwrap());
    let own_text = own.to_string();
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
    assert_eq!(
        (of(0), of(1)),
        (3, 9),
        "only the shared floor affects the first robot"
    );
    let transfer = own.report.transfer.unwrap();
    assert!((transfer.untuned[0] - 0.5).abs() < 1e-9 && (transfer.untuned[1] - 1.0).abs() < 0.05);

    // The second robot, left out, gets the best floor of the first robot, and its own best mass on that floor.
    let lowest = |robot: usize, of: &dyn Fn(&PointScore) -> bool| {
        let chosen = grid.iter().filter(|point| of(point));
        let scores = chosen.map(|point| (point.recordings[robot], point.values.clone()));
        scores.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    };
    let floor = lowest(0, &|_| true).1[0];
    let (held_out, values) = lowest(1, &|point| point.values[0] == floor);
    assert_eq!(transfer.robots[1].held_out, held_out);
    assert_eq!(transfer.robots[1].without_it, values);
    let among = transfer.robots.iter().map(|robot| robot.refitted_among);
    assert_eq!(among.collect::<Vec<_>>(), [1, 3]);
    assert_eq!(transfer.own_parameters, OwnParameters::Refitted);

    // Where no two points have the same floor, no own parameter can be fitted again, and the report says so.
    let options = TuneOptions {
        optimizer: optimizer_by_name("random").unwrap(),
        budget: 12,
        ..TuneOptions::default()
    };
    let scattered = of_fleet(mass, "").unwrap();
    let scattered = scattered.tune(&options, &RunOptions::default()).unwrap();
    assert!(scattered.to_string().contains("NOT fitted again"));
    assert!(!own_text.contains("NOT fitted again") && own_text.contains("fitted again"));
    let transfer = scattered.report.transfer.unwrap();
    assert_eq!(transfer.own_parameters, OwnParameters::AsTheyCame);

    let unknown = mass.replace("0022", "0023");
    let error = of_fleet(&unknown, "").unwrap_err().to_string();
    assert!(error.contains("no robot of this name"), "{error}");
    assert!(error.contains("random_0005, random_0022"), "{error}");
    assert!(of_fleet(&mass.replace("mass_scale", "mas_scale"), "").is_err());
}

/// Writes an arena in which a wall stands beside the robot, and two controllers that stop every leg while the sensor measures less
/// than a limit. The limit of `sees` is larger than the distance of the wall, and that of `blind` is smaller.
fn hall(folder: &Path) {
    let arena = "Arena(name: \"hall\", size_m: (4.0, 4.0), boundary: Open, \
        boxes: [(centre_m: (2.24, 2.0), half_m: (0.05, 0.8))], start: (x_m: 2.0, y_m: 2.0))";
    std::fs::write(folder.join("hall.ron"), arena).unwrap();
    let legs = ["leg_a", "leg_b", "leg_c"].map(|leg| format!("(actuator: {leg:?}, hold: 0.0)"));
    for (name, below_m) in [("sees", 0.2), ("blind", 0.01)] {
        let text = format!(
            "Controller(arena: \"hall.ron\", rate_hz: 20, \
             sensors: [(name: \"front\", on: \"core\", at_m: (0, 0, 0.03), model: \"ultrasonic\")], \
             rules: [(when: (sensor: \"front\", below_m: {below_m:?}), then: [{}])])",
            legs.join(", ")
        );
        std::fs::write(folder.join(format!("{name}.ron")), text).unwrap();
    }
}

#[test]
fn a_sweep_simulates_with_the_controller_that_the_study_names() {
    let folder = tempfile::tempdir().unwrap();
    hall(folder.path());
    let study = |robots: &str| {
        let text = study_text(robots, 2.0, "Single");
        let text = text.replace("\"../", &format!("\"{}/", project().display()));
        let source = Source::new(folder.path().join("steered.ron"), text);
        Study::parse(&source, &Overrides::default())
    };
    let swept = |robots: &str| {
        let study = study(robots).unwrap();
        (
            study.sweep(&RunOptions::default()).unwrap(),
            study.fingerprint(),
        )
    };
    let way_m = |answer: &Answer| answer.scores.points[0].path_xy_m[181][0];
    let (without, plain) = swept(&robot("00", ""));
    let (sees, seeing) = swept(&robot("00", "controller: \"sees.ron\","));
    let (blind, _) = swept(&robot("00", "controller: \"blind.ron\","));
    // A wall that the robot does not touch and a rule whose condition is never met change nothing.
    assert_eq!(scores(&blind), scores(&without));
    let (stood_m, walked_m) = (way_m(&sees), way_m(&without));
    assert!(
        stood_m < 0.3 * walked_m,
        "the controller has no effect: {stood_m} m of {walked_m} m"
    );
    assert_ne!(plain, seeing, "two different studies have one fingerprint");

    // Each of many robots can have its own controller, and otherwise has that of the study.
    let pair =
        |shared: &str, second: &str| scores(&swept(&format!("{} {shared}", two("", second))).0);
    let second_only = pair("", "controller: \"sees.ron\",");
    let none = pair("", "");
    let first_only = pair("controller: \"sees.ron\",", "controller: \"blind.ron\",");
    for ((second_only, none), first_only) in second_only.iter().zip(&none).zip(&first_only) {
        assert_eq!(second_only[0], none[0]);
        assert_ne!(second_only[1..], none[1..]);
        assert_ne!(first_only[0], none[0]);
        assert_eq!(first_only[1..], none[1..]);
    }

    let text = study_text(&robot("00", "controller: \"sees.ron\","), 2.0, "Single");
    let text = text.replace("start: Settled", "start: FromRecording");
    let text = text.replace("\"../", &format!("\"{}/", project().display()));
    let source = Source::new(folder.path().join("steered.ron"), text);
    let error = Study::parse(&source, &Overrides::default()).unwrap_err();
    assert!(error.to_string().contains("start: Settled"), "{error}");
}

#[test]
fn a_study_of_one_robot_and_of_many_at_once_is_refused() {
    let error = |text: &str| parse(text).unwrap_err().to_string();
    let both = format!("{} {}", robot("00", ""), two("", ""));
    assert!(error(&both).contains("of many"), "{}", error(&both));
    let light = error(&two("weight: 0.0,", ""));
    assert!(
        light.contains("weight") && light.contains("robots[0]"),
        "{light}"
    );
}
