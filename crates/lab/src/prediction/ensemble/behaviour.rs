//! Behaviours: clusters of repeats with similar paths.

use kodama::{Method, linkage};
use serde::{Deserialize, Serialize};

use super::{Ensemble, Motion};
use realgap_core::statistics::{Proportion, least_by, mean_of_any, median};
use realgap_path::trajectory::{Prepared, rms_m};

/// Most behaviours: a longer list would not describe the ensemble any more.
pub const BEHAVIOURS: usize = 5;
/// Confidence level of the probabilities' intervals.
const LEVEL: f64 = 0.95;
/// Two clusters of paths are two behaviours where their distance is larger than this share of the body length and than
/// [`CUT_DISPLACEMENTS`] of the displacement.
const CUT_BODY_LENGTHS: f64 = 0.5;
/// The same as a share of the median path's net displacement.
const CUT_DISPLACEMENTS: f64 = 0.25;
/// A robot that moves less than this share of its body length may turn in place.
const IN_PLACE_BODY_LENGTHS: f64 = 0.5;
/// So may a robot whose displacement is less than this share of the length of its path.
const IN_PLACE_PATHS: f64 = 0.1;
/// It does where its heading changes by at least this much, radians.
const IN_PLACE_TURN_RAD: f64 = std::f64::consts::FRAC_PI_4;

realgap_core::labelled_enum! {
    /// Kind of a behaviour.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "snake_case")]
    Kind.label;
    /// The behaviour of the simulation without noise.
    AsPredicted "as predicted";
    /// Goes nowhere while its heading changes.
    TurnsInPlace "turns in place";
    /// Anything else.
    OtherPath "other path";
}

/// A cluster of repeats with similar paths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Behaviour {
    /// Name, numbered where several are of one kind.
    pub name: String,
    /// Kind of the behaviour.
    pub kind: Kind,
    /// Share of all repeats (diverged ones included) with its 95 % Wilson interval.
    pub probability: Proportion,
    /// Number of the repeat in the middle of the cluster (least mean distance to the others); `None` for the behaviour without
    /// noise where no repeat shows it.
    pub representative: Option<u64>,
    /// Numbers of its repeats.
    pub repeats: Vec<u64>,
    /// Mean net displacement, metres.
    pub mean_displacement_m: f64,
    /// The path of the representative, prepared frame, metres.
    pub path_xy_m: Vec<[f64; 2]>,
}

/// The behaviours of an ensemble: the one without noise first, then the others by decreasing probability.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Behaviours {
    /// Distance above which two clusters are two behaviours, metres.
    pub cut_m: f64,
    /// The behaviours.
    pub list: Vec<Behaviour>,
}

/// RMS distance between two groups of paths (mean over pairs) above which they are two behaviours, metres: half
/// a body length, or a quarter of the median net displacement where that is more.
pub fn cut_m(body_length_m: f64, displacements_m: &[f64]) -> f64 {
    let far_m = if displacements_m.is_empty() {
        0.0
    } else {
        median(displacements_m)
    };
    (CUT_BODY_LENGTHS * body_length_m).max(CUT_DISPLACEMENTS * far_m)
}

/// Finds the behaviours: average-linkage clusters of the RMS distances between prepared paths, cut at [`cut_m`],
/// or higher where that would give more than [`BEHAVIOURS`].
///
/// The run without noise takes part in the clustering but is not counted: the group it falls into is "as
/// predicted".
pub fn behaviours(ensemble: &Ensemble) -> Behaviours {
    let repeats = ensemble.motions().map(|(repeat, m)| (repeat.number, m));
    let repeats: Vec<(u64, &Motion)> = repeats.collect();
    let noise_free = ensemble.noise_free.get();
    let motions: Vec<&Motion> = repeats.iter().map(|(_, m)| *m).chain(noise_free).collect();
    let displacements_m = repeats.iter().map(|(_, m)| m.net_displacement_m());
    let displacements_m: Vec<f64> = displacements_m.collect();
    let paths: Vec<&Prepared> = motions.iter().map(|m| &m.path).collect();
    let wanted_m = cut_m(ensemble.body_length_m, &displacements_m);
    let (groups, cut_m) = groups(&paths, wanted_m);
    let mut list: Vec<Behaviour> = groups
        .into_iter()
        .map(|group| {
            let is_prediction = group.last().is_some_and(|&last| last >= repeats.len());
            let members = group.iter().copied().filter(|&i| i < repeats.len());
            let members: Vec<usize> = members.collect();
            let medoid = medoid(&paths, &members);
            let shown = motions[medoid.unwrap_or(group[0])];
            let kind = if is_prediction {
                Kind::AsPredicted
            } else if turns_in_place(shown, ensemble.body_length_m) {
                Kind::TurnsInPlace
            } else {
                Kind::OtherPath
            };
            let far_m: f64 = members.iter().map(|&i| displacements_m[i]).sum();
            Behaviour {
                name: kind.label().to_owned(),
                kind,
                probability: Proportion::new(members.len(), ensemble.repeats.len(), LEVEL),
                representative: medoid.map(|i| repeats[i].0),
                repeats: members.iter().map(|&i| repeats[i].0).collect(),
                mean_displacement_m: if members.is_empty() {
                    shown.net_displacement_m()
                } else {
                    far_m / members.len() as f64
                },
                path_xy_m: shown.path.xy_m().to_vec(),
            }
        })
        .collect();
    // Stable: groups of equal size keep the order of their first repeats.
    list.sort_by_key(|b| {
        (
            b.kind != Kind::AsPredicted,
            std::cmp::Reverse(b.repeats.len()),
        )
    });
    number(&mut list);
    Behaviours { cut_m, list }
}

impl Behaviours {
    /// The behaviour whose repeats are nearest on average, and their mean distance, metres. `repeats` gives the number of every
    /// repeat and its distance.
    pub(in crate::prediction) fn nearest(
        &self,
        distances_m: &[(u64, f64)],
    ) -> Option<(f64, usize)> {
        let all = self.list.iter().enumerate();
        all.filter_map(|(index, behaviour)| {
            let members = distances_m.iter();
            let of = members.filter(|(number, _)| behaviour.repeats.contains(number));
            Some((mean_of_any(of.map(|(_, distance_m)| *distance_m))?, index))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Index of the behaviour of a repeat.
    pub fn of_repeat(&self, number: u64) -> Option<usize> {
        self.list.iter().position(|b| b.repeats.contains(&number))
    }
}

/// Whether a motion goes nowhere while the heading changes.
fn turns_in_place(motion: &Motion, body_length_m: f64) -> bool {
    let far_m = motion.net_displacement_m();
    let nowhere = far_m < IN_PLACE_BODY_LENGTHS * body_length_m
        || far_m < IN_PLACE_PATHS * motion.path.path_length_m();
    nowhere && motion.turned_rad.abs() >= IN_PLACE_TURN_RAD
}

fn number(list: &mut [Behaviour]) {
    for kind in [Kind::TurnsInPlace, Kind::OtherPath] {
        if list.iter().filter(|b| b.kind == kind).count() > 1 {
            for (index, behaviour) in list.iter_mut().filter(|b| b.kind == kind).enumerate() {
                behaviour.name = format!("{} {}", kind.label(), index + 1);
            }
        }
    }
}

/// The member with the least mean distance to the others; the first of equals.
fn medoid(paths: &[&Prepared], members: &[usize]) -> Option<usize> {
    let total = |&i: &usize| -> f64 { members.iter().map(|&j| rms_m(paths[i], paths[j])).sum() };
    least_by(members.iter().copied(), total)
}

/// Groups of indices, each in increasing order, and the distance at which they were cut.
fn groups(paths: &[&Prepared], cut_m: f64) -> (Vec<Vec<usize>>, f64) {
    let n = paths.len();
    let mut condensed = Vec::with_capacity(n * n.saturating_sub(1) / 2);
    for i in 0..n {
        for j in i + 1..n {
            condensed.push(rms_m(paths[i], paths[j]));
        }
    }
    let mut groups: Vec<Option<Vec<usize>>> = (0..n).map(|i| Some(vec![i])).collect();
    let mut left = n;
    let mut reached_m = cut_m;
    if n > 1 {
        // Steps come in order of distance, and a step may merge what an earlier one made.
        for step in linkage(&mut condensed, n, Method::Average).steps() {
            if step.dissimilarity > cut_m && left <= BEHAVIOURS {
                break;
            }
            reached_m = reached_m.max(step.dissimilarity);
            let mut merged = groups[step.cluster1].take().unwrap_or_default();
            merged.extend(groups[step.cluster2].take().unwrap_or_default());
            merged.sort_unstable();
            groups.push(Some(merged));
            left -= 1;
        }
    }
    let mut groups: Vec<Vec<usize>> = groups.into_iter().flatten().collect();
    groups.sort();
    (groups, reached_m)
}
