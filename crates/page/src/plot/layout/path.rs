//! Paths on the floor: metres in, centimetres in the picture, both axes to one measure.

use std::ops::RangeInclusive;

use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

/// A point (x, y) of a path, in metres; points that are not finite are left out.
pub type PathPoint = [f64; 2];

const CM_PER_M: f64 = 100.0;
/// Positions beyond this (1000 km) are not positions of a robot.
const ABSURD_M: f64 = 1e6;

/// The finite points, in centimetres.
pub(in crate::plot) fn finite_cm(points_m: &[PathPoint]) -> Vec<Point> {
    let is_place = |point: &&PathPoint| point.iter().all(|v| v.abs() < ABSURD_M);
    let places = points_m.iter().filter(is_place);
    places.map(|&[x, y]| (x * CM_PER_M, y * CM_PER_M)).collect()
}

/// The ranges of x and y of all paths and the start (0, 0), in centimetres, with some room.
pub(in crate::plot) fn bounds_cm<'a>(
    paths: impl Iterator<Item = &'a [PathPoint]>,
) -> ((f64, f64), (f64, f64)) {
    let points = paths.flat_map(finite_cm).chain([(0.0, 0.0)]);
    let (xs, ys): (Vec<f64>, Vec<f64>) = points.unzip();
    let (x, y) = (ends_of(xs), ends_of(ys));
    // A robot that stays where it is still gets two millimetres of axis.
    let size = (x.1 - x.0).max(y.1 - y.0).max(1.0);
    let room = |(low, high): (f64, f64)| {
        let room = 0.06 * size + (0.1 * size - (high - low)).max(0.0) / 2.0;
        (low - room, high + room)
    };
    (room(x), room(y))
}

/// Widens the one range that is too narrow for a frame of this width / height.
pub(in crate::plot) fn equal_aspect(x: (f64, f64), y: (f64, f64), shape: f64) -> (Scale, Scale) {
    let (width, height) = (x.1 - x.0, y.1 - y.0);
    let widen = |(low, high): (f64, f64), to: f64| {
        let middle = low + (high - low) / 2.0;
        (middle - to / 2.0, middle + to / 2.0)
    };
    let (x, y) = match width / height < shape {
        true => (widen(x, height * shape), y),
        false => (x, widen(y, width / shape)),
    };
    (Scale::linear(x.0, x.1), Scale::linear(y.0, y.1))
}

/// Draws a path of metres.
pub(in crate::plot) fn draw_path(
    canvas: &mut Canvas,
    frame: &Frame,
    path_m: &[PathPoint],
    stroke: Stroke,
) {
    let points = finite_cm(path_m).into_iter().map(|point| frame.at(point));
    canvas.path(&points.collect::<Vec<_>>(), stroke);
}

/// Paths seen from above as a part of a picture of this width.
pub(in crate::plot) struct Above {
    x: (f64, f64),
    y: (f64, f64),
    width: f64,
    margin: f64,
    /// Height of the frame.
    pub height: f64,
}

impl Above {
    /// Room for these paths, its height such a share of its width.
    pub(in crate::plot) fn new<'a>(
        paths: impl Iterator<Item = &'a Vec<PathPoint>>,
        shape: RangeInclusive<f64>,
        width: f64,
        margin: f64,
    ) -> Self {
        let (x, y) = bounds_cm(paths.map(Vec::as_slice));
        let share = ((y.1 - y.0) / (x.1 - x.0)).clamp(*shape.start(), *shape.end());
        Self {
            x,
            y,
            width,
            margin,
            height: ((width - 2.0 * margin - 70.0) * share).round(),
        }
    }

    /// Draws frame, axes and the start around what `paths` draws.
    pub(in crate::plot) fn draw(
        &self,
        canvas: &mut Canvas,
        top: f64,
        x_label: &str,
        paths: impl FnOnce(&mut Canvas, &Frame),
    ) {
        let Self { x, y, height, .. } = *self;
        let count = (height / 65.0).clamp(3.0, 8.0) as usize;
        // The width of the labels depends on the range and the range on the frame: one round is
        // enough, as only the number of digits matters.
        let (_, rough) = equal_aspect(x, y, (self.width - 2.0 * self.margin - 70.0) / height);
        let left = (self.margin + left_of_label(&rough.ticks(count))).round();
        let right = self.width - self.margin;
        let (x, y) = equal_aspect(x, y, (right - left) / height);
        let frame = Frame::new((left, top), (right, top + height), [x, y]);
        let (x_ticks, y_ticks) = (x.ticks(9), y.ticks(count));
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        paths(canvas, &frame);
        draw_start(canvas, frame.at((0.0, 0.0)));
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, x_label);
        frame.draw_y_axis(canvas, &y_ticks, "y (cm)");
    }
}
