//! The report of an ensemble: the forecast of a study's repeats under noise, and whether its recordings agree with it.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::ensemble::{self, Coverage, Draws, Ensemble, Forecast, Reality, Recall};
use super::kept::{row_of, runs_in};
use super::{ModelError, ModelOptions, UncertainParameters};
use crate::calibration::{RepeatCase, Repeatable, by_name, few_recordings};
use crate::claim::{self, About, Claim};
use realgap_core::file::sha256;
use realgap_core::statistics::Proportion;
use realgap_core::{Result, Warning};
use realgap_optimization::{Batch, Ending, Progress, RunOptions, drive};
use realgap_path::trajectory::{Prepared, Source};
use realgap_simulation::{Noise, Run};
use realgap_store::{Fingerprint, RunRow, Storage};

/// Most cases that are printed one by one.
const CASES_PRINTED: usize = 3;
/// Level of the interval of a share of recordings.
const INTERVAL: f64 = 0.95;

/// Options of an ensemble.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleOptions {
    /// Noise of the repeats.
    pub noise: Noise,
    /// Source of the noise, e.g. a file.
    pub noise_from: String,
    /// Repeats of each start.
    pub repeats: usize,
    /// Seed of all draws.
    pub seed: u64,
    /// What the model error is computed from; `None` for no model error.
    pub model: Option<ModelOptions>,
}

/// The repeats of one start.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnsembleCase {
    /// The study's name, or the recording's where every recording has its own start.
    pub case: String,
    /// The repeats themselves; not written with the report.
    #[serde(skip)]
    pub ensemble: Ensemble,
    /// Prepared paths of its recordings, true lengths, metres; not written with the report.
    #[serde(skip)]
    pub real_paths_m: Vec<Vec<[f64; 2]>>,
    /// Summary of the repeats.
    #[serde(rename = "summary")]
    pub forecast: Forecast,
    /// Comparison with the recordings; `None` where there are none.
    pub reality: Option<Reality>,
    /// How far models that are as valid differ; `None` where they were not simulated.
    pub model: Option<ModelError>,
    /// Recordings whose net displacement lies in the range that holds 90 % of further runs in another engine.
    pub in_further_runs: Option<Proportion>,
}

/// The forecast of a study's repeats under noise; its `Display` is a text for readers.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnsembleReport {
    /// Name of the study.
    pub study: String,
    /// Name of the robot.
    pub morphology: String,
    /// Whether all repeats of all starts were simulated.
    pub complete: bool,
    /// Fixed values of the simulation.
    pub parameters: BTreeMap<String, f64>,
    /// Source of the noise.
    pub noise_from: String,
    /// Engine and its version.
    pub engine: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// Where the recordings come from.
    pub source: Source,
    /// All recordings against the ensembles of their starts.
    pub reality: Option<Reality>,
    /// One ensemble a start.
    pub cases: Vec<EnsembleCase>,
    /// Every claim of the report about reality, the most important first; the claim about the displacement is that of the first
    /// start.
    pub claims: Vec<Claim>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
    /// How many of the recordings the values were fitted on; `None` where no fit is known.
    #[serde(skip)]
    pub seen_by_fit: Option<usize>,
}

impl EnsembleReport {
    /// Repeats every start of a study. After a request to stop, no further repeat begins; finished repeats are reported as
    /// incomplete.
    ///
    /// # Errors
    /// Noise or settings that cannot be simulated, no repeats at all.
    pub fn new(
        study: &Repeatable,
        options: &EnsembleOptions,
        run: &RunOptions<'_>,
    ) -> Result<Self> {
        Self::recalling(study, options, &|_| Ok(None), run)
    }

    /// As [`EnsembleReport::new`], from repeats that several workers have simulated ([`EnsembleReport::part`]); repeats that the
    /// store does not have are simulated.
    ///
    /// # Errors
    /// As [`EnsembleReport::new`]; a store that cannot be read, or that holds other repeats.
    pub fn of_store(
        study: &Repeatable,
        options: &EnsembleOptions,
        folder: &Path,
        run: &RunOptions<'_>,
    ) -> Result<Self> {
        let known = runs_in(folder, &Self::fingerprint(study, options))?;
        Self::recalling(study, options, &known, run)
    }

    /// Everything that decides the repeats.
    pub fn fingerprint(study: &Repeatable, options: &EnsembleOptions) -> Fingerprint {
        let definition = &study.definition;
        let cases = study.cases.iter();
        let experiments: String = cases.map(|c| format!("{:?}", c.experiment)).collect();
        let fingerprint = Fingerprint::new()
            .with("realgap", env!("CARGO_PKG_VERSION"))
            .with("engine", study.cases[0].experiment.engine_version())
            .with("study", &definition.name)
            .with("experiments sha256", sha256(experiments.as_bytes()))
            .with("noise", format!("{:?}", options.noise))
            .with("repeats", options.repeats)
            .with("seed", options.seed);
        definition.with_recordings(definition.with_draws(fingerprint))
    }

    /// Simulates one worker's share of the repeats.
    ///
    /// # Errors
    /// As [`EnsembleReport::new`]; a full disk.
    pub fn part(
        study: &Repeatable,
        options: &EnsembleOptions,
        part: &mut impl Storage<RunRow>,
        run: &RunOptions<'_>,
    ) -> Result<Ending> {
        let total = study.cases.len() * options.repeats;
        let batch = Batch::new(total, run);
        let make = |index| Self::repeat(study, options, index);
        drive(&batch, part, make, |done| run.tell(done, total, None))
    }

    /// One repeat, counted over all starts.
    ///
    /// # Errors
    /// As [`EnsembleReport::new`].
    pub fn repeat(study: &Repeatable, options: &EnsembleOptions, index: usize) -> Result<RunRow> {
        let (case, number) = (index / options.repeats, index % options.repeats);
        row_of(index, &Self::run(study, options, case, number as u64)?)
    }

    /// One repeat of a start in full, with the parameters that it draws.
    ///
    /// # Errors
    /// As [`EnsembleReport::new`].
    pub fn run(
        study: &Repeatable,
        options: &EnsembleOptions,
        case: usize,
        number: u64,
    ) -> Result<Run> {
        let uncertain = UncertainParameters::of_draws(&study.definition.draws);
        let experiment = uncertain.apply(&study.cases[case].experiment, options.seed, number)?;
        ensemble::repeat(&experiment, &options.noise, options.seed, number)
    }

    fn recalling(
        study: &Repeatable,
        options: &EnsembleOptions,
        recall: Recall<'_>,
        run: &RunOptions<'_>,
    ) -> Result<Self> {
        let total = study.cases.len() * options.repeats;
        let uncertain = UncertainParameters::of_draws(&study.definition.draws);
        let mut ensembles: Vec<(&RepeatCase, Ensemble)> = Vec::new();
        for case in &study.cases {
            // A case without a finished repeat is left out, except for the first.
            if run.is_stopped() && !ensembles.is_empty() {
                break;
            }
            let before = ensembles.len() * options.repeats;
            let tell = |progress: Progress| run.tell(before + progress.done, total, None);
            let run = RunOptions {
                progress: Some(&tell),
                ..*run
            };
            let draws = Draws {
                noise: &options.noise,
                uncertain: &uncertain,
                seed: options.seed,
                repeats: options.repeats,
                recall: &|number| recall(before + number),
            };
            let repeats = run.install(|| ensemble::run_each(&case.experiment, &draws, &run))??;
            ensembles.push((case, repeats));
        }
        let mut report = run.install(|| Self::of(study, ensembles, &options.noise_from))??;
        // Where every recording has a start of its own, the model error would cost as much again for each of them.
        if let ([only], [case], Some(model)) =
            (&mut report.cases[..], &study.cases[..], &options.model)
        {
            only.add_model(case, model, run)?;
            if only.model.is_none() && run.is_stopped() {
                report.complete = false;
                report.warnings.push(ModelError::unasked());
            }
        }
        Ok(report)
    }

    fn of(
        study: &Repeatable,
        ensembles: Vec<(&RepeatCase, Ensemble)>,
        noise_from: &str,
    ) -> Result<Self> {
        let definition = &study.definition;
        let complete = ensembles.len() == study.cases.len()
            && ensembles.iter().all(|(_, repeats)| repeats.is_complete());
        let cases = ensembles
            .into_iter()
            .map(|(case, ensemble)| EnsembleCase::new(case, ensemble))
            .collect::<Result<Vec<_>>>()?;
        let parts: Vec<&Reality> = cases.iter().flat_map(|case| &case.reality).collect();
        let mut warnings = study.warnings.clone();
        if let Some(case) = cases.iter().find(|case| case.reality.is_some()) {
            warnings.extend(ensemble::no_camera(&case.ensemble.noise));
        }
        warnings.extend(few_recordings(definition.recordings.len()));
        warnings.extend(cases.iter().flat_map(|case| case.forecast.warnings.clone()));
        warnings.sort();
        warnings.dedup();
        let report = Self {
            study: definition.name.clone(),
            morphology: definition.morphology.name().to_owned(),
            complete,
            parameters: by_name(&definition.set),
            noise_from: noise_from.to_owned(),
            engine: study.cases[0].experiment.engine_version(),
            version: env!("CARGO_PKG_VERSION"),
            source: definition.source(),
            reality: Reality::pooled(&parts),
            cases,
            claims: Vec::new(),
            warnings,
            seen_by_fit: definition.seen_by_fit,
        };
        Ok(report.with_claims())
    }

    /// The report with the claims that follow from its numbers.
    #[must_use]
    pub fn with_claims(mut self) -> Self {
        let first = self.cases.first();
        let reach = first.and_then(|case| claim::reach(&case.forecast));
        let regions = self.reality.iter().flat_map(|r| &r.coverage);
        let regions: Vec<Claim> = regions.map(Coverage::claim).collect();
        let alike = self.reality.as_ref().and_then(|reality| reality.alike);
        let recorded = claim::recorded(&regions, alike.as_ref(), self.source);
        let runs = self.reality.iter().flat_map(|reality| &reality.runs);
        let distances_m: Vec<f64> = runs.map(|run| run.distance_m).collect();
        let gap = claim::beside(&distances_m, claim::called(self.source));
        let against = claim::contradictions(&regions, alike.as_ref(), self.source);
        let trust = claim::trust_of(&self.comparison(distances_m.len(), against));
        let verdict = gap.into_iter().chain(reach).chain([trust]);
        self.claims = verdict.chain(recorded).chain(regions).collect();
        self
    }

    /// What recordings say on whether to trust the repeats.
    fn comparison(&self, recordings: usize, against: Vec<String>) -> claim::Comparison {
        let passed = "nothing contradicts its regions and their confidences";
        claim::Comparison {
            complete: self.complete,
            against,
            tested: (recordings >= claim::FEW).then(|| passed.to_owned()),
            would_tell: match recordings {
                0 => "it is compared with no recording; record runs",
                _ => "there are too few recordings; record the same run again, at least five times",
            }
            .to_owned(),
            seen_by_fit: self.seen_by_fit,
            recordings,
        }
    }

    /// Number of repeats that were simulated, of all starts together.
    pub fn repeats(&self) -> usize {
        self.cases.iter().map(|case| case.forecast.repeats).sum()
    }

    /// Whether no repeat at all was completed.
    pub fn is_lost(&self) -> bool {
        let lost = |case: &EnsembleCase| case.forecast.displacement_m.is_none();
        self.cases.iter().all(lost)
    }
}

impl EnsembleCase {
    fn new(case: &RepeatCase, ensemble: Ensemble) -> Result<Self> {
        let forecast = Forecast::new(&ensemble)?;
        let real: Vec<_> = case.real.iter().map(|(n, p)| (n.as_str(), p)).collect();
        let reality = Reality::new(&ensemble, &forecast, &real)?;
        Ok(Self {
            case: case.name.clone(),
            real_paths_m: case.real.iter().map(|(_, p)| p.xy_m().to_vec()).collect(),
            ensemble,
            forecast,
            reality,
            model: None,
            in_further_runs: None,
        })
    }

    fn add_model(
        &mut self,
        case: &RepeatCase,
        options: &ModelOptions,
        run: &RunOptions<'_>,
    ) -> Result<()> {
        let quiet = RunOptions {
            progress: None,
            ..*run
        };
        let (ensemble, forecast) = (&self.ensemble, &self.forecast);
        self.model = ModelError::new(&case.experiment, ensemble, forecast, options, &quiet)?;
        let further_run_m = self.model.as_ref().and_then(|model| model.further_run_m);
        if let (Some(range), false) = (further_run_m, case.real.is_empty()) {
            let inside = |path: &Prepared| range.contains(path.net_displacement_m());
            let inside = case.real.iter().map(|(_, path)| inside(path));
            self.in_further_runs = Some(Proportion::of(inside, INTERVAL));
        }
        Ok(())
    }
}

impl fmt::Display for EnsembleReport {
    /// Writes the verdict, each start where there are few, then all recordings against the ensembles.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&claim::verdict_lines(&self.claims))?;
        if self.cases.len() <= CASES_PRINTED {
            for (index, case) in self.cases.iter().enumerate() {
                if index > 0 {
                    writeln!(f)?;
                }
                write!(f, "{case}")?;
            }
        } else {
            write!(
                f,
                "{}: {} recordings with an ensemble of {} repeats each",
                self.study,
                self.cases.len(),
                self.cases[0].forecast.repeats
            )?;
        }
        if let Some(reality) = &self.reality {
            write!(f, "\n{reality}")?;
        }
        let mut said = self.claims.iter().filter(|c| c.about == About::Ensemble);
        said.try_for_each(|claim| write!(f, "\n  {claim}"))
    }
}

impl fmt::Display for EnsembleCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let forecast = &self.forecast;
        write!(
            f,
            "{}: {} repeats of {} s, {:.1} CPU s{}",
            self.case,
            forecast.repeats,
            forecast.duration_s,
            forecast.cpu_s,
            forecast.numbers(),
        )?;
        if let Some(model) = &self.model {
            write!(f, "{model}")?;
        }
        if let Some(held) = &self.in_further_runs {
            write!(f, ": {} of {} recordings", held.count, held.trials)?;
        }
        let over_models = self.model.as_ref().map(ModelError::behaviour_shares);
        write!(
            f,
            "\n{}",
            forecast.behaviour_table(self.reality.as_ref(), over_models.as_deref())
        )
    }
}
