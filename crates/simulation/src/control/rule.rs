//! Threshold rules: when something is near, another gait for a while.

use super::{Controller, Heard, Reads, Sensed, Steer};
use realgap_sensing::range::{Beam, RangeSensor as _, ReadingUnit};

/// What has to hold for a rule.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// A sensor reads a distance nearer than this, metres.
    Below {
        /// Index of the sensor.
        sensor: usize,
        /// Distance, metres.
        distance_m: f64,
    },
    /// A sensor reads a distance farther than this, metres.
    Above {
        /// Index of the sensor.
        sensor: usize,
        /// Distance, metres.
        distance_m: f64,
    },
    /// No reading came of this sensor.
    Silent {
        /// Index of the sensor.
        sensor: usize,
    },
    /// Another robot said that it is nearer than this, metres; any robot where none is named.
    Heard {
        /// Number of the robot.
        from: Option<usize>,
        /// Distance from here to where it was when it sent, metres.
        within_m: f64,
    },
    /// Always: what is done where nothing else is.
    Always,
}

/// One rule.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// When.
    pub when: Condition,
    /// For how long it is followed once it holds, seconds; 0 until the next decision.
    pub for_s: f64,
    /// What servos do then, by the name of their hinge; those that are not named go on by themselves.
    pub then: Vec<(String, Steer)>,
}

/// What a sensor would read at a distance is above its threshold, or below it where readings fall with the distance.
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
                    let apart = [0, 1, 2].map(|k| heard.position_m[k] - sensed.position_m[k]);
                    apart[0].hypot(apart[1]).hypot(apart[2]) < *within_m
                };
                let mut heard = sensed.heard.iter();
                heard.any(|heard| from.is_none_or(|from| from == heard.from) && is_near(heard))
            }
            Self::Always => true,
        }
    }
}

/// Which rule one robot follows, and until when.
#[derive(Debug, Clone, Default)]
pub(super) struct Mind {
    followed: Option<(usize, f64)>,
}

impl Mind {
    /// The rule that is followed from now on; one that has its time is kept until that is over.
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
