//! Two implementations vouch for each other: the principal components of `comparison` and those of
//! linfa-reduction, where that one is exact (its first components; docs/design.md says how it is with more).
#![allow(clippy::unwrap_used)] // a test may fail loudly

use linfa::traits::Fit;
use linfa_reduction::Pca;
use ndarray::Array2;
use realgap_core::unit::LengthUnit;
use realgap_path::comparison::{Basis, Components};
use realgap_path::trajectory::{POINTS, Prepared, prepare, read};

const CURVES: [&str; 9] = [
    "real",
    "scaled",
    "turned",
    "warped",
    "smooth",
    "coarse",
    "far",
    "fewer_than_182",
    "spin",
];

fn prepared() -> Vec<Prepared> {
    let folder = crate::common::golden().join("curves");
    let curve = |name| read(folder.join(format!("{name}.csv")), LengthUnit::Metre).unwrap();
    CURVES
        .map(|name| prepare(&curve(name).trajectory).unwrap())
        .to_vec()
}

/// One row a curve: x1..xN, y1..yN.
fn table(curves: &[Prepared]) -> Array2<f64> {
    Array2::from_shape_fn((curves.len(), 2 * POINTS), |(row, column)| {
        curves[row].xy_m()[column % POINTS][column / POINTS]
    })
}

#[test]
fn the_leading_components_are_those_of_linfa() {
    let curves = prepared();
    let all: Vec<&Prepared> = curves.iter().collect();
    let table = table(&curves);
    let spread: f64 = {
        let centred = &table - &table.mean_axis(ndarray::Axis(0)).unwrap();
        centred.iter().map(|value| value * value).sum()
    };
    for count in 1..=3 {
        let basis = Basis::fit(&all, Components::Count(count)).unwrap();
        let theirs = Pca::params(count)
            .fit(&linfa::DatasetBase::from(table.clone()))
            .unwrap();
        for component in 0..count {
            // A singular value squared is what the component explains of the total.
            let ratio = theirs.singular_values()[component].powi(2) / spread;
            let ours = basis.explained_variance_ratio()[component];
            assert!(
                (ratio / ours - 1.0).abs() < 1e-9,
                "{count} components, number {component}: {ratio} and {ours}"
            );
        }
        // Signs of components mean nothing; distances do not depend on them.
        let centred = &table - theirs.mean();
        let coefficients = centred.dot(&theirs.components().t());
        for (a, first) in curves.iter().enumerate() {
            for (b, second) in curves.iter().enumerate() {
                let difference = &coefficients.row(a) - &coefficients.row(b);
                let theirs_m = (difference.dot(&difference) / POINTS as f64).sqrt();
                let ours_m = basis.discrepancy_m(first, second);
                assert!(
                    (theirs_m - ours_m).abs() < 1e-9 * ours_m.max(1e-3),
                    "{count} components, {} and {}: {theirs_m} and {ours_m}",
                    CURVES[a],
                    CURVES[b]
                );
            }
        }
    }
}
