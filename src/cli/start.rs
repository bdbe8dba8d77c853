//! `realgap start`: makes a study of the user's files, and prints every guess with its evidence.

mod drive;
mod driven;
mod effort;
mod gains;
mod joint;
mod mujoco;
mod noise;
mod path;
mod proposal;
mod rehearsal;
mod wheels;

use realgap::RunOptions;
use realgap::calibration::{Overrides, UnusedColumns};
use realgap::file::{Source, write_ron};
use realgap::prediction::ensemble::rms_m;
use realgap::robot::import::is_foreign;
use realgap::trajectory::{
    Ambiguity, Evidence, InferredReading, JointReading, Prepared, Reading, Recording,
    WheelCommands, prepare, read_all,
};

use super::kit::*;
use super::question::answer;
use super::shell;
use drive::Drive;
pub use driven::Commanded;
pub use gains::Gains;
use rehearsal::{Rehearsed, rehearse};

/// Make a study of your own recordings and your robot, and detect how the files must be read
///
/// Use it first with your own data. Names of columns give their quantities and units, the usual interval between
/// samples gives the unit of time, and free fall (9.81 m/s² everywhere) gives the unit of length and the vertical
/// axis; without free fall, the floor and the robot's size give them. Lost and unsorted samples, gaps, waiting before
/// the motion, several objects in a file and mirrored axes are detected. Every guess is printed with its evidence,
/// and stands in the study's `reading`.
///
/// What the files do not determine is asked for on a terminal; elsewhere the error names the option that answers. A
/// robot without joints starts from its first recorded state, any other robot starts at rest. Then the study is
/// checked, and the next command is printed.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap start runs/*.csv --cube 0.1 0.37
  realgap start runs/*.csv robot.urdf -o study.ron
  realgap start runs/*.csv scene.xml --engine mujoco
  realgap sweep study.ron                   # the next command")]
pub struct Start {
    /// Recordings (.csv, .tum, .mcap, ...), and the robot (.ron, .urdf or .xml)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The robot is a cube: its edge in metres and its mass in kilograms
    #[arg(long, num_args = 2, value_names = ["SIDE_M", "MASS_KG"])]
    cube: Option<Vec<f64>>,
    /// Names of the joints of numbered columns (q1, q2, ...) and of lists, in their order
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    joints: Vec<String>,
    /// Gains with which the firmware turns commanded angles into torques, in N m/rad and N m s/rad, e.g. 20,1.5; for some joints
    /// '*_calf_joint=30,2' (repeatable)
    #[arg(long, value_name = "[JOINT=]KP,KD", allow_hyphen_values = true)]
    pd: Vec<Gains>,
    /// Distance between the left and the right wheels, metres, for recorded commands of forward speed and turn rate (columns
    /// `linear` and `angular`) [default: that of the robot's file]
    #[arg(long, value_name = "METRES")]
    track: Option<f64>,
    /// A recorded column that commands joints, and the column that switches their servos, e.g. 'drive_*=throttle:enabled' (repeatable).
    /// The path is then fitted in windows, by least squares; what the numbers mean, `command` of the actuators in the robot's file says
    #[arg(long, value_name = "JOINT=COLUMN[:SWITCH]", conflicts_with_all = ["cube", "track", "own_gait"])]
    command: Vec<Commanded>,
    /// The recorded robot ran the gait of its own file; needed for wheels without recorded commands
    #[arg(long)]
    own_gait: bool,
    /// Simulate the model as it is in this engine of its own, in place of a robot read from it: starts Python, with the packages
    /// realgap and mujoco (docs/simulator.md)
    #[arg(long, value_enum, value_name = "ENGINE", conflicts_with_all = ["cube", "track", "own_gait", "command"])]
    engine: Option<ForeignEngine>,
    /// The Python that has these packages, which the study names, too [default: python3]
    #[arg(long, value_name = "PYTHON", requires = "engine")]
    python: Option<String>,
    #[command(flatten)]
    reading: ReadingOptions,
    /// File of the study; a robot made by --cube is written beside it
    #[arg(short, long, value_name = "FILE", default_value = "study.ron")]
    output: PathBuf,
}

/// Engines that simulate the user's model unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ForeignEngine {
    /// MuJoCo loads the model, and its own fields are the parameters.
    Mujoco,
}

/// The text of a study beside its file names; STUDY stands for the study's own path.
struct Draft {
    /// Comments at its beginning.
    head: String,
    /// Its fields before the parameters.
    before: String,
    /// The timestep, seconds; else the program's own.
    timestep_s: Option<f64>,
    /// Length of windows and the interval between them, seconds; else whole recordings.
    horizon: Option<(f64, f64)>,
    /// One line per parameter.
    parameters: String,
    /// Its fields after them.
    after: String,
    /// Further assumptions, each with its evidence.
    clues: Vec<(&'static str, String)>,
    /// The command that comes next.
    next: String,
}

/// The recordings and their robot.
struct Subject {
    recordings: Vec<PathBuf>,
    robot_file: PathBuf,
    robot: Morphology,
}

impl Start {
    pub fn run(self) -> Result<()> {
        let request = Request {
            reading: self.reading.reading()?,
            files: self.files,
            cube: self.cube,
            joints: self.joints,
            pd: self.pd,
            track: self.track,
            commanded: self.command,
            own_gait: self.own_gait,
            engine: self.engine,
            python: self.python,
            output: self.output,
        };
        let started = request.study(&OnTerminal)?;
        terminal::print_warnings(&started.warnings);
        terminal::print(started.lines.join("\n"));
        Ok(())
    }
}

/// The files of which a study is made, and what is known about them: the options of the command, or arguments of Python.
#[derive(Debug, Default)]
pub struct Request {
    /// Recordings, and the robot.
    pub files: Vec<PathBuf>,
    /// The robot is a cube: its edge in metres and its mass in kilograms.
    pub cube: Option<Vec<f64>>,
    /// Names of the joints of numbered columns and of lists, in their order.
    pub joints: Vec<String>,
    /// Gains with which the firmware turns commanded angles into torques.
    pub pd: Vec<Gains>,
    /// Distance between the left and the right wheels, metres.
    pub track: Option<f64>,
    /// Recorded columns that command joints.
    pub commanded: Vec<Commanded>,
    /// Whether the recorded robot ran the gait of its own file.
    pub own_gait: bool,
    /// The engine that simulates the model as it is.
    pub engine: Option<ForeignEngine>,
    /// The Python that has this engine's packages.
    pub python: Option<String>,
    /// How the files are read, as far as that is known.
    pub reading: Reading,
    /// The file of the study.
    pub output: PathBuf,
}

/// Who asks for a study.
pub trait Caller {
    /// Answers what the files leave open.
    ///
    /// # Errors
    /// There is no answer.
    fn answer(&self, doubts: &[Warning], open: &Ambiguity, known: &mut Reading) -> Result<()>;

    /// Does some work of `total` runs, and shows how far it is.
    ///
    /// # Errors
    /// As the work.
    fn during<T>(&self, total: usize, work: impl FnOnce(&RunOptions<'_>) -> Result<T>)
    -> Result<T>;
}

/// The command, whose user can be asked.
struct OnTerminal;

impl Caller for OnTerminal {
    fn answer(&self, doubts: &[Warning], open: &Ambiguity, known: &mut Reading) -> Result<()> {
        terminal::print_warnings(doubts);
        answer(open, known)
    }

    fn during<T>(
        &self,
        total: usize,
        work: impl FnOnce(&RunOptions<'_>) -> Result<T>,
    ) -> Result<T> {
        let what = "runs before the study is written";
        progress::during(total, what, RunOptions::default(), work)
    }
}

/// A study that was made and written.
#[derive(Debug)]
pub struct Started {
    /// For people: how the files were read and why, and the next command.
    pub lines: Vec<String>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Request {
    /// Makes the study and writes it.
    ///
    /// # Errors
    /// Files that cannot be read, questions without an answer, a robot that moves although nothing drives it.
    pub fn study(self, caller: &impl Caller) -> Result<Started> {
        output::check(&self.output)?;
        if let Some(ForeignEngine::Mujoco) = self.engine {
            return self.study_in_mujoco(caller);
        }
        let mut subject = self.subject()?;
        let size_m = subject.robot.summary().body_length_m;
        let hinges = subject.robot.assemble().hinges;
        let joints: Vec<String> = hinges.into_iter().map(|hinge| hinge.name).collect();
        let mut guess = self.inferred(
            &subject.recordings,
            (&joints, Some(size_m)),
            caller,
            |known| wheels::find(&subject, known, self.track),
        )?;
        if !self.commanded.is_empty() {
            // Windows that begin while the robot stands are left out, in every recording by itself.
            guess.leave_crop(&self.reading);
        }
        let mut recordings = Vec::new();
        for path in &subject.recordings {
            recordings.extend(read_all(path, &guess.reading)?);
        }
        let mut draft = match self.commanded.is_empty() {
            false => driven::draft(&subject, &recordings, &self.commanded)?,
            true => {
                let (file, gains) = (&self.output, &self.pd);
                let drive = Drive::find(&mut subject, &recordings, file, self.own_gait, gains)?;
                let mut draft = match recordings.iter().all(|r| r.trajectory.is_of_joints()) {
                    true => joint::draft(&subject, &recordings, &drive)?,
                    false => path::draft(&subject, &recordings, guess.has_free_fall, &drive)?,
                };
                draft.clues.splice(0..0, drive.clues);
                draft
            }
        };
        let (count, alike) = (recordings.len(), alike(&recordings));
        // The study reads the recordings again; thousands of them would be in memory twice.
        drop(recordings);
        let Rehearsed {
            text,
            study,
            doubts,
        } = rehearse(&mut draft, &self.output, caller, |draft| {
            self.text(&subject, &guess, draft)
        })?;
        output::write_ron(&self.output, &text)?;
        let mut lines: Vec<String> = doubts
            .iter()
            .map(|doubt| format!("doubt: {doubt}"))
            .collect();
        lines.push(format!(
            "{} of {}, read as follows:",
            counted(count, "recording"),
            subject.robot.name()
        ));
        lines.extend(said(&guess, &draft).map(|(what, because)| format!("  {what}: {because}")));
        lines.extend(study.unused_columns()?.iter().map(unused));
        lines.extend(alike);
        lines.push(format!(
            "written {}, {}; next: realgap {}",
            self.output.display(),
            match doubts.is_empty() {
                true => "which is valid",
                false => "which is valid, but answers nothing before these doubts are settled",
            },
            draft
                .next
                .replace("STUDY", &shell::path(&self.output).to_string())
        ));
        Ok(Started {
            lines,
            warnings: study.warnings().to_vec(),
        })
    }

    /// How the recordings are read: what the options say, what the files show, and what the user is asked.
    fn inferred(
        &self,
        recordings: &[PathBuf],
        (joints, size_m): (&[String], Option<f64>),
        caller: &impl Caller,
        wheels: impl FnOnce(&Reading) -> Result<Option<(WheelCommands, String)>>,
    ) -> Result<InferredReading> {
        let mut known = self.reading.clone();
        known.read_without_unit(driven::columns(&self.commanded));
        let named = JointReading::infer(&recordings[0], &known, joints, &self.joints)?;
        let named = named.unwrap_or_else(|| JointReading {
            reading: known.clone(),
            ..JointReading::default()
        });
        known = named.reading;
        let mut evidence = named.evidence;
        if known.wheels.is_none()
            && let Some((found, reason)) = wheels(&known)?
        {
            evidence.push(Evidence {
                finding: format!(
                    "speeds of wheels from `{}` and `{}`",
                    found.forward, found.turn
                ),
                reason,
            });
            known.wheels = Some(found);
        }
        let mut guess = loop {
            let guess = InferredReading::infer(recordings, &known, size_m)?;
            match guess.ambiguities.first() {
                None => break guess,
                Some(open) => caller.answer(&guess.doubts, open, &mut known)?,
            }
        };
        guess.evidence.splice(0..0, evidence);
        Ok(guess)
    }

    /// Separates the recordings from the robot.
    fn subject(&self) -> Result<Subject> {
        let is_robot = |path: &PathBuf| {
            is_foreign(path) || path.extension().is_some_and(|ending| ending == "ron")
        };
        let (robots, recordings): (Vec<_>, Vec<_>) = self.files.iter().cloned().partition(is_robot);
        // A file of another kind is reported as such, before robots are counted.
        for file in robots.iter().filter(|file| !is_foreign(file)) {
            read_morphology(file)?;
        }
        if recordings.is_empty() {
            return Err(Error::usage("no recording is named")
                .found("robots alone")
                .hint("name recordings, too: realgap start runs/*.csv robot.ron"));
        }
        let robot_file = match (robots.as_slice(), &self.cube) {
            ([file], None) => file.clone(),
            ([], Some(cube)) => self.write_cube(cube)?,
            ([], None) => {
                return Err(Error::usage("which robot was recorded?")
                    .found("recordings alone")
                    .allowed("a robot's file (.ron, .urdf, .xml), or --cube SIDE_M MASS_KG"));
            }
            (all, _) => {
                let count = all.len() + usize::from(self.cube.is_some());
                return Err(Error::usage("recordings of one study are of one robot")
                    .found(counted(count, "robot"))
                    .hint(
                        "name the robot that was recorded; call `realgap start` once per robot",
                    ));
            }
        };
        Ok(Subject {
            recordings,
            robot: read_morphology(&robot_file)?,
            robot_file,
        })
    }

    fn write_cube(&self, cube: &[f64]) -> Result<PathBuf> {
        let [side_m, mass_kg] = [cube[0], cube[1]];
        let stem = self
            .output
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy();
        let file = self.output.with_file_name(format!("{stem}_cube.ron"));
        let text = format!(
            "// A cube without servo.\n(\n    name: \"cube\",\n    modules: [\n        (name: \"cube\", kind: Passive(side_m: {side_m:?}, mass_kg: {mass_kg:?})),\n    ],\n)\n"
        );
        Morphology::parse(&Source::new("--cube", text.clone())).map_err(|error| {
            let hint = "metres and kilograms: --cube 0.1 0.37 is a cube of 10 cm and 370 g";
            error.hint(hint).into_usage()
        })?;
        output::write_ron(&file, &text)?;
        Ok(file)
    }

    /// The study's text.
    fn text(&self, subject: &Subject, guess: &InferredReading, draft: &Draft) -> Result<String> {
        let mut names = String::new();
        for path in &subject.recordings {
            names += &format!("        {},\n", in_study(&self.output, path)?);
        }
        let mut clues = String::new();
        for (what, because) in said(guess, draft) {
            clues += &format!("    // {what}: {}\n", because.replace('\n', " "));
        }
        let reading = reading_text(&guess.reading)?;
        let mut timing = String::new();
        if let Some(timestep_s) = draft.timestep_s {
            timing += &format!("    timestep_s: {timestep_s:?},\n");
        }
        if let Some((length_s, every_s)) = draft.horizon {
            timing += &format!(
                "    horizon: ({length_s:?}, {every_s:?}), // windows of {length_s} s, one every {every_s} s\n"
            );
        }
        let text = format!(
            "{}Study(\n    description: \"made by realgap start\",\n    morphology: {},\n    recordings: [\n{names}    ],\n{clues}{reading}{}{timing}    parameters: [ // `realgap study parameters` lists all parameters\n{}    ],\n{})\n",
            draft.head,
            in_study(&self.output, &subject.robot_file)?,
            draft.before,
            draft.parameters,
            draft.after,
        );
        Ok(file_text(&text, &self.output))
    }
}

/// A path as it stands in the study.
fn in_study(study: &Path, path: &Path) -> Result<String> {
    let is_here = study
        .parent()
        .is_none_or(|folder| folder.as_os_str().is_empty());
    let path = match is_here || path.is_absolute() {
        true => path.to_path_buf(),
        false => std::path::absolute(path).map_err(|e| Error::io("find the file", path, &e))?,
    };
    Ok(format!("{:?}", path.display().to_string()))
}

/// The field of a study that says how its recordings are read; nothing where they are read as usual.
fn reading_text(reading: &Reading) -> Result<String> {
    match *reading == Reading::default() {
        true => Ok(String::new()),
        false => Ok(format!(
            "    reading: {},\n",
            write_ron(reading)?.trim_end().replace('\n', "\n    ")
        )),
    }
}

/// The text of a study, with its own name for STUDY.
fn file_text(text: &str, study: &Path) -> String {
    text.replace("STUDY", &study.display().to_string())
}

/// A line about recorded columns that the study does not use.
fn unused(unused: &UnusedColumns) -> String {
    format!(
        "  not used: {}: {}; {}",
        unused.columns.join(", "),
        unused.because,
        unused.remedy
    )
}

/// Every guess with its evidence.
fn said<'a>(
    guess: &'a InferredReading,
    draft: &'a Draft,
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let of_files = guess
        .evidence
        .iter()
        .map(|evidence| (&*evidence.finding, &*evidence.reason));
    let of_robot = draft
        .clues
        .iter()
        .map(|(what, because)| (*what, &**because));
    of_files.chain(of_robot)
}

/// The largest distance between prepared paths, from which the user can judge whether the recordings are repeats of one run.
fn alike(recordings: &[Recording]) -> Option<String> {
    let prepared = recordings
        .iter()
        .map(|recording| prepare(&recording.trajectory).ok());
    let paths: Vec<Prepared> = prepared.collect::<Option<_>>()?;
    let (first, others) = paths.split_first()?;
    let farthest_m = others
        .iter()
        .map(|path| rms_m(path, first))
        .fold(0.0, f64::max);
    let reach_m = first
        .xy_m()
        .iter()
        .map(|[x, y]| x.hypot(*y))
        .fold(0.0, f64::max);
    if others.is_empty() || reach_m == 0.0 {
        return None;
    }
    Some(format!(
        "  are these repeats of one run? With the same start and heading, their paths lie up to {:.0} % of their reach apart",
        100.0 * farthest_m / reach_m
    ))
}
