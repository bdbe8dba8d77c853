//! Modules: cubes, and cubes that drive one of their faces.

use nalgebra::{Matrix3, Vector3};

use super::assembly::{Gait, Servo, ServoLaw};
use super::face::Face;
use super::flaw::{Checked, Flaw};
use crate::Error;

/// One cube module. Lengths in metres, in the module's own frame: origin at the centre of the
/// cube, axes along its faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Unique name: letters, digits, `_` and `-`, at most [`Module::MAX_NAME`] characters.
    pub name: String,
    /// Edge length, m.
    pub side_m: f64,
    /// Mass without the face plate, kg.
    pub mass_kg: f64,
    /// Principal moments about the centre of mass, along the module's axes, kg m²; a solid cube when `None`.
    pub inertia_kg_m2: Option<[f64; 3]>,
    /// Centre of mass in the module's frame, m; inside the cube.
    pub centre_of_mass_m: Vector3<f64>,
    /// The servo of an active module; `None` for a passive one.
    pub drive: Option<Drive>,
}

/// What makes a module active: a servo that drives one of its faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// The driven face.
    pub face: Face,
    /// How the face moves.
    pub axis: DriveAxis,
    /// Control law and limits.
    pub servo: Servo,
    /// Open-loop command.
    pub gait: Gait,
}

/// How a driven face moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveAxis {
    /// The face spins about its own outward normal, right-handed.
    Normal {
        /// The slab on the face. Needed where no module is glued onto the face.
        plate: Option<Plate>,
    },
    /// The face bends like a hinge, whose axis runs through the centre of the face.
    Tangent {
        /// Direction of the axis, right-handed; at right angles to the face.
        axis: Face,
    },
}

/// A square slab on a driven face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate {
    /// Edge length, m.
    pub side_m: f64,
    /// Thickness, m.
    pub thickness_m: f64,
    /// Mass, kg.
    pub mass_kg: f64,
}

/// Largest angle in a gait (offset, amplitude, phase), rad.
const MAX_ANGLE_RAD: f64 = 1000.0;

impl Module {
    /// Longest name, in characters.
    pub const MAX_NAME: usize = 64;

    /// A passive module: a solid cube.
    pub fn passive(name: impl Into<String>, side_m: f64, mass_kg: f64) -> Self {
        Self {
            name: name.into(),
            side_m,
            mass_kg,
            inertia_kg_m2: None,
            centre_of_mass_m: Vector3::zeros(),
            drive: None,
        }
    }

    /// An active module: a solid cube that drives one of its faces.
    pub fn active(name: impl Into<String>, side_m: f64, mass_kg: f64, drive: Drive) -> Self {
        Self {
            drive: Some(drive),
            ..Self::passive(name, side_m, mass_kg)
        }
    }

    /// The slab on the driven face, if there is one.
    pub fn plate(&self) -> Option<Plate> {
        match self.drive?.axis {
            DriveAxis::Normal { plate } => plate,
            DriveAxis::Tangent { .. } => None,
        }
    }

    /// The driven face of an active module.
    pub fn driven_face(&self) -> Option<Face> {
        self.drive.map(|drive| drive.face)
    }

    /// Inertia of the cube about its centre of mass, along the module's axes, kg m².
    pub fn cube_inertia_kg_m2(&self) -> Matrix3<f64> {
        let solid = self.mass_kg * self.side_m * self.side_m / 6.0;
        let [x, y, z] = self.inertia_kg_m2.unwrap_or([solid; 3]);
        Matrix3::from_diagonal(&Vector3::new(x, y, z))
    }

    /// Checks every value by itself. `at` is the path of this module in a file, e.g. `modules[2]`.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        check_name(&self.name, "a module", &format!("{at}.name"))?;
        let at = format!("{at}.kind");
        check_side(self.side_m, &format!("{at}.side_m"))?;
        check_mass(self.mass_kg, &format!("{at}.mass_kg"))?;
        if let Some(moments) = self.inertia_kg_m2 {
            check_inertia(moments, &format!("{at}.inertia_kg_m2"))?;
        }
        for (index, offset) in self.centre_of_mass_m.iter().enumerate() {
            let half = self.side_m / 2.0;
            if offset.is_nan() || offset.abs() > half {
                return Err(Flaw::new(
                    format!("{at}.centre_of_mass_m[{index}]"),
                    Error::invalid("the centre of mass must lie inside the cube")
                        .found(format!("{} m", number(*offset)))
                        .allowed(format!("between {} m and {half} m", -half)),
                ));
            }
        }
        self.drive.map_or(Ok(()), |drive| drive.check(&at))
    }
}

impl Drive {
    fn check(&self, at: &str) -> Checked<()> {
        match self.axis {
            DriveAxis::Normal { plate: Some(plate) } => {
                let at = format!("{at}.axis.plate");
                check_side(plate.side_m, &format!("{at}.side_m"))?;
                Range::above(0.0, 10.0, "m")
                    .check(plate.thickness_m, &format!("{at}.thickness_m"))?;
                check_mass(plate.mass_kg, &format!("{at}.mass_kg"))?;
            }
            DriveAxis::Normal { plate: None } => {}
            DriveAxis::Tangent { axis } if axis.is_perpendicular_to(self.face) => {}
            DriveAxis::Tangent { axis } => {
                let allowed: Vec<&str> = self.face.perpendicular().map(Face::name).collect();
                return Err(Flaw::new(
                    format!("{at}.axis.axis"),
                    Error::invalid(format!(
                        "a bending axis must be at right angles to the driven face {}",
                        self.face.name()
                    ))
                    .found(axis.name())
                    .allowed(allowed.join(", "))
                    .hint("use `axis: Normal(...)` for a face that spins about its own normal"),
                ));
            }
        }
        self.check_servo(&format!("{at}.servo"))?;
        let at = format!("{at}.gait");
        let angle = Range::within(-MAX_ANGLE_RAD, MAX_ANGLE_RAD, "rad");
        angle.check(self.gait.offset_rad, &format!("{at}.offset_rad"))?;
        angle.check(self.gait.amplitude_rad, &format!("{at}.amplitude_rad"))?;
        Range::within(0.0, 100.0, "Hz")
            .check(self.gait.frequency_hz, &format!("{at}.frequency_hz"))?;
        angle.check(self.gait.phase_rad, &format!("{at}.phase_rad"))
    }

    fn check_servo(&self, at: &str) -> Checked<()> {
        let Servo {
            law,
            max_torque_nm,
            max_speed_rad_s,
        } = self.servo;
        match law {
            ServoLaw::Velocity { gain_1_s } => {
                Range::above(0.0, 1e5, "1/s").check(gain_1_s, &format!("{at}.law.gain_1_s"))?;
            }
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => {
                Range::above(0.0, 1e6, "N m/rad")
                    .check(stiffness_nm_rad, &format!("{at}.law.stiffness_nm_rad"))?;
                Range::within(0.0, 1e6, "N m s/rad")
                    .check(damping_nm_s_rad, &format!("{at}.law.damping_nm_s_rad"))?;
            }
        }
        Range::above(0.0, 1e4, "N m").check(max_torque_nm, &format!("{at}.max_torque_nm"))?;
        // Infinity is the documented way to say "no limit"; files say it by leaving the field out.
        if max_speed_rad_s == f64::INFINITY {
            return Ok(());
        }
        Range::above(0.0, 1e4, "rad/s")
            .check(max_speed_rad_s, &format!("{at}.max_speed_rad_s"))
            .map_err(|flaw| flaw.hint("leave it out for a servo without a speed limit"))
    }
}

/// Letters, digits, `_` and `-`, the last not in front: names become column names, file names and parameter names.
pub(super) fn check_name(name: &str, whose: &str, at: &str) -> Checked<()> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let count = name.chars().count();
    if (1..=Module::MAX_NAME).contains(&count) && name.chars().all(plain) && !name.starts_with('-')
    {
        return Ok(());
    }
    let shown: String = name.chars().take(Module::MAX_NAME).collect();
    Err(Flaw::new(
        at,
        Error::invalid(format!("not a usable name for {whose}"))
            .found(format!("{shown:?} ({count} characters)"))
            .allowed(format!(
                "1 to {} letters a-z and A-Z, digits, `_` and `-` (not in front)",
                Module::MAX_NAME
            )),
    ))
}

fn check_side(side_m: f64, at: &str) -> Checked<()> {
    Range::within(0.001, 10.0, "m").check(side_m, at)
}

fn check_mass(mass_kg: f64, at: &str) -> Checked<()> {
    Range::within(1e-6, 1000.0, "kg").check(mass_kg, at)
}

/// Moments that no body can have (one larger than the sum of the others) make a simulation explode.
fn check_inertia(moments: [f64; 3], at: &str) -> Checked<()> {
    for (index, &moment) in moments.iter().enumerate() {
        Range::above(0.0, 1e5, "kg m^2").check(moment, &format!("{at}[{index}]"))?;
        let others = moments.iter().sum::<f64>() - moment;
        if moment > others * (1.0 + 1e-9) {
            return Err(Flaw::new(
                at,
                Error::invalid("no solid has such moments of inertia")
                    .found(format!(
                        "{moment} kg m^2, but the two others sum to {others}"
                    ))
                    .allowed("no moment larger than the sum of the two others"),
            ));
        }
    }
    Ok(())
}

/// A range of a quantity; NaN and infinities are in none.
struct Range {
    low: f64,
    low_excluded: bool,
    high: f64,
    unit: &'static str,
}

impl Range {
    fn within(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low,
            low_excluded: false,
            high,
            unit,
        }
    }

    fn above(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low_excluded: true,
            ..Self::within(low, high, unit)
        }
    }

    fn check(&self, value: f64, at: &str) -> Checked<()> {
        let Self {
            low, high, unit, ..
        } = *self;
        if value >= low && value <= high && !(self.low_excluded && value == low) {
            return Ok(());
        }
        let allowed = if self.low_excluded {
            format!(
                "more than {} {unit}, at most {} {unit}",
                number(low),
                number(high)
            )
        } else {
            format!("{} {unit} to {} {unit}", number(low), number(high))
        };
        let problem = if value.is_finite() {
            "out of range"
        } else {
            "not a number that can be used"
        };
        Err(Flaw::new(
            at,
            Error::invalid(problem)
                .found(format!("{} {unit}", number(value)))
                .allowed(allowed),
        ))
    }
}

/// As people write it: 1e300 has no use for 300 digits.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
