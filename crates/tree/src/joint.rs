//! Forces along a joint: motor or servo, limits, dry and viscous friction, spring.
//!
//! Servos, dampers and springs are treated implicitly, as part of the articulated inertia, so that contacts include their
//! stiffness immediately. A servo at its torque limit becomes a constraint row, as limits and dry friction are (Todorov 2011,
//! 2014).

use crate::contact::Softness;
use crate::forest::{Body, Freedom};
use crate::kinematics::Node;
use crate::spatial::Spatial;

/// A servo that was at its limit is treated implicitly again when its torque falls below this fraction of the limit.
const NEAR: f64 = 0.9;

/// A joint that moves into its limit more slowly than this counts as resting on it, rad/s or m/s.
const RESTING_SPEED: f64 = 0.05;

/// Command of a joint's motor, valid until the next command.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Command {
    /// No torque.
    #[default]
    Off,
    /// Torque = gain · (target − speed), limited to `max_torque`.
    Velocity {
        /// Target speed, rad/s or m/s.
        target: f64,
        /// Torque per speed, N m s/rad or N s/m.
        gain: f64,
        /// Limit of the torque, N m or N.
        max_torque: f64,
    },
    /// Torque = stiffness · (target − position) − damping · speed, limited to `max_torque`.
    Servo {
        /// Target position, rad or m.
        target: f64,
        /// Stiffness, N m/rad or N/m.
        stiffness: f64,
        /// Torque per speed, N m s/rad or N s/m.
        damping: f64,
        /// Limit of the torque, N m or N.
        max_torque: f64,
    },
    /// A constant torque, N m or N.
    Torque(f64),
}

/// Impulses along a joint during a step. They act on the child, and with the opposite sign on the parent, N m s or N s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointImpulse {
    /// Impulse of the motor.
    pub motor: f64,
    /// Impulse of a limit.
    pub limit: f64,
    /// Impulse of dry friction.
    pub dry_friction: f64,
    /// Impulse of viscous friction.
    pub viscous_friction: f64,
    /// Impulse of the spring.
    pub spring: f64,
}

/// Motor, friction, limits and spring of one joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointForces {
    pub command: Command,
    pub viscous: f64,
    pub dry: f64,
    pub armature: f64,
    /// Impulses since the beginning of the step.
    pub done: JointImpulse,
    /// Servo: impulse = push − grip · speed, at most `most`. If `folded` is true, the servo is part of the inertia (implicit),
    /// otherwise it is a row.
    push: f64,
    grip: f64,
    most: f64,
    folded: bool,
    motor: f64,
    saturated: bool,
    /// Dry friction: at most this impulse.
    dry_most: f64,
    dry_now: f64,
    /// Limit within reach: +1 for the lower one, −1 for the upper one, 0 for none.
    side: f64,
    wanted: f64,
    slack: f64,
    limit_now: f64,
    spring_push: f64,
}

impl JointForces {
    pub fn new(body: &Body) -> Self {
        Self {
            viscous: body.viscous,
            dry: body.dry,
            armature: body.armature,
            ..Self::default()
        }
    }

    /// Discards the stored impulses of the previous step.
    pub fn forget(&mut self) {
        (self.motor, self.dry_now, self.limit_now) = (0.0, 0.0, 0.0);
        self.saturated = false;
    }

    /// Evaluates command and position before a step; returns the implicit inertia of the joint, including the rotor. `ratio`:
    /// length of the step relative to that of the previous step.
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
        self.push += time_s * stiffness * (target - spring_position(node, time_s));
        self.grip = time_s * (0.25 * time_s * stiffness + damping);
        self.folded = !self.saturated || self.grip == 0.0;
        self.spring_push = time_s * body.stiffness * (body.rest - spring_position(node, time_s));
        self.dry_most = self.dry * time_s;
        self.armature + self.passive(body, time_s) + if self.folded { self.grip } else { 0.0 }
    }

    fn passive(&self, body: &Body, time_s: f64) -> f64 {
        time_s * (self.viscous + 0.25 * time_s * body.stiffness)
    }

    /// The generalised impulse of all terms without a row, plus the impulses of the rows in the previous step.
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
        // A joint that hits its limit meets a rigid stop; a joint that rests on it meets a compliant one.
        let rests = distance <= 0.0 && -side * node.speed < RESTING_SPEED;
        self.slack = if rests {
            softness.slack * node.give
        } else {
            0.0
        };
    }

    /// Whether any row may act.
    pub fn has_rows(&self) -> bool {
        !self.folded || self.dry_most > 0.0 || self.side != 0.0
    }

    /// Solves all rows of the joint once within a sweep, at this speed of the joint; returns the generalised impulse to add.
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

    /// Solves the row of a servo near its limit.
    fn solve_motor(&mut self, speed: f64, give: f64) -> f64 {
        let law = self.push - self.grip * speed;
        let now = self.motor + (law - self.motor) / (1.0 + self.grip * give);
        let now = now.clamp(-self.most, self.most);
        let more = now - self.motor;
        self.motor = now;
        more
    }

    /// Whether an implicit servo exceeded its torque limit; if so, it is treated as a row from now on.
    pub fn exceeds(&mut self, speed: f64) -> bool {
        let exceeds = self.folded
            && self.grip > 0.0
            && (self.push - self.grip * speed).abs() > self.most * (1.0 + 1e-9);
        self.saturated |= exceeds;
        exceeds
    }

    /// Treats the servo as a row, whatever its torque.
    pub(crate) fn unfold(&mut self) {
        self.saturated = true;
    }

    /// After the last sweep: records the impulses at the resulting speed.
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

/// The position at which the force of a spring is taken in a step, without the term of a quarter of the coming speed. The full
/// position is a mean of those before and after the step, with which a spring neither gains nor loses energy, however stiff it is
/// (Newmark 1959, average acceleration).
fn spring_position(node: &Node, time_s: f64) -> f64 {
    node.position - 0.25 * time_s * node.speed
}

/// The speed of a joint, from the velocities of child and parent, which must be consistent with each other.
#[inline]
pub(crate) fn speed_between(node: &Node, parent: &Spatial) -> f64 {
    node.reader.dot(&(node.velocity - *parent))
}

/// Distance from a limit at which its row becomes active: the travel of the joint in a step, and a margin.
pub(crate) fn limit_reach(body: &Body, node: &Node, time_s: f64) -> f64 {
    let near = if body.freedom == Freedom::Turning {
        0.02
    } else {
        0.002
    };
    near + 2.0 * time_s * node.speed.abs()
}
