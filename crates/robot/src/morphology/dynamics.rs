//! Masses, poses and the mass matrix of the joints at given coordinates: quantities that other programs compute, too, for
//! comparison.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Point3, Vector3};
use serde::Serialize;

use super::assembly::{Assembly, Freedom};

/// Dynamic quantities of a robot with a fixed root, at rest at given joint coordinates; robot frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dynamics {
    /// Coordinates of the joints, radians or metres, in the order of the hinges.
    pub coordinates: Vec<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, metres.
    pub centre_m: [f64; 3],
    /// Poses of the bodies: position (metres), then orientation as a quaternion with its real part first.
    pub bodies: Vec<[f64; 7]>,
    /// The mass matrix of the joints, row by row, kg m² (kg where both slide).
    pub mass_matrix: Vec<Vec<f64>>,
    /// Accelerations of the joints from rest under gravity along −z, rad/s² or m/s².
    pub accelerations: Vec<f64>,
}

/// Mass, its first moment and its inertia about the robot's origin.
#[derive(Clone, Copy)]
struct Composite {
    mass_kg: f64,
    moment_kg_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

/// Motion of the child per unit speed of its joint: angular velocity, and velocity of the point at the robot's origin.
struct Screw {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

/// Gravity, m/s².
const GRAVITY_M_S2: f64 = 9.81;

impl Assembly {
    /// Masses, poses and the mass matrix at these coordinates of the joints (composite rigid bodies: Featherstone 2008, table
    /// 6.2). The inertia of a rotor counts at its own joint only.
    pub fn dynamics(&self, coordinates: &[f64]) -> Dynamics {
        let moved = self.moved(coordinates);
        let mut composites: Vec<Composite> = self
            .parts
            .iter()
            .zip(&moved)
            .map(|(part, moved)| {
                let mass = part.mass(moved);
                let c = mass.centre_m;
                let away = Matrix3::identity() * c.norm_squared() - c * c.transpose();
                Composite {
                    mass_kg: mass.mass_kg,
                    moment_kg_m: c * mass.mass_kg,
                    inertia_kg_m2: mass.inertia_kg_m2 + away * mass.mass_kg,
                }
            })
            .collect();
        // Parents precede their children, so the reverse order visits children first.
        for hinge in self.hinges.iter().rev() {
            let child = composites[hinge.child_part];
            let parent = &mut composites[hinge.parent_part];
            parent.mass_kg += child.mass_kg;
            parent.moment_kg_m += child.moment_kg_m;
            parent.inertia_kg_m2 += child.inertia_kg_m2;
        }
        let screws: Vec<Screw> = self
            .hinges
            .iter()
            .map(|hinge| {
                let at = &moved[hinge.parent_part];
                let axis = at.rotation * hinge.axis_robot.into_inner();
                let anchor_m = (at * Point3::from(hinge.anchor_robot_m)).coords;
                match hinge.freedom {
                    Freedom::Turn => Screw {
                        angular: axis,
                        linear: anchor_m.cross(&axis),
                    },
                    Freedom::Slide => Screw {
                        angular: Vector3::zeros(),
                        linear: axis,
                    },
                }
            })
            .collect();
        let (matrix, weights) = self.mass_matrix(&composites, &screws);
        let accelerations = matrix.clone().cholesky().map_or_else(
            || DVector::from_element(weights.len(), f64::NAN),
            |factors| factors.solve(&weights),
        );
        let whole = composites[0];
        Dynamics {
            coordinates: coordinates.to_vec(),
            mass_kg: whole.mass_kg,
            centre_m: (whole.moment_kg_m / whole.mass_kg).into(),
            bodies: self.body_poses(&moved),
            mass_matrix: matrix
                .row_iter()
                .map(|row| row.iter().copied().collect())
                .collect(),
            accelerations: accelerations.iter().copied().collect(),
        }
    }

    /// The mass matrix, and the generalised force of gravity at every joint.
    fn mass_matrix(
        &self,
        composites: &[Composite],
        screws: &[Screw],
    ) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.hinges.len();
        let mut matrix = DMatrix::zeros(count, count);
        let mut weights = DVector::zeros(count);
        let above = |part: usize| {
            self.hinges
                .iter()
                .position(|hinge| hinge.child_part == part)
        };
        for (index, hinge) in self.hinges.iter().enumerate() {
            let moving = &composites[hinge.child_part];
            let own = &screws[index];
            // Momentum of all parts that the joint moves, at unit speed of the joint.
            let force = own.linear * moving.mass_kg + own.angular.cross(&moving.moment_kg_m);
            let turn = moving.inertia_kg_m2 * own.angular + moving.moment_kg_m.cross(&own.linear);
            let mut next = Some(index);
            while let Some(other) = next {
                let value = screws[other].angular.dot(&turn) + screws[other].linear.dot(&force);
                matrix[(index, other)] = value;
                matrix[(other, index)] = value;
                next = above(self.hinges[other].parent_part);
            }
            let motor = hinge.actuator.as_ref().and_then(|a| a.servo.law.motor());
            matrix[(index, index)] +=
                hinge.bearing.armature_kg_m2 + motor.map_or(0.0, |motor| motor.armature_kg_m2);
            let pull = Vector3::new(0.0, 0.0, -GRAVITY_M_S2);
            weights[index] = own.linear.dot(&pull) * moving.mass_kg
                + own.angular.dot(&moving.moment_kg_m.cross(&pull));
        }
        (matrix, weights)
    }

    /// Poses of the bodies, in the order of their names; of modules those of their first box.
    fn body_poses(&self, moved: &[Isometry3<f64>]) -> Vec<[f64; 7]> {
        let mut poses = vec![[f64::NAN; 7]; self.module_names.len()];
        for (part, moved) in self.parts.iter().zip(moved) {
            for solid in part.solids.iter().rev() {
                let pose = moved * solid.robot_from_solid;
                let (t, q) = (pose.translation.vector, pose.rotation);
                // The first solid of a body is the one that carries its mass, in the body's own frame.
                poses[solid.module] = [t.x, t.y, t.z, q.w, q.i, q.j, q.k];
            }
        }
        poses
    }
}

#[cfg(test)]
mod tests {
    use crate::morphology::Morphology;
    use realgap_core::file::Source;

    #[test]
    fn a_pendulum_of_two_rods_has_the_mass_matrix_of_the_textbook() {
        let text = r#"(name: "double", mount: (), bodies: [
            (name: "stand"),
            (name: "upper", mass_kg: 2, centre_of_mass_m: (0, 0, -0.5), inertia_kg_m2: (xx: 0.2, yy: 0.3, zz: 0.1)),
            (name: "lower", mass_kg: 3, centre_of_mass_m: (0, 0, -0.25), inertia_kg_m2: (xx: 0.2, yy: 0.4, zz: 0.1))],
            joints: [(name: "a", parent: "stand", child: "upper", kind: Turn(axis: (0, 1, 0))),
                (name: "b", parent: "upper", child: "lower", pose: (at_m: (0, 0, -1)), kind: Turn(axis: (0, 1, 0)))])"#;
        let robot = Morphology::parse(&Source::new("double.ron", text)).unwrap();
        let angle = 0.7_f64;
        let found = robot.assemble().dynamics(&[0.3, angle]).mass_matrix;
        let (lower, cross) = (0.4 + 3.0 * 0.0625, 3.0 * 0.25 * angle.cos());
        let upper = 0.3 + 2.0 * 0.25 + 3.0 + lower + 2.0 * cross;
        for (value, expected) in [
            (found[0][0], upper),
            (found[0][1], lower + cross),
            (found[1][0], lower + cross),
            (found[1][1], lower),
        ] {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
    }
}
