//! What a sweep or a tuning leaves in a folder.

pub(crate) mod best;
pub(in crate::results) mod cell;
pub(in crate::results) mod convergence;
mod corner;
pub(crate) mod joint;
pub(in crate::results) mod picture;
pub(in crate::results) mod plane;
