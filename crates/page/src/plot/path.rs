//! Paths on the floor: metres in, centimetres in the picture, both axes to one measure.

use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

use super::canvas::{Canvas, Point};
use super::frame::Frame;
use super::scale::Scale;

/// A point (x, y) of a path, in metres; points that are not finite are left out.
pub type PathPoint = [f64; 2];

const CM_PER_M: f64 = 100.0;
/// Positions beyond this (1000 km) are not positions of a robot.
const ABSURD_M: f64 = 1e6;

/// The finite points, in centimetres.
pub(super) fn finite_cm(points_m: &[PathPoint]) -> Vec<Point> {
    points_m
        .iter()
        .filter(|point| point.iter().all(|v| v.abs() < ABSURD_M))
        .map(|&[x, y]| (x * CM_PER_M, y * CM_PER_M))
        .collect()
}

/// The ranges of x and y of all paths and the start (0, 0), in centimetres, with some room.
pub(super) fn bounds_cm<'a>(
    paths: impl Iterator<Item = &'a [PathPoint]>,
) -> ((f64, f64), (f64, f64)) {
    let (mut x, mut y) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
    for point in paths.flat_map(finite_cm) {
        x = (x.0.min(point.0), x.1.max(point.0));
        y = (y.0.min(point.1), y.1.max(point.1));
    }
    // A robot that stays where it is still gets two millimetres of axis.
    let size = (x.1 - x.0).max(y.1 - y.0).max(1.0);
    let room = |(low, high): (f64, f64)| {
        let room = 0.06 * size + (0.1 * size - (high - low)).max(0.0) / 2.0;
        (low - room, high + room)
    };
    (room(x), room(y))
}

/// Widens the one range that is too narrow for a frame of this width / height.
pub(super) fn equal_aspect(x: (f64, f64), y: (f64, f64), shape: f64) -> (Scale, Scale) {
    let (width, height) = (x.1 - x.0, y.1 - y.0);
    let widen = |(low, high): (f64, f64), to: f64| {
        let middle = low + (high - low) / 2.0;
        (middle - to / 2.0, middle + to / 2.0)
    };
    let (x, y) = if width / height < shape {
        (widen(x, height * shape), y)
    } else {
        (x, widen(y, width / shape))
    };
    (Scale::linear(x.0, x.1), Scale::linear(y.0, y.1))
}

pub(super) fn draw_path<B: DrawingBackend>(
    canvas: &mut Canvas<B>,
    frame: &Frame,
    points_cm: &[Point],
    width: f64,
    colour: RGBColor,
    dash: Option<(f64, f64)>,
) {
    let points: Vec<Point> = points_cm.iter().map(|&point| frame.at(point)).collect();
    canvas.path(&points, width, colour, dash);
}
