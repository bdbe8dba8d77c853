//! Somebody else's simulator behind the interface of our own.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use super::failure::{Answered, Failure};
use super::motion::motion;
use super::port::{Port, Question};
use super::protocol::{CommandsAsked, HELLO, Hello, ParameterDeclaration, RunAnswer, RunQuestion};
use super::table;
use realgap_core::file::unknown_name;
use realgap_core::{Code, Error, Result, Warning};
use realgap_path::trajectory::Trajectory;
use realgap_simulation::parameter::{FOREIGN, Parameter, foreign_parameter};
use realgap_simulation::{Divergence, Experiment, Log, Outcome, Push, Run, RunHooks, Simulator};

/// Somebody else's simulator that has said who it is.
#[derive(Debug)]
pub struct Guest {
    port: Arc<dyn Port>,
    hello: Hello,
    version: &'static str,
    habits: OnceLock<Habits>,
    next: AtomicU64,
}

/// What two first questions have shown.
#[derive(Debug, Clone)]
struct Habits {
    /// Whether the same question has the same answer.
    is_deterministic: bool,
    /// Whether another seed, or the same once more, gives another answer.
    is_random: bool,
    /// The joints of its answers.
    joints: Vec<String>,
}

/// Seeds fit into 31 bits, so that every language takes them.
const SEED_BITS: u32 = 31;
/// The other seed of the first questions.
const OTHER_SEED: u64 = 1;

/// A text that lives as long as the program, as versions of engines do.
pub(crate) fn leaked(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

impl Guest {
    /// Asks a simulator who it is.
    ///
    /// # Errors
    /// No answer, or one that is not of the protocol.
    pub fn new(port: Arc<dyn Port>) -> Result<Self> {
        let line = port
            .ask(HELLO, Question::Hello)
            .map_err(|failure| refused(&failure))?;
        let hello = Hello::parse(&line)?;
        let version = format!("{} {}: {}", hello.name, hello.version, port.identity());
        Ok(Self {
            version: leaked(version.replace(" :", ":")),
            port,
            hello,
            habits: OnceLock::new(),
            next: AtomicU64::new(1),
        })
    }

    /// What the simulator says of itself.
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// The declaration and the parameter of this name, with or without `sim.` before it.
    ///
    /// # Errors
    /// A name that the simulator does not declare.
    pub fn parameter(&self, name: &str) -> Result<(&ParameterDeclaration, &'static Parameter)> {
        let all = || self.hello.parameters.iter();
        let own = name
            .strip_prefix(FOREIGN)
            .and_then(|rest| rest.strip_prefix('.'));
        let found = all()
            .find(|declared| declared.name == name)
            .or_else(|| all().find(|declared| Some(declared.name.as_str()) == own));
        let declared = found.ok_or_else(|| {
            unknown_name(
                "parameter of the simulator",
                own.unwrap_or(name),
                all().map(|declared| declared.name.as_str()),
            )
        })?;
        Ok((declared, foreign_parameter(&declared.declared())))
    }

    /// The values that hold where a study states none.
    pub fn defaults(&self) -> BTreeMap<String, f64> {
        let all = self.hello.parameters.iter();
        all.map(|declared| (declared.name.clone(), declared.default))
            .collect()
    }

    fn ask(&self, experiment: &Experiment, seed: u64) -> Answered<Trajectory> {
        let foreign = &experiment.foreign;
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let times_s = experiment.sample_times_s();
        let settings = &self.hello.settings;
        let setting = match settings.len() {
            0 => None,
            count => settings.get((foreign.setting % count as u64) as usize),
        };
        let units = self.hello.parameters.iter();
        let start = &foreign.start;
        let question = RunQuestion {
            ask: "run",
            id,
            parameters: foreign
                .values
                .iter()
                .map(|(name, value)| (name.as_str(), *value))
                .collect(),
            units: units.map(|p| (p.name.as_str(), p.unit.as_str())).collect(),
            seed,
            setting,
            duration_s: experiment.duration_s,
            times_s: &times_s,
            recording: &start.recording,
            start: start
                .values
                .iter()
                .map(|(name, value)| (name.as_str(), true_value(experiment, name, *value)))
                .collect(),
            commands: (!start.commands.is_empty()).then(|| CommandsAsked {
                times_s: &start.times_s,
                channels: start
                    .commands
                    .iter()
                    .map(|(name, all)| (name.as_str(), all.as_slice()))
                    .collect(),
            }),
        };
        let line = serde_json::to_string(&question)
            .map_err(|error| Failure::of_answer(format!("cannot be asked: {error}")))?;
        let line = self.port.ask(&line, Question::Run(id))?;
        self.read(&line, &times_s)
    }

    fn read(&self, line: &str, times_s: &[f64]) -> Answered<Trajectory> {
        let answered = |why: String| Failure::of_answer(format!("answered {why}"));
        let answer: RunAnswer = serde_json::from_str(line).map_err(|error| {
            let is_null = line.contains("null");
            let hint = if is_null { "; null is no number" } else { "" };
            answered(format!(
                "something else than the protocol asks for: {error}{hint}"
            ))
        })?;
        if let Some(why) = answer.failed {
            return Err(Failure::of_answer(format!(
                "says that it failed: {}",
                realgap_core::text::shown(&why, 600)
            )));
        }
        let channels = answer
            .channels
            .into_iter()
            .map(|(name, values)| (name, values.0));
        let mut channels: BTreeMap<String, Vec<f64>> = channels.collect();
        let mut own_s = answer.times_s.map(|values| values.0);
        if let Some(file) = answer.file {
            if own_s.is_some() || !channels.is_empty() {
                return Err(answered("both a file and channels".to_owned()));
            }
            let path = self
                .port
                .folder()
                .map_or_else(|| file.clone(), |folder| folder.join(&file));
            (own_s, channels) = table::read(&path).map_err(answered)?;
        }
        motion(own_s, channels, times_s).map_err(answered)
    }
}

/// Columns of lengths and of speeds along the axes of the world.
const LENGTHS: [&str; 6] = ["x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s"];

/// A recorded first value in true lengths, where the study says how long recorded lengths are: the recording that a run is compared
/// with is scaled alike.
fn true_value(experiment: &Experiment, name: &str, value: f64) -> f64 {
    match LENGTHS.contains(&name) {
        true => value / experiment.recording_length_scale,
        false => value,
    }
}

/// The error of a simulator that cannot be used at all.
fn refused(failure: &Failure) -> Error {
    let error = Error::invalid(format!("the simulator {}", failure.why())).field("simulator");
    let error = match failure.last_words() {
        Some(words) => error.found(format!("its last words: {}", words.replace('\n', " | "))),
        None => error,
    };
    error.hint("run the command by hand; it reads one line of JSON and answers with one line")
}

/// The seed of a run: that of the study's repeats, or 0 for a run without noise.
fn seed_of(experiment: &Experiment) -> u64 {
    let Some((seed, number)) = experiment.perturbation.draw else {
        return 0;
    };
    // A linear congruential generator mixes both numbers (Knuth 1997, MMIX).
    let mix = |value: u64| {
        value
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407)
    };
    mix(mix(seed).wrapping_add(number)) >> (u64::BITS - SEED_BITS)
}

impl Simulator for Guest {
    fn version(&self, _: &Experiment) -> &'static str {
        self.version
    }

    fn run(
        &self,
        experiment: &Experiment,
        pushes: &[Push],
        mut hooks: RunHooks<'_>,
    ) -> Result<(Run, Log)> {
        if !pushes.is_empty() || hooks.observer.is_some() || hooks.feedback.is_some() {
            return Err(Error::invalid(
                "the study's own simulator answers with a whole run: it can be neither watched nor steered step by step",
            ));
        }
        if experiment.energy_from_s.is_some() {
            return Err(Error::invalid(
                "the study's own simulator does not say which energies it computes",
            ));
        }
        hooks.report_progress(0, 1)?;
        let started = Instant::now();
        let answer = self.ask(experiment, seed_of(experiment));
        let cpu: Duration = started.elapsed();
        let outcome = match answer {
            Ok(motion) => Outcome::Completed(motion),
            Err(failure) => Outcome::Diverged(Divergence::failure(failure.to_string())),
        };
        let steps = outcome.get().map_or(0, |motion| motion.len() as u64);
        let run = Run {
            outcome,
            steps,
            settle_steps: 0,
            cpu,
            servo_rms_rad: 0.0,
            energy: None,
            warnings: Vec::new(),
        };
        Ok((run, Log::default()))
    }

    fn vary(&self, experiment: &mut Experiment, number: u64) {
        experiment.foreign.setting = number;
    }

    fn refine(&self, experiment: &mut Experiment, factor: f64) -> bool {
        let number = self.hello.refined(factor);
        experiment.foreign.setting = number.unwrap_or_default() as u64;
        number.is_some()
    }

    fn settings(&self, usual: usize) -> usize {
        let differs = self.habits.get().is_some_and(|habits| habits.is_random);
        match differs {
            true => usual,
            false => self.hello.settings.len().max(1),
        }
    }

    fn joints(&self, _: &Experiment) -> Vec<String> {
        let habits = self.habits.get();
        habits.map_or_else(Vec::new, |habits| habits.joints.clone())
    }

    fn prepare(&self, experiment: &Experiment) -> Result<Vec<Warning>> {
        let habits = match self.habits.get() {
            Some(habits) => habits,
            None => {
                let mut without_noise = experiment.clone();
                without_noise.perturbation.draw = None;
                let ask = |seed: u64| {
                    let answer = self.ask(&without_noise, seed);
                    answer.map_err(|failure| refused(&failure))
                };
                let (first, second) = (ask(0)?, ask(0)?);
                let is_deterministic = first == second;
                // Where even the same seed gives another answer, another seed tells nothing more.
                let is_random = !is_deterministic || first != ask(OTHER_SEED)?;
                let joints = first.joints().iter().map(|joint| joint.name.clone());
                let joints = joints.collect();
                self.habits.get_or_init(|| Habits {
                    is_deterministic,
                    is_random,
                    joints,
                })
            }
        };
        if habits.is_deterministic {
            return Ok(Vec::new());
        }
        Ok(vec![Code::NotReproducible.warning(format!(
            "{} answers the same question with the same seed differently: its repeats count as noise, and results cannot be had again bit by bit",
            self.hello.name
        ))])
    }
}
