//! The doubt about several bodies whose samples alternate in one recording.

use super::Seen;
use super::series::{Series as _, quantile};
use nalgebra::Vector3;
use realgap_core::unit::number;

/// A body's own step is the shortest one among those to this many earlier samples.
const LOOK_BACK: usize = 6;
/// The shares of own steps below which the usual one is looked for: bodies move at different speeds.
const USUAL: [f64; 3] = [0.75, 0.9, 0.95];
/// A sample belongs to a body if it is at most this many usual steps from the body's last sample.
const NEAR: f64 = 8.0;
/// The largest number of bodies; a path with more places is the motion of one body, or noise.
const BODIES: usize = 8;
/// The smallest share of the samples that each of two bodies has.
const SHARE: f64 = 0.1;
/// The smallest number of jumps back to a body that was left.
const RETURNS: usize = 6;

/// Two places nearer than this, metres, are one body whose tracker wavers between two answers.
const APART_M: f64 = 0.01;

/// The samples of one body.
struct Body {
    last: usize,
    samples: usize,
}

/// A message if the path jumps back and forth between bodies that each move by small steps.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let positions = seen.trajectory.positions_world_m();
    let own_step = |k: usize| {
        let earlier = k.saturating_sub(LOOK_BACK)..k;
        earlier
            .map(|j| positions.distance(j, k))
            .fold(f64::INFINITY, f64::min)
    };
    let own: Vec<f64> = (1..positions.len())
        .map(own_step)
        .filter(|step| *step > 0.0)
        .collect();
    USUAL.into_iter().find_map(|share| {
        let usual_m = quantile(own.clone(), share)?;
        bodies(seen, positions, usual_m)
    })
}

fn bodies(seen: &Seen<'_>, positions: &[Vector3<f64>], usual_m: f64) -> Option<String> {
    let mut all: Vec<Body> = Vec::new();
    let (mut current, mut returns, mut first) = (0, 0, None);
    let mut farthest_m = 0.0_f64;
    // Samples that are exactly 0 are lost, which is another doubt.
    let is_lost = |k: &usize| *k > 0 && positions.is_zero(*k);
    for k in (0..positions.len()).filter(|k| !is_lost(k)) {
        let distances = all.iter().map(|body| positions.distance(body.last, k));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        match nearest {
            Some((index, distance_m)) if distance_m <= NEAR * usual_m => {
                if index != current {
                    returns += 1;
                    first = first.or(Some(k));
                    farthest_m = farthest_m.max(positions.distance(all[current].last, k));
                }
                current = index;
                all[index].last = k;
                all[index].samples += 1;
            }
            _ if all.len() == BODIES => return None,
            _ => {
                current = all.len();
                all.push(Body {
                    last: k,
                    samples: 1,
                });
            }
        }
    }
    let least = SHARE * positions.len() as f64;
    let count = all
        .iter()
        .filter(|body| body.samples as f64 >= least)
        .count();
    (count >= 2 && returns >= RETURNS && farthest_m > APART_M).then_some(())?;
    Some(format!(
        "the path jumps {returns} times back and forth between {count} places, up to {} m apart (first at {}), and moves by about {} m otherwise: these seem to be {count} bodies or runs in one file; read one of them (`only: (column: ..., value: ...)` where a column tells them apart), or export each to a file of its own",
        number(farthest_m),
        seen.at(first?),
        number(usual_m)
    ))
}
