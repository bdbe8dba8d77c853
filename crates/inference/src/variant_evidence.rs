//! How probable two variants of a black box are, by how well each explains the observations at its own best point.

use realgap_core::statistics::{mean, standard_deviation};

use crate::implausibility::as_normal;

/// Least standard deviation of the logarithm of scores. The settings of one point have much in common that reality need not share, and
/// the best point of a variant may lie beside those that were evaluated, so that their scatter understates how far a score may move.
const LEAST_SD: f64 = 0.3;

/// The probability of each of two variants, which are equally probable beforehand. `scores` are those of runs at the variant's own
/// best point, one a setting.
///
/// If reality is like a variant, it has a setting of its own, and moves the mean of these scores by as much as the setting of a run
/// moves the score of the run, because a distance does not show which of its ends has moved. So the logarithm of the ratio of the two
/// means has, for a variant that explains the observations as well as the other, the variance of single runs and of both means. The
/// probability of a variant falls like exp(−z²/2) with that ratio in standard deviations, z (the profile likelihood of a mixture of
/// two hypotheses, each at its best point; Hoeting et al. 1999).
pub fn variant_probabilities(scores: [&[f64]; 2]) -> [f64; 2] {
    if scores.iter().any(|own| own.is_empty()) {
        return scores.map(|own| if own.is_empty() { 0.0 } else { 1.0 });
    }
    // A score of 0 has no logarithm.
    let least = f64::MIN_POSITIVE.sqrt();
    let logs = scores.map(|own| {
        own.iter()
            .map(|s| libm::log(s.max(least)))
            .collect::<Vec<_>>()
    });
    let freedom = logs.each_ref().map(|own| own.len() as f64 - 1.0);
    let squares = [0, 1].map(|v| freedom[v] * standard_deviation(&logs[v]).powi(2));
    let all_freedom = freedom[0] + freedom[1];
    let of_run = match all_freedom > 0.0 {
        true => (squares[0] + squares[1]) / all_freedom,
        false => 0.0,
    };
    let of_means = logs.each_ref().map(|own| 1.0 / own.len() as f64);
    let variance = of_run.max(LEAST_SD * LEAST_SD) * (1.0 + of_means[0] + of_means[1]);
    let means = scores.map(|own| libm::log(mean(own).max(least)));
    let better = means[0].min(means[1]);
    let likely = means.map(|mean| {
        let z = as_normal((mean - better) / variance.sqrt(), all_freedom.max(1.0));
        libm::exp(-0.5 * z * z)
    });
    likely.map(|likely_one| likely_one / (likely[0] + likely[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_that_explain_as_well_are_as_probable_and_one_that_cannot_is_not() {
        let good = [1.0, 1.2, 0.9, 1.1, 1.0, 0.8];
        let [first, second] = variant_probabilities([&good, &good]);
        assert_eq!((first, second), (0.5, 0.5));
        let bad = good.map(|score| 3.0 * score);
        let [first, second] = variant_probabilities([&good, &bad]);
        assert!(first > 0.95, "{first} {second}");
        // Where settings move scores by as much as the variants differ, nothing is rejected.
        let loose = [0.4, 2.0, 0.7, 1.5, 1.0, 0.5];
        let looser = loose.map(|score| 1.5 * score);
        let [first, second] = variant_probabilities([&loose, &looser]);
        assert!(second > 0.2 && first > second, "{first} {second}");
        // The order does not matter, and a variant that never finished explains nothing.
        let [second_first, _] = variant_probabilities([&looser, &loose]);
        assert_eq!(second_first, second);
        assert_eq!(variant_probabilities([&good, &[]]), [1.0, 0.0]);
    }
}
