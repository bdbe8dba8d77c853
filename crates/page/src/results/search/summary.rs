//! `summary.json` of a search.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};

use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_core::warning::{Code, Warning};
use realgap_lab::claim::{self, About, BestOfSearch, Claim};
use realgap_lab::prediction::Rerun;
use realgap_lab::search::{
    Baseline, Finalist, KnownParameter, ParameterShare, Search, SearchResults,
};
use realgap_optimization::Ending;

/// One of the best robots, in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BestRobot {
    /// Ranks begin at 1, and survivors come first.
    pub rank: usize,
    /// Position in the search's order.
    pub index: usize,
    /// The files in `best/`, without ending.
    pub file: String,
    /// Number of modules.
    pub modules: usize,
    /// Number of servos.
    pub servos: usize,
    /// This is the fitness with the draws of the search.
    pub search_fitness: Option<f64>,
    /// This is the fitness with fresh seeds.
    pub fitness: Option<f64>,
    /// Median net displacement with fresh seeds, metres.
    pub median_displacement_m: Option<f64>,
    /// 5 % and 95 % quantile of it, metres.
    pub displacement_q05_q95_m: Option<[f64; 2]>,
    /// Net displacement that counts as success, metres: half of what the run without noise does.
    pub success_m: Option<f64>,
    /// Probability of it.
    pub success: Option<f64>,
    /// What the servos give over the distance, J/m.
    pub joules_per_metre: Option<f64>,
    /// That energy per weight: the mechanical cost of transport.
    pub cost_of_transport: Option<f64>,
    /// Whether half and double timestep and substeps, the limit of hard contact and the other joint kind at its own leave its displacement
    /// within the tolerance.
    pub survives: bool,
    /// Largest change under these, as a share; `None` where it failed.
    pub largest_change: Option<f64>,
    /// The settings of the rerun that failed or changed most.
    pub worst_rerun: Option<String>,
}

/// A whole search in short: `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchSummary {
    /// Name of the search.
    pub search: String,
    /// Name of the strategy.
    pub strategy: String,
    /// What was made large.
    pub objective: String,
    /// Unit of fitness.
    pub unit: String,
    /// Whether all robots were simulated.
    pub complete: bool,
    /// Robots simulated.
    pub robots: usize,
    /// Robots of the whole search.
    pub robots_total: usize,
    /// Runs of every robot.
    pub repeats: usize,
    /// Length of every run, seconds.
    pub duration_s: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Robots without fitness, by reason.
    pub failures: BTreeMap<String, usize>,
    /// Best fitness in the search.
    pub best_fitness: Option<f64>,
    /// Cells of the archive that hold a robot, and all cells.
    pub archive: Option<[usize; 2]>,
    /// What the search started from, with the draws that rank the best; `None` where it draws its own robots.
    pub baseline: Option<Baseline>,
    /// Parameters that the search fixes or draws, such as those of the floor, and where their values come from.
    #[serde(default)]
    pub parameters: Vec<KnownParameter>,
    /// The page of the folder whose posterior is drawn from, from the folder of this search; `None` where there is none.
    #[serde(default)]
    pub posterior_page: Option<String>,
    /// How much of the width of the best robot's predicted displacement comes from drawing them; `None` where nothing is drawn.
    #[serde(default)]
    pub parameter_share: Option<ParameterShare>,
    /// The best robots, looked at again; empty where the search was interrupted.
    pub best: Vec<BestRobot>,
    /// Every claim about the best robot, the most important first.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// Engines with their versions: that which judges the finalists, and that which explores.
    pub engine: String,
    /// Version of this crate.
    pub version: String,
    /// What the reader should know.
    // A page takes the warnings of all parts at once, those of other versions included.
    #[serde(deserialize_with = "unread")]
    pub warnings: Vec<Warning>,
}

fn unread<'de, D: Deserializer<'de>>(d: D) -> std::result::Result<Vec<Warning>, D::Error> {
    IgnoredAny::deserialize(d).map(|_| Vec::new())
}

impl BestRobot {
    /// A finalist whose files are called `file`.
    pub(super) fn new(file: String, finalist: &Finalist) -> Self {
        let (robot, finals) = (&finalist.robot, &finalist.finals);
        let displacement_m = finalist.prediction().displacement_m;
        let changes: Option<Vec<f64>> = finals.reruns.iter().map(|r| r.change).collect();
        let size = |rerun: &Rerun| rerun.change.map_or(f64::INFINITY, f64::abs);
        let reruns = finals.reruns.iter();
        let worst = reruns.max_by(|a, b| size(a).total_cmp(&size(b)));
        Self {
            rank: finals.rank,
            index: finalist.evaluated.index,
            file,
            modules: robot.modules().len(),
            servos: robot.summary().servos,
            search_fitness: finals.search_fitness,
            fitness: finals.fitness,
            median_displacement_m: displacement_m.map(|d| d.q50),
            displacement_q05_q95_m: displacement_m.map(|d| [d.q05, d.q95]),
            success_m: finalist.success().map(|s| s.least_displacement_m),
            success: finalist.success().map(|s| s.probability.share),
            joules_per_metre: finals.economy.map(|economy| economy.joules_per_metre),
            cost_of_transport: finals.economy.map(|economy| economy.cost_of_transport),
            survives: finals.survives,
            worst_rerun: worst.map(|rerun| rerun.settings.to_owned()),
            largest_change: changes.map(|all| all.iter().map(|c| c.abs()).fold(0.0, f64::max)),
        }
    }
}

impl SearchSummary {
    pub(super) fn new(
        search: &Search,
        results: &SearchResults,
        best: Vec<BestRobot>,
        (baseline, share): (Option<&Baseline>, Option<ParameterShare>),
    ) -> Result<Self> {
        let strategy = search.strategy();
        let mut failures = BTreeMap::new();
        for failure in results.robots.iter().filter_map(|r| r.failure()) {
            let reason = failure.reason.code().to_owned();
            *failures.entry(reason).or_insert(0) += 1;
        }
        let fitness = results.robots.iter().filter_map(|r| r.fitness());
        let archive = strategy.archive(&results.history())?;
        let summary = Self {
            search: search.name().to_owned(),
            strategy: strategy.name().to_owned(),
            objective: search.objective().label(),
            unit: search.objective().measure.unit().label().to_owned(),
            complete: results.ending == Ending::Complete,
            robots: results.robots.len(),
            robots_total: strategy.budget(),
            repeats: search.repeats(),
            duration_s: search.duration_s(),
            seed: search.seed(),
            failures,
            best_fitness: fitness.reduce(f64::max),
            archive: archive.map(|archive| [archive.elites().len(), archive.cells().len()]),
            warnings: warnings(search, &best, baseline),
            baseline: baseline.cloned(),
            parameters: search.known_parameters()?,
            parameter_share: share,
            posterior_page: None,
            best,
            claims: Vec::new(),
            engine: search.engines(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        Ok(summary)
    }

    /// The summary with the claims that follow from its numbers, and with those about how far the best robot gets.
    #[must_use]
    pub(crate) fn with_claims(mut self, of_best: &[Claim]) -> Self {
        let survivors = self.best.iter().filter(|robot| robot.survives).count();
        let first = self.best.first().map(|robot| BestOfSearch {
            robot: &robot.file,
            fitness: robot.fitness,
            unit: Unit::by_label(&self.unit).unwrap_or(Unit::One),
            objective: &self.objective,
            survives: robot.survives,
            survivors: (survivors, self.best.len()),
            baseline: self.baseline.as_ref().and_then(|base| base.fitness),
        });
        let odds = of_best.iter().filter(|claim| claim.about == About::Success);
        let mut claims = claim::search(first, self.complete);
        claims.extend(odds.cloned());
        self.claims = claims;
        self
    }
}

fn warnings(search: &Search, best: &[BestRobot], baseline: Option<&Baseline>) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if search.noise().is_zero() && search.uncertain().is_empty() {
        warnings.push(Code::NoNoise.warning(
            "all repeats are the same run: the best robot is the best for one set of conditions, and its uncertainty is unknown",
        ));
    }
    if !best.is_empty() && best.iter().all(|robot| !robot.survives) {
        warnings.push(Code::NoSurvivor.warning(
            "no finalist walks the same under other solver settings: the result may be an artefact of the simulation",
        ));
    }
    let fitness = baseline.and_then(|baseline| baseline.fitness);
    let again = best.iter().filter_map(|robot| robot.fitness);
    if let (Some(start), Some(found)) = (fitness, again.reduce(f64::max))
        && found <= start
    {
        warnings.push(Code::BaselineNotBeaten.warning(
            "no finalist is better than the robot that the search started from, on seeds that chose neither of them",
        ));
    }
    warnings
}
