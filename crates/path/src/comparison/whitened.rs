//! `pca-whitened`: distance in units of how far reality is from itself.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::POINTS;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;

/// Mahalanobis distance in the covariance of the recordings, 1 for two recordings ([`Spread`](super::Spread)): a centimetre
/// counts for much where reality repeats itself to a millimetre, and for little where it does not.
#[derive(Debug, Clone, Copy)]
pub struct PcaWhitened;

impl Metric for PcaWhitened {
    constant_methods! {
        name: &'static str = "pca-whitened";
        column: &'static str = "pca_whitened_1";
        unit: Unit = Unit::One;
        doc: &'static str = "distance in units of how far two recordings are apart, direction by direction";
        needs: Needs = Needs {
            spread: true,
            ..Needs::POINTS
        };
    }

    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement> {
        let Some(spread) = context.spread else {
            return Err(Error::invalid(
                "the metric `pca-whitened` needs the spread of reality",
            ));
        };
        let distance = spread.distance(pair.real_prepared, pair.simulated_prepared);
        Ok(Measurement::new(distance, POINTS))
    }
}
