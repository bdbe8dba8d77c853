//! Follows planned motions (`JointTrajectory`) as a controller does: from the last command to each point, until a later plan comes.

use super::message::{Plan, Point};
use super::series::{AtTimes, Clock};

/// The commanded angles at these times; `None` before the first point of the first plan.
pub(super) fn planned(plans: &[Plan], clock: Clock, times_ns: &[i64]) -> AtTimes {
    let start_ns = |plan: &Plan| match plan.stamp_ns {
        // Such a plan starts when it arrives.
        0 => plan.log_ns.saturating_add(clock.shift_ns),
        stamp_ns if clock.has_stamps => stamp_ns,
        _ => plan.log_ns.saturating_add(clock.shift_ns),
    };
    let mut all: Vec<(i64, &Plan)> = plans.iter().map(|plan| (start_ns(plan), plan)).collect();
    all.sort_by_key(|(start_ns, _)| *start_ns);
    let mut begins: Vec<Option<Vec<f64>>> = Vec::with_capacity(all.len());
    for (index, (start_ns, _)) in all.iter().enumerate() {
        let before = index.checked_sub(1).map(|last| (last, all[last]));
        begins.push(before.and_then(|(last, (since_ns, plan))| {
            commanded(plan, begins[last].as_deref(), start_ns - since_ns)
        }));
    }
    let at = |time_ns: &i64| {
        let next = all.partition_point(|(start_ns, _)| start_ns <= time_ns);
        let last = next.checked_sub(1)?;
        let (start_ns, plan) = all[last];
        commanded(plan, begins[last].as_deref(), time_ns - start_ns)
    };
    times_ns.iter().map(at).collect()
}

/// The angles that a plan commands so long after its start, if `begin` was commanded before it.
fn commanded(plan: &Plan, begin: Option<&[f64]>, since_ns: i64) -> Option<Vec<f64>> {
    let next = plan
        .points
        .partition_point(|point| point.after_start_ns <= since_ns);
    let last = next.checked_sub(1).map(|last| &plan.points[last]);
    match (last, plan.points.get(next)) {
        (Some(from), Some(to)) => Some(between(from, to, since_ns)),
        (Some(last), None) => Some(last.angles.clone()),
        (None, Some(first)) => {
            let from = Point {
                after_start_ns: 0,
                angles: begin?.to_vec(),
                speeds: Vec::new(),
            };
            Some(between(&from, first, since_ns))
        }
        // A plan without points stops the motion where it is.
        (None, None) => begin.map(<[f64]>::to_vec),
    }
}

/// Between two points: on a cubic where both state speeds, else on a line, as `joint_trajectory_controller` of ROS does it.
fn between(from: &Point, to: &Point, at_ns: i64) -> Vec<f64> {
    let length_s = (to.after_start_ns - from.after_start_ns) as f64 * 1e-9;
    let share = (at_ns - from.after_start_ns) as f64 * 1e-9 / length_s;
    let angles = from.angles.iter().zip(&to.angles);
    let lines = angles.map(|(a, b)| a + share * (b - a));
    if from.speeds.is_empty() || to.speeds.is_empty() {
        return lines.collect();
    }
    let speeds = from.speeds.iter().zip(&to.speeds);
    let ends = from.angles.iter().zip(&to.angles).zip(speeds);
    ends.map(|((a, b), (va, vb))| {
        let rest = 1.0 - share;
        let slope = b - a;
        // Hermite's cubic as a line and what bends it.
        let bend = rest * (va * length_s - slope) - share * (vb * length_s - slope);
        a + share * slope + share * rest * bend
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOCK: Clock = Clock {
        has_stamps: false,
        shift_ns: 0,
    };

    fn plan(log_ns: i64, points: &[(i64, f64, Option<f64>)]) -> Plan {
        let point = |(after_start_ns, angle, speed): &(i64, f64, Option<f64>)| Point {
            after_start_ns: *after_start_ns,
            angles: vec![*angle],
            speeds: speed.iter().copied().collect(),
        };
        Plan {
            stamp_ns: 0,
            log_ns,
            joints: vec!["pan".to_owned()],
            points: points.iter().map(point).collect(),
        }
    }

    fn values(plans: &[Plan], times_ns: &[i64]) -> Vec<Option<f64>> {
        let all = planned(plans, CLOCK, times_ns);
        all.into_iter().map(|one| one.map(|one| one[0])).collect()
    }

    #[test]
    fn a_plan_is_followed_until_a_later_one_comes() {
        let plans = [
            plan(100, &[(0, 1.0, None), (100, 2.0, None)]),
            // It comes half way, and starts from what is commanded then.
            plan(150, &[(50, 0.5, None)]),
            plan(400, &[]),
        ];
        let found = values(&plans, &[99, 100, 125, 150, 175, 200, 399, 1000]);
        let expected = [
            None,
            Some(1.0),
            Some(1.25),
            Some(1.5),
            Some(1.0),
            Some(0.5),
            Some(0.5),
            Some(0.5),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn speeds_at_the_points_make_a_cubic() {
        let second = 1_000_000_000;
        let cubic = |t: f64| t * t * t - t + 0.3;
        let points = [
            (0, cubic(0.0), Some(-1.0)),
            (2 * second, cubic(2.0), Some(11.0)),
        ];
        let found = values(&[plan(0, &points)], &[second / 2, second, 3 * second / 2]);
        for (found, t) in found.into_iter().zip([0.5, 1.0, 1.5]) {
            assert!((found.unwrap() - cubic(t)).abs() < 1e-12);
        }
    }
}
