//! The runs that check a posterior.

use realgap_core::error::Result;
use realgap_optimization::UnitPoint;

/// Evaluates points and returns the errors of each; `None` for a run that diverged.
pub type Evaluate<'a> = dyn FnMut(&[UnitPoint]) -> Result<Vec<Option<Vec<f64>>>> + 'a;

/// The errors at a point with a timestep that is multiplied by a factor; `None` for a run that diverged.
pub type Finer<'a> = dyn FnMut(&UnitPoint, f64) -> Result<Option<Vec<f64>>> + 'a;

/// Runs at points that the posterior asks for, up to a limit.
pub(super) struct CheckRuns<'a> {
    evaluate: &'a mut Evaluate<'a>,
    /// Runs that may still be made.
    left: usize,
    /// Number of errors of a run.
    errors: usize,
    /// The runs that were made, with their errors.
    known: Vec<(UnitPoint, Vec<f64>)>,
}

impl<'a> CheckRuns<'a> {
    pub fn new(evaluate: &'a mut Evaluate<'a>, most: usize, errors: usize) -> Self {
        Self {
            evaluate,
            left: most,
            errors,
            known: Vec::new(),
        }
    }

    /// Whether so many more runs may be made.
    pub fn has_left(&self, count: usize) -> bool {
        self.left >= count
    }

    /// The errors at these points; all `None` where the limit is reached. A run with another number of errors counts as diverged.
    pub fn run(&mut self, points: Vec<UnitPoint>) -> Result<Vec<Option<Vec<f64>>>> {
        if !self.has_left(points.len()) {
            return Ok(vec![None; points.len()]);
        }
        self.left -= points.len();
        let found = (self.evaluate)(&points)?;
        let is_whole = |errors: &Vec<f64>| errors.len() == self.errors;
        let found = found.into_iter();
        let found: Vec<Option<Vec<f64>>> = found.map(|errors| errors.filter(is_whole)).collect();
        let whole = points.into_iter().zip(&found);
        self.known
            .extend(whole.filter_map(|(point, errors)| Some((point, errors.clone()?))));
        Ok(found)
    }

    /// The runs that were made and did not diverge, with their errors.
    pub fn known(&self) -> &[(UnitPoint, Vec<f64>)] {
        &self.known
    }
}
