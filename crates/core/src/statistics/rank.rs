//! Ranks of a sample with ties, and the check of a sample's values.

use crate::error::{Error, Result};

/// The rank of each value from 1, the mean rank for ties, and Σ (t³ − t) over groups of t equal values.
pub(super) fn ranks(values: &[f64]) -> (Vec<f64>, f64) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut tie_term = 0.0;
    let mut before = 0;
    for group in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let t = group.len() as f64;
        for &index in group {
            ranks[index] = before as f64 + 0.5 * (t + 1.0);
        }
        tie_term += t * t * t - t;
        before += group.len();
    }
    (ranks, tie_term)
}

/// Refuses samples with too few values, or with values that are not finite.
pub(super) fn check_sample(name: &str, values: &[f64], least: usize) -> Result<()> {
    if values.len() < least {
        return Err(Error::invalid("the sample is too small")
            .field(name)
            .found(values.len())
            .allowed(format!("{least} or more values")));
    }
    match values.iter().find(|v| !v.is_finite()) {
        Some(value) => Err(
            Error::invalid("the sample has a value that is no finite number")
                .field(name)
                .found(value)
                .allowed("finite numbers"),
        ),
        None => Ok(()),
    }
}
