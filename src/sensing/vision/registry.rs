//! The extractors by name.

use super::contour::Contour;
use super::edge::Edges;
use super::extractor::Extractor;
use super::script::Script;
use super::template::Template;
use crate::error::Result;
use crate::file::look_up;

/// Every extractor, in the order of the paper.
pub const EXTRACTORS: &[&dyn Extractor] = &[
    &Edges::PAPER,
    &Template::PAPER,
    &Contour::PAPER,
    &Script::PAPER,
];

/// The extractor of this name.
///
/// ```
/// use realgap::sensing::vision::{Extractor, extractor_by_name};
///
/// assert_eq!(extractor_by_name("template")?.figure(), 6);
/// assert!(extractor_by_name("edge").is_err());
/// # Ok::<(), realgap::Error>(())
/// ```
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn extractor_by_name(name: &str) -> Result<&'static dyn Extractor> {
    look_up("extractor", name, EXTRACTORS.iter().copied(), |extractor| {
        extractor.name()
    })
    .map_err(|error| error.field("extractor"))
}
