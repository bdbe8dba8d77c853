//! Tests of agreement with scikit-image and scipy (tests/golden/vision.json, made by tools/golden_vision.py).

use std::collections::BTreeSet;

use realgap_vision::{
    Edges, Extractor, Region, Snake, Sought, correlation_map, gauss, mean_distance_px, otsu,
};
use serde_json::Value;

use crate::common;
use crate::drawing::{around, ellipse, grey, texture};

fn golden() -> Value {
    serde_json::from_str(&common::read(&common::golden(), "vision.json")).unwrap()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

#[test]
fn matching_in_the_fourier_domain_agrees_with_scipy_and_scikit_image() {
    for case in golden()["matching"].as_array().unwrap() {
        let [width, height] = numbers(&case["picture"]).map(|v| v as usize);
        let [x_px, y_px, width_px, height_px] = numbers(&case["template"]).map(|v| v as usize);
        let picture = texture(width, height);
        let part = picture
            .cropped(Region {
                x_px,
                y_px,
                width_px,
                height_px,
            })
            .unwrap();
        let template = grey(width_px, height_px, |x, y| {
            if (x, y) == (0, 0) {
                1.0
            } else {
                part.at(x as i64, y as i64) * 0.5
            }
        });
        let (columns, _, map) = correlation_map(&picture, &template).unwrap();
        let mut largest = 0.0_f64;
        for place in case["places"].as_array().unwrap() {
            let [x, y, library, plain] = numbers(place);
            let found = map[y as usize * columns + x as usize];
            largest = largest
                .max((found - library).abs())
                .max((found - plain).abs());
        }
        println!("{width} x {height}: largest difference {largest:.1e}");
        assert!(largest < 1e-9, "{largest}");
        let sum = map.iter().sum::<f64>() - case["sum"].as_f64().unwrap();
        assert!(sum.abs() < 1e-6, "{sum}");
    }
}

#[test]
fn gaussian_filter_and_otsus_threshold_agree_with_scikit_image() {
    let golden = golden();
    let smooth = gauss(&texture(90, 70), 1.4);
    let known = golden["gauss"].as_array().unwrap();
    let mut index = 0;
    for y in (0..70).step_by(10) {
        for x in (0..90).step_by(9) {
            let difference = f64::from(smooth.at(x, y)) - known[index].as_f64().unwrap();
            assert!(difference.abs() < 1e-6, "({x}, {y}): {difference}");
            index += 1;
        }
    }
    assert_eq!(index, known.len());
    // All thresholds between two groups of values are equally good; scikit-image uses the lowest of them, this program the middle.
    let shapes = ellipse(120, 100, [60.3, 48.7, 33.2, 21.9], 0.3, 0.7);
    let split = |threshold: f32| shapes.values().iter().filter(|v| **v < threshold).count();
    let theirs = golden["otsu"].as_f64().unwrap() as f32;
    let (ours, theirs) = (split(otsu(&shapes)) as f64, split(theirs) as f64);
    assert!((ours / theirs - 1.0).abs() < 0.03, "{ours} {theirs}");
}

#[test]
fn edges_agree_with_scikit_image() {
    let shapes = ellipse(120, 100, [60.3, 48.7, 33.2, 21.9], 0.3, 0.7);
    let found = Edges::PAPER.extract(&shapes, &Sought::default()).unwrap();
    let map = found.feature.map.unwrap();
    let ours: BTreeSet<(i64, i64)> = (0..100)
        .flat_map(|y| (0..120).map(move |x| (x, y)))
        .filter(|(x, y)| map.at(*x, *y) > 0.0)
        .collect();
    let theirs: BTreeSet<(i64, i64)> = golden()["canny"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| {
            let [x, y] = numbers(p);
            (x as i64, y as i64)
        })
        .collect();
    let both = ours.intersection(&theirs).count();
    println!(
        "edges: {} here, {} there, {both} in both",
        ours.len(),
        theirs.len()
    );
    assert_eq!(ours, theirs);
}

#[test]
fn a_greedy_snake_comes_as_near_to_known_outlines_as_scikit_images_contour() {
    for case in golden()["snakes"].as_array().unwrap() {
        let shape = numbers(&case["ellipse"]);
        let picture = ellipse(200, 160, shape, 0.2, 0.9);
        let snake = Snake::PAPER;
        let settled = snake
            .settle(&snake.edges(&picture), &around(shape, 1.4, 48))
            .unwrap();
        let mine = mean_distance_px(&settled.points_px, &around(shape, 1.0, 2000)).unwrap();
        let theirs = case["mean_distance_px"].as_f64().unwrap();
        println!(
            "{}: {mine:.2} px, scikit-image {theirs:.2} px",
            case["name"]
        );
        assert!(mine < 1.0 && mine < theirs, "{mine} {theirs}");
    }
}
