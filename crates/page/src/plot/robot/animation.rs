//! A robot in motion as an animated PNG: the view of the static pictures of robots, paths growing behind.

use rayon::prelude::*;

use super::block::{ACTIVE, FLOOR, PASSIVE, SPIN, draw_length};
use super::surface::{draw_outline, draw_surface, far_first, project, shadow};
use crate::plot::kit::*;
use realgap_core::file::AnimatedPng;
use realgap_core::statistics::ends_of;
use realgap_robot::morphology::Surface;

const WIDTH: f64 = 760.0;
const MARGIN: f64 = 20.0;
const HEAD: f64 = 58.0;
const KEY: f64 = 44.0;
/// Height of the room for the robot as a share of its width.
const SHAPE: std::ops::RangeInclusive<f64> = 0.42..=0.8;
/// The colour of recordings, the same as on the pages.
const RECORDED: RGBColor = RGBColor(0, 138, 100);
const OTHER: RGBColor = RGBColor(169, 163, 154);
const SHADOW: RGBColor = RGBColor(222, 222, 219);
/// Frames that are drawn at once.
const AT_ONCE: usize = 16;

/// What a surface in motion stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A cube without a servo.
    Passive,
    /// A cube with a servo.
    Active,
    /// The plate that a servo spins.
    Plate,
    /// A body beside the robot.
    Other,
}

/// A path: where something was over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Whether it was recorded; the other one is the run.
    pub is_recorded: bool,
    /// Seconds since the start, increasing.
    pub times_s: Vec<f64>,
    /// Places in the world, metres.
    pub places_m: Vec<[f64; 3]>,
}

/// One moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moment {
    /// Seconds since the start.
    pub time_s: f64,
    /// What the run consists of, in the world.
    pub solids: Vec<(Surface, Look)>,
    /// What recorded robots consist of, drawn as outlines.
    pub outlines: Vec<Surface>,
}

/// A whole animation.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// What is shown.
    pub title: String,
    /// Names of the run and of the recordings in the legend.
    pub labels: [String; 2],
    /// Corners of the floor, in a circle.
    pub floor_m: [[f64; 3]; 4],
    /// Height of the floor at x, y = 0 and its rise along x, for shadows.
    pub floor_rise: [f64; 2],
    /// Paths.
    pub traces: Vec<Trace>,
    /// Bodies that do not move.
    pub fixed: Vec<Surface>,
    /// At least one, at equal intervals.
    pub moments: Vec<Moment>,
    /// How long each moment is shown, seconds.
    pub shown_s: f64,
}

impl Trace {
    /// The place at a time; the last place after the end.
    fn place_m(&self, time_s: f64) -> Option<[f64; 3]> {
        let after = self.times_s.partition_point(|t| *t <= time_s);
        let before = after.checked_sub(1)?;
        let (a, b) = (self.places_m.get(before)?, self.places_m.get(after));
        let Some(b) = b else { return Some(*a) };
        let (from, to) = (self.times_s[before], self.times_s[after]);
        let share = (time_s - from) / (to - from);
        Some(std::array::from_fn(|axis| {
            a[axis] + share * (b[axis] - a[axis])
        }))
    }
}

/// Draws an animation: the bytes of an animated PNG file, which plays in an endless loop. Programs that do not support animated
/// PNG show the first moment.
///
/// # Errors
/// No moment.
pub fn draw_animation(animation: &Animation) -> Result<Vec<u8>> {
    let room = animation.room();
    let (width, height) = room.size;
    let mut bytes = Vec::new();
    let count = animation.moments.len();
    let mut file = AnimatedPng::new(&mut bytes, [width, height], count, animation.shown_s)?;
    for moments in animation.moments.chunks(AT_ONCE) {
        let frames = moments.par_iter().map(|moment| Frame {
            animation,
            room: &room,
            moment,
        });
        let drawn: Vec<_> = frames.map(|frame| picture::pixels(&frame)).collect();
        for pixels in drawn {
            file.push(pixels?)?;
        }
    }
    file.finish()?;
    Ok(bytes)
}

/// Where things are in the picture.
struct Room {
    size: (u32, u32),
    scale: f64,
    middle: Point,
    centre: Point,
    has_floor: bool,
}

impl Room {
    fn place(&self, point_m: [f64; 3]) -> Point {
        let (x, y) = project(point_m);
        (
            self.centre.0 + self.scale * (x - self.middle.0),
            self.centre.1 + self.scale * (y - self.middle.1),
        )
    }
}

impl Animation {
    /// All places of paths and corners of moving bodies that are finite.
    fn places_m(&self) -> Vec<[f64; 3]> {
        let traces = self.traces.iter();
        let traces = traces.flat_map(|trace| trace.places_m.iter().copied());
        let corners = self.moments.iter().flat_map(|moment| {
            let solids = moment.solids.iter().map(|(surface, _)| surface);
            let all = solids.chain(&moment.outlines);
            all.flat_map(|surface| surface.corners_m.iter().map(|corner| (*corner).into()))
        });
        let all = traces.chain(corners);
        all.filter(|place: &[f64; 3]| place.iter().all(|v| v.is_finite()))
            .collect()
    }

    /// Whether something comes nearer to the floor than everything together is long. A robot that is held high above the floor would
    /// be a speck above its own shadow.
    fn has_floor(&self, places_m: &[[f64; 3]]) -> bool {
        let [height_m, rise] = self.floor_rise;
        let nearest_m = (places_m.iter())
            .map(|[x, _, z]| z - (height_m + rise * x))
            .fold(f64::INFINITY, f64::min);
        let longest_m = [0, 1, 2]
            .map(|axis| {
                let (low, high) = ends_of(places_m.iter().map(|place| place[axis]));
                high - low
            })
            .into_iter()
            .fold(0.0, f64::max);
        nearest_m <= longest_m
    }

    fn room(&self) -> Room {
        let mut places_m = self.places_m();
        let has_floor = self.has_floor(&places_m);
        if has_floor {
            places_m.extend(self.floor_m);
        }
        let (xs, ys): (Vec<f64>, Vec<f64>) = places_m.into_iter().map(project).unzip();
        let ((x0, x1), (y0, y1)) = (ends_of(xs), ends_of(ys));
        let (wide_m, tall_m) = ((x1 - x0).max(1e-3), (y1 - y0).max(1e-3));
        let width = WIDTH - 2.0 * MARGIN;
        let height = width * (tall_m / wide_m).clamp(*SHAPE.start(), *SHAPE.end());
        Room {
            size: (WIDTH as u32, (HEAD + height + KEY).round() as u32),
            scale: (width / wide_m).min(height / tall_m),
            middle: (0.5 * (x0 + x1), 0.5 * (y0 + y1)),
            centre: (0.5 * WIDTH, HEAD + 0.5 * height),
            has_floor,
        }
    }
}

struct Frame<'a> {
    animation: &'a Animation,
    room: &'a Room,
    moment: &'a Moment,
}

impl Picture for Frame<'_> {
    fn size(&self) -> (u32, u32) {
        self.room.size
    }

    fn draw(&self, canvas: &mut Canvas) {
        if self.room.has_floor {
            self.draw_floor(canvas);
        }
        self.draw_paths(canvas);
        self.draw_bodies(canvas);
        self.draw_points(canvas);
        self.draw_words(canvas);
    }
}

impl Frame<'_> {
    fn draw_floor(&self, canvas: &mut Canvas) {
        let corners = self.animation.floor_m;
        canvas.polygon(&corners.map(|corner| self.room.place(corner)), FLOOR);
        // Lines at whole decimetres or metres, no more than a few dozen.
        let [low, high] = [f64::min, f64::max].map(|pick| {
            [0, 1].map(|axis| {
                let along = corners.map(|c| c[axis]).into_iter();
                along.reduce(pick).unwrap_or(0.0)
            })
        });
        let longest = (high[0] - low[0]).max(high[1] - low[1]);
        let mut steps = [0.1, 0.5, 1.0, 5.0, 10.0].into_iter();
        let Some(step) = steps.find(|step| longest / step <= 24.0) else {
            return;
        };
        let [height, rise] = self.animation.floor_rise;
        let on_floor = |x: f64, y: f64| self.room.place([x, y, height + rise * x]);
        for axis in [0, 1] {
            let first = (low[axis] / step).ceil() as i64;
            let last = (high[axis] / step).floor() as i64;
            for line in first..=last {
                let at = line as f64 * step;
                let ends = match axis {
                    0 => [on_floor(at, low[1]), on_floor(at, high[1])],
                    _ => [on_floor(low[0], at), on_floor(high[0], at)],
                };
                canvas.path(&ends, Stroke::new(1.0, GRID));
            }
        }
    }

    fn draw_paths(&self, canvas: &mut Canvas) {
        for trace in &self.animation.traces {
            let colour = colour(trace);
            let all: Vec<Point> = trace.places_m.iter().map(|p| self.room.place(*p)).collect();
            canvas.path(&all, Stroke::new(1.2, tint(colour, 0.3)));
            let now = trace.times_s.partition_point(|t| *t <= self.moment.time_s);
            canvas.path(&all[..now], Stroke::new(2.4, tint(colour, 0.85)));
        }
    }

    fn draw_bodies(&self, canvas: &mut Canvas) {
        let [height, rise] = self.animation.floor_rise;
        let place = |point: [f64; 3]| self.room.place(point);
        let fixed = self.animation.fixed.iter();
        let fixed = fixed.map(|surface| (surface.clone(), Look::Other));
        let all = fixed.chain(self.moment.solids.iter().cloned());
        let (surfaces, looks): (Vec<Surface>, Vec<Look>) = all.unzip();
        if self.room.has_floor {
            for surface in &surfaces {
                let below = shadow(surface).into_iter();
                let below = below.map(|[x, y]| place([x, y, height + rise * x]));
                canvas.polygon(&below.collect::<Vec<_>>(), SHADOW);
            }
        }
        for index in far_first(&surfaces) {
            let colour = match looks[index] {
                Look::Passive => PASSIVE,
                Look::Active => ACTIVE,
                Look::Plate => SPIN,
                Look::Other => OTHER,
            };
            draw_surface(canvas, &surfaces[index], &place, colour, 1.1);
        }
        for surface in &self.moment.outlines {
            draw_outline(canvas, surface, &place, RECORDED);
        }
    }

    /// Draws each path, and a line from the run to each recording.
    fn draw_points(&self, canvas: &mut Canvas) {
        let now = |trace: &Trace| Some(self.room.place(trace.place_m(self.moment.time_s)?));
        let traces = &self.animation.traces;
        let run = traces.iter().find(|trace| !trace.is_recorded).and_then(now);
        for trace in traces.iter().filter(|trace| trace.is_recorded) {
            let Some(at) = now(trace) else { continue };
            if let Some(run) = run {
                let between = Stroke::new(1.4, RECORDED).dashed(Some((5.0, 4.0)));
                canvas.path(&[run, at], between);
            }
            canvas.disc(at, 6.5, RGBColor(255, 255, 255));
            canvas.disc(at, 5.0, RECORDED);
        }
        if let Some(run) = run {
            canvas.disc(run, 5.5, RGBColor(255, 255, 255));
            canvas.disc(run, 4.0, BLUE);
        }
    }

    fn draw_words(&self, canvas: &mut Canvas) {
        let clock = Letter::new(24.0, Weight::Bold, INK);
        let time = format!("{:.1} s", self.moment.time_s);
        canvas.text(&time, (WIDTH - MARGIN, 36.0), Align::Right, clock);
        let letter = Letter::new(22.0, Weight::Bold, INK);
        let room = WIDTH - 2.0 * MARGIN - 110.0;
        let title = shorten(&self.animation.title, Weight::Bold, 22.0, room);
        canvas.text(&title, (MARGIN, 36.0), Align::Left, letter);

        let letter = Letter::new(17.0, Weight::Regular, FAINT_INK);
        let middle = f64::from(self.room.size.1) - 0.5 * KEY;
        let mut left = MARGIN;
        for (is_recorded, label) in [false, true].into_iter().zip(&self.animation.labels) {
            let traces = &self.animation.traces;
            let Some(trace) = traces.iter().find(|trace| trace.is_recorded == is_recorded) else {
                continue;
            };
            let colour = colour(trace);
            let end = (left + 26.0, middle);
            canvas.path(&[(left, middle), end], Stroke::new(3.0, colour));
            canvas.disc(end, 4.5, colour);
            let label = shorten(label, Weight::Regular, 17.0, 260.0);
            canvas.text_beside(&label, (left + 38.0, middle), Align::Left, letter);
            left += 38.0 + letter.width(&label) + 28.0;
        }
        self.draw_scale_bar(canvas, middle, letter);
    }

    fn draw_scale_bar(&self, canvas: &mut Canvas, middle: f64, letter: Letter) {
        let lengths = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
        let fitting = lengths.into_iter().filter(|m| m * self.room.scale <= 130.0);
        let Some(length_m) = fitting.reduce(f64::max) else {
            return;
        };
        let (right, y) = (WIDTH - MARGIN, middle + 7.0);
        let left = right - length_m * self.room.scale;
        draw_length(canvas, (left, right), (y, 5.0), 2.4);
        let text = match length_m < 1.0 {
            true => format!("{:.0} cm", 100.0 * length_m),
            false => format!("{length_m:.0} m"),
        };
        let centre = 0.5 * (left + right);
        canvas.text(&text, (centre, y - 8.0), Align::Centre, letter);
    }
}

fn colour(trace: &Trace) -> RGBColor {
    if trace.is_recorded { RECORDED } else { BLUE }
}
