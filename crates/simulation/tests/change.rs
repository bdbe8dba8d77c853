//! Test helpers: small changes to an experiment with a servo, and the recorded motion of its hinge.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::sync::Arc;

use realgap_path::trajectory::JointTrack;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Between, CommandTrack, Experiment, JointFormulation, JointState, run};

/// Small changes to an experiment, one after the other.
pub trait Change: Into<Experiment> {
    fn with(self, change: impl FnOnce(&mut Experiment)) -> Experiment {
        let mut experiment = self.into();
        change(&mut experiment);
        experiment
    }
    fn with_commands(
        self,
        times_s: &[f64],
        angles_rad: &[f64],
        off_from_s: Option<f64>,
    ) -> Experiment {
        let track = CommandTrack::new(times_s.to_vec(), angles_rad.to_vec(), off_from_s).unwrap();
        let track = track.with(Between::Interpolated);
        self.with(|e| {
            e.commands.insert("shaft".to_owned(), Arc::new(track));
        })
    }
    fn off(self) -> Experiment {
        self.with_commands(&[0.0], &[0.0], Some(0.0))
    }
    fn from(self, angle_rad: f64, speed_rad_s: f64) -> Experiment {
        self.with(|e| {
            e.start_joints = vec![JointState {
                angle_rad,
                speed_rad_s,
            }];
        })
    }
    fn weightless(self) -> Experiment {
        self.with(|e| e.gravity_m_s2 = 0.0)
    }
    fn joined(self, kind: JointFormulation) -> Experiment {
        self.with(|e| e.solver.joint = kind)
    }
    fn lasting(self, duration_s: f64) -> Experiment {
        self.with(|e| e.duration_s = duration_s)
    }
    fn set(self, name: &str, value: f64) -> Experiment {
        let assignment = format!("{name}={value}").parse().unwrap();
        ParameterSet::new().with(assignment).apply(&self.into())
    }
}

impl Change for Experiment {}

pub fn film(experiment: &Experiment) -> (Vec<f64>, JointTrack) {
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    (motion.times_s().to_vec(), motion.joints()[0].clone())
}
