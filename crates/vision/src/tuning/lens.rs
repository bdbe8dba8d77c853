//! The settings of a lens with their intervals.
//!
//! The uncertainty is estimated in two ways, of which the larger is used: by a jackknife over views, which includes errors of the
//! scene, and by a parametric bootstrap with simulated pictures (`bias.rs`), which includes errors of the method.

use rayon::prelude::*;

use super::extrinsics::{Extrinsics, Prior, numbers, resect, with};
use super::shot::Shot;
use super::{LEVEL, TunedSetting, known};
use crate::camera::Lens;
use realgap_core::statistics::{jackknife_variance, student_quantile};

/// Search range of the field of view about its start (radians), and search range of the distortion about 0.
const FIELD_RAD: f64 = 0.26;
const DISTORTION: f64 = 0.5;

/// The field of view in degrees, and both coefficients of distortion.
pub(super) fn in_degrees(lens: &Lens) -> [f64; 3] {
    let [field_of_view_rad, first, second] = numbers(lens);
    [field_of_view_rad.to_degrees(), first, second]
}

/// The lens after subtraction of the bias of the method (the first number of each pair in `off`).
pub(super) fn corrected(lens: &Lens, off: &[(f64, f64); 3]) -> Lens {
    let its = in_degrees(lens);
    let [degrees, first, second] = [0, 1, 2].map(|k| its[k] - off[k].0);
    with(lens, [degrees.to_radians(), first, second])
}

/// Half widths of the intervals of the numbers, by a jackknife over views.
fn by_views(lens: &Lens, shots: &[&Shot], extrinsics: &[Extrinsics], prior: &Prior) -> [f64; 3] {
    let mut views: Vec<usize> = shots.iter().map(|shot| shot.view).collect();
    views.dedup();
    let without: Vec<[f64; 3]> = views
        .par_iter()
        .map(|view| {
            let others = shots.iter().zip(extrinsics);
            let others = others.filter(|(shot, _)| shot.view != *view);
            let mut others: Vec<Extrinsics> = others.map(|(_, its)| its.clone()).collect();
            in_degrees(&resect(lens, &mut others, prior))
        })
        .collect();
    let t = student_quantile(0.5 + 0.5 * LEVEL, views.len() as f64 - 1.0);
    [0, 1, 2].map(|k| {
        let own: Vec<f64> = without.iter().map(|its| its[k]).collect();
        t * jackknife_variance(&own).sqrt()
    })
}

/// The settings of field of view and distortion: their values at the start, the estimates after subtraction of the bias, and their
/// intervals.
pub(super) fn lens_settings(
    start: &Lens,
    found: &Lens,
    (shots, extrinsics): (&[&Shot], &[Extrinsics]),
    prior: &Prior,
    off: &[(f64, f64); 3],
) -> Vec<TunedSetting> {
    let views = by_views(found, shots, extrinsics, prior);
    let (first, values) = (in_degrees(start), in_degrees(&corrected(found, off)));
    let field = FIELD_RAD.to_degrees();
    let distortion = (-DISTORTION, DISTORTION);
    let named = [
        (
            "field_of_view_deg",
            "degrees",
            (first[0] - field, first[0] + field),
        ),
        ("distortion.0", "", distortion),
        ("distortion.1", "", distortion),
    ];
    let setting =
        |(k, (name, unit, searched)): (usize, (&'static str, &'static str, (f64, f64)))| {
            let half = views[k].max(off[k].1);
            let (low, high) = (values[k] - half, values[k] + half);
            let share = |value: f64| (value - searched.0) / (searched.1 - searched.0);
            TunedSetting {
                name,
                unit,
                start: first[k],
                value: values[k],
                low: low.max(searched.0),
                high: high.min(searched.1),
                searched,
                known: known(share(low), share(high)),
            }
        };
    named.into_iter().enumerate().map(setting).collect()
}
