//! Equally valid settings: numerics and starts that nobody can choose between by reason.
//!
//! A step that is half as long, twice the substeps, the second engine, or a start a millimetre off is as good a choice as the
//! study's own, and for a robot that walks it changes the score. What all of them say on average is an answer; what one of them says is luck.

use realgap_engine::{Experiment, Noise};

/// One of the equally valid settings, by number; 0 is the study's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Setting(u64);

/// What is left alone and what varies between the settings of a study.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    /// How starts (or, for an ensemble, whole repeats) differ.
    pub noise: Noise,
    /// How many there are.
    pub count: usize,
    /// Seed of the noise.
    pub seed: u64,
}

impl Setting {
    /// The study's own.
    pub const OWN: Self = Self(0);

    /// The setting with this number.
    pub fn new(number: usize) -> Self {
        Self(number as u64)
    }
}

impl Settings {
    /// The setting that trial number `index` is simulated with: all of them in turn, so that neighbours on a grid differ.
    pub fn of_trial(&self, index: usize) -> Setting {
        Setting::new(index % self.count)
    }

    /// The engines that simulate, with their versions, each with the numbers of its settings; the study's own first.
    pub fn engines(&self, own: &Experiment) -> Vec<(&'static str, Vec<usize>)> {
        let mut engines: Vec<(&'static str, Vec<usize>)> = Vec::new();
        for number in 0..self.count {
            let version = self.apply(Setting::new(number), own).engine().version();
            match engines.iter_mut().find(|(known, _)| *known == version) {
                Some((_, numbers)) => numbers.push(number),
                None => engines.push((version, vec![number])),
            }
        }
        engines
    }

    /// What a run costs on average over the settings, in runs with the study's own.
    pub fn mean_cost(&self, own: &Experiment) -> f64 {
        let steps = |experiment: &Experiment| {
            experiment.solver.substeps as f64 / experiment.solver.timestep_s
        };
        let all = (0..self.count).map(|number| steps(&self.apply(Setting::new(number), own)));
        all.sum::<f64>() / self.count as f64 / steps(own)
    }

    /// The experiment as this setting has it.
    pub fn apply(&self, setting: Setting, experiment: &Experiment) -> Experiment {
        if setting == Setting::OWN {
            return experiment.clone();
        }
        let perturbed = self.noise.perturb(experiment, self.seed, setting.0);
        perturbed.with_setting(setting.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_robot::morphology::Morphology;

    fn experiment() -> Experiment {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../morphologies/tripod.ron");
        Experiment::new(Morphology::read(path).unwrap().assemble())
    }

    fn settings() -> Settings {
        Settings {
            noise: Noise::careful_start(),
            count: 16,
            seed: 1,
        }
    }

    #[test]
    fn the_first_setting_is_the_study_s_own() {
        let own = experiment();
        let same = settings().apply(Setting::OWN, &own);
        assert_eq!(format!("{own:?}"), format!("{same:?}"));
    }

    #[test]
    fn no_setting_is_coarser_than_the_study_s_own_or_finer_than_half_of_it() {
        let own = experiment();
        for number in 1..16 {
            let changed = settings().apply(Setting::new(number), &own).solver;
            if changed.engine != own.solver.engine {
                // One solve of the second engine stands for one and a half to three substeps.
                let solves = (changed.substeps as f64 / changed.timestep_s)
                    * (own.solver.timestep_s / own.solver.substeps as f64);
                assert!((0.333..=0.667).contains(&solves), "{number}: {solves}");
                continue;
            }
            let finer = own.solver.timestep_s / changed.timestep_s;
            let more = changed.substeps as f64 / own.solver.substeps as f64;
            assert!((1.0..=2.0).contains(&finer), "{number}: {finer}");
            assert!((1.0..=2.0).contains(&more), "{number}: {more}");
            assert!(finer * more > 1.0, "{number} changes nothing");
        }
    }
}
