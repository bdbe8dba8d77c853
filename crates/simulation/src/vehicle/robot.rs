//! One robot, epoch by epoch: drive, look, turn.

use rand::RngExt as _;
use rand_distr::StandardNormal;

use super::Vehicle;
use super::drive::{Drive, EPOCH_S};
use super::sense::Eye;
use realgap_core::random::Generator;
use realgap_sensing::arena::{Arena, Object, Shape};

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Doing {
    /// Straight ahead.
    Forward,
    /// Decided, but still going straight until a time.
    Reacting { until_s: f64 },
    /// On by so much after a straight command.
    Coasting { left_m: f64 },
    /// Turning right by so much more.
    Turning { left_rad: f64 },
}

/// Where it is.
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

/// Draws of the actuators; zeros where nothing is random.
pub(super) struct Dice {
    pub rng: Option<Generator>,
    pub factor: f64,
}

impl Dice {
    fn normal(&mut self, sd: f64) -> f64 {
        let factor = self.factor;
        self.rng.as_mut().map_or(0.0, |rng| {
            factor * sd * rng.sample::<f64, _>(StandardNormal)
        })
    }

    /// As [`Dice::normal`], of something that is no actuator.
    pub fn normal_of(&mut self, sd: f64) -> f64 {
        self.rng
            .as_mut()
            .map_or(0.0, |rng| sd * rng.sample::<f64, _>(StandardNormal))
    }

    /// Whether something happens in this run that happens in such a share of them; without draws, what most of them do.
    pub fn happens(&mut self, share: f64) -> bool {
        let chance = self.rng.as_mut().map_or(0.5, |rng| rng.random::<f64>());
        chance < share
    }

    /// What follows a straight command.
    fn coast(&mut self, drive: &Drive) -> Doing {
        Doing::Coasting {
            left_m: (drive.coast_m + self.normal(drive.coast_sd_m)).max(0.0),
        }
    }
}

/// A robot among others: where it is, what it does, and everywhere that it has been.
pub(super) struct Robot<'a> {
    pose: Pose,
    doing: Doing,
    dice: Dice,
    eye: Eye<'a>,
    /// The arena with the other robots in it as circles, the last objects; none where it is alone.
    crowd: Option<Arena>,
    /// Poses at every epoch.
    pub path: Vec<Pose>,
}

impl<'a> Robot<'a> {
    /// A robot that begins its first straight command.
    pub fn new(
        vehicle: &Vehicle,
        drive: &Drive,
        start: Pose,
        mut dice: Dice,
        eye: Eye<'a>,
    ) -> Self {
        let mut pose = start;
        pose.heading_rad += drive.drift_offset_rad + dice.normal(drive.drift_sd_rad);
        let crowd = (!vehicle.others.is_empty()).then(|| {
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
            doing: Doing::Forward,
            dice,
            eye,
            crowd,
            path: vec![start],
        }
    }

    /// Where it is, metres.
    pub fn place_m(&self) -> [f64; 2] {
        self.pose.place_m
    }

    /// One epoch; `others_m` is where the other robots are.
    pub fn step(&mut self, vehicle: &Vehicle, drive: &Drive, time_s: f64, others_m: &[[f64; 2]]) {
        if let Some(crowd) = &mut self.crowd {
            let walls = crowd.objects.len() - others_m.len();
            for (disc, place_m) in crowd.objects[walls..].iter_mut().zip(others_m) {
                disc.centre_m = *place_m;
            }
        }
        let arena = self.crowd.as_ref().unwrap_or(&vehicle.arena);
        let mut pose = self.pose;
        let mut ahead_m = drive.speed_m_s * EPOCH_S;
        match self.doing {
            Doing::Forward => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if self
                    .eye
                    .is_near(arena, time_s, pose.place_m, pose.heading_rad)
                    == Some(true)
                {
                    self.doing = if drive.reaction_s > 0.0 {
                        Doing::Reacting {
                            until_s: time_s + drive.reaction_s,
                        }
                    } else {
                        self.dice.coast(drive)
                    };
                }
            }
            Doing::Reacting { until_s } => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if time_s >= until_s - 1e-9 {
                    self.doing = self.dice.coast(drive);
                }
            }
            Doing::Coasting { left_m } => {
                ahead_m = ahead_m.min(left_m);
                self.doing = if left_m > ahead_m {
                    Doing::Coasting {
                        left_m: left_m - ahead_m,
                    }
                } else {
                    let turn_rad =
                        drive.turn_rate_rad_s * drive.turn_command_s + drive.turn_coast_rad;
                    Doing::Turning {
                        left_rad: (turn_rad + self.dice.normal(drive.turn_sd_rad)).max(0.0),
                    }
                };
            }
            Doing::Turning { left_rad } => {
                ahead_m = 0.0;
                let step_rad = (drive.turn_rate_rad_s * EPOCH_S).min(left_rad);
                pose.heading_rad -= step_rad;
                self.doing = if left_rad > step_rad {
                    Doing::Turning {
                        left_rad: left_rad - step_rad,
                    }
                } else {
                    self.eye.forget();
                    pose.heading_rad +=
                        drive.drift_offset_rad + self.dice.normal(drive.drift_sd_rad);
                    Doing::Forward
                };
            }
        }
        let next = Pose {
            place_m: pose.at(ahead_m, 0.0),
            ..pose
        };
        // It pushes nothing: where it would run into a wall or a robot, its wheels slip.
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
