//! The RON form of a modular robot. Only this file depends on the form; all other code uses the validated types.

use nalgebra::Unit;
use serde::{Deserialize, Serialize};

use super::assembly::{Actuator, Bearing, Gait, Servo};
use super::attachment::Attachment;
use super::command_scale::CommandScale;
use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::module::Module;
use super::module_file::{DefaultsFile, ModuleFile, Triple, required, triple, vector};
use super::pivot::Pivot;
use super::tree::quarter_turns_flaw;
use super::{Blueprint, Morphology, names};
use realgap_core::file::unknown_name;

/// A robot as its file states it.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "morphology")]
pub struct MorphologyFile {
    /// Name of the robot: letters, digits, `_` and `-`.
    name: String,
    /// Free text that describes the robot.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    description: String,
    /// Default values for modules that do not state them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    defaults: Option<DefaultsFile>,
    /// The modules.
    modules: Vec<ModuleFile>,
    /// The attachments: rigid connections between faces of modules.
    #[serde(rename = "glue", alias = "attachments", default)]
    attachments: Vec<AttachmentFile>,
    /// Hinges between modules, stated by anchor and axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    hinges: Vec<PivotFile>,
    /// Pairs of modules between which no contacts are computed.
    #[serde(
        rename = "never_touch",
        alias = "collision_exclude",
        default,
        skip_serializing_if = "Vec::is_empty"
    )]
    collision_exclude: Vec<(String, String)>,
    /// Position at which the first module is fixed in the world, metres; without it the robot moves freely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mount_m: Option<Triple>,
    /// The module whose motion is recorded; the first by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    track: Option<String>,
}

#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "hinge")]
struct PivotFile {
    /// Unique name; joint columns of recordings have it.
    name: String,
    /// The parent module, nearer to the root.
    parent: String,
    /// The child module, which turns right-handed by the angle about the axis.
    child: String,
    /// A point on the axis, in the parent's frame, metres.
    anchor_m: Triple,
    /// The same point in the child's frame, metres.
    #[serde(default)]
    child_anchor_m: Triple,
    /// Direction of the axis in the parent's frame.
    axis: Triple,
    /// Torque against the motion per speed, N m s/rad.
    #[serde(default)]
    viscous_nm_s_rad: f64,
    /// Largest torque of dry friction, N m.
    #[serde(default)]
    dry_nm: f64,
    /// Smallest and largest angle, radians; without this field the hinge has no limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    limits_rad: Option<(f64, f64)>,
    /// Control law and limits; without servo and gait the hinge is passive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    servo: Option<Servo>,
    /// The command that the servo follows; without a gait the servo holds 0 rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gait: Option<Gait>,
}

#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "glue")]
struct AttachmentFile {
    /// The parent module, nearer to the root.
    parent: String,
    /// The parent's face.
    face: Face,
    /// The child module, which is attached to that face.
    child: String,
    /// The child's face; by default the opposite of the parent's face, so that both frames are parallel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    child_face: Option<Face>,
    /// Turns of the child by 90 degrees about the outward normal of the parent's face, right-handed, 0 to 3.
    #[serde(default, skip_serializing_if = "is_zero")]
    quarter_turns: i64,
}

// serde passes fields by reference.
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
        // Names are checked before the attachments: a name that an attachment refers to may be missing because a copied module
        // repeats another name.
        let by_name = names(&modules)?;
        let lookup = |name: &str, path: String| {
            by_name
                .get(name)
                .copied()
                .ok_or_else(|| unknown_module(name, path, &modules))
        };
        let mut attachments = Vec::with_capacity(self.attachments.len());
        for (index, joint) in self.attachments.into_iter().enumerate() {
            attachments.push(Attachment {
                parent: lookup(&joint.parent, format!("glue[{index}].parent"))?,
                face: joint.face,
                child: lookup(&joint.child, format!("glue[{index}].child"))?,
                child_face: joint.child_face.unwrap_or(joint.face.opposite()),
                quarter_turns: u8::try_from(joint.quarter_turns)
                    .map_err(|_| quarter_turns_flaw(index, joint.quarter_turns))?,
            });
        }
        let mut pivots = Vec::with_capacity(self.hinges.len());
        for (index, hinge) in self.hinges.into_iter().enumerate() {
            let at = format!("hinges[{index}]");
            pivots.push(Pivot {
                parent: lookup(&hinge.parent, format!("{at}.parent"))?,
                child: lookup(&hinge.child, format!("{at}.child"))?,
                anchor_parent_m: vector(hinge.anchor_m),
                anchor_child_m: vector(hinge.child_anchor_m),
                axis_parent: Unit::new_normalize(vector(hinge.axis)),
                bearing: Bearing {
                    viscous_nm_s_rad: hinge.viscous_nm_s_rad,
                    dry_nm: hinge.dry_nm,
                    limits_rad: hinge.limits_rad,
                    ..Bearing::default()
                },
                actuator: match (hinge.servo, hinge.gait) {
                    (None, None) => None,
                    (servo, gait) => Some(Actuator {
                        servo: required(servo, None, "servo", &at)?,
                        gait: gait.unwrap_or(Gait::hold(0.0)),
                        command: CommandScale::default(),
                    }),
                },
                name: hinge.name,
            });
        }
        let mut collision_exclude = Vec::with_capacity(self.collision_exclude.len());
        for (index, (a, b)) in self.collision_exclude.iter().enumerate() {
            let path = || format!("never_touch[{index}]");
            collision_exclude.push((lookup(a, path())?, lookup(b, path())?));
        }
        let track = match self.track {
            Some(name) => Some(lookup(&name, "track".to_owned())?),
            None => None,
        };
        Ok(Blueprint {
            name: self.name,
            description: self.description,
            modules,
            attachments,
            pivots,
            collision_exclude,
            mount_world_m: self.mount_m.map(vector),
            track,
        })
    }

    /// The file form of a morphology, with all values written out and no `defaults`.
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
            attachments: morphology
                .attachments()
                .iter()
                .map(|joint| AttachmentFile {
                    parent: name(joint.parent),
                    face: joint.face,
                    child: name(joint.child),
                    child_face: (joint.child_face != joint.face.opposite())
                        .then_some(joint.child_face),
                    quarter_turns: joint.quarter_turns.into(),
                })
                .collect(),
            hinges: morphology
                .pivots()
                .iter()
                .map(|pivot| PivotFile::from_pivot(pivot, name))
                .collect(),
            collision_exclude: morphology
                .collision_exclude()
                .iter()
                .map(|&(a, b)| (name(a), name(b)))
                .collect(),
            mount_m: morphology.mount_world_m().as_ref().map(triple),
            track: Some(name(morphology.track())),
        }
    }
}

fn unknown_module(name: &str, path: String, modules: &[Module]) -> Flaw {
    let names = modules.iter().map(|module| module.name.as_str());
    Flaw::new(path, unknown_name("module", name, names))
}

impl PivotFile {
    fn from_pivot(pivot: &Pivot, name: impl Fn(usize) -> String) -> Self {
        Self {
            name: pivot.name.clone(),
            parent: name(pivot.parent),
            child: name(pivot.child),
            anchor_m: triple(&pivot.anchor_parent_m),
            child_anchor_m: triple(&pivot.anchor_child_m),
            axis: triple(&pivot.axis_parent),
            viscous_nm_s_rad: pivot.bearing.viscous_nm_s_rad,
            dry_nm: pivot.bearing.dry_nm,
            limits_rad: pivot.bearing.limits_rad,
            servo: pivot.actuator.map(|actuator| actuator.servo),
            gait: pivot.actuator.map(|actuator| actuator.gait),
        }
    }
}
