//! Probability distributions of the errors that a repeat draws.

use rand_distr::{Distribution as _, StandardNormal};
use serde::{Deserialize, Serialize};

use realgap_core::error::{Error, Result};
use realgap_core::random::Generator;

/// Distribution of an error. Each is a monotonic function of a standard normal number. So every field draws one random number,
/// independent of its distribution, and the same seed gives the same quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Distribution {
    /// Normal with mean 0 and this standard deviation.
    Normal(f64),
    /// Uniform between two values.
    Uniform(f64, f64),
    /// |Normal(sd)|: never negative, with the highest density at 0.
    HalfNormal(f64),
    /// A factor exp(Normal(sd)): median 1, never negative. Only for relative fields.
    LogNormal(f64),
}

/// Draws one standard normal number from a stream.
pub(super) fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}

/// The use of a drawn value, which determines the allowed distributions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// Added to a value of any sign.
    Offset,
    /// Added to a value that may not become negative.
    Delay,
    /// A factor 1 + draw.
    Factor,
}

/// Smallest factor: a relative draw below it is raised to it. For usual fields this is about ten standard deviations away.
const LEAST_FACTOR: f64 = 0.01;
/// Largest standard deviation of a normal relative error; a wider one would often be cut off at the smallest factor.
const WIDEST_NORMAL_FACTOR: f64 = 0.3;
/// Largest standard deviation of a log-normal factor; a larger one is probably a typing error, because it means a factor of e² in
/// each direction within one standard deviation.
const WIDEST_LOG_NORMAL: f64 = 2.0;

impl Default for Distribution {
    /// Always 0 (a factor: always 1).
    fn default() -> Self {
        Self::Normal(0.0)
    }
}

impl Distribution {
    /// Whether every draw is 0 (a factor: 1).
    pub fn is_zero(&self) -> bool {
        match *self {
            Self::Normal(sd) | Self::HalfNormal(sd) | Self::LogNormal(sd) => sd == 0.0,
            Self::Uniform(low, high) => low == 0.0 && high == 0.0,
        }
    }

    /// Root mean square of the draws: the size of the error, whatever its sign.
    pub fn size(&self) -> f64 {
        match *self {
            Self::Normal(sd) | Self::HalfNormal(sd) => sd,
            // E(exp(sd z) − 1)² for a standard normal z.
            Self::LogNormal(sd) => {
                let square = libm::expm1(2.0 * sd * sd) - 2.0 * libm::expm1(0.5 * sd * sd);
                square.max(0.0).sqrt()
            }
            Self::Uniform(low, high) => ((low * low + low * high + high * high) / 3.0)
                .max(0.0)
                .sqrt(),
        }
    }

    /// The same distribution with its spread divided by a number.
    pub(super) fn divided_by(&self, divisor: f64) -> Self {
        match *self {
            Self::Normal(sd) => Self::Normal(sd / divisor),
            Self::Uniform(low, high) => Self::Uniform(low / divisor, high / divisor),
            Self::HalfNormal(sd) => Self::HalfNormal(sd / divisor),
            Self::LogNormal(sd) => Self::LogNormal(sd / divisor),
        }
    }

    /// The draw that corresponds to a standard normal number.
    pub(super) fn draw(&self, normal: f64) -> f64 {
        match *self {
            Self::Normal(sd) => sd * normal,
            Self::Uniform(low, high) => {
                let share = 0.5 * libm::erfc(-normal * std::f64::consts::FRAC_1_SQRT_2);
                low + (high - low) * share
            }
            Self::HalfNormal(sd) => sd * normal.abs(),
            Self::LogNormal(sd) => libm::expm1(sd * normal),
        }
    }

    /// The factor that corresponds to a standard normal number; positive and finite.
    pub(super) fn factor(&self, normal: f64) -> f64 {
        match *self {
            Self::LogNormal(sd) => libm::exp(sd * normal),
            _ => (1.0 + self.draw(normal)).max(LEAST_FACTOR),
        }
    }

    /// Checks the numbers, and that the distribution suits its use.
    pub(super) fn check(&self, field: &str, purpose: Use) -> Result<()> {
        let wrong = |message: &str, allowed: &str| {
            Err(Error::invalid(message)
                .field(field)
                .found(self)
                .allowed(allowed))
        };
        match *self {
            Self::Normal(sd) | Self::HalfNormal(sd) | Self::LogNormal(sd)
                if !(sd.is_finite() && sd >= 0.0) =>
            {
                wrong(
                    "a standard deviation must be finite and not negative",
                    "0 or more",
                )
            }
            Self::Uniform(low, high) if !(low.is_finite() && high.is_finite()) => {
                wrong("the ends must be finite", "two finite numbers")
            }
            Self::Uniform(low, high) if low > high => wrong(
                "the low end is above the high one",
                "Uniform(low, high) with low <= high",
            ),
            Self::LogNormal(_) if purpose != Use::Factor => wrong(
                "a log-normal is a distribution of factors",
                "Normal(sd), HalfNormal(sd) or Uniform(low, high)",
            ),
            Self::LogNormal(sd) if sd > WIDEST_LOG_NORMAL => {
                wrong("too wide for an error", "LogNormal(sd) with sd <= 2")
            }
            Self::Normal(sd) | Self::HalfNormal(sd)
                if purpose == Use::Factor && sd > WIDEST_NORMAL_FACTOR =>
            {
                wrong(
                    "a normal relative error this wide would make factors negative",
                    "up to 0.3; LogNormal(sd) for wider ones",
                )
            }
            Self::Uniform(low, _) if purpose == Use::Factor && low <= -1.0 => wrong(
                "a factor 1 + draw must be positive",
                "Uniform(low, high) with low > -1",
            ),
            Self::Normal(sd) if purpose == Use::Delay && sd > 0.0 => wrong(
                "a delay cannot be negative",
                "HalfNormal(sd) or Uniform(low, high) with low >= 0",
            ),
            Self::Uniform(low, _) if purpose == Use::Delay && low < 0.0 => wrong(
                "a delay cannot be negative",
                "HalfNormal(sd) or Uniform(low, high) with low >= 0",
            ),
            _ => Ok(()),
        }
    }
}

impl std::fmt::Display for Distribution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::Normal(sd) => write!(f, "Normal({sd})"),
            Self::Uniform(low, high) => write!(f, "Uniform({low}, {high})"),
            Self::HalfNormal(sd) => write!(f, "HalfNormal({sd})"),
            Self::LogNormal(sd) => write!(f, "LogNormal({sd})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_normal_number_become_quantiles_of_the_distribution() {
        let third = 0.430_727_299_295_457_5; // scipy.stats.norm.ppf(2/3)
        let uniform = Distribution::Uniform(1.0, 4.0);
        assert!((uniform.draw(third) - 3.0).abs() < 1e-12);
        assert!((uniform.draw(-third) - 2.0).abs() < 1e-12);
        assert_eq!(uniform.draw(-50.0), 1.0);
        assert_eq!(Distribution::Normal(2.0).draw(-1.5), -3.0);
        assert_eq!(Distribution::HalfNormal(2.0).draw(-1.5), 3.0);
        assert!((Distribution::LogNormal(0.5).factor(2.0) - std::f64::consts::E).abs() < 1e-15);
    }

    #[test]
    fn the_size_of_a_distribution_is_the_root_mean_square_of_its_draws() {
        // Quantiles of the standard normal at the middles of 2000 equal shares.
        let normals: Vec<f64> = (0..2000)
            .map(|k| realgap_core::statistics::normal_quantile((f64::from(k) + 0.5) / 2000.0))
            .collect();
        for distribution in [
            Distribution::Normal(0.3),
            Distribution::HalfNormal(0.3),
            Distribution::LogNormal(0.3),
            Distribution::Uniform(-1.0, 4.0),
        ] {
            let squares = normals.iter().map(|z| distribution.draw(*z).powi(2));
            let size = (squares.sum::<f64>() / normals.len() as f64).sqrt();
            let error = (distribution.size() / size - 1.0).abs();
            assert!(error < 5e-3, "{distribution}: {size}");
        }
    }

    #[test]
    fn factors_stay_positive_and_finite_for_extreme_draws() {
        for distribution in [
            Distribution::Normal(WIDEST_NORMAL_FACTOR),
            Distribution::Uniform(-0.999_999, 5.0),
            Distribution::LogNormal(WIDEST_LOG_NORMAL),
        ] {
            distribution.check("mass_relative", Use::Factor).unwrap();
            for normal in [-9.0, -4.0, 0.0, 4.0, 9.0] {
                let factor = distribution.factor(normal);
                assert!(
                    factor > 0.0 && factor.is_finite(),
                    "{distribution} {normal}"
                );
            }
        }
    }
}
