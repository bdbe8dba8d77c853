//! Models that are as valid as the requested one: other numerics, joints, engines, and other values from the confidence set.

use super::Source;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{EngineChoice, Experiment};

/// Numbers of the equally valid numerical settings that are tried: twice the substeps, half the timestep, and less of either.
const NUMERICS: u64 = 4;
/// Most points of the confidence set that are tried.
const POINTS: usize = 8;
/// Name of the model at the limit of rigid contact, with the experiment's own kind of joint.
pub(super) const LIMIT: &str = "limit of hard contact";

/// The change by which a model differs from an experiment.
pub(super) type Change = Box<dyn Fn(&Experiment) -> Experiment + Sync + Send>;

/// Other models of an experiment: name, what they vary, and the change. Only values vary where no engine of this program simulates.
pub(super) fn alternatives(
    experiment: &Experiment,
    points: &[ParameterSet],
) -> Vec<(String, Source, Change)> {
    let mut models = match experiment.has_engine() {
        false => Vec::new(),
        true => other_physics(experiment),
    };
    let taken = points.len().min(POINTS);
    for index in 0..taken {
        // The points are spread over the set, and both ends are included.
        let point = points[index * (points.len() - 1) / taken.saturating_sub(1).max(1)].clone();
        models.push((
            point.to_string(),
            Source::Indistinguishable,
            Box::new(move |own| point.apply(own)),
        ));
    }
    models
}

/// Other numerics, joints and engines for the same values.
fn other_physics(experiment: &Experiment) -> Vec<(String, Source, Change)> {
    let mut models: Vec<(String, Source, Change)> = Vec::new();
    for number in 1..=NUMERICS {
        let changed = experiment.with_numerics(number);
        let solver = &changed.solver;
        let name = format!("{:.3e} s x {} substeps", solver.timestep_s, solver.substeps);
        let change: Change = Box::new(move |own| own.with_numerics(number));
        models.push((name, Source::Numerics, change));
    }
    let kind = experiment.joint_kind();
    models.push((
        LIMIT.to_owned(),
        Source::Numerics,
        Box::new(move |own| own.at_limit(kind)),
    ));
    let assembly = &experiment.assembly;
    if !assembly.hinges.is_empty() && !assembly.is_compliant() {
        models.push((
            format!("{:?} joints at their limit", kind.other()).to_lowercase(),
            Source::Joints,
            Box::new(move |own| own.at_limit(kind.other())),
        ));
    }
    if let Some(second) = experiment.second_engine() {
        let other = match experiment.solver.engine == second {
            true => EngineChoice::default(),
            false => second,
        };
        let change: Change = Box::new(move |own| {
            let mut own = own.clone();
            own.solver.engine = other;
            own
        });
        models.push((other.get().version().to_owned(), Source::Engine, change));
        let change: Change = Box::new(|own| own.relaxed().unwrap_or_else(|| own.clone()));
        models.push(("relaxed cone".to_owned(), Source::Contact, change));
    }
    models
}
