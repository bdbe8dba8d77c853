//! What is known of a jointed robot before any flight.

use super::estimate::LengthReading;
use realgap_core::error::Result;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{Assignment, Parameter, ParameterSet, Scale, by_name};

/// What is known of a parameter before any flight: one standard deviation about the stated value. Weak, so that flights that
/// say nothing leave it where it was.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    pub(super) parameter: &'static Parameter,
    pub(super) stated: f64,
    pub(super) deviation: f64,
}

/// What may be identified, and how far it may reasonably be from what is stated.
pub(super) fn priors(experiment: &Experiment, reading: LengthReading) -> Result<Vec<Prior>> {
    let robot = experiment.adjusted_assembly();
    let length_m = robot.body_length_m;
    let mut named: Vec<(String, f64)> = Vec::new();
    for (index, name) in robot.module_names.iter().enumerate() {
        // Only ratios of masses act in flight.
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
    // Friction that would stop a part within a second.
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
    /// The value so many deviations from the stated one, within the parameter's bounds.
    pub(super) fn value(&self, deviations: f64) -> f64 {
        let moved = self.deviation * deviations;
        let value = match self.parameter.scale {
            Scale::Log => self.stated * moved.exp(),
            Scale::Linear => self.stated + moved,
        };
        value.clamp(self.parameter.bounds.0, self.parameter.bounds.1)
    }
}

pub(super) fn set(priors: &[Prior], free: &[usize], deviations: &[f64]) -> Result<ParameterSet> {
    free.iter()
        .zip(deviations)
        .map(|(index, deviations)| {
            let prior = &priors[*index];
            Assignment::new(prior.parameter.name, prior.value(*deviations))
        })
        .collect()
}
