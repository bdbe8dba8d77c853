//! The RON form of a robot. Only this file knows it; everything else sees validated types.

use std::collections::HashMap;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::assembly::{Gait, Servo, ServoLaw};
use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::glue::Glue;
use super::module::{Drive, DriveAxis, Module, Plate};
use super::tree::quarter_turns_flaw;
use super::{Blueprint, Morphology};
use crate::Error;
use crate::file::unknown_name;

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "morphology")]
pub(super) struct MorphologyFile {
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    description: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    defaults: Option<DefaultsFile>,
    modules: Vec<ModuleFile>,
    #[serde(default)]
    glue: Vec<GlueFile>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    track: Option<String>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "defaults")]
struct DefaultsFile {
    side_m: Option<f64>,
    mass_kg: Option<f64>,
    servo: Option<ServoFile>,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "module")]
struct ModuleFile {
    name: String,
    kind: KindFile,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "kind")]
enum KindFile {
    Passive {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        side_m: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mass_kg: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inertia_kg_m2: Option<(f64, f64, f64)>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre_of_mass_m: Option<(f64, f64, f64)>,
    },
    Active {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        side_m: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mass_kg: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inertia_kg_m2: Option<(f64, f64, f64)>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre_of_mass_m: Option<(f64, f64, f64)>,
        face: Face,
        axis: AxisFile,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        servo: Option<ServoFile>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gait: Option<GaitFile>,
    },
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "axis")]
enum AxisFile {
    Normal {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        plate: Option<PlateFile>,
    },
    Tangent {
        axis: Face,
    },
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "plate")]
struct PlateFile {
    side_m: f64,
    thickness_m: f64,
    mass_kg: f64,
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "servo")]
struct ServoFile {
    law: LawFile,
    max_torque_nm: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_speed_rad_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "law")]
enum LawFile {
    Velocity {
        gain_1_s: f64,
    },
    Torque {
        stiffness_nm_rad: f64,
        damping_nm_s_rad: f64,
    },
}

#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "gait")]
struct GaitFile {
    #[serde(default)]
    offset_rad: f64,
    amplitude_rad: f64,
    frequency_hz: f64,
    #[serde(default)]
    phase_rad: f64,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename = "glue")]
struct GlueFile {
    parent: String,
    face: Face,
    child: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    child_face: Option<Face>,
    #[serde(default, skip_serializing_if = "is_zero")]
    quarter_turns: i64,
}

// serde hands fields over by reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(turns: &i64) -> bool {
    *turns == 0
}

impl MorphologyFile {
    /// Fills in defaults and turns names into indices.
    pub(super) fn into_blueprint(self) -> Checked<Blueprint> {
        let defaults = self.defaults.unwrap_or_default();
        let modules = self
            .modules
            .into_iter()
            .enumerate()
            .map(|(index, module)| module.into_module(&format!("modules[{index}].kind"), &defaults))
            .collect::<Checked<Vec<Module>>>()?;
        // A name given twice is refused later; until then the first bearer has it.
        let mut by_name: HashMap<&str, usize> = HashMap::new();
        for (index, module) in modules.iter().enumerate() {
            by_name.entry(&module.name).or_insert(index);
        }
        let lookup = |name: &str, path: String| {
            by_name
                .get(name)
                .copied()
                .ok_or_else(|| unknown_module(name, path, &modules))
        };
        let mut glue = Vec::with_capacity(self.glue.len());
        for (index, joint) in self.glue.into_iter().enumerate() {
            glue.push(Glue {
                parent: lookup(&joint.parent, format!("glue[{index}].parent"))?,
                face: joint.face,
                child: lookup(&joint.child, format!("glue[{index}].child"))?,
                child_face: joint.child_face.unwrap_or(joint.face.opposite()),
                quarter_turns: u8::try_from(joint.quarter_turns)
                    .map_err(|_| quarter_turns_flaw(index, joint.quarter_turns))?,
            });
        }
        let track = match self.track {
            Some(name) => Some(lookup(&name, "track".to_owned())?),
            None => None,
        };
        Ok(Blueprint {
            name: self.name,
            description: self.description,
            modules,
            glue,
            track,
        })
    }

    /// Everything written out, without defaults.
    pub(super) fn from_morphology(morphology: &Morphology) -> Self {
        let name = |index: usize| morphology.modules()[index].name.clone();
        Self {
            name: morphology.name().to_owned(),
            description: morphology.description().to_owned(),
            defaults: None,
            modules: morphology
                .modules()
                .iter()
                .map(ModuleFile::from_module)
                .collect(),
            glue: morphology
                .glue()
                .iter()
                .map(|joint| GlueFile {
                    parent: name(joint.parent),
                    face: joint.face,
                    child: name(joint.child),
                    child_face: (joint.child_face != joint.face.opposite())
                        .then_some(joint.child_face),
                    quarter_turns: joint.quarter_turns.into(),
                })
                .collect(),
            track: Some(name(morphology.track())),
        }
    }
}

fn unknown_module(name: &str, path: String, modules: &[Module]) -> Flaw {
    let names = modules.iter().map(|module| module.name.as_str());
    Flaw::new(path, unknown_name("module", name, names))
}

fn required<T>(value: Option<T>, default: Option<T>, field: &str, at: &str) -> Checked<T> {
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
    fn into_module(self, at: &str, defaults: &DefaultsFile) -> Checked<Module> {
        let (side_m, mass_kg, inertia_kg_m2, centre_of_mass_m, drive) = match self.kind {
            KindFile::Passive {
                side_m,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
            } => (side_m, mass_kg, inertia_kg_m2, centre_of_mass_m, None),
            KindFile::Active {
                side_m,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
                face,
                axis,
                servo,
                gait,
            } => {
                let drive = Drive {
                    face,
                    axis: axis.into(),
                    servo: required(servo, defaults.servo, "servo", at)?.into(),
                    gait: gait.unwrap_or(GaitFile::HOLD).into(),
                };
                (
                    side_m,
                    mass_kg,
                    inertia_kg_m2,
                    centre_of_mass_m,
                    Some(drive),
                )
            }
        };
        Ok(Module {
            name: self.name,
            side_m: required(side_m, defaults.side_m, "side_m", at)?,
            mass_kg: required(mass_kg, defaults.mass_kg, "mass_kg", at)?,
            inertia_kg_m2: inertia_kg_m2.map(|(x, y, z)| [x, y, z]),
            centre_of_mass_m: centre_of_mass_m
                .map_or(Vector3::zeros(), |(x, y, z)| Vector3::new(x, y, z)),
            drive,
        })
    }

    fn from_module(module: &Module) -> Self {
        let side_m = Some(module.side_m);
        let mass_kg = Some(module.mass_kg);
        let inertia_kg_m2 = module.inertia_kg_m2.map(|[x, y, z]| (x, y, z));
        let centre = module.centre_of_mass_m;
        let centre_of_mass_m =
            (centre != Vector3::zeros()).then_some((centre.x, centre.y, centre.z));
        let kind = match &module.drive {
            None => KindFile::Passive {
                side_m,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
            },
            Some(drive) => KindFile::Active {
                side_m,
                mass_kg,
                inertia_kg_m2,
                centre_of_mass_m,
                face: drive.face,
                axis: drive.axis.into(),
                servo: Some(drive.servo.into()),
                gait: Some(drive.gait.into()),
            },
        };
        Self {
            name: module.name.clone(),
            kind,
        }
    }
}

impl From<AxisFile> for DriveAxis {
    fn from(file: AxisFile) -> Self {
        match file {
            AxisFile::Normal { plate } => Self::Normal {
                plate: plate.map(|plate| Plate {
                    side_m: plate.side_m,
                    thickness_m: plate.thickness_m,
                    mass_kg: plate.mass_kg,
                }),
            },
            AxisFile::Tangent { axis } => Self::Tangent { axis },
        }
    }
}

impl From<DriveAxis> for AxisFile {
    fn from(axis: DriveAxis) -> Self {
        match axis {
            DriveAxis::Normal { plate } => Self::Normal {
                plate: plate.map(|plate| PlateFile {
                    side_m: plate.side_m,
                    thickness_m: plate.thickness_m,
                    mass_kg: plate.mass_kg,
                }),
            },
            DriveAxis::Tangent { axis } => Self::Tangent { axis },
        }
    }
}

impl From<ServoFile> for Servo {
    fn from(file: ServoFile) -> Self {
        Self {
            law: match file.law {
                LawFile::Velocity { gain_1_s } => ServoLaw::Velocity { gain_1_s },
                LawFile::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                } => ServoLaw::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                },
            },
            max_torque_nm: file.max_torque_nm,
            max_speed_rad_s: file.max_speed_rad_s.unwrap_or(f64::INFINITY),
        }
    }
}

impl From<Servo> for ServoFile {
    fn from(servo: Servo) -> Self {
        Self {
            law: match servo.law {
                ServoLaw::Velocity { gain_1_s } => LawFile::Velocity { gain_1_s },
                ServoLaw::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                } => LawFile::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                },
            },
            max_torque_nm: servo.max_torque_nm,
            max_speed_rad_s: servo
                .max_speed_rad_s
                .is_finite()
                .then_some(servo.max_speed_rad_s),
        }
    }
}

impl GaitFile {
    /// The gait of a servo that is given none: hold 0 rad.
    const HOLD: Self = Self {
        offset_rad: 0.0,
        amplitude_rad: 0.0,
        frequency_hz: 0.0,
        phase_rad: 0.0,
    };
}

impl From<GaitFile> for Gait {
    fn from(file: GaitFile) -> Self {
        Self {
            offset_rad: file.offset_rad,
            amplitude_rad: file.amplitude_rad,
            frequency_hz: file.frequency_hz,
            phase_rad: file.phase_rad,
        }
    }
}

impl From<Gait> for GaitFile {
    fn from(gait: Gait) -> Self {
        Self {
            offset_rad: gait.offset_rad,
            amplitude_rad: gait.amplitude_rad,
            frequency_hz: gait.frequency_hz,
            phase_rad: gait.phase_rad,
        }
    }
}
