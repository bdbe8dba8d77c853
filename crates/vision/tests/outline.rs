//! Tests of snakes on discs and ellipses with known outlines, and of the warnings if there is no edge.

use realgap_vision::{
    Contour, Ending, Extractor, Feature, Snake, Sought, evenly, mean_distance_px,
};

use crate::drawing::{around, ellipse, grey};

const SHAPES: [[f64; 4]; 4] = [
    [100.0, 80.0, 45.0, 45.0],
    [100.4, 79.7, 30.0, 30.0],
    [95.0, 82.0, 55.0, 35.0],
    [104.0, 77.0, 28.0, 44.0],
];

fn snake(window_px: usize) -> Snake {
    Snake {
        window_px,
        ..Snake::PAPER
    }
}

#[test]
fn both_windows_find_discs_and_ellipses_to_a_pixel() {
    for shape in SHAPES {
        let picture = ellipse(200, 160, shape, 0.25, 0.8);
        for window_px in [3, 9] {
            let snake = snake(window_px);
            let found = snake
                .settle(&snake.edges(&picture), &around(shape, 1.25, 60))
                .unwrap();
            let apart = mean_distance_px(&found.points_px, &around(shape, 1.0, 2000)).unwrap();
            println!(
                "{shape:?}, {window_px} x {window_px}: {apart:.2} px, {} stuck, {} rounds, {:?}",
                found.stuck.len(),
                found.rounds,
                found.ending
            );
            assert!(apart < 1.0, "{shape:?} {window_px}: {apart}");
            assert!(found.stuck.is_empty(), "{:?}", found.stuck);
            assert_ne!(found.ending, Ending::OutOfRounds);
        }
    }
}

/// The paper expects that a larger window frees points that are stuck on a line; this is not so for a closed line.
#[test]
fn a_faint_line_around_an_object_stops_the_contour_and_is_reported() {
    let shape = [100.0, 80.0, 35.0, 35.0];
    let disc = ellipse(200, 160, shape, 0.2, 0.9);
    let settled = |window_px: usize, is_line: &dyn Fn(f64, f64) -> bool| {
        let picture = grey(200, 160, |x, y| {
            let (dx, dy) = (x as f64 - 100.0, y as f64 - 80.0);
            let dark = if is_line(dx, dy) && (dx.hypot(dy) - 48.0).abs() < 1.0 {
                0.1
            } else {
                0.0
            };
            disc.at(x as i64, y as i64) - dark
        });
        let snake = snake(window_px);
        snake
            .settle(&snake.edges(&picture), &around(shape, 1.5, 48))
            .unwrap()
    };
    for window_px in [3, 9] {
        let held = settled(window_px, &|_, _| true);
        let quarter = settled(window_px, &|dx, dy| dx > 0.0 && dy > 0.0);
        let apart =
            |points: &[[f64; 2]]| mean_distance_px(points, &around(shape, 1.0, 2000)).unwrap();
        println!(
            "{window_px} x {window_px}: {:.1} px, {} stuck; a quarter of the line: {:.1} px, {} stuck",
            apart(&held.points_px),
            held.stuck.len(),
            apart(&quarter.points_px),
            quarter.stuck.len()
        );
        assert!(held.stuck.len() > 40 && apart(&held.points_px) > 10.0);
        assert!(apart(&quarter.points_px) < apart(&held.points_px));
    }
}

#[test]
fn a_contour_in_a_uniform_picture_is_stuck_and_gives_a_warning() {
    let blank = grey(120, 90, |_, _| 0.5);
    let sought = Sought {
        start_px: around([60.0, 45.0, 30.0, 30.0], 1.0, 20),
        ..Sought::default()
    };
    let found = Contour::PAPER.extract(&blank, &sought).unwrap();
    let codes: Vec<&str> = found.warnings.iter().map(|w| w.code.name()).collect();
    assert!(codes.contains(&"contour-stuck"), "{codes:?}");
}

#[test]
fn a_contour_outside_of_the_picture_or_of_two_points_is_refused() {
    let blank = grey(120, 90, |_, _| 0.5);
    let refused = |start_px: Vec<[f64; 2]>| {
        let sought = Sought {
            start_px,
            ..Sought::default()
        };
        let error = Contour::PAPER.extract(&blank, &sought).unwrap_err();
        error.to_string()
    };
    let outside = refused(around([110.0, 45.0, 30.0, 30.0], 1.0, 20));
    assert!(outside.contains("outside of the picture"), "{outside}");
    assert!(outside.contains("120 x 90"), "{outside}");
    let few = refused(vec![[1.0, 1.0], [5.0, 5.0]]);
    assert!(few.contains("too few points"), "{few}");
    let even = Contour { snake: snake(4) };
    let sought = Sought {
        start_px: around([60.0, 45.0, 30.0, 30.0], 1.0, 20),
        ..Sought::default()
    };
    assert!(even.extract(&blank, &sought).is_err());
}

#[test]
fn distances_to_an_outline_are_distances_to_its_sides() {
    let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    let apart = |points: &[[f64; 2]]| mean_distance_px(points, &square).unwrap();
    assert_eq!(apart(&[[5.0, 3.0]]), 3.0);
    assert_eq!(apart(&[[5.0, -2.0], [13.0, 14.0]]), 3.5);
    assert_eq!(mean_distance_px(&[], &square), None);
    let points = evenly(&square, 8);
    assert_eq!(points[1], [5.0, 0.0]);
    assert_eq!(points[7], [0.0, 5.0]);
    let feature = |points: &[[f64; 2]]| Feature {
        points_px: points.to_vec(),
        ..Feature::default()
    };
    let moved: Vec<[f64; 2]> = square.iter().map(|p| [p[0] + 1.0, p[1]]).collect();
    let contour = Contour::PAPER;
    let there = contour
        .distance(&feature(&square), &feature(&moved))
        .unwrap();
    let back = contour
        .distance(&feature(&moved), &feature(&square))
        .unwrap();
    assert_eq!(there, back);
    assert!(there > 0.0 && there <= 1.0, "{there}");
}
