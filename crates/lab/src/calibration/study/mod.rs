//! A study that is ready to run: its cases, and the simulation of one point.

pub(super) mod basis;
pub(super) mod builder;
pub(super) mod case;
pub(super) mod command_check;
pub(super) mod command_file;
pub(super) mod definition;
pub(super) mod file;
pub(super) mod fingerprint;
pub(super) mod fleet;
pub(super) mod gain_check;
pub(super) mod horizon;
pub(super) mod mujoco_file;
pub(super) mod overrides;
pub(super) mod own_case;
pub(super) mod robot_file;
pub(super) mod run_parameters;
pub(super) mod scene_file;
pub(super) mod scored_columns;
pub(super) mod simulator_file;
pub(super) mod split;
pub(super) mod steering;
pub(super) mod untouched;
pub(super) mod window_rule;

use std::path::Path;

use rayon::prelude::*;

use crate::calibration::recording::identity::{in_sample, seen_by_fit};
use crate::calibration::study::case::cases;
use crate::calibration::study::fleet::check_owners;
use crate::calibration::{BasisRule, Case, Definition, Overrides, ScoreRule};
use realgap_core::file::Source;
use realgap_core::{Code, Error, Result, Warning};
use realgap_identification::{StartState, refine_again};
use realgap_path::comparison::{Basis, ChannelSet, Channels, Context, Metric, Pair, Spread};
use realgap_path::trajectory::{Alignment, Prepared, Trajectory, prepare_as};
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{EngineChoice, Experiment, Noise, Simulator};
use realgap_store::{CaseOutcome, CaseResult, CaseRow, Trial};

/// Approximate number of single errors that are kept of a point, over all cases, and the least number of one case.
const MOST_ERRORS: usize = 16_384;
const LEAST_ERRORS: usize = 32;

/// A warning where a floor slopes and each path is turned to its own net displacement.
fn folded_directions(definition: &Definition, cases: &[Case]) -> Option<Warning> {
    let is_turned =
        definition.align == Alignment::NetDisplacement && !definition.metric.needs().joints;
    let slopes = |case: &Case| case.experiment.floor.slope_rad != 0.0;
    let is_varied = definition
        .parameters
        .iter()
        .any(|p| p.name == "floor.slope_rad");
    (is_turned && (is_varied || cases.iter().any(slopes))).then(|| {
        Code::FoldedDirections.warning(
            "the floor slopes, and each path is turned to its own net displacement before it is compared: uphill and downhill look the same",
        )
    })
}

/// A study with its cases.
#[derive(Debug, Clone)]
pub struct Study {
    definition: Definition,
    cases: Vec<Case>,
    warnings: Vec<Warning>,
    held_out: Vec<bool>,
    /// Weight of each recording's score, 1 on average.
    weights: Vec<f64>,
    /// Spread of the fitted recordings, in recorded lengths, where the metric needs it.
    spread: Option<Spread>,
    /// Whether answers are checked by further runs.
    audited: bool,
    /// The second engine, which is as valid for this study as its own.
    pub(in crate::calibration) second: Option<EngineChoice>,
}

impl Study {
    /// Reads a study with its robot and its recordings, and prepares it.
    ///
    /// # Errors
    /// As [`Definition::read`] and [`Study::new`].
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        Self::new(Definition::read(path, overrides)?)
    }

    /// As [`Study::read`], from a text. Paths in the text are relative to the folder of the source's path.
    ///
    /// # Errors
    /// As [`Study::read`].
    pub fn parse(source: &Source, overrides: &Overrides) -> Result<Self> {
        Self::new(Definition::parse(source, overrides)?)
    }

    /// The same study with these values fixed, after those that it fixes itself, for ensembles and gaps. `fitted_on` are the
    /// recordings on which the values were fitted and `draws` are the posterior draws of these fits, as in [`Overrides`].
    ///
    /// # Errors
    /// As [`Study::new`].
    pub fn at(
        &self,
        set: &ParameterSet,
        draws: Vec<Vec<ParameterSet>>,
        fitted_on: &[String],
    ) -> Result<Self> {
        let mut definition = self.definition.clone();
        definition.draws = draws;
        definition.set = definition.set.with_all(set);
        definition.seen_by_fit = seen_by_fit(&definition.recordings, fitted_on);
        let known = in_sample(&definition.recordings, definition.seen_by_fit);
        definition.warnings.extend(known);
        Self::new(definition)
    }

    /// Builds the cases of a study.
    ///
    /// # Errors
    /// Recordings from which no run can start, or settings that cannot be simulated.
    pub fn new(definition: Definition) -> Result<Self> {
        check_score(&definition).map_err(|e| definition.at_file(e))?;
        let (cases, mut warnings) = cases(&definition)?;
        warnings.extend(definition.warnings.iter().cloned());
        check_owners(&definition).map_err(|e| definition.at_file(e))?;
        warnings.extend(folded_directions(&definition, &cases));
        warnings.extend(gain_check::doubts(&definition, &cases));
        let of_first = definition.set_of(&definition.morphology);
        warnings.extend(of_first.without_effect(&cases[0].experiment));
        warnings.extend(definition.robot_warnings());
        warnings.extend(cases[0].experiment.warnings());
        warnings.extend(untouched::regions(&definition, &cases));
        let simulator = cases[0].experiment.simulator.get();
        let said = simulator.prepare(&cases[0].experiment);
        warnings.extend(said.map_err(|e| definition.at_file(e))?);
        warnings.sort();
        warnings.dedup();
        let weights = definition.weights();
        let held_out = match definition.split {
            Some(split) => split.held_out(definition.recordings.len(), definition.seed)?,
            None => vec![false; definition.recordings.len()],
        };
        let mut study = Self {
            definition,
            cases,
            warnings,
            held_out,
            weights,
            spread: None,
            audited: true,
            second: None,
        };
        study.second = study.second_engine();
        if study.definition.metric.needs().spread {
            let fitted = study.part_of(&study.real_paths(), false);
            let spread = Spread::of(&fitted).map_err(|e| study.definition.at_file(e))?;
            study.spread = Some(spread);
        }
        if study.definition.basis.is_known() {
            // A saved basis that does not fit is refused before any simulation.
            study.basis([]).map_err(|e| study.definition.at_file(e))?;
        }
        study.check_recordings()?;
        Ok(study)
    }

    /// Compares each recording with itself, so that a recording that the metric cannot use is refused before any simulation.
    fn check_recordings(&self) -> Result<()> {
        if self.definition.metric.needs().basis {
            return Ok(());
        }
        let cases = self.cases.iter();
        for (case, target) in cases.flat_map(|case| case.targets.iter().map(move |t| (case, t))) {
            let itself = (&target.motion, &target.prepared);
            let pair = Pair::new(itself, itself);
            self.definition
                .metric
                .compare(&pair, &self.context(case, self.spread.as_ref()))
                .map_err(|e| e.at_file(&self.definition.recordings[target.recording].path))?;
        }
        Ok(())
    }

    /// The definition of the study.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The definition, where the cases are not needed any more.
    pub(crate) fn into_definition(self) -> Definition {
        self.definition
    }

    /// The simulations of one point.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// What simulates the study's runs.
    pub(in crate::calibration) fn simulator(&self) -> &dyn Simulator {
        self.cases[0].experiment.simulator.get()
    }

    /// Warnings for the reader.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The same study whose answers are not checked by further runs: no numerical audit, no test whether the model explains the
    /// recordings, no runs that check the posterior of least squares. Intervals may then be too narrow, and answers say so.
    #[must_use]
    pub fn unaudited(mut self) -> Self {
        self.audited = false;
        self
    }

    /// Whether answers are checked by further runs.
    pub(in crate::calibration) fn is_audited(&self) -> bool {
        self.audited
    }

    /// A motion as this study compares it.
    ///
    /// # Errors
    /// As [`prepare_as`].
    pub fn prepared(&self, motion: &Trajectory) -> Result<Prepared> {
        let alignment = match motion.is_of_joints() {
            true => Alignment::default(),
            false => self.definition.align,
        };
        prepare_as(motion, alignment)
    }

    /// How many equally valid settings a mean score is over; 1 for a study of single runs.
    pub fn setting_count(&self) -> usize {
        self.settings().count
    }

    /// The number of the setting with which trial number `index` is run; 0 is the study's own.
    pub fn setting_of_trial(&self, index: usize) -> u64 {
        self.settings().of_trial(index).number()
    }

    /// Simulated seconds of one point, without settling.
    pub fn simulated_s(&self) -> f64 {
        let cases = self.cases.iter();
        cases.map(|case| case.experiment.duration_s).sum()
    }

    /// Weight of a recording's score, 1 on average.
    pub(in crate::calibration) fn weight(&self, recording: usize) -> f64 {
        self.weights[recording]
    }

    /// The study's parameters with these values, in the study's order.
    pub fn parameter_set(&self, values: &[f64]) -> ParameterSet {
        let named = self.definition.parameters.iter().zip(values);
        let named = named.map(|(&parameter, &value)| Assignment { parameter, value });
        named.collect()
    }

    /// Simulates every case of grid point `index` and keeps what the comparison needs.
    ///
    /// # Errors
    /// A metric that cannot compare the paths. A diverged simulation is an outcome, not an error.
    pub fn simulate(&self, index: usize) -> Result<Trial> {
        self.simulate_trial(index, self.definition.grid.values(index), false)
    }

    /// Simulates every case at these values, as trial number `index`. The number decides which of the equally valid settings is
    /// used. Single errors are kept where `has_errors` asks for them.
    ///
    /// # Errors
    /// As [`Study::simulate`], and a metric that is not made of single errors.
    pub(in crate::calibration) fn simulate_trial(
        &self,
        index: usize,
        values: Vec<f64>,
        has_errors: bool,
    ) -> Result<Trial> {
        let settings = self.settings();
        let setting = settings.of_trial(index);
        let set = self.parameter_set(&values);
        let cases = self.each_case(|case| {
            let experiment = self.experiment_with(case, &set)?;
            self.simulate_case(case, &settings.apply(setting, &experiment), has_errors)
        })?;
        Ok(Trial {
            index,
            values,
            cases,
        })
    }

    /// The experiment of a case with these parameter values.
    ///
    /// # Errors
    /// A start state that cannot be refined as the study asks.
    pub fn experiment(&self, case: usize, values: &[f64]) -> Result<Experiment> {
        self.experiment_with(case, &self.parameter_set(values))
    }

    /// The experiment of a case with these parameters, its start refined as the study asks.
    ///
    /// # Errors
    /// As [`Study::experiment`].
    pub fn experiment_with(&self, case: usize, set: &ParameterSet) -> Result<Experiment> {
        // A value that is fixed for one joint takes precedence over a value that is varied for all joints.
        let set = self.definition.set.precise().with_all(set);
        let experiment = set.apply(&self.cases[case].experiment);
        if self.definition.start_state == StartState::FirstSample {
            return Ok(experiment);
        }
        // The start depends on the centre of mass, gravity and the length scale, so it is identified after the parameters are
        // set.
        let recording = self.cases[case].targets[0].recording;
        let recorded = &self.definition.recordings[recording].trajectory;
        let mut known = self.cases[case]
            .flight
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let rule = self.definition.start_state;
        let refined = refine_again(rule, experiment, recorded, &mut known)?.0;
        Ok(refined)
    }

    /// Ratio of recorded to true lengths at these values.
    pub(in crate::calibration) fn recording_length_scale(&self, values: &[f64]) -> f64 {
        self.parameter_set(values)
            .apply(&self.cases[0].experiment)
            .recording_length_scale
    }

    /// Simulates case 0 with these parameters under `noise`, repeat number `repeat`.
    ///
    /// # Errors
    /// As [`Study::simulate`].
    pub(in crate::calibration) fn simulate_perturbed(
        &self,
        set: &ParameterSet,
        noise: &Noise,
        repeat: u64,
    ) -> Result<CaseRow> {
        let experiment = self.experiment_with(0, set)?;
        let perturbed = noise.perturb(&experiment, self.definition.seed, repeat);
        self.simulate_case(0, &perturbed, false)
    }

    /// Simulates every case with these parameters.
    ///
    /// # Errors
    /// As [`Study::simulate`].
    pub(in crate::calibration) fn simulate_set(&self, set: &ParameterSet) -> Result<Vec<CaseRow>> {
        self.each_case(|case| self.simulate_case(case, &self.experiment_with(case, set)?, false))
    }

    /// One row per case, in parallel on the current rayon pool.
    fn each_case(&self, row: impl Fn(usize) -> Result<CaseRow> + Sync) -> Result<Vec<CaseRow>> {
        let cases = (0..self.cases.len()).into_par_iter();
        cases.map(&row).collect()
    }

    /// Simulates every case at these values with other numerical settings.
    ///
    /// # Errors
    /// As [`Study::simulate`], and settings that cannot be simulated.
    pub(in crate::calibration) fn simulate_changed(
        &self,
        values: &[f64],
        change: impl Fn(&mut Experiment) + Sync,
        has_errors: bool,
    ) -> Result<Trial> {
        self.simulate_changed_each(values, |_, experiment| change(experiment), has_errors)
    }

    /// As [`Study::simulate_changed`], with a change that may differ between cases.
    pub(in crate::calibration) fn simulate_changed_each(
        &self,
        values: &[f64],
        change: impl Fn(usize, &mut Experiment) + Sync,
        has_errors: bool,
    ) -> Result<Trial> {
        let cases = self.each_case(|case| {
            let mut experiment = self.experiment(case, values)?;
            change(case, &mut experiment);
            self.simulate_case(case, &experiment, has_errors)
        })?;
        Ok(Trial {
            index: 0,
            values: values.to_vec(),
            cases,
        })
    }

    /// Whether a recording is held out of the fit.
    pub fn is_held_out(&self, recording: usize) -> bool {
        self.held_out[recording]
    }

    /// The values of the fitted recordings, or of those that are held out; one value a recording.
    pub(in crate::calibration) fn part_of<T: Copy>(
        &self,
        recordings: &[T],
        held_out: bool,
    ) -> Vec<T> {
        let all = recordings.iter().zip(&self.held_out);
        all.filter(|(_, is_held_out)| **is_held_out == held_out)
            .map(|(value, _)| *value)
            .collect()
    }

    /// The same study with exactly these recordings held out of the fit.
    pub(in crate::calibration) fn without(&self, held_out: &[usize]) -> Self {
        let recordings = 0..self.definition.recordings.len();
        Self {
            held_out: recordings.map(|index| held_out.contains(&index)).collect(),
            ..self.clone()
        }
    }

    /// Number of recordings that are fitted.
    pub(crate) fn fitted_recordings(&self) -> usize {
        self.held_out.iter().filter(|held_out| !**held_out).count()
    }

    /// Most single errors that are kept of a case.
    pub(in crate::calibration) fn most_errors(&self) -> usize {
        (MOST_ERRORS / self.cases.len()).max(LEAST_ERRORS)
    }

    /// The study with its own setting alone: least squares take differences of runs, which other settings would distort.
    pub(in crate::calibration) fn with_own_setting(&self) -> Self {
        let mut study = self.clone();
        study.definition.score = ScoreRule::Single;
        study
    }

    fn simulate_case(
        &self,
        case: usize,
        experiment: &Experiment,
        has_errors: bool,
    ) -> Result<CaseRow> {
        self.cases[case].row(experiment, has_errors, || {
            self.simulate_anew(case, experiment, has_errors)
        })
    }

    fn simulate_anew(
        &self,
        case: usize,
        experiment: &Experiment,
        has_errors: bool,
    ) -> Result<CaseRow> {
        let run = realgap_simulation::run(experiment)?;
        let motion = match run.outcome {
            realgap_simulation::Outcome::Completed(motion) => motion,
            realgap_simulation::Outcome::Diverged(divergence) => {
                return Ok(CaseRow {
                    steps: run.steps,
                    outcome: CaseOutcome::Diverged(divergence.to_string()),
                });
            }
        };
        let prepared = self.prepared(&motion)?;
        let needs_basis = self.definition.metric.needs().basis;
        // The compared paths are in true lengths.
        let spread = self.spread.as_ref();
        let spread = spread.map(|spread| spread.scaled(1.0 / experiment.recording_length_scale));
        let context = self.context(&self.cases[case], spread.as_ref());
        let (mut scores, mut errors) = (Vec::new(), Vec::new());
        let most = self.most_errors();
        if !needs_basis {
            for target in &self.cases[case].targets {
                let target = target.in_true_lengths(experiment.recording_length_scale)?;
                let pair = Pair::new((&target.motion, &target.prepared), (&motion, &prepared));
                scores.push(self.definition.metric.compare(&pair, &context)?.value);
                if has_errors {
                    match self.scored_channels() {
                        Some(channels) => errors.extend(channels.errors(&pair, most)?),
                        None => {
                            let own = self.definition.metric.errors(&pair, most)?;
                            errors.extend(own.into_iter().flatten());
                        }
                    }
                }
            }
        }
        scores.extend(errors);
        // Scores with a basis can be computed only after all paths are known; pictures need the path of the first case.
        let path_xy_m = if needs_basis || case == 0 {
            // The path is kept in recorded lengths, like the recordings that share a basis and a picture with it.
            let scale = experiment.recording_length_scale;
            let points = prepared.xy_m().iter();
            points.map(|point| point.map(|m| m * scale)).collect()
        } else {
            Vec::new()
        };
        Ok(CaseRow {
            steps: run.steps,
            outcome: CaseOutcome::Completed(CaseResult {
                net_displacement_m: prepared.net_displacement_m(),
                scores,
                path_xy_m,
            }),
        })
    }

    /// The basis of a study's scores, fitted on all recordings and all completed simulations (diverged ones are left out) unless
    /// the study has a known basis; `None` where the metric needs none.
    ///
    /// # Errors
    /// Paths from which no basis can be built.
    pub(in crate::calibration) fn basis<'a>(
        &self,
        rows: impl IntoIterator<Item = &'a CaseRow>,
    ) -> Result<Option<Basis>> {
        let definition = &self.definition;
        if !definition.metric.needs().basis {
            return Ok(None);
        }
        let real = self.real_paths();
        match &definition.basis {
            BasisRule::Saved { basis, .. } => Ok(Some((**basis).clone())),
            BasisRule::Recordings => {
                let fitted = self.part_of(&real, false);
                let basis = Basis::fit(&fitted, definition.components)?;
                if basis.kept() == 0 {
                    return Err(Error::invalid("these recordings have no principal components")
                        .field("basis")
                        .found(format!("{} that do not differ", fitted.len()))
                        .allowed("at least two different recordings")
                        .hint("record more repeats, or let the simulations have their say: basis: Everything"));
                }
                Ok(Some(basis))
            }
            BasisRule::Everything => {
                let simulated: Vec<Prepared> = rows
                    .into_iter()
                    .filter_map(CaseRow::completed)
                    .map(|result| Prepared::from_xy_m(result.path_xy_m.clone()))
                    .collect::<Result<_>>()?;
                let all: Vec<&Prepared> = real.iter().copied().chain(&simulated).collect();
                Basis::fit(&all, definition.components).map(Some)
            }
        }
    }

    /// The channels of which the score is made; `None` where the metric compares what it always compares.
    pub(in crate::calibration) fn scored_channels(&self) -> Option<&ChannelSet> {
        let is_of_channels = self.definition.metric.name() == Channels.name();
        is_of_channels.then_some(&self.definition.channels)
    }

    /// What a metric may know of a case.
    fn context<'a>(&'a self, case: &Case, spread: Option<&'a Spread>) -> Context<'a> {
        Context {
            basis: None,
            spread,
            body_length_m: case.body_length_m(),
            channels: Some(&self.definition.channels),
        }
    }

    /// The prepared paths of the recordings, by recording.
    pub fn real_paths(&self) -> Vec<&Prepared> {
        let targets = self.cases.iter().flat_map(|case| &case.targets);
        let mut targets: Vec<_> = targets.collect();
        targets.sort_by_key(|target| target.recording);
        targets.iter().map(|target| &target.prepared).collect()
    }
}

/// Checks that a mean over an ensemble has repeats, and noise by which they differ.
fn check_score(definition: &Definition) -> Result<()> {
    let ScoreRule::Ensemble { repeats } = definition.score else {
        return Ok(());
    };
    if !(2..=1000).contains(&repeats) {
        return Err(Error::invalid("not a number of repeats")
            .field("score")
            .found(repeats)
            .allowed("2 to 1000"));
    }
    if definition.noise.is_none() {
        return Err(Error::invalid("the study does not say how repeats differ")
            .field("noise")
            .found("no such section")
            .hint("add a `noise` section, or score equally valid settings only"));
    }
    Ok(())
}
