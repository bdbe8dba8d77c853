//! The RON form of a module.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::assembly::{Actuator, Gait, Servo};
use super::command_scale::CommandScale;
use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::module::{Drive, DriveAxis, Module, ModuleBox};
use realgap_core::Error;

/// Three numbers along x, y and z.
pub(super) type Triple = (f64, f64, f64);

#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "defaults")]
pub(super) struct DefaultsFile {
    /// Edge of a cube, metres.
    side_m: Option<f64>,
    /// Mass of a module without its plate, kg.
    mass_kg: Option<f64>,
    /// The servo.
    servo: Option<Servo>,
}

#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "module")]
pub(super) struct ModuleFile {
    /// Unique name: letters, digits, `_` and `-`.
    name: String,
    /// Passive, or active with a servo.
    kind: KindFile,
}

#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "kind")]
#[allow(clippy::large_enum_variant, reason = "read once, then gone")]
enum KindFile {
    /// A cube without a servo.
    Passive {
        /// Edge of a cube, metres; by default that of `defaults`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        side_m: Option<f64>,
        /// Edge lengths along x, y and z in place of `side_m`, metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sides_m: Option<Triple>,
        /// The solid boxes of the module within that outer box; without them the module fills the outer box.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        boxes: Vec<BoxFile>,
        /// Mass without the plate, kg; by default that of `defaults`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mass_kg: Option<f64>,
        /// Principal moments about the centre of mass, along the module's axes, kg m2; by default those of uniform boxes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inertia_kg_m2: Option<Triple>,
        /// Centre of mass in the module's frame, metres; by default that of uniform boxes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre_of_mass_m: Option<Triple>,
    },
    /// A module with a servo that moves one face.
    Active {
        /// Edge of a cube, metres; by default that of `defaults`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        side_m: Option<f64>,
        /// Edge lengths along x, y and z in place of `side_m`, metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sides_m: Option<Triple>,
        /// The solid boxes of the module within that outer box; without them the module fills the outer box.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        boxes: Vec<BoxFile>,
        /// Mass without the plate, kg; by default that of `defaults`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mass_kg: Option<f64>,
        /// Principal moments about the centre of mass, along the module's axes, kg m2; by default those of uniform boxes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inertia_kg_m2: Option<Triple>,
        /// Centre of mass in the module's frame, metres; by default that of uniform boxes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre_of_mass_m: Option<Triple>,
        /// The driven face.
        face: Face,
        /// How the face moves.
        axis: DriveAxis,
        /// Control law and limits; by default those of `defaults`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        servo: Option<Servo>,
        /// The command that the servo follows; without a gait the servo holds 0 rad.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gait: Option<Gait>,
    },
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "box")]
struct BoxFile {
    /// Edge lengths along the module's axes, metres.
    sides_m: Triple,
    /// Centre in the module's frame, metres.
    #[serde(default)]
    centre_m: Triple,
}

pub(super) fn vector((x, y, z): Triple) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

pub(super) fn triple(v: &Vector3<f64>) -> Triple {
    (v.x, v.y, v.z)
}

pub(super) fn required<T>(
    value: Option<T>,
    default: Option<T>,
    field: &str,
    at: &str,
) -> Checked<T> {
    value.or(default).ok_or_else(|| {
        Flaw::new(
            at,
            Error::invalid(format!("the field `{field}` is missing")).hint(format!(
                "add `{field}` here, or to `defaults` for all modules"
            )),
        )
    })
}

impl ModuleFile {
    pub(super) fn into_module(self, at: &str, defaults: &DefaultsFile) -> Checked<Module> {
        let drive = match self.kind {
            KindFile::Passive { .. } => None,
            KindFile::Active {
                face,
                axis,
                servo,
                gait,
                ..
            } => Some(Drive {
                face,
                axis,
                actuator: Actuator {
                    servo: required(servo, defaults.servo, "servo", at)?,
                    gait: gait.unwrap_or(Gait::hold(0.0)),
                    command: CommandScale::default(),
                },
            }),
        };
        let (KindFile::Passive {
            side_m,
            sides_m,
            boxes,
            mass_kg,
            inertia_kg_m2,
            centre_of_mass_m,
        }
        | KindFile::Active {
            side_m,
            sides_m,
            boxes,
            mass_kg,
            inertia_kg_m2,
            centre_of_mass_m,
            ..
        }) = self.kind;
        let sides_m = match (side_m, sides_m) {
            (Some(_), Some(_)) => {
                return Err(Flaw::new(
                    format!("{at}.sides_m"),
                    Error::invalid("a module has `side_m` or `sides_m`, not both"),
                ));
            }
            (None, Some(sides_m)) => vector(sides_m),
            (side_m, None) => Vector3::repeat(required(side_m, defaults.side_m, "side_m", at)?),
        };
        Ok(Module {
            name: self.name,
            sides_m,
            boxes: boxes
                .into_iter()
                .map(|part| ModuleBox {
                    sides_m: vector(part.sides_m),
                    centre_m: vector(part.centre_m),
                })
                .collect(),
            mass_kg: required(mass_kg, defaults.mass_kg, "mass_kg", at)?,
            inertia_kg_m2: inertia_kg_m2.map(|(x, y, z)| [x, y, z]),
            centre_of_mass_m: centre_of_mass_m.map(vector),
            drive,
        })
    }

    pub(super) fn from_module(module: &Module) -> Self {
        let side_m = module.is_cube().then_some(module.sides_m.x);
        let sides_m = (!module.is_cube()).then(|| triple(&module.sides_m));
        let boxes = module
            .boxes
            .iter()
            .map(|part| BoxFile {
                sides_m: triple(&part.sides_m),
                centre_m: triple(&part.centre_m),
            })
            .collect();
        let mass_kg = Some(module.mass_kg);
        let inertia_kg_m2 = module.inertia_kg_m2.map(|[x, y, z]| (x, y, z));
        let centre_of_mass_m = module.centre_of_mass_m.as_ref().map(triple);
        let kind = match &module.drive {
            None => KindFile::Passive {
                side_m,
                sides_m,
                boxes,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
            },
            Some(drive) => KindFile::Active {
                side_m,
                sides_m,
                boxes,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
                face: drive.face,
                axis: drive.axis,
                servo: Some(drive.actuator.servo),
                gait: Some(drive.actuator.gait),
            },
        };
        Self {
            name: module.name.clone(),
            kind,
        }
    }
}
