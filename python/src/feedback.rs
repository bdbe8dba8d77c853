//! A function in Python that commands a robot from its sensor readings and messages during a run.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use realgap::robot::morphology::Assembly;
use realgap::simulation::{
    Controller, Experiment, Film, Log, Run, RunHooks, Sensed, Steer, film_with,
};
use realgap::{Error, Result};
use serde::Deserialize;

/// Default rate of the decisions of a function, Hz.
const RATE_HZ: f64 = 50.0;

/// The controller of a run.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steering {
    controller: Option<PathBuf>,
    seed: Option<u64>,
    step_rate_hz: Option<f64>,
}

impl Steering {
    /// The experiment with its controller: that of the file, or one for a function alone.
    ///
    /// # Errors
    /// Those of [`Controller::read`]; a seed without a controller, which would have no effect.
    pub fn apply(&self, experiment: Experiment, has_step: bool) -> Result<Experiment> {
        let controller = match &self.controller {
            Some(path) => Controller::read(path, &experiment)?,
            None if self.seed.is_some() => {
                return Err(Error::usage("nothing is drawn without a controller")
                    .field("seed")
                    .hint("give a controller= with sensors"));
            }
            None if !has_step => return Ok(experiment),
            None => Controller::bare(RATE_HZ),
        };
        let rate_hz = self.step_rate_hz.unwrap_or(controller.rate_hz);
        let mut steered = experiment
            .with_controller(Controller {
                rate_hz,
                ..controller
            })
            .map_err(|e| match e.field_name() {
                Some("rate_hz") if self.step_rate_hz.is_some() => e.field("step_rate_hz"),
                _ => e,
            })?;
        steered.perturbation.draw = self.seed.map(|seed| (seed, 0));
        Ok(steered)
    }
}

/// A function that is called at every decision.
pub struct Step {
    call: Py<PyAny>,
    thrown: Mutex<Option<PyErr>>,
}

/// A message: its sender, the position of the sender, the times of sending and arrival, and the strength.
type Heard<'a> = (&'a str, [f64; 3], f64, f64, f64);

impl Step {
    pub fn new(call: Py<PyAny>) -> Self {
        Self {
            call,
            thrown: Mutex::new(None),
        }
    }

    /// The exception that the function raised; it ends the run and is raised unchanged.
    pub fn thrown(&self) -> Option<PyErr> {
        self.thrown
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }

    /// Calls the function: names of servos with their new commands.
    fn ask(&self, names: &Names<'_>, sensed: &Sensed) -> Result<Vec<(String, f64)>> {
        Python::attach(|py| {
            let readings: Vec<(&str, Option<f64>)> =
                pairs(&names.sensors, &sensed.readings).collect();
            let angles: Vec<(&str, f64)> = pairs(&names.hinges, &sensed.angles_rad).collect();
            let heard = sensed.heard.iter().map(|heard| -> Heard<'_> {
                let (from, at_m) = (names.robots[heard.from], heard.position_m);
                let (sent_s, arrived_s) = (heard.sent_s, heard.arrived_s);
                (from, at_m, sent_s, arrived_s, heard.strength_dbm)
            });
            let heard: Vec<Heard<'_>> = heard.collect();
            let robot = names.robots[sensed.robot];
            let place = sensed.position_m;
            self.call
                .call1(py, (robot, sensed.time_s, place, readings, angles, heard))
                .and_then(|told| told.extract::<Vec<(String, f64)>>(py))
        })
        .map_err(|cause| {
            let mut thrown = self.thrown.lock().unwrap_or_else(PoisonError::into_inner);
            *thrown = Some(cause);
            Error::invalid("the function `step` raised")
        })
    }
}

fn pairs<'a, T: Copy>(names: &'a [&'a str], of: &'a [T]) -> impl Iterator<Item = (&'a str, T)> {
    names.iter().copied().zip(of.iter().copied())
}

/// Names of robots, sensors and hinges.
struct Names<'a> {
    robots: Vec<&'a str>,
    sensors: Vec<&'a str>,
    hinges: Vec<&'a str>,
}

impl<'a> Names<'a> {
    fn of(assembly: &'a Assembly, controller: &'a Controller) -> Self {
        let others = controller.others.iter().map(|other| other.name.as_str());
        Self {
            robots: std::iter::once(controller.name.as_str())
                .chain(others)
                .collect(),
            sensors: controller.sensors.iter().map(|s| s.name.as_str()).collect(),
            hinges: assembly.hinges.iter().map(|h| h.name.as_str()).collect(),
        }
    }
}

/// Simulates an experiment until `stop` is set; a `step` is called at every decision.
pub fn film(
    experiment: &Experiment,
    step: Option<&Step>,
    stop: &AtomicBool,
) -> Result<(Run, Option<Film>, Log)> {
    let mut clock = |share: f64| {
        if stop.load(Ordering::Relaxed) {
            let at_s = share * experiment.duration_s;
            return Err(
                Error::interrupted(format!("interrupted at t_s = {at_s:.3}"))
                    .hint("run it again; the same numbers come out"),
            );
        }
        Ok(())
    };
    let hooks = RunHooks {
        clock: Some(&mut clock),
        ..RunHooks::default()
    };
    let (Some(controller), Some(step)) = (&experiment.controller, step) else {
        return film_with(experiment, hooks);
    };
    let names = Names::of(&experiment.assembly, controller);
    let mut feedback = |sensed: &Sensed, steering: &mut [Steer]| {
        for (name, value) in step.ask(&names, sensed)? {
            let mut hinges = experiment.assembly.hinges.iter();
            let hinge = hinges.position(|h| h.name == name && h.actuator.is_some());
            let Some(hinge) = hinge else {
                let hinges = experiment.assembly.hinges.iter();
                let driven = hinges.filter(|hinge| hinge.actuator.is_some());
                let driven: Vec<&str> = driven.map(|hinge| hinge.name.as_str()).collect();
                return Err(Error::usage("no servo of this name")
                    .field("step")
                    .found(name)
                    .allowed(driven.join(", ")));
            };
            steering[hinge] = Steer::Hold(value);
        }
        Ok(())
    };
    let hooks = RunHooks {
        feedback: Some(&mut feedback),
        ..hooks
    };
    film_with(experiment, hooks)
}
