//! Defect of Parry: the moments of inertia of light bodies differ from the given ones.

use rapier3d_f64::prelude::*;

pub fn main() {
    for scale in [1.0, 1e-3, 1e-5, 1e-6] {
        // Moments of 3, 2 and 1 times the scale; the axes of the first two are turned by 30 degrees about z.
        let (s, c) = (0.5_f64, 0.75_f64.sqrt());
        let (xx, yy, xy) = (3.0 * c * c + 2.0 * s * s, 3.0 * s * s + 2.0 * c * c, s * c);
        let columns = [xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 1.0].map(|m| m * scale);
        let given = Matrix::from_cols_array(&columns);
        let made = MassProperties::with_inertia_matrix(Vector::ZERO, 1.0, given);
        let back = made.reconstruct_inertia_matrix();
        println!(
            "{scale:e} kg m2 times xx {:.3} (given {xx:.3}), yy {:.3} (given {yy:.3}), xy {:.3} (given {xy:.3})",
            back.x_axis.x / scale,
            back.y_axis.y / scale,
            back.y_axis.x / scale
        );
    }
}
