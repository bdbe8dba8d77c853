//! `realgap replay`: shows a robot in motion and its recordings, as a page, an animation, or a file for another program.

use realgap::calibration::{Overrides, RepeatCase, Repeatable, StartRule};
use realgap::comparison;
use realgap::file::{look_up, sha256, write_atomic};
use realgap::report::{Replay, SIMULATION};
use realgap::simulation::{Divergence, Experiment, Film, Floor, Outcome, Sampling, film_with};
use realgap::trajectory::{self, Reading, Recording};

use super::kind::{self, read_repeatable};
use super::kit::*;
use super::option::recording_unused;
use super::page;
use super::shell;

/// Show a run in 3D with its recordings: as a web page, an animation, or a file for Foxglove or a 3D program
///
/// Use it to see what a robot does, and where the simulation leaves its recordings. A robot's file is simulated from
/// rest, as `simulate` does, as long as the first recording. A study, or the best.ron of one, is simulated with its
/// own settings and scene and, where runs start from a recording, from that recording's start. A recorded or
/// simulated run is shown as it is: with all parts where the file has them (`simulate --parts`), otherwise with the
/// parts that follow from the tracked module's orientation and the joints, otherwise as a point.
///
/// Recorded runs are translucent as far as their poses are known, otherwise a point with a line to the run. They are
/// moved to the same start and turned about the vertical so that all go the same way, unless --as-recorded.
/// docs/results.md describes the content of a page, an animation and a log.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap replay morphologies/tripod.ron --against runs/run_00.csv
  realgap replay parts.csv --robot morphologies/tripod.ron -o replay.png
  realgap replay sweeps/cube_toss_fit.ron --parameters sweeps/cube_toss_best.ron")]
pub struct ReplayCommand {
    /// A robot or a study (.ron), or a run (.csv or .tum)
    #[arg(value_name = "RUN|MORPHOLOGY|STUDY")]
    run: PathBuf,
    /// The robot that made the run; without it a point is shown
    #[arg(long, value_name = "MORPHOLOGY")]
    robot: Option<PathBuf>,
    /// Recordings to show together with the run (repeatable)
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    against: Vec<PathBuf>,
    /// For a study whose runs start from recordings: name of the recording to start from [default: the first]
    #[arg(long, value_name = "RECORDING")]
    start: Option<String>,
    /// Keep recordings where their files say, instead of moving and turning them onto the run's start and direction
    #[arg(long)]
    as_recorded: bool,
    /// Length of a simulated run, seconds [default: that of the first recording, else 10]
    #[arg(long, value_name = "S", value_parser = parse_seconds)]
    duration: Option<f64>,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    reading: ReadingOptions,
    /// File to write; its ending chooses the format: .html (a page), .png (an animation), .mcap (Foxglove), .glb (glTF)
    #[arg(short, long, value_name = "FILE", default_value = "replay.html")]
    output: PathBuf,
}

impl ReplayCommand {
    pub fn run(self) -> Result<()> {
        check_replay(&self.output)?;
        if kind::is_study(&self.run) {
            self.of_study()?;
            return Ok(());
        }
        if self.start.is_some() {
            return Err(
                Error::usage("only runs of a study can start from a recording")
                    .field("--start")
                    .found(self.run.display()),
            );
        }
        let recordings = read_recordings(&self.against, &self.reading.reading()?)?;
        let mut files: Vec<&Path> = vec![&self.run];
        files.extend(self.robot.as_deref());
        files.extend(self.against.iter().map(PathBuf::as_path));
        let is_ron = self.run.extension().is_some_and(|ending| ending == "ron");
        if is_ron || realgap::robot::import::is_foreign(&self.run) {
            if self.robot.is_some() {
                return Err(Error::usage("this is a robot already")
                    .field("robot")
                    .found(self.run.display())
                    .hint("leave --robot out"));
            }
            self.simulated(&recordings, &files)?;
        } else {
            self.recorded(&recordings, &files)?;
        }
        Ok(())
    }

    /// A run that is simulated now.
    fn simulated(&self, recordings: &[Recording], files: &[&Path]) -> Result<()> {
        let morphology = read_morphology(&self.run)?;
        let values = self.values.parameter_set()?;
        let mut experiment = values.apply(&Experiment::new(morphology.assemble()));
        let longest_s = recordings.first().map(|r| r.trajectory.duration_s());
        experiment.duration_s = self.duration.or(longest_s).unwrap_or(10.0);
        experiment.sampling = Sampling::Rate(60.0);
        let mut warnings = morphology.warnings();
        warnings.extend(values.without_effect(&experiment));
        warnings.extend(recording_unused(&values));
        experiment.check().map_err(Error::into_usage)?;
        let (run, film, _) =
            progress::during_one(experiment.duration_s, |hooks| film_with(&experiment, hooks))?;
        warnings.extend(run.warnings);
        if let Outcome::Diverged(divergence) = run.outcome {
            return Err(diverged(&divergence, &self.run));
        }
        let Some(film) = film else { return Ok(()) };
        self.write(&Shown {
            morphology: Some(&morphology),
            film: &film,
            name: SIMULATION,
            experiment: Some(&experiment),
            recordings,
            align: !self.as_recorded,
            warnings: &warnings,
            files,
        })
    }

    /// The run of a study.
    fn of_study(&self) -> Result<()> {
        if kind::is_of_own_simulator(&self.run) {
            return Err(Error::usage(
                "a replay shows bodies, and the study names its own simulator",
            )
            .at_file(&self.run)
            .hint("`realgap sweep` and `realgap tune` draw its paths, joints and channels beside the recorded ones"));
        }
        let against = self.against.iter().map(|path| path.display().to_string());
        let mut overrides = Overrides {
            recordings: against.collect(),
            reading: self.reading.reading()?,
            ..self.values.over(Overrides::default())?
        };
        // Nothing is scored here, so recordings that the study's metric would refuse are shown, too.
        let study = read_repeatable(&self.run, &overrides).or_else(|_| {
            overrides.metric = Some(comparison::by_name("rms")?);
            read_repeatable(&self.run, &overrides)
        })?;
        let case = self.case(&study)?;
        let mut experiment = case.experiment.clone();
        if let Some(duration_s) = self.duration {
            experiment.duration_s = duration_s;
            experiment.sampling = Sampling::Rate(60.0);
        }
        experiment.check().map_err(Error::into_usage)?;
        let (run, film, _) =
            progress::during_one(experiment.duration_s, |hooks| film_with(&experiment, hooks))?;
        if let Outcome::Diverged(divergence) = run.outcome {
            return Err(diverged(&divergence, &self.run));
        }
        let Some(film) = film else {
            return Err(Error::invalid("this robot has no parts to show")
                .at_file(&self.run)
                .hint("name a study of modules"));
        };
        let is_settled = study.definition.start == StartRule::Settled;
        let recordings = page::recordings_of(&study, case);
        self.write(&Shown {
            morphology: Some(&study.definition.morphology),
            film: &film,
            name: SIMULATION,
            experiment: Some(&experiment),
            recordings: &recordings,
            align: is_settled && !self.as_recorded,
            warnings: &[study.warnings.clone(), run.warnings].concat(),
            files: &[&self.run],
        })
    }

    /// The case whose recording `--start` names.
    fn case<'a>(&self, study: &'a Repeatable) -> Result<&'a RepeatCase> {
        match &self.start {
            None => study
                .cases
                .first()
                .ok_or_else(|| Error::invalid("the study has no run to show").at_file(&self.run)),
            Some(name) => look_up("recording", name, &study.cases, |case| &case.name)
                .map_err(Error::into_usage),
        }
    }

    /// A run from a file.
    fn recorded(&self, recordings: &[Recording], files: &[&Path]) -> Result<()> {
        if self.duration.is_some() || self.values.parameter_set()?.iter().next().is_some() {
            return Err(
                Error::usage("this run is read from a file and not simulated")
                    .at_file(&self.run)
                    .hint("leave --duration, --set and --parameters out, or name a robot's file"),
            );
        }
        let morphology = self.robot.as_deref().map(read_morphology).transpose()?;
        let run = trajectory::read(&self.run, self.reading.reading()?)?;
        let assembly = morphology.as_ref().map(Morphology::assemble);
        let film = match &assembly {
            Some(assembly) => Film::of_recording(assembly, &run),
            None => Film {
                track: run.trajectory.clone(),
                parts: Vec::new(),
                scene: Vec::new(),
            },
        };
        self.write(&Shown {
            morphology: morphology.as_ref(),
            film: &film,
            name: &run.name,
            experiment: None,
            recordings,
            align: !self.as_recorded,
            warnings: &run.warnings,
            files,
        })
    }

    fn write(&self, shown: &Shown<'_>) -> Result<()> {
        terminal::print_warnings(shown.warnings);
        terminal::print_warnings(shown.recordings.iter().flat_map(|r| &r.warnings));
        let bytes = shown.write(&self.output)?;
        terminal::print(format!(
            "written {} ({} kB): open it in {}",
            self.output.display(),
            bytes.div_ceil(1000),
            Show::of(&self.output)?.viewer(),
        ));
        Ok(())
    }
}

/// The content of a replay.
pub struct Shown<'a> {
    /// The robot.
    pub morphology: Option<&'a Morphology>,
    /// The run.
    pub film: &'a Film,
    /// The name of the run.
    pub name: &'a str,
    /// The experiment, where the run was simulated.
    pub experiment: Option<&'a Experiment>,
    /// The recordings that are shown with it.
    pub recordings: &'a [Recording],
    /// Whether recordings are moved and turned onto the run.
    pub align: bool,
    /// Warnings of the run; the warnings of the recordings are added.
    pub warnings: &'a [Warning],
    /// The files that were read.
    pub files: &'a [&'a Path],
}

impl Shown<'_> {
    /// Writes the page; its length in bytes.
    pub fn write(&self, path: &Path) -> Result<usize> {
        let mut warnings = self.warnings.to_vec();
        warnings.extend(self.recordings.iter().flat_map(|r| r.warnings.clone()));
        let show = Show::of(path)?;
        let provenance = self.provenance()?;
        let scene = self
            .experiment
            .map_or_else(Vec::new, Experiment::shown_scene);
        let replay = Replay {
            robot: self.morphology,
            run: self.film,
            run_name: self.name,
            recordings: self.recordings,
            align: self.align,
            floor: self.experiment.map_or_else(Floor::default, |e| e.floor),
            scene: &scene,
            warnings: &warnings,
            provenance: &provenance,
        };
        let bytes = match show {
            Show::Page => replay.page()?.into_bytes(),
            Show::Log => replay.mcap()?,
            Show::Model => replay.gltf()?,
            Show::Animation => replay.animation()?,
        };
        write_atomic(path, &bytes)?;
        Ok(bytes.len())
    }

    fn provenance(&self) -> Result<Vec<(String, String)>> {
        let mut all = vec![("realgap", env!("CARGO_PKG_VERSION").to_owned())];
        if let Some(experiment) = self.experiment {
            all.push(("engine", experiment.engine_version().to_owned()));
            let solver = &experiment.solver;
            all.push(("timestep", format!("{} s", solver.timestep_s)));
            all.push(("substeps", solver.substeps.to_string()));
            all.push(("joints", format!("{:?}", experiment.joint_kind())));
        }
        let mut all: Vec<_> = all.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
        for file in self.files {
            let bytes = std::fs::read(file).map_err(|e| Error::io("read the file", file, &e))?;
            let hash = sha256(bytes);
            all.push((file.display().to_string(), format!("sha256 {hash}")));
        }
        all.push(("command".to_owned(), shell::command_line()));
        Ok(all)
    }
}

/// The error of a run that has no result.
pub fn diverged(divergence: &Divergence, file: &Path) -> Error {
    Error::invalid(format!("the simulation diverged {divergence}"))
        .at_file(file)
        .hint("try a shorter --timestep or more --substeps; check masses, sizes and servo limits")
}

/// The format of a replay, by the ending of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Show {
    Page,
    Log,
    Model,
    Animation,
}

impl Show {
    fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_deref().and_then(std::ffi::OsStr::to_str) {
            Some("html") => Ok(Self::Page),
            Some("mcap") => Ok(Self::Log),
            Some("glb") => Ok(Self::Model),
            Some("png" | "apng") => Ok(Self::Animation),
            _ => Err(Error::usage("a replay cannot be written as such a file")
                .at_file(path)
                .allowed("a name that ends in .html (a page), .png (an animation), .mcap (Foxglove) or .glb (glTF)")),
        }
    }

    /// The program that opens it.
    fn viewer(self) -> &'static str {
        match self {
            Self::Page => "a browser",
            Self::Log => "Foxglove",
            Self::Model => "a viewer of glTF",
            Self::Animation => "a browser",
        }
    }
}

/// Checks before the work that a replay can be written there.
pub fn check_replay(path: &Path) -> Result<()> {
    Show::of(path)?;
    output::check(path)
}

fn read_recordings(paths: &[PathBuf], reading: &Reading) -> Result<Vec<Recording>> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(trajectory::read_all(path, reading.clone())?);
    }
    Ok(all)
}
