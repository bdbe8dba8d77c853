//! Runs compared with each other: moved onto one start, and their distances at equal times.

use nalgebra::{UnitQuaternion, Vector3};

use realgap_core::error::Result;
use realgap_core::statistics::ends_of;
use realgap_path::trajectory::{Interpolator, Trajectory, prepare};
use realgap_simulation::Film;

/// Points of a curve over time.
pub(in crate::report) const CURVE: usize = 241;

/// A recorded film as it is compared: its first point on that of `onto`, turned about z so that both net displacements have one
/// direction.
///
/// # Errors
/// Paths too long to be compared.
pub(in crate::report) fn laid_onto(film: &Film, onto: &Trajectory) -> Result<Film> {
    let turn_rad = prepare(onto)?.heading_rad() - prepare(&film.track)?.heading_rad();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
    let [from, to] = [&film.track, onto].map(|track| track.positions_world_m()[0]);
    film.moved(turn_rad, to - turn * from)
}

/// The distance of two motions at equal times since their starts, as long as both last: time in seconds and distance in metres,
/// in space where both know heights, else in the plane.
pub(in crate::report) fn distances(a: &Trajectory, b: &Trajectory) -> Vec<[f64; 2]> {
    let is_planar = a.is_planar() || b.is_planar();
    let end_s = a.duration_s().min(b.duration_s());
    let (mut of_a, mut of_b) = (Interpolator::new(a), Interpolator::new(b));
    let distances = times(end_s).map(|t_s| {
        let difference = of_a.position_world_m(t_s) - of_b.position_world_m(t_s);
        [t_s, length_m(difference, is_planar)]
    });
    distances.collect()
}

/// How far each of several motions is from the mean of the others at equal times: time, smallest and largest distance. Empty for
/// fewer than two.
pub(in crate::report) fn spread(motions: &[&Trajectory]) -> Vec<[f64; 3]> {
    if motions.len() < 2 {
        return Vec::new();
    }
    let is_planar = motions.iter().any(|motion| motion.is_planar());
    let (end_s, _) = ends_of(motions.iter().map(|motion| motion.duration_s()));
    let all = motions.iter().map(|motion| Interpolator::new(motion));
    let mut all: Vec<_> = all.collect();
    let spread = times(end_s).map(|t_s| {
        let places = all.iter_mut().map(|one| one.position_world_m(t_s));
        let places: Vec<Vector3<f64>> = places.collect();
        let sum: Vector3<f64> = places.iter().sum();
        let others = (places.len() - 1) as f64;
        let differences = places.iter().map(|place| place - (sum - place) / others);
        let (low, high) = ends_of(differences.map(|d| length_m(d, is_planar)));
        [t_s, low, high]
    });
    spread.collect()
}

fn length_m(difference_m: Vector3<f64>, is_planar: bool) -> f64 {
    match is_planar {
        true => difference_m.xy().norm(),
        false => difference_m.norm(),
    }
}

fn times(end_s: f64) -> impl Iterator<Item = f64> {
    (0..CURVE).map(move |k| end_s * k as f64 / (CURVE - 1) as f64)
}

/// Mean of a curve over its points.
pub(in crate::report) fn mean(curve: &[[f64; 2]]) -> f64 {
    curve.iter().map(|[_, value]| value).sum::<f64>() / curve.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(angle_rad: f64, speed_m_s: f64, start: [f64; 2]) -> Film {
        let at = |t: f64| {
            Vector3::new(
                start[0] + speed_m_s * t * angle_rad.cos(),
                start[1] + speed_m_s * t * angle_rad.sin(),
                0.1,
            )
        };
        let track = Trajectory::new(vec![0.0, 1.0, 2.0], vec![at(0.0), at(1.0), at(2.0)]).unwrap();
        Film {
            track,
            parts: Vec::new(),
            scene: Vec::new(),
        }
    }

    #[test]
    fn a_run_in_another_direction_at_another_place_is_the_same_run() {
        let (a, b) = (
            straight(0.3, 0.5, [1.0, 2.0]),
            straight(-2.0, 0.5, [0.0, -1.0]),
        );
        let laid = laid_onto(&b, &a.track).unwrap();
        assert!(
            distances(&a.track, &laid.track)
                .iter()
                .all(|[_, m]| *m < 1e-12)
        );
        // A faster one is ahead by the difference of the speeds times the time.
        let fast = laid_onto(&straight(1.0, 0.7, [5.0, 5.0]), &a.track).unwrap();
        for [t, m] in distances(&a.track, &fast.track) {
            assert!((m - 0.2 * t).abs() < 1e-12, "{t} {m}");
        }
    }

    #[test]
    fn the_spread_is_that_from_the_mean_of_the_others() {
        let runs = [0.4, 0.5, 0.9].map(|speed| straight(0.0, speed, [0.0, 0.0]).track);
        assert!(spread(&[&runs[0]]).is_empty());
        let spread = spread(&[&runs[0], &runs[1], &runs[2]]);
        let [t, low, high] = spread[CURVE - 1];
        // 0.4 from 0.7, 0.5 from 0.65, 0.9 from 0.45; after two seconds.
        assert!((t - 2.0).abs() < 1e-12 && (low - 0.3).abs() < 1e-12 && (high - 0.9).abs() < 1e-12);
    }
}
