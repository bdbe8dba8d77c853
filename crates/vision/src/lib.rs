//! Compares simulated pictures with real ones by the features that are extracted from both (paper 002), and simulates cameras.
//!
//! There are four feature extractors, each of which shows its steps as pictures: [`Edges`] (Canny), [`Template`] (normalised
//! correlation in the Fourier domain over a pyramid of sizes), [`Contour`] (a greedy snake) and [`Script`] (text by a learned
//! alphabet). [`EXTRACTORS`] lists them; a new extractor is one file and one line in this list. An extractor may call another
//! [`Program`]: with the feature `tesseract` there is a fifth extractor, which is used only if the user names it.
//!
//! ```
//! use std::sync::Arc;
//!
//! use realgap_vision::{Alphabet, Extractor, Sought, extractor_by_name, print_text};
//!
//! let letters = "ABCDEFGHIJKLM\nNOPQRSTUVWXYZ\n0123456789";
//! let sought = Sought {
//!     alphabet: Some(Arc::new(Alphabet::learn(&print_text(letters, 48.0, 0.1)?, letters)?)),
//!     text: Some("GATE 7".to_owned()),
//!     ..Sought::default()
//! };
//! let reader = extractor_by_name("text")?;
//! let found = reader.extract(&print_text("GATE 7", 31.0, 0.1)?, &sought)?;
//! assert_eq!(found.feature.text.as_deref(), Some("GATE 7"));
//! assert_eq!(reader.error(&found.feature, &sought), Some(0.0));
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod album;
mod alignment;
mod alphabet;
pub mod camera;
mod codec;
mod comparison;
mod contour;
mod edge;
mod extractor;
mod filter;
mod glyph;
mod jpeg_code;
mod jpeg_scan;
mod lettering;
mod matching;
mod option;
mod picture;
mod program;
mod registry;
mod script;
mod sheet;
mod snake;
mod template;
#[cfg(feature = "tesseract")]
mod tesseract;
pub mod tuning;
mod views;

pub use album::Shots;
pub use alignment::RelativeTo;
pub use alphabet::Alphabet;
#[cfg(feature = "schema")]
pub use camera::{CameraFile, SceneFile};
pub use comparison::{
    Answer, ExtractorReport, Mean, PairedComparison, ViewRow, VisionReport, compare_folders,
};
pub use contour::Contour;
pub use edge::{Edges, correlation};
pub use extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
pub use filter::{gauss, otsu, sobel, steepness};
pub use lettering::print_text;
pub use matching::{correlate, correlation_map};
pub use option::VisionOptions;
pub use picture::{Grey, MOST_PIXELS, Picture, Region};
pub use program::Program;
pub use registry::{EXTRACTORS, extractor_by_name, own_extractors};
pub use script::{Script, character_error_rate, edit_distance};
pub use sheet::{contact_sheet, stacked};
pub use snake::{Ending, Settled, Snake, evenly, mean_distance_px};
pub use template::{Match, Template};
#[cfg(feature = "tesseract")]
pub use tesseract::Tesseract;
pub use views::{AlphabetFile, PictureSource, VIEWS_FILE, ViewFile, Views, ViewsFile};
