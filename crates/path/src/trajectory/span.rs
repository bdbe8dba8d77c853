//! A span of time, and the part of a trajectory inside of it.

use std::fmt;

use super::resample::{Interpolator, at_places};
use super::{Trajectory, clip};
use realgap_core::error::{Error, Result};

/// Times that differ by less are equal: a microsecond is below the resolution of a recording's clock.
const SAME_S: f64 = 1e-6;

/// The time between two moments, seconds of one clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The first moment.
    pub from_s: f64,
    /// The last moment, not before the first.
    pub to_s: f64,
}

impl Span {
    /// From the first to the last sample.
    pub fn of(trajectory: &Trajectory) -> Self {
        let times_s = trajectory.times_s();
        Self {
            from_s: times_s[0],
            to_s: times_s[times_s.len() - 1],
        }
    }

    /// The same span with moments that are `by_s` seconds later.
    #[must_use]
    pub fn later(self, by_s: f64) -> Self {
        Self {
            from_s: self.from_s + by_s,
            to_s: self.to_s + by_s,
        }
    }

    /// The time that belongs to both spans; `None` if they have no moment, or only one, in common.
    #[must_use]
    pub fn common(self, other: Self) -> Option<Self> {
        let common = Self {
            from_s: self.from_s.max(other.from_s),
            to_s: self.to_s.min(other.to_s),
        };
        (common.duration_s() > SAME_S).then_some(common)
    }

    /// Length, seconds.
    pub fn duration_s(self) -> f64 {
        self.to_s - self.from_s
    }

    /// The part of a trajectory in this span; its first and its last sample are interpolated where they fall between two samples.
    /// A trajectory that lies in the span is returned whole.
    ///
    /// # Errors
    /// A trajectory without time in this span.
    pub fn cut(self, whole: &Trajectory) -> Result<Trajectory> {
        let all = Self::of(whole);
        let Some(part) = self.common(all) else {
            return Err(Error::invalid("the trajectory has no time in this span")
                .found(all)
                .allowed(self));
        };
        if part.from_s <= all.from_s + SAME_S {
            return clip(whole, part.to_s - all.from_s);
        }
        let inside = |time_s: f64| time_s > part.from_s + SAME_S && time_s < part.to_s - SAME_S;
        let between = whole.times_s().iter().copied().filter(|t| inside(*t));
        let mut times_s = vec![part.from_s];
        times_s.extend(between);
        times_s.push(part.to_s);
        let mut at = Interpolator::new(whole);
        let places = times_s.iter().map(|time_s| at.place(time_s - all.from_s));
        let places: Vec<_> = places.collect();
        let signals = whole.signals().iter();
        let signals = signals.map(|s| s.map(|all| places.iter().map(|p| p.held(all)).collect()));
        at_places(whole, times_s, &places)?.with_signals(signals.collect())
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} to {:.3} s", self.from_s, self.to_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    fn ahead(start_s: f64) -> Trajectory {
        let times: Vec<f64> = (0..11).map(|i| start_s + f64::from(i) * 0.1).collect();
        let at = |t: &f64| Vector3::new(2.0 * (t - start_s), 0.0, 0.0);
        let turn = |t: &f64| UnitQuaternion::from_euler_angles(0.0, 0.0, t - start_s);
        Trajectory::new(times.clone(), times.iter().map(at).collect())
            .and_then(|path| path.with_orientations(times.iter().map(turn).collect()))
            .unwrap()
    }

    #[test]
    fn both_ends_of_a_part_are_interpolated() {
        let whole = ahead(100.0);
        let span = Span {
            from_s: 100.25,
            to_s: 100.62,
        };
        let part = span.cut(&whole).unwrap();
        assert_eq!(part.times_s()[0], 100.25);
        assert_eq!(part.times_s()[part.len() - 1], 100.62);
        assert_eq!(part.len(), 6);
        assert!((part.positions_world_m()[0].x - 0.5).abs() < 1e-9);
        assert!((part.net_displacement_world_m().x - 0.74).abs() < 1e-9);
        let turned = part.orientations_world_from_body().unwrap();
        assert!((turned[0].angle() - 0.25).abs() < 1e-9);
    }

    #[test]
    fn a_trajectory_inside_of_the_span_is_returned_whole() {
        let whole = ahead(0.0);
        let wide = Span {
            from_s: -1.0,
            to_s: 9.0,
        };
        assert_eq!(wide.cut(&whole).unwrap(), whole);
        assert_eq!(Span::of(&whole).cut(&whole).unwrap(), whole);
        assert!(Span::of(&ahead(7.0)).cut(&whole).is_err());
    }

    #[test]
    fn one_moment_in_common_is_no_common_time() {
        let (first, second) = (Span::of(&ahead(0.0)), Span::of(&ahead(1.0)));
        assert_eq!(first.common(second), None);
        let half = first.common(first.later(0.5)).unwrap();
        assert!((half.duration_s() - 0.5).abs() < 1e-12);
    }
}
