//! Mean, spread and quantiles of a sample.

/// Arithmetic mean; NaN for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The [`mean`] of the values of an iterator.
pub fn mean_of(values: impl IntoIterator<Item = f64>) -> f64 {
    mean(&values.into_iter().collect::<Vec<f64>>())
}

/// As [`mean_of`]; `None` for no values.
pub fn mean_of_any(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().collect();
    (!values.is_empty()).then(|| mean(&values))
}

/// The smallest and the largest of some numbers; (∞, −∞) for no numbers.
pub fn ends_of(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let ends = values.into_iter();
    ends.fold(none, |(low, high), v| (low.min(v), high.max(v)))
}

/// The item with the smallest value of `of`, the first of several with this value; `None` for no items.
pub fn least_by<T>(all: impl IntoIterator<Item = T>, of: impl Fn(&T) -> f64) -> Option<T> {
    let all = all.into_iter().map(|one| (of(&one), one));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, one)| one)
}

/// Sample standard deviation (n − 1); 0 for fewer than two values.
pub fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let mean = mean(values);
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
}

/// Median: the mean of the middle two where their number is even; NaN for no values.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Quantile at `level` in 0 to 1, linear between order statistics (numpy's default, type 7 of Hyndman & Fan 1996);
/// NaN for no values. The values need no order.
///
/// ```
/// assert_eq!(realgap_core::statistics::quantile(&[4.0, 1.0, 2.0, 3.0], 0.25), 1.75);
/// ```
pub fn quantile(values: &[f64], level: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = level.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64)
}
