//! Misfit of runs that start from recordings: a model that lacks a force or a delay is told so, a right model is not, and without
//! any noise nothing is said.
//!
//! The recorded worlds are integrated here, by Runge and Kutta's method in small steps, or simulated at a quarter of the study's
//! timestep, and are recorded with noise from a seed.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use rand::SeedableRng;
use rand_distr::{Distribution as _, StandardNormal};
use realgap_core::file::Source;
use realgap_core::random::Generator;
use realgap_lab::calibration::{Answer, NoiseSource, Overrides, Pattern, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{CommandTrack, Experiment, JointState, Quantity, Sampling, run};

const PLANK: &str = r#"(name: "plank", modules: [(name: "box", kind: Passive(sides_m: (0.2, 0.12, 0.04), mass_kg: 0.8))], hinges: [])"#;
const PENDULUM: &str = r#"(name: "swing", bodies: [
    (name: "world", mass_kg: 0),
    (name: "bob", mass_kg: 0.4, centre_of_mass_m: (0, 0, -0.2), inertia_kg_m2: (xx: 1e-3, yy: 1e-3, zz: 1e-3))],
  joints: [(name: "swing", parent: "world", child: "bob", pose: (at_m: (0, 0, 1)), kind: Turn(axis: (0, 1, 0)))],
  mount: ())"#;
const ARM: &str = r#"(name: "arm", bodies: [
    (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
    (name: "upper", mass_kg: 0.2, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 7e-4, zz: 7e-4)),
    (name: "lower", mass_kg: 0.1, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 4e-4, zz: 4e-4))],
  joints: [
    (name: "pitch", parent: "base", child: "upper", pose: (at_m: (0.1, 0, 0)), kind: Turn(axis: (0, 1, 0), viscous_nm_s_rad: 0.01)),
    (name: "elbow", parent: "upper", child: "lower", pose: (at_m: (0.2, 0, 0)), kind: Turn(axis: (0, 1, 0), viscous_nm_s_rad: 0.01))],
  actuators: [
    (joint: "pitch", servo: (law: Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.4), max_torque_nm: 3)),
    (joint: "elbow", servo: (law: Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.4), max_torque_nm: 3))],
  mount: (at_m: (0, 0, 1)))"#;

/// Random numbers of a world.
struct Chance(Generator);

impl Chance {
    fn new(seed: u64) -> Self {
        Self(Generator::seed_from_u64(seed))
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * libm::erfc(-self.normal() / std::f64::consts::SQRT_2)
    }
}

/// The states of a point at `times`, by steps of a thousandth of a second.
fn integrated(
    times: &[f64],
    start: [f64; 2],
    acceleration: impl Fn([f64; 2]) -> f64,
) -> Vec<[f64; 2]> {
    let (mut at, mut t) = (start, times[0]);
    let slope = |[x, v]: [f64; 2]| [v, acceleration([x, v])];
    let moved = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], h: f64| [x + h * dx, v + h * dv];
    times
        .iter()
        .map(|until| {
            while t < until - 1e-9 {
                let h = (until - t).min(1e-3);
                let a = slope(at);
                let b = slope(moved(at, a, 0.5 * h));
                let c = slope(moved(at, b, 0.5 * h));
                let d = slope(moved(at, c, h));
                for axis in 0..2 {
                    at[axis] += h / 6.0 * (a[axis] + 2.0 * b[axis] + 2.0 * c[axis] + d[axis]);
                }
                t += h;
            }
            at
        })
        .collect()
}

fn times(samples: usize, rate_hz: f64) -> Vec<f64> {
    (0..samples).map(|k| k as f64 / rate_hz).collect()
}

/// Recordings of a box that slides in a random direction, with `drag` in 1/s; seen with `camera_m`.
fn slides(
    folder: &Path,
    count: usize,
    friction: f64,
    drag: f64,
    camera_m: f64,
    chance: &mut Chance,
) {
    std::fs::write(folder.join("robot.ron"), PLANK).unwrap();
    for number in 0..count {
        let speed = chance.within(1.0, 1.5);
        let way = chance.within(-3.0, 3.0);
        let times = times(44, 60.0);
        let states = integrated(&times, [0.0, speed], |[_, v]| match v > 0.0 {
            true => -9.81 * friction - drag * v,
            false => -50.0 * v,
        });
        let mut text =
            "t_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n"
                .to_owned();
        for (t, [s, v]) in times.iter().zip(states) {
            let seen = [s * way.cos(), s * way.sin(), 0.02].map(|m| m + camera_m * chance.normal());
            let [x, y, z] = seen;
            let (vx, vy) = (v * way.cos(), v * way.sin());
            writeln!(text, "{t},{x},{y},{z},1,0,0,0,{vx},{vy},0,0,0,0").unwrap();
        }
        std::fs::write(folder.join(format!("run_{number}.csv")), text).unwrap();
    }
}

/// Recordings of a pendulum with viscous and dry friction of its joint, read by an encoder of this resolution after noise.
fn swings(
    folder: &Path,
    count: usize,
    [viscous, dry]: [f64; 2],
    noise: [f64; 2],
    chance: &mut Chance,
) {
    std::fs::write(folder.join("robot.ron"), PENDULUM).unwrap();
    let inertia = 1e-3 + 0.4 * 0.2 * 0.2;
    for number in 0..count {
        let times = times(300, 100.0);
        let start = [chance.within(0.6, 1.4), 0.0];
        let states = integrated(&times, start, |[q, v]| {
            let slip = libm::tanh(v / 1e-3);
            (-0.4 * 9.81 * 0.2 * libm::sin(q) - viscous * v - dry * slip) / inertia
        });
        let mut text = "t_s,swing_rad,swing_rad_s\n".to_owned();
        for (t, [q, v]) in times.iter().zip(states) {
            let seen = q + noise[0] * chance.normal();
            let seen = match noise[1] > 0.0 {
                true => (seen / noise[1]).round() * noise[1],
                false => seen,
            };
            writeln!(text, "{t},{seen:.7},{v:.6}").unwrap();
        }
        std::fs::write(folder.join(format!("run_{number}.csv")), text).unwrap();
    }
}

/// A recording of an arm that follows commands with these parameters, at a quarter of the study's timestep.
fn follows(folder: &Path, truth: &[(&str, f64)], noise_rad: f64, chance: &mut Chance) {
    std::fs::write(folder.join("robot.ron"), ARM).unwrap();
    let robot = Morphology::parse(&Source::new("robot.ron", ARM)).unwrap();
    let times = times(200, 50.0);
    let mut experiment = Experiment::new(robot.assemble());
    let commands = ["pitch", "elbow"].map(|name| {
        let [a, b, phase] = [
            chance.within(1.0, 2.5),
            chance.within(4.0, 6.0),
            chance.within(0.0, 3.0),
        ];
        let wave = |t: &f64| 0.4 * libm::sin(a * t + phase) + 0.2 * libm::cos(b * t);
        let values: Vec<f64> = times.iter().map(wave).collect();
        let track = CommandTrack::new(times.clone(), values.clone(), None).unwrap();
        experiment
            .commands
            .insert(name.to_owned(), Arc::new(track.of(Quantity::Position)));
        values
    });
    experiment.start_joints = vec![
        JointState {
            angle_rad: 0.1,
            speed_rad_s: 0.0
        };
        2
    ];
    experiment.sampling = Sampling::Times(times.clone().into());
    experiment.duration_s = 3.98;
    experiment.solver.timestep_s = 0.00125;
    let set: ParameterSet = truth
        .iter()
        .map(|(name, value)| Assignment::new(name, *value).unwrap())
        .collect();
    let motion = run(&set.apply(&experiment))
        .unwrap()
        .outcome
        .completed()
        .unwrap();
    let mut text = "t_s,pitch_command_rad,elbow_command_rad,pitch_rad,elbow_rad\n".to_owned();
    for (k, t) in times.iter().enumerate() {
        let seen = [0, 1]
            .map(|joint: usize| motion.joints()[joint].angles_rad[k] + noise_rad * chance.normal());
        writeln!(
            text,
            "{t},{},{},{},{}",
            commands[0][k], commands[1][k], seen[0], seen[1]
        )
        .unwrap();
    }
    std::fs::write(folder.join("run_0.csv"), text).unwrap();
}

fn study(folder: &Path, more: &str) -> Study {
    let text = format!(
        r#"Study(morphology: "robot.ron", recordings: ["*.csv"], start: FromRecording, {more})"#
    );
    let path = folder.join("study.ron");
    std::fs::write(&path, text).unwrap();
    Study::read(path, &Overrides::default()).unwrap()
}

const OF_SLIDES: &str =
    r#"metric: "rms", parameters: [(name: "floor.friction", from: 0.05, to: 0.6, points: 12)], "#;
const DRY: &str = r#"metric: "joints", score: Single, timestep_s: 0.005, parameters: [(name: "hinge.dry_nm", from: 0, to: 0.05)], "#;
const VISCOUS: &str = r#"metric: "joints", score: Single, timestep_s: 0.005, parameters: [
    (name: "hinge.viscous_nm_s_rad", from: 0, to: 0.03), (name: "hinge.dry_nm", from: 0, to: 0.05)], "#;
const SERVO: &str = r#"metric: "joints", score: Single, timestep_s: 0.005, commands: Commands(), parameters: [
    (name: "servo.pitch.stiffness_nm_rad", from: 4, to: 16), (name: "servo.elbow.stiffness_nm_rad", from: 4, to: 16),
    (name: "servo.*.damping_nm_s_rad", from: 0.1, to: 1)], "#;
const CAMERA: &str =
    "noise: Noise(camera: (position_m: Normal(0.001), angle_rad: Normal(0.005))), ";
const ZEROS: &str = "noise: Noise(servo_zero_rad: Normal(0.002)), ";

fn one() -> RunOptions<'static> {
    RunOptions {
        jobs: 1,
        ..RunOptions::default()
    }
}

fn fitted(study: &Study) -> Answer {
    let options = TuneOptions {
        optimizer: optimizer_by_name("gauss-newton").unwrap(),
        budget: 30,
        patience: None,
    };
    study.tune(&options, &one()).unwrap()
}

/// A world with its answer: a right model for `lack` 0, otherwise one that lacks something of this size.
fn world(kind: usize, seed: u64, lack: f64) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    let mut chance = Chance::new(seed);
    let chance = &mut chance;
    let has_noise = seed % 2 == 1;
    let stated = |text: &'static str| if has_noise { text } else { "" };
    match kind {
        0 => {
            let (friction, camera_m) = (chance.within(0.1, 0.4), chance.within(0.0003, 0.002));
            slides(
                folder.path(),
                4,
                friction,
                lack * chance.within(0.8, 1.5),
                camera_m,
                chance,
            );
            let text = format!("{OF_SLIDES}{}", stated(CAMERA));
            study(folder.path(), &text).sweep(&one()).unwrap()
        }
        1 => {
            let dry = chance.within(0.0, 0.02);
            let viscous = match lack > 0.0 {
                true => lack * chance.within(0.01, 0.02),
                false => chance.within(0.002, 0.02),
            };
            let noise = match seed % 4 < 2 {
                true => [chance.within(0.0005, 0.003), 0.0],
                false => [0.0, std::f64::consts::TAU / 4096.0],
            };
            swings(folder.path(), 2, [viscous, dry], noise, chance);
            let window = if seed.is_multiple_of(3) {
                "horizon: (0.8, 0.7), "
            } else {
                ""
            };
            fitted(&study(
                folder.path(),
                &format!("{}{window}", if lack > 0.0 { DRY } else { VISCOUS }),
            ))
        }
        _ => {
            let truth = [
                ("servo.pitch.stiffness_nm_rad", chance.within(6.0, 12.0)),
                ("servo.elbow.stiffness_nm_rad", chance.within(6.0, 12.0)),
                ("servo.*.damping_nm_s_rad", chance.within(0.3, 0.7)),
                ("servo.*.latency_s", lack * chance.within(0.04, 0.08)),
            ];
            let noise_rad = chance.within(0.0005, 0.002);
            follows(
                folder.path(),
                &truth[..if lack > 0.0 { 4 } else { 3 }],
                noise_rad,
                chance,
            );
            fitted(&study(folder.path(), &format!("{SERVO}{}", stated(ZEROS))))
        }
    }
}

const KINDS: [&str; 3] = ["slide (drag)", "pendulum (viscous)", "arm (servo lag)"];

/// What the answer says about the model as a whole.
fn said(answer: &Answer) -> String {
    let text = answer.to_string();
    let mut lines = text.lines();
    let starts = ["fits within", "No parameters of this model"];
    let is_said = |line: &&str| {
        starts
            .iter()
            .any(|start| line.trim_start().starts_with(start))
    };
    let of_model = lines.find(is_said);
    of_model.unwrap_or_default().to_owned()
}

/// REALGAP_MISFIT=40 cargo test -p realgap-lab --test main misfit::table -- --ignored --nocapture
#[test]
#[ignore = "a table that takes minutes"]
fn table() {
    let count: u64 = std::env::var("REALGAP_MISFIT").map_or(14, |text| text.parse().unwrap());
    for lack in [0.0, 1.0] {
        for (kind, name) in KINDS.iter().enumerate() {
            let mut flagged = 0;
            for seed in 0..count {
                let answer = world(kind, 1000 * kind as u64 + seed, lack);
                let fit = answer.report.fit.clone().unwrap();
                flagged += u64::from(!fit.explains);
                if fit.explains == (lack > 0.0) {
                    println!("  {name} {seed} lacks {lack}: {}", said(&answer));
                }
            }
            println!("{name}, lacks {lack}: {flagged} of {count} flagged");
        }
    }
}

#[test]
fn a_box_with_drag_is_no_box_with_more_friction_and_the_sentence_says_where() {
    let answer = world(0, 1, 1.0);
    let fit = answer.report.fit.clone().unwrap();
    assert!(!fit.explains && fit.judged, "{}", said(&answer));
    let residuals = fit.residuals.unwrap();
    let misfit = residuals.misfit.unwrap();
    let channel = &residuals.channels[misfit.channel];
    assert_eq!(channel.channel, "the position along the way");
    assert!(misfit.from_s < misfit.to_s);
    let warnings = &answer.report.warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.code == realgap_core::Code::ModelContradicted)
    );
    assert!(
        said(&answer).contains("No parameters of this model explain"),
        "{}",
        said(&answer)
    );
}

#[test]
fn a_servo_that_lags_is_seen_as_a_lag_of_its_size() {
    let folder = tempfile::tempdir().unwrap();
    follows(
        folder.path(),
        &[("servo.*.latency_s", 0.06)],
        0.001,
        &mut Chance::new(8),
    );
    let more = r#"metric: "joints", score: Single, timestep_s: 0.005, commands: Commands(),
        parameters: [(name: "body.lower.mass_scale", from: 0.5, to: 2)]"#;
    let answer = fitted(&study(folder.path(), more));
    let fit = answer.report.fit.clone().unwrap();
    let misfit = fit.residuals.clone().unwrap().misfit.unwrap();
    assert_eq!(misfit.pattern, Pattern::Lag, "{}", said(&answer));
    assert!((misfit.size - 0.06).abs() < 0.02, "{}", said(&answer));
}

#[test]
fn right_models_are_not_blamed_with_and_without_stated_noise() {
    for (kind, seed) in [
        (0, 0),
        (0, 1),
        (1, 1000),
        (1, 1002),
        (1, 1003),
        (2, 2000),
        (2, 2001),
    ] {
        let answer = world(kind, seed, 0.0);
        let fit = answer.report.fit.clone().unwrap();
        assert!(
            fit.explains && fit.judged,
            "{} {seed}: {}",
            KINDS[kind],
            said(&answer)
        );
    }
}

#[test]
fn without_any_noise_nothing_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    swings(folder.path(), 1, [0.02, 0.0], [0.0; 2], &mut Chance::new(3));
    let answer = fitted(&study(folder.path(), DRY));
    let fit = answer.report.fit.clone().unwrap();
    assert!(fit.explains && !fit.judged, "{fit:?}");
    assert!(
        said(&answer).contains("cannot be judged"),
        "{}",
        said(&answer)
    );
    let warnings = &answer.report.warnings;
    assert!(
        warnings
            .iter()
            .all(|w| w.code != realgap_core::Code::ModelContradicted)
    );
}

#[test]
fn the_steps_of_an_encoder_are_its_noise() {
    let folder = tempfile::tempdir().unwrap();
    let step = std::f64::consts::TAU / 4096.0;
    swings(
        folder.path(),
        2,
        [0.01, 0.005],
        [0.0, step],
        &mut Chance::new(4),
    );
    let fit = fitted(&study(folder.path(), VISCOUS)).report.fit.unwrap();
    let channel = fit.residuals.unwrap().channels[0].clone();
    assert_eq!(channel.noise_source, NoiseSource::Resolution);
    assert!(
        (channel.noise / (step / 12.0_f64.sqrt()) - 1.0).abs() < 1e-3,
        "{channel:?}"
    );
}

#[test]
fn constant_short_equal_and_contradictory_recordings_give_a_sentence() {
    let header = "t_s,swing_rad,swing_rad_s\n";
    let still = |samples: usize| -> String {
        let rows = (0..samples).map(|k| format!("{},0.0,0.0\n", k as f64 * 0.01));
        header.to_owned() + &rows.collect::<String>()
    };
    let answer_of = |files: &[String]| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("robot.ron"), PENDULUM).unwrap();
        for (number, text) in files.iter().enumerate() {
            std::fs::write(folder.path().join(format!("run_{number}.csv")), text).unwrap();
        }
        fitted(&study(folder.path(), DRY))
    };
    // A pendulum at rest, and one of three samples.
    for samples in [100, 3] {
        let answer = answer_of(&[still(samples)]);
        let fit = answer.report.fit.clone();
        assert!(
            fit.is_none_or(|fit| fit.explains),
            "{samples}: {}",
            said(&answer)
        );
    }
    // The same recording twice is as good as once.
    let folder = tempfile::tempdir().unwrap();
    swings(
        folder.path(),
        1,
        [0.0, 0.01],
        [0.001, 0.0],
        &mut Chance::new(5),
    );
    let one = std::fs::read_to_string(folder.path().join("run_0.csv")).unwrap();
    let answer = answer_of(&[one.clone(), one]);
    assert!(
        answer.report.fit.clone().unwrap().explains,
        "{}",
        said(&answer)
    );
    // Recordings that contradict each other: the dry friction of two is five times that of the others.
    let folder = tempfile::tempdir().unwrap();
    let mut chance = Chance::new(6);
    let files = [0.005, 0.025, 0.025, 0.005].map(|dry| {
        swings(folder.path(), 1, [0.0, dry], [0.001, 0.0], &mut chance);
        std::fs::read_to_string(folder.path().join("run_0.csv")).unwrap()
    });
    let answer = answer_of(&files);
    let fit = answer.report.fit.clone().unwrap();
    assert!(!fit.explains, "{}", said(&answer));
    assert!(
        said(&answer).contains("differ from each other"),
        "{}",
        said(&answer)
    );
}
