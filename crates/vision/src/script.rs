//! The extractor `text`: straightens text, segments it into glyphs, and recognises each by a learned alphabet. Figures 4, 11 and 12
//! of paper 002.

use super::extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
use super::glyph::{LEAST_SPOT, hough_angle_rad, inked, rows, without_spots};
use super::picture::Grey;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

/// Recognition of text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Script {
    /// Largest rotation of rows in either direction, radians.
    pub most_turn_rad: f64,
    /// Patches of ink below this share of the usual size are noise.
    pub least_spot: f64,
}

/// A smaller rotation than this is not corrected, because rotating a picture blurs it, radians (a tenth of a degree).
const LEAST_TURN_RAD: f64 = 0.0018;

impl Script {
    /// The settings of the registry: up to 15 degrees in either direction.
    pub const PAPER: Self = Self {
        most_turn_rad: 0.2618,
        least_spot: LEAST_SPOT,
    };
}

/// Number of edits (insertion, deletion or replacement of a character) from one text to the other (Levenshtein 1966).
///
/// ```
/// assert_eq!(realgap_vision::edit_distance("kitten", "sitting"), 3);
/// ```
pub fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let above = row[j + 1];
            row[j + 1] = (diagonal + usize::from(x != *y))
                .min(above + 1)
                .min(row[j] + 1);
            diagonal = above;
        }
    }
    row[b.len()]
}

/// The text with one space between words and without empty lines.
fn tidy(text: &str) -> String {
    let lines: Vec<String> = text
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|line| !line.is_empty())
        .collect();
    lines.join("\n")
}

/// Number of edits from the recognised to the true text, divided by the length of the true text; may exceed 1.
pub fn character_error_rate(read: &str, truth: &str) -> f64 {
    let (read, truth) = (tidy(read), tidy(truth));
    edit_distance(&read, &truth) as f64 / truth.chars().count().max(1) as f64
}

/// The quantities of errors and distances, which all extractors of text share.
pub(super) const ERROR_RATE: Measure = Measure {
    name: "character error rate",
    unit: "",
};
pub(super) const DISTANCE: Measure = Measure {
    name: "edits between the texts, per character",
    unit: "",
};

/// The part of a picture that contains text.
pub(super) fn text_part(picture: &Grey, sought: &Sought) -> Result<Grey> {
    match sought.text_region {
        Some(region) => picture.cropped(region),
        None => Ok(picture.clone()),
    }
}

pub(super) fn error_rate(found: &Feature, sought: &Sought) -> Option<f64> {
    Some(character_error_rate(
        found.text.as_ref()?,
        sought.text.as_ref()?,
    ))
}

pub(super) fn distance(a: &Feature, b: &Feature) -> Option<f64> {
    let (a, b) = (tidy(a.text.as_ref()?), tidy(b.text.as_ref()?));
    let longest = a.chars().count().max(b.chars().count());
    Some(edit_distance(&a, &b) as f64 / longest.max(1) as f64)
}

impl Extractor for Script {
    constant_methods! {
        name: &'static str = "text";
        doc: &'static str = "text, glyph by glyph, by a learned alphabet";
        figure: u8 = 11;
        error_measure: Option<Measure> = Some(ERROR_RATE);
        distance_measure: Measure = DISTANCE;
    }

    fn is_sought(&self, sought: &Sought) -> bool {
        sought.alphabet.is_some() && sought.text.is_some()
    }

    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction> {
        let alphabet = sought
            .alphabet
            .as_ref()
            .ok_or_else(|| Error::invalid("there is no alphabet to read with").field("alphabet"))?;
        let part = text_part(picture, sought)?;
        let ink = inked(&part);
        let angle_rad = hough_angle_rad(&ink, self.most_turn_rad);
        let upright = if angle_rad.abs() < LEAST_TURN_RAD {
            ink.clone()
        } else {
            ink.turned(-angle_rad, 0.0)
        };
        let clean = without_spots(&upright, self.least_spot);
        let rows = rows(&clean);
        let text = alphabet.read(&rows);
        let glyphs: usize = rows.iter().map(Vec::len).sum();
        let step = |name, picture| Step { name, picture };
        Ok(Extraction {
            steps: vec![
                step("picture", part),
                step(
                    "inverted, threshold",
                    ink.map(|v| f32::from(u8::from(v > 0.5))),
                ),
                step("turned", upright),
                step("noise filter", clean),
            ],
            remarks: vec![format!(
                "{glyphs} glyphs in {} rows, turned by {:.2} degrees",
                rows.len(),
                angle_rad.to_degrees()
            )],
            feature: Feature {
                text: Some(text),
                ..Feature::default()
            },
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
