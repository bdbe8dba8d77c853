//! Tests of casting beams in arenas, and of the errors for bad arenas.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::FRAC_PI_4;

use realgap_core::file::Source;
use realgap_sensing::arena::Arena;

fn arena(body: &str) -> realgap_core::Result<Arena> {
    Arena::parse(&Source::new(
        "arena.ron",
        format!("(name: \"a\", size_m: (4.0, 3.0), {body})"),
    ))
}

#[test]
fn a_beam_hits_objects_at_the_distances_and_angles_of_the_geometry() {
    let arena = arena(
        "boundary: Solid,
        boxes: [(centre_m: (2.0, 1.0), half_m: (0.1, 0.5)), (centre_m: (3.0, 2.0), half_m: (0.2, 0.2), turn_deg: 45)],
        circles: [(centre_m: (1.0, 2.5), radius_m: 0.25)],
        walls: [(from_m: (0.0, 0.2), to_m: (4.0, 0.2), thickness_m: 0.02)]",
    )
    .unwrap();
    let hit = |x: f64, y: f64, degrees: f64| {
        let hit = arena.cast([x, y], degrees.to_radians()).unwrap();
        (hit.distance_m, hit.incidence_rad)
    };
    let near = |(a, b): (f64, f64), (c, d): (f64, f64)| {
        assert!(
            (a - c).abs() < 1e-9 && (b - d).abs() < 1e-7,
            "{a} {b}, not {c} {d}"
        )
    };
    near(hit(1.0, 1.0, 0.0), (0.9, 0.0));
    near(hit(1.0, 1.0, 90.0), (1.25, 0.0));
    near(hit(1.0, 1.0, 180.0), (1.0, 0.0));
    near(hit(1.0, 1.0, -90.0), (0.79, 0.0));
    // The corner of the turned box, and its side.
    near(hit(2.5, 2.0, 0.0), (0.5 - 0.2 * 2f64.sqrt(), FRAC_PI_4));
    near(hit(2.5, 1.5, 45.0), (0.5 * 2f64.sqrt() - 0.2, 0.0));
    // Off the middle of a circle: sin θ = offset / radius.
    near(
        hit(0.3, 2.5 - 0.125, 0.0),
        (
            0.7 - (0.25_f64.powi(2) - 0.125_f64.powi(2)).sqrt(),
            30f64.to_radians(),
        ),
    );
    let oblique = arena.cast([1.0, 1.0], 20f64.to_radians()).unwrap();
    assert!((oblique.incidence_rad - 20f64.to_radians()).abs() < 1e-7);
    // A beam that begins inside of an object has distance 0.
    assert_eq!(arena.cast([2.0, 1.0], 0.3).unwrap().distance_m, 0.0);
    assert_eq!(
        arena
            .object_at([2.0, 1.0])
            .map(|k| arena.clearance_m([2.0, 1.0]) < 0.0 && k > 3),
        Some(true)
    );
    // A cone hits objects that its central line misses.
    let line = arena.cast([0.5, 2.1], 0.0).unwrap();
    let cone = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 9).unwrap();
    assert!(cone.distance_m < line.distance_m && cone.offset_rad > 0.0);
    let same = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 1).unwrap();
    assert_eq!(same.distance_m, line.distance_m);
}

#[test]
fn an_open_field_returns_nothing_and_steps_along_a_beam_reach_the_object() {
    let arena = arena("boundary: Open, circles: [(centre_m: (2.0, 1.5), radius_m: 0.3)]").unwrap();
    assert!(arena.cast([0.5, 1.5], std::f64::consts::PI).is_none());
    for k in 0..400 {
        let angle = f64::from(k) / 400.0 * std::f64::consts::TAU;
        let Some(hit) = arena.cast([0.5, 1.2], angle) else {
            continue;
        };
        let (sin, cos) = angle.sin_cos();
        let at = [0.5 + hit.distance_m * cos, 1.2 + hit.distance_m * sin];
        assert!(arena.clearance_m(at).abs() < 1e-9);
    }
}

#[test]
fn an_impossible_arena_is_refused() {
    for (body, said) in [
        (
            "boundary: Open, boxes: [(centre_m: (1.0, 1.0), half_m: (0.0, 1.0))]",
            "not a box",
        ),
        (
            "boundary: Open, circles: [(centre_m: (1.0, 1.0), radius_m: -1.0)]",
            "not a circle",
        ),
        (
            "boundary: Open, walls: [(from_m: (1.0, 1.0), to_m: (1.0, 1.0))]",
            "not a wall",
        ),
        (
            "boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]",
            "do not close",
        ),
        (
            "boundary: Solid, boxes: [(centre_m: (1.0, 1.0), half_m: (0.5, 0.5))], start: (x_m: 1.0, y_m: 1.0)",
            "cannot start here",
        ),
        (
            "boundary: Solid, start: (x_m: 9.0, y_m: 1.0)",
            "inside of the field",
        ),
        ("boundary: Closed", "Solid, Open"),
    ] {
        let error = arena(body).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("arena.ron:1:"),
            "{error}"
        );
    }
    let closed =
        arena("boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)]")
            .unwrap();
    assert_eq!(closed.objects.len(), 3);
}
