//! The inertia that joints move at the start: MuJoCo turns ratios of damping and time constants into dampings and stiffnesses with
//! it.

use nalgebra::{DMatrix, Isometry3, Point3, Vector3};

use super::mass::Mass;
use super::model::{JointType, Model};

/// One degree of freedom: the velocity that it gives to points of the bodies beyond it.
struct Freedom {
    body: usize,
    joint: usize,
    turns: bool,
    axis_world: Vector3<f64>,
    anchor_world_m: Vector3<f64>,
}

/// The inverse of the inertia matrix of a model at the start, with the armatures of its joints.
pub(super) struct Inertia {
    freedoms: Vec<Freedom>,
    inverse: Option<DMatrix<f64>>,
}

impl Inertia {
    /// Computes the matrix from the masses of the bodies; `armatures` are those of the joints, by body and joint.
    pub fn of(model: &Model, masses: &[Mass], armatures: &[Vec<f64>]) -> Self {
        let mut poses: Vec<Isometry3<f64>> = Vec::with_capacity(model.bodies.len());
        let mut freedoms: Vec<Freedom> = Vec::new();
        let mut own: Vec<Vec<usize>> = Vec::new();
        for (id, body) in model.bodies.iter().enumerate() {
            let above = poses.get(body.parent).copied().unwrap_or_default();
            let pose = if id == 0 {
                Isometry3::identity()
            } else {
                above * body.pose
            };
            let mut moved = if id == 0 {
                Vec::new()
            } else {
                own[body.parent].clone()
            };
            for (index, joint) in body.joints.iter().enumerate() {
                let anchor_world_m = (pose * Point3::from(joint.pos_m)).coords;
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                let turned = axes.map(|axis| pose.rotation * axis);
                let origin_m = pose.translation.vector;
                let all: Vec<(bool, Vector3<f64>, Vector3<f64>)> = match joint.kind {
                    JointType::Hinge => vec![(true, pose.rotation * joint.axis, anchor_world_m)],
                    JointType::Slide => vec![(false, pose.rotation * joint.axis, anchor_world_m)],
                    JointType::Ball => turned.map(|axis| (true, axis, anchor_world_m)).to_vec(),
                    JointType::Free => (axes.map(|axis| (false, axis, origin_m)).into_iter())
                        .chain(turned.map(|axis| (true, axis, origin_m)))
                        .collect(),
                };
                for (turns, axis_world, anchor_world_m) in all {
                    moved.push(freedoms.len());
                    freedoms.push(Freedom {
                        body: id,
                        joint: index,
                        turns,
                        axis_world,
                        anchor_world_m,
                    });
                }
            }
            poses.push(pose);
            own.push(moved);
        }
        let mut matrix: DMatrix<f64> = DMatrix::zeros(freedoms.len(), freedoms.len());
        for ((pose, moved), mass) in poses.iter().zip(&own).zip(masses) {
            let centre = (pose * Point3::from(mass.centre_m)).coords;
            let turn = pose.rotation.to_rotation_matrix();
            let inertia = turn * mass.inertia_kg_m2 * turn.transpose();
            let speeds: Vec<(Vector3<f64>, Vector3<f64>)> = (moved.iter())
                .map(|&freedom| {
                    let Freedom {
                        turns,
                        axis_world,
                        anchor_world_m,
                        ..
                    } = &freedoms[freedom];
                    match turns {
                        true => (axis_world.cross(&(centre - anchor_world_m)), *axis_world),
                        false => (*axis_world, Vector3::zeros()),
                    }
                })
                .collect();
            for (a, (linear, angular)) in moved.iter().zip(&speeds) {
                for (b, (other_linear, other_angular)) in moved.iter().zip(&speeds) {
                    matrix[(*a, *b)] += mass.mass_kg * linear.dot(other_linear)
                        + angular.dot(&(inertia * other_angular));
                }
            }
        }
        for (index, freedom) in freedoms.iter().enumerate() {
            matrix[(index, index)] += armatures[freedom.body][freedom.joint];
        }
        let inverse = matrix.cholesky().map(|factor| factor.inverse());
        Self { freedoms, inverse }
    }

    fn of_joint(&self, body: usize, joint: usize) -> impl Iterator<Item = usize> {
        let all = self.freedoms.iter().enumerate();
        all.filter(move |(_, freedom)| freedom.body == body && freedom.joint == joint)
            .map(|(index, _)| index)
    }

    /// The inertia of a joint while all others are free, averaged over its degrees of freedom.
    pub fn free(&self, body: usize, joint: usize) -> Option<f64> {
        let inverse = self.inverse.as_ref()?;
        let all: Vec<f64> = (self.of_joint(body, joint))
            .map(|index| inverse[(index, index)])
            .collect();
        Some(all.len() as f64 / all.iter().sum::<f64>())
    }
}
