//! The default metric `pca`: distance of the coefficients of principal components.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::POINTS;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;

/// ‖c_real − c_sim‖₂ / √N, metres, where c are the coefficients in [`Context::basis`] (paper 003, section 2.2, step 4).
#[derive(Debug, Clone, Copy)]
pub struct Pca;

impl Metric for Pca {
    constant_methods! {
        name: &'static str = "pca";
        column: &'static str = "pca_coefficients_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "distance of the principal component coefficients of all trajectories compared";
        needs: Needs = Needs {
            basis: true,
            ..Needs::POINTS
        };
    }

    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement> {
        let Some(basis) = context.basis else {
            return Err(Error::invalid("the metric `pca` needs a basis"));
        };
        let (a, b) = (pair.real_prepared, pair.simulated_prepared);
        let mut measurement = Measurement::new(basis.discrepancy_m(a, b), POINTS);
        measurement
            .warnings
            .extend(basis.out_of_basis_warning(a, b));
        Ok(measurement)
    }
}
