//! The extractor `tesseract`: text recognised by the installed program Tesseract, for comparison with [`Script`](super::Script).

use super::extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
use super::picture::Grey;
use super::program::Program;
use super::script::{DISTANCE, ERROR_RATE, distance, error_rate, text_part};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

/// The call of Tesseract, with page segmentation mode 6: a single block of text.
static PROGRAM: Program = Program::new(
    "tesseract",
    &["stdin", "stdout", "--psm", "6"],
    "install it (apt install tesseract-ocr, brew install tesseract), or leave out the extractor `tesseract`",
);

/// Recognition of text by the program Tesseract, which must be installed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tesseract;

impl Extractor for Tesseract {
    constant_methods! {
        name: &'static str = "tesseract";
        doc: &'static str = "text, by the installed program Tesseract";
        figure: u8 = 11;
        program: Option<&'static Program> = Some(&PROGRAM);
        error_measure: Option<Measure> = Some(ERROR_RATE);
        distance_measure: Measure = DISTANCE;
    }

    fn is_sought(&self, sought: &Sought) -> bool {
        sought.text.is_some()
    }

    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction> {
        if sought.text.is_none() {
            return Err(Error::invalid("there is no text to be read").field("text"));
        }
        let part = text_part(picture, sought)?;
        let version = PROGRAM.version()?;
        let text = PROGRAM.read(&part.picture().to_png()?)?;
        let lines = text.lines().filter(|line| !line.trim().is_empty()).count();
        Ok(Extraction {
            remarks: vec![format!("{lines} rows by {version} ({})", PROGRAM.call())],
            feature: Feature {
                text: Some(text.trim_end().to_owned()),
                ..Feature::default()
            },
            // Tesseract does not show its intermediate steps.
            steps: vec![Step {
                name: "picture",
                picture: part,
            }],
            warnings: Vec::new(),
        })
    }

    fn error(&self, found: &Feature, sought: &Sought) -> Option<f64> {
        error_rate(found, sought)
    }

    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64> {
        distance(a, b)
    }
}
