//! Computes from a trajectory the time at which a robot reaches a goal.

use realgap_core::error::{Error, Result};
use realgap_core::statistics::Duration;
use realgap_path::trajectory::Trajectory;

/// A position to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Position of the goal, world frame, metres.
    pub position_world_m: [f64; 2],
    /// The goal is reached within this distance, metres.
    pub within_m: f64,
}

/// The time from the first sample until the robot first is within the given distance of the goal. If the robot does not reach the
/// goal, the trial counts as given up at the last sample. Between samples the robot is assumed to move on a straight line.
///
/// # Errors
/// A distance that is not above 0, a position that is not finite, a robot that starts at the goal.
pub fn time_to_reach(motion: &Trajectory, goal: &Goal) -> Result<Duration> {
    if !(goal.within_m > 0.0 && goal.within_m.is_finite()) {
        return Err(
            Error::usage("the distance at which the goal is reached must be above 0")
                .field("within")
                .found(goal.within_m)
                .allowed("metres above 0"),
        );
    }
    if !goal.position_world_m.iter().all(|v| v.is_finite()) {
        return Err(Error::usage("the position of the goal must be finite")
            .field("reach")
            .found(format!("{:?}", goal.position_world_m))
            .allowed("metres, finite"));
    }
    let times = motion.times_s();
    let off: Vec<[f64; 2]> = motion
        .positions_world_m()
        .iter()
        .map(|p| {
            [
                p.x - goal.position_world_m[0],
                p.y - goal.position_world_m[1],
            ]
        })
        .collect();
    let first = off.first().zip(times.first());
    if first.is_none_or(|([x, y], _)| x.hypot(*y) <= goal.within_m) {
        return Err(Error::invalid(
            "the robot starts at the goal, so it has no time to reach it",
        ));
    }
    let start_s = times[0];
    for index in 1..off.len() {
        let ([ax, ay], [bx, by]) = (off[index - 1], off[index]);
        let (dx, dy) = (bx - ax, by - ay);
        // Solves |a + u d|² = r² for the smallest u in 0 to 1.
        let (aa, ad, dd) = (ax * ax + ay * ay, ax * dx + ay * dy, dx * dx + dy * dy);
        let rest = ad * ad - dd * (aa - goal.within_m * goal.within_m);
        if dd > 0.0 && rest >= 0.0 {
            let u = (-ad - rest.sqrt()) / dd;
            if (0.0..=1.0).contains(&u) {
                let time_s = times[index - 1] + u * (times[index] - times[index - 1]) - start_s;
                return Ok(Duration {
                    time_s,
                    finished: true,
                });
            }
        }
    }
    Ok(Duration {
        time_s: times[times.len() - 1] - start_s,
        finished: false,
    })
}
