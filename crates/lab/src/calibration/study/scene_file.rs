//! The RON form of bodies beside the robot, and their tracks from recordings.

use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Deserialize;

use realgap_core::file::{orientation, unknown_name};
use realgap_core::{Error, Result};
use realgap_path::trajectory::Recording;
use realgap_simulation::{Experiment, SceneBody, SceneBox, SceneMotion};

type Triple = (f64, f64, f64);

/// One body as written.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Body")]
pub(in crate::calibration) struct BodyFile {
    /// Its name, with which its recorded columns begin.
    name: String,
    /// What it consists of.
    boxes: Vec<BoxFile>,
    /// Coefficient of friction of its surface.
    #[serde(default = "default_friction")]
    friction: f64,
    /// How the body moves.
    motion: MotionFile,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "box")]
struct BoxFile {
    /// Edge lengths along the body's axes, metres.
    sides_m: Triple,
    /// Centre in the body's frame, metres.
    #[serde(default)]
    centre_m: Triple,
    /// Rotation vector, radians.
    #[serde(default)]
    turn_rad: Triple,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "motion")]
enum MotionFile {
    /// Follows the recorded columns that begin with the body's name.
    Recorded,
    /// Stands still.
    Fixed {
        /// Place of the body's frame, metres.
        position_m: Triple,
        /// Orientation of the body's frame, a quaternion, real part first.
        #[serde(default = "upright")]
        orientation_wxyz: (f64, f64, f64, f64),
    },
    /// Moves when it is pushed.
    Free {
        /// Place of the body's frame, metres.
        position_m: Triple,
        /// Orientation of the body's frame, a quaternion, real part first.
        #[serde(default = "upright")]
        orientation_wxyz: (f64, f64, f64, f64),
        /// Mass, kg.
        mass_kg: f64,
    },
}

fn default_friction() -> f64 {
    0.5
}

fn upright() -> (f64, f64, f64, f64) {
    (1.0, 0.0, 0.0, 0.0)
}

fn vector((x, y, z): Triple) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

fn pose(at: Triple, wxyz: (f64, f64, f64, f64)) -> Result<Isometry3<f64>> {
    let turn = orientation(wxyz)?;
    let at = vector(at);
    if !at.iter().all(|v| v.is_finite()) {
        return Err(Error::invalid("not a position").field("position_m"));
    }
    Ok(Isometry3::from_parts(at.into(), turn))
}

impl BodyFile {
    pub(in crate::calibration) fn into_body(self) -> Result<SceneBody> {
        let boxes = self.boxes.iter().map(|part| SceneBox {
            sides_m: vector(part.sides_m),
            body_from_box: Isometry3::from_parts(
                vector(part.centre_m).into(),
                UnitQuaternion::from_scaled_axis(vector(part.turn_rad)),
            ),
        });
        let body = SceneBody {
            boxes: boxes.collect(),
            friction: self.friction,
            motion: match self.motion {
                MotionFile::Recorded => SceneMotion::Driven { track: None },
                MotionFile::Fixed {
                    position_m,
                    orientation_wxyz,
                } => SceneMotion::Fixed {
                    world_from_body: pose(position_m, orientation_wxyz)?,
                },
                MotionFile::Free {
                    position_m,
                    orientation_wxyz,
                    mass_kg,
                } => SceneMotion::Free {
                    world_from_body: pose(position_m, orientation_wxyz)?,
                    mass_kg,
                },
            },
            name: self.name,
        };
        body.check()?;
        Ok(body)
    }
}

/// Gives every body that follows recorded columns its track in this recording.
///
/// # Errors
/// A recording without a body of that name, or with one that has no orientations.
pub(in crate::calibration) fn lead(
    experiment: &mut Experiment,
    recording: &Recording,
) -> Result<()> {
    for body in &mut experiment.scene {
        let SceneMotion::Driven { track } = &mut body.motion else {
            continue;
        };
        let known = recording.bodies.iter().find(|(name, _)| *name == body.name);
        let Some((_, motion)) = known else {
            let names = recording.bodies.iter().map(|(name, _)| name.as_str());
            return Err(unknown_name("recorded body", &body.name, names)
                .at_file(&recording.path)
                .or_hint("a driven body needs columns NAME_x_m, NAME_y_m, NAME_z_m, NAME_qw, NAME_qx, NAME_qy, NAME_qz"));
        };
        *track = Some(Arc::new(motion.clone()));
        body.check().map_err(|e| e.at_file(&recording.path))?;
    }
    Ok(())
}
