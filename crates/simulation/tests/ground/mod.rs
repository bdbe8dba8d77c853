//! Tests of the ground: regions of the floor with friction of their own, and steps, in both engines.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod heights;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_core::warning::Code;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{EngineChoice, Experiment, RAPIER, Start, TREE, read_arena, run};

use crate::change::Change as _;
use crate::common;

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
