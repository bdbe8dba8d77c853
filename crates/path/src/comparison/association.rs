//! Which samples of two trajectories belong together in time.

use nalgebra::{UnitQuaternion, Vector3};

use super::umeyama::{Similarity, Umeyama};
use crate::trajectory::{Interpolator, Trajectory};
use realgap_core::error::{Error, Result};

/// The usual largest difference of two stamps that belong together, seconds; it is evo's.
pub const MAX_DIFFERENCE_S: f64 = 0.01;
/// The fewest matched samples from which a distance is computed: with one, nothing can be said about a motion.
const FEWEST: usize = 2;

/// The rule by which samples are matched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Association {
    /// Every sample of the trajectory with fewer samples is matched with the nearest one in time of the other, as evo does it.
    Nearest {
        /// Samples farther apart in time than this are not matched, seconds.
        max_difference_s: f64,
    },
    /// Every sample of the reference in the common time is matched with the other trajectory's interpolated pose: linear in position,
    /// slerp in orientation.
    Interpolated,
}

impl Default for Association {
    fn default() -> Self {
        Self::Nearest {
            max_difference_s: MAX_DIFFERENCE_S,
        }
    }
}

impl Association {
    /// Checks the largest difference of times.
    ///
    /// # Errors
    /// A difference that is negative or no number.
    pub fn check(self) -> Result<()> {
        match self {
            Self::Nearest { max_difference_s }
                if !(max_difference_s >= 0.0 && max_difference_s.is_finite()) =>
            {
                Err(Error::usage("samples cannot be matched within this time")
                    .field("max_difference")
                    .found(max_difference_s)
                    .allowed("a number of seconds, 0 or more"))
            }
            _ => Ok(()),
        }
    }
}

/// The stamps of one trajectory, and how much later its clock is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stamped<'a> {
    pub(super) trajectory: &'a Trajectory,
    /// This is subtracted from the times first, seconds: 0, or the time of the first sample.
    pub(super) start_s: f64,
}

impl Stamped<'_> {
    fn stamps_s(self) -> Vec<f64> {
        let times_s = self.trajectory.times_s().iter();
        times_s.map(|time_s| time_s - self.start_s).collect()
    }
}

/// The matched poses of two trajectories.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// Positions of the reference, metres.
    reference_m: Vec<Vector3<f64>>,
    /// Positions of the other trajectory, metres.
    other_m: Vec<Vector3<f64>>,
    /// Orientations of the reference and of the other, if both trajectories have them.
    turns: Option<[Vec<UnitQuaternion<f64>>; 2]>,
    /// Samples of the reference without a partner.
    unmatched_reference: usize,
    /// Samples of the other trajectory without a partner.
    unmatched_other: usize,
}

impl Matched {
    /// Matches two trajectories, the other's stamps being `offset_s` too late.
    ///
    /// # Errors
    /// Fewer than two samples are matched.
    pub(super) fn new(
        reference: Stamped<'_>,
        other: Stamped<'_>,
        offset_s: f64,
        rule: Association,
    ) -> Result<Self> {
        rule.check()?;
        let matched = match rule {
            Association::Nearest { max_difference_s } => {
                nearest(reference, other, offset_s, max_difference_s)
            }
            Association::Interpolated => interpolated(reference, other, offset_s),
        };
        if matched.len() < FEWEST {
            let found = match matched.len() {
                0 => "no sample",
                _ => "one sample",
            };
            return Err(too_few(rule).found(format!("{found} in common")));
        }
        Ok(matched)
    }

    /// The same with the other trajectory brought onto the reference.
    #[must_use]
    pub fn aligned(mut self, alignment: Umeyama) -> Self {
        let scales = match alignment {
            Umeyama::None => return self,
            Umeyama::Se3 => false,
            Umeyama::Sim3 => true,
        };
        let best = Similarity::best(&self.reference_m, &self.other_m, scales);
        for position in &mut self.other_m {
            *position = best.scale * (best.turn * *position) + best.shift_m;
        }
        if let Some([_, turns]) = &mut self.turns {
            for turn in turns {
                *turn = best.turn * *turn;
            }
        }
        self
    }

    /// Number of matched pairs of samples, at least 2.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.reference_m.len()
    }

    /// Numbers of samples without a partner: of the reference, and of the other trajectory.
    pub fn unmatched(&self) -> [usize; 2] {
        [self.unmatched_reference, self.unmatched_other]
    }

    /// Positions of the reference and of the other trajectory, metres, equally many.
    pub fn positions_m(&self) -> [&[Vector3<f64>]; 2] {
        [&self.reference_m, &self.other_m]
    }

    /// Orientations of the reference and of the other trajectory, if both have them.
    pub fn orientations(&self) -> Option<[&[UnitQuaternion<f64>]; 2]> {
        let [reference, other] = self.turns.as_ref()?;
        Some([reference, other])
    }

    /// Pairs of samples by their indices.
    fn of_indices(a: &Trajectory, b: &Trajectory, pairs: &[(usize, usize)]) -> Self {
        let positions = |of: &Trajectory, at: &dyn Fn(&(usize, usize)) -> usize| {
            let flatten = flattened(a, b);
            let all = pairs.iter().map(|pair| of.positions_world_m()[at(pair)]);
            all.map(flatten).collect()
        };
        let turns = a
            .orientations_world_from_body()
            .zip(b.orientations_world_from_body());
        let turns = turns.map(|(a, b)| {
            [
                pairs.iter().map(|(i, _)| a[*i]).collect(),
                pairs.iter().map(|(_, j)| b[*j]).collect(),
            ]
        });
        // One sample may be the nearest of several.
        let mut partners: Vec<usize> = pairs.iter().map(|(_, j)| *j).collect();
        partners.sort_unstable();
        partners.dedup();
        let mut sought: Vec<usize> = pairs.iter().map(|(i, _)| *i).collect();
        sought.sort_unstable();
        sought.dedup();
        Self {
            reference_m: positions(a, &|pair| pair.0),
            other_m: positions(b, &|pair| pair.1),
            turns,
            unmatched_reference: a.len() - sought.len(),
            unmatched_other: b.len() - partners.len(),
        }
    }
}

/// The position that is compared. As for the other metrics, heights count only where both trajectories have them.
fn flattened(a: &Trajectory, b: &Trajectory) -> impl Fn(Vector3<f64>) -> Vector3<f64> + use<> {
    let is_flat = a.is_planar() || b.is_planar();
    move |p| match is_flat {
        true => Vector3::new(p.x, p.y, 0.0),
        false => p,
    }
}

fn too_few(rule: Association) -> Error {
    use realgap_core::error::Advice;
    let error = Error::invalid("too few samples of the two trajectories belong together");
    match rule {
        Association::Nearest { max_difference_s } => error
            .allowed(format!(
                "two or more within {max_difference_s} s of each other"
            ))
            .advise(Advice::Associate),
        Association::Interpolated => error
            .allowed("two or more samples of the reference in the common time")
            .advise(Advice::OtherTime),
    }
}

/// The samples nearest to each other in time. The rules for the search, for ties and for the range are evo's
/// (`sync.associate_trajectories`, evo 1.38.1): the stamps of the trajectory with fewer samples are looked up in the other (those of
/// the second where both have equally many), of two equally near samples the earlier one is taken, and one sample may be the partner
/// of several.
fn nearest(
    reference: Stamped<'_>,
    other: Stamped<'_>,
    offset_s: f64,
    max_difference_s: f64,
) -> Matched {
    let (a_s, b_s) = (reference.stamps_s(), other.stamps_s());
    let other_is_longer = b_s.len() > a_s.len();
    let pairs: Vec<(usize, usize)> = if other_is_longer {
        nearest_stamps(&a_s, &b_s, -offset_s, max_difference_s)
    } else {
        let found = nearest_stamps(&b_s, &a_s, offset_s, max_difference_s);
        found.into_iter().map(|(j, i)| (i, j)).collect()
    };
    Matched::of_indices(reference.trajectory, other.trajectory, &pairs)
}

/// For every stamp of `few`, the index of the nearest of `many`, whose stamps are first made `later_s` later.
fn nearest_stamps(
    few: &[f64],
    many: &[f64],
    later_s: f64,
    max_difference_s: f64,
) -> Vec<(usize, usize)> {
    let at = |index: usize| many[index] + later_s;
    let last = many.len() - 1;
    let mut pairs = Vec::with_capacity(few.len());
    for (index, stamp_s) in few.iter().enumerate() {
        if *stamp_s < at(0) - max_difference_s || *stamp_s > at(last) + max_difference_s {
            continue;
        }
        let after = many.partition_point(|time_s| time_s + later_s <= *stamp_s);
        let after = after.min(last);
        let to_after_s = at(after) - stamp_s;
        let from_before_s = match after {
            0 => f64::INFINITY,
            _ => stamp_s - at(after - 1),
        };
        if to_after_s <= max_difference_s && to_after_s < from_before_s {
            pairs.push((index, after));
        } else if from_before_s <= max_difference_s && from_before_s <= to_after_s {
            pairs.push((index, after - 1));
        }
    }
    pairs
}

/// The other trajectory's poses at the stamps of the reference that lie between its ends.
fn interpolated(reference: Stamped<'_>, other: Stamped<'_>, offset_s: f64) -> Matched {
    let (a, b) = (reference.trajectory, other.trajectory);
    // Times of the other trajectory are counted from its first sample; rounding must not lose a sample at an end.
    let first_s = b.times_s()[0] - other.start_s;
    let since_s = |stamp_s: f64| (stamp_s - first_s) + offset_s;
    let tolerance_s = 1e-9 * b.duration_s() + 1e-9;
    let range = -tolerance_s..=b.duration_s() + tolerance_s;
    let flatten = flattened(a, b);
    let both =
        a.orientations_world_from_body().is_some() && b.orientations_world_from_body().is_some();
    let mut at = Interpolator::new(b);
    let mut matched = Matched {
        reference_m: Vec::new(),
        other_m: Vec::new(),
        turns: both.then(|| [Vec::new(), Vec::new()]),
        unmatched_reference: 0,
        unmatched_other: 0,
    };
    for (index, stamp_s) in reference.stamps_s().into_iter().enumerate() {
        let time_s = since_s(stamp_s);
        if !range.contains(&time_s) {
            matched.unmatched_reference += 1;
            continue;
        }
        matched
            .reference_m
            .push(flatten(a.positions_world_m()[index]));
        matched.other_m.push(flatten(at.position_world_m(time_s)));
        let turn = at.orientation_world_from_body(time_s);
        let turns = a.orientations_world_from_body().zip(turn);
        if let (Some([mine, theirs]), Some((all, turn))) = (&mut matched.turns, turns) {
            mine.push(all[index]);
            theirs.push(turn);
        }
    }
    // Samples of the other trajectory outside of the reference's time serve no stamp.
    let ends_s = [0, a.len() - 1].map(|end| since_s(a.times_s()[end] - reference.start_s));
    let span = ends_s[0] - tolerance_s..=ends_s[1] + tolerance_s;
    let starts_s = b.times_s()[0];
    let outside = b
        .times_s()
        .iter()
        .filter(|time_s| !span.contains(&(*time_s - starts_s)));
    matched.unmatched_other = outside.count();
    matched
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(times_s: &[f64]) -> Trajectory {
        let positions = times_s.iter().map(|t| Vector3::new(*t, 0.0, 0.0));
        Trajectory::new(times_s.to_vec(), positions.collect()).unwrap()
    }

    fn stamped(trajectory: &Trajectory) -> Stamped<'_> {
        Stamped {
            trajectory,
            start_s: 0.0,
        }
    }

    #[test]
    fn the_nearest_sample_is_taken_and_of_two_equally_near_ones_the_earlier() {
        let many = [0.0, 0.25, 0.5, 0.75, 1.0];
        for (stamp_s, within_s, expected) in [
            (0.375, 0.2, Some(1)),
            (0.376, 0.2, Some(2)),
            (0.25, 0.0, Some(1)),
            (0.3, 0.01, None),
            (-0.1, 0.2, Some(0)),
            (-0.3, 0.2, None),
            (1.1, 0.2, Some(4)),
            (1.3, 0.2, None),
            (1.0, 0.0, Some(4)),
        ] {
            let found = nearest_stamps(&[stamp_s], &many, 0.0, within_s);
            let expected: Vec<_> = expected.map(|index| (0, index)).into_iter().collect();
            assert_eq!(found, expected, "{stamp_s} within {within_s}");
        }
    }

    #[test]
    fn the_shorter_trajectory_is_looked_up_in_the_longer_and_an_offset_is_taken_away() {
        let (few, many) = (line(&[1.0, 2.0]), line(&[0.0, 0.5, 1.0, 1.5, 2.0]));
        let late = many.later(0.25).unwrap();
        let rule = Association::default();
        for (a, b, offset_s) in [
            (&few, &many, 0.0),
            (&few, &late, 0.25),
            (&many, &few, 0.0),
            (&late, &few, -0.25),
        ] {
            let matched = Matched::new(stamped(a), stamped(b), offset_s, rule).unwrap();
            assert_eq!(matched.len(), 2);
            assert_eq!(matched.unmatched().iter().sum::<usize>(), 3);
            let [p, q] = matched.positions_m();
            assert_eq!((p[1] - p[0]).x, (q[1] - q[0]).x);
        }
    }

    #[test]
    fn interpolation_uses_every_sample_of_the_reference_in_the_common_time() {
        let reference = line(&[-1.0, 0.1, 0.2, 0.3, 5.0]);
        let other = line(&[-2.0, 0.0, 0.25, 0.5, 9.0]).later(100.0).unwrap();
        let rule = Association::Interpolated;
        let matched = Matched::new(stamped(&reference), stamped(&other), 100.0, rule).unwrap();
        assert_eq!((matched.len(), matched.unmatched()), (5, [0, 2]));
        let [p, q] = matched.positions_m();
        for (p, q) in p.iter().zip(q) {
            assert!((p - q).norm() < 1e-12, "{p} {q}");
        }
    }

    #[test]
    fn one_sample_in_common_is_refused() {
        let (a, b) = (line(&[0.0, 1.0, 2.0]), line(&[2.0, 3.0, 4.0]));
        for rule in [Association::default(), Association::Interpolated] {
            let error = Matched::new(stamped(&a), stamped(&b), 0.0, rule).unwrap_err();
            assert!(
                error.to_string().contains("one sample in common"),
                "{error}"
            );
        }
        let negative = Association::Nearest {
            max_difference_s: -1.0,
        };
        assert!(Matched::new(stamped(&a), stamped(&b), 0.0, negative).is_err());
    }
}
