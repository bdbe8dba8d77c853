//! Bodies beside the robot: fixed, free, or driven along a recorded track.

use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};

/// A box of such a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneBox {
    /// Edge lengths along its own axes, metres.
    pub sides_m: Vector3<f64>,
    /// Its own axes in the body's frame, from its centre.
    pub body_from_box: Isometry3<f64>,
}

/// A body that is not part of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBody {
    /// Name: a driven body is recorded in columns that begin with it.
    pub name: String,
    /// Its boxes, in its own frame, at least one.
    pub boxes: Vec<SceneBox>,
    /// Coulomb friction coefficient of the pair robot and body, dimensionless.
    pub friction: f64,
    /// How the body moves.
    pub motion: SceneMotion,
}

/// How a body of the scene moves.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneMotion {
    /// Not at all.
    Fixed {
        /// Where it is.
        world_from_body: Isometry3<f64>,
    },
    /// It moves as forces make it, from rest.
    Free {
        /// Where it starts.
        world_from_body: Isometry3<f64>,
        /// Mass, kg; the density is the same everywhere.
        mass_kg: f64,
    },
    /// Along a recorded track, whatever is in the way; in recorded lengths, from its first sample on.
    Driven {
        /// Poses over time; before it is known, the body stands at the origin.
        track: Option<Arc<Trajectory>>,
    },
}

impl SceneBody {
    /// Checks what no field can check for itself.
    ///
    /// # Errors
    /// No boxes, sizes or friction that cannot be, a driven body without orientations.
    pub fn check(&self) -> Result<()> {
        let refuse = |what: &str, found: String, allowed: &str| {
            Err(Error::invalid(what)
                .field(format!("scene.{}", self.name))
                .found(found)
                .allowed(allowed))
        };
        let is_size = |side: &f64| (1e-4..=100.0).contains(side);
        let boxes = &self.boxes;
        if boxes.is_empty() || !boxes.iter().all(|b| b.sides_m.iter().all(is_size)) {
            return refuse(
                "a body of the scene needs boxes",
                format!("{} boxes", boxes.len()),
                "at least one, with sides of 0.0001 to 100 m",
            );
        }
        if !boxes.iter().all(|b| {
            b.body_from_box
                .translation
                .vector
                .iter()
                .all(|v| v.is_finite())
        }) {
            return refuse(
                "a box of the scene is nowhere",
                "a number that is not finite".to_owned(),
                "finite metres",
            );
        }
        if !(0.0..=10.0).contains(&self.friction) {
            return refuse("out of range", self.friction.to_string(), "0 to 10");
        }
        match &self.motion {
            SceneMotion::Free { mass_kg, .. } if !(1e-6..=1000.0).contains(mass_kg) => {
                refuse("out of range", format!("{mass_kg} kg"), "1e-6 to 1000 kg")
            }
            SceneMotion::Driven { track: Some(track) }
                if track.orientations_world_from_body().is_none() =>
            {
                refuse(
                    "a body cannot be driven along a track without orientations",
                    "positions only".to_owned(),
                    "columns NAME_qw, NAME_qx, NAME_qy, NAME_qz beside NAME_x_m, NAME_y_m, NAME_z_m",
                )
            }
            _ => Ok(()),
        }
    }
}

/// Where a driven body is, while time goes on.
pub(super) struct Guide<'a> {
    track: Option<Interpolator<'a>>,
    length_scale: f64,
}

impl<'a> Guide<'a> {
    /// `length_scale`: recorded lengths over true ones.
    pub fn new(track: Option<&'a Trajectory>, length_scale: f64) -> Self {
        Self {
            track: track.map(Interpolator::new),
            length_scale,
        }
    }

    /// Pose at a time since the first sample, true lengths.
    pub fn pose(&mut self, since_start_s: f64) -> Isometry3<f64> {
        let Some(track) = &mut self.track else {
            return Isometry3::identity();
        };
        let at_m: Vector3<f64> = track.position_world_m(since_start_s) / self.length_scale;
        let turn = track
            .orientation_world_from_body(since_start_s)
            .unwrap_or_else(UnitQuaternion::identity);
        Isometry3::from_parts(at_m.into(), turn)
    }
}
