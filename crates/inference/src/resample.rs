//! Systematic resampling: draws with equal weights from points with different ones (Kitagawa 1996).

/// Indices of `count` draws, increasing: one random share, `first` (0 to 1), and then equal steps through the cumulated weights. Never
/// empty, also where the weights are no numbers.
pub(crate) fn systematic(weights: &[f64], count: usize, first: f64) -> Vec<usize> {
    let total: f64 = weights.iter().sum();
    let (mut drawn, mut sum) = (Vec::with_capacity(count), 0.0);
    for (index, weight) in weights.iter().enumerate() {
        sum += weight / total * count as f64;
        while (drawn.len() as f64 + first) < sum {
            drawn.push(index);
        }
    }
    if drawn.is_empty() {
        drawn.push(0);
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_drawn_as_often_as_its_weight_says() {
        let drawn = systematic(&[1.0, 0.0, 3.0], 8, 0.5);
        assert_eq!(drawn, [0, 0, 2, 2, 2, 2, 2, 2]);
        assert_eq!(systematic(&[f64::NAN, 1.0], 8, 0.5), [0]);
    }
}
