//! Import of MJCF, the format of MuJoCo: a compiler of its own that computes what MuJoCo's compiler computes.
//!
//! Elements become owned values ([`element`]), `<include>`, `<attach>` and `<replicate>` become their contents ([`copies`]), and
//! default classes become attributes ([`defaults`]); then bodies ([`model`]), masses ([`mass`]), and actuators ([`actuator`]) are
//! read. The contract with MuJoCo is stated in docs/validation/compiled.md.

mod actuator;
mod copies;
mod defaults;
mod element;
mod mass;
mod matrix;
mod mesh;
mod model;
mod principal;
mod remark;
mod robot;
mod settings;

use super::Options;
use super::note::Notes;
use crate::morphology::body::Structure;
use realgap_core::error::Result;
use realgap_core::file::Source;

/// Reads the model of a file, whose text may be repaired, and of the files that it includes.
pub(super) fn read(
    source: &Source,
    text: &str,
    options: &Options,
    notes: &mut Notes,
) -> Result<Structure> {
    robot::read(source, text, options, notes)
}
