//! The objective of a search: a measure of each repeat, and an aggregate of all repeats.

use serde::{Deserialize, Serialize};

use realgap_core::Result;
use realgap_core::range::Range;
use realgap_core::statistics::{mean, quantile, standard_deviation};
use realgap_core::unit::Unit;
use realgap_path::trajectory::Prepared;
use realgap_simulation::EnergyBalance;
pub use realgap_store::TravelRow as Travel;

realgap_core::labelled_enum! {
    /// What is measured in one repeat.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    Measure.label;
    /// Distance from start to end in the plane, metres: the papers' fitness.
    Displacement "displacement";
    /// Displacement per length of the path, 0 to 1; 0 for a robot that moves less than one body length.
    Straightness "straightness";
    /// Displacement per time, m/s.
    Speed "speed";
    /// Displacement per joule that the servos gave, m/J, because speed per power is distance per energy. Energy that the servos
    /// absorb counts as lost ([`realgap_simulation::EnergyBalance::servo_positive_j`]). 0 for a robot that moves less than one
    /// body length, because a robot that hardly moves hardly needs energy.
    SpeedPerEnergy "speed per energy";
}

/// How the measures of all repeats become one number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Aggregate {
    /// The mean of the repeats.
    Mean,
    /// A quantile, level from 0 to 1; low levels prefer robots that rarely fail.
    LowerQuantile(f64),
    /// The mean minus so many standard deviations.
    MeanMinusSd(f64),
}

/// The quantity that a search maximises.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Objective {
    /// The measure of each repeat.
    pub measure: Measure,
    /// The aggregate of the measures of all repeats.
    pub aggregate: Aggregate,
    /// Seconds at the beginning of each run that do not count: a robot that falls over does so at once, and its fall would count
    /// as displacement.
    pub from_s: f64,
    /// A run counts for at most so many times the displacement in the last quarter of the counted time, which is 4 for a steady
    /// walker. A robot that falls over and then lies still gets nothing. `None` counts the whole displacement.
    pub last_quarters: Option<f64>,
}

impl Default for Objective {
    /// Displacement, its 20 % quantile.
    fn default() -> Self {
        Self {
            measure: Measure::Displacement,
            aggregate: Aggregate::LowerQuantile(0.2),
            from_s: 0.0,
            last_quarters: None,
        }
    }
}

impl Measure {
    /// Its value for one repeat, in [`Measure::unit`].
    pub fn of(self, travel: &Travel, body_length_m: f64, duration_s: f64) -> f64 {
        match self {
            Self::Displacement => travel.displacement_m,
            Self::Straightness => travel.straightness(body_length_m),
            Self::Speed => travel.displacement_m / duration_s,
            Self::SpeedPerEnergy => travel.metres_per_joule(body_length_m),
        }
    }

    /// Its unit.
    pub fn unit(self) -> Unit {
        match self {
            Self::Displacement => Unit::Metre,
            Self::Straightness => Unit::One,
            Self::Speed => Unit::MetrePerSecond,
            Self::SpeedPerEnergy => Unit::MetrePerJoule,
        }
    }
}

impl Aggregate {
    /// The number of some repeats; at least one.
    pub fn of(self, values: &[f64]) -> f64 {
        match self {
            Self::Mean => mean(values),
            Self::LowerQuantile(level) => quantile(values, level),
            Self::MeanMinusSd(k) => mean(values) - k * standard_deviation(values),
        }
    }
}

impl Objective {
    /// The part of one run of this length that counts; `energy` is counted from [`Objective::from_s`] on.
    pub fn travel(
        &self,
        path: &Prepared,
        turned_rad: f64,
        energy: Option<&EnergyBalance>,
        duration_s: f64,
    ) -> Travel {
        let servo_j = energy.map(|energy| energy.servo_positive_j);
        let xy_m = path.xy_m();
        let share = (self.from_s / duration_s).clamp(0.0, 1.0);
        let first = (share * (xy_m.len() - 1) as f64).round() as usize;
        let distance_m = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let counted = &xy_m[first..];
        let end_m = counted[counted.len() - 1];
        let (mut displacement_m, path_length_m) = match first {
            0 => (path.net_displacement_m(), path.path_length_m()),
            _ => {
                let steps_m = counted.windows(2).map(|w| distance_m(w[0], w[1]));
                (distance_m(counted[0], end_m), steps_m.sum())
            }
        };
        if let Some(times) = self.last_quarters {
            let last_m = distance_m(counted[(counted.len() - 1) * 3 / 4], end_m);
            displacement_m = displacement_m.min(times * last_m);
        }
        Travel {
            displacement_m,
            path_length_m,
            turned_rad,
            servo_j,
        }
    }

    /// Its value for the repeats of one robot; at least one.
    pub fn of(&self, repeats: &[Travel], body_length_m: f64, duration_s: f64) -> f64 {
        let values = repeats.iter();
        let counted_s = duration_s - self.from_s;
        let values = values.map(|travel| self.measure.of(travel, body_length_m, counted_s));
        self.aggregate.of(&values.collect::<Vec<_>>())
    }

    /// Checks that it can be computed.
    ///
    /// # Errors
    /// A quantile's level or a factor out of range.
    pub fn check(&self) -> Result<()> {
        Range::within(0.0, 3600.0, "s").check(self.from_s, "from_s")?;
        if let Some(times) = self.last_quarters {
            // A factor below four would reduce the measure of a steady walker.
            Range::within(4.0, 1e6, "").check(times, "last_quarters")?;
        }
        let (value, highest) = match self.aggregate {
            Aggregate::Mean => return Ok(()),
            Aggregate::LowerQuantile(level) => (level, 1.0),
            Aggregate::MeanMinusSd(k) => (k, 100.0),
        };
        Range::within(0.0, highest, "").check(value, "aggregate")
    }

    /// A short description for readers, e.g. `displacement, 20 % quantile`.
    pub fn label(&self) -> String {
        let aggregate = match self.aggregate {
            Aggregate::Mean => "mean".to_owned(),
            Aggregate::LowerQuantile(level) => format!("{} % quantile", 100.0 * level),
            Aggregate::MeanMinusSd(k) => format!("mean - {k} sd"),
        };
        let after = match self.from_s {
            0.0 => String::new(),
            from_s => format!(" after {from_s} s"),
        };
        let last = match self.last_quarters {
            None => String::new(),
            Some(times) => format!(", at most {times} times its last quarter"),
        };
        format!("{}{after}{last}, {aggregate}", self.measure.label())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use realgap_path::trajectory::{Trajectory, prepare};

    /// The counted displacement of a run of 20 s with this position along x over time.
    fn counted_m(x_m: impl Fn(f64) -> f64, last_quarters: Option<f64>) -> f64 {
        let times_s: Vec<f64> = (0..=1200).map(|k| f64::from(k) / 60.0).collect();
        let places = times_s.iter().map(|t| Vector3::new(x_m(*t), 0.0, 0.0));
        let motion = Trajectory::new(times_s.clone(), places.collect()).unwrap();
        let objective = Objective {
            from_s: 5.0,
            last_quarters,
            ..Objective::default()
        };
        let path = prepare(&motion).unwrap();
        objective.travel(&path, 0.0, None, 20.0).displacement_m
    }

    #[test]
    fn a_fall_is_no_walk_where_the_last_quarter_counts() {
        // The robot falls over in the eighth second and then lies still.
        let fall = |t: f64| if t < 8.0 { 0.0 } else { 0.4 };
        let walk = |t: f64| 0.04 * t;
        let last = Some(8.0);
        assert!((counted_m(fall, None) - 0.4).abs() < 1e-9);
        assert!(counted_m(fall, last) < 1e-9);
        assert!((counted_m(walk, last) - counted_m(walk, None)).abs() < 1e-12);
        assert!((counted_m(walk, last) - 0.6).abs() < 0.01);
    }
}
