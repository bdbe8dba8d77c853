//! Modules of a robot: boxes (in most cases cubes), and boxes with a servo that drives one of their faces.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::assembly::{Actuator, Servo};
use super::face::Face;
use super::flaw::{Checked, Flaw, Range};
use super::law::ServoLaw;
use super::motor::check_motor;
use realgap_core::{Error, range};

/// One module. Lengths in metres, in the module's own frame: origin at the centre of its box, axes along the faces of
/// the box.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Unique name: letters, digits, `_` and `-`, at most [`Module::MAX_NAME`] characters.
    pub name: String,
    /// Edge lengths along x, y and z, m; all equal for a cube. Attachments and servos are on the faces of this box.
    pub sides_m: Vector3<f64>,
    /// The solid boxes of the module within that outer box; if empty, the module fills the outer box.
    pub boxes: Vec<ModuleBox>,
    /// Mass without the face plate, kg.
    pub mass_kg: f64,
    /// Principal moments about the centre of mass, along the module's axes, kg m²; of uniform boxes when `None`.
    pub inertia_kg_m2: Option<[f64; 3]>,
    /// Centre of mass in the module's frame, m, inside the box; that of uniform boxes when `None`.
    pub centre_of_mass_m: Option<Vector3<f64>>,
    /// The servo of an active module; `None` for a passive one.
    pub drive: Option<Drive>,
}

/// One of the boxes of a module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModuleBox {
    /// Edge lengths along the module's axes, m.
    pub sides_m: Vector3<f64>,
    /// Centre in the module's frame, m.
    pub centre_m: Vector3<f64>,
}

/// The servo of an active module, which drives one of its faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// The driven face.
    pub face: Face,
    /// How the face moves.
    pub axis: DriveAxis,
    /// Servo and gait.
    pub actuator: Actuator,
}

/// How a driven face moves.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "axis")]
pub enum DriveAxis {
    /// The face spins about its own outward normal, right-handed.
    Normal {
        /// The slab on the face. It is required if no module is attached to the face.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        plate: Option<Plate>,
    },
    /// The face bends like a hinge, whose axis runs through the centre of the face.
    Tangent {
        /// Direction of the axis, right-handed; at right angles to the face.
        axis: Face,
    },
}

/// A square slab on a driven face.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "plate")]
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
            sides_m: Vector3::repeat(side_m),
            boxes: Vec::new(),
            mass_kg,
            inertia_kg_m2: None,
            centre_of_mass_m: None,
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

    /// The slab on the driven face, if any.
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

    /// The boxes that the module consists of, at least one.
    pub(crate) fn solid_boxes(&self) -> Vec<ModuleBox> {
        if self.boxes.is_empty() {
            return vec![ModuleBox {
                sides_m: self.sides_m,
                centre_m: Vector3::zeros(),
            }];
        }
        self.boxes.clone()
    }

    /// Whether all edge lengths are equal.
    pub(crate) fn is_cube(&self) -> bool {
        self.sides_m == Vector3::repeat(self.sides_m.x)
    }

    /// Mass (kg), centre of mass (m) and inertia about it (kg m²) of each box, in the module's frame. If the file states an
    /// inertia or a centre of mass, the first box carries all of the mass and the others have none; otherwise the density is
    /// uniform.
    pub(super) fn box_masses(&self) -> Vec<(f64, Vector3<f64>, Matrix3<f64>)> {
        let boxes = self.solid_boxes();
        let volumes_m3: Vec<f64> = boxes.iter().map(|b| b.sides_m.product()).collect();
        let whole_m3: f64 = volumes_m3.iter().sum();
        let uniform: Vec<_> = boxes
            .iter()
            .zip(&volumes_m3)
            .map(|(b, volume_m3)| {
                let share = if boxes.len() == 1 {
                    1.0
                } else {
                    volume_m3 / whole_m3
                };
                let mass_kg = self.mass_kg * share;
                (
                    mass_kg,
                    b.centre_m,
                    uniform_inertia_kg_m2(mass_kg, &b.sides_m),
                )
            })
            .collect();
        if self.inertia_kg_m2.is_none() && self.centre_of_mass_m.is_none() {
            return uniform;
        }
        let moment: Vector3<f64> = uniform.iter().map(|(mass, at, _)| at * *mass).sum();
        let centre_m = moment / self.mass_kg;
        let inertia = match self.inertia_kg_m2 {
            Some([x, y, z]) => Matrix3::from_diagonal(&Vector3::new(x, y, z)),
            None if boxes.len() == 1 => uniform[0].2,
            None => uniform
                .iter()
                .map(|(mass_kg, at_m, own)| {
                    let d = at_m - centre_m;
                    own + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * *mass_kg
                })
                .sum(),
        };
        let first = (
            self.mass_kg,
            self.centre_of_mass_m.unwrap_or(centre_m),
            inertia,
        );
        let rest = boxes[1..]
            .iter()
            .map(|b| (0.0, b.centre_m, Matrix3::zeros()));
        std::iter::once(first).chain(rest).collect()
    }

    /// Checks the range of every value. `at` is the path of this module in a file, e.g. `modules[2]`.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        check_name(&self.name, "a module", &format!("{at}.name"))?;
        let at = format!("{at}.kind");
        if self.is_cube() || self.sides_m.x.is_nan() {
            check_side(self.sides_m.x, &format!("{at}.side_m"))?;
        }
        for (index, side_m) in self.sides_m.iter().enumerate() {
            check_side(*side_m, &format!("{at}.sides_m[{index}]"))?;
        }
        for (index, part) in self.boxes.iter().enumerate() {
            self.check_box(part, &format!("{at}.boxes[{index}]"))?;
        }
        check_mass(self.mass_kg, &format!("{at}.mass_kg"))?;
        if let Some(moments) = self.inertia_kg_m2 {
            check_inertia(moments, &format!("{at}.inertia_kg_m2"))?;
        }
        for (index, offset) in self.centre_of_mass_m.iter().flatten().enumerate() {
            let half = self.sides_m[index] / 2.0;
            if offset.is_nan() || offset.abs() > half {
                return Err(Flaw::new(
                    format!("{at}.centre_of_mass_m[{index}]"),
                    Error::invalid("the centre of mass must lie inside the module")
                        .found(format!("{} m", range::number(*offset)))
                        .allowed(format!("between {} m and {half} m", -half)),
                ));
            }
        }
        self.drive.map_or(Ok(()), |drive| drive.check(&at))
    }

    fn check_box(&self, part: &ModuleBox, at: &str) -> Checked<()> {
        for index in 0..3 {
            check_side(part.sides_m[index], &format!("{at}.sides_m[{index}]"))?;
            let reach_m = part.centre_m[index].abs() + 0.5 * part.sides_m[index];
            let half_m = 0.5 * self.sides_m[index];
            if reach_m.is_nan() || reach_m > half_m + 1e-9 {
                return Err(Flaw::new(
                    format!("{at}.centre_m[{index}]"),
                    Error::invalid("a box extends beyond its module")
                        .found(format!("it extends {} m from the module's centre", range::number(reach_m)))
                        .allowed(format!("at most {half_m} m, half of the module's side"))
                        .hint("enlarge sides_m (or side_m): the faces of the module are those of the bounding box of all its boxes"),
                ));
            }
        }
        Ok(())
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
        check_actuator(&self.actuator, at)
    }
}

/// Checks a servo and its gait; `at` is the path of the value that contains both.
pub(super) fn check_actuator(actuator: &Actuator, at: &str) -> Checked<()> {
    check_servo(&actuator.servo, &format!("{at}.servo"))?;
    let at = format!("{at}.gait");
    let gait = &actuator.gait;
    let angle = Range::within(-MAX_ANGLE_RAD, MAX_ANGLE_RAD, "rad");
    angle.check(gait.offset_rad, &format!("{at}.offset_rad"))?;
    angle.check(gait.amplitude_rad, &format!("{at}.amplitude_rad"))?;
    Range::within(0.0, 100.0, "Hz").check(gait.frequency_hz, &format!("{at}.frequency_hz"))?;
    angle.check(gait.phase_rad, &format!("{at}.phase_rad"))
}

fn check_servo(servo: &Servo, at: &str) -> Checked<()> {
    let Servo {
        law,
        max_torque_nm,
        max_speed_rad_s,
        delay_s,
        torque_constant_nm_a,
    } = *servo;
    if let Some(constant) = torque_constant_nm_a {
        let at = format!("{at}.torque_constant_nm_a");
        Range::above(0.0, 1000.0, "N m/A").check(constant, &at)?;
        if law.motor().is_some() {
            return Err(Flaw::new(
                at,
                Error::invalid("the law of this servo states its own torque constant")
                    .found(format!("{constant} N m/A beside `law: Motor(...)`"))
                    .hint("state it in the law alone"),
            ));
        }
    }
    Range::within(0.0, 10.0, "s").check(delay_s, &format!("{at}.delay_s"))?;
    match law {
        ServoLaw::Velocity { gain_per_s } => {
            Range::above(0.0, 1e5, "1/s").check(gain_per_s, &format!("{at}.law.gain_1_s"))?;
        }
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => {
            // Without stiffness, the servo follows speeds by its damping.
            let is_of_speeds = stiffness_nm_rad == 0.0 && damping_nm_s_rad > 0.0;
            if !is_of_speeds {
                Range::above(0.0, 1e6, "N m/rad")
                    .check(stiffness_nm_rad, &format!("{at}.law.stiffness_nm_rad"))?;
            }
            Range::within(0.0, 1e6, "N m s/rad")
                .check(damping_nm_s_rad, &format!("{at}.law.damping_nm_s_rad"))?;
        }
        ServoLaw::Motor(motor) => check_motor(&motor, &format!("{at}.law"))?,
        ServoLaw::Throttle if max_speed_rad_s == f64::INFINITY => {
            return Err(Flaw::new(
                format!("{at}.max_speed_rad_s"),
                Error::invalid("the law Throttle needs the speed at which its torque vanishes")
                    .found("none")
                    .hint("add `max_speed_rad_s` beside `max_torque_nm`, the torque at standstill"),
            ));
        }
        ServoLaw::Direct | ServoLaw::Throttle => {}
    }
    Range::above(0.0, 1e4, "N m").check(max_torque_nm, &format!("{at}.max_torque_nm"))?;
    // Infinity is the documented value for "no limit"; in files the field is left out.
    if max_speed_rad_s == f64::INFINITY {
        return Ok(());
    }
    Range::above(0.0, 1e4, "rad/s")
        .check(max_speed_rad_s, &format!("{at}.max_speed_rad_s"))
        .map_err(|flaw| flaw.hint("leave it out for a servo without a speed limit"))
}

/// A uniform box: m/12 times the sum of the squared sides across the axis; for a cube m s²/6, a formula of its own that keeps the
/// bits of earlier results.
fn uniform_inertia_kg_m2(mass_kg: f64, sides_m: &Vector3<f64>) -> Matrix3<f64> {
    let side_m = sides_m.x;
    if *sides_m == Vector3::repeat(side_m) {
        return Matrix3::from_diagonal_element(mass_kg * side_m * side_m / 6.0);
    }
    let squares = sides_m.component_mul(sides_m);
    Matrix3::from_diagonal(&((Vector3::repeat(squares.sum()) - squares) * (mass_kg / 12.0)))
}

/// Checks that a name consists of letters, digits, `_` and `-` and does not begin with `-`: names become column names, file names
/// and parameter names.
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

/// Refuses physically impossible moments (one larger than the sum of the others), because they make a simulation diverge.
fn check_inertia(moments: [f64; 3], at: &str) -> Checked<()> {
    for (index, &moment) in moments.iter().enumerate() {
        Range::above(0.0, 1e5, "kg m^2").check(moment, &format!("{at}[{index}]"))?;
        let others = moments.iter().sum::<f64>() - moment;
        if moment > others * (1.0 + 1e-9) {
            return Err(Flaw::new(
                at,
                Error::invalid("these moments of inertia are physically impossible")
                    .found(format!(
                        "{moment} kg m^2, but the two others sum to {others}"
                    ))
                    .allowed("no moment larger than the sum of the two others"),
            ));
        }
    }
    Ok(())
}
