//! Fits one polynomial to samples: chooses its degree and its terms and estimates the coefficients.

use nalgebra::{DMatrix, DVector};

use super::option::GraphOptions;
use super::regression::{Powers, Stop, count, estimate, monomial, monomials, order};
use super::sample::Sample;
use crate::graph::model::{Polynomial, Term};
use realgap_core::statistics::mean;

/// Number of folds of the cross-validation. A fold is a contiguous part of the path, because neighbouring samples are nearly equal.
pub(super) const FOLDS: usize = 5;
/// Largest number of terms of a polynomial.
const MOST_TERMS: usize = 15;
/// Smallest number of samples for each term of a polynomial.
pub(super) const SAMPLES_PER_TERM: usize = 3;

/// The regressors (one row for each sample, one column for each term) and the ranges.
fn table(samples: &[Sample], terms: &[Powers]) -> (DMatrix<f64>, DVector<f64>) {
    (
        DMatrix::from_fn(samples.len(), terms.len(), |row, term| {
            monomial(terms[term], samples[row].place)
        }),
        DVector::from_iterator(samples.len(), samples.iter().map(|s| s.range_m)),
    )
}

fn limits(samples: &[Sample]) -> (f64, f64) {
    let of =
        |fold: fn(f64, f64) -> f64, from: f64| samples.iter().map(|s| s.range_m).fold(from, fold);
    (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
}

/// Fits a polynomial to the samples; the constant `instead_m` if there are none.
pub(super) fn polynomial(samples: &[Sample], options: &GraphOptions, instead_m: f64) -> Polynomial {
    let constant = |value: f64| Term {
        powers: [0, 0],
        value,
        error: 0.0,
        ratio: 0.0,
    };
    if samples.is_empty() {
        return Polynomial {
            samples: 0,
            limits_m: (instead_m, instead_m),
            terms: vec![constant(instead_m)],
        };
    }
    let ranges: Vec<f64> = samples.iter().map(|s| s.range_m).collect();
    let (degree, terms) = match options.stop {
        Stop::Validation => validated(samples, options.degree),
        Stop::Terms(terms) => (options.degree, terms),
        _ => (options.degree, MOST_TERMS),
    };
    fitted(samples, degree, terms, options.stop).unwrap_or_else(|| Polynomial {
        samples: samples.len(),
        limits_m: limits(samples),
        terms: vec![constant(mean(&ranges))],
    })
}

/// The polynomial of this degree with at most `most` terms; `None` if none can be fitted.
fn fitted(samples: &[Sample], degree: u32, most: usize, stop: Stop) -> Option<Polynomial> {
    let powers = monomials(degree);
    let (regressors, ranges) = table(samples, &powers);
    let most = most.min((samples.len() / SAMPLES_PER_TERM).max(1));
    let mut chosen = order(&regressors, &ranges, most).ok()?;
    if stop != Stop::Validation {
        chosen.truncate(count(stop, &chosen, &ranges));
    }
    let found = estimate(&regressors, &ranges, &chosen).ok()?;
    let terms = chosen.iter().zip(found.values.iter().zip(&found.errors));
    Some(Polynomial {
        samples: samples.len(),
        limits_m: limits(samples),
        terms: terms
            .map(|(term, (value, error))| Term {
                powers: powers[term.index],
                value: *value,
                error: if error.is_finite() { *error } else { 0.0 },
                ratio: term.ratio,
            })
            .collect(),
    })
}

/// The fold of a sample, from its position along the path (0 to 1).
pub(super) fn fold(way: f64) -> usize {
    ((way * FOLDS as f64) as usize).min(FOLDS - 1)
}

/// Degree and number of terms with the smallest mean absolute error in the cross-validation; of equals, the smaller.
fn validated(samples: &[Sample], most_degree: u32) -> (u32, usize) {
    let mut best = (f64::INFINITY, 0, 1);
    for degree in 0..=most_degree {
        let terms = monomials(degree);
        let mut sums = vec![0.0; terms.len().min(MOST_TERMS)];
        for left_out in 0..FOLDS {
            let (out, kept): (Vec<Sample>, Vec<Sample>) = samples
                .iter()
                .copied()
                .partition(|s| fold(s.way) == left_out);
            if out.is_empty() || kept.is_empty() {
                continue;
            }
            for (index, error) in errors_by_terms(&kept, &out, &terms, sums.len())
                .into_iter()
                .enumerate()
            {
                sums[index] += error;
            }
        }
        for (index, sum) in sums.iter().enumerate() {
            if *sum < best.0 * (1.0 - 1e-9) {
                best = (*sum, degree, index + 1);
            }
        }
    }
    (best.1, best.2)
}

/// Sums of absolute errors on the samples `out` with the first 1, 2, … terms that are chosen and fitted from the samples `kept`.
fn errors_by_terms(kept: &[Sample], out: &[Sample], terms: &[Powers], most: usize) -> Vec<f64> {
    let (regressors, ranges) = table(kept, terms);
    let allowed = most.min((kept.len() / SAMPLES_PER_TERM).max(1));
    let Ok(chosen) = order(&regressors, &ranges, allowed) else {
        return vec![f64::INFINITY; most];
    };
    let (least, largest) = limits(kept);
    (1..=most)
        .map(|count| {
            let first = &chosen[..count.min(chosen.len())];
            let Ok(found) = estimate(&regressors, &ranges, first) else {
                return f64::INFINITY;
            };
            out.iter()
                .map(|sample| {
                    let sum: f64 = first
                        .iter()
                        .zip(&found.values)
                        .map(|(term, value)| value * monomial(terms[term.index], sample.place))
                        .sum();
                    (sum.clamp(least, largest) - sample.range_m).abs()
                })
                .sum()
        })
        .collect()
}
