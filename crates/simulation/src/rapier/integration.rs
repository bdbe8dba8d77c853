//! Conversion of an experiment's solver and contact settings into Rapier's integration parameters.

use crate::experiment::{Experiment, FrictionModel};
use rapier3d_f64::prelude::{FrictionModel as EngineFriction, IntegrationParameters};

pub(super) fn parameters(experiment: &Experiment) -> IntegrationParameters {
    let contact = &experiment.contact;
    let mut p = IntegrationParameters {
        dt: experiment.solver.timestep_s,
        num_solver_iterations: experiment.solver.substeps,
        num_internal_pgs_iterations: experiment.solver.sweeps,
        num_internal_stabilization_iterations: experiment.solver.relaxations,
        normalized_prediction_distance: contact.prediction_m,
        // The speed is not limited, so that a diverging robot is detected and not slowed down.
        normalized_max_linear_velocity: f64::MAX,
        friction_model: match contact.friction_model {
            FrictionModel::Simplified => EngineFriction::Simplified,
            FrictionModel::Coulomb | FrictionModel::Relaxed => EngineFriction::Coulomb,
        },
        ..IntegrationParameters::default()
    };
    // The floor has no body, so its contacts use the softness of fixed bodies; contacts between modules are half as stiff, as in
    // Rapier's own defaults.
    p.static_contact_softness.natural_frequency = contact.natural_frequency_hz;
    p.static_contact_softness.damping_ratio = contact.damping_ratio;
    p.contact_softness.natural_frequency = 0.5 * contact.natural_frequency_hz;
    p.contact_softness.damping_ratio = contact.damping_ratio;
    p
}
