//! Fits the start state of a jointed robot to all samples of a free flight.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use super::linkage::{Attitude, Linkage};
use super::solve::line;
use realgap_path::trajectory::{State, Trajectory};
use realgap_simulation::JointState;

/// Typical errors of a tracker, by which residuals of positions, orientations and joint angles are divided so that they can be
/// added.
const POSITION_M: f64 = 1.5e-3;
const ROTATION_RAD: f64 = 0.012;
const JOINT_RAD: f64 = 0.015;
/// Gauss-Newton converges in a few rounds from a start that is a few degrees off.
const ROUNDS: usize = 8;
/// Number of samples from which the initial guess of the start is computed.
const GUESSED: usize = 8;
/// The fit has converged if the start changes by less than this: radians, and rad/s.
const CONVERGED: f64 = 1e-6;
/// Change of a coordinate of the start by which the flight is differentiated.
const NUDGE: f64 = 1e-5;

/// The recorded samples of one flight, in true lengths.
#[derive(Debug, Clone)]
pub(super) struct Samples {
    pub times_s: Vec<f64>,
    pub positions_m: Vec<Vector3<f64>>,
    pub orientations: Vec<UnitQuaternion<f64>>,
    /// Angles of each joint at all samples, radians.
    pub angles_rad: Vec<Vec<f64>>,
}

impl Samples {
    /// The first `count` samples, joints in the order of the linkage; `None` without orientations or without one of the joints.
    pub fn new(linkage: &Linkage, motion: &Trajectory, count: usize) -> Option<Self> {
        let start_s = motion.times_s()[0];
        let angles_rad = linkage
            .joint_names()
            .map(|name| Some(motion.joint(name)?.angles_rad[..count].to_vec()))
            .collect::<Option<_>>()?;
        Some(Self {
            times_s: motion.times_s()[..count]
                .iter()
                .map(|t| t - start_s)
                .collect(),
            positions_m: motion.positions_world_m()[..count].to_vec(),
            orientations: motion.orientations_world_from_body()?[..count].to_vec(),
            angles_rad,
        })
    }

    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// The first `count` samples.
    fn beginning(&self, count: usize) -> Self {
        Self {
            times_s: self.times_s[..count].to_vec(),
            positions_m: self.positions_m[..count].to_vec(),
            orientations: self.orientations[..count].to_vec(),
            angles_rad: self
                .angles_rad
                .iter()
                .map(|a| a[..count].to_vec())
                .collect(),
        }
    }

    /// An initial guess of the start from differences over the first samples of the flight.
    fn guess(&self) -> Attitude {
        // Only the first samples are used, because the angular velocity of a tumbling body changes during the flight.
        let last = GUESSED.min(self.len()) - 1;
        let span_s = self.times_s[last];
        let turned: Vector3<f64> = self
            .orientations
            .windows(2)
            .take(last)
            .map(|w| (w[0].inverse() * w[1]).scaled_axis())
            .sum();
        Attitude {
            world_from_body: self.orientations[0],
            rate_body_rad_s: turned / span_s,
            angles_rad: self.angles_rad.iter().map(|all| all[0]).collect(),
            speeds_rad_s: self
                .angles_rad
                .iter()
                .map(|all| (all[last] - all[0]) / span_s)
                .collect(),
        }
    }
}

/// The result of fitting a start to one flight.
#[derive(Debug, Clone)]
pub(super) struct JointFit {
    /// Orientation, angular velocity, joint angles and joint speeds at the first sample.
    pub start: Attitude,
    /// Centre of mass of the whole robot at the first sample, world frame, metres.
    pub centre_m: Vector3<f64>,
    /// Velocity of the centre of mass at the first sample, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Residuals of every sample: position (metres), turn (radians), joints (radians).
    pub residuals: Vec<Residual>,
}

/// The residual of a fit at one sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Residual {
    /// Recorded minus fitted position of the tracked point, world frame, metres.
    pub position_m: Vector3<f64>,
    /// Turn from the fitted to the recorded orientation, body frame, radians.
    pub turn_rad: Vector3<f64>,
    /// Recorded minus fitted joint angles, radians, within half a turn.
    pub joints_rad: Vec<f64>,
}

impl Residual {
    /// The residual at one sample, from the residual of the position and the fitted attitude.
    pub fn of(
        samples: &Samples,
        sample: usize,
        position_m: Vector3<f64>,
        fitted: &Attitude,
    ) -> Self {
        let turned = fitted.world_from_body.inverse() * samples.orientations[sample];
        let joints = samples.angles_rad.iter().zip(&fitted.angles_rad);
        Self {
            position_m,
            turn_rad: turned.scaled_axis(),
            joints_rad: joints
                .map(|(recorded, fitted)| {
                    let error = recorded[sample] - fitted;
                    error - TAU * (error / TAU).round()
                })
                .collect(),
        }
    }

    fn weighted(&self) -> impl Iterator<Item = f64> {
        let position = self.position_m / POSITION_M;
        let turn = self.turn_rad / ROTATION_RAD;
        let joints: Vec<f64> = self.joints_rad.iter().map(|e| e / JOINT_RAD).collect();
        [position.x, position.y, position.z, turn.x, turn.y, turn.z]
            .into_iter()
            .chain(joints)
    }
}

impl JointFit {
    /// State of the tracked part and the joints at the first sample.
    pub fn state(&self, linkage: &Linkage) -> (State, Vec<JointState>) {
        let start = &self.start;
        let turn = start.world_from_body;
        let arm_m = linkage.centre_m(&start.angles_rad);
        let arm_velocity = start.rate_body_rad_s.cross(&arm_m) + linkage.centre_velocity_m_s(start);
        let state = State {
            position_world_m: self.centre_m - turn * arm_m,
            orientation_world_from_body: turn,
            velocity_world_m_s: self.velocity_m_s - turn * arm_velocity,
            angular_velocity_body_rad_s: start.rate_body_rad_s,
        };
        let joints = start.angles_rad.iter().zip(&start.speeds_rad_s);
        let joints = joints.map(|(angle_rad, speed_rad_s)| JointState {
            angle_rad: *angle_rad,
            speed_rad_s: *speed_rad_s,
        });
        (state, joints.collect())
    }

    /// All residuals, each divided by the typical error of a tracker.
    pub fn weighted(&self) -> DVector<f64> {
        let values: Vec<f64> = self.residuals.iter().flat_map(Residual::weighted).collect();
        DVector::from_vec(values)
    }

    /// Root mean square of all residuals, each divided by the typical error of a tracker.
    pub fn misfit(&self) -> f64 {
        let weighted = self.weighted();
        weighted.norm() / (weighted.len() as f64).sqrt()
    }

    /// Root mean square of the residuals of the positions, metres.
    pub fn residual_m(&self) -> f64 {
        let squares = self
            .residuals
            .iter()
            .map(|one| one.position_m.norm_squared());
        (squares.sum::<f64>() / self.residuals.len() as f64).sqrt()
    }
}

/// Simulates the flight from a given start; the centre of mass moves on the parabola that fits the samples best. `None` if the
/// simulation fails.
pub(super) fn flown(
    linkage: &Linkage,
    gravity_m_s2: f64,
    samples: &Samples,
    start: &Attitude,
) -> Option<JointFit> {
    let flight = linkage.fly(start, &samples.times_s)?;
    let times_s = &samples.times_s;
    let arms: Vec<Vector3<f64>> = flight
        .iter()
        .map(|a| a.world_from_body * linkage.centre_m(&a.angles_rad))
        .collect();
    let fall = |t: f64| Vector3::z() * (0.5 * gravity_m_s2 * t * t);
    let centres: Vec<Vector3<f64>> = times_s
        .iter()
        .zip(&samples.positions_m)
        .zip(&arms)
        .map(|((t, p), arm)| p + arm + fall(*t))
        .collect();
    let (centre_m, velocity_m_s) = line(times_s, &centres);
    let residuals = (0..samples.len())
        .map(|k| {
            let position_m = centres[k] - centre_m - velocity_m_s * times_s[k];
            Residual::of(samples, k, position_m, &flight[k])
        })
        .collect();
    Some(JointFit {
        start: start.clone(),
        centre_m,
        velocity_m_s,
        residuals,
    })
}

/// A start changed by `step`: turn (body frame, radians), angular velocity, joint angles, joint speeds.
fn moved(start: &Attitude, step: &DVector<f64>) -> Attitude {
    let joints = start.angles_rad.len();
    let part = |from: usize| Vector3::new(step[from], step[from + 1], step[from + 2]);
    let sum = |values: &[f64], from: usize| -> Vec<f64> {
        let values = values.iter().enumerate();
        values.map(|(k, value)| value + step[from + k]).collect()
    };
    Attitude {
        world_from_body: start.world_from_body * UnitQuaternion::from_scaled_axis(part(0)),
        rate_body_rad_s: start.rate_body_rad_s + part(3),
        angles_rad: sum(&start.angles_rad, 6),
        speeds_rad_s: sum(&start.speeds_rad_s, 6 + joints),
    }
}

/// Jacobian of the weighted residuals with respect to the start, by finite differences.
pub(super) fn slopes(
    linkage: &Linkage,
    gravity_m_s2: f64,
    samples: &Samples,
    fit: &JointFit,
) -> Option<DMatrix<f64>> {
    let here = fit.weighted();
    let size = 6 + 2 * fit.start.angles_rad.len();
    let mut slopes = DMatrix::zeros(here.len(), size);
    for column in 0..size {
        let mut step = DVector::zeros(size);
        step[column] = NUDGE;
        let there = flown(linkage, gravity_m_s2, samples, &moved(&fit.start, &step))?;
        slopes.set_column(column, &((there.weighted() - &here) / NUDGE));
    }
    Some(slopes)
}

/// The start that fits all samples best, by Gauss-Newton; `None` if Gauss-Newton fails.
pub(super) fn fit(
    linkage: &Linkage,
    gravity_m_s2: f64,
    samples: &Samples,
    from: Option<&Attitude>,
) -> Option<JointFit> {
    let guess = match from {
        Some(start) => start.clone(),
        None => {
            // The first samples are fitted first, then twice as many and so on, because Gauss-Newton does not converge on a long
            // flight if the guess of the angular velocity is wrong.
            let mut guess = samples.guess();
            let mut count = GUESSED;
            while count < samples.len() {
                guess = converge(linkage, gravity_m_s2, &samples.beginning(count), guess)?.start;
                count *= 2;
            }
            guess
        }
    };
    converge(linkage, gravity_m_s2, samples, guess)
}

/// Gauss-Newton from an initial guess.
fn converge(
    linkage: &Linkage,
    gravity_m_s2: f64,
    samples: &Samples,
    guess: Attitude,
) -> Option<JointFit> {
    let mut best = flown(linkage, gravity_m_s2, samples, &guess)?;
    for _ in 0..ROUNDS {
        let slopes = slopes(linkage, gravity_m_s2, samples, &best)?;
        let here = best.weighted();
        let normal = slopes.transpose() * &slopes;
        let step = normal.cholesky()?.solve(&-(slopes.transpose() * &here));
        let mut share = 1.0;
        let mut next = None;
        // A step that increases the residuals is halved.
        for _ in 0..6 {
            let tried = flown(
                linkage,
                gravity_m_s2,
                samples,
                &moved(&best.start, &(&step * share)),
            );
            if let Some(fit) = tried.filter(|fit| fit.weighted().norm() <= here.norm()) {
                next = Some(fit);
                break;
            }
            share *= 0.5;
        }
        let Some(fit) = next else { break };
        best = fit;
        if step.amax() * share < CONVERGED {
            break;
        }
    }
    Some(best)
}
