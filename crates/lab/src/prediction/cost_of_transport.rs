//! Cost of transport: energy per distance.

use std::fmt;

use serde::Serialize;

use realgap_core::statistics::mean;

/// The mechanical energy that locomotion costs: the energy that the servos give; energy that they absorb counts as lost. Heat and
/// electronics are not part of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CostOfTransport {
    /// Mean energy that the servos give in a repeat, joules.
    pub servo_j: f64,
    /// All energy over all distance of the repeats, J/m.
    pub joules_per_metre: f64,
    /// The same per weight, dimensionless: mechanical cost of transport.
    pub cost_of_transport: f64,
    /// Largest share of the energy that the balance of a repeat does not explain.
    pub residual_share: f64,
}

impl CostOfTransport {
    /// Of repeats in which servos gave these energies, over these net displacements, by a robot of this weight. `None` where the
    /// cost is undefined: no energy, no displacement, or no weight.
    ///
    /// ```
    /// use realgap_lab::prediction::CostOfTransport;
    ///
    /// // 3 J in all over 1.5 m, by a robot of 5 N.
    /// let economy = CostOfTransport::new(&[1.0, 2.0], &[0.5, 1.0], 5.0, [0.01, 0.004]).unwrap();
    /// assert_eq!((economy.joules_per_metre, economy.cost_of_transport), (2.0, 0.4));
    /// assert_eq!(economy.residual_share, 0.01);
    /// ```
    pub fn new(
        servos_j: &[f64],
        distances_m: &[f64],
        weight_n: f64,
        residual_shares: impl IntoIterator<Item = f64>,
    ) -> Option<Self> {
        let (servo_j, distance_m): (f64, f64) = (servos_j.iter().sum(), distances_m.iter().sum());
        let is_number = servo_j > 0.0 && distance_m > 0.0 && weight_n > 0.0;
        is_number.then(|| Self {
            servo_j: mean(servos_j),
            joules_per_metre: servo_j / distance_m,
            cost_of_transport: servo_j / (distance_m * weight_n),
            residual_share: residual_shares.into_iter().fold(0.0, f64::max),
        })
    }
}

impl fmt::Display for CostOfTransport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.3} J/m, cost of transport {:.2} ({:.3} J a run from the servos; the balance is open by {:.1} % at most)",
            self.joules_per_metre,
            self.cost_of_transport,
            self.servo_j,
            100.0 * self.residual_share
        )
    }
}
