//! Infers the direction of a recording's axes from its motion: free fall, height above a floor, and rolling.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::super::axes::Axes;
use super::super::{Recording, Trajectory};
use realgap_core::statistics::ends_of;

/// The axis of a file that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::trajectory) enum Up {
    Z,
    Y,
    MinusZ,
    MinusY,
    Other,
}

impl Up {
    /// The axis that points up: this axis of the file (0 to 2), in its positive or negative direction.
    fn along(axis: usize, is_positive: bool) -> Self {
        match (axis, is_positive) {
            (2, true) => Self::Z,
            (2, false) => Self::MinusZ,
            (1, true) => Self::Y,
            (1, false) => Self::MinusY,
            _ => Self::Other,
        }
    }

    /// The name of the axis and the setting that reads it as up; `None` if it is read so anyway, or if no setting does.
    pub(in crate::trajectory) fn setting(self) -> Option<(&'static str, Axes)> {
        match self {
            Self::Y => Some(("y", Axes::YUp)),
            Self::MinusZ => Some(("-z", Axes::ZDown)),
            Self::MinusY => Some(("-y", Axes::Camera)),
            Self::Z | Self::Other => None,
        }
    }
}

/// Free fall in a recording.
#[derive(Debug, Clone, Copy)]
pub(in crate::trajectory) struct Fall {
    /// Acceleration, m/s² if the unit of length with which the file was read is right.
    pub size_m_s2: f64,
    pub up: Up,
}

/// The number of samples to which one parabola is fitted.
const WINDOW: usize = 9;
/// The number of consecutive windows whose accelerations must agree.
const CONSECUTIVE: usize = 4;
/// The relative tolerance of this agreement.
const SPREAD: f64 = 0.08;
/// The smallest share of the acceleration that must be along one axis.
const ALONG: f64 = 0.97;
/// The smallest acceleration that counts as free fall, in units of length per second squared; other motion has no such constant acceleration.
const MIN_M_S2: f64 = 5.0;

/// The acceleration of the parabola that is fitted to these samples; `None` if the fit is singular.
fn acceleration(times_s: &[f64], places: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let middle_s = times_s[times_s.len() / 2];
    let (mut normal, mut right) = (nalgebra::Matrix3::zeros(), nalgebra::Matrix3::zeros());
    for (time_s, place) in times_s.iter().zip(places) {
        let t = time_s - middle_s;
        let row = Vector3::new(1.0, t, 0.5 * t * t);
        normal += row * row.transpose();
        right += row * place.transpose();
    }
    // The times are much smaller than 1, so the rows are scaled for a well-conditioned solution.
    let scale = times_s[times_s.len() - 1] - times_s[0];
    let scales =
        nalgebra::Matrix3::from_diagonal(&Vector3::new(1.0, 1.0 / scale, 1.0 / (scale * scale)));
    let solved = (scales * normal * scales).lu().solve(&(scales * right))?;
    Some((scales * solved).row(2).transpose())
}

/// Finds free fall: several consecutive windows with the same acceleration along one axis, whose size is gravity in metres, centimetres or
/// millimetres.
pub(in crate::trajectory) fn free_fall(trajectory: &Trajectory) -> Option<Fall> {
    let (times_s, places) = (trajectory.times_s(), trajectory.positions_world_m());
    if trajectory.is_planar() || times_s.len() < WINDOW + CONSECUTIVE {
        return None;
    }
    let step = (times_s.len() / 4000).max(1);
    let ends = (WINDOW..=times_s.len()).step_by(step);
    let all: Vec<Vector3<f64>> = ends
        .filter_map(|end| acceleration(&times_s[end - WINDOW..end], &places[end - WINDOW..end]))
        .collect();
    let run = all.windows(CONSECUTIVE).find_map(|some| {
        let mean = some.iter().sum::<Vector3<f64>>() / CONSECUTIVE as f64;
        let is_constant = some
            .iter()
            .all(|one| (one - mean).norm() < SPREAD * mean.norm());
        let along = mean.abs().max() / mean.norm();
        let is_gravity = [1.0, 100.0, 1000.0]
            .iter()
            .any(|size| (mean.norm() / (size * 9.81) - 1.0).abs() < super::FALL);
        (is_constant && along > ALONG && mean.norm() > MIN_M_S2 && is_gravity).then_some(mean)
    })?;
    let axis = run.iamax();
    Some(Fall {
        size_m_s2: run.norm(),
        up: Up::along(axis, run[axis] < 0.0),
    })
}

/// The largest distance from the first position.
pub(super) fn reach_m(trajectory: &Trajectory) -> f64 {
    let places = trajectory.positions_world_m();
    let far = places.iter().map(|place| (place - places[0]).norm());
    far.fold(0.0, f64::max)
}

/// The axis on which the robot stays between 0.1 and 2 body lengths from zero and hardly moves, as above a floor; and its median height.
pub(super) fn above_floor(trajectory: &Trajectory, body_m: f64) -> Option<(Up, f64)> {
    let places = trajectory.positions_world_m();
    let level = |axis: usize| {
        let mut all: Vec<f64> = places.iter().map(|place| place[axis]).collect();
        all.sort_by(f64::total_cmp);
        let range = all[all.len() - 1] - all[0];
        (all[all.len() / 2], range)
    };
    let levels = [0, 1, 2].map(level);
    let widest = levels.iter().map(|(_, range)| *range).fold(0.0, f64::max);
    let is_floor = |axis: usize| {
        let (level_m, range_m) = levels[axis];
        (0.1 * body_m..2.0 * body_m).contains(&level_m.abs())
            && range_m < 0.3 * widest
            && range_m < body_m
    };
    let found: Vec<usize> = (0..3).filter(|axis| is_floor(*axis)).collect();
    // If z looks like the height above a floor, the other axes are not considered.
    let axis = match found.as_slice() {
        all if all.contains(&2) && levels[2].0 > 0.0 => 2,
        [axis] => *axis,
        _ => return None,
    };
    let level_m = levels[axis].0;
    Some((Up::along(axis, level_m > 0.0), level_m))
}

/// The smallest and the largest position along each axis.
pub(in crate::trajectory) fn ends_m(trajectory: &Trajectory) -> [(f64, f64); 3] {
    [0, 1, 2].map(|axis| {
        let places = trajectory.positions_world_m().iter();
        ends_of(places.map(|place| place[axis]))
    })
}

/// True if the robot moves along z nearly as far as along another axis, and leaves the range from 0.1 to 2 body lengths above zero, so there
/// is no floor below z.
pub(super) fn roams_along_z(trajectory: &Trajectory, body_m: f64) -> bool {
    let [x, y, (low_m, high_m)] = ends_m(trajectory);
    let range_m = [x, y, (low_m, high_m)].map(|(low_m, high_m)| high_m - low_m);
    let is_over_floor = low_m > 0.1 * body_m && high_m < 2.0 * body_m;
    !is_over_floor && range_m[2] > 0.3 * range_m[0].max(range_m[1])
}

/// The sum of products of two quantities, and the sum of their sizes; the ratio says whether the quantities have the same sign.
#[derive(Default)]
struct SignAgreement {
    sum: f64,
    size: f64,
}

impl SignAgreement {
    fn add(&mut self, product: f64) {
        self.sum += product;
        self.size += product.abs();
    }

    fn share(&self) -> f64 {
        match self.size > 0.0 {
            true => self.sum / self.size,
            false => 0.0,
        }
    }
}

/// The smallest share of a tumbling motion that must contradict right-handed axes.
const AGAINST: f64 = 0.25;
/// The smallest number of recordings of a tumbling body that allow a conclusion.
const TUMBLES: usize = 8;

/// A robot on wheels or legs moves along a constant line of its own body, forward or backward: with mirrored axes this line is at least this
/// constant (0 to 1), …
const STEADY: f64 = 0.9;
/// … and as the axes are read, it is at most this constant, if the axes are mirrored.
const ASTRAY: f64 = 0.5;
/// The axes are certainly mirrored if the line is at most this constant as they are read, …
const SCATTERED: f64 = 0.3;
/// … and the robot goes along at least this many headings. With fewer it may move ahead at one heading and sideways at another, so the axes
/// are only doubted.
const HEADINGS: usize = 8;

/// Axes that contradict the motion.
pub(super) struct Mirrored {
    /// What was found.
    pub found: String,
    /// True if no right-handed motion explains it; otherwise it is only a doubt.
    pub is_certain: bool,
}

/// The steps of upright robots along the ground, in the frame of the body.
#[derive(Default)]
struct Way {
    /// Sums over the steps with their directions doubled, so that forward and backward are one: as read, and with the sign of y changed.
    read: Vector2<f64>,
    mirror: Vector2<f64>,
    way_m: f64,
    /// The way along the headings of each part of a turn.
    along_m: [f64; PARTS],
}

/// The parts of a turn into which headings are sorted.
const PARTS: usize = 32;
/// The smallest share of the way that makes a heading count.
const COUNTS: f64 = 0.01;

impl Way {
    fn add(&mut self, yaw_rad: f64, step_m: Vector2<f64>) {
        let length_m = step_m.norm();
        let doubled = |sign: f64| {
            let body = Rotation2::new(sign * yaw_rad) * step_m;
            let angle_rad = 2.0 * body.y.atan2(body.x);
            length_m * Vector2::new(angle_rad.cos(), angle_rad.sin())
        };
        self.read += doubled(-1.0);
        self.mirror += doubled(1.0);
        self.way_m += length_m;
        let part = (yaw_rad / std::f64::consts::TAU).rem_euclid(1.0) * PARTS as f64;
        self.along_m[(part as usize).min(PARTS - 1)] += length_m;
    }

    fn contradiction(&self) -> Option<Mirrored> {
        let [read, mirror] = [self.read, self.mirror].map(|sum| sum.norm() / self.way_m);
        (mirror > STEADY && read < ASTRAY).then(|| {
            let counts = |along_m: &&f64| **along_m > COUNTS * self.way_m;
            let headings = self.along_m.iter().filter(counts).count();
            Mirrored {
                found: format!("its line of motion in the body frame is constant to {mirror:.2} (of 1) with the sign of y changed, and only to {read:.2} as it is read"),
                is_certain: headings >= HEADINGS && read < SCATTERED,
            }
        })
    }
}

/// A contradiction if positions and orientations do not belong to one right-handed frame: a body that rolls forward along one axis rolls
/// backward along the other, or a robot that turns to one side moves to the other side.
pub(super) fn mirrored(all: &[Recording]) -> Option<Mirrored> {
    let [mut along_x, mut along_y] = [(); 2].map(|()| SignAgreement::default());
    let mut way = Way::default();
    let mut is_upright = true;
    for recording in all {
        let trajectory = &recording.trajectory;
        let turns = trajectory.orientations_world_from_body()?;
        let (times_s, places) = (trajectory.times_s(), trajectory.positions_world_m());
        is_upright &= turns.iter().all(|turn| (turn * Vector3::z()).z > 0.9);
        for index in 1..places.len() {
            let dt_s = times_s[index] - times_s[index - 1];
            let step_m = places[index] - places[index - 1];
            let w = (turns[index] * turns[index - 1].inverse()).scaled_axis() / dt_s;
            // Rolling without slip: the velocity of the centre is the angular velocity cross the vector up from the floor.
            along_x.add(w.y * step_m.x);
            along_y.add(-w.x * step_m.y);
            let ahead = turns[index] * Vector3::x();
            way.add(ahead.y.atan2(ahead.x), step_m.xy());
        }
    }
    if is_upright {
        return way.contradiction();
    }
    let [x, y] = [along_x.share(), along_y.share()];
    let is_clear = all.len() >= TUMBLES && x.abs().min(y.abs()) > AGAINST;
    (is_clear && x * y < 0.0).then(|| Mirrored {
        found: format!("it rolls forward along one axis and backward along the other (x {x:+.2}, y {y:+.2}, each from -1 to 1)"),
        is_certain: true,
    })
}
