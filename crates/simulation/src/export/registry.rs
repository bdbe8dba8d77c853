//! The export formats by name.

use super::format::Format;
use super::mjcf::Mjcf;
use super::urdf::Urdf;
use realgap_core::error::Result;
use realgap_core::file::look_up;

/// Every known format.
pub const FORMATS: &[&dyn Format] = &[&Mjcf, &Urdf];

/// The format called `name`.
///
/// # Errors
/// An unknown name.
pub fn format_named(name: &str) -> Result<&'static dyn Format> {
    look_up("export format", name, FORMATS.iter().copied(), |format| {
        format.name()
    })
}
