//! What an extractor is: from a picture to a feature, with its steps, and how far two features are apart.

use std::sync::Arc;

use super::alphabet::Alphabet;
use super::picture::{Grey, Region};
use super::program::Program;
use realgap_core::error::Result;
use realgap_core::warning::Warning;

/// What is looked for in the pictures of one view, and what is known to be there. Everything may be missing.
#[derive(Debug, Clone, Default)]
pub struct Sought {
    /// A picture of the thing to be found.
    pub template: Option<Arc<Grey>>,
    /// Where its centre is, pixels.
    pub template_at_px: Option<[f64; 2]>,
    /// Where a contour begins, pixels, around the thing.
    pub start_px: Vec<[f64; 2]>,
    /// The thing's outline, pixels, closed.
    pub outline_px: Vec<[f64; 2]>,
    /// Where text is; the whole picture where that is not said.
    pub text_region: Option<Region>,
    /// The text, lines ending in `\n`.
    pub text: Option<String>,
    /// The characters that are known.
    pub alphabet: Option<Arc<Alphabet>>,
}

/// What an extractor found: whatever of this it has.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Feature {
    /// A value for every pixel.
    pub map: Option<Grey>,
    /// Places, pixels.
    pub points_px: Vec<[f64; 2]>,
    /// Text.
    pub text: Option<String>,
}

/// One step on the way, as a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Its name, for a caption.
    pub name: &'static str,
    /// What the picture looks like after it.
    pub picture: Grey,
}

/// A feature and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// What was found.
    pub feature: Feature,
    /// The way there, from the picture on.
    pub steps: Vec<Step>,
    /// How sure it is, in words.
    pub remarks: Vec<String>,
    /// What a reader should know.
    pub warnings: Vec<Warning>,
}

/// What the numbers of an extractor are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measure {
    /// In words, for a column.
    pub name: &'static str,
    /// `px`, or empty for a share.
    pub unit: &'static str,
}

/// Finds one kind of feature in a picture.
pub trait Extractor: Sync {
    /// Its name, as on the command line.
    fn name(&self) -> &'static str;

    /// What it finds and how, in one sentence.
    fn doc(&self) -> &'static str;

    /// The figure of paper 002 that shows it for several pictures.
    fn figure(&self) -> u8;

    /// The other program that does the work, where it is not done here. Such an extractor is asked only where it is named: what a
    /// build can do must not change results.
    fn program(&self) -> Option<&'static Program> {
        None
    }

    /// What [`Extractor::error`] measures; `None` where nothing can be known beforehand.
    fn error_measure(&self) -> Option<Measure>;

    /// What [`Extractor::distance`] measures.
    fn distance_measure(&self) -> Measure;

    /// Whether there is something to look for in this view.
    fn is_sought(&self, sought: &Sought) -> bool;

    /// Finds the feature.
    ///
    /// # Errors
    /// Nothing to look for, or something that cannot be in a picture of this size.
    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction>;

    /// How far a feature is from what is known to be there; `None` where nothing is known.
    fn error(&self, found: &Feature, sought: &Sought) -> Option<f64>;

    /// How far two features are apart, 0 for the same; `None` where they cannot be compared.
    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64>;
}
