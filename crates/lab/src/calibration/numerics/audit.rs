//! The numerical audit: how much the best score depends on timestep, substeps and contact stiffness.

use serde::{Deserialize, Serialize};

use crate::calibration::Profile;
use crate::calibration::{Scores, Study};
use realgap_core::Result;
use realgap_core::unit::counted;
use realgap_optimization::RunOptions;
use realgap_simulation::{Experiment, Solver};

/// The best point again, with one numerical setting changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AuditRow {
    /// What was changed, and to what.
    pub setting: String,
    /// Whether the setting is coarser than the study's own: it shows how much accuracy there is to lose, not how sure the answer
    /// is.
    pub coarser: bool,
    /// The score with this setting, in the study's own engine, or in the second one where the recordings speak against the own
    /// one; `None` where the run diverged.
    pub score: Option<f64>,
    /// `score` minus the best score; where there are two engines, minus the mean of that engine's settings.
    pub change: Option<f64>,
}

/// How much the best score depends on timestep, substeps and contact stiffness, which recordings cannot determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Audit {
    /// Half and double timestep, half and double substeps, and the limit of hard contact.
    pub rows: Vec<AuditRow>,
    /// Largest absolute change by a setting that is no coarser than the study's.
    pub largest_change: f64,
    /// Largest absolute change by a coarser setting.
    pub largest_coarser_change: f64,
    /// Parameters whose whole searched range changes the best score by less than `largest_change`.
    pub unresolved: Vec<String>,
    /// Parameters whose values in the confidence set differ in score by less than `largest_change`.
    pub shaken: Vec<String>,
}

/// Longest timestep that an experiment may have, seconds.
const LONGEST_S: f64 = 0.1;

type Change = Box<dyn Fn(&mut Experiment) + Sync>;

impl Audit {
    /// Re-runs the best point; `None` where nothing has a score.
    ///
    /// # Errors
    /// As [`Study::simulate`].
    pub fn new(
        (study, run): (&Study, &RunOptions<'_>),
        scores: &Scores,
        profiles: &[Profile],
    ) -> Result<Option<Self>> {
        let Some(best) = scores.best else {
            return Ok(None);
        };
        let point = &scores.points[best];
        // The difference between the engines is reported elsewhere, so only runs of one engine are compared.
        let settings = study.settings();
        let second = settings.second.filter(|_| scores.engine < 0.0);
        let runs = scores.runs_at(&point.values);
        let runs: Vec<(usize, f64)> = runs
            .filter_map(|run| Some((run.index, run.score?)))
            .collect();
        let best = settings
            .second
            .and_then(|_| settings.engine_means(&runs)[usize::from(second.is_some())]);
        let best = best.or(point.score);
        let experiment = study.experiment(0, &point.values)?;
        if !experiment.has_engine() {
            return Ok(None);
        }
        let solver = experiment.solver;
        let mut rows = Vec::new();
        let changes = changes(&solver);
        let step = run.step("auditing the numerics", changes.len());
        for (setting, coarser, change) in changes {
            let in_engine = |experiment: &mut Experiment| {
                if let Some(second) = second {
                    experiment.solver.engine = second;
                }
                change(experiment);
            };
            let trial = study.simulate_changed(&point.values, in_engine, false)?;
            step.count();
            let score = Scores::with_basis(study, &[trial], scores.basis.clone())?.points[0].score;
            rows.push(AuditRow {
                setting,
                coarser,
                score,
                change: score.zip(best).map(|(now, best)| now - best),
            });
        }
        let largest = |coarser: bool| {
            let rows = rows.iter().filter(|row| row.coarser == coarser);
            let changes = rows.filter_map(|row| row.change);
            changes.fold(0.0, |largest: f64, change| largest.max(change.abs()))
        };
        let (largest_change, largest_coarser_change) = (largest(false), largest(true));
        let names = |spread: fn(&Profile) -> f64| -> Vec<String> {
            let less = profiles.iter().filter(|p| spread(p) < largest_change);
            less.map(|profile| profile.parameter.name.to_owned())
                .collect()
        };
        let (unresolved, shaken) = (names(Profile::spread), names(Profile::spread_within));
        Ok(Some(Self {
            rows,
            largest_change,
            largest_coarser_change,
            unresolved,
            shaken,
        }))
    }

    /// The setting, no coarser than the study's own, that changes the score most, and its change.
    pub fn worst(&self) -> Option<(&str, f64)> {
        let rows = self.rows.iter().filter(|row| !row.coarser);
        let changed = rows.filter_map(|row| Some((row.setting.as_str(), row.change?)));
        changed.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

/// The settings of the audit: name, whether it is coarser, and the change of the experiment.
fn changes(solver: &Solver) -> Vec<(String, bool, Change)> {
    let mut changes: Vec<(String, bool, Change)> = Vec::new();
    for factor in [0.5, 2.0] {
        let timestep_s = solver.timestep_s * factor;
        if timestep_s <= LONGEST_S {
            changes.push((
                format!("timestep {factor} times: {timestep_s:.3e} s"),
                factor > 1.0,
                Box::new(move |e| e.solver.timestep_s = timestep_s),
            ));
        }
    }
    for substeps in [solver.substeps / 2, solver.substeps * 2] {
        if (1..=256).contains(&substeps) {
            changes.push((
                format!(
                    "{} instead of {}",
                    counted(substeps, "substep"),
                    solver.substeps
                ),
                substeps < solver.substeps,
                Box::new(move |e| e.solver.substeps = substeps),
            ));
        }
    }
    // Convergence in the timestep alone does not prove a result correct: a contact that is too soft converges, too. So the
    // contact is made harder as well.
    changes.push((
        "limit of hard contact and short steps".to_owned(),
        false,
        Box::new(|e| *e = e.at_limit(e.joint_kind())),
    ));
    changes
}
