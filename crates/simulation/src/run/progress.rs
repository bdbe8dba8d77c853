//! Progress of a run from settling to its last sample, one step at a time.

use std::time::Duration;

use nalgebra::Vector3;

use super::super::energy::EnergyMeter;
use super::super::experiment::{Experiment, JointState, Start};
use super::super::outcome::{Divergence, Outcome};
use super::super::path::{Path, between};
use super::super::watch::{Observer, RunHooks, Snapshot};
use super::{Rollout, Run, SETTLE_LIMIT_S};
use crate::control::Steer;
use realgap_core::error::Result;
use realgap_path::trajectory::{State, Trajectory};

/// Progress of a run: its samples so far, and the next sample time.
pub(in super::super) struct RunProgress {
    times_s: Vec<f64>,
    path: Path,
    before: (State, Vec<JointState>),
    /// Index of the first sample time that has not been reached.
    next: usize,
    origin_world_m: Vector3<f64>,
    timestep_s: f64,
    /// Number of steps of the whole run.
    pub steps: u64,
}

impl RunProgress {
    /// The sampled trajectory.
    pub fn finish(&mut self) -> Result<Trajectory> {
        std::mem::take(&mut self.path).finish()
    }
}

impl Rollout<'_> {
    /// Present angles of the hinges as their encoders read them, radians.
    pub(in super::super) fn angles_rad(&self) -> Vec<f64> {
        let hinges = 0..self.angles_rad.len();
        hinges.map(|index| self.angle_rad(index)).collect()
    }

    /// Commands of the controller in place of the servos' own commands, by hinge.
    pub(in super::super) fn steering(&mut self) -> &mut [Steer] {
        &mut self.steering
    }

    pub(super) fn run(&mut self, experiment: &Experiment, hooks: &mut RunHooks<'_>) -> Result<Run> {
        let mut progress = match self.begin(experiment, &mut hooks.observer)? {
            Ok(progress) => progress,
            Err(divergence) => {
                return Ok(
                    self.take_run(Outcome::Diverged(divergence.with_stiff_joint(experiment)))
                );
            }
        };
        for step in 1..=progress.steps {
            hooks.report_progress(step - 1, progress.steps)?;
            if let Some(divergence) = self.advance(&mut progress, step, &mut hooks.observer) {
                let divergence = divergence.with_stiff_joint(experiment);
                return Ok(self.take_run(Outcome::Diverged(divergence)));
            }
        }
        let path = progress.finish()?;
        Ok(self.take_run(Outcome::Completed(path)))
    }

    /// The run up to now, with this outcome.
    pub(in super::super) fn take_run(&mut self, outcome: Outcome<Trajectory>) -> Run {
        let hinges = self.assembly.hinges.iter();
        let servos = hinges.filter(|hinge| hinge.actuator.is_some()).count();
        let commands = self.steps * servos as u64;
        let servo_rms_rad = if commands > 0 && outcome.is_completed() {
            (self.squared_error_rad2 / commands as f64).sqrt()
        } else {
            0.0
        };
        let meter = self.meter.as_ref().filter(|_| outcome.is_completed());
        let energy = meter.map(EnergyMeter::balance);
        self.warnings
            .extend(energy.and_then(|energy| energy.warning()));
        if outcome.is_completed() && self.experiment.contact.is_on {
            let touched = self.world.touched_regions();
            self.warnings.extend(self.experiment.untouched(touched));
        }
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

    /// Lets the robot settle if the experiment states a settled start, and takes the first samples.
    pub(in super::super) fn begin(
        &mut self,
        experiment: &Experiment,
        observer: &mut Observer<'_>,
    ) -> Result<std::result::Result<RunProgress, Divergence>> {
        let timestep_s = experiment.solver.timestep_s;
        let origin_world_m = self.track().position_world_m;
        // A mounted robot does not settle on the floor.
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
        path.instrument_names = self.instruments.columns();
        if let Some(observer) = observer {
            observer(&Snapshot::take(0.0, self.assembly, self.world.as_ref()));
        }
        if let Some(meter) = &mut self.meter {
            meter.start(self.assembly, self.world.as_ref());
        }
        let before = self.sample();
        let mut next = 0;
        while next < times_s.len() && times_s[next] <= 0.0 {
            path.push(times_s[next], &before, self.instruments.readings());
            next += 1;
        }
        let end_s = experiment.duration_s.max(times_s[times_s.len() - 1]);
        Ok(Ok(RunProgress {
            steps: (end_s / timestep_s - 1e-9).ceil() as u64,
            times_s,
            path,
            before,
            next,
            origin_world_m,
            timestep_s,
        }))
    }

    /// Advances by step number `step` (from 1), and takes the samples within it.
    pub(in super::super) fn advance(
        &mut self,
        progress: &mut RunProgress,
        step: u64,
        observer: &mut Observer<'_>,
    ) -> Option<Divergence> {
        let timestep_s = progress.timestep_s;
        let (from_s, to_s) = ((step - 1) as f64 * timestep_s, step as f64 * timestep_s);
        self.step(from_s, to_s);
        self.steps = step;
        if let Some(why) = self.divergence_reason(&progress.origin_world_m) {
            return Some(Divergence { at_s: to_s, why });
        }
        if let Some(meter) = &mut self.meter {
            meter.read(self.assembly, self.world.as_ref(), from_s, &self.efforts);
        }
        if let Some(observer) = observer {
            observer(&Snapshot::take(to_s, self.assembly, self.world.as_ref()));
        }
        let after = self.sample();
        let times_s = &progress.times_s;
        while progress.next < times_s.len()
            && times_s[progress.next] <= to_s + 1e-9 * timestep_s.max(1e-3)
        {
            let share = ((times_s[progress.next] - from_s) / timestep_s).clamp(0.0, 1.0);
            let sample = between(&progress.before, &after, share);
            let readings = self.instruments.readings();
            progress
                .path
                .push(times_s[progress.next], &sample, readings);
            progress.next += 1;
        }
        progress.before = after;
        None
    }
}
