//! What a motion tells of its axes: free fall, a floor, rolling.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::super::{Recording, Trajectory};

/// Which of a file's axes points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Up {
    Z,
    Y,
    MinusZ,
    MinusY,
    Other,
}

impl Up {
    /// Up along this axis of the file, or against it.
    fn along(axis: usize, is_positive: bool) -> Self {
        match (axis, is_positive) {
            (2, true) => Self::Z,
            (2, false) => Self::MinusZ,
            (1, true) => Self::Y,
            (1, false) => Self::MinusY,
            _ => Self::Other,
        }
    }
}

/// A free fall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fall {
    /// Its acceleration, in what the lengths were read as a second squared.
    pub size_m_s2: f64,
    pub up: Up,
}

/// Samples through which one parabola is laid.
const WINDOW: usize = 9;
/// So many windows one behind the other fall alike.
const ALIKE: usize = 4;
/// Within this share of their acceleration.
const SPREAD: f64 = 0.08;
/// The axis that falls has this share of the acceleration.
const ALONG: f64 = 0.97;
/// Nothing else that is recorded accelerates so evenly as this, in units of length a second squared.
const LEAST_M_S2: f64 = 5.0;

/// The acceleration of the parabola through these samples.
fn acceleration(times_s: &[f64], places: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let middle_s = times_s[times_s.len() / 2];
    let (mut normal, mut right) = (nalgebra::Matrix3::zeros(), nalgebra::Matrix3::zeros());
    for (time_s, place) in times_s.iter().zip(places) {
        let t = time_s - middle_s;
        let row = Vector3::new(1.0, t, 0.5 * t * t);
        normal += row * row.transpose();
        right += row * place.transpose();
    }
    // Times are small beside one: rows are scaled to be solved well.
    let scale = times_s[times_s.len() - 1] - times_s[0];
    let scales =
        nalgebra::Matrix3::from_diagonal(&Vector3::new(1.0, 1.0 / scale, 1.0 / (scale * scale)));
    let solved = (scales * normal * scales).lu().solve(&(scales * right))?;
    Some((scales * solved).row(2).transpose())
}

/// Free fall, wherever several windows accelerate alike along one axis by what can be gravity in some unit.
pub(super) fn free_fall(trajectory: &Trajectory) -> Option<Fall> {
    let (times_s, places) = (trajectory.times_s(), trajectory.positions_world_m());
    if trajectory.is_planar() || times_s.len() < WINDOW + ALIKE {
        return None;
    }
    let step = (times_s.len() / 4000).max(1);
    let ends = (WINDOW..=times_s.len()).step_by(step);
    let all: Vec<Vector3<f64>> = ends
        .filter_map(|end| acceleration(&times_s[end - WINDOW..end], &places[end - WINDOW..end]))
        .collect();
    let run = all.windows(ALIKE).find_map(|some| {
        let mean = some.iter().sum::<Vector3<f64>>() / ALIKE as f64;
        let is_alike = some
            .iter()
            .all(|one| (one - mean).norm() < SPREAD * mean.norm());
        let along = mean.abs().max() / mean.norm();
        let is_gravity = [1.0, 100.0, 1000.0]
            .iter()
            .any(|size| (mean.norm() / (size * 9.81) - 1.0).abs() < super::FALL);
        (is_alike && along > ALONG && mean.norm() > LEAST_M_S2 && is_gravity).then_some(mean)
    })?;
    let axis = run.iamax();
    Some(Fall {
        size_m_s2: run.norm(),
        up: Up::along(axis, run[axis] < 0.0),
    })
}

/// How far it comes from where it began.
pub(super) fn reach_m(trajectory: &Trajectory) -> f64 {
    let places = trajectory.positions_world_m();
    let far = places.iter().map(|place| (place - places[0]).norm());
    far.fold(0.0, f64::max)
}

/// The axis along which it stays at about half its size, or up to twice, and hardly moves; the height.
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
    // What others do does not matter where z is as it should be.
    let axis = match found.as_slice() {
        all if all.contains(&2) && levels[2].0 > 0.0 => 2,
        [axis] => *axis,
        _ => return None,
    };
    let level_m = levels[axis].0;
    Some((Up::along(axis, level_m > 0.0), level_m))
}

/// Whether it goes along z as far as along another axis, or nearly, and not only between a tenth and twice of its size above zero:
/// no floor is there.
pub(super) fn roams_along_z(trajectory: &Trajectory, body_m: f64) -> bool {
    let ends_m = |axis: usize| {
        let along = || {
            let places = trajectory.positions_world_m().iter();
            places.map(move |place| place[axis])
        };
        let low_m = along().fold(f64::INFINITY, f64::min);
        (low_m, along().fold(f64::NEG_INFINITY, f64::max))
    };
    let range_m = |axis: usize| ends_m(axis).1 - ends_m(axis).0;
    let (low_m, high_m) = ends_m(2);
    let is_over_floor = low_m > 0.1 * body_m && high_m < 2.0 * body_m;
    !is_over_floor && range_m(2) > 0.3 * range_m(0).max(range_m(1))
}

/// Sums of products, and of their sizes: whether two things go together.
#[derive(Default)]
struct Together {
    sum: f64,
    size: f64,
}

impl Together {
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

/// So much of a motion has to speak against the axes.
const AGAINST: f64 = 0.25;
/// Tumbling tells it only over several recordings.
const TUMBLES: usize = 8;

/// What goes on wheels or legs goes in one direction of its own: this sure of it where the axes are mirrored back, …
const STEADY: f64 = 0.9;
/// … and no surer than this as they are read.
const ASTRAY: f64 = 0.5;

/// Why positions and orientations are not of one right-handed world: what rolls forward along one axis rolls backward along the
/// other, or what turns to one side goes to the other.
pub(super) fn mirrored(all: &[Recording]) -> Option<String> {
    let [mut along_x, mut along_y] = [(); 2].map(|()| Together::default());
    // Sums of directions as the body sees them, as read and mirrored, and how far it went.
    let (mut read, mut mirror, mut way_m) = (Vector2::zeros(), Vector2::zeros(), 0.0);
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
            // Rolling without slip: the velocity of the centre is the rate of turn cross the way up from the floor.
            along_x.add(w.y * step_m.x);
            along_y.add(-w.x * step_m.y);
            let ahead = turns[index] * Vector3::x();
            let yaw = Rotation2::new(ahead.y.atan2(ahead.x));
            read += yaw.inverse() * step_m.xy();
            mirror += yaw * step_m.xy();
            way_m += step_m.xy().norm();
        }
    }
    if is_upright {
        let [read, mirror] = [read, mirror].map(|sum| sum.norm() / way_m);
        return (mirror > STEADY && read < ASTRAY).then(|| {
            format!("it goes in one direction of its own, {mirror:.2} of 1, were y the other way round, and {read:.2} as it is read")
        });
    }
    let [x, y] = [along_x.share(), along_y.share()];
    let is_clear = all.len() >= TUMBLES && x.abs().min(y.abs()) > AGAINST;
    (is_clear && x * y < 0.0).then(|| {
        format!("it rolls forward along one axis and backward along the other (x {x:+.2}, y {y:+.2} of 1)")
    })
}
