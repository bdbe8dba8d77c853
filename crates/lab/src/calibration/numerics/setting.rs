//! Equally valid settings: choices of numerics, start and engine between which there is no reason to prefer one.
//!
//! A timestep half as long, twice the substeps, a start that is a millimetre off, or the second engine where it can run the
//! robot, is as good a choice as the study's own; for a walking robot each of them changes the score. So the score is the mean
//! over all of them, because a single one contains chance. Both engines have the same weight, whatever their numbers of settings
//! are.

use crate::calibration::{ScoreRule, StartRule, Study};
use realgap_core::statistics::mean_of_any;
use realgap_simulation::{EngineChoice, Experiment, Noise};

/// With two engines, one setting in so many runs in the study's own engine, which is the expensive one: six of sixteen. The mean
/// over both engines is then as precise as with fifteen settings that are shared evenly.
const OWN_EVERY: usize = 3;
/// A grid of at least so many points needs fewer runs of the expensive engine to determine the difference between the engines,
/// which is a smooth function of the parameters: on its points, only one in `OWN_OF_A_LARGE_MAP` of the own engine's settings
/// runs in it.
const LARGE_MAP: usize = 256;
const OWN_OF_A_LARGE_MAP: usize = 2;

/// Number of equally valid settings where the study does not state one.
const VALID_SETTINGS: usize = 16;

/// Number of an equally valid setting; 0 is the study's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::calibration) struct Setting(u64);

/// The equally valid settings of a study.
#[derive(Debug, Clone, Copy)]
pub(in crate::calibration) struct Settings {
    /// How starts (or, for an ensemble, whole repeats) differ.
    pub noise: Noise,
    /// How many there are.
    pub count: usize,
    /// Seed of the noise.
    pub seed: u64,
    /// The engine that is as valid as the study's own; `None` where there is none.
    pub second: Option<EngineChoice>,
    /// Trials with a number below this one are points of a large grid; 0 where the grid is not large.
    pub of_map: usize,
}

impl Setting {
    /// The study's own.
    pub const OWN: Self = Self(0);

    /// The setting with this number.
    pub fn new(number: usize) -> Self {
        Self(number as u64)
    }

    /// Its number.
    pub fn number(self) -> u64 {
        self.0
    }
}

impl Settings {
    /// The setting of trial number `index`: all settings take turns, so that neighbours on a grid have different ones. On a large
    /// grid, half of the settings of the study's own engine are replaced by a neighbouring setting of the second engine.
    pub fn of_trial(&self, index: usize) -> Setting {
        let (round, number) = (index / self.count, index % self.count);
        let gives_way = index < self.of_map
            && self.engine_of(number) > 0.0
            && !(number / OWN_EVERY + round).is_multiple_of(OWN_OF_A_LARGE_MAP);
        Setting::new(match gives_way {
            false => number,
            true if number + 1 < self.count => number + 1,
            true => number - 1,
        })
    }

    /// Code of the engine of trial number `index`: 1 for the study's own, −1 for the second, 0 where there is one engine only.
    /// The deviation of an engine from the mean of both is this code times half of their difference.
    pub(crate) fn engine_of_trial(&self, index: usize) -> f64 {
        self.engine_of(self.of_trial(index).0 as usize)
    }

    /// Code of the engine of a setting.
    fn engine_of(&self, number: usize) -> f64 {
        match (self.second, number % OWN_EVERY) {
            (None, _) => 0.0,
            (_, 0) => 1.0,
            _ => -1.0,
        }
    }

    /// The mean of runs, each given by the number of its trial and a value: the mean of the engine with this code, or, for 0, of both
    /// engines' means. Runs of the other engine count where the one that is asked for has none.
    pub fn mean(&self, engine: f64, runs: &[(usize, f64)]) -> f64 {
        let [own, second] = self.engine_means(runs);
        let of_one = match engine {
            0.0 => own.zip(second).map(|(own, second)| 0.5 * (own + second)),
            1.0 => own,
            _ => second,
        };
        of_one.or(own).or(second).unwrap_or(f64::NAN)
    }

    /// The mean of each engine's runs: of the study's own engine, and of the second.
    pub(crate) fn engine_means(&self, runs: &[(usize, f64)]) -> [Option<f64>; 2] {
        let of = |is_own: bool| {
            let here = |index: usize| (self.engine_of_trial(index) >= 0.0) == is_own;
            let values = runs.iter().filter(|(index, _)| here(*index));
            mean_of_any(values.map(|(_, value)| *value))
        };
        [of(true), of(false)]
    }

    /// Mean cost of a run over all settings, of the study's own engine and of the second, in runs of that engine with the study's
    /// own steps. A substep costs as much as a step.
    pub(crate) fn mean_costs(&self, own: &Experiment) -> [f64; 2] {
        let steps = |experiment: &Experiment| {
            experiment.solver.substeps as f64 / experiment.solver.timestep_s
        };
        let cost = |index: usize| steps(&self.apply(self.of_trial(index), own)) / steps(own);
        let trials = OWN_OF_A_LARGE_MAP * self.count;
        let of = |is_own: bool| {
            let here = |index: &usize| (self.engine_of_trial(*index) >= 0.0) == is_own;
            (0..trials).filter(here).map(cost).sum::<f64>() / trials as f64
        };
        [of(true), of(false)]
    }

    /// The experiment with this setting.
    pub fn apply(&self, setting: Setting, experiment: &Experiment) -> Experiment {
        if setting == Setting::OWN {
            return experiment.clone();
        }
        let perturbed = self.noise.perturb(experiment, self.seed, setting.0);
        let mut changed = perturbed.with_numerics(setting.0);
        if let Some(second) = self.second
            && self.engine_of(setting.0 as usize) < 0.0
        {
            changed.solver.engine = second;
        }
        changed
    }
}

/// Whether a grid of so many points is a large one.
pub(in crate::calibration) fn is_large_map(points: usize) -> bool {
    points >= LARGE_MAP
}

impl Study {
    /// How repeats of the recorded run are assumed to differ, where a single recording cannot show it: as the study's noise says, or
    /// else like careful repeats; and this in words. A run that starts as its recording did has no other start, and does not differ
    /// without a stated noise. Nor do runs that are compared by single errors, because least squares take differences of runs.
    pub(in crate::calibration) fn noise_of_repeats(&self) -> (Noise, &'static str) {
        let stated = self.definition().noise;
        let stated = stated.filter(|_| !self.definition().metric.needs().joints);
        let none = Noise::default();
        match (stated, self.definition().start) {
            (Some(noise), StartRule::Settled) => (noise, "as the noise of the study says"),
            (Some(noise), StartRule::FromRecording) => (
                Noise {
                    start_position_m: none.start_position_m,
                    start_height_m: none.start_height_m,
                    start_tilt_rad: none.start_tilt_rad,
                    start_heading_rad: none.start_heading_rad,
                    ..noise
                },
                "as the noise of the study says, except for their starts",
            ),
            (None, StartRule::Settled) => (
                Noise::careful_repeat(),
                "like careful repeats: starts by 1 mm and 1 deg, servo zeros by 1 deg",
            ),
            (None, StartRule::FromRecording) => (none, "by the numerical settings alone"),
        }
    }

    /// The equally valid settings over which a score is the mean.
    pub(in crate::calibration) fn settings(&self) -> Settings {
        let definition = self.definition();
        let start = match definition.start {
            _ if self.fitted_recordings() < 2 => self.noise_of_repeats().0,
            StartRule::Settled => Noise::careful_start(),
            StartRule::FromRecording => Noise::default(),
        };
        let (noise, count) = match definition.score {
            ScoreRule::Valid => (start, self.simulator().settings(VALID_SETTINGS)),
            ScoreRule::Ensemble { repeats } => (definition.noise.unwrap_or(start), repeats),
            ScoreRule::Single => (start, 1),
        };
        // A single run is made with the study's own engine.
        let second = self.second.filter(|_| count > 1);
        let points = definition.grid.len();
        let is_large = second.is_some() && is_large_map(points);
        Settings {
            noise,
            count,
            seed: definition.seed,
            second,
            of_map: if is_large { points } else { 0 },
        }
    }

    /// The second engine, which is as valid for this study as its own engine Rapier, where it can run all robots of the study at
    /// all searched values. `None` for a study that fixes `solver.engine` or a parameter that only Rapier has, and for fits of
    /// joint errors, because least squares take differences of their runs.
    pub(in crate::calibration) fn second_engine(&self) -> Option<EngineChoice> {
        let definition = self.definition();
        let ranges = definition.grid.ranges();
        let engine = "solver.engine";
        let is_searched = ranges.iter().any(|r| r.parameter.name == engine);
        let is_fixed = definition.set.value(engine).is_some();
        if is_searched || is_fixed || definition.metric.needs().joints {
            return None;
        }
        let ends: [Vec<f64>; 2] = [
            ranges.iter().map(|range| range.from).collect(),
            ranges.iter().map(|range| range.to).collect(),
        ];
        let experiments = self.cases().iter().map(|case| &case.experiment);
        let mut engines = experiments.flat_map(|experiment| {
            let is_reference = experiment.solver.engine == EngineChoice::default();
            let of = move |values: &Vec<f64>| {
                let there = self.parameter_set(values).apply(experiment);
                there.second_engine().filter(|_| is_reference)
            };
            ends.each_ref().map(of)
        });
        let first = engines.next()?;
        first.filter(|_| engines.all(|engine| engine == first))
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
            second: None,
            of_map: 0,
        }
    }

    fn of_both() -> Settings {
        Settings {
            second: experiment().second_engine(),
            ..settings()
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
            let finer = own.solver.timestep_s / changed.timestep_s;
            let more = changed.substeps as f64 / own.solver.substeps as f64;
            assert!((1.0..=2.0).contains(&finer), "{number}: {finer}");
            assert!((1.0..=2.0).contains(&more), "{number}: {more}");
            assert!(finer * more > 1.0, "{number} changes nothing");
        }
    }

    #[test]
    fn engines_weigh_the_same_however_many_settings_each_has() {
        let both = of_both();
        let own = |number: &usize| both.engine_of_trial(*number) > 0.0;
        let numbers: Vec<usize> = (0..16).filter(own).collect();
        assert_eq!(numbers, [0, 3, 6, 9, 12, 15]);
        // A deviation of one engine alone moves the mean by half of it, for two settings and more.
        for count in 2..=16 {
            let some = Settings { count, ..both };
            let runs = (0..count).map(|n| (n, if own(&n) { 10.0 } else { 4.0 }));
            let runs: Vec<(usize, f64)> = runs.collect();
            assert_eq!(some.mean(0.0, &runs), 7.0, "{count}");
            assert_eq!(some.mean(1.0, &runs), 10.0, "{count}");
            assert_eq!(some.mean(-1.0, &runs), 4.0, "{count}");
            assert_eq!(some.mean(0.0, &runs[1..2]), 4.0);
            assert_eq!(some.mean(1.0, &runs[1..2]), 4.0);
        }
    }

    #[test]
    fn a_large_map_runs_the_expensive_engine_half_as_often_and_equally_often_with_each_setting() {
        let both = of_both();
        let large = Settings {
            of_map: LARGE_MAP,
            ..both
        };
        let mut of_own = [0; 16];
        for index in 0..2 * 16 {
            let setting = large.of_trial(index).0 as usize;
            let is_own = large.engine_of_trial(index) > 0.0;
            assert_eq!(is_own, setting.is_multiple_of(OWN_EVERY));
            of_own[setting] += usize::from(is_own);
        }
        let expected: [usize; 16] = std::array::from_fn(|n| usize::from(n % OWN_EVERY == 0));
        assert_eq!(of_own, expected);
        // Behind the points of a large grid, and on a smaller grid, all settings take turns.
        for index in LARGE_MAP..2 * LARGE_MAP {
            assert_eq!(large.of_trial(index), both.of_trial(index));
        }
        assert!(is_large_map(LARGE_MAP) && !is_large_map(LARGE_MAP - 1));
    }

    #[test]
    fn the_second_engine_changes_the_engine_and_nothing_else() {
        let own = experiment();
        for number in 0..16 {
            let alone = settings().apply(Setting::new(number), &own);
            let mut with = of_both().apply(Setting::new(number), &own);
            let is_own = with.solver.engine == own.solver.engine;
            assert_eq!(is_own, of_both().engine_of_trial(number) > 0.0);
            with.solver.engine = own.solver.engine;
            assert_eq!(alone, with, "{number}");
            // The size of the grid changes no setting: a map and its enlarged part show the same surface.
            let large = Settings {
                of_map: LARGE_MAP,
                ..of_both()
            };
            let small = of_both().apply(Setting::new(number), &own);
            assert_eq!(large.apply(Setting::new(number), &own), small, "{number}");
        }
    }
}
