//! The page that a command writes into its results folder.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use clap::Args;
use realgap::Result;
use realgap::calibration::{
    Answer, Case, Definition, RepeatCase, Repeatable, StartRule, Study, Target,
};
use realgap::file::{remove_sealed, write_atomic, write_sealed};
use realgap::optimization::Ending;
use realgap::report::{
    NextCommand, PAGE_FILE, PageData, RecordedPath, Replay, ReplayData, ReportTree, ResultsPage,
    SHOWN_RECORDINGS, SIMULATION, SingleReport, side_by_side,
};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, film};
use realgap::trajectory::{Recording, Trajectory};
use realgap::warning::Code;

use super::option::Print;
use super::{output, shell, terminal};

/// Largest number of recorded robots in a replay; more would hide the simulated one.
const GHOSTS: usize = 3;
/// Options that do not change the results of a command, with the number of their values.
const WITHOUT_EFFECT: [(&str, usize); 9] = [
    ("--jobs", 1),
    ("-j", 1),
    ("--output", 1),
    ("-o", 1),
    ("--format", 1),
    ("--resume", 0),
    ("--restart", 0),
    ("--no-report", 0),
    ("--live", 1),
];

/// Whether a page is written.
#[derive(Debug, Clone, Copy, Args)]
pub struct PageOption {
    /// Leave report.html out of the folder
    #[arg(long)]
    no_report: bool,
}

impl PageOption {
    /// Writes `report.html` into a finished results folder and returns a note about it for the terminal. An error is only a warning,
    /// because the results are complete.
    pub fn write(
        self,
        folder: &Path,
        page: &ResultsPage,
        data: impl FnOnce() -> PageData,
    ) -> &'static str {
        if self.no_report {
            for name in [PAGE_FILE, PageData::FILE] {
                if let Err(error) = remove_sealed(&folder.join(name)) {
                    let warning = Code::NotWritten.warning(error.to_string());
                    terminal::print_warnings(&[warning]);
                }
            }
            return "";
        }
        let data = PageData {
            command: command(typed()),
            ..data()
        };
        if let Err(error) = write(folder, page, &data) {
            let warning = Code::NotWritten.warning(format!("no report.html: {error}"));
            terminal::print_warnings(&[warning]);
            return "";
        }
        "; report.html opens in a browser"
    }
}

/// The output of a command without a results folder: it is printed, and written as a page.
#[derive(Debug, Clone, Args)]
pub struct Telling {
    /// Also write the answer and its pictures as one page (.html)
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    pub print: Print,
}

impl Telling {
    /// Checks before the work that the page can be written.
    pub fn check(&self) -> Result<()> {
        self.report.as_deref().map_or(Ok(()), output::check_page)
    }

    /// Writes the page: `text` is what the command prints, `of` the file that it is about.
    pub fn write<'a>(
        &self,
        kind: &'static str,
        of: &Path,
        found: &impl serde::Serialize,
        text: &str,
        pictures: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<()> {
        let Some(file) = &self.report else {
            return Ok(());
        };
        let report = ReportTree::of(found)?;
        let pictures: Vec<&Path> = pictures.into_iter().map(PathBuf::as_path).collect();
        let name = of.file_stem().unwrap_or(of.as_os_str()).to_string_lossy();
        let page = SingleReport {
            kind,
            name: &name,
            text,
            report: &report,
            pictures: &pictures,
            command: &shell::command_line(),
        };
        write_atomic(file, page.page()?.as_bytes())
    }
}

fn write(folder: &Path, page: &ResultsPage, data: &PageData) -> Result<()> {
    data.write(folder)?;
    let page = page.html(Some(data), &data.command);
    write_sealed(&folder.join(PAGE_FILE), page.as_bytes(), true)
}

/// The command that pages name in place of the running one: `cluster merge` finishes a planned command.
static STANDS_FOR: OnceLock<Vec<String>> = OnceLock::new();

/// Lets pages name this command in place of the running one, because both give the same results.
pub fn stands_for(words: &[String]) {
    let words = std::iter::once("realgap".to_owned()).chain(words.iter().cloned());
    let _first = STANDS_FOR.set(words.collect());
}

/// The arguments of the command, the program's name first.
fn typed() -> impl Iterator<Item = String> {
    let own = || {
        let words = super::invocation::typed().iter();
        words.map(|word| word.to_string_lossy().into_owned())
    };
    let words = STANDS_FOR.get().cloned();
    words.unwrap_or_else(|| own().collect()).into_iter()
}

/// The command that reproduces the results: without the program's path, and without options that do not change results.
fn command(words: impl Iterator<Item = String>) -> String {
    let mut kept = vec!["realgap".to_owned()];
    let mut words = words.skip(1);
    while let Some(word) = words.next() {
        let name = word.split_once('=').map_or(word.as_str(), |(name, _)| name);
        match WITHOUT_EFFECT.iter().find(|(known, _)| *known == name) {
            Some((_, values)) if name.len() == word.len() => {
                words.by_ref().take(*values).for_each(drop);
            }
            Some(_) => {}
            None => kept.push(shell::quoted(word)),
        }
    }
    kept.join(" ")
}

/// The commands that use the answer of a study. The folder has no name in them: equal results have equal pages wherever they lie.
fn next(study: &Study) -> Vec<NextCommand> {
    let of = |purpose: &str, command: &str| NextCommand {
        purpose: purpose.to_owned(),
        command: command.to_owned(),
    };
    let search = of(
        "Search for a better robot or gait on this floor (DIR is this folder); every repeat takes a draw of its posterior:",
        "realgap search SEARCH.ron --posterior DIR",
    );
    let predict = of(
        "Predict what a robot does with these values, and with which odds (DIR is this folder):",
        "realgap predict ROBOT.ron --parameters DIR/best.ron --posterior DIR",
    );
    match study.definition().metric.needs().joints {
        true => vec![predict],
        false => vec![search, predict],
    }
}

/// Data that the page of a study shows in addition to its results.
pub fn of_study(study: &Study, answer: &Answer) -> PageData {
    let definition = study.definition();
    let Some(case) = study.cases().first() else {
        return PageData::default();
    };
    let best = answer.scores.best.map(|best| &answer.scores.points[best]);
    let experiment = best.and_then(|best| study.experiment(0, &best.values).ok());
    let scale = experiment
        .as_ref()
        .map_or(1.0, |e| e.recording_length_scale);
    let (recorded, recordings) = recorded(definition, case, scale);
    PageData {
        next: match answer.ending {
            Ending::Complete if best.is_some() => next(study),
            _ => Vec::new(),
        },
        duration_s: case.experiment.duration_s,
        reality: definition.source().reality_label().to_owned(),
        recorded,
        best_xy_m: best.map_or_else(Vec::new, |best| {
            best.path_xy_m.iter().map(rounded).collect()
        }),
        // After an interruption, no further simulation is started.
        replay: experiment
            .filter(|_| answer.ending == Ending::Complete)
            .and_then(|experiment| seen(definition, &experiment, &recordings)),
        ..PageData::default()
    }
}

/// Data that the page of a gap shows in addition: the run of the first start without noise.
pub fn of_gap(study: &Study) -> PageData {
    let definition = study.definition();
    let Some(case) = study.cases().first() else {
        return PageData::default();
    };
    let (_, recordings) = recorded(definition, case, 1.0);
    PageData {
        duration_s: case.experiment.duration_s,
        replay: seen(definition, &case.experiment, &recordings),
        ..PageData::default()
    }
}

/// A position, rounded to hundredths of a millimetre.
fn rounded(place_m: &[f64; 2]) -> [f64; 2] {
    place_m.map(|m| (m * 1e5).round() / 1e5)
}

/// The recordings of a case: as prepared paths, and as recordings for the replay.
fn recorded(
    definition: &Definition,
    case: &Case,
    scale: f64,
) -> (Vec<RecordedPath>, Vec<Recording>) {
    let (mut paths, mut seen) = (Vec::new(), Vec::new());
    for target in case.targets.iter().take(SHOWN_RECORDINGS) {
        let recording = &definition.recordings[target.recording];
        let Ok(target) = target.in_true_lengths(scale) else {
            continue;
        };
        let target: &Target = &target;
        if !target.motion.is_of_joints() {
            paths.push(RecordedPath {
                name: recording.name.clone(),
                duration_s: target.motion.duration_s(),
                xy_m: target.prepared.xy_m().iter().map(rounded).collect(),
            });
        }
        if seen.len() < GHOSTS && is_seen(&target.motion, &case.experiment) {
            seen.push(Recording {
                trajectory: target.motion.clone(),
                // Bodies are left out, because they last as long as the file, and the motion only as long as the study.
                log: None,
                bodies: Vec::new(),
                ..recording.clone()
            });
        }
    }
    (paths, seen)
}

/// Whether a recording determines where the robot was; joints alone do so only for a robot that is held.
fn is_seen(motion: &Trajectory, experiment: &Experiment) -> bool {
    !motion.is_of_joints() || experiment.assembly.world_from_mount.is_some()
}

/// Recordings of a case for its replay, without the length scale that the study applies to recordings.
pub fn recordings_of(study: &Repeatable, case: &RepeatCase) -> Vec<Recording> {
    let scale = case.experiment.recording_length_scale;
    let is_of_case = |r: &&Recording| case.real.iter().any(|(name, _)| *name == r.name);
    let shown = study.definition.recordings.iter().filter(is_of_case);
    shown
        .filter(|recording| is_seen(&recording.trajectory, &case.experiment))
        .filter_map(|recording| {
            Some(Recording {
                trajectory: recording.trajectory.scaled(1.0 / scale).ok()?,
                log: None,
                bodies: Vec::new(),
                ..recording.clone()
            })
        })
        .take(GHOSTS)
        .collect()
}

/// Data that the page of repeats shows in addition: the run of the first start without noise.
pub fn of_repeats(study: &Repeatable) -> PageData {
    let Some(case) = study.cases.first() else {
        return PageData::default();
    };
    let recordings = recordings_of(study, case);
    PageData {
        duration_s: case.experiment.duration_s,
        reality: study.definition.source().reality_label().to_owned(),
        replay: seen(&study.definition, &case.experiment, &recordings),
        ..PageData::default()
    }
}

/// Data that the page of one robot shows in addition to its results.
pub fn of_robot(experiment: &Experiment, robot: &Morphology) -> PageData {
    PageData {
        duration_s: experiment.duration_s,
        replay: moving(experiment, robot, &[], true),
        ..PageData::default()
    }
}

/// Data that the page of a search shows in addition to its results: its best robots side by side.
pub fn of_robots(robots: &[(Experiment, &Morphology)]) -> PageData {
    let runs: Vec<_> = robots
        .iter()
        .filter_map(|(experiment, robot)| Some((*robot, film(experiment).ok()?.1?)))
        .collect();
    let first = robots.first().map(|(experiment, _)| experiment);
    PageData {
        duration_s: first.map_or(0.0, |first| first.duration_s),
        replay: first.and_then(|first| side_by_side(&runs, first.floor).ok().flatten()),
        ..PageData::default()
    }
}

/// One more run of a study together with its recordings.
fn seen(
    definition: &Definition,
    experiment: &Experiment,
    recordings: &[Recording],
) -> Option<ReplayData> {
    let is_settled = definition.start == StartRule::Settled;
    moving(experiment, &definition.morphology, recordings, is_settled)
}

/// One more run with all parts; `None` where it diverges or has no parts.
fn moving(
    experiment: &Experiment,
    robot: &Morphology,
    recordings: &[Recording],
    align: bool,
) -> Option<ReplayData> {
    let film = film(experiment).ok()?.1?;
    let replay = Replay {
        robot: Some(robot),
        run: &film,
        run_name: SIMULATION,
        recordings,
        align,
        floor: experiment.floor,
        scene: &experiment.shown_scene(),
        warnings: &[],
        provenance: &[],
    };
    replay.data().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_to_run_again_leaves_out_options_that_do_not_change_results() {
        let typed =
            "./realgap sweep a.ron --jobs 3 --points=5 -o out --resume --format=json --set x=1";
        let words = typed.split(' ').map(str::to_owned);
        assert_eq!(command(words), "realgap sweep a.ron --points=5 --set x=1");
    }
}
