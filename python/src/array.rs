//! Arrays are passed between Rust and Python as bytes, eight per number, little-endian: Python makes arrays of them without a copy,
//! and this crate needs no further crate for arrays.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use realgap::{Error, Result};

/// Largest | |q| − 1 | that is kept bit for bit, and largest that is accepted; both as for files.
const UNIT_EXACT: f64 = 1e-9;
const UNIT_ACCEPTED: f64 = 1e-2;

/// The bytes of numbers.
pub fn bytes(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// The numbers of bytes.
pub fn numbers(bytes: &[u8]) -> Vec<f64> {
    let (eights, _) = bytes.as_chunks::<8>();
    eights
        .iter()
        .map(|eight| f64::from_le_bytes(*eight))
        .collect()
}

/// The bytes of vectors, a row each.
pub fn vector_bytes<'a>(vectors: impl IntoIterator<Item = &'a Vector3<f64>>) -> Vec<u8> {
    bytes(vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]))
}

/// The vectors of bytes.
pub fn vectors(bytes: &[u8]) -> Vec<Vector3<f64>> {
    let numbers = numbers(bytes);
    let (rows, _) = numbers.as_chunks::<3>();
    rows.iter().map(|row| Vector3::from(*row)).collect()
}

/// The bytes of orientations, a row w, x, y, z each.
pub fn quaternion_bytes<'a>(all: impl IntoIterator<Item = &'a UnitQuaternion<f64>>) -> Vec<u8> {
    bytes(all.into_iter().flat_map(|q| [q.w, q.i, q.j, q.k]))
}

/// The orientations of bytes, a row w, x, y, z each.
///
/// # Errors
/// Rows whose length differs from 1 by more than files may have.
pub fn quaternions(bytes: &[u8]) -> Result<Vec<UnitQuaternion<f64>>> {
    let numbers = numbers(bytes);
    let (rows, _) = numbers.as_chunks::<4>();
    let unit = |(index, [w, x, y, z]): (usize, &[f64; 4])| {
        let q = Quaternion::new(*w, *x, *y, *z);
        let deviation = (q.norm() - 1.0).abs();
        if deviation <= UNIT_EXACT {
            return Ok(UnitQuaternion::new_unchecked(q));
        }
        // NaN is not accepted either.
        if deviation <= UNIT_ACCEPTED {
            return Ok(UnitQuaternion::new_unchecked(q / q.norm()));
        }
        Err(Error::invalid("the quaternion is not of length 1")
            .field(format!("orientations[{index}]"))
            .found(format!("length {}", q.norm()))
            .allowed(format!("1 within {UNIT_ACCEPTED}, real part first")))
    };
    rows.iter().enumerate().map(unit).collect()
}
