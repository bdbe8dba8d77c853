//! A run from settling to its last sample, a step at a time.

use std::time::Duration;

use nalgebra::Vector3;

use super::super::energy::Meter;
use super::super::experiment::{Experiment, JointState, Start};
use super::super::outcome::{Divergence, Outcome};
use super::super::path::{Path, between};
use super::super::watch::{Observer, RunHooks, Snapshot};
use super::{Rollout, Run, SETTLE_LIMIT_S};
use crate::control::Steer;
use realgap_core::error::Result;
use realgap_path::trajectory::{State, Trajectory};

/// How far a run has come.
pub(in super::super) struct Course {
    times_s: Vec<f64>,
    path: Path,
    before: (State, Vec<JointState>),
    /// The first sample time that is not reached.
    next: usize,
    origin_world_m: Vector3<f64>,
    timestep_s: f64,
    /// Steps of the whole run.
    pub steps: u64,
}

impl Course {
    /// The motion that was sampled.
    pub fn finish(&mut self) -> Result<Trajectory> {
        std::mem::take(&mut self.path).finish()
    }
}

impl Rollout<'_> {
    /// Angles of the hinges now, by their encoders, radians.
    pub(in super::super) fn angles_rad(&self) -> Vec<f64> {
        let hinges = 0..self.angles_rad.len();
        hinges.map(|index| self.angle_rad(index)).collect()
    }

    /// What servos do in place of their orders, by hinge.
    pub(in super::super) fn steering(&mut self) -> &mut [Steer] {
        &mut self.steering
    }

    pub(super) fn run(&mut self, experiment: &Experiment, hooks: &mut RunHooks<'_>) -> Result<Run> {
        let mut course = match self.begin(experiment, &mut hooks.observer)? {
            Ok(course) => course,
            Err(divergence) => return Ok(self.told(Outcome::Diverged(divergence))),
        };
        for step in 1..=course.steps {
            hooks.tell(step - 1, course.steps)?;
            if let Some(divergence) = self.advance(&mut course, step, &mut hooks.observer) {
                return Ok(self.told(Outcome::Diverged(divergence)));
            }
        }
        let path = course.finish()?;
        Ok(self.told(Outcome::Completed(path)))
    }

    /// The run so far, with this outcome.
    pub(in super::super) fn told(&mut self, outcome: Outcome<Trajectory>) -> Run {
        let hinges = self.assembly.hinges.iter();
        let servos = hinges.filter(|hinge| hinge.actuator.is_some()).count();
        let commands = self.steps * servos as u64;
        let servo_rms_rad = if commands > 0 && outcome.is_completed() {
            (self.squared_error_rad2 / commands as f64).sqrt()
        } else {
            0.0
        };
        let meter = self.meter.as_ref().filter(|_| outcome.is_completed());
        let energy = meter.map(Meter::balance);
        self.warnings
            .extend(energy.and_then(|energy| energy.warning()));
        Run {
            outcome,
            steps: self.steps,
            settle_steps: self.settle_steps,
            cpu: Duration::ZERO,
            servo_rms_rad,
            energy,
            warnings: std::mem::take(&mut self.warnings),
        }
    }

    /// Comes to rest where the experiment asks for it, and takes the first samples.
    pub(in super::super) fn begin(
        &mut self,
        experiment: &Experiment,
        observer: &mut Observer<'_>,
    ) -> Result<std::result::Result<Course, Divergence>> {
        let timestep_s = experiment.solver.timestep_s;
        let origin_world_m = self.track().position_world_m;
        // What is held needs no floor to come to rest on.
        if experiment.start == Start::Settled && self.assembly.world_from_mount.is_none() {
            if let Some(why) = self.settle(timestep_s, &origin_world_m) {
                let at_s = (self.settle_steps as f64 * timestep_s) - SETTLE_LIMIT_S;
                let at_s = at_s.min(0.0);
                return Ok(Err(Divergence { at_s, why }));
            }
            self.squared_error_rad2 = 0.0;
        }
        let times_s = experiment.sample_times_s();
        let mut path = Path::with_capacity(times_s.len());
        if self.records_joints {
            let hinges = self.assembly.hinges.iter();
            path.joint_names = hinges.map(|hinge| hinge.name.clone()).collect();
        }
        if let Some(observer) = observer {
            observer(&Snapshot::take(0.0, self.assembly, self.world.as_ref()));
        }
        if let Some(meter) = &mut self.meter {
            meter.start(self.assembly, self.world.as_ref());
        }
        let before = self.sample();
        let mut next = 0;
        while next < times_s.len() && times_s[next] <= 0.0 {
            path.push(times_s[next], &before);
            next += 1;
        }
        let end_s = experiment.duration_s.max(times_s[times_s.len() - 1]);
        Ok(Ok(Course {
            steps: (end_s / timestep_s - 1e-9).ceil() as u64,
            times_s,
            path,
            before,
            next,
            origin_world_m,
            timestep_s,
        }))
    }

    /// Takes a step, from 1, and the samples within it.
    pub(in super::super) fn advance(
        &mut self,
        course: &mut Course,
        step: u64,
        observer: &mut Observer<'_>,
    ) -> Option<Divergence> {
        let timestep_s = course.timestep_s;
        let (from_s, to_s) = ((step - 1) as f64 * timestep_s, step as f64 * timestep_s);
        self.step(from_s, to_s);
        self.steps = step;
        if let Some(why) = self.absurd(&course.origin_world_m) {
            return Some(Divergence { at_s: to_s, why });
        }
        if let Some(meter) = &mut self.meter {
            meter.read(self.assembly, self.world.as_ref(), from_s, &self.efforts);
        }
        if let Some(observer) = observer {
            observer(&Snapshot::take(to_s, self.assembly, self.world.as_ref()));
        }
        let after = self.sample();
        let times_s = &course.times_s;
        while course.next < times_s.len()
            && times_s[course.next] <= to_s + 1e-9 * timestep_s.max(1e-3)
        {
            let share = ((times_s[course.next] - from_s) / timestep_s).clamp(0.0, 1.0);
            let sample = between(&course.before, &after, share);
            course.path.push(times_s[course.next], &sample);
            course.next += 1;
        }
        course.before = after;
        None
    }
}
