//! What is known about how good the approximation of a posterior is.

use serde::Serialize;

use realgap_core::statistics::mean;

use super::effective;

/// Draws that are run agree with the approximation where the mean of the deviance above the promised one is below this for each
/// parameter.
const AGREEMENT: f64 = 1.0;
/// A fit has converged where its next step would be shorter than so many standard deviations.
const CONVERGED: f64 = 3.0;
/// Errors that are larger than their noise by this factor are systematic: the model is wrong, or the minimum is.
const SYSTEMATIC: f64 = 3.0;
/// Descents that have to end at a minimum with such errors before it counts as that of the model.
const ENOUGH: usize = 2;

/// What is known about how good the approximation of a posterior is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Agreement {
    /// Length of the step that the descent would have gone on with, in standard deviations of the posterior: large where the budget
    /// ended before the fit did.
    pub remaining: f64,
    /// Size of the errors of the best point, in sizes of the noise that they show by themselves (differences of high order): about 1
    /// where nothing but noise is left.
    pub systematic: f64,
    /// Descents that ended at the best point; `None` for a fit that has one start, because it has many parameters or priors.
    pub descents: Option<usize>,
    /// Draws that were run.
    pub checked: usize,
    /// Of these, the effective number once weighted by how well they fit (Kish 1965).
    pub effective: f64,
    /// Mean deviance beyond what was promised, for each parameter: 0 where the approximation holds; `None` where no draw was run.
    pub excess: Option<f64>,
}

impl Agreement {
    /// The same with the excess deviance of some draws that were run.
    pub(super) fn with_checks(self, excesses: &[f64], parameters: usize) -> Self {
        let weights: Vec<f64> = excesses.iter().map(|e| libm::exp(-0.5 * e)).collect();
        Self {
            checked: excesses.len(),
            effective: effective(&weights),
            excess: Some(mean(excesses) / parameters as f64),
            ..self
        }
    }

    /// Whether the fit had ended when the budget did.
    pub fn has_ended(&self) -> bool {
        self.remaining < CONVERGED
    }

    /// Whether it had ended, in a minimum that is not doubted.
    pub fn has_converged(&self) -> bool {
        self.has_ended() && !self.may_be_local()
    }

    /// Whether the best point leaves more than noise.
    pub fn is_systematic(&self) -> bool {
        self.systematic > SYSTEMATIC
    }

    /// Whether the best point may be a minimum beside the lowest one: it leaves more than noise, and no second descent ended there. A
    /// second one from elsewhere makes a wrong model likelier than a wrong minimum (stopping rules for descents from many starts:
    /// Boender & Rinnooy Kan 1987).
    pub fn may_be_local(&self) -> bool {
        self.is_systematic() && self.descents.is_some_and(|descents| descents < ENOUGH)
    }

    /// Whether runs at draws confirm the approximation.
    pub fn holds(&self) -> bool {
        self.excess.is_none_or(|excess| excess < AGREEMENT)
    }
}
