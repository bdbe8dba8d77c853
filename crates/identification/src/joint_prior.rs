//! Prior distributions of the parameters of a jointed robot, before any flight is used.

use super::estimate::LengthReading;
use realgap_core::error::Result;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{Assignment, Parameter, ParameterSet, Scale, by_name};

/// Prior of one parameter: the stated value with a standard deviation. The priors are weak; they keep a parameter at its stated
/// value if the flights contain no information about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    pub(super) parameter: &'static Parameter,
    pub(super) stated: f64,
    pub(super) deviation: f64,
}

/// The parameters that can be identified, each with the standard deviation of its plausible values about the stated value.
pub(super) fn priors(experiment: &Experiment, reading: LengthReading) -> Result<Vec<Prior>> {
    let robot = experiment.adjusted_assembly();
    let length_m = robot.body_length_m;
    let mut named: Vec<(String, f64)> = Vec::new();
    for (index, name) in robot.module_names.iter().enumerate() {
        // Only ratios of masses affect a flight, so the mass of the first module is fixed.
        if index > 0 {
            named.push((format!("module.{name}.mass_scale"), 0.2));
        }
        for axis in ["x", "y", "z"] {
            named.push((format!("module.{name}.com_offset_{axis}_m"), 0.1 * length_m));
        }
        for axis in ["x", "y", "z"] {
            named.push((format!("module.{name}.inertia_{axis}_scale"), 0.3));
        }
    }
    // The deviation of hinge friction is of the size that would stop a part within a second.
    let part = robot.parts[robot.hinges[0].child_part].mass(&nalgebra::Isometry3::identity());
    let resists = part.inertia_kg_m2.trace() / 3.0 + 0.25 * part.mass_kg * length_m * length_m;
    named.push(("hinge.viscous_nm_s_rad".to_owned(), resists));
    named.push(("hinge.dry_nm".to_owned(), resists));
    match reading {
        LengthReading::LengthScale => named.push(("recording.length_scale".to_owned(), 0.05)),
        LengthReading::Gravity => named.push(("gravity_m_s2".to_owned(), 0.5)),
    }
    named
        .into_iter()
        .map(|(name, deviation)| {
            let parameter = by_name(&name)?;
            Ok(Prior {
                parameter,
                stated: parameter.value(experiment).unwrap_or(0.0),
                deviation,
            })
        })
        .collect()
}

impl Prior {
    /// The value that lies `deviations` standard deviations from the stated value, limited to the parameter's bounds.
    pub(super) fn value(&self, deviations: f64) -> f64 {
        let moved = self.deviation * deviations;
        let value = match self.parameter.scale {
            Scale::Log => self.stated * moved.exp(),
            Scale::Linear => self.stated + moved,
        };
        value.clamp(self.parameter.bounds.0, self.parameter.bounds.1)
    }
}

/// Values of the parameters `free`, given in standard deviations from their stated values.
pub(super) fn set(priors: &[Prior], free: &[usize], deviations: &[f64]) -> Result<ParameterSet> {
    free.iter()
        .zip(deviations)
        .map(|(index, deviations)| {
            let prior = &priors[*index];
            Assignment::new(prior.parameter.name, prior.value(*deviations))
        })
        .collect()
}
