//! Converts the quaternion of a file into an orientation.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::error::{Error, Result};

/// The orientation from a field `orientation_wxyz`: a quaternion with the real part first, of any length other than zero.
pub fn orientation(wxyz: (f64, f64, f64, f64)) -> Result<UnitQuaternion<f64>> {
    let (w, x, y, z) = wxyz;
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
        // A quaternion whose squares overflow cannot be normalised.
        .filter(|turn| (turn.norm() - 1.0).abs() < 1e-6)
        .ok_or_else(|| {
            Error::invalid("not an orientation")
                .field("orientation_wxyz")
                .found(format!("{wxyz:?}"))
                .allowed("a quaternion, real part first, that is neither zero nor infinite")
        })
}
