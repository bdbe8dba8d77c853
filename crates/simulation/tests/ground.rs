//! Tests of the ground: regions of the floor with friction of their own, steps, and height fields, in both engines.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::PI;
use std::process::Command;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_core::warning::Code;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{Robot, format_named};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{EngineChoice, Experiment, RAPIER, Start, TREE, read_arena, run};

use crate::change::Change as _;
use crate::common::{self, python_with};

const G: f64 = 9.81;

/// Both engines.
fn engines() -> [EngineChoice; 2] {
    [EngineChoice::new(&RAPIER), EngineChoice::new(&TREE)]
}

/// A body of one shape that starts at a height with a velocity; nothing bounces.
fn thrown(form: &str, height_m: f64, velocity_m_s: Vector3<f64>, spin: Vector3<f64>) -> Experiment {
    let text = format!(
        "(name: \"one\", bodies: [(name: \"one\", mass_kg: 0.2, shapes: [(form: {form})])])"
    );
    let robot = Morphology::parse(&Source::new("one.ron", text)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.gravity_m_s2 = G;
    experiment.floor.restitution = 0.0;
    experiment.start = Start::State(State {
        position_world_m: Vector3::z() * height_m,
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: velocity_m_s,
        angular_velocity_body_rad_s: spin,
    });
    experiment
}

/// Flat enough that it does not tip, and heavy in front while it brakes.
const PUCK_M: [f64; 2] = [0.2, 0.02];

fn puck(speed_m_s: f64) -> Experiment {
    let [side, height] = PUCK_M;
    let form = format!("Box(sides_m: ({side}, {side}, {height}))");
    let velocity = Vector3::x() * speed_m_s;
    thrown(&form, 0.5 * height, velocity, Vector3::zeros()).lasting(2.0)
}

const RADIUS_M: f64 = 0.05;

/// A ball that rolls along +x.
fn ball(speed_m_s: f64, height_m: f64) -> Experiment {
    let spin = Vector3::y() * (speed_m_s / RADIUS_M);
    let form = format!("Sphere(radius_m: {RADIUS_M})");
    thrown(&form, height_m, Vector3::x() * speed_m_s, spin).set("floor.friction", 1.0)
}

/// The experiment on the ground of an arena, whose coordinates are the world's.
fn on(experiment: Experiment, ground: &str) -> Experiment {
    on_file(experiment, ground, std::path::Path::new(""))
}

fn on_file(experiment: Experiment, ground: &str, folder: &std::path::Path) -> Experiment {
    let text = format!("(name: \"a\", size_m: (4.0, 4.0), boundary: Open, {ground})");
    let (walls, ground) = read_arena(&Source::new(folder.join("a.ron"), text), false).unwrap();
    assert!(walls.is_empty());
    experiment.with(|e| e.ground = ground)
}

fn by(engine: EngineChoice, experiment: &Experiment) -> Experiment {
    experiment.clone().with(|e| e.solver.engine = engine)
}

fn path(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

fn end(experiment: &Experiment) -> Vector3<f64> {
    *path(experiment).positions_world_m().last().unwrap()
}

fn regions(first: f64, second: f64) -> String {
    format!(
        "regions: [
            (name: \"smooth\", corners_m: [(-1, -1), (0.5, -1), (0.5, 1), (-1, 1)], friction: {first:?}),
            (name: \"rough\", corners_m: [(0.5, -1), (3, -1), (3, 1), (0.5, 1)], friction: {second:?}),
        ]"
    )
}

/// Speed with which the puck comes to rest `beyond_m` beyond an edge at 0.5 m. While it crosses the edge, its front is in one region
/// and its rear in the other; braking presses the front down.
fn speed_m_s(first: f64, second: f64, beyond_m: f64) -> f64 {
    let [side, height] = PUCK_M;
    let lever = 0.5 * height / side;
    let crossing = 0.5 * (first + second) / (1.0 - (second - first) * lever);
    let work = first * (0.5 - 0.5 * side) + crossing * side + second * (beyond_m - 0.5 * side);
    (2.0 * G * work).sqrt()
}

#[test]
fn a_box_that_slides_from_one_region_into_another_stops_where_its_energy_is_used_up() {
    for (first, second) in [(0.2, 0.6), (0.5, 0.1)] {
        for engine in engines() {
            let sliding = on(puck(speed_m_s(first, second, 0.3)), &regions(first, second));
            let sliding = by(engine, &sliding);
            let stops_m = end(&sliding).x;
            println!(
                "a box over two regions, {engine:?}, {first} then {second}: {stops_m:.4} m for 0.8 m"
            );
            // Rapier's own sliding friction is within 0.5 % (docs/validation/verification.md).
            assert!(
                (stops_m - 0.8).abs() < 0.008,
                "{engine:?} {first} {second}: {stops_m}"
            );
            // The floor's own friction acts nowhere; a region's own value acts.
            assert_eq!(end(&sliding.clone().set("floor.friction", 0.9)).x, stops_m);
            let other = end(&sliding.set("floor.rough.friction", 2.0 * second)).x;
            assert!(stops_m - other > 0.05, "{engine:?}: {stops_m} {other}");
        }
    }
}

#[test]
fn a_later_region_lies_on_top_of_an_earlier_one() {
    let both = |first: &str, second: &str| {
        let region = |name: &str| {
            let friction = if name == "ice" { 0.05 } else { 0.5 };
            format!(
                "(name: \"{name}\", corners_m: [(-1, -1), (3, -1), (3, 1), (-1, 1)], friction: {friction})"
            )
        };
        format!("regions: [{}, {}]", region(first), region(second))
    };
    for engine in engines() {
        let far_m = |ground: &str| end(&by(engine, &on(puck(1.0), ground))).x;
        let expected_m = 1.0 / (2.0 * G * 0.5);
        let found_m = far_m(&both("ice", "felt"));
        assert!(
            (found_m - expected_m).abs() < 0.01 * expected_m,
            "{engine:?}: {found_m}"
        );
        assert!(far_m(&both("felt", "ice")) > 5.0 * expected_m);
    }
}

#[test]
fn a_region_bounces_as_it_says() {
    let ground = "regions: [(name: \"mat\", corners_m: [(-1, -1), (1, -1), (1, 1), (-1, 1)], friction: 0.5, restitution: 0.6)]";
    for engine in engines() {
        let dropped = thrown(
            "Sphere(radius_m: 0.05)",
            0.25,
            Vector3::zeros(),
            Vector3::zeros(),
        );
        let dropped = on(dropped.lasting(0.45), ground);
        // Falls 0.2 m in 0.2019 s, and comes to rest in the air 0.6 of that time later.
        let highest = |experiment: &Experiment| {
            let path = path(experiment);
            let late = path.times_s().iter().zip(path.positions_world_m());
            late.filter(|(t, _)| **t > 0.25)
                .map(|(_, p)| p.z - RADIUS_M)
                .fold(0.0, f64::max)
        };
        let found_m = highest(&by(engine, &dropped));
        println!(
            "a bounce on a region, {engine:?}: {found_m:.4} m for {:.4} m",
            0.36 * 0.2
        );
        assert!(
            (found_m - 0.36 * 0.2).abs() < 0.02 * 0.2,
            "{engine:?}: {found_m}"
        );
        let dull = highest(&by(engine, &dropped).set("floor.mat.restitution", 0.3));
        assert!((dull - 0.09 * 0.2).abs() < 0.02 * 0.2, "{engine:?}: {dull}");
    }
}

#[test]
fn a_region_that_nothing_touches_is_said_and_one_that_is_touched_is_not() {
    for engine in engines() {
        let said = |speed_m_s: f64| {
            let run = run(&by(engine, &on(puck(speed_m_s), &regions(0.4, 0.4)))).unwrap();
            let all = run.warnings.into_iter();
            let own = all.filter(|warning| warning.code == Code::RegionUntouched);
            own.map(|warning| warning.message).collect::<Vec<_>>()
        };
        let slow = said(0.5);
        assert_eq!(slow.len(), 1, "{slow:?}");
        assert!(slow[0].contains("`rough`"), "{slow:?}");
        assert_eq!(said(2.2), [""; 0]);
    }
}

#[test]
fn a_parameter_of_a_missing_region_or_step_gives_a_warning_about_no_effect() {
    let experiment = on(puck(1.0), &regions(0.2, 0.6));
    let said = |text: &str| {
        let set = ParameterSet::new().with(text.parse().unwrap());
        let warnings = set.without_effect(&experiment);
        warnings
            .first()
            .map(|w| w.message.clone())
            .unwrap_or_default()
    };
    assert_eq!(said("floor.rough.friction=0.3"), "");
    assert!(said("floor.ice.friction=0.3").contains("only the regions smooth, rough"));
    assert!(said("floor.rough.height_m=0.3").contains("no step `rough`, only none"));
    assert!(said("floor.heights_scale=2").contains("no height field"));
}

#[test]
fn a_ball_climbs_a_step_and_goes_on_as_fast_as_its_angular_momentum_about_the_edge_and_its_energy_say()
 {
    let speed_m_s = 0.6;
    for height_m in [0.004, 0.008] {
        let ground = format!(
            "steps: [(name: \"kerb\", centre_m: (1.0, 0.0), half_m: (0.8, 0.5), height_m: {height_m:?}, friction: 1.0)]"
        );
        // The ball meets the edge without slip, and turns about it.
        let kept = speed_m_s * (1.0 - height_m / RADIUS_M / 1.4);
        let expected = (kept * kept - 2.0 / 1.4 * G * height_m).sqrt();
        for engine in engines() {
            let climbing = on(ball(speed_m_s, RADIUS_M), &ground).lasting(1.5);
            let climbing = by(engine, &climbing);
            let path = path(&climbing);
            let at = |t: f64| {
                let index = path.times_s().iter().position(|s| *s >= t).unwrap();
                (path.times_s()[index], path.positions_world_m()[index])
            };
            let ((t0, p0), (t1, p1)) = (at(1.0), at(1.4));
            let speed = (p1.x - p0.x) / (t1 - t0);
            println!(
                "a ball over a step of {height_m} m, {engine:?}: {speed:.4} m/s for {expected:.4}"
            );
            assert!(p1.x > 0.3, "{engine:?}: it did not get over the edge");
            assert!(
                (p1.z - RADIUS_M - height_m).abs() < 5e-4,
                "{engine:?}: {p1}"
            );
            assert!(
                (speed / expected - 1.0).abs() < 0.03,
                "{engine:?} {height_m}: {speed} for {expected}"
            );
            // A step that is too high stops it.
            assert!(end(&climbing.set("floor.kerb.height_m", 0.03)).x < 0.2);
        }
    }
}

#[test]
fn a_walking_robot_climbs_a_step_in_both_engines() {
    let file = common::project().join("morphologies/tripod.ron");
    let robot = Morphology::read(file).unwrap();
    let mut walking = Experiment::new(robot.assemble()).lasting(6.0);
    walking.floor.friction = 0.5;
    let free = end(&walking);
    let (x, y) = (free.x, free.y);
    let heading_deg = y.atan2(x).to_degrees();
    // The edge is half way of where the robot goes without a step.
    let (cos, sin) = (x / x.hypot(y), y / x.hypot(y));
    let middle = 0.5 * x.hypot(y) + 1.0;
    let ground = format!(
        "steps: [(name: \"plate\", centre_m: ({:?}, {:?}), half_m: (1.0, 2.0), turn_deg: {heading_deg:?}, height_m: 0.006, friction: 0.5)]",
        middle * cos,
        middle * sin
    );
    let climbing = on(walking.clone(), &ground);
    for engine in engines() {
        let flat = path(&by(engine, &walking));
        let rough = path(&by(engine, &climbing));
        let last = |path: &Trajectory| *path.positions_world_m().last().unwrap();
        let (flat, rough) = (last(&flat), last(&rough));
        assert!(
            (flat - rough).norm() > 1e-3,
            "{engine:?}: the step changes nothing"
        );
        let along = rough.x * cos + rough.y * sin;
        assert!(
            along > 0.5 * x.hypot(y),
            "{engine:?}: {along} of {}",
            x.hypot(y)
        );
    }
}

#[test]
fn a_robot_that_starts_in_a_step_is_refused_before_it_runs() {
    let ground = "steps: [(name: \"kerb\", centre_m: (0, 0), half_m: (0.3, 0.5), height_m: 0.05, friction: 1.0)]";
    let error = run(&on(puck(1.0), ground)).unwrap_err().to_string();
    assert!(
        error.contains("starts in a step") && error.contains("kerb"),
        "{error}"
    );
}

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
    let rough = field(folder.path(), 41, 4.0, |x, y| {
        -slope_rad.tan() * x + 0.0 * y
    });
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
    let flat = field(folder.path(), 21, 1.0, |x, y| 0.0 * (x + y));
    let ground = format!("{}, {flat}", regions(0.2, 0.6));
    for engine in engines() {
        // The edge of the regions is the rim of the field, so that the puck leaves the field, too.
        let sliding = on_file(puck(speed_m_s(0.2, 0.6, 0.3)), &ground, folder.path());
        let place = end(&by(engine, &sliding));
        assert!((place.x - 0.8).abs() < 0.012, "{engine:?}: {place}");
        assert!((place.z - 0.01).abs() < 5e-4, "{engine:?}: {place}");
    }
}

#[test]
fn a_start_pose_turns_and_moves_the_ground() {
    let text = "(name: \"a\", size_m: (4.0, 4.0), boundary: Open, start: (x_m: 2.0, y_m: 1.0, heading_deg: 90),
        regions: [(name: \"r\", corners_m: [(1, 1.5), (3, 1.5), (3, 3), (1, 3)], friction: 0.3)],
        steps: [(name: \"s\", centre_m: (2, 2), half_m: (0.5, 0.1), height_m: 0.02, friction: 0.5)])";
    let (_, ground) = read_arena(&Source::new("a.ron", text), true).unwrap();
    // What is ahead of the robot, along +y of the arena, is along +x of the world.
    assert!(ground.region_at([1.0, 0.0]).is_some() && ground.region_at([0.4, 0.0]).is_none());
    assert!(ground.region_at([1.0, 0.99]).is_some() && ground.region_at([1.0, 1.01]).is_none());
    let step = &ground.steps[0];
    assert!((step.centre_m[0] - 1.0).abs() < 1e-12 && step.centre_m[1].abs() < 1e-12);
    assert!((step.turn_deg + 90.0).abs() < 1e-12);
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

#[test]
fn a_region_with_the_floors_own_friction_changes_nothing() {
    let file = common::project().join("morphologies/tripod.ron");
    let robot = Morphology::read(file).unwrap();
    let mut walking = Experiment::new(robot.assemble()).lasting(3.0);
    walking.floor.friction = 0.5;
    let ground = "regions: [(name: \"same\", corners_m: [(-9, -9), (9, -9), (9, 9), (-9, 9)], friction: 0.5)]";
    for engine in engines() {
        let walking = by(engine, &walking);
        let same = on(walking.clone(), ground);
        assert_eq!(path(&same), path(&walking), "{engine:?}");
        assert_ne!(path(&same.set("floor.same.friction", 0.3)), path(&walking));
    }
}

#[test]
fn a_car_with_tyres_is_not_driven_on_ice_and_rises_by_the_height_of_a_step() {
    let ice = "regions: [(name: \"ice\", corners_m: [(0.3, -2), (9, -2), (9, 2), (0.3, 2)], friction: 0.0)]";
    // Its wheels spin there, and it goes on as fast as it came.
    let sliding = crate::wheels::car(0.3, 0.0).lasting(1.0);
    let speed = |experiment: &Experiment| {
        let path = path(experiment);
        let places = path.positions_world_m();
        let last = places.len() - 1;
        [last / 2, last].map(|k| (places[k] - places[k - 10]).norm() * 20.0)
    };
    let [half, whole] = speed(&on(sliding.clone(), ice));
    let [_, driven] = speed(&sliding);
    assert!((whole / half - 1.0).abs() < 1e-3, "{half} {whole}");
    assert!(driven > 1.2 * whole, "{driven} {whole}");
    for height_m in [0.003, 0.006] {
        let kerb = format!(
            "steps: [(name: \"kerb\", centre_m: (2.4, 0.0), half_m: (2.0, 0.5), height_m: {height_m:?}, friction: 0.8)]"
        );
        let rolling = crate::wheels::car(0.0, 0.0).lasting(1.0);
        let z_m = |experiment: &Experiment| {
            let path = path(experiment);
            let places = path.positions_world_m();
            places[places.len() - 10..].iter().map(|p| p.z).sum::<f64>() / 10.0
        };
        let risen_m = z_m(&on(rolling.clone(), &kerb)) - z_m(&rolling);
        assert!(
            (risen_m - height_m).abs() < 3e-4,
            "{risen_m} for {height_m}"
        );
    }
}
