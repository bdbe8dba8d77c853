//! One run of one robot: everything that moved, as arrays.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use realgap::calibration::Fitted;
use realgap::file::Source;
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::simulation::{
    Between, CommandTrack, Experiment, Film, JointFormulation, Outcome, Sampling,
};
use realgap::trajectory::{self, write_with_bodies};
use realgap::{Error, Result, Warning};
use serde::Deserialize;
use serde_json::json;

use crate::array;
use crate::error::Raise;
use crate::feedback::{self, Steering, Step};
use crate::robot::Robot;
use crate::running::{self, Way};
use crate::text::{of_text, to_text};
use crate::trajectory::Trajectory;

/// Times and angles of a hinge.
type CommandBytes = (String, Vec<u8>, Vec<u8>);

/// Settings of a run; `None` means the default of the command.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    duration_s: f64,
    rate_hz: f64,
    set: BTreeMap<String, f64>,
    parameters: Vec<PathBuf>,
    timestep_s: Option<f64>,
    substeps: Option<usize>,
    joint: Option<String>,
    arena: Option<PathBuf>,
    energy: bool,
    steering: Steering,
}

/// Values of parameters, from files first.
pub fn values(files: &[PathBuf], set: &BTreeMap<String, f64>) -> Result<ParameterSet> {
    Ok(fitted(files, set)?.values)
}

/// The same values, with the posterior draws of the fits in the files.
pub fn fitted(files: &[PathBuf], set: &BTreeMap<String, f64>) -> Result<Fitted> {
    let set = set
        .iter()
        .map(|(name, value)| Assignment::new(name, *value));
    let set: Result<ParameterSet> = set.collect();
    Ok(Fitted::read(files)?.with_values(&set.map_err(Error::into_usage)?))
}

fn joint_kind(name: &str) -> Result<JointFormulation> {
    match name {
        "auto" => Ok(JointFormulation::Auto),
        "multibody" => Ok(JointFormulation::Multibody),
        "impulse" => Ok(JointFormulation::Impulse),
        other => Err(Error::usage("not a kind of joint")
            .field("joint")
            .found(other)
            .allowed("auto, multibody, impulse")),
    }
}

/// The result of a run.
#[pyclass(frozen, module = "realgap._native")]
pub struct Simulation {
    robot: String,
    film: Film,
    info: String,
    others: Vec<(String, trajectory::Trajectory)>,
    /// A table with one row per decision; empty without a controller.
    decisions: String,
}

/// Simulates a robot from rest. `commands` replace the gaits of servos, by hinge; `step` is called at every decision of a
/// controller.
#[pyfunction]
#[pyo3(signature = (robot, settings, times_s, commands, step))]
pub fn simulate(
    py: Python<'_>,
    robot: &Robot,
    settings: &str,
    times_s: Option<&[u8]>,
    commands: Vec<CommandBytes>,
    step: Option<Py<PyAny>>,
) -> PyResult<Simulation> {
    let step = step.map(Step::new);
    let (experiment, mut warnings) =
        experiment(robot, settings, times_s, &commands, step.is_some()).or_raise(py)?;
    let way = Way {
        jobs: Some(1),
        progress: None,
    };
    let filmed = running::run(py, &way, |options| {
        feedback::film(&experiment, step.as_ref(), options.stop_flag())
    });
    let (run, film, log) = filmed.map_err(|raised| {
        let thrown = step.as_ref().and_then(Step::thrown);
        thrown.unwrap_or(raised)
    })?;
    warnings.extend(run.warnings.iter().cloned());
    let simulated = || -> Result<Simulation> {
        let Some(film) = film else {
            let why = match &run.outcome {
                Outcome::Diverged(divergence) => divergence.to_string(),
                Outcome::Completed(_) => String::new(),
            };
            return Err(Error::invalid(format!("the simulation diverged {why}"))
                .at_file(robot.morphology.name())
                .hint("try a shorter timestep_s or more substeps; check masses, sizes and servo limits"));
        };
        let info = json!({
            "robot": robot.morphology.name(),
            "steps": run.steps,
            "settle_steps": run.settle_steps,
            "cpu_s": run.cpu.as_secs_f64(),
            "servo_rms_rad": run.servo_rms_rad,
            "energy": run.energy,
            "timestep_s": experiment.solver.timestep_s,
            "substeps": experiment.solver.substeps,
            "engine": experiment.engine_version(),
            "records_joints": experiment.records_joints,
            "warnings": warnings,
        });
        let controller = experiment.controller.as_deref();
        Ok(Simulation {
            robot: robot.morphology.name().to_owned(),
            info: to_text(&info)?,
            film,
            decisions: controller.map_or(String::new(), |controller| log.to_csv(controller)),
            others: log.others,
        })
    };
    simulated().or_raise(py)
}

fn experiment(
    robot: &Robot,
    settings: &str,
    times_s: Option<&[u8]>,
    commands: &[CommandBytes],
    has_step: bool,
) -> Result<(Experiment, Vec<Warning>)> {
    let settings: Settings = of_text("simulate", settings)?;
    let mut experiment = Experiment::new(robot.morphology.assemble());
    experiment.duration_s = settings.duration_s;
    experiment.sampling = match times_s {
        Some(bytes) => Sampling::Times(array::numbers(bytes).into()),
        None => Sampling::Rate(settings.rate_hz),
    };
    if let Some(path) = &settings.arena {
        experiment.enter_arena(&Source::read(path, "arena")?)?;
    }
    let experiment = settings.steering.apply(experiment, has_step)?;
    let values = values(&settings.parameters, &settings.set)?;
    let mut warnings = robot.morphology.warnings();
    warnings.extend(values.without_effect(&experiment));
    let mut experiment = values.apply(&experiment);
    if let Some(timestep_s) = settings.timestep_s {
        experiment.solver.timestep_s = timestep_s;
    }
    if let Some(substeps) = settings.substeps {
        experiment.solver.substeps = substeps;
    }
    if let Some(joint) = &settings.joint {
        experiment.solver.joint = joint_kind(joint)?;
    }
    if settings.energy {
        experiment.energy_from_s = Some(0.0);
    }
    for (hinge, times_s, angles_rad) in commands {
        let hinges = &experiment.assembly.hinges;
        let driven = hinges.iter().filter(|known| known.actuator.is_some());
        let driven: Vec<&str> = driven.map(|known| known.name.as_str()).collect();
        if !driven.contains(&hinge.as_str()) {
            return Err(Error::usage("no servo of this name")
                .field("gait")
                .found(hinge)
                .allowed(driven.join(", ")));
        }
        let (times_s, angles_rad) = (array::numbers(times_s), array::numbers(angles_rad));
        let track = CommandTrack::new(times_s, angles_rad, None)
            .map_err(|error| error.field(format!("gait of {hinge}")))?
            .with(Between::Interpolated);
        experiment.commands.insert(hinge.clone(), Arc::new(track));
    }
    experiment.check().map_err(Error::into_usage)?;
    Ok((experiment, warnings))
}

impl Simulation {
    /// Everything that moved.
    pub fn film(&self) -> &Film {
        &self.film
    }
}

#[pymethods]
impl Simulation {
    fn info(&self) -> &str {
        &self.info
    }

    /// The tracked module, as the command writes it: with joints where the robot's file states hinges.
    fn trajectory(&self, py: Python<'_>, name: &str, with_joints: bool) -> PyResult<Trajectory> {
        let mut motion = self.film.track.clone();
        if !with_joints {
            motion = motion.with_joints(Vec::new()).or_raise(py)?;
        }
        Ok(Trajectory::of(name, motion).stand_in_of(&self.robot))
    }

    /// Positions and orientations of the parts: time, part, coordinate.
    fn parts<'py>(&self, py: Python<'py>) -> (Bound<'py, PyBytes>, Bound<'py, PyBytes>) {
        let samples = 0..self.film.track.len();
        let poses = samples.flat_map(|sample| {
            let parts = self.film.parts.iter().flatten();
            parts.map(move |poses| &poses[sample])
        });
        let places = array::vector_bytes(poses.clone().map(|pose| &pose.translation.vector));
        let turns = array::quaternion_bytes(poses.map(|pose| &pose.rotation));
        (PyBytes::new(py, &places), PyBytes::new(py, &turns))
    }

    /// Angles and speeds of the hinges: time, hinge.
    fn joints<'py>(&self, py: Python<'py>) -> (Bound<'py, PyBytes>, Bound<'py, PyBytes>) {
        let joints = self.film.track.joints();
        let by_time = |of: &dyn Fn(usize, usize) -> f64| {
            let samples = 0..self.film.track.len();
            let all = samples.flat_map(|t| (0..joints.len()).map(move |joint| (t, joint)));
            array::bytes(all.map(|(t, joint)| of(t, joint)).collect::<Vec<_>>())
        };
        let angles = by_time(&|t, joint| joints[joint].angles_rad[t]);
        let speeds = by_time(&|t, joint| match &joints[joint].speeds_rad_s {
            Some(speeds) => speeds[t],
            None => f64::NAN,
        });
        (PyBytes::new(py, &angles), PyBytes::new(py, &speeds))
    }

    /// The other robots' tracked modules, by name, in the frame of the run.
    fn others(&self) -> Vec<(String, Trajectory)> {
        let others = self.others.iter().map(|(name, motion)| {
            let motion = Trajectory::of(name, motion.clone()).stand_in_of(&self.robot);
            (name.clone(), motion)
        });
        others.collect()
    }

    /// The table of decisions, as `realgap simulate --decisions` writes it.
    fn decisions(&self) -> &str {
        &self.decisions
    }

    /// Writes all parts into a CSV file, as `realgap simulate --parts` does.
    fn write_parts(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let write = || write_with_bodies(&path, &self.film.track, &self.film.bodies()?);
        write().or_raise(py)
    }
}
