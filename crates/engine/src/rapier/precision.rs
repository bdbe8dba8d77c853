//! The engine in the precision that the crate was compiled with: feature `f64` (default) or `f32`.
//!
//! Numbers change precision at this edge, in [`narrow`] and [`wide`]; everything else of the crate is f64.

#[cfg(all(feature = "f64", feature = "f32"))]
compile_error!(
    "the features `f64` and `f32` exclude each other: for f32 build with `--no-default-features --features f32`"
);
#[cfg(not(any(feature = "f64", feature = "f32")))]
compile_error!(
    "one of the features `f64` (the default) and `f32` is needed, e.g. `--features f64`"
);

#[cfg(all(feature = "f32", not(feature = "f64")))]
pub(crate) use rapier3d::{dynamics, geometry, math, parry, pipeline, prelude};
#[cfg(feature = "f64")]
pub(crate) use rapier3d_f64::{dynamics, geometry, math, parry, pipeline, prelude};

pub(crate) use math::Real;

/// Version and precision of the engine, which decide the results bit for bit.
#[cfg(feature = "f64")]
pub const ENGINE_VERSION: &str = "rapier3d-f64 0.36.1";
/// Version and precision of the engine, which decide the results bit for bit.
#[cfg(not(feature = "f64"))]
pub const ENGINE_VERSION: &str = "rapier3d 0.36.1 f32";

/// A number as the engine takes it.
#[cfg(feature = "f64")]
pub(crate) const fn narrow(value: f64) -> Real {
    value
}

/// A number as the engine takes it.
#[cfg(not(feature = "f64"))]
pub(crate) const fn narrow(value: f64) -> Real {
    value as Real
}

/// A number of the engine as everybody else takes it.
#[cfg(feature = "f64")]
pub(crate) const fn wide(value: Real) -> f64 {
    value
}

/// A number of the engine as everybody else takes it.
#[cfg(not(feature = "f64"))]
pub(crate) const fn wide(value: Real) -> f64 {
    value as f64
}
