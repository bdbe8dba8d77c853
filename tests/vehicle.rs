//! Beliefs and the two-wheel robot: closed forms, what is refused, and studies of it like of any other robot.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::sync::Arc;

use realgap::random::Numbered;
use realgap::robot::morphology::Morphology;
use realgap::sensing::belief::{Belief, BeliefOptions, BeliefReport};
use realgap::sensing::range::{Beam, RangeSensor, sensor_by_name};
use realgap::simulation::{Experiment, Noise, Vehicle, run};
use realgap::trajectory::Trajectory;

/// After ten readings: σ(d) / (0.9582 √10).
#[test]
fn ten_readings_are_believed_as_a_normal_sensor_allows() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let options = BeliefOptions {
        distances: vec![2.0, 20.0],
        ..BeliefOptions::default()
    };
    let found = BeliefReport::new(&ultrasonic, None, &options).unwrap();
    for (side, expected) in found.distances.iter().zip([0.17, 0.22]) {
        let set = &side.simulated;
        assert!(
            (set.belief_sd - expected).abs() < 0.01,
            "{}: {}",
            side.distance,
            set.belief_sd
        );
        assert!((side.kalman_sd.unwrap() - expected).abs() < 0.01);
        assert!((0.82..=0.97).contains(&set.held), "{}", set.held);
        assert!((set.mean.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_log_of_the_same_sensor_is_believed_alike_and_another_is_not() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let log = |shift: f64| {
        let mut text = String::from("distance_cm,reading_cm\n");
        let mut rng = Numbered::SensorReading.generator(99, 0);
        for _ in 0..2000 {
            text += &format!(
                "20,{}\n",
                shift + ultrasonic.draw(&Beam::straight(0.2), &mut rng).unwrap()
            );
        }
        realgap::sensing::range::ReadingLog::parse("log.csv", &text).unwrap()
    };
    let overlap = |shift: f64| {
        let options = BeliefOptions {
            distances: vec![20.0],
            ..BeliefOptions::default()
        };
        BeliefReport::new(&ultrasonic, Some(&log(shift)), &options)
            .unwrap()
            .distances[0]
            .overlap
            .unwrap()
    };
    assert!(overlap(0.0) > 0.9, "{}", overlap(0.0));
    assert!(overlap(0.5) < 0.6, "{}", overlap(0.5));
    let mut wrong = log(0.0);
    wrong.distance_unit = realgap::unit::LengthUnit::Metre;
    let options = BeliefOptions {
        distances: vec![20.0],
        ..BeliefOptions::default()
    };
    let error = BeliefReport::new(&ultrasonic, Some(&wrong), &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("other units"), "{error}");
}

#[test]
fn a_belief_survives_readings_that_cannot_be_and_follows_a_motion() {
    let ultrasonic = sensor_by_name("ultrasonic").unwrap();
    let mut belief = Belief::uniform(0.01, 0.21, 201);
    // Thousands of densities far below the smallest number.
    for _ in 0..5000 {
        belief.observe(&ultrasonic, 3.0e3);
    }
    let sum: f64 = belief.probabilities().iter().sum();
    assert!((sum - 1.0).abs() < 1e-9 && belief.restarts() == 0);
    belief.observe(&ultrasonic, f64::INFINITY);
    assert_eq!(belief.restarts(), 1);
    assert!(
        belief
            .probabilities()
            .iter()
            .all(|p| (p - 1.0 / 201.0).abs() < 1e-12)
    );
    let options = BeliefOptions {
        distances: vec![20.0],
        approach: 1.0,
        approach_sd: 0.1,
        ..BeliefOptions::default()
    };
    let found = BeliefReport::new(&ultrasonic, None, &options).unwrap();
    let side = &found.distances[0];
    assert!((side.distance - 11.0).abs() < 1e-9);
    assert!(
        side.simulated.bias.abs() < 0.1 && side.simulated.belief_sd < 0.35,
        "{:?}",
        side.simulated.bias
    );
}

fn two_wheel() -> Experiment {
    let vehicle = Vehicle::read(common::project().join("vehicles/two_wheel.ron"), None).unwrap();
    let cube = Morphology::read(common::project().join("morphologies/cube.ron")).unwrap();
    let mut experiment = Experiment::new(cube.assemble());
    experiment.drive = vehicle.drive;
    experiment.vehicle = Some(Arc::new(vehicle));
    experiment.duration_s = 5.0;
    experiment
}

fn motion(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

/// The ideal robot of paper 000, section 5.2: straight to the first box, right, straight to the second, right, and back.
#[test]
fn the_ideal_robot_goes_where_the_paper_says() {
    let mut experiment = two_wheel();
    experiment.drive.ideal_actuator = 1.0;
    experiment.drive.ideal_sensor = 1.0;
    experiment.drive.ideal_control = 1.0;
    // The paper measures from the robot's middle.
    experiment.drive.sensor_ahead_m = 0.0;
    let path = motion(&experiment);
    let positions = path.positions_world_m();
    let most_x = positions.iter().map(|p| p.x).fold(0.0, f64::max);
    assert!((most_x - 0.76).abs() < 0.005, "{most_x}");
    let turned = path.turned_rad().unwrap();
    assert!((turned + std::f64::consts::PI).abs() < 1e-6, "{turned}");
    let last = positions[positions.len() - 1];
    assert!((last.y - 0.31).abs() < 0.005 && last.x < 0.5, "{last:?}");
    let speed = positions[60].x - positions[0].x;
    assert!(
        (speed - 0.2266).abs() < 1e-6,
        "constants come once a command, not once an epoch: {speed}"
    );
}

#[test]
fn constants_of_a_command_come_once() {
    let mut experiment = two_wheel();
    experiment.drive.drift_rad_s = 0.0;
    experiment.drive.drift_offset_rad = 0.0;
    experiment.drive.ideal_sensor = 1.0;
    experiment.drive.sampling_s = 0.01;
    let far = |coast_m: f64| {
        let mut changed = experiment.clone();
        changed.drive.coast_m = coast_m;
        motion(&changed)
            .positions_world_m()
            .iter()
            .map(|p| p.x)
            .fold(0.0, f64::max)
    };
    let gained = far(0.0134) - far(0.0);
    assert!((gained - 0.0134).abs() < 0.003, "{gained}");
    let turned = |coast_rad: f64| {
        let mut changed = experiment.clone();
        changed.drive.turn_coast_rad = coast_rad;
        // One turn within the run.
        changed.duration_s = 2.5;
        motion(&changed).turned_rad().unwrap()
    };
    let more = turned(0.1) - turned(0.2);
    assert!((more - 0.1).abs() < 1e-6, "{more}");
}

#[test]
fn repeats_differ_by_their_number_alone_and_are_the_same_again() {
    let experiment = two_wheel();
    let noise = Noise::default();
    let of = |repeat: u64| motion(&noise.perturb(&experiment, 7, repeat));
    assert_eq!(of(3), of(3));
    assert_ne!(of(3), of(4));
    assert_eq!(motion(&experiment), motion(&experiment));
    // Half of the actuators' errors switched off changes no draw of the sensor.
    let mut quiet = experiment.clone();
    quiet.drive.actuator_noise = 0.0;
    quiet.drive.sensor_noise = 0.0;
    let quiet = |repeat: u64| motion(&noise.perturb(&quiet, 7, repeat));
    // Only the moment of the first reading is left: it is within a sampling time.
    let off = (quiet(3).positions_world_m()[80] - quiet(4).positions_world_m()[80]).norm();
    assert!(off < 1e-9, "{off}");
}

/// Robots in an empty field, the first at (1, 1) looking along +x.
fn crowd(others: &str) -> realgap::Result<Experiment> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "field.ron",
        "(name: \"field\", size_m: (4.0, 3.0), boundary: Open, start: (x_m: 1.0, y_m: 1.0))"
            .to_owned(),
    );
    write(
        "robot.ron",
        format!(
            "(name: \"robot\", radius_m: 0.08, arena: \"field.ron\", sensor: \"ultrasonic\", others: [{others}])"
        ),
    );
    let vehicle = Vehicle::read(folder.path().join("robot.ron"), None)?;
    let mut experiment = two_wheel();
    experiment.drive = vehicle.drive;
    experiment.vehicle = Some(Arc::new(vehicle));
    experiment.duration_s = 3.0;
    Ok(experiment)
}

#[test]
fn robots_in_one_arena_see_and_avoid_one_another() {
    let turned_rad = |experiment: &Experiment| {
        let motion = motion(experiment);
        let all = motion.orientations_world_from_body().unwrap();
        all[0].angle_to(&all[all.len() - 1])
    };
    // Alone it drifts; another that comes towards it makes it turn to the right.
    let alone = turned_rad(&crowd("").unwrap());
    assert!(alone < 0.3, "{alone}");
    let met = turned_rad(&crowd("(x_m: 1.8, y_m: 0.97, heading_deg: 180.0)").unwrap());
    assert!(met > 1.2, "{met}");
    // One far off changes nothing, not even what is drawn.
    let mut far = crowd("(x_m: 3.9, y_m: 2.9, heading_deg: 90.0)").unwrap();
    let mut lone = crowd("").unwrap();
    for experiment in [&mut far, &mut lone] {
        experiment.perturbation.draw = Some((3, 4));
    }
    assert_eq!(motion(&far), motion(&lone));
    // One that is driven into from behind its sensor's view stops both before they overlap.
    let mut blind = crowd("(x_m: 1.5, y_m: 1.0, heading_deg: 180.0)").unwrap();
    blind.drive.threshold_m = 0.0;
    blind.drive.ideal_sensor = 1.0;
    let path = motion(&blind);
    let farthest_m = path
        .positions_world_m()
        .iter()
        .map(|p| p.x)
        .fold(0.0, f64::max);
    assert!((farthest_m - 1.17).abs() < 0.01, "{farthest_m}");
    for (others, said) in [
        ("(x_m: 1.1, y_m: 1.0)", "starts in another"),
        ("(x_m: 9.0, y_m: 1.0)", "inside of the field"),
        ("(x_m: 2.0, y_m: 1.0), (x_m: 2.0, y_m: 1.1)", "others[1]"),
    ] {
        let error = crowd(others).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("robot.ron:1:"),
            "{error}"
        );
    }
}

#[test]
fn a_thousand_runs_take_seconds() {
    let experiment = two_wheel();
    let begun = std::time::Instant::now();
    for repeat in 0..100 {
        let _motion = motion(&Noise::default().perturb(&experiment, 1, repeat));
    }
    // 2 CPU s a thousand in a release build; tests are slower, and machines busy.
    assert!(begun.elapsed().as_secs_f64() < 2.0, "{:?}", begun.elapsed());
}

#[test]
fn a_study_names_one_robot_and_a_condition_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let root = common::project().display();
    let runs = folder.path().join("runs.csv");
    let mut text = String::from("condition,run,t_s,x_m,y_m\n");
    for (condition, speed) in [("slow", 0.1), ("fast", 0.21)] {
        for run in 0..3 {
            for k in 0..12 {
                let t = 0.1 * f64::from(k);
                text += &format!(
                    "{condition},{run},{t},{},{}\n",
                    0.36 + speed * t,
                    0.51 + 0.001 * f64::from(run) * t
                );
            }
        }
    }
    std::fs::write(&runs, text).unwrap();
    let study = |condition: &str, more: &str| {
        common::study(
            folder.path(),
            &format!(
                "vehicle: (file: \"{root}/vehicles/two_wheel.ron\"), {more}
                condition: \"{condition}\", start: Settled, duration_s: 1.0, metric: \"rms\", score: Single,
                parameters: [(name: \"vehicle.speed_m_s\", from: 0.05, to: 0.25, points: 5)],
                noise: (camera: (position_m: Normal(0.0005))),"
            ),
        )
    };
    let ensemble = |study: &std::path::Path| {
        common::realgap()
            .args([
                "ensemble",
                study.to_str().unwrap(),
                "--recordings",
                runs.to_str().unwrap(),
                "--repeats",
                "40",
                "--format",
                "json",
                "-o",
            ])
            .arg(folder.path().join("out"))
            .output()
            .unwrap()
    };
    let output = ensemble(&study("fast", ""));
    assert!(output.status.success(), "{}", common::text(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let reality = &found["ensembles"][0]["reality"];
    let reality = if reality.is_null() {
        &found["reality"]
    } else {
        reality
    };
    assert_eq!(
        reality["runs"].as_array().map(Vec::len),
        Some(3),
        "{}",
        common::text(&output.stdout)
    );
    let output = ensemble(&study("quick", ""));
    assert!(
        common::text(&output.stderr).contains("fast, slow"),
        "{}",
        common::text(&output.stderr)
    );
    let output = ensemble(&study(
        "fast",
        &format!("morphology: \"{root}/morphologies/cube.ron\","),
    ));
    assert!(common::text(&output.stderr).contains("one robot"));
    // A sweep finds the speed of the recordings.
    let output = common::realgap()
        .args([
            "sweep",
            study("slow", "").to_str().unwrap(),
            "--recordings",
            runs.to_str().unwrap(),
            "--format",
            "json",
            "-o",
        ])
        .arg(folder.path().join("swept"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", common::text(&output.stderr));
    let best = common::read(&folder.path().join("swept"), "best.ron");
    assert!(
        best.contains("0.1,") || best.contains("0.1\n") || best.contains(": 0.1"),
        "{best}"
    );
}

/// The shipped studies against the real runs, all of them: those that were held out are in docs/fidelity/sensing.md.
#[test]
fn real_runs_lie_where_the_shipped_studies_put_them() {
    let Some(folder) = common::shared_data("two_wheel_runs") else {
        return;
    };
    let runs = folder.join("runs.csv");
    let out = tempfile::tempdir().unwrap();
    let mut good = 0;
    for condition in ["us1", "us_bayesian", "ir", "ir_bayesian"] {
        let study = format!("sweeps/two_wheel_{condition}.ron");
        let output = common::realgap()
            .args([
                "ensemble",
                &study,
                "--recordings",
                runs.to_str().unwrap(),
                "--format",
                "json",
                "-o",
            ])
            .arg(out.path().join(condition))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let coverage = found["reality"]["coverage"].as_array().unwrap();
        let inside = coverage[2]["over_time"].as_f64().unwrap();
        assert!(inside > 0.7, "{condition}: {inside}");
        good += usize::from((0.8..=0.97).contains(&inside));
    }
    assert!(good >= 3, "{good} of 4");
}
