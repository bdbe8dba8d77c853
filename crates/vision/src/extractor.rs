//! The trait of feature extractors: extracts a feature from a picture, and computes the distance between two features.

use std::sync::Arc;

use super::alphabet::Alphabet;
use super::picture::{Grey, Region};
use super::program::Program;
use realgap_core::error::Result;
use realgap_core::warning::Warning;

/// What extractors search for in the pictures of one view, and the known truth. Every field is optional.
#[derive(Debug, Clone, Default)]
pub struct Sought {
    /// The template: a picture of the object to be found.
    pub template: Option<Arc<Grey>>,
    /// True position of the centre of the template, pixels.
    pub template_at_px: Option<[f64; 2]>,
    /// The contour from which a snake starts, around the object, pixels.
    pub start_px: Vec<[f64; 2]>,
    /// True outline of the object, closed, pixels.
    pub outline_px: Vec<[f64; 2]>,
    /// The part of the picture that contains text; by default the whole picture.
    pub text_region: Option<Region>,
    /// The true text, lines ending in `\n`.
    pub text: Option<String>,
    /// The alphabet by which characters are recognised.
    pub alphabet: Option<Arc<Alphabet>>,
}

/// The feature that an extractor found; an extractor fills only some of the fields.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Feature {
    /// A value for every pixel.
    pub map: Option<Grey>,
    /// Points, pixels.
    pub points_px: Vec<[f64; 2]>,
    /// Text.
    pub text: Option<String>,
}

/// One step of an extraction, as a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Name of the step, for a caption.
    pub name: &'static str,
    /// The picture after this step.
    pub picture: Grey,
}

/// A feature with the steps by which it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// The feature.
    pub feature: Feature,
    /// The steps of the extraction, beginning with the picture.
    pub steps: Vec<Step>,
    /// Remarks on the result, for example its correlation.
    pub remarks: Vec<String>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// The quantity that an extractor reports as an error or a distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measure {
    /// Name of the quantity, for the heading of a column.
    pub name: &'static str,
    /// Unit: `px`, or empty for a share.
    pub unit: &'static str,
}

/// A feature extractor, which finds one kind of feature in a picture.
pub trait Extractor: Sync {
    /// Name of the extractor on the command line.
    fn name(&self) -> &'static str;

    /// One sentence that states what the extractor finds, and by which method.
    fn doc(&self) -> &'static str;

    /// The figure of paper 002 that shows this extractor for several pictures.
    fn figure(&self) -> u8;

    /// The other program that the extractor calls, if it does. Such an extractor is used only if the user names it, so that results do
    /// not depend on the features of a build.
    fn program(&self) -> Option<&'static Program> {
        None
    }

    /// The quantity of [`Extractor::error`]; `None` for features without a known truth.
    fn error_measure(&self) -> Option<Measure>;

    /// The quantity of [`Extractor::distance`].
    fn distance_measure(&self) -> Measure;

    /// Whether the view states what this extractor needs to search for.
    fn is_sought(&self, sought: &Sought) -> bool;

    /// Extracts the feature from a picture.
    ///
    /// # Errors
    /// The view does not state what to search for, or states something that does not fit into a picture of this size.
    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction>;

    /// Distance of a feature from the known truth; `None` if the truth is not known.
    fn error(&self, found: &Feature, sought: &Sought) -> Option<f64>;

    /// Distance between two features, 0 for equal features; `None` if they cannot be compared.
    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64>;
}
