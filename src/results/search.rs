//! What a search leaves in a folder: tables, the best robots with their cards, a summary.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::search_picture::draw;
use super::table::write as write_table;
use super::write_report;
use crate::error::{Error, Result};
use crate::export::{Robot, format_named};
use crate::file::write_atomic;
use crate::optimization::Ending;
use crate::prediction::Rerun;
use crate::robot::genome::Specimen;
use crate::search::{Body, Finalist, Hunt, Judged, Plan, Quarry};
use crate::warning::{Code, Warning};

/// One of the best robots, in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestRobot {
    /// From 1; survivors first.
    pub rank: usize,
    /// Position in the search's order.
    pub index: usize,
    /// The files in `best/`, without ending.
    pub file: String,
    /// Number of modules.
    pub modules: usize,
    /// Number of servos.
    pub servos: usize,
    /// With the draws of the search.
    pub search_fitness: Option<f64>,
    /// With new draws.
    pub fitness: Option<f64>,
    /// Median net displacement with new draws, metres.
    pub median_displacement_m: Option<f64>,
    /// 5 % and 95 % quantile of it, metres.
    pub displacement_q05_q95_m: Option<[f64; 2]>,
    /// Probability of at least half of what the run without noise does.
    pub success: Option<f64>,
    /// Whether half and double timestep and substeps and the other joint kind leave its displacement within the tolerance.
    pub survives: bool,
    /// Largest change under these, as a share; `None` where it failed.
    pub largest_change: Option<f64>,
    /// The settings of the rerun that failed or changed most.
    pub worst_rerun: Option<&'static str>,
}

/// A whole search in short: `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchSummary {
    /// Name of the search.
    pub search: String,
    /// Name of the strategy.
    pub strategy: &'static str,
    /// What was made large.
    pub objective: String,
    /// Unit of fitness.
    pub unit: &'static str,
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
    pub failures: BTreeMap<&'static str, usize>,
    /// Best fitness in the search.
    pub best_fitness: Option<f64>,
    /// Cells of the archive that hold a robot, and all cells.
    pub archive: Option<[usize; 2]>,
    /// The best robots, looked at again; empty where the search was interrupted.
    pub best: Vec<BestRobot>,
    /// The engine and its precision.
    pub engine: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Writes everything into `folder`, next to the store, and returns the summary. Without finalists there are no best robots.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_search(
    folder: &Path,
    hunt: &Hunt,
    quarry: &Quarry,
    finalists: &[Finalist],
) -> Result<SearchSummary> {
    remove_old(folder)?;
    write_history(folder, hunt, &quarry.robots)?;
    if let Plan::MapElites(_) = &hunt.plan {
        write_archive(folder, hunt, &quarry.robots)?;
    }
    let mut best = Vec::new();
    for (index, finalist) in finalists.iter().enumerate() {
        best.push(write_best(folder, hunt, index + 1, finalist)?);
    }
    draw(folder, hunt, &quarry.robots, finalists)?;
    let summary = summarise(hunt, quarry, best)?;
    write_report(folder, "summary.json", &summary)?;
    Ok(summary)
}

fn write_history(folder: &Path, hunt: &Hunt, robots: &[Judged]) -> Result<()> {
    let axes: Vec<&str> = match &hunt.plan {
        Plan::MapElites(archive) => archive.axes.iter().map(|axis| axis.name.as_str()).collect(),
        _ => Vec::new(),
    };
    let mut header = vec![
        "robot",
        "generation",
        "modules",
        "fitness",
        "unit",
        "status",
        "seen",
        "mean_displacement_m",
    ];
    header.extend(axes.iter().copied());
    header.push("genome");
    let unit = hunt.objective.measure.unit().label();
    let rows = robots.iter().map(|robot| {
        let status = robot.failure.as_ref().map_or("walked", |f| f.reason.code());
        let seen = robot.failure.as_ref().map_or("", |f| f.seen.as_str());
        let mut row = vec![
            robot.index.to_string(),
            hunt.plan.generation_of(robot.index).to_string(),
            robot.genome.len().to_string(),
            number(robot.fitness),
            unit.to_owned(),
            status.to_owned(),
            seen.split_whitespace().collect::<Vec<_>>().join(" "),
            number(robot.mean_displacement_m),
        ];
        row.extend((0..axes.len()).map(|axis| number(robot.descriptors.get(axis).copied())));
        let genes = robot.genome.genes().iter().flat_map(|gene| gene.values());
        row.push(genes.map(f64::to_string).collect::<Vec<_>>().join(" "));
        row
    });
    write_table(&folder.join("history.csv"), &header, rows)
}

/// Robots as the archive's cells hold them: index of the cell along each axis, and of the robot.
pub(super) fn elites(hunt: &Hunt, robots: &[Judged]) -> Result<Vec<(Vec<usize>, usize)>> {
    let Plan::MapElites(plan) = &hunt.plan else {
        return Ok(Vec::new());
    };
    let history: Vec<_> = robots
        .iter()
        .map(|robot| crate::search::Evaluated {
            genome: robot.genome.clone(),
            fitness: robot.fitness,
            descriptors: robot.descriptors.clone(),
        })
        .collect();
    let archive = plan.archive(&history)?;
    let cells = archive.cells().iter().enumerate();
    Ok(cells
        .filter_map(|(cell, elite)| Some((cell, (*elite)?)))
        .map(|(cell, elite)| {
            let mut rest = cell;
            let along = plan.axes.iter().map(|axis| {
                let here = rest % axis.cells;
                rest /= axis.cells;
                here
            });
            (along.collect(), elite)
        })
        .collect())
}

fn write_archive(folder: &Path, hunt: &Hunt, robots: &[Judged]) -> Result<()> {
    let Plan::MapElites(plan) = &hunt.plan else {
        return Ok(());
    };
    let cells: Vec<String> = plan
        .axes
        .iter()
        .map(|a| format!("{}_cell", a.name))
        .collect();
    let header: Vec<&str> = cells
        .iter()
        .map(String::as_str)
        .chain(plan.axes.iter().map(|axis| axis.name.as_str()))
        .chain(["robot", "fitness", "unit"])
        .collect();
    let unit = hunt.objective.measure.unit().label();
    let elites = elites(hunt, robots)?;
    let rows = elites.iter().map(|(along, elite)| {
        let robot = &robots[*elite];
        let mut row: Vec<String> = along.iter().map(usize::to_string).collect();
        row.extend(robot.descriptors.iter().map(f64::to_string));
        row.extend([
            robot.index.to_string(),
            number(robot.fitness),
            unit.to_owned(),
        ]);
        row
    });
    write_table(&folder.join("archive.csv"), &header, rows)
}

fn write_best(folder: &Path, hunt: &Hunt, rank: usize, finalist: &Finalist) -> Result<BestRobot> {
    let best = folder.join("best");
    std::fs::create_dir_all(&best).map_err(|e| Error::io("make the folder", &best, &e))?;
    let robot = &finalist.robot;
    let file = format!("{rank:02}_{}", robot.name());
    let at = |ending: &str| best.join(format!("{file}{ending}"));
    write_atomic(at(".ron"), robot.to_ron()?.as_bytes())?;
    if let Body::Developed(development) = &hunt.body {
        let specimen = Specimen {
            name: robot.name().to_owned(),
            genome: finalist.judged.genome.clone(),
            development: development.clone(),
        };
        write_atomic(at(".genome.ron"), specimen.to_ron()?.as_bytes())?;
    }
    let exported = format_named("mjcf")?.render(&Robot::new(robot, &hunt.experiment(robot)));
    write_atomic(at(".xml"), exported.text.as_bytes())?;
    write_report(&best, &format!("{file}.json"), &finalist.card(hunt, rank)?)?;
    let changes: Option<Vec<f64>> = finalist.reruns.iter().map(|r| r.change).collect();
    let displacement = &finalist.prediction.displacement_m;
    Ok(BestRobot {
        rank,
        index: finalist.judged.index,
        file,
        modules: robot.modules().len(),
        servos: robot.summary().hinges,
        search_fitness: finalist.judged.fitness,
        fitness: finalist.fitness,
        median_displacement_m: displacement.map(|d| d.q50),
        displacement_q05_q95_m: displacement.map(|d| [d.q05, d.q95]),
        success: finalist.success.as_ref().map(|s| s.probability.share),
        survives: finalist.survives(),
        worst_rerun: finalist
            .reruns
            .iter()
            .max_by(|a, b| {
                let size = |r: &Rerun| r.change.map_or(f64::INFINITY, f64::abs);
                size(a).total_cmp(&size(b))
            })
            .map(|rerun| rerun.settings),
        largest_change: changes.map(|all| all.iter().fold(0.0, |most: f64, c| most.max(c.abs()))),
    })
}

fn summarise(hunt: &Hunt, quarry: &Quarry, best: Vec<BestRobot>) -> Result<SearchSummary> {
    let mut failures = BTreeMap::new();
    for failure in quarry.robots.iter().filter_map(|r| r.failure.as_ref()) {
        *failures.entry(failure.reason.code()).or_insert(0) += 1;
    }
    let archive = match &hunt.plan {
        Plan::MapElites(plan) => Some([
            elites(hunt, &quarry.robots)?.len(),
            plan.axes.iter().map(|axis| axis.cells).product(),
        ]),
        _ => None,
    };
    let mut warnings = Vec::new();
    if hunt.noise.is_zero() && hunt.doubt.is_none() {
        warnings.push(Warning::new(
            Code::NoNoise,
            "all repeats are the same run: the best robot is the best at one point, and nothing says how sure that is",
        ));
    }
    if !best.is_empty() && best.iter().all(|robot| !robot.survives) {
        warnings.push(Warning::new(
            Code::NoSurvivor,
            "no finalist walks the same under other solver settings: what was found may be an artefact of the simulation",
        ));
    }
    Ok(SearchSummary {
        search: hunt.name.clone(),
        strategy: hunt.plan.name(),
        objective: hunt.objective.label(),
        unit: hunt.objective.measure.unit().label(),
        complete: quarry.ending == Ending::Complete,
        robots: quarry.robots.len(),
        robots_total: hunt.plan.budget(),
        repeats: hunt.repeats,
        duration_s: hunt.duration_s,
        seed: hunt.seed,
        failures,
        best_fitness: quarry
            .robots
            .iter()
            .filter_map(|r| r.fitness)
            .reduce(f64::max),
        archive,
        best,
        engine: crate::simulation::ENGINE_VERSION,
        version: env!("CARGO_PKG_VERSION"),
        warnings,
    })
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// Removes what an earlier search wrote: a robot must not outlive its search.
fn remove_old(folder: &Path) -> Result<()> {
    let refuse = |path: &Path, e: &std::io::Error| Error::io("remove an old result", path, e);
    for name in ["history.csv", "archive.csv", "summary.json"] {
        let path = folder.join(name);
        if path.exists() {
            std::fs::remove_file(&path).map_err(|e| refuse(&path, &e))?;
        }
    }
    for stem in ["fitness", "archive", "gallery", "paths"] {
        super::remove_pictures(folder, stem)?;
    }
    let best = folder.join("best");
    let Ok(entries) = std::fs::read_dir(&best) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // Ours start with a rank.
        let is_ours = name.split_once('_').is_some_and(|(rank, rest)| {
            rank.len() == 2
                && rank.bytes().all(|b| b.is_ascii_digit())
                && rest.starts_with("robot_")
        });
        if is_ours {
            std::fs::remove_file(entry.path()).map_err(|e| refuse(&entry.path(), &e))?;
        }
    }
    Ok(())
}
