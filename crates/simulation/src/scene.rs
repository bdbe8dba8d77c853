//! Bodies of the scene besides the robot: fixed, free, or driven along a recorded track.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};
use realgap_robot::morphology::body::Beside;

/// A box of a body of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneBox {
    /// Edge lengths along its own axes, metres.
    pub sides_m: Vector3<f64>,
    /// Pose of the box in the body's frame; the origin of the box is its centre.
    pub body_from_box: Isometry3<f64>,
}

/// A body that is not part of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBody {
    /// Name; the recorded columns of a driven body begin with it.
    pub name: String,
    /// Its boxes, in its own frame, at least one.
    pub boxes: Vec<SceneBox>,
    /// Coulomb friction coefficient of the pair robot and body, dimensionless.
    pub friction: f64,
    /// How the body moves.
    pub motion: SceneMotion,
}

impl SceneBody {
    /// A body that a robot's file states beside the robot.
    pub(super) fn beside(body: &Beside) -> Self {
        let world_from_body = body.pose.isometry();
        let boxes = body.boxes.iter().map(|part| SceneBox {
            sides_m: Vector3::new(part.sides_m.0, part.sides_m.1, part.sides_m.2),
            body_from_box: part.pose.isometry(),
        });
        Self {
            name: body.name.clone(),
            boxes: boxes.collect(),
            friction: body.friction,
            motion: match body.mass_kg {
                None => SceneMotion::Fixed { world_from_body },
                Some(mass_kg) => SceneMotion::Free {
                    world_from_body,
                    mass_kg,
                },
            },
        }
    }

    /// Centre of mass and inertia about it of boxes of one density.
    pub(super) fn uniform(&self, mass_kg: f64) -> (Vector3<f64>, Matrix3<f64>) {
        let volume = |sides: &Vector3<f64>| sides.product();
        let whole_m3: f64 = self.boxes.iter().map(|b| volume(&b.sides_m)).sum();
        let share = |sides: &Vector3<f64>| mass_kg * volume(sides) / whole_m3;
        let moment: Vector3<f64> = self
            .boxes
            .iter()
            .map(|b| b.body_from_box.translation.vector * share(&b.sides_m))
            .sum();
        let centre_m = moment / mass_kg;
        let inertia_kg_m2: Matrix3<f64> = self
            .boxes
            .iter()
            .map(|b| {
                let mass_kg = share(&b.sides_m);
                let squares = b.sides_m.component_mul(&b.sides_m);
                let own = Matrix3::from_diagonal(
                    &((Vector3::repeat(squares.sum()) - squares) * (mass_kg / 12.0)),
                );
                let turn = b.body_from_box.rotation.to_rotation_matrix();
                let d = b.body_from_box.translation.vector - centre_m;
                turn * own * turn.transpose()
                    + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * mass_kg
            })
            .sum();
        (centre_m, inertia_kg_m2)
    }
}

/// How a body of the scene moves.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneMotion {
    /// The body does not move.
    Fixed {
        /// Pose of the body.
        world_from_body: Isometry3<f64>,
    },
    /// The body moves freely, starting at rest.
    Free {
        /// Pose at the start.
        world_from_body: Isometry3<f64>,
        /// Mass, kg; the density is the same everywhere.
        mass_kg: f64,
    },
    /// The body follows a recorded track, unaffected by contacts; in recorded lengths, from its first sample on.
    Driven {
        /// Poses over time; without a track the body is at the origin.
        track: Option<Arc<Trajectory>>,
    },
}

impl SceneBody {
    /// Checks the values of the body.
    ///
    /// # Errors
    /// A body without boxes, sizes or friction out of range, a driven body whose track has no orientations.
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
                "the position of a box of the scene is not finite",
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

/// The pose of a driven body over time.
pub(super) struct DrivenPath<'a> {
    track: Option<Interpolator<'a>>,
    length_scale: f64,
}

impl<'a> DrivenPath<'a> {
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
