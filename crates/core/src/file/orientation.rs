//! Orientations as files write them.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::error::{Error, Result};

/// The orientation of a field `orientation_wxyz`, real part first, of any length.
pub fn orientation(wxyz: (f64, f64, f64, f64)) -> Result<UnitQuaternion<f64>> {
    let (w, x, y, z) = wxyz;
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
        // Parts so large that their squares overflow have no direction.
        .filter(|turn| (turn.norm() - 1.0).abs() < 1e-6)
        .ok_or_else(|| {
            Error::invalid("not an orientation")
                .field("orientation_wxyz")
                .found(format!("{wxyz:?}"))
                .allowed("a quaternion, real part first, that is neither zero nor endless")
        })
}
