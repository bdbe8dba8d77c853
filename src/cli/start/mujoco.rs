//! `realgap start --engine mujoco`: a study that simulates the user's own model in MuJoCo, as it is.

mod model;
mod parameter;

use realgap::calibration::{CommandConsent, ExpectedNoise, Overrides, RunStart, Study};
use realgap::file::Source;
use realgap::trajectory::{Reading, Recording, read_all};

use super::super::kit::*;
use super::super::shell;
use super::proposal::{Proposal, budget};
use super::{Caller, Request, Started, file_text, in_study, reading_text};
use model::Model;

/// Recordings that are simulated before the study is written.
const MOST: usize = 2;
/// How files of models end that MuJoCo loads.
const MODELS: [&str; 3] = ["xml", "mjcf", "urdf"];

/// The parts of a study of MuJoCo.
struct Draft {
    /// The fields of the simulator beside its model.
    simulator: Vec<String>,
    /// Whether runs start from recorded values.
    starts_recorded: bool,
    metric: &'static str,
    parameters: Vec<Proposal>,
    noise: String,
    /// Assumptions, each with its evidence.
    clues: Vec<(String, String)>,
}

impl Request {
    /// Makes the study and writes it.
    pub(super) fn study_in_mujoco(&self, caller: &impl Caller) -> Result<Started> {
        let (file, recordings) = self.model_and_recordings()?;
        let model = Model::ask(self.python(), &file)?;
        let size_m = model.body_length_m;
        let joints: Vec<String> = model.joints.iter().map(|j| j.name.clone()).collect();
        let guess = self.inferred(&recordings, (&joints, size_m), caller, |_| Ok(None))?;
        let mut read: Vec<Recording> = Vec::new();
        for path in &recordings {
            read.extend(read_all(path, &guess.reading)?);
        }
        let mut draft = self.draft(&model, &file, &read)?;
        let found = guess
            .evidence
            .iter()
            .map(|e| (e.finding.clone(), e.reason.clone()));
        draft.clues.splice(0..0, found);
        let text = self.study_of_mujoco(&draft, &file, &recordings, &guess.reading)?;
        // Who asks for this engine has consented to it.
        let overrides = Overrides {
            command: CommandConsent::Given,
            ..Overrides::default()
        };
        let study = Study::parse(&Source::new(&self.output, text.clone()), &overrides)?;
        let prior = caller.during(2 * MOST, |run| study.prior_runs(MOST, run))?;
        output::write_ron(&self.output, &text)?;
        let mut lines = Vec::new();
        if prior.diverged() > 0 {
            lines.push(format!(
                "doubt: {} of {} fail before the fit: `realgap evaluate {} --allow-command` says why",
                prior.diverged(),
                counted(prior.runs.len(), "run"),
                shell::path(&self.output)
            ));
        }
        lines.push(format!(
            "{} of {} in MuJoCo {}, read as follows:",
            counted(read.len(), "recording"),
            file.display(),
            model.version
        ));
        lines.extend(
            draft
                .clues
                .iter()
                .map(|(what, because)| format!("  {what}: {because}")),
        );
        lines.push(format!(
            "written {}, {}; next: realgap {}",
            self.output.display(),
            match lines[0].starts_with("doubt") {
                false => "which is valid",
                true => "which is valid, but answers nothing before this doubt is settled",
            },
            next(&draft).replace("STUDY", &shell::path(&self.output).to_string())
        ));
        Ok(Started {
            lines,
            warnings: study.warnings().to_vec(),
        })
    }

    fn python(&self) -> &str {
        self.python.as_deref().unwrap_or("python3")
    }

    /// Separates the recordings from the model.
    fn model_and_recordings(&self) -> Result<(PathBuf, Vec<PathBuf>)> {
        let is_model = |path: &PathBuf| {
            let ending = path
                .extension()
                .map(|e| e.to_string_lossy().to_ascii_lowercase());
            ending.is_some_and(|ending| MODELS.contains(&ending.as_str()))
        };
        let (models, recordings): (Vec<_>, Vec<_>) = self.files.iter().cloned().partition(is_model);
        let form = "realgap start runs/*.csv scene.xml --engine mujoco";
        match (models.as_slice(), recordings.is_empty()) {
            ([model], false) => Ok((model.clone(), recordings)),
            (_, true) => Err(Error::usage("no recording is named")
                .found("models alone")
                .hint(format!("name recordings, too: {form}"))),
            (all, false) => Err(
                Error::usage("a study of MuJoCo has one model and its recordings")
                    .found(counted(all.len(), "model"))
                    .allowed("one file that ends in .xml, .mjcf or .urdf")
                    .hint(form),
            ),
        }
    }

    /// What the recordings and the model say.
    fn draft(&self, model: &Model, file: &Path, recordings: &[Recording]) -> Result<Draft> {
        let is_of_joints = recordings.iter().all(|r| r.trajectory.is_of_joints());
        let gains = match self.pd.as_slice() {
            [] => None,
            [one] => Some(one.of_every_joint().ok_or_else(one_pair)?),
            _ => return Err(one_pair()),
        };
        let first = &recordings[0];
        let mut clues = Vec::new();
        let commands = model.commands(recordings)?;
        let mut simulator = Vec::new();
        if let Some((kp, kd)) = gains {
            simulator.push(format!("pd: ({kp:?}, {kd:?})"));
        }
        model.check_gains(&commands, gains.is_some(), &first.path)?;
        if is_of_joints && model.free_joints > 0 {
            simulator.push("hold: true".to_owned());
            clues.push((
                "the base is held".to_owned(),
                "joints alone were recorded, so that free joints are taken out".to_owned(),
            ));
        }
        if let [key, more @ ..] = model.keyframes.as_slice() {
            simulator.push(format!("keyframe: {key:?}"));
            let others = match more {
                [] => String::new(),
                more => format!("; the model also has {}", more.join(", ")),
            };
            clues.push((
                "what was not recorded starts as in a keyframe".to_owned(),
                format!("the model's first is {key:?}{others}"),
            ));
        }
        if let Some(python) = &self.python {
            simulator.push(format!("python: {python:?}"));
        }
        let is_posed = recordings.iter().all(|r| {
            let motion = &r.trajectory;
            !motion.is_planar() && motion.orientations_world_from_body().is_some()
        });
        if !is_of_joints && model.free_joints == 0 {
            return Err(Error::usage("a path was recorded, and no body of the model is free to follow it")
                .at_file(file)
                .found("a model without free joints")
                .allowed(format!("a body or site whose pose is compared: {}", model.bodies.join(", ")))
                .hint("give the body a <freejoint/>, or write the study by hand, with `track` in its MujocoModel"));
        }
        let (parameters, found) = match is_of_joints {
            true => parameter::of_joints(model, recordings, &commands, gains)?,
            false => parameter::of_contacts(model, file)?,
        };
        clues.extend(found);
        clues.push((
            "scores and intervals allow for the timestep".to_owned(),
            format!(
                "the model's own ({:?} s), a half and a quarter of it are settings of the simulator",
                model.timestep_s
            ),
        ));
        let (noise, metric) = match is_of_joints {
            true => (String::new(), "joints"),
            false => {
                let start = match is_posed {
                    true => RunStart::Recorded,
                    false => RunStart::Settled,
                };
                let expected = ExpectedNoise::of(recordings, start, false);
                clues.push((
                    "the camera's noise (`noise`)".to_owned(),
                    expected.because(),
                ));
                let text = super::noise::camera_section(&expected);
                (text, if is_posed { "pose" } else { "rms" })
            }
        };
        Ok(Draft {
            simulator,
            starts_recorded: is_of_joints || is_posed,
            metric,
            parameters,
            noise,
            clues,
        })
    }

    /// The study's text.
    fn study_of_mujoco(
        &self,
        draft: &Draft,
        model: &Path,
        recordings: &[PathBuf],
        reading: &Reading,
    ) -> Result<String> {
        let file = in_study(&self.output, model)?;
        let simulator = match draft.simulator.is_empty() {
            true => format!("Mujoco({file})"),
            false => format!("MujocoModel(model: {file}, {})", draft.simulator.join(", ")),
        };
        let mut names = String::new();
        for path in recordings {
            names += &format!("        {},\n", in_study(&self.output, path)?);
        }
        let clues: String = draft
            .clues
            .iter()
            .map(|(what, because)| format!("    // {what}: {}\n", because.replace('\n', " ")))
            .collect();
        let start = match draft.starts_recorded {
            true => "    start: FromRecording, // each run starts with the first recorded values\n",
            false => "    start: Settled, // each run starts as the model does\n",
        };
        let parameters: String = draft.parameters.iter().map(Proposal::line).collect();
        let text = format!(
            "\
// Which of the model's own numbers make it move in MuJoCo as it was recorded (docs/simulator.md)?
//   realgap check STUDY --allow-command     is this file valid, and what is in it?
//   realgap {}
//   realgap apply FOLDER {} -o calibrated.xml     the model with what was found
Study(
    description: \"made by realgap start\",
    simulator: {simulator},
    recordings: [
{names}    ],
{clues}{}{start}    parameters: [ // `python3 -m realgap.mujoco MODEL --list` lists all fields of a model
{parameters}    ],
    metric: \"{}\",
{})
",
            next(draft),
            shell::path(model),
            reading_text(reading)?,
            draft.metric,
            draft.noise
        );
        Ok(file_text(&text, &self.output))
    }
}

/// The command that comes next, with STUDY for the study.
fn next(draft: &Draft) -> String {
    match draft.metric {
        "joints" => format!(
            "tune STUDY --optimizer gauss-newton --budget {} --allow-command",
            budget(draft.parameters.len())
        ),
        _ => "sweep STUDY --allow-command".to_owned(),
    }
}

/// The error of gains that differ from joint to joint.
fn one_pair() -> Error {
    Error::usage("one pair of gains holds for all motors of a model in MuJoCo")
        .field("--pd")
        .found("gains of single joints")
        .allowed("--pd KP,KD, once")
        .hint("give other joints <position> actuators in the model, whose kp and kv are fields")
}
