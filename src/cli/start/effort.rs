//! What moves a recorded joint, and what it moves: scales of the ranges in which its inertia and friction are searched.

use realgap::calibration::RecordedCommand;
use realgap::robot::morphology::{Assembly, CommandScale, Hinge, ServoLaw};
use realgap::simulation::Quantity;
use realgap::trajectory::{Recording, Trajectory};

use super::proposal::{ARMATURE_S2, DRIVE, FRICTION};

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

/// What drives a joint, in any engine.
pub(super) struct Driven<'a> {
    /// The joint, by the name of its column.
    pub joint: &'a str,
    /// What its column of commands may be called after: the joint, and where engines name actuators, the actuator.
    pub names: Vec<&'a str>,
    /// Gains with which commanded angles become torques, N m/rad and N m s/rad; torques are commanded as they are.
    pub gains: Option<(f64, f64)>,
    /// The largest torque, N m; infinite where nothing states it.
    pub limit_nm: f64,
    /// How a recorded command becomes one of the joint.
    pub command: CommandScale,
}

impl<'a> Driven<'a> {
    /// The servo of a hinge.
    pub fn of(hinge: &'a Hinge) -> Option<Self> {
        let actuator = hinge.actuator.as_ref()?;
        let gains = match actuator.servo.law {
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => Some((stiffness_nm_rad, damping_nm_s_rad)),
            _ => None,
        };
        Some(Self {
            joint: &hinge.name,
            names: vec![&hinge.name],
            gains,
            limit_nm: actuator.servo.max_torque_nm,
            command: actuator.command,
        })
    }
}

/// What bounds the ranges of a joint, beside its own values.
pub(super) struct Scales {
    effort: Effort,
    /// The largest torque that its drive needs, N m; of a joint without a drive that which gravity may have about it.
    torque_nm: f64,
}

impl Scales {
    /// The limit of a drive may be far above what gravity needs, where a file states no limit.
    pub fn new(effort: Effort, limit_nm: Option<f64>, gravity_nm: f64) -> Self {
        let torque_nm = match limit_nm {
            Some(limit_nm) => limit_nm.min(DRIVE * gravity_nm),
            None => gravity_nm,
        };
        Self { effort, torque_nm }
    }

    /// The largest armature that is searched beside the joint's own, kg m².
    pub fn most_armature(&self, own: f64) -> f64 {
        let felt = (ARMATURE_S2 * self.torque_nm).max(self.effort.inertia_kg_m2);
        (20.0 * own).max(felt)
    }

    /// The largest viscous friction, N m s/rad.
    pub fn most_viscous(&self, own: f64) -> f64 {
        let lost = (FRICTION * self.torque_nm).max(self.effort.viscous_nm_s_rad);
        (5.0 * own).max(lost)
    }

    /// The largest dry friction, N m.
    pub fn most_dry(&self, own: f64) -> f64 {
        (5.0 * own).max((FRICTION * self.torque_nm).max(self.effort.dry_nm))
    }
}

impl Effort {
    /// The scales of every joint of a robot, in the order of its hinges.
    pub fn of_joints(robot: &Assembly, recordings: &[Recording]) -> Vec<Self> {
        let carried = robot.dynamics(&vec![0.0; robot.hinges.len()]).mass_matrix;
        let joints = robot.hinges.iter().enumerate();
        joints
            .map(|(index, hinge)| {
                // Every joint feels its own rotor already.
                let inertia_kg_m2 = carried[index][index] - hinge.bearing.armature_kg_m2;
                Self::of(inertia_kg_m2, Driven::of(hinge).as_ref(), recordings)
            })
            .collect()
    }

    /// The scales of a joint that carries this inertia. Where no recorded command says what its drive exerts, friction has no scale
    /// and is 0.
    pub fn of(inertia_kg_m2: f64, driven: Option<&Driven<'_>>, recordings: &[Recording]) -> Self {
        let mut sums = Sums::default();
        if let Some(driven) = driven {
            let motions = recordings.iter().map(|recording| &recording.trajectory);
            motions.for_each(|motion| sums.add(driven, motion));
        }
        let torque_nm = LOST * sums.torque_nm();
        let speed_rad_s = sums.speed_rad_s();
        Self {
            inertia_kg_m2,
            dry_nm: torque_nm,
            viscous_nm_s_rad: match speed_rad_s > SLOWEST_RAD_S {
                true => torque_nm / speed_rad_s,
                false => 0.0,
            },
        }
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

    /// Adds the samples of a recording whose commands say what the drive exerts: torques, or angles with gains.
    fn add(&mut self, driven: &Driven<'_>, motion: &Trajectory) {
        let Some(joint) = motion.joint(driven.joint) else {
            return;
        };
        let mut names = driven.names.iter();
        let command = names.find_map(|name| RecordedCommand::of(name, motion));
        let Some((command, values)) =
            command.and_then(|c| c.values(motion).map(|values| (c.quantity, values)))
        else {
            return;
        };
        let gains = match (command, driven.gains) {
            (Quantity::Position, Some(gains)) => Some(gains),
            (Quantity::Torque, _) => None,
            _ => return,
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
                    let goal_rad = driven.command.apply(command);
                    stiffness_nm_rad * (goal_rad - angles_rad[now]) - damping_nm_s_rad * speed_rad_s
                }
            };
            let limit_nm = driven.limit_nm;
            self.torque_nm2 += asked_nm.clamp(-limit_nm, limit_nm).powi(2);
            self.speed_rad2_s2 += speed_rad_s.powi(2);
            self.count += 1;
        }
    }
}
