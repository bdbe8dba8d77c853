//! Expected improvement: by how much a value with a normal distribution is expected to fall below the best one so far.

use std::f64::consts::{PI, SQRT_2};

/// Logarithm of the mean amount by which a normal number falls below `best` (Jones, Schonlau & Welch 1998); the logarithm
/// still tells candidates apart where the amount itself is too small for a number (Ament et al. 2023).
pub(super) fn log_expected_improvement(mean: f64, sd: f64, best: f64) -> f64 {
    if sd <= 0.0 {
        return libm::log((best - mean).max(0.0));
    }
    let z = (best - mean) / sd;
    let log_density = -0.5 * z * z - 0.5 * libm::log(2.0 * PI);
    libm::log(sd)
        + if z > -20.0 {
            libm::log(libm::exp(log_density) + 0.5 * z * libm::erfc(-z / SQRT_2))
        } else {
            let w = 1.0 / (z * z);
            log_density + libm::log(w * (1.0 - w * (3.0 - w * (15.0 - w * 105.0))))
        }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Deserialize)]
    struct Query {
        mean: f64,
        sd: f64,
        best: f64,
        log_improvement: f64,
    }

    #[derive(Deserialize)]
    struct Case {
        queries: Vec<Query>,
    }

    #[test]
    fn expected_improvement_is_that_of_high_precision_arithmetic_even_where_it_is_no_number() {
        let cases = include_str!("../../tests/golden/gaussian_process.json");
        let cases: Vec<Case> = serde_json::from_str(cases).unwrap();
        for query in cases.iter().flat_map(|case| &case.queries) {
            let found = log_expected_improvement(query.mean, query.sd, query.best);
            assert!(
                (found - query.log_improvement).abs() < 1e-9 * query.log_improvement.abs(),
                "{found} is not {}",
                query.log_improvement
            );
        }
        assert_eq!(log_expected_improvement(1.0, 0.0, 2.0), 0.0);
        assert_eq!(log_expected_improvement(2.0, 0.0, 1.0), f64::NEG_INFINITY);
    }
}
