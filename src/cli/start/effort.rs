//! What moves a recorded joint, and what it moves: scales of the ranges in which its inertia and friction are searched.

use realgap::calibration::RecordedCommand;
use realgap::robot::morphology::{Assembly, Hinge, ServoLaw};
use realgap::simulation::Quantity;
use realgap::trajectory::{Recording, Trajectory};

/// Speeds are differences over this time, which is long beside an encoder's step and short beside a motion, seconds.
const LAG_S: f64 = 0.05;
/// A joint that moves more slowly tells nothing about viscous friction, rad/s (of a slide m/s).
const SLOWEST_RAD_S: f64 = 1e-3;
/// Friction takes at most this share of the torque that a servo exerts while the joint moves.
const LOST: f64 = 0.5;

/// The scales of one joint.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Effort {
    /// Inertia of all that the joint carries, about its axis in the robot's posture at zero, kg m² (of a slide its mass, kg).
    pub inertia_kg_m2: f64,
    /// The largest dry friction that leaves the servo enough for the recorded motion, N m.
    pub dry_nm: f64,
    /// The same for viscous friction, N m s/rad.
    pub viscous_nm_s_rad: f64,
}

impl Effort {
    /// The scales of every joint of a robot, in the order of its hinges. Where no recorded command says what a servo exerts, friction
    /// has no scale and is 0.
    pub fn of_joints(robot: &Assembly, recordings: &[Recording]) -> Vec<Self> {
        let carried = robot.dynamics(&vec![0.0; robot.hinges.len()]).mass_matrix;
        let joints = robot.hinges.iter().enumerate();
        joints
            .map(|(index, hinge)| {
                let mut sums = Sums::default();
                for recording in recordings {
                    sums.add(hinge, &recording.trajectory);
                }
                let torque_nm = LOST * sums.torque_nm();
                let speed_rad_s = sums.speed_rad_s();
                Self {
                    // Every joint feels its own rotor already.
                    inertia_kg_m2: carried[index][index] - hinge.bearing.armature_kg_m2,
                    dry_nm: torque_nm,
                    viscous_nm_s_rad: match speed_rad_s > SLOWEST_RAD_S {
                        true => torque_nm / speed_rad_s,
                        false => 0.0,
                    },
                }
            })
            .collect()
    }
}

/// Sums of squares over the recorded samples of a joint.
#[derive(Default)]
struct Sums {
    torque_nm2: f64,
    speed_rad2_s2: f64,
    count: usize,
}

impl Sums {
    fn torque_nm(&self) -> f64 {
        (self.torque_nm2 / self.count.max(1) as f64).sqrt()
    }

    fn speed_rad_s(&self) -> f64 {
        (self.speed_rad2_s2 / self.count.max(1) as f64).sqrt()
    }

    /// Adds the samples of a recording whose commands say what the servo exerts: torques, or angles with the gains of a servo.
    fn add(&mut self, hinge: &Hinge, motion: &Trajectory) {
        let Some(actuator) = hinge.actuator else {
            return;
        };
        let Some(joint) = motion.joint(&hinge.name) else {
            return;
        };
        let Some(command) = RecordedCommand::all_of(std::slice::from_ref(hinge), motion).pop()
        else {
            return;
        };
        // The gains with which angles become torques; torques are commanded as they are.
        let gains = match (command.quantity, actuator.servo.law) {
            (
                Quantity::Position,
                ServoLaw::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                },
            ) => Some((stiffness_nm_rad, damping_nm_s_rad)),
            (Quantity::Torque, _) => None,
            _ => return,
        };
        let values = match motion.joint(&command.column) {
            Some(angles) => &angles.angles_rad,
            None => match motion.signal(&command.column) {
                Some(signal) => &signal.values,
                None => return,
            },
        };
        let (times_s, angles_rad) = (motion.times_s(), &joint.angles_rad);
        let mut before = 0;
        for now in 1..times_s.len() {
            while times_s[now] - times_s[before + 1] >= LAG_S {
                before += 1;
            }
            let speed_rad_s =
                (angles_rad[now] - angles_rad[before]) / (times_s[now] - times_s[before]);
            // Commands are held until the next sample.
            let command = values[now - 1];
            let asked_nm = match gains {
                None => command,
                Some((stiffness_nm_rad, damping_nm_s_rad)) => {
                    let goal_rad = actuator.command.apply(command);
                    stiffness_nm_rad * (goal_rad - angles_rad[now]) - damping_nm_s_rad * speed_rad_s
                }
            };
            let limit = actuator.servo.max_torque_nm;
            self.torque_nm2 += asked_nm.clamp(-limit, limit).powi(2);
            self.speed_rad2_s2 += speed_rad_s.powi(2);
            self.count += 1;
        }
    }
}
