//! The unit of the angles in a log: as stated, as names say, or as values show.

use super::super::super::reading::{Reading, Ticks};
use super::name::{Found, Quantity, words};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::AngleUnit;

/// Angles beyond this are not in radians, those of joints that do not wind up.
const RADIANS: f64 = 7.0;
/// Angles beyond this are not in degrees.
const DEGREES: f64 = 361.0;
/// The largest counts of encoders per turn; whole numbers beyond the smallest of them are counts.
const PER_TURN: [f64; 4] = [1024.0, 4096.0, 16384.0, 65536.0];
/// The smallest count that is none of degrees.
const COUNTS: f64 = 400.0;
/// Differences below this are those of rounding.
const ROUNDED: f64 = 1e-4;
/// How near to a whole number of steps a move has to be, the share of moves that have to be so, and the smallest number of moves.
const WHOLE: f64 = 0.02;
const MOST_STEPS: f64 = 0.95;
const FEW: usize = 20;
/// The step of a common encoder of 4096 counts per turn, degrees.
const STEP_DEG: f64 = 360.0 / 4096.0;

/// The unit of angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unit {
    Of(AngleUnit),
    Ticks(Ticks),
}

impl Unit {
    pub(super) fn words(self) -> String {
        match self {
            Self::Of(unit) => unit.to_string(),
            Self::Ticks(ticks) => format!("counts of an encoder ({ticks})"),
        }
    }

    /// The name of a column in this program's own files; `None` for a quantity that it does not read in this unit.
    pub(super) fn name(self, joint: &str, quantity: Quantity) -> Option<String> {
        let symbol = match self {
            Self::Of(unit) => unit.symbol(),
            Self::Ticks(_) => "ticks",
        };
        let is_rad = self == Self::Of(AngleUnit::Radian);
        match quantity {
            Quantity::Angle => Some(format!("{joint}_{symbol}")),
            Quantity::Command => Some(format!("{joint}_command_{symbol}")),
            // A servo that counts angles gives speeds in a unit of its own, e.g. 0.229 turns a minute.
            Quantity::Speed if symbol == "ticks" => None,
            Quantity::Speed => Some(format!("{joint}_{symbol}_s")),
            Quantity::CommandedSpeed => is_rad.then(|| format!("{joint}_command_rad_s")),
            Quantity::CommandedTorque => Some(format!("{joint}_command_nm")),
            Quantity::CommandedCurrent => Some(format!("{joint}_command_a")),
            Quantity::Torque => Some(format!("{joint}_torque_nm")),
        }
    }
}

/// The unit of the angles, with the reason: as stated, as the names say, or from the values.
pub(super) fn unit(found: &[Found<'_, '_>], known: &Reading) -> Result<(Unit, String)> {
    if let Some(ticks) = known.ticks {
        return Ok((Unit::Ticks(ticks), "stated".to_owned()));
    }
    if let Some(unit) = known.angle {
        return Ok((Unit::Of(unit), "stated".to_owned()));
    }
    let is_angle =
        |one: &&Found<'_, '_>| matches!(one.quantity, Quantity::Angle | Quantity::Command);
    let angles: Vec<&Found<'_, '_>> = found.iter().filter(is_angle).collect();
    let says = |word: &str| {
        angles
            .iter()
            .all(|one| words(one.column.name).iter().any(|w| w == word))
    };
    for unit in [AngleUnit::Radian, AngleUnit::Degree] {
        if says(unit.symbol()) {
            return Ok((Unit::Of(unit), "the names of the columns say so".to_owned()));
        }
    }
    let values = || {
        angles
            .iter()
            .flat_map(|one| one.column.values.iter().copied())
    };
    let largest = values().fold(0.0, |most: f64, value| most.max(value.abs()));
    let are_whole = values().all(|value| value.fract() == 0.0);
    if are_whole && largest > COUNTS {
        let per_turn = PER_TURN.into_iter().find(|most| largest < *most);
        let per_turn = per_turn.unwrap_or(PER_TURN[3]);
        let ticks = Ticks {
            per_turn,
            zero: per_turn / 2.0,
        };
        let because = format!(
            "all are whole numbers up to {largest}; if the encoder has other counts, or its zero is elsewhere, state them as `ticks`"
        );
        return Ok((Unit::Ticks(ticks), because));
    }
    let reason = |unit: &str| format!("they reach {largest:.4}{unit}");
    if has_degree_steps(&angles) {
        let because =
            format!("their steps are those of 4096 counts per turn, {STEP_DEG:.4} degrees");
        return Ok((Unit::Of(AngleUnit::Degree), because));
    }
    if largest <= RADIANS {
        return Ok((Unit::Of(AngleUnit::Radian), reason("")));
    }
    let is_learning = angles.iter().any(|one| {
        let words = words(one.column.name);
        ["observation", "action"]
            .iter()
            .any(|known| words.iter().any(|word| word == known))
    });
    let is_full = values().any(|value| value.abs() == 100.0);
    if largest <= DEGREES && !(largest <= 100.0 && (is_learning || is_full)) {
        return Ok((Unit::Of(AngleUnit::Degree), reason("")));
    }
    let error = Error::usage("the recordings leave a question open").found(format!(
        "angles of joints up to {largest:.4}, and no name states their unit"
    ));
    Err(match largest <= 100.0 {
        true => error
            .allowed("degrees or radians; shares of a range from -100 to 100, as robot learning writes them, are no angles")
            .hint("turn shares into angles with the calibration of the robot; of a data set of LeRobot, put the calibration file into its folder as meta/calibration.json")
            .advise(Advice::AngleUnit),
        false => error
            .allowed("degrees, radians, or counts of an encoder")
            .advise(Advice::AngleUnit),
    })
}

/// Whether measured angles move by steps of an encoder of 4096 counts per turn, in degrees; they may be rounded to few digits.
pub(super) fn has_degree_steps(angles: &[&Found<'_, '_>]) -> bool {
    let measured = angles.iter().filter(|one| one.quantity == Quantity::Angle);
    let pairs = measured.flat_map(|one| one.column.values.windows(2));
    let moves = pairs.map(|pair| (pair[1] - pair[0]).abs());
    let counts: Vec<f64> = moves
        .filter(|by| *by > ROUNDED)
        .map(|by| by / STEP_DEG)
        .collect();
    let whole = counts
        .iter()
        .filter(|count| (*count - count.round()).abs() < WHOLE && count.round() > 0.0);
    counts.len() >= FEW && whole.count() as f64 > MOST_STEPS * counts.len() as f64
}
