//! Tests that forward regression chooses the same terms as SysIdentPy, and recovers known polynomials.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_distr::StandardNormal;
use realgap_core::random::Numbered;
use realgap_sensing::graph::regression::{
    Stop, count, criterion, estimate, mean_squares, monomial, monomials, order,
};

use super::common;

fn regressors(places: &[[f64; 2]], degree: u32) -> DMatrix<f64> {
    let powers = monomials(degree);
    DMatrix::from_fn(places.len(), powers.len(), |row, term| {
        monomial(powers[term], places[row])
    })
}

#[derive(serde::Deserialize)]
struct Golden {
    places: Vec<[f64; 2]>,
    values: Vec<f64>,
    powers: Vec<[u32; 2]>,
    ratios: Vec<f64>,
    coefficients: Vec<f64>,
    aic: Vec<f64>,
    bic: Vec<f64>,
}

/// The order of terms, ratios, coefficients and criteria agree with those of SysIdentPy (tools/golden_frols.py).
#[test]
fn forward_regression_agrees_with_sysidentpy() {
    let text = common::read(&common::golden(), "frols.json");
    let cases: Vec<Golden> = serde_json::from_str(&text).unwrap();
    assert_eq!(cases.len(), 4);
    let close = |what: &str, found: f64, expected: f64| {
        assert!(
            (found - expected).abs() <= 1e-8 * expected.abs().max(1.0),
            "{what}: {found} {expected}"
        );
    };
    for case in cases {
        let matrix = regressors(&case.places, 4);
        let y = DVector::from_vec(case.values.clone());
        let chosen = order(&matrix, &y, case.powers.len()).unwrap();
        let powers: Vec<[u32; 2]> = chosen.iter().map(|c| monomials(4)[c.index]).collect();
        assert_eq!(powers, case.powers);
        for (found, expected) in chosen.iter().zip(&case.ratios) {
            close("ratio", found.ratio, *expected);
        }
        let found = estimate(&matrix, &y, &chosen).unwrap();
        for (found, expected) in found.values.iter().zip(&case.coefficients) {
            close("coefficient", *found, *expected);
        }
        let squares = mean_squares(&chosen, &y);
        for (stop, expected) in [(Stop::Aic, &case.aic), (Stop::Bic, &case.bic)] {
            for (found, expected) in criterion(stop, &squares, y.len()).iter().zip(expected) {
                close("criterion", *found, *expected);
            }
        }
    }
}

#[test]
fn a_sparse_polynomial_is_recovered_with_its_terms_and_correct_standard_errors() {
    let truth = [([0, 0], 3.0), ([1, 0], 1.2), ([1, 1], -0.8), ([0, 3], 0.6)];
    let (mut right, mut held, mut asked) = (0, 0, 0);
    for seed in 0..100 {
        let mut rng = Numbered::SensorReading.generator(seed, 0);
        let places: Vec<[f64; 2]> = (0..200)
            .map(|_| [0; 2].map(|_| 2.0 * rng.random::<f64>() - 1.0))
            .collect();
        let y = DVector::from_iterator(
            200,
            places.iter().map(|place| {
                let noise: f64 = rng.sample(StandardNormal);
                truth
                    .iter()
                    .map(|(powers, value)| value * monomial(*powers, *place))
                    .sum::<f64>()
                    + 0.2 * noise
            }),
        );
        let matrix = regressors(&places, 4);
        let mut chosen = order(&matrix, &y, 12).unwrap();
        chosen.truncate(count(Stop::Bic, &chosen, &y));
        let found = estimate(&matrix, &y, &chosen).unwrap();
        let mut powers: Vec<[u32; 2]> = chosen.iter().map(|c| monomials(4)[c.index]).collect();
        for (known, value) in truth {
            if let Some(index) = powers.iter().position(|p| *p == known) {
                asked += 1;
                held +=
                    usize::from((found.values[index] - value).abs() <= 1.96 * found.errors[index]);
            }
        }
        powers.sort_unstable();
        let mut known = truth.map(|(powers, _)| powers);
        known.sort_unstable();
        right += usize::from(powers == known);
    }
    // BIC sometimes chooses a needless term, which does not bias the others.
    assert!(right >= 75, "{right} of 100");
    assert!(held as f64 >= 0.9 * asked as f64, "{held} of {asked}");
    // The sum of the ratios of the kept terms reaches the share that was asked for.
    let places: Vec<[f64; 2]> = (0..50)
        .map(|k| [f64::from(k) / 50.0, (f64::from(k) * 0.37).sin()])
        .collect();
    let y = DVector::from_iterator(50, places.iter().map(|p| 1.0 + p[0] * p[1]));
    let chosen = order(&regressors(&places, 4), &y, 10).unwrap();
    let kept = count(Stop::Err(0.99), &chosen, &y);
    let sum = |n: usize| chosen[..n].iter().map(|c| c.ratio).sum::<f64>();
    assert!(sum(kept) >= 0.99 && sum(kept - 1) < 0.99);
    assert_eq!(count(Stop::Terms(3), &chosen, &y), 3);
}

#[test]
fn an_impossible_regression_is_refused() {
    let places = [[0.0, 0.0], [0.5, 0.1], [1.0, -0.2]];
    let y = DVector::from_vec(vec![1.0, 2.0, 3.0]);
    let of = |most: usize, y: &DVector<f64>| {
        order(&regressors(&places, 4), y, most).map_err(|e| e.to_string())
    };
    assert!(of(4, &y).unwrap_err().contains("more terms than samples"));
    assert!(
        of(2, &DVector::zeros(3))
            .unwrap_err()
            .contains("no terms can be chosen")
    );
    assert!(
        of(2, &DVector::from_vec(vec![1.0, f64::NAN, 1.0]))
            .unwrap_err()
            .contains("finite")
    );
    // If all samples are at the same position, only one term is independent.
    let same = [[0.3, 0.3]; 8];
    let chosen = order(&regressors(&same, 2), &DVector::from_element(8, 2.0), 6).unwrap();
    assert_eq!(chosen.len(), 1);
}
