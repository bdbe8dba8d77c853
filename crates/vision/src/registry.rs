//! The list of feature extractors, and looking them up by name.

use super::contour::Contour;
use super::edge::Edges;
use super::extractor::Extractor;
use super::script::Script;
use super::template::Template;
#[cfg(feature = "tesseract")]
use super::tesseract::Tesseract;
use realgap_core::error::Result;
use realgap_core::file::look_up;

/// All extractors: first those of paper 002 in its order, then those that call other programs.
pub const EXTRACTORS: &[&dyn Extractor] = &[
    &Edges::PAPER,
    &Template::PAPER,
    &Contour::PAPER,
    &Script::PAPER,
    #[cfg(feature = "tesseract")]
    &Tesseract,
];

/// The extractors that need no other program; these are used if the user names none.
pub fn own_extractors() -> Vec<&'static dyn Extractor> {
    let own = EXTRACTORS.iter().filter(|e| e.program().is_none());
    own.copied().collect()
}

/// The extractor of this name.
///
/// ```
/// use realgap_vision::{Extractor, extractor_by_name};
///
/// assert_eq!(extractor_by_name("template")?.figure(), 6);
/// assert!(extractor_by_name("edge").is_err());
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// An unknown name; the error lists the known ones.
pub fn extractor_by_name(name: &str) -> Result<&'static dyn Extractor> {
    look_up("extractor", name, EXTRACTORS.iter().copied(), |extractor| {
        extractor.name()
    })
    .map_err(|error| {
        let error = error.field("extractor");
        if cfg!(not(feature = "tesseract")) && name == "tesseract" {
            return error.hint(
                "this program was built without it: `cargo install --path . --features tesseract`",
            );
        }
        error
    })
}
