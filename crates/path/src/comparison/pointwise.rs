//! Metrics that compare points of the same index: `displacement` and `rms`.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

use crate::trajectory::rms_m;

/// Absolute difference of the net displacements, metres: the error of the distance travelled (the fitness of paper 003).
#[derive(Debug, Clone, Copy)]
pub struct Displacement;

impl Metric for Displacement {
    constant_methods! {
        name: &'static str = "displacement";
        column: &'static str = "displacement_error_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "absolute difference of the net displacements";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let real_m = pair.real_prepared.net_displacement_m();
        let simulated_m = pair.simulated_prepared.net_displacement_m();
        Ok(Measurement::new((real_m - simulated_m).abs(), 1))
    }
}

/// Root mean square distance of corresponding prepared points in the x-y plane, metres.
#[derive(Debug, Clone, Copy)]
pub struct Rms;

impl Metric for Rms {
    constant_methods! {
        name: &'static str = "rms";
        column: &'static str = "rms_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "root mean square distance of corresponding points";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (real, simulated) = (pair.real_prepared, pair.simulated_prepared);
        let points = real.xy_m().len();
        Ok(Measurement::new(rms_m(real, simulated), points))
    }
}

/// Squared distance of two points, m².
pub(super) fn squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
