//! Which numbers of a robot's own file fitted parameters change.

mod ron;

use realgap_core::error::Result;
use realgap_core::file::Source;
use realgap_robot::import::amendment::{
    Amendment, BodyMass, JointQuantity, Outcome, Target, amend,
};
use realgap_robot::import::{Options, is_foreign};
use realgap_robot::morphology::{Assembly, Hinge, Morphology, ServoLaw, Shape};

use crate::Experiment;
use crate::parameter::{Assignment, FOREIGN, ParameterSet};

/// The file of a robot with the values of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// Its text.
    pub text: String,
    /// Of every value, in order, what became of it.
    pub values: Vec<(Assignment, Fate)>,
    /// The largest relative difference between a number that was to be written and the same number read back.
    pub largest_difference: f64,
}

/// What became of a fitted value.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// It was written: each number, as [`Written`](realgap_robot::import::amendment::Written) says.
    Written(Vec<realgap_robot::import::amendment::Written>),
    /// The file says the same already.
    Unchanged,
    /// The file cannot say it: why.
    Unsaid(String),
}

/// Writes fitted values into the RON, URDF or MJCF from which a robot was read. `remark` is the comment that is put before an element,
/// or before a line of RON, for a parameter.
///
/// # Errors
/// As [`Morphology::import`] and [`Morphology::parse`].
pub fn calibrate(
    source: &Source,
    options: &Options,
    set: &ParameterSet,
    remark: impl Fn(&Assignment) -> String,
) -> Result<Calibrated> {
    if !is_foreign(source.path()) {
        return ron::calibrate(source, set, remark);
    }
    let before = Experiment::new(Morphology::import(source, options)?.0.assemble());
    let after = set.apply(&before);
    let (old, new) = (before.adjusted_assembly(), after.adjusted_assembly());
    let mut amendments: Vec<Amendment> = Vec::new();
    let mut causes: Vec<Vec<usize>> = Vec::new();
    let assignments: Vec<Assignment> = set.iter().copied().collect();
    let alone: Vec<Experiment> = assignments
        .iter()
        .map(|value| ParameterSet::from_iter([*value]).apply(&before))
        .collect();
    // A number comes from the values without which it would be another.
    let without = assignments.iter().map(|left_out| {
        let others = set.iter().filter(|value| *value != left_out).copied();
        let others: ParameterSet = others.collect();
        others.apply(&before).adjusted_assembly()
    });
    let without: Vec<Assembly> = without.collect();
    let mut push = |target: Target, causing: Vec<usize>| {
        let remarks = causing.iter().map(|index| remark(&assignments[*index]));
        let remark = remarks.collect::<Vec<_>>().join("; ");
        amendments.push(Amendment { target, remark });
        causes.push(causing);
    };
    let changing = |differs: &dyn Fn(&Assembly) -> bool| -> Vec<usize> {
        let all = without.iter().enumerate();
        all.filter(|(_, robot)| differs(robot))
            .map(|(index, _)| index)
            .collect()
    };
    for (index, (hinge, fitted)) in old.hinges.iter().zip(&new.hinges).enumerate() {
        for quantity in JointQuantity::ALL {
            let value = |hinge: &Hinge| number(hinge, quantity);
            if let (Some(from), Some(to)) = (value(hinge), value(fitted))
                && from != to
            {
                let target = Target::Joint {
                    joint: hinge.name.clone(),
                    quantity,
                    from,
                    to,
                };
                push(
                    target,
                    changing(&|robot| value(&robot.hinges[index]) != Some(to)),
                );
            }
        }
    }
    for module in 0..old.module_names.len() {
        if let (Some(from), Some(to)) = (mass(&old, module), mass(&new, module))
            && from != to
        {
            let target = Target::Body {
                body: old.module_names[module].clone(),
                from,
                to,
            };
            push(target, changing(&|robot| mass(robot, module) != Some(to)));
        }
    }
    for (index, value) in assignments.iter().enumerate() {
        let name = value.parameter.name;
        if alone[index].gravity_m_s2 != before.gravity_m_s2 {
            push(Target::Gravity(value.value), vec![index]);
        } else if let Some(own) = name.strip_prefix(FOREIGN).and_then(|n| n.strip_prefix('.')) {
            let target = Target::Field {
                name: own.to_owned(),
                to: value.value,
            };
            push(target, vec![index]);
        }
    }
    let amended = amend(source, options, &amendments)?;
    let values = assignments.iter().enumerate().map(|(index, value)| {
        let mine = causes.iter().zip(&amended.outcomes);
        let mine: Vec<&Outcome> = mine
            .filter(|(causes, _)| causes.contains(&index))
            .map(|(_, outcome)| outcome)
            .collect();
        let is_idle = value.parameter.value(&before) == Some(value.value);
        (*value, fate(value, &mine, is_idle))
    });
    let values = values.collect();
    let read = Source::new(source.path(), amended.text.clone());
    let again = Experiment::new(Morphology::import(&read, options)?.0.assemble());
    let written = amendments.iter().zip(&amended.outcomes);
    let written = written.filter(|(_, outcome)| outcome.is_ok());
    let differences = written.map(|(amendment, _)| difference(&amendment.target, &again.assembly));
    Ok(Calibrated {
        text: amended.text.clone(),
        values,
        largest_difference: differences.fold(0.0, f64::max),
    })
}

fn fate(value: &Assignment, outcomes: &[&Outcome], is_idle: bool) -> Fate {
    let refused = outcomes.iter().find_map(|outcome| outcome.as_ref().err());
    let written = outcomes.iter().filter_map(|outcome| outcome.as_ref().ok());
    let written: Vec<_> = written.flatten().cloned().collect();
    match (refused, written.is_empty()) {
        (Some(why), true) => Fate::Unsaid(why.clone()),
        (Some(why), false) => Fate::Unsaid(format!("only in part: {why}")),
        (None, false) => Fate::Written(written),
        (None, true) if is_idle => Fate::Unchanged,
        (None, true) => Fate::Unsaid(reason(value)),
    }
}

/// Why no robot file says a parameter.
fn reason(value: &Assignment) -> String {
    let name = value.parameter.name;
    let group = name.split('.').next().unwrap_or(name);
    match group {
        "floor" | "pusher" => {
            "it belongs to a pair of bodies and to the contacts of the engine that it was fitted in"
        }
        "contact" | "solver" | "timestep_s" | "substeps" => {
            "it belongs to the engine that it was fitted in"
        }
        "recording" => "it describes the recordings, not the robot",
        "gait" => "these files state no gait",
        "joint" => "it describes the encoders, not the robot",
        "mount" => "it describes the stand, not the robot",
        "servo" => "the file's actuators have no field for it, or no such control law",
        "hinge" => "these files have no field for it, or the robot has no such joint",
        _ => "these files have no field for it",
    }
    .to_owned()
}

/// A number of a hinge; `None` where it has none.
fn number(hinge: &Hinge, quantity: JointQuantity) -> Option<f64> {
    let servo = hinge.actuator.as_ref().map(|actuator| &actuator.servo);
    let gains = servo.and_then(|servo| match servo.law {
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => Some((stiffness_nm_rad, damping_nm_s_rad)),
        _ => None,
    });
    match quantity {
        JointQuantity::Viscous => Some(hinge.bearing.viscous_nm_s_rad),
        JointQuantity::Dry => Some(hinge.bearing.dry_nm),
        JointQuantity::Armature => Some(hinge.bearing.armature_kg_m2),
        JointQuantity::ServoStiffness => gains.map(|(stiffness, _)| stiffness),
        JointQuantity::ServoDamping => gains.map(|(_, damping)| damping),
        JointQuantity::ServoLimit => servo.map(|servo| servo.max_torque_nm),
    }
}

/// The mass properties of a body that a file states, in its own frame.
fn mass(robot: &Assembly, module: usize) -> Option<BodyMass> {
    let mut solids = robot.parts.iter().flat_map(|part| &part.solids);
    let body = solids.find(|solid| {
        solid.module == module && solid.shape == Shape::Nothing && solid.mass_kg > 0.0
    })?;
    Some(BodyMass {
        mass_kg: body.mass_kg,
        centre_m: body.centre_of_mass_solid_m,
        inertia_kg_m2: body.inertia_kg_m2,
    })
}

/// The relative difference between what was to be written and what is read.
fn difference(target: &Target, read: &Assembly) -> f64 {
    let relative = |found: f64, asked: f64| match found == asked {
        true => 0.0,
        false => (found - asked).abs() / asked.abs().max(f64::MIN_POSITIVE),
    };
    match target {
        Target::Joint {
            joint,
            quantity,
            to,
            ..
        } => {
            let mut hinges = read.hinges.iter();
            let found = hinges.find(|hinge| hinge.name == *joint);
            let found = found.and_then(|hinge| number(hinge, *quantity));
            found.map_or(f64::INFINITY, |found| relative(found, *to))
        }
        Target::Body { body, to, .. } => {
            let module = read.module_names.iter().position(|name| name == body);
            let Some(found) = module.and_then(|module| mass(read, module)) else {
                return f64::INFINITY;
            };
            let size_m = (to.inertia_kg_m2.trace() / to.mass_kg).sqrt();
            let inertia = (found.inertia_kg_m2 - to.inertia_kg_m2).norm();
            relative(found.mass_kg, to.mass_kg)
                .max((found.centre_m - to.centre_m).norm() / size_m)
                .max(inertia / to.inertia_kg_m2.norm())
        }
        // The import does not read these; their text is the number.
        Target::Gravity(_) | Target::Field { .. } => 0.0,
    }
}
