//! Work that can be shared among shards.

use std::time::Instant;

use super::{Cost, Merged, Plan, Round};
use crate::calibration::{Repeatable, Study, TuneOptions};
use crate::prediction::gap::{GapOptions, StudyGap};
use crate::prediction::{EnsembleOptions, EnsembleReport};
use crate::search::Search;
use realgap_core::{Error, Result};
use realgap_optimization::{Ending, RunOptions};
use realgap_store::{Fingerprint, FolderLock, Part, RobotRow, RunRow, Share, Table, Trial};

/// A long computation whose rows can be simulated by several workers.
pub enum Work {
    /// A sweep: all points of a study's grid, and the waves after it.
    Sweep(Box<Study>),
    /// A tuning: the points that an optimizer asks for.
    Tune(Box<Study>, TuneOptions),
    /// A search: the robots that a strategy proposes.
    Search(Box<Search>),
    /// Repeats of a study under its noise.
    Ensemble(Box<Repeatable>, EnsembleOptions),
    /// Runs of a study, without noise and under it, for its gap.
    Gap(Box<Study>, GapOptions),
}

/// Runs are measured until they have taken so many seconds together.
const MEASURED_S: f64 = 2.0;
/// Most runs that are measured.
const MOST_MEASURED: usize = 12;

/// Does the same with every kind of work, whatever its rows are; `follow` simulates the share of the current batch that belongs
/// to a worker's part.
macro_rules! with_rows {
    ($work:expr, $follow:ident => $done:expr) => {
        match $work {
            Work::Sweep(study) => {
                let $follow = |part: &mut _, run: &_| study.sweep_part(part, run);
                $done
            }
            Work::Tune(study, options) => {
                let $follow = |part: &mut _, run: &_| study.tune_part(part, options, run);
                $done
            }
            Work::Search(search) => {
                let $follow = |part: &mut _, run: &_| search.run_part(part, run);
                $done
            }
            Work::Ensemble(study, options) => {
                let $follow = |part: &mut Part<RunRow>, run: &_| {
                    EnsembleReport::part(study, options, part, run)
                };
                $done
            }
            Work::Gap(study, options) => {
                let $follow =
                    |part: &mut Part<RunRow>, run: &_| StudyGap::part(study, options, part, run);
                $done
            }
        }
    };
}

impl Work {
    /// Name of the study or search.
    pub fn name(&self) -> &str {
        match self {
            Self::Sweep(study) | Self::Tune(study, _) => &study.definition().name,
            Self::Search(search) => search.name(),
            Self::Ensemble(study, _) => &study.definition.name,
            Self::Gap(study, _) => &study.definition().name,
        }
    }

    /// Everything that decides the results.
    pub fn fingerprint(&self) -> Fingerprint {
        match self {
            Self::Sweep(study) => study.fingerprint(),
            Self::Tune(study, options) => study.tune_fingerprint(options),
            Self::Search(search) => search.fingerprint(),
            Self::Ensemble(study, options) => EnsembleReport::fingerprint(study, options),
            Self::Gap(study, options) => StudyGap::fingerprint(study, options),
        }
    }

    /// Rows of the whole run; of a tuning or search the largest possible number.
    pub fn rows(&self) -> usize {
        match self {
            Self::Sweep(study) => study.sweep_runs(),
            Self::Tune(_, options) => options.budget,
            Self::Search(search) => search.strategy().budget(),
            Self::Ensemble(study, options) => study.cases.len() * options.repeats,
            Self::Gap(study, options) => StudyGap::runs(study, options),
        }
    }

    /// Simulates the rows of one shard in the current round. Returns how many of them are left: none, unless the run was stopped.
    ///
    /// # Errors
    /// A shard that another worker is simulating, that is damaged or belongs to another plan; a full disk; the errors of a
    /// simulation.
    pub fn run_shard(&self, plan: &Plan, share: Share, run: &RunOptions<'_>) -> Result<usize> {
        let round = plan.round()?;
        plan.must_be_of(&self.fingerprint())?;
        if round.complete || round.rows_of(share) == 0 {
            return Ok(0);
        }
        let folder = plan.shard_folder(round.number, share.number());
        let lock = FolderLock::make(&folder)?;
        with_rows!(self, follow => one_shard(plan, round, &lock, share, |part| follow(part, run)))
    }

    /// Merges the rows of the shards and finds the rows that are needed next. Returns the result of merging, the round before it,
    /// and the current one.
    ///
    /// # Errors
    /// As [`Work::run_shard`]; results that cannot be written.
    pub fn merge(&self, plan: &Plan, run: &RunOptions<'_>) -> Result<(Merged, Round, Round)> {
        plan.must_be_of(&self.fingerprint())?;
        let round = if plan.has_round() {
            plan.round()?
        } else {
            let (asked, missing) = self.missing(plan, run)?;
            Round::found_again(plan.last_round(), asked, &missing)
        };
        if round.complete {
            return Ok((Merged::default(), round, round));
        }
        let merged = match self {
            Self::Sweep(_) | Self::Tune(..) => plan.absorb::<Trial>(&round),
            Self::Search(_) => plan.absorb::<RobotRow>(&round),
            Self::Ensemble(..) | Self::Gap(..) => plan.absorb::<RunRow>(&round),
        }?;
        let (asked, missing) = self.missing(plan, run)?;
        let next = round.after(asked, &missing);
        plan.write_round(&next)?;
        Ok((merged, round, next))
    }

    /// The first round of a plan.
    ///
    /// # Errors
    /// As [`Work::run_shard`].
    pub fn begin(&self, plan: &Plan, run: &RunOptions<'_>) -> Result<Round> {
        let (asked, _) = self.missing(plan, run)?;
        let round = Round::first(asked);
        plan.write_round(&round)?;
        Ok(round)
    }

    /// How many rows are requested in the current round and the earlier ones, and which of them are not merged.
    fn missing(&self, plan: &Plan, run: &RunOptions<'_>) -> Result<(usize, Vec<usize>)> {
        with_rows!(self, follow => look(plan, |part| follow(part, run)))
    }

    /// Measures a few runs on one thread.
    ///
    /// # Errors
    /// As [`Work::run_shard`].
    pub fn measure(&self) -> Result<Cost> {
        let run = RunOptions {
            jobs: 1,
            ..RunOptions::default()
        };
        run.install(|| match self {
            Self::Sweep(study) | Self::Tune(study, _) => {
                let points = study.definition().grid.len();
                self.cost(points, |n| Ok(study.simulate(n)?.stored_bytes()))
            }
            Self::Search(search) => {
                let genomes = search.strategy().propose(&[])?;
                self.cost(genomes.len(), |n| {
                    let robot = search.evaluate(n, &genomes[n])?;
                    Ok(RobotRow::from(&robot).stored_bytes())
                })
            }
            Self::Ensemble(study, options) => self.cost(self.rows(), |n| {
                Ok(EnsembleReport::repeat(study, options, n)?.stored_bytes())
            }),
            Self::Gap(study, options) => self.cost(self.rows(), |n| {
                Ok(StudyGap::simulate(study, options, n)?.stored_bytes())
            }),
        })?
    }

    /// The mean cost of some of so many rows, spread over all of them; `make` simulates one and returns its size.
    fn cost(&self, rows: usize, make: impl Fn(usize) -> Result<usize>) -> Result<Cost> {
        let count = MOST_MEASURED.min(rows.max(1));
        let begun = Instant::now();
        let (mut measured, mut bytes) = (0, 0);
        for step in 0..count {
            // The middle of each of so many equal parts; the outermost ones come first, from both ends in turn.
            let place = if step % 2 == 0 {
                step / 2
            } else {
                count - 1 - step / 2
            };
            bytes += make((2 * place + 1) * rows / (2 * count))?;
            measured += 1;
            if begun.elapsed().as_secs_f64() > MEASURED_S {
                break;
            }
        }
        Ok(Cost {
            measured,
            run_cpu_s: begun.elapsed().as_secs_f64() / measured as f64,
            run_bytes: bytes as f64 / measured as f64,
            runs: self.rows(),
        })
    }
}

/// Simulates the rows of a shard, and returns how many are left.
fn one_shard<R: Table>(
    plan: &Plan,
    round: Round,
    lock: &FolderLock,
    share: Share,
    follow: impl Fn(&mut Part<R>) -> Result<Ending>,
) -> Result<usize> {
    let mut part = Part::<R>::open(&plan.store(), lock, share, &plan.fingerprint())?;
    // The rows of this round are wanted only while it is still the current one.
    if plan.round()? != round {
        return Err(Error::conflict("the round was merged meanwhile")
            .at_file(plan.folder())
            .hint("run the shard again: the next round is under way"));
    }
    follow(&mut part)?;
    part.close()
}

/// How many rows are requested, and which are not merged.
fn look<R: Table>(
    plan: &Plan,
    follow: impl Fn(&mut Part<R>) -> Result<Ending>,
) -> Result<(usize, Vec<usize>)> {
    let mut part = Part::<R>::look(&plan.store(), &plan.fingerprint())?;
    follow(&mut part)?;
    Ok((part.asked(), part.missing()?))
}
