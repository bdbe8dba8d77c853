//! Numerical ensemble: timesteps and substeps that are as valid as an experiment's own.
//!
//! Half the timestep or twice the substeps is an equally good choice, but for a walking robot it changes the result. Studies use
//! the mean score over such settings, and predictions report the spread of their results.

use super::experiment::Experiment;

impl Experiment {
    /// The experiment with equally valid numerical settings; number 0 stands for its own settings. For other numbers the timestep
    /// is divided, or the substeps are multiplied, by a factor of 1 to 2. Odd numbers vary the substeps, even ones the step, in a
    /// sequence whose first members always cover the range evenly (van der Corput 1935).
    ///
    /// A simulator of somebody else has settings of its own.
    #[must_use]
    pub fn with_numerics(&self, number: u64) -> Self {
        let mut changed = self.clone();
        self.simulator.get().vary(&mut changed, number);
        changed
    }
}

/// The timestep and substeps of setting number `number`.
pub(super) fn vary_engine(experiment: &mut Experiment, number: u64) {
    let (shorter, more) = factors(number);
    experiment.solver.timestep_s /= shorter;
    experiment.solver.substeps = (experiment.solver.substeps as f64 * more).ceil() as usize;
}

/// The factors by which the timestep is divided and the substeps are multiplied.
fn factors(number: u64) -> (f64, f64) {
    if number == 0 {
        return (1.0, 1.0);
    }
    let factor = libm::exp2(1.0 - van_der_corput((number - 1) / 2));
    if number % 2 == 1 {
        (1.0, factor)
    } else {
        (factor, 1.0)
    }
}

/// The index-th number of the sequence 0, 1/2, 1/4, 3/4, 1/8 …
fn van_der_corput(mut index: u64) -> f64 {
    let (mut value, mut digit) = (0.0, 0.5);
    while index > 0 {
        if index % 2 == 1 {
            value += digit;
        }
        index /= 2;
        digit *= 0.5;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_members_cover_the_range() {
        // First twice the substeps, then half the step, then intermediate factors.
        assert_eq!((factors(1), factors(2)), ((1.0, 2.0), (2.0, 1.0)));
        assert!((factors(3).1 - 2.0_f64.sqrt()).abs() < 1e-12 && factors(3).0 == 1.0);
        assert_eq!(factors(0), (1.0, 1.0));
    }
}
