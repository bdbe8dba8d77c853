//! Tuning: an optimizer chooses the points, and every trial is stored as soon as it is finished.

use std::borrow::Cow;

use crate::calibration::answer::INFERRING;
use crate::calibration::exploration::information_gain::FitPrecision;
use crate::calibration::exploration::least_squares::LeastSquaresFit;
use crate::calibration::exploration::trial_sink::{RunDescription, TrialSink};
use crate::calibration::exploration::tune_problem::{brief, first_design};
use crate::calibration::exploration::wave::with_waves;
use crate::calibration::study::split::fold;
use crate::calibration::{
    Answer, InformationGain, Method, PointScore, Scores, Split, Study, Termination, Tuned,
};
use realgap_core::statistics::median;
use realgap_core::{Advice, Error, Result};
use realgap_optimization::{
    Batch, Ending, EvaluatedPoint, History, OptimizationProblem, Optimizer, Proposal, RunOptions,
    UnitPoint, default_optimizer, drive, space_filling,
};
use realgap_path::comparison::Basis;
use realgap_store::{Fingerprint, Mode, Part, Place, Trial};

/// Options of a tuning.
#[derive(Debug, Clone, Copy)]
pub struct TuneOptions {
    /// The optimizer that chooses the points.
    pub optimizer: &'static dyn Optimizer,
    /// Most simulations of the whole study, the first design included.
    pub budget: usize,
    /// Number of points in a row without an improvement after which the tuning stops.
    pub patience: Option<usize>,
}

impl Default for TuneOptions {
    /// A hundred points that CMA-ES chooses.
    fn default() -> Self {
        Self {
            optimizer: default_optimizer(),
            budget: 100,
            patience: None,
        }
    }
}

impl Study {
    /// Simulates the points that an optimizer asks for. The answer has the best point, the confidence set and a verdict per
    /// parameter.
    ///
    /// A metric with a basis gets it from the recordings and a space-filling first design; it stays the same from then on. The
    /// answer depends on the study, the optimizer, its seed and the budget, not on the number of threads.
    ///
    /// # Errors
    /// A budget that does not hold the first design and one batch, or a metric that cannot compare the paths.
    pub fn tune(&self, options: &TuneOptions, run: &RunOptions<'_>) -> Result<Answer> {
        tune(self, None, options, run)
    }

    /// As [`Study::tune`], with every trial stored in a folder as soon as it is finished: the answer has the same bits however
    /// often the run was interrupted and resumed. A larger budget continues where a smaller one ended; a smaller one uses the
    /// stored trials.
    ///
    /// # Errors
    /// As [`Study::tune`]; a folder in use, results of another study in it, a full disk.
    pub fn tune_into<'a>(
        &self,
        place: impl Into<Place<'a>>,
        mode: Mode,
        options: &TuneOptions,
        run: &RunOptions<'_>,
    ) -> Result<Answer> {
        tune(self, Some((place.into(), mode)), options, run)
    }

    /// Everything that decides the results of a tuning.
    pub(crate) fn tune_fingerprint(&self, options: &TuneOptions) -> Fingerprint {
        let fingerprint = self
            .fingerprint()
            .with("optimizer", options.optimizer.name())
            .with("first design", first_design(self, options));
        if options.optimizer.depends_on_budget() {
            fingerprint.with("budget", options.budget)
        } else {
            fingerprint
        }
    }

    /// Simulates one worker's share of the current batch of a distributed tuning and stops there. The ending is "interrupted"
    /// unless all shares are merged already.
    ///
    /// # Errors
    /// As [`Study::tune_into`].
    pub(crate) fn tune_part(
        &self,
        part: &mut Part,
        options: &TuneOptions,
        run: &RunOptions<'_>,
    ) -> Result<Ending> {
        let study = tuned(self, options);
        let mut tuning = Tuning::with(&study, TrialSink::Part(part), options, run)?;
        Ok(match tuning.search()? {
            Termination::Interrupted => Ending::Interrupted,
            _ => Ending::Complete,
        })
    }
}

/// The study as it is tuned: with its own setting alone where an optimizer takes differences of runs.
fn tuned<'a>(study: &'a Study, options: &TuneOptions) -> Cow<'a, Study> {
    match options.optimizer.needs_errors() {
        true => Cow::Owned(study.with_own_setting()),
        false => Cow::Borrowed(study),
    }
}

fn tune(
    study: &Study,
    place: Option<(Place<'_>, Mode)>,
    options: &TuneOptions,
    run: &RunOptions<'_>,
) -> Result<Answer> {
    let study = &*tuned(study, options);
    let mut tuning = Tuning::open(study, place, options, run)?;
    let folds = match study.definition().split {
        Some(Split::Folds(folds)) => folds,
        _ => 0,
    };
    tuning.shown = (0, (folds + 1) * options.budget);
    let termination = tuning.search()?;
    let ending = match termination {
        Termination::Interrupted => Ending::Interrupted,
        _ => Ending::Complete,
    };
    let scores = tuning.scores()?;
    tuning.sink.score(&scores.runs)?;
    tuning.sink.end(ending)?;
    let evaluated = tuning.told.len();
    let history = tuning.history();
    let linearisations = options.optimizer.linearisations(&tuning.brief, &history);
    let warning = options.optimizer.warning(&tuning.brief, &history);
    run.step(INFERRING, 0);
    let known = run.install(|| {
        let problem = (&tuning.brief, history.evaluated);
        LeastSquaresFit::new((study, run), problem, &linearisations, (&scores, ending))
    })??;
    let method = Method::Tune(Tuned {
        optimizer: options.optimizer.name(),
        budget: tuning.budget,
        design: tuning.design.len(),
        evaluated,
        termination,
        least_squares: known
            .as_ref()
            .map_or_else(Vec::new, |known| known.estimates.clone()),
        agreement: known.as_ref().map(LeastSquaresFit::agreement),
        lowest_score: known.as_ref().and_then(|known| {
            let lowest = known.scores.ranked().first().copied()?;
            let lowest = (known.scores.best != Some(lowest)).then_some(lowest)?;
            known.scores.points[lowest].score
        }),
        motions: match (&known, linearisations.first()) {
            (Some(known), Some(best)) => tuning.motions(&known.precision, best.indices)?,
            _ => Vec::new(),
        },
    });
    let refits = match ending {
        Ending::Complete if folds > 0 => {
            let known = tuning.sink.trials()?;
            refits(study, options, run, folds, &known)?
        }
        _ => None,
    };
    let doubts = known
        .as_ref()
        .map_or_else(Vec::new, LeastSquaresFit::warnings);
    let mut answer = run.install(|| {
        let scores = match ending {
            // Least squares end at a known minimum, so that no waves are needed.
            Ending::Complete if known.is_none() => with_waves((study, run), scores)?,
            _ => match &known {
                Some(known) => known.scores.clone(),
                None => scores,
            },
        };
        Answer::new((study, run), method, ending, scores, refits, known)
    })??;
    answer
        .report
        .warnings
        .extend(warning.into_iter().chain(doubts));
    Ok(answer)
}

/// The best point of the same tuning without the recordings of each fold, in memory; trials in `known` are not simulated again.
/// `None` where the tuning was interrupted, or where a fold has no point with a score.
fn refits(
    study: &Study,
    options: &TuneOptions,
    run: &RunOptions<'_>,
    folds: usize,
    known: &[Trial],
) -> Result<Option<Vec<PointScore>>> {
    let definition = study.definition();
    let recordings = definition.recordings.len();
    let mut best = Vec::new();
    for number in 0..folds {
        let study = study.without(&fold(recordings, definition.seed, folds, number));
        let mut tuning = Tuning::open(&study, None, options, run)?;
        tuning.known = known;
        tuning.shown = ((number + 1) * options.budget, (folds + 1) * options.budget);
        if tuning.search()? == Termination::Interrupted {
            return Ok(None);
        }
        let scores = tuning.scores()?;
        match scores.best {
            Some(winner) => best.push(scores.points[winner].clone()),
            None => return Ok(None),
        }
    }
    Ok(Some(best))
}

struct Tuning<'a> {
    study: &'a Study,
    /// Most points: the budget, or the number of stored trials if that is larger.
    budget: usize,
    options: &'a TuneOptions,
    brief: OptimizationProblem,
    run: &'a RunOptions<'a>,
    sink: TrialSink<'a>,
    design: Vec<UnitPoint>,
    basis: Option<Basis>,
    told: Vec<EvaluatedPoint>,
    /// Scores so far, with the numbers of their trials.
    seen: Vec<(usize, f64)>,
    best: Option<f64>,
    since_best: usize,
    /// Trials of the same study by an earlier tuning, by index.
    known: &'a [Trial],
    /// For the progress: the number of points before these, and of all.
    shown: (usize, usize),
}

impl<'a> Tuning<'a> {
    fn open(
        study: &'a Study,
        place: Option<(Place<'_>, Mode)>,
        options: &'a TuneOptions,
        run: &'a RunOptions<'a>,
    ) -> Result<Self> {
        brief(study, options)?;
        let kept = RunDescription {
            study,
            fingerprint: study.tune_fingerprint(options),
            kind: "tune",
            expected: options.budget,
        };
        Self::with(study, TrialSink::open(&kept, place)?, options, run)
    }

    fn with(
        study: &'a Study,
        sink: TrialSink<'a>,
        options: &'a TuneOptions,
        run: &'a RunOptions<'a>,
    ) -> Result<Self> {
        let brief = brief(study, options)?;
        let mut design = space_filling(
            brief.dimensions(),
            0,
            first_design(study, options),
            brief.seed,
        );
        if let (Some(first), Some(own)) = (design.first_mut(), &brief.own) {
            first.clone_from(own);
        }
        Ok(Self {
            study,
            budget: options.budget.max(sink.rows().finished()?.len()),
            options,
            design,
            brief,
            run,
            sink,
            basis: None,
            told: Vec::new(),
            seen: Vec::new(),
            best: None,
            since_best: 0,
            known: &[],
            shown: (0, options.budget),
        })
    }

    fn search(&mut self) -> Result<Termination> {
        let design = self.design.clone();
        if self.evaluate(&design)? == Ending::Interrupted {
            return Ok(Termination::Interrupted);
        }
        let trials = self.sink.rows().rows_within(0..design.len())?;
        let rows = trials.iter().flat_map(|trial| &trial.cases);
        self.basis = self.study.basis(rows)?;
        self.tell(&design)?;
        let TuneOptions {
            optimizer,
            patience,
            ..
        } = *self.options;
        loop {
            if self.told.len() >= self.budget {
                return Ok(Termination::Budget);
            }
            if patience.is_some_and(|most| self.since_best >= most) {
                return Ok(Termination::NoImprovement);
            }
            let mut candidates = match optimizer.propose(&self.brief, &self.history())? {
                Proposal::Evaluate(candidates) => candidates,
                Proposal::Exhausted => return Ok(Termination::Exhausted),
            };
            candidates.truncate(self.budget - self.told.len());
            if self.evaluate(&candidates)? == Ending::Interrupted {
                return Ok(Termination::Interrupted);
            }
            self.tell(&candidates)?;
        }
    }

    fn history(&self) -> History<'_> {
        let (design, evaluated) = self.told.split_at(self.design.len().min(self.told.len()));
        History { design, evaluated }
    }

    /// The information gain of each recording, from the finite differences that least squares took.
    fn motions(
        &self,
        known: &FitPrecision,
        indices: (usize, usize),
    ) -> Result<Vec<InformationGain>> {
        let first = self.design.len();
        let (at, moved) = (first + indices.0, first + indices.1);
        let rows = self.sink.rows();
        let mut trials = rows.rows_within(at..at + 1)?;
        trials.extend(rows.rows_within(moved..moved + self.brief.dimensions())?);
        let around = trials.iter();
        let around = around.map(|trial| (&self.told[trial.index].point, trial));
        Ok(self.study.motions(known, &around.collect::<Vec<_>>()))
    }

    /// Evaluates the candidates that follow the evaluated points; stored ones are not simulated again.
    fn evaluate(&mut self, candidates: &[UnitPoint]) -> Result<Ending> {
        let offset = self.told.len();
        let (before, total) = self.shown;
        let grid = &self.study.definition().grid;
        let batch = Batch::new(offset + candidates.len(), self.run);
        drive(
            &batch,
            self.sink.rows_mut(),
            |index| {
                let values = grid.values_at(&candidates[index - offset]);
                match self.known.get(index) {
                    Some(trial) if trial.values == values => Ok(trial.clone()),
                    _ => {
                        let has_errors = self.options.optimizer.needs_errors();
                        self.study.simulate_trial(index, values, has_errors)
                    }
                }
            },
            |done| self.run.tell(before + done, total, self.best),
        )
    }

    /// Scores the points that were just evaluated and adds them to the history.
    fn tell(&mut self, candidates: &[UnitPoint]) -> Result<()> {
        let offset = self.told.len();
        let trials = self
            .sink
            .rows()
            .rows_within(offset..offset + candidates.len())?;
        let scores = Scores::with_basis(self.study, &trials, self.basis.clone())?;
        let scored = scores.runs.iter();
        self.seen
            .extend(scored.filter_map(|run| Some((run.index, run.score?))));
        let (settings, shifts) = (self.study.settings(), self.engine_shifts());
        let grid = &self.study.definition().grid;
        for ((point, scored), trial) in candidates.iter().zip(&scores.runs).zip(&trials) {
            // An optimizer from outside may propose other points when it is asked again.
            if grid.values_at(point) != trial.values {
                return Err(Error::conflict(
                    "the stored points are not those that the optimizer asks for",
                )
                .found(format!("point {}", trial.index))
                .hint("the same history must give the same proposal")
                .advise(Advice::Restart));
            }
            let engine = usize::from(settings.engine_of_trial(trial.index) < 0.0);
            let score = scored.score.map(|score| score - shifts[engine]);
            self.notice(score);
            let mut errors = Vec::new();
            if self.options.optimizer.needs_errors()
                && let Some((own, blocks)) = self.study.errors_of(trial)
            {
                (errors, self.brief.error_blocks) = (own, blocks);
            }
            self.told.push(EvaluatedPoint {
                point: point.clone(),
                score,
                errors,
            });
        }
        self.sink.score(&scores.runs)?;
        let (before, total) = self.shown;
        self.run.tell(before + self.told.len(), total, self.best);
        Ok(())
    }

    /// Shift of the scores of the study's own engine and of the second, which is subtracted so that the optimizer compares points
    /// and not engines: half of the difference between the medians of both engines' scores so far. The emulator models the
    /// difference by itself and gets unshifted scores.
    fn engine_shifts(&self) -> [f64; 2] {
        let settings = self.study.settings();
        let median_of = |engine: f64| {
            let scores = self.seen.iter();
            let own = scores.filter(|(index, _)| settings.engine_of_trial(*index) == engine);
            let own: Vec<f64> = own.map(|(_, score)| *score).collect();
            (!own.is_empty()).then(|| median(&own))
        };
        let both = median_of(1.0).zip(median_of(-1.0));
        let half = both.map_or(0.0, |(own, second)| 0.5 * (own - second));
        [half, -half]
    }

    fn notice(&mut self, score: Option<f64>) {
        match score {
            Some(score) if self.best.is_none_or(|best| score < best) => {
                self.best = Some(score);
                self.since_best = 0;
            }
            _ => self.since_best += 1,
        }
    }

    /// Scores of all evaluated points, also of an interrupted batch.
    fn scores(&self) -> Result<Scores> {
        let trials = self.sink.trials()?;
        match &self.basis {
            Some(basis) => Scores::with_basis(self.study, &trials, Some(basis.clone())),
            None => Scores::new(self.study, &trials),
        }
    }
}
