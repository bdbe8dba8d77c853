//! Prediction intervals for places without readings, by conformal prediction.

/// Half width of an interval that contains this share of the readings at a new place. It is a quantile of the absolute errors at
/// left-out places, in which every place has the same weight and the new place counts as worse than all others (hierarchical
/// conformal prediction; Lee, Barber & Willett 2023, "Distribution-free inference with hierarchical data", arXiv 2306.06342,
/// section 3). The interval contains at least that share for any distribution if places are exchangeable. `None` if there are too
/// few places.
pub(super) fn grouped_quantile(errors: &[Vec<f64>], level: f64) -> Option<f64> {
    let groups = errors.iter().filter(|own| !own.is_empty());
    let count = groups.clone().count();
    let mut weighted: Vec<(f64, f64)> = groups
        .flat_map(|own| {
            let weight = 1.0 / ((count + 1) as f64 * own.len() as f64);
            own.iter().map(move |error| (error.abs(), weight))
        })
        .collect();
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    weighted.into_iter().find_map(|(error, weight)| {
        below += weight;
        // The tolerance allows for rounding errors of the sum of weights.
        (below >= level - 1e-9).then_some(error)
    })
}

#[cfg(test)]
mod tests {
    use super::grouped_quantile;

    #[test]
    fn every_place_has_the_same_weight_and_too_few_places_give_no_interval() {
        // Nineteen places with an error of their number, one of them read a thousand times.
        let mut errors: Vec<Vec<f64>> = (1..=19).map(|k| vec![f64::from(k)]).collect();
        errors[0] = vec![1.0; 1000];
        assert_eq!(grouped_quantile(&errors, 0.9), Some(18.0));
        assert_eq!(grouped_quantile(&errors[..9], 0.9), Some(9.0));
        assert_eq!(grouped_quantile(&errors[..8], 0.9), None);
    }
}
