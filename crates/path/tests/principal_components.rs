//! The principal components of a sweep are those of an independent library: linfa-reduction.

use linfa::DatasetBase;
use linfa::traits::{Fit, Predict};
use linfa_reduction::Pca;
use nalgebra::Vector3;
use ndarray::Array2;
use realgap_path::comparison::{Basis, Components};
use realgap_path::trajectory::{POINTS, Prepared, Trajectory, prepare};

/// Paths as a sweep over two parameters makes them: a distance travelled, a bend, and eight gaits of falling size, each of which
/// depends on both parameters in its own way.
fn sweep(rows: usize) -> Vec<Prepared> {
    let path = |row: usize| {
        let (friction, restitution) = ((row % 28) as f64 / 28.0, (row / 28) as f64 / 22.0);
        let positions = (0..POINTS).map(|index| {
            let t = index as f64 / (POINTS - 1) as f64;
            let sway = (1..=8).map(|mode| {
                let k = f64::from(mode);
                let size =
                    0.08 * 0.75_f64.powi(mode) * (k * friction + 1.7 * k * k * restitution).cos();
                size * (k * std::f64::consts::PI * t).sin()
            });
            let forward_m = (0.4 + 0.5 * friction * restitution) * t;
            let bend_m = 0.2 * (friction - 0.5) * t * t;
            Vector3::new(
                forward_m,
                bend_m + sway.sum::<f64>() + tremble_m(row, index),
                0.0,
            )
        });
        let times_s = (0..POINTS).map(|index| 0.05 * index as f64).collect();
        prepare(&Trajectory::new(times_s, positions.collect()).unwrap()).unwrap()
    };
    (0..rows).map(path).collect()
}

/// A tremble of up to 2 mm, different in every row and at every point, so that the table has full rank as one of real paths has.
fn tremble_m(row: usize, index: usize) -> f64 {
    let phase = 12.9898 * row as f64 + 78.233 * index as f64;
    let chaotic = 43_758.545_3 * phase.sin();
    0.004 * (chaotic - chaotic.floor() - 0.5)
}

/// By how much linfa's distances between the first path and all others differ from ours, with so many components, relative to the
/// largest distance.
fn difference(paths: &[Prepared], components: usize) -> f64 {
    let all: Vec<&Prepared> = paths.iter().collect();
    let basis = Basis::fit(&all, Components::Count(components)).unwrap();
    let rows = paths.iter().flat_map(|path| {
        let xy_m = path.xy_m();
        let x = xy_m.iter().map(|point| point[0]);
        x.chain(xy_m.iter().map(|point| point[1]))
            .collect::<Vec<_>>()
    });
    let table = Array2::from_shape_vec((paths.len(), 2 * POINTS), rows.collect()).unwrap();
    let dataset = DatasetBase::from(table);
    let coefficients = Pca::params(components)
        .fit(&dataset)
        .unwrap()
        .predict(dataset.records());
    let distances = (1..paths.len()).map(|other| {
        let apart = &coefficients.row(0) - &coefficients.row(other);
        let linfa_m = (apart.mapv(|value| value * value).sum() / POINTS as f64).sqrt();
        let ours_m = basis.discrepancy_m(&paths[0], &paths[other]);
        ((linfa_m - ours_m).abs(), ours_m)
    });
    let (worst_m, largest_m) = distances
        .fold((0.0_f64, 0.0_f64), |(worst, largest), (error, size)| {
            (worst.max(error), largest.max(size))
        });
    assert!(
        largest_m > 0.01,
        "the paths of the test hardly differ: {largest_m} m"
    );
    worst_m / largest_m
}

#[test]
fn on_a_table_of_the_size_of_a_sweep_the_discrepancies_are_those_of_linfa() {
    let paths = sweep(616);
    for components in 1..=8 {
        let difference = difference(&paths, components);
        println!("{components} components: {difference:.1e}");
        assert!(difference < 1e-9, "{components} components: {difference:e}");
    }
}

/// linfa truncates the decomposition by an iteration (LOBPCG) that does not converge on a table of few rows. This is why the program
/// does not take its components from linfa, and why linfa is a witness on large tables only.
#[test]
fn on_ten_rows_linfa_is_a_witness_for_the_first_components_only() {
    let paths = sweep(616)
        .into_iter()
        .step_by(61)
        .take(10)
        .collect::<Vec<_>>();
    let differences = [1, 2, 3, 4, 5, 6, 7, 8].map(|components| difference(&paths, components));
    println!("{differences:?}");
    assert!(differences[0] < 1e-9, "{differences:?}");
    assert!(
        differences.iter().all(|difference| *difference < 0.05),
        "{differences:?}"
    );
}
