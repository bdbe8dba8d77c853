//! Commands of a robot on wheels as forward speed and turn rate, from which the commanded speeds of its wheels follow.

use serde::{Deserialize, Serialize};

use super::Reading;
use super::registry::{format_in, read_bytes};
use realgap_core::error::{Error, Result};

/// Commanded forward speed and turn rate of a robot on wheels. Each wheel gets a column NAME_command_rad_s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WheelCommands {
    /// Column of the forward speed.
    pub forward: String,
    /// Metres per second per unit of that column.
    pub forward_m_s: f64,
    /// Column of the turn rate, positive to the left.
    pub turn: String,
    /// Radians per second per unit of that column.
    pub turn_rad_s: f64,
    /// The wheels.
    pub wheels: Vec<Wheel>,
}

/// A wheel that rolls where the robot drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Wheel {
    /// Its joint.
    pub joint: String,
    /// How far it is to the left of the middle, metres; negative on the right.
    pub left_m: f64,
    /// Its radius, metres; negative where positive angles roll it backwards.
    pub radius_m: f64,
}

impl WheelCommands {
    /// The names of the columns that follow, in the order of the wheels.
    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        let wheels = self.wheels.iter();
        wheels.map(|wheel| format!("{}_command_rad_s", wheel.joint))
    }

    /// Speeds of the wheels that roll without slip, radians per second.
    pub(super) fn speeds_rad_s(&self, forward: f64, turn: f64) -> impl Iterator<Item = f64> {
        let (forward_m_s, turn_rad_s) = (self.forward_m_s * forward, self.turn_rad_s * turn);
        let wheels = self.wheels.iter();
        wheels.map(move |wheel| (forward_m_s - turn_rad_s * wheel.left_m) / wheel.radius_m)
    }

    /// What is wrong with these wheels.
    pub(super) fn fault(&self) -> Option<Error> {
        let is_size = |radius_m: f64| (1e-6..=1e3).contains(&radius_m.abs());
        let numbers = [self.forward_m_s, self.turn_rad_s];
        let sides = self.wheels.iter().map(|wheel| wheel.left_m);
        let are_finite = numbers.into_iter().chain(sides).all(f64::is_finite);
        let are_round = self.wheels.iter().all(|wheel| is_size(wheel.radius_m));
        (self.wheels.is_empty() || !are_finite || !are_round).then(|| {
            Error::invalid("these are no wheels")
                .found(format!("{self:?}"))
                .allowed("one wheel or more, with radii from 1e-6 to 1000 m")
        })
    }
}

/// The columns of a file that state forward speed and turn rate, and the size of their units.
#[derive(Debug, Clone, PartialEq)]
pub struct TwistColumns {
    /// Column of the forward speed, and metres per second per unit.
    pub forward: (String, f64),
    /// Column of the turn rate, and radians per second per unit.
    pub turn: (String, f64),
}

/// Words beside `linear` and `angular` that do not make them something else.
const BESIDE: [&str; 13] = [
    "cmd", "vel", "command", "twist", "x", "z", "m", "mm", "cm", "s", "rad", "deg", "velocity",
];

impl TwistColumns {
    /// The columns `linear` and `angular`, or e.g. `cmd_vel.linear.x` and `cmd_vel.angular.z`; `None` in a file without them, or
    /// without columns.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn infer(path: &std::path::Path, known: &Reading) -> Result<Option<Self>> {
        let bytes = read_bytes(path)?;
        let format = format_in(path, &bytes)?;
        let text = format
            .decode(bytes, known)
            .map_err(|e| e.at_file(path))?
            .text;
        Ok(Self::among(&format.columns(&text, known)))
    }

    fn among(columns: &[&str]) -> Option<Self> {
        let find = |axis: &str, other: &str| {
            let is_one = |name: &&&str| {
                let words = words(name);
                let is_known = |word: &String| word == axis || BESIDE.contains(&word.as_str());
                let is_other_axis = words.iter().any(|word| word == other);
                words.iter().any(|word| word == axis)
                    && words.iter().all(is_known)
                    && !is_other_axis
            };
            let mut found = columns.iter().filter(is_one);
            let first = found.next()?;
            found.next().is_none().then(|| (*first).to_owned())
        };
        let has = |name: &str, unit: &str| words(name).iter().any(|word| word == unit);
        // `linear` may point along x only, and `angular` about z only.
        let forward = find("linear", "z")?;
        let turn = find("angular", "x")?;
        let metres = match (has(&forward, "mm"), has(&forward, "cm")) {
            (true, _) => 1e-3,
            (_, true) => 1e-2,
            _ => 1.0,
        };
        let radians = match has(&turn, "deg") {
            true => 1f64.to_radians(),
            false => 1.0,
        };
        Some(Self {
            forward: (forward, metres),
            turn: (turn, radians),
        })
    }
}

fn words(name: &str) -> Vec<String> {
    let lower = name.to_lowercase();
    let parts = lower.split(|c: char| !c.is_ascii_alphabetic());
    let parts = parts.filter(|part| !part.is_empty());
    parts.map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_a_base_are_known_by_their_names_and_units() {
        let of =
            |names: &[&str]| TwistColumns::among(names).map(|found| (found.forward, found.turn));
        let one = |forward: &str, size: f64, turn: &str, angle: f64| {
            Some(((forward.to_owned(), size), (turn.to_owned(), angle)))
        };
        assert_eq!(
            of(&["t", "x", "linear", "angular"]),
            one("linear", 1.0, "angular", 1.0)
        );
        assert_eq!(
            of(&[
                "cmd_vel.linear.x",
                "cmd_vel.linear.z",
                "cmd_vel.angular.x",
                "cmd_vel.angular.z"
            ]),
            one("cmd_vel.linear.x", 1.0, "cmd_vel.angular.z", 1.0)
        );
        assert_eq!(
            of(&["cmd_linear_cm_s", "cmd_angular_deg_s"]),
            one(
                "cmd_linear_cm_s",
                1e-2,
                "cmd_angular_deg_s",
                1f64.to_radians()
            )
        );
        // A measured twist is no command.
        assert_eq!(of(&["odom.twist.linear.x", "odom.twist.angular.z"]), None);
        assert_eq!(of(&["linear"]), None);
    }

    #[test]
    fn wheels_roll_without_slip_where_they_are() {
        let wheel = |joint: &str, left_m, radius_m| Wheel {
            joint: joint.to_owned(),
            left_m,
            radius_m,
        };
        let commands = WheelCommands {
            forward: "v".to_owned(),
            forward_m_s: 1.0,
            turn: "w".to_owned(),
            turn_rad_s: 1.0,
            wheels: vec![wheel("l", 0.1, 0.05), wheel("r", -0.1, -0.05)],
        };
        let speeds = |v, w| commands.speeds_rad_s(v, w).collect::<Vec<_>>();
        assert_eq!(speeds(0.2, 0.0), [4.0, -4.0]);
        assert_eq!(speeds(0.0, 1.0), [-2.0, -2.0]);
    }
}
