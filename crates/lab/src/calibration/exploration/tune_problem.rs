//! The optimization problem of a study that is tuned.

use crate::calibration::{Study, TuneOptions};
use realgap_core::{Advice, Error, Result};
use realgap_optimization::{OptimizationProblem, UnitPoint};

/// Largest budget: all points are held in memory, and every proposal looks at all of them.
const MOST_POINTS: usize = 1_000_000;

/// Runs of the first design on which the basis of the `pca` metric is fitted.
const BASIS_DESIGN: usize = 64;

/// Whether the metric needs a basis that the study does not have.
fn needs_basis(study: &Study) -> bool {
    let definition = study.definition();
    definition.metric.needs().basis && !definition.basis.is_known()
}

/// Number of points of the first design.
pub(super) fn first_design(study: &Study, options: &TuneOptions) -> usize {
    let dimensions = study.definition().grid.ranges().len();
    let basis = if needs_basis(study) { BASIS_DESIGN } else { 0 };
    options.optimizer.design(dimensions).max(basis)
}

/// Checks that least squares get single errors, and that prior knowledge is given to no other optimizer, because the others
/// cannot use it.
fn check_errors(study: &Study, options: &TuneOptions) -> Result<()> {
    let definition = study.definition();
    let name = options.optimizer.name();
    if !options.optimizer.needs_errors() {
        if definition.priors.iter().all(Option::is_none) {
            return Ok(());
        }
        return Err(
            Error::usage("this optimizer makes nothing of prior knowledge")
                .field("optimizer")
                .found(name)
                .allowed("gauss-newton, or a study without `prior`"),
        );
    }
    if definition.metric.has_errors() {
        return Ok(());
    }
    Err(Error::usage(format!(
        "{name} needs a metric that is made of single errors"
    ))
    .field("metric")
    .found(definition.metric.name())
    .allowed("joints, pose"))
}

/// The coordinates of the values that the robot and the floor have without a fit, within the ranges; the middle of the range of a
/// parameter without such a value.
pub(in crate::calibration) fn own_values(study: &Study) -> UnitPoint {
    let definition = study.definition();
    let ranges = definition.grid.ranges().iter();
    let all = ranges
        .zip(&definition.parameters)
        .map(|(range, parameter)| {
            let experiment = definition.set.apply(&definition.untuned(parameter));
            let value = parameter.value(&experiment);
            value.map_or(0.5, |value| {
                range.coordinate(value.clamp(range.from, range.to))
            })
        });
    all.collect()
}

/// The optimization problem of the study.
///
/// # Errors
/// A budget that does not hold the first design and one batch, or that is too large.
pub(super) fn brief(study: &Study, options: &TuneOptions) -> Result<OptimizationProblem> {
    let definition = study.definition();
    let ranges = definition.grid.ranges().iter();
    let design = first_design(study, options);
    let brief = OptimizationProblem {
        points: ranges.map(|range| range.points).collect(),
        budget: options.budget.saturating_sub(design),
        seed: definition.seed,
        priors: match options.optimizer.needs_errors() {
            true => definition.priors_of_fit(),
            false => definition.priors.clone(),
        },
        error_blocks: Vec::new(),
        own: Some(own_values(study)),
    };
    check_errors(study, options)?;
    let batch = options.optimizer.batch(&brief).max(1);
    if options.budget > MOST_POINTS {
        return Err(Error::usage("the budget is too large")
            .field("budget")
            .found(options.budget)
            .allowed(format!("at most {MOST_POINTS}")));
    }
    if brief.budget < batch {
        let error = Error::usage("the budget is too small")
            .field("budget")
            .found(options.budget)
            .allowed(format!(
                "at least {}: a first design of {design} and one batch of {batch}",
                design + batch
            ));
        return Err(if needs_basis(study) {
            error.advise(Advice::MetricWithoutBasis)
        } else {
            error
        });
    }
    Ok(brief)
}
