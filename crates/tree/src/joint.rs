//! What acts along a joint: motor or servo, limits, dry and viscous friction, spring.
//!
//! Servos, dampers and springs resist implicitly, as part of the articulated inertia, so that contacts feel at once what stands
//! behind a joint. A servo at its torque limit becomes a row of its own, as limits and dry friction are (Todorov 2011, 2014).

use crate::contact::Softness;
use crate::forest::{Body, Freedom};
use crate::kinematics::Node;
use crate::spatial::Spatial;

/// Share of its limit below which a servo that has been there is part of the inertia again.
const NEAR: f64 = 0.9;

/// A joint that moves slower than this into its limit leans on it, rad/s or m/s.
const LEANING: f64 = 0.05;

/// What a joint's motor is asked to do from now on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Command {
    /// Nothing.
    #[default]
    Off,
    /// Torque = gain · (target − speed), within its limit.
    Velocity {
        /// Speed, rad/s or m/s.
        target: f64,
        /// N m s/rad or N s/m.
        gain: f64,
        /// Limit, N m or N.
        max_torque: f64,
    },
    /// Torque = stiffness · (target − position) − damping · speed, within its limit.
    Servo {
        /// Position, rad or m.
        target: f64,
        /// N m/rad or N/m.
        stiffness: f64,
        /// N m s/rad or N s/m.
        damping: f64,
        /// Limit, N m or N.
        max_torque: f64,
    },
    /// This torque, N m or N.
    Torque(f64),
}

/// What acted along a joint during a step: impulses on the child, against them on the parent, N m s or N s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointImpulse {
    /// By the motor.
    pub motor: f64,
    /// By a limit.
    pub limit: f64,
    /// By dry friction.
    pub dry_friction: f64,
    /// By viscous friction.
    pub viscous_friction: f64,
    /// By the spring.
    pub spring: f64,
}

/// The actors along one joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Actor {
    pub command: Command,
    pub viscous: f64,
    pub dry: f64,
    pub armature: f64,
    /// What was done since the step began.
    pub done: JointImpulse,
    /// Servo: impulse = push − grip · speed, at most `most`. Folded: part of the inertia, else a row.
    push: f64,
    grip: f64,
    most: f64,
    folded: bool,
    motor: f64,
    saturated: bool,
    /// Dry friction: at most this impulse.
    dry_most: f64,
    dry_now: f64,
    /// Limit: +1 the lower one, −1 the upper one, 0 out of reach.
    side: f64,
    wanted: f64,
    slack: f64,
    limit_now: f64,
    spring_push: f64,
}

impl Actor {
    pub fn new(body: &Body) -> Self {
        Self {
            viscous: body.viscous,
            dry: body.dry,
            armature: body.armature,
            ..Self::default()
        }
    }

    /// Nothing has happened yet.
    pub fn forget(&mut self) {
        (self.motor, self.dry_now, self.limit_now) = (0.0, 0.0, 0.0);
        self.saturated = false;
    }

    /// Reads command and position before a step; returns what resists implicitly, rotor included.
    /// `ratio`: how long the step is, compared to the one before.
    pub fn prepare(&mut self, body: &Body, node: &Node, time_s: f64, ratio: f64) -> f64 {
        self.motor *= ratio;
        self.dry_now *= ratio;
        self.limit_now *= ratio;
        let (mut stiffness, mut damping, mut target) = (0.0, 0.0, 0.0);
        self.push = 0.0;
        let most = match self.command {
            Command::Off => 0.0,
            Command::Torque(torque) => {
                self.push = torque * time_s;
                f64::INFINITY
            }
            Command::Velocity {
                target: speed,
                gain,
                max_torque,
            } => {
                damping = gain;
                self.push = time_s * gain * speed;
                max_torque
            }
            Command::Servo {
                target: position,
                stiffness: k,
                damping: d,
                max_torque,
            } => {
                (stiffness, damping, target) = (k, d, position);
                max_torque
            }
        };
        self.most = most * time_s;
        self.push += time_s * stiffness * (target - felt(node, time_s));
        self.grip = time_s * (0.25 * time_s * stiffness + damping);
        self.folded = !self.saturated || self.grip == 0.0;
        self.spring_push = time_s * body.stiffness * (body.rest - felt(node, time_s));
        self.dry_most = self.dry * time_s;
        self.armature + self.passive(body, time_s) + if self.folded { self.grip } else { 0.0 }
    }

    fn passive(&self, body: &Body, time_s: f64) -> f64 {
        time_s * (self.viscous + 0.25 * time_s * body.stiffness)
    }

    /// The generalised impulse of all that needs no row, and of rows as they were in the step before.
    pub fn effort(&mut self, body: &Body, node: &Node, time_s: f64) -> f64 {
        self.dry_now = self.dry_now.clamp(-self.dry_most, self.dry_most);
        let passive = self.spring_push - self.passive(body, time_s) * node.speed;
        let motor = if self.folded {
            self.push - self.grip * node.speed
        } else {
            self.motor = self.motor.clamp(-self.most, self.most);
            self.motor
        };
        passive + motor + self.dry_now + self.limit_now
    }

    /// Sets up the row of a limit that the joint may reach.
    pub fn approach(&mut self, body: &Body, node: &Node, softness: &Softness, reach: f64) {
        let Some((low, high)) = body.limits else {
            return;
        };
        let (above, below) = (node.position - low, high - node.position);
        let (side, distance) = if above <= below {
            (1.0, above)
        } else {
            (-1.0, below)
        };
        if distance > reach || side != self.side {
            self.limit_now = 0.0;
        }
        self.side = if distance > reach { 0.0 } else { side };
        self.wanted = softness.wanted_speed(distance);
        // Hitting it is hard, leaning on it soft.
        let leans = distance <= 0.0 && -side * node.speed < LEANING;
        self.slack = if leans {
            softness.slack * node.give
        } else {
            0.0
        };
    }

    /// Whether any row may act.
    pub fn has_rows(&self) -> bool {
        !self.folded || self.dry_most > 0.0 || self.side != 0.0
    }

    /// One visit of a sweep to all rows of the joint at this speed; returns the generalised impulse to add.
    pub fn solve(&mut self, speed: f64, give: f64) -> f64 {
        let mut more = 0.0;
        if !self.folded {
            more += self.solve_motor(speed, give);
        }
        if self.dry_most > 0.0 {
            let now = self.dry_now - (speed + give * more) / give;
            let now = now.clamp(-self.dry_most, self.dry_most);
            more += now - self.dry_now;
            self.dry_now = now;
        }
        if self.side != 0.0 {
            let speed = self.side * (speed + give * more);
            let before = self.side * self.limit_now;
            let residual = speed - self.wanted + self.slack * before;
            let now = (before - residual / (give + self.slack)).max(0.0);
            more += self.side * (now - before);
            self.limit_now = self.side * now;
        }
        more
    }

    /// A servo near its limit.
    fn solve_motor(&mut self, speed: f64, give: f64) -> f64 {
        let law = self.push - self.grip * speed;
        let now = self.motor + (law - self.motor) / (1.0 + self.grip * give);
        let now = now.clamp(-self.most, self.most);
        let more = now - self.motor;
        self.motor = now;
        more
    }

    /// Whether a servo that is part of the inertia gave more than it has; from now on it is a row.
    pub fn exceeds(&mut self, speed: f64) -> bool {
        let exceeds = self.folded
            && self.grip > 0.0
            && (self.push - self.grip * speed).abs() > self.most * (1.0 + 1e-9);
        self.saturated |= exceeds;
        exceeds
    }

    /// Makes a servo a row whatever it gives.
    pub fn unfold(&mut self) {
        self.saturated = true;
    }

    /// After the last sweep: notes what was done at the speed that came of it.
    pub fn finish(&mut self, body: &Body, speed: f64, time_s: f64) {
        if self.folded {
            self.motor = self.push - self.grip * speed;
        }
        self.saturated &= self.motor.abs() > NEAR * self.most;
        let done = &mut self.done;
        done.motor += self.motor;
        done.limit += self.limit_now;
        done.dry_friction += self.dry_now;
        done.viscous_friction -= time_s * self.viscous * speed;
        done.spring += self.spring_push - 0.25 * time_s * time_s * body.stiffness * speed;
    }
}

/// The position that a spring feels in a step, but for a quarter of the coming speed: a mean of those before, now and after, with
/// which it neither gains nor loses energy however stiff it is (Newmark 1959, average acceleration).
fn felt(node: &Node, time_s: f64) -> f64 {
    node.position - 0.25 * time_s * node.speed
}

/// The speed of a joint, between two velocities that know of each other.
#[inline]
pub(crate) fn speed_between(node: &Node, parent: &Spatial) -> f64 {
    node.reader.dot(&(node.velocity - *parent))
}

/// How far from a limit its row begins: what the joint may travel in a step, and a little.
pub(crate) fn limit_reach(body: &Body, node: &Node, time_s: f64) -> f64 {
    let near = if body.freedom == Freedom::Turning {
        0.02
    } else {
        0.002
    };
    near + 2.0 * time_s * node.speed.abs()
}
