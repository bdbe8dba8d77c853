//! Timesteps and substeps that are as valid as an experiment's own.
//!
//! A step that is half as long or twice the substeps is as good a choice, and for a robot that walks it changes what comes of
//! it. Studies score the mean over such settings, and predictions say how far they part.

use super::experiment::Experiment;

impl Experiment {
    /// The experiment with the equally valid numerics of this number, 0 being its own: the timestep divided or the substeps
    /// multiplied by 1 to 2. Odd numbers vary the substeps, even ones the step, spread so that any first few cover the range
    /// (van der Corput 1935).
    #[must_use]
    pub fn with_numerics(&self, number: u64) -> Self {
        let (shorter, more) = factors(number);
        let mut changed = self.clone();
        changed.solver.timestep_s /= shorter;
        changed.solver.substeps = (changed.solver.substeps as f64 * more).ceil() as usize;
        changed
    }
}

/// By how much the timestep is divided and the substeps are multiplied.
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
    fn any_first_few_cover_the_range() {
        // Twice the substeps, half the step, then what lies between.
        assert_eq!((factors(1), factors(2)), ((1.0, 2.0), (2.0, 1.0)));
        assert!((factors(3).1 - 2.0_f64.sqrt()).abs() < 1e-12 && factors(3).0 == 1.0);
        assert_eq!(factors(0), (1.0, 1.0));
    }
}
