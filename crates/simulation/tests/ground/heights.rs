//! Tests of height fields, in both engines and in MuJoCo's format.

use std::f64::consts::PI;
use std::process::Command;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_path::trajectory::Trajectory;
use realgap_simulation::export::{Robot, format_named};
use realgap_simulation::{Experiment, Start};

use super::{G, RADIUS_M, ball, by, end, engines, on_file, path, puck, regions, speed_m_s, thrown};
use crate::change::Change as _;
use crate::common::python_with;

/// Writes heights as a CSV over a square with its middle at the origin; the arena's text for it.
fn field(
    folder: &std::path::Path,
    count: usize,
    side_m: f64,
    height: impl Fn(f64, f64) -> f64,
) -> String {
    let at = |k: usize| side_m * (k as f64 / (count - 1) as f64 - 0.5);
    // The first row is the one with the largest y.
    let row = |r: usize| {
        let cells = (0..count).map(|c| format!("{}", height(at(c), -at(r))));
        cells.collect::<Vec<_>>().join(",")
    };
    let text: Vec<String> = (0..count).map(row).collect();
    std::fs::write(folder.join("h.csv"), text.join("\n")).unwrap();
    format!(
        "ground: HeightField(file: \"h.csv\", from_m: ({0:?}, {0:?}), size_m: ({side_m:?}, {side_m:?}))",
        -0.5 * side_m
    )
}

#[test]
fn a_plane_as_a_tilted_height_field_moves_a_robot_as_the_slope_does() {
    let folder = tempfile::tempdir().unwrap();
    let slope_rad: f64 = 0.3;
    let rough = field(folder.path(), 41, 4.0, |x, _| -slope_rad.tan() * x);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope_rad);
    let lying = |experiment: Experiment, height_m: f64| {
        experiment.lasting(1.0).with(|e| {
            if let Start::State(state) = &mut e.start {
                state.position_world_m = turn * (Vector3::z() * height_m);
                state.orientation_world_from_body = turn;
                state.velocity_world_m_s = Vector3::zeros();
                state.angular_velocity_body_rad_s = Vector3::zeros();
            }
        })
    };
    let cube = "Box(sides_m: (0.1, 0.1, 0.1))";
    let cube = thrown(cube, 0.05, Vector3::zeros(), Vector3::zeros()).set("floor.friction", 0.2);
    for (what, experiment, right_m_s2) in [
        (
            "slides",
            lying(cube, 0.05),
            G * (slope_rad.sin() - 0.2 * slope_rad.cos()),
        ),
        (
            "rolls",
            lying(ball(0.0, RADIUS_M), RADIUS_M),
            G * slope_rad.sin() / 1.4,
        ),
    ] {
        for engine in engines() {
            let way_m = |experiment: &Experiment| end(&by(engine, experiment)).norm();
            let slope = way_m(&experiment.clone().set("floor.slope_rad", slope_rad));
            let tilted = on_file(experiment.clone(), &rough, folder.path());
            let grid = way_m(&tilted);
            println!(
                "{what}, {engine:?}: {slope:.4} m on a slope, {grid:.4} m on a height field, {:.4} m",
                0.5 * right_m_s2
            );
            // Both are within 1 % of the closed form, which is what the engines' own contacts reach on a slope.
            let right_m = 0.5 * right_m_s2;
            for (of, found) in [("slope", slope), ("grid", grid)] {
                assert!(
                    (found / right_m - 1.0).abs() < 0.02,
                    "{engine:?} {what}: {of} {found} for {right_m}"
                );
            }
            assert!(
                (grid / slope - 1.0).abs() < 0.01,
                "{engine:?} {what}: {grid} {slope}"
            );
            // A slope of the floor tilts the field further.
            let steeper = way_m(&tilted.set("floor.slope_rad", 0.1));
            assert!(steeper > 1.2 * grid, "{engine:?} {what}: {steeper} {grid}");
        }
    }
}

/// How far from the lowest point a ball starts.
const AMPLITUDE_M: f64 = 0.08;

/// A ball of 5 cm in a bowl whose radius of curvature is 0.6 m.
fn bowl(folder: &std::path::Path) -> Experiment {
    let text = field(folder, 201, 1.0, |x, y| (x * x + y * y) / 1.2);
    let start_m = AMPLITUDE_M;
    let normal = Vector3::new(-start_m / 0.6, 0.0, 1.0).normalize();
    let place = Vector3::new(start_m, 0.0, start_m * start_m / 1.2) + normal * RADIUS_M;
    let still = ball(0.0, RADIUS_M).lasting(6.0).with(|e| {
        if let Start::State(state) = &mut e.start {
            state.position_world_m = place;
        }
    });
    on_file(still, &text, folder)
}

/// Times between crossings of the middle, twice their mean: a period.
fn period_s(path: &Trajectory) -> f64 {
    let samples: Vec<_> = path
        .times_s()
        .iter()
        .zip(path.positions_world_m())
        .collect();
    let crossing = |pair: &[(&f64, &Vector3<f64>)]| {
        let (a, b) = (pair[0], pair[1]);
        let share = a.1.x / (a.1.x - b.1.x);
        (a.1.x > 0.0) != (b.1.x > 0.0)
            && a.1.x != b.1.x
            && share.is_finite()
            && (0.0..=1.0).contains(&share)
    };
    let times: Vec<f64> = samples
        .windows(2)
        .filter(|pair| crossing(pair))
        .map(|pair| {
            let share = pair[0].1.x / (pair[0].1.x - pair[1].1.x);
            pair[0].0 + share * (pair[1].0 - pair[0].0)
        })
        .collect();
    2.0 * (times[4] - times[0]) / 4.0
}

/// Period of a ball that rolls in a parabola with this radius of curvature at its lowest point: the ball's middle moves on a curve
/// whose radius is smaller by the ball's own, and the parabola is less curved beside its lowest point.
fn right_s(curvature_m: f64) -> f64 {
    let small_s = 2.0 * PI * (1.4 * (curvature_m - RADIUS_M) / G).sqrt();
    small_s * (1.0 + 0.25 * (AMPLITUDE_M / curvature_m).powi(2))
}

#[test]
fn a_ball_in_a_bowl_swings_with_the_period_of_the_closed_form_and_twice_the_heights_are_faster() {
    let folder = tempfile::tempdir().unwrap();
    let rolling = bowl(folder.path());
    for engine in engines() {
        for (scale, lift_m) in [(1.0, 0.0), (2.0, 0.006)] {
            let rolling = by(engine, &rolling).set("floor.heights_scale", scale);
            let rolling = rolling.with(|e| {
                if let Start::State(state) = &mut e.start {
                    state.position_world_m.z += lift_m;
                }
            });
            let (found_s, right_s) = (period_s(&path(&rolling)), right_s(0.6 / scale));
            println!(
                "a ball in a bowl, {engine:?}, heights x {scale}: {found_s:.4} s for {right_s:.4} s"
            );
            assert!(
                (found_s / right_s - 1.0).abs() < 0.01,
                "{engine:?} {scale}: {found_s} for {right_s}"
            );
        }
    }
}

#[test]
fn a_robot_that_settles_in_a_bowl_starts_above_it_and_ends_at_its_lowest_point() {
    let folder = tempfile::tempdir().unwrap();
    let text = field(folder.path(), 81, 2.0, |x, y| {
        ((x - 0.2) * (x - 0.2) + y * y) / 1.2 - 0.05
    });
    for engine in engines() {
        let ball = ball(0.0, RADIUS_M)
            .with(|e| e.start = Start::Settled)
            .lasting(15.0);
        let ball = by(engine, &on_file(ball, &text, folder.path()));
        let path = path(&ball);
        let places = path.positions_world_m();
        assert!(
            places.iter().all(|p| p.z > -0.05 + 0.9 * RADIUS_M),
            "{engine:?}"
        );
        // It swings about the lowest point, at 0.2 m.
        let (low, high) = places
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.x), h.max(p.x)));
        assert!(
            (0.5 * (low + high) - 0.2).abs() < 0.03,
            "{engine:?}: {low} to {high}"
        );
    }
}

#[test]
fn regions_lie_on_a_height_field_too_and_the_flat_floor_goes_on_around_it() {
    let folder = tempfile::tempdir().unwrap();
    let flat = field(folder.path(), 21, 1.0, |_, _| 0.0);
    let ground = format!("{}, {flat}", regions(0.2, 0.6));
    for engine in engines() {
        // The edge of the regions is the rim of the field, so that the puck leaves the field, too.
        let sliding = on_file(puck(speed_m_s(0.2, 0.6, 0.3)), &ground, folder.path());
        let place = end(&by(engine, &sliding));
        assert!((place.x - 0.8).abs() < 0.012, "{engine:?}: {place}");
        assert!((place.z - 0.01).abs() < 5e-4, "{engine:?}: {place}");
    }
}

/// Puts a ball above places of an exported ground in MuJoCo, and prints how high the surface below is.
const HEIGHTS_IN_MUJOCO: &str = "
import sys, mujoco, numpy as np
model = mujoco.MjModel.from_xml_string(sys.stdin.read())
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
for place in sys.argv[1:]:
    x, y = map(float, place.split(','))
    geom = np.zeros(1, dtype=np.int32)
    down = mujoco.mj_ray(model, data, np.array([x, y, 5.0]), np.array([0.0, 0, -1]), None, 1, model.body('one').id, geom)
    print(5.0 - down)
";

#[test]
fn an_exported_ground_has_the_same_heights_in_mujoco_and_says_what_it_loses() {
    let folder = tempfile::tempdir().unwrap();
    let heights = field(folder.path(), 11, 2.0, |x, y| 0.1 + 0.03 * x + 0.02 * y);
    let steps = "steps: [(name: \"kerb\", centre_m: (3.0, 0.5), half_m: (0.5, 0.2), turn_deg: 30, height_m: 0.04, friction: 0.7)]";
    let ground = format!("{steps}, {heights}, {}", regions(0.2, 0.6));
    let experiment = on_file(ball(0.0, 0.5), &ground, folder.path());
    let experiment = experiment.set("floor.heights_scale", 2.0);
    let robot = Robot::named("one", &experiment);
    let mjcf = format_named("mjcf").unwrap().render(&robot);
    let said: Vec<&str> = mjcf.warnings.iter().map(|w| w.message.as_str()).collect();
    assert!(
        said.iter()
            .any(|m| m.contains("regions of the floor (smooth, rough)")),
        "{said:?}"
    );
    let urdf = format_named("urdf").unwrap().render(&robot);
    let mut said = urdf.warnings.iter();
    assert!(said.any(|w| w.message.contains("steps and height field")));
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let places = [
        ([0.31, 0.22], 0.2 + 2.0 * (0.03 * 0.31 + 0.02 * 0.22)),
        ([-0.7, 0.85], 0.2 + 2.0 * (-0.03 * 0.7 + 0.02 * 0.85)),
        ([3.0, 0.5], 0.04),
        // Beside the turned step and the field.
        ([2.6, 0.65], 0.0),
        ([-1.5, 0.0], 0.0),
    ];
    let words = places.map(|([x, y], _)| format!("{x},{y}"));
    let mut child = Command::new(python)
        .args(["-c", HEIGHTS_IN_MUJOCO])
        .args(words)
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    std::io::Write::write_all(&mut pipe, mjcf.text.as_bytes()).unwrap();
    drop(pipe);
    let said = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    let found: Vec<f64> = said.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(found.len(), places.len());
    for ((place, height), found) in places.into_iter().zip(found) {
        assert!(
            (found - height).abs() < 1e-5,
            "{place:?}: {found} for {height}"
        );
    }
}
