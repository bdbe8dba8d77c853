//! Cuts parts out of trajectories.

use super::reading::Crop;
use super::{Recording, Trajectory};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::warning::{Code, Warning};

/// The first `duration_s` seconds of a trajectory. If the end falls between two samples, the last sample is
/// linearly interpolated. A trajectory that is not longer is returned whole.
///
/// # Errors
/// None for a valid trajectory and a positive duration.
pub fn clip(whole: &Trajectory, duration_s: f64) -> Result<Trajectory> {
    let times_s = whole.times_s();
    let end_s = times_s[0] + duration_s;
    // A microsecond is below the resolution of a recording's clock.
    let tolerance_s = 1e-6;
    if times_s[times_s.len() - 1] <= end_s + tolerance_s {
        return Ok(whole.clone());
    }
    let kept = times_s
        .iter()
        .filter(|t| **t <= end_s + tolerance_s)
        .count()
        .max(1);
    let needs_end = kept < 2 || times_s[kept - 1] < end_s - tolerance_s;
    let share = (end_s - times_s[kept - 1]) / (times_s[kept] - times_s[kept - 1]);
    let mut times = times_s[..kept].to_vec();
    let mut positions = whole.positions_world_m()[..kept].to_vec();
    if needs_end {
        times.push(end_s);
        positions.push(
            whole.positions_world_m()[kept - 1].lerp(&whole.positions_world_m()[kept], share),
        );
    }
    let mut clipped = Trajectory::new(times, positions)?;
    if let Some(all) = whole.orientations_world_from_body() {
        let mut orientations = all[..kept].to_vec();
        if needs_end {
            orientations.push(
                all[kept - 1]
                    .try_slerp(&all[kept], share, 1e-12)
                    .unwrap_or(all[kept]),
            );
        }
        clipped = clipped.with_orientations(orientations)?;
    }
    if let Some([linear, angular]) = whole.velocities() {
        let cut = |all: &[nalgebra::Vector3<f64>]| {
            let mut some = all[..kept].to_vec();
            if needs_end {
                some.push(all[kept - 1].lerp(&all[kept], share));
            }
            some
        };
        clipped = clipped.with_velocities(cut(linear), cut(angular))?;
    }
    let cut = |all: &[f64], share: f64| {
        let mut some = all[..kept].to_vec();
        if needs_end {
            some.push(all[kept - 1] + share * (all[kept] - all[kept - 1]));
        }
        some
    };
    let joints = whole.joints().iter().map(|j| j.map(|all| cut(all, share)));
    clipped = clipped.with_joints(joints.collect())?;
    let signals = whole.signals().iter().map(|s| s.map(|all| cut(all, 0.0)));
    clipped = clipped.with_signals(signals.collect())?;
    Ok(clipped.planar_like(whole))
}

/// The samples of a part; no sample is interpolated.
///
/// # Errors
/// Fewer than two samples in the part.
pub(super) fn cropped(whole: &Trajectory, crop: Crop) -> Result<Trajectory> {
    let times_s = whole.times_s();
    let to_s = crop.to_s.unwrap_or(f64::INFINITY);
    let is_in = |time_s: f64| {
        let since_start_s = time_s - times_s[0];
        // A microsecond is below the resolution of a recording's clock.
        (crop.from_s - 1e-6..=to_s + 1e-6).contains(&since_start_s)
    };
    let from = times_s.iter().take_while(|t| !is_in(**t)).count();
    let kept = times_s[from..].iter().take_while(|t| is_in(**t)).count();
    if kept < 2 {
        return Err(
            Error::invalid("fewer than two samples of this recording are left")
                .field("crop")
                .found(crop)
                .allowed(format!("a part of 0 s to {:.3} s", whole.duration_s()))
                .advise(Advice::Crop),
        );
    }
    samples(whole, from..from + kept)
}

/// The part of `duration_s` seconds from the sample with index `first`; the last sample may be interpolated as in [`clip`].
///
/// # Errors
/// Fewer than two samples in the part.
pub fn cut_out(whole: &Trajectory, first: usize, duration_s: f64) -> Result<Trajectory> {
    let times_s = whole.times_s();
    let Some(start_s) = times_s.get(first) else {
        return Err(Error::invalid("the part begins after the end of the trajectory").found(first));
    };
    let end_s = start_s + duration_s - 1e-6;
    let last = times_s
        .partition_point(|t| *t < end_s)
        .min(times_s.len() - 1);
    clip(
        &samples(whole, first..(last + 1).max(first + 2).min(times_s.len()))?,
        duration_s,
    )
}

/// The samples with these indices.
fn samples(whole: &Trajectory, part: std::ops::Range<usize>) -> Result<Trajectory> {
    let times_s = whole.times_s();
    let positions = whole.positions_world_m()[part.clone()].to_vec();
    let mut cropped = Trajectory::new(times_s[part.clone()].to_vec(), positions)?;
    if let Some(all) = whole.orientations_world_from_body() {
        cropped = cropped.with_orientations(all[part.clone()].to_vec())?;
    }
    if let Some([linear, angular]) = whole.velocities() {
        let (linear, angular) = (&linear[part.clone()], &angular[part.clone()]);
        cropped = cropped.with_velocities(linear.to_vec(), angular.to_vec())?;
    }
    let joints = whole.joints().iter();
    let joints = joints.map(|joint| joint.map(|all| all[part.clone()].to_vec()));
    cropped = cropped.with_joints(joints.collect())?;
    let signals = whole.signals().iter();
    let signals = signals.map(|signal| signal.map(|all| all[part.clone()].to_vec()));
    cropped = cropped.with_signals(signals.collect())?;
    Ok(cropped.planar_like(whole))
}

/// Cuts all recordings to the duration of the shortest, so that they are compared at equal times; returns a warning if any
/// recording was cut.
///
/// # Errors
/// None for valid trajectories.
pub fn cut_to_shortest(recordings: &mut [&mut Recording]) -> Result<Option<Warning>> {
    let durations = recordings.iter().map(|r| r.trajectory.duration_s());
    let shortest_s = durations.clone().fold(f64::INFINITY, f64::min);
    let longest_s = durations.fold(0.0, f64::max);
    for recording in recordings {
        recording.trajectory = clip(&recording.trajectory, shortest_s)?;
    }
    Ok((longest_s > shortest_s + 1e-6).then(|| {
        Code::ReadAs.warning(format!(
            "compared at equal times over the first {shortest_s:.3} s, the duration of the shortest recording; the longest lasts {longest_s:.3} s"
        ))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn an_end_between_two_samples_is_interpolated() {
        let times: Vec<f64> = (0..11).map(|i| 3.0 + f64::from(i) * 0.1).collect();
        let positions = times
            .iter()
            .map(|t| Vector3::new(2.0 * t, 0.0, 0.0))
            .collect();
        let whole = Trajectory::new(times, positions).unwrap();
        let half = clip(&whole, 0.55).unwrap();
        assert_eq!(half.len(), 7);
        assert!((half.duration_s() - 0.55).abs() < 1e-12);
        assert!((half.net_displacement_world_m().x - 1.1).abs() < 1e-12);
        assert_eq!(clip(&whole, 0.5).unwrap().len(), 6);
        assert_eq!(clip(&whole, 1.0).unwrap(), whole);
        assert_eq!(clip(&whole, 9.0).unwrap(), whole);
    }
}
