//! Threshold rules: a condition on a sensor or message, and servo actions for a time.

use super::{Controller, Heard, Reads, Sensed, Steer};
use realgap_sensing::range::{Beam, RangeSensor as _, ReadingUnit};

/// The condition of a rule.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// A sensor measures a distance below this, metres.
    Below {
        /// Index of the sensor.
        sensor: usize,
        /// Distance, metres.
        distance_m: f64,
    },
    /// A sensor measures a distance above this, metres.
    Above {
        /// Index of the sensor.
        sensor: usize,
        /// Distance, metres.
        distance_m: f64,
    },
    /// A sensor returns no reading.
    Silent {
        /// Index of the sensor.
        sensor: usize,
    },
    /// The position in another robot's last message is nearer than this, metres; any robot's if none is named.
    Heard {
        /// Index of the robot.
        from: Option<usize>,
        /// Distance between this robot and the position in the message, metres.
        within_m: f64,
    },
    /// Always true: for a default rule.
    Always,
}

/// One rule.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Condition of the rule.
    pub when: Condition,
    /// Time for which the rule is followed once its condition holds, seconds; 0 means until the next decision.
    pub for_s: f64,
    /// Servo actions, by the name of the hinge; servos that are not named continue with their own commands.
    pub then: Vec<(String, Steer)>,
}

/// Whether a reading means a distance below `distance_m`. The readings of a sensor may rise or fall with the distance, so the
/// reading is compared with the mean readings at this distance and at a smaller one.
fn is_nearer(reads: &Reads, reading: f64, distance_m: f64) -> bool {
    let Reads::Range(sensor) = reads else {
        return reading < distance_m;
    };
    if let ReadingUnit::Length(unit) = sensor.reading_unit {
        return reading * unit.metres() < distance_m;
    }
    let at = |distance_m: f64| sensor.mean(&Beam::straight(distance_m));
    let (edge, nearer) = (at(distance_m), at(0.9 * distance_m));
    if nearer > edge {
        reading > edge
    } else {
        reading < edge
    }
}

impl Condition {
    fn holds(&self, controller: &Controller, sensed: &Sensed) -> bool {
        let of = |sensor: usize| sensed.readings[sensor];
        let nearer = |sensor: usize, distance_m: f64| {
            let reads = &controller.sensors[sensor].reads;
            of(sensor).map(|reading| is_nearer(reads, reading, distance_m))
        };
        match self {
            Self::Below { sensor, distance_m } => nearer(*sensor, *distance_m) == Some(true),
            Self::Above { sensor, distance_m } => nearer(*sensor, *distance_m) == Some(false),
            Self::Silent { sensor } => of(*sensor).is_none(),
            Self::Heard { from, within_m } => {
                let is_near = |heard: &Heard| {
                    let offset_m = [0, 1, 2].map(|k| heard.position_m[k] - sensed.position_m[k]);
                    offset_m[0].hypot(offset_m[1]).hypot(offset_m[2]) < *within_m
                };
                let mut heard = sensed.heard.iter();
                heard.any(|heard| from.is_none_or(|from| from == heard.from) && is_near(heard))
            }
            Self::Always => true,
        }
    }
}

/// The rule that one robot follows, and the time until which it follows it.
#[derive(Debug, Clone, Default)]
pub(super) struct RuleSelector {
    followed: Option<(usize, f64)>,
}

impl RuleSelector {
    /// Selects the rule to follow from now on; a rule whose time is not over is kept.
    pub fn decide(&mut self, controller: &Controller, sensed: &Sensed) -> Option<usize> {
        if let Some((rule, until_s)) = self.followed
            && sensed.time_s < until_s - 1e-9
        {
            return Some(rule);
        }
        let mut rules = controller.rules.iter();
        let found = rules.position(|rule| rule.when.holds(controller, sensed));
        self.followed = found.map(|rule| (rule, sensed.time_s + controller.rules[rule].for_s));
        found
    }
}
