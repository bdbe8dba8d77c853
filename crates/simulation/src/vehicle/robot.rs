//! One two-wheel robot in epochs: it drives straight, reads its sensor, and turns away from obstacles.

use rand::RngExt as _;
use rand_distr::StandardNormal;

use super::Vehicle;
use super::drive::{Drive, EPOCH_S};
use super::sense::VehicleSensor;
use realgap_core::random::Generator;
use realgap_sensing::arena::{Arena, Object, Shape};

/// State of the robot's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum MotionState {
    /// Driving straight ahead.
    Forward,
    /// The robot has decided to turn, but still drives straight until a time.
    Reacting { until_s: f64 },
    /// Coasting by the remaining distance after a straight command.
    Coasting { left_m: f64 },
    /// Turning right by the remaining angle.
    Turning { left_rad: f64 },
}

/// Pose of the robot in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub place_m: [f64; 2],
    pub heading_rad: f64,
}

impl Pose {
    pub fn at(&self, ahead_m: f64, left_m: f64) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        [
            self.place_m[0] + ahead_m * cos - left_m * sin,
            self.place_m[1] + ahead_m * sin + left_m * cos,
        ]
    }
}

/// Random errors of the actuators; zero in a run without noise.
pub(super) struct ActuatorNoise {
    pub rng: Option<Generator>,
    pub factor: f64,
}

impl ActuatorNoise {
    fn normal(&mut self, sd: f64) -> f64 {
        let factor = self.factor;
        self.rng.as_mut().map_or(0.0, |rng| {
            factor * sd * rng.sample::<f64, _>(StandardNormal)
        })
    }

    /// A random error that the factor for actuators does not scale.
    pub(crate) fn normal_of(&mut self, sd: f64) -> f64 {
        self.rng
            .as_mut()
            .map_or(0.0, |rng| sd * rng.sample::<f64, _>(StandardNormal))
    }

    /// Whether an event with this probability happens in this run; without noise, whether the probability is above one half.
    pub fn happens(&mut self, share: f64) -> bool {
        let chance = self.rng.as_mut().map_or(0.5, |rng| rng.random::<f64>());
        chance < share
    }

    /// The coasting state after a straight command.
    fn coast(&mut self, drive: &Drive) -> MotionState {
        MotionState::Coasting {
            left_m: (drive.coast_m + self.normal(drive.coast_sd_m)).max(0.0),
        }
    }
}

/// One robot of the run: its pose, its state of motion, and its path.
pub(super) struct Robot<'a> {
    pose: Pose,
    state: MotionState,
    noise: ActuatorNoise,
    sensor: VehicleSensor<'a>,
    /// The arena with the other robots added as circles, which are its last objects; `None` if there are no other robots.
    arena_with_others: Option<Arena>,
    /// Poses at every epoch.
    pub path: Vec<Pose>,
}

impl<'a> Robot<'a> {
    /// A robot that begins its first straight command.
    pub fn new(
        vehicle: &Vehicle,
        drive: &Drive,
        start: Pose,
        mut noise: ActuatorNoise,
        sensor: VehicleSensor<'a>,
    ) -> Self {
        let mut pose = start;
        pose.heading_rad += drive.drift_offset_rad + noise.normal(drive.drift_sd_rad);
        let arena_with_others = (!vehicle.others.is_empty()).then(|| {
            let mut arena = (*vehicle.arena).clone();
            arena.objects.extend(vehicle.others.iter().map(|_| Object {
                centre_m: [0.0; 2],
                shape: Shape::Circle {
                    radius_m: vehicle.radius_m,
                },
                material: String::new(),
            }));
            arena
        });
        Self {
            pose,
            state: MotionState::Forward,
            noise,
            sensor,
            arena_with_others,
            path: vec![start],
        }
    }

    /// Position of the robot, metres.
    pub fn place_m(&self) -> [f64; 2] {
        self.pose.place_m
    }

    /// Simulates one epoch; `others_m` are the positions of the other robots.
    pub fn step(&mut self, vehicle: &Vehicle, drive: &Drive, time_s: f64, others_m: &[[f64; 2]]) {
        if let Some(arena_with_others) = &mut self.arena_with_others {
            let walls = arena_with_others.objects.len() - others_m.len();
            for (disc, place_m) in arena_with_others.objects[walls..].iter_mut().zip(others_m) {
                disc.centre_m = *place_m;
            }
        }
        let arena = self.arena_with_others.as_ref().unwrap_or(&vehicle.arena);
        let mut pose = self.pose;
        let mut ahead_m = drive.speed_m_s * EPOCH_S;
        match self.state {
            MotionState::Forward => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if self
                    .sensor
                    .is_near(arena, time_s, pose.place_m, pose.heading_rad)
                    == Some(true)
                {
                    self.state = if drive.reaction_s > 0.0 {
                        MotionState::Reacting {
                            until_s: time_s + drive.reaction_s,
                        }
                    } else {
                        self.noise.coast(drive)
                    };
                }
            }
            MotionState::Reacting { until_s } => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if time_s >= until_s - 1e-9 {
                    self.state = self.noise.coast(drive);
                }
            }
            MotionState::Coasting { left_m } => {
                ahead_m = ahead_m.min(left_m);
                self.state = if left_m > ahead_m {
                    MotionState::Coasting {
                        left_m: left_m - ahead_m,
                    }
                } else {
                    let turn_rad =
                        drive.turn_rate_rad_s * drive.turn_command_s + drive.turn_coast_rad;
                    MotionState::Turning {
                        left_rad: (turn_rad + self.noise.normal(drive.turn_sd_rad)).max(0.0),
                    }
                };
            }
            MotionState::Turning { left_rad } => {
                ahead_m = 0.0;
                let step_rad = (drive.turn_rate_rad_s * EPOCH_S).min(left_rad);
                pose.heading_rad -= step_rad;
                self.state = if left_rad > step_rad {
                    MotionState::Turning {
                        left_rad: left_rad - step_rad,
                    }
                } else {
                    self.sensor.forget();
                    pose.heading_rad +=
                        drive.drift_offset_rad + self.noise.normal(drive.drift_sd_rad);
                    MotionState::Forward
                };
            }
        }
        let next = Pose {
            place_m: pose.at(ahead_m, 0.0),
            ..pose
        };
        // The robot pushes nothing: if it would run into a wall or another robot, its wheels slip.
        let nears = |other: &[f64; 2]| {
            let off_m = |at: [f64; 2]| (at[0] - other[0]).hypot(at[1] - other[1]);
            let next_m = off_m(next.place_m);
            next_m < 2.0 * vehicle.radius_m && next_m < off_m(pose.place_m)
        };
        let is_free = vehicle.arena.clearance_m(next.place_m) >= 0.0 && !others_m.iter().any(nears);
        if ahead_m > 0.0 && is_free {
            pose = next;
        }
        self.pose = pose;
        self.path.push(pose);
    }
}
