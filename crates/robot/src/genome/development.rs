//! Settings of development: module sizes, masses, servo limits and gait ranges that a genome is translated into.

use serde::{Deserialize, Serialize};

use super::sequence::Genome;
use crate::morphology::{
    Actuator, CommandScale, Drive, DriveAxis, Face, Gait, Plate, Servo, ServoLaw,
};
use realgap_core::{Error, Result};

/// Settings that translate the numbers of a genome into sizes, masses, a servo and the ranges of the gait.
///
/// The papers give the side of the active module (about 58 mm) and up to five modules; all other values are assumptions; the
/// masses and the servo are those of `morphologies/tripod.ron`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Development {
    /// Largest number of modules of a robot, 1 to [`Genome::MAX_MODULES`].
    pub max_modules: usize,
    /// Share of the range of the gene's number `kind` that stands for a passive module, 0 to 1.
    pub passive_share: f64,
    /// Edge length of every module, m. Active and passive modules have the same edge length, so that all of them lie on one
    /// lattice.
    pub side_m: f64,
    /// Mass of a passive module, kg.
    pub passive_mass_kg: f64,
    /// Mass of an active module without its plate, kg.
    pub active_mass_kg: f64,
    /// Edge length of the plate on the driven face, m.
    pub plate_side_m: f64,
    /// Thickness of the plate, m.
    pub plate_thickness_m: f64,
    /// Mass of the plate, kg.
    pub plate_mass_kg: f64,
    /// Gain of the servo's velocity law, 1/s.
    pub servo_gain_1_s: f64,
    /// Largest torque of the servo, N m.
    pub servo_max_torque_nm: f64,
    /// Largest speed of the servo, rad/s.
    pub servo_max_speed_rad_s: f64,
    /// Range of the amplitude, rad: the first value for a gene number of 0, the second for 1.
    pub amplitude_rad: (f64, f64),
    /// Range of the frequency, Hz. With the default amplitudes no gait commands a larger speed than the servo's limit.
    pub frequency_hz: (f64, f64),
    /// Range of the phase, rad.
    pub phase_rad: (f64, f64),
    /// Range of the mean angle, rad. The mean angle matters because a square plate pushes with its corners.
    pub offset_rad: (f64, f64),
}

impl Default for Development {
    fn default() -> Self {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};
        Self {
            max_modules: 5,
            passive_share: 0.5,
            side_m: 0.058,
            passive_mass_kg: 0.03,
            active_mass_kg: 0.068,
            plate_side_m: 0.058,
            plate_thickness_m: 0.006,
            plate_mass_kg: 0.012,
            servo_gain_1_s: 30.0,
            servo_max_torque_nm: 0.2,
            servo_max_speed_rad_s: 8.0,
            amplitude_rad: (0.0, FRAC_PI_2),
            frequency_hz: (0.2, 0.8),
            phase_rad: (0.0, TAU),
            offset_rad: (-FRAC_PI_4, FRAC_PI_4),
        }
    }
}

impl Development {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn check(&self) -> Result<()> {
        if !(1..=Genome::MAX_MODULES).contains(&self.max_modules) {
            return Err(Error::invalid("out of range")
                .field("max_modules")
                .found(self.max_modules)
                .allowed(format!("1 to {}", Genome::MAX_MODULES)));
        }
        let positive = f64::MIN_POSITIVE;
        for (field, value, low, high, unit) in [
            ("passive_share", self.passive_share, 0.0, 1.0, ""),
            ("side_m", self.side_m, 0.001, 10.0, " m"),
            ("passive_mass_kg", self.passive_mass_kg, 1e-6, 1e3, " kg"),
            ("active_mass_kg", self.active_mass_kg, 1e-6, 1e3, " kg"),
            ("plate_side_m", self.plate_side_m, 0.001, 10.0, " m"),
            (
                "plate_thickness_m",
                self.plate_thickness_m,
                1e-6,
                10.0,
                " m",
            ),
            ("plate_mass_kg", self.plate_mass_kg, 1e-6, 1e3, " kg"),
            ("servo_gain_1_s", self.servo_gain_1_s, positive, 1e5, " 1/s"),
            (
                "servo_max_torque_nm",
                self.servo_max_torque_nm,
                positive,
                1e4,
                " N m",
            ),
            (
                "servo_max_speed_rad_s",
                self.servo_max_speed_rad_s,
                positive,
                1e4,
                " rad/s",
            ),
        ] {
            if !(low..=high).contains(&value) {
                let allowed = if low == positive {
                    format!("more than 0, at most {high}{unit}")
                } else {
                    format!("{low} to {high}{unit}")
                };
                return Err(Error::invalid("out of range")
                    .field(field)
                    .found(format!("{value}{unit}"))
                    .allowed(allowed));
            }
        }
        for (field, (low, high), widest, unit) in [
            ("amplitude_rad", self.amplitude_rad, -1000.0..=1000.0, "rad"),
            ("frequency_hz", self.frequency_hz, 0.0..=100.0, "Hz"),
            ("phase_rad", self.phase_rad, -1000.0..=1000.0, "rad"),
            ("offset_rad", self.offset_rad, -1000.0..=1000.0, "rad"),
        ] {
            if !(widest.contains(&low) && widest.contains(&high) && low <= high) {
                return Err(Error::invalid("not a usable range")
                    .field(field)
                    .found(format!("({low}, {high}) {unit}"))
                    .allowed(format!(
                        "(low, high) with low not above high, both from {} to {} {unit}",
                        widest.start(),
                        widest.end()
                    )));
            }
        }
        Ok(())
    }

    /// A servo that spins the plate on `face`.
    pub(super) fn drive(&self, face: Face, gait: Gait) -> Drive {
        Drive {
            face,
            axis: DriveAxis::Normal {
                plate: Some(Plate {
                    side_m: self.plate_side_m,
                    thickness_m: self.plate_thickness_m,
                    mass_kg: self.plate_mass_kg,
                }),
            },
            actuator: Actuator {
                servo: Servo {
                    law: ServoLaw::Velocity {
                        gain_per_s: self.servo_gain_1_s,
                    },
                    max_torque_nm: self.servo_max_torque_nm,
                    max_speed_rad_s: self.servo_max_speed_rad_s,
                    delay_s: 0.0,
                },
                gait,
                command: CommandScale::default(),
            },
        }
    }
}
