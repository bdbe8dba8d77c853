//! The metric `pca-whitened`: Mahalanobis distance in units of the distance between two recordings.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::POINTS;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;

/// Mahalanobis distance with the covariance of the recordings, scaled to 1 for two recordings ([`Spread`](super::Spread)): a centimetre has
/// a large weight in directions in which recordings agree to a millimetre, and a small weight in directions in which they differ.
#[derive(Debug, Clone, Copy)]
pub struct PcaWhitened;

impl Metric for PcaWhitened {
    constant_methods! {
        name: &'static str = "pca-whitened";
        column: &'static str = "pca_whitened_1";
        unit: Unit = Unit::One;
        doc: &'static str = "distance in units of the distance between two recordings, direction by direction";
        needs: Needs = Needs {
            spread: true,
            ..Needs::POINTS
        };
    }

    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement> {
        let Some(spread) = context.spread else {
            return Err(Error::invalid(
                "the metric `pca-whitened` needs the spread of repeated recordings",
            ));
        };
        let distance = spread.distance(pair.real_prepared, pair.simulated_prepared);
        Ok(Measurement::new(distance, POINTS))
    }
}
