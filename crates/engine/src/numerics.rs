//! Timesteps, substeps and engines that are as valid as an experiment's own.
//!
//! A step that is half as long or twice the substeps is as good a choice, and for a robot that walks it changes what comes of
//! it; so does another engine. Studies score the mean over such settings, and predictions say how far they part.

use super::engine::EngineChoice;
use super::experiment::Experiment;
use super::rapier::RAPIER;

/// Of so many equally valid settings one is the reference's, which is dear; the others are the second engine's.
const REFERENCE_EVERY: u64 = 4;
/// Substeps of the reference that one solve of the second engine stands for at most, and half as many at least: errors against the
/// limit of hard contact are alike then (docs/fidelity/engines.md).
const SOLVE_SUBSTEPS: f64 = 3.0;

impl Experiment {
    /// The experiment with the equally valid numerics of this number in its own engine, 0 being its own: the timestep divided or
    /// the substeps multiplied by 1 to 2. Odd numbers vary the substeps, even ones the step, spread so that any first few cover the
    /// range (van der Corput 1935).
    #[must_use]
    pub fn with_numerics(&self, number: u64) -> Self {
        let (shorter, more) = factors(number);
        let mut changed = self.clone();
        changed.solver.timestep_s /= shorter;
        changed.solver.substeps = (changed.solver.substeps as f64 * more).ceil() as usize;
        changed
    }

    /// The experiment with the equally valid setting of this number, 0 being its own: numerics, and in three of four the second
    /// engine where there [is one](Experiment::second_engine).
    #[must_use]
    pub fn with_setting(&self, number: u64) -> Self {
        let Some(second) = self.second_engine() else {
            return self.with_numerics(number);
        };
        let turn = number / REFERENCE_EVERY;
        if number.is_multiple_of(REFERENCE_EVERY) {
            let mut changed = self.with_numerics(turn);
            if number > 0 {
                changed.solver.engine = EngineChoice::new(&RAPIER);
            }
            return changed;
        }
        let mut changed = self.clone();
        let solver = &mut changed.solver;
        let solve_s = SOLVE_SUBSTEPS * solver.timestep_s / solver.substeps as f64;
        solver.engine = second;
        solver.substeps = 1;
        // The numbers left, counted from 0.
        let place = van_der_corput(number - 1 - turn);
        solver.timestep_s = solve_s / libm::exp2(1.0 - place);
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
    use crate::experiment::JointKind;
    use realgap_robot::morphology::Assembly;

    #[test]
    fn any_first_few_cover_the_range() {
        // Twice the substeps, half the step, then what lies between.
        assert_eq!((factors(1), factors(2)), ((1.0, 2.0), (2.0, 1.0)));
        assert!((factors(3).1 - 2.0_f64.sqrt()).abs() < 1e-12 && factors(3).0 == 1.0);
        assert_eq!(factors(0), (1.0, 1.0));
    }

    #[test]
    #[cfg(feature = "f64")]
    fn one_setting_in_four_is_the_reference_s_and_none_is_like_another() {
        let own = Experiment::new(Assembly::nobody());
        let all: Vec<Experiment> = (0..16).map(|number| own.with_setting(number)).collect();
        let reference = |e: &&Experiment| e.solver.engine == EngineChoice::default();
        assert_eq!(all.iter().filter(reference).count(), 4);
        assert_eq!(all[0], own);
        for (index, one) in all.iter().enumerate() {
            assert!(!all[..index].contains(one), "{:?}", one.solver);
        }
        let tree = own.with_setting(1);
        let again = tree.with_setting(4).solver.engine;
        assert_eq!(again, EngineChoice::default());
    }

    #[test]
    fn what_means_something_in_rapier_only_stays_there() {
        let mut own = Experiment::new(Assembly::nobody());
        own.solver.joint = JointKind::Impulse;
        for number in 0..16 {
            assert_eq!(own.with_setting(number), own.with_numerics(number));
        }
    }
}
