//! The extractor `template`: finds a template at any position and size in a picture. Figures 3, 6 and 7 of paper 002.

use super::extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
use super::filter::steepness;
use super::matching::{correlate, correlation_map};
use super::picture::Grey;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

/// Template matching by normalised correlation over a pyramid of sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Template {
    /// Smallest and largest size, as a factor of the template's own.
    pub scale: (f64, f64),
    /// Factor from one size to the next, above 1.
    pub step: f64,
    /// Sizes with a side below this are left out, because they match anywhere, pixels.
    pub least_px: usize,
}

/// The match of a template in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Position of the centre of the template, pixels.
    pub centre_px: [f64; 2],
    /// Size in the picture divided by the template's own size.
    pub scale: f64,
    /// Normalised correlation of the match, at most 1.
    pub r: f64,
}

impl Template {
    /// The settings of the registry.
    pub const PAPER: Self = Self {
        scale: (0.25, 2.0),
        step: 1.15,
        least_px: 12,
    };

    /// The factors of all sizes that fit into the picture, and the template in these sizes.
    fn pyramid(&self, picture: &Grey, template: &Grey) -> (Vec<f64>, Vec<Grey>) {
        let (mut factors, mut sizes) = (Vec::new(), Vec::new());
        let levels = ((self.scale.1 / self.scale.0).ln() / self.step.ln()).floor() as i32;
        // The template's own size is one of them.
        let below = ((1.0 / self.scale.0).ln() / self.step.ln()).floor() as i32;
        for level in -below..=(levels - below) {
            let factor = self.step.powi(level);
            let side = |pixels: usize| (pixels as f64 * factor).round().max(1.0) as usize;
            let (width, height) = (side(template.width()), side(template.height()));
            let is_small = width.min(height) < self.least_px && level != 0;
            if is_small || width > picture.width() || height > picture.height() {
                continue;
            }
            factors.push(factor);
            sizes.push(if level == 0 {
                template.clone()
            } else {
                template.resized(width, height)
            });
        }
        (factors, sizes)
    }

    /// The match with the largest correlation, and a picture of the correlations at that size for all positions of the centre.
    ///
    /// # Errors
    /// A template that is larger than the picture in every size, or that is uniform.
    pub fn find(&self, picture: &Grey, template: &Grey) -> Result<(Match, Grey)> {
        let first = template.values()[0];
        if template.values().iter().all(|v| *v == first) {
            return Err(Error::invalid("the template is the same everywhere")
                .field("template")
                .hint("use a template with structure by which it can be recognised"));
        }
        let (factors, sizes) = self.pyramid(picture, template);
        if sizes.is_empty() {
            return Err(Error::invalid("the template is larger than the picture")
                .field("template")
                .found(format!("{} x {} px", template.width(), template.height()))
                .allowed(format!(
                    "at most {:.0} x {:.0} px, for the smallest size to fit",
                    picture.width() as f64 / self.scale.0,
                    picture.height() as f64 / self.scale.0
                )));
        }
        let mut best = (0, 0, 0, f64::NEG_INFINITY);
        correlate(picture, &sizes, |index, x, y, r| {
            if r > best.3 {
                best = (index, x, y, r);
            }
        })?;
        let (index, x, y, r) = best;
        let size = &sizes[index];
        let (width, height, map) = correlation_map(picture, size)?;
        let at = |x: usize, y: usize| map[y * width + x];
        let dx = peak(x, width, |x| at(x, y));
        let dy = peak(y, height, |y| at(x, y));
        let half = |side: usize| 0.5 * (side - 1) as f64;
        let (left, top) = ((size.width() - 1) / 2, (size.height() - 1) / 2);
        let places = Grey::from_fn(picture.width(), picture.height(), |x, y| {
            match (x.checked_sub(left), y.checked_sub(top)) {
                (Some(x), Some(y)) if x < width && y < height => at(x, y) as f32,
                _ => 0.0,
            }
        });
        let found = Match {
            centre_px: [
                x as f64 + dx + half(size.width()),
                y as f64 + dy + half(size.height()),
            ],
            scale: factors[index],
            r,
        };
        Ok((found, places))
    }
}

/// The sub-pixel correction by [`top`] at the position of a largest value; 0 at an end.
fn peak(place: usize, count: usize, value: impl Fn(usize) -> f64) -> f64 {
    if place == 0 || place + 1 >= count {
        return 0.0;
    }
    top(value(place - 1), value(place), value(place + 1))
}

/// Position of the vertex of the parabola through a largest value and its neighbours, relative to the largest value; at most half a
/// pixel.
pub(super) fn top(before: f64, here: f64, after: f64) -> f64 {
    let bend = before - 2.0 * here + after;
    if bend < 0.0 {
        (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

impl Extractor for Template {
    constant_methods! {
        name: &'static str = "template";
        doc: &'static str = "where a template is, by normalised correlation over a pyramid of sizes";
        figure: u8 = 6;
        error_measure: Option<Measure> = Some(Measure {
            name: "template distance",
            unit: "px",
        });
        distance_measure: Measure = Measure {
            name: "distance of the places found",
            unit: "px",
        };
    }

    fn is_sought(&self, sought: &Sought) -> bool {
        sought.template.is_some()
    }

    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction> {
        let template = sought
            .template
            .as_ref()
            .ok_or_else(|| Error::invalid("there is no template to look for").field("template"))?;
        let (found, places) = self.find(picture, template)?;
        let [x, y] = found.centre_px;
        let size = |side: usize| (side as f64 * found.scale / 2.0) as i64;
        let (dx, dy) = (size(template.width()), size(template.height()));
        let framed = picture.drawn_over(|column, row| {
            let off = |at: usize, middle: f64| (at as i64 - middle.round() as i64).abs();
            let (ox, oy) = (off(column, x), off(row, y));
            (ox == dx && oy <= dy) || (oy == dy && ox <= dx)
        });
        let step = |name, picture| Step { name, picture };
        Ok(Extraction {
            steps: vec![
                step("template", template.as_ref().clone()),
                step("picture", picture.clone()),
                step(
                    "inverted Sobel",
                    steepness(picture).stretched().map(|v| 1.0 - v),
                ),
                // Large correlations are dark, as in the paper.
                step("correlation", places.map(|r| 0.5 - 0.5 * r)),
                step("found", framed),
            ],
            remarks: vec![format!(
                "at ({x:.1}, {y:.1}) px, {:.2} times the template's size, correlation {:.3}",
                found.scale, found.r
            )],
            feature: Feature {
                points_px: vec![found.centre_px],
                ..Feature::default()
            },
            warnings: Vec::new(),
        })
    }

    fn error(&self, found: &Feature, sought: &Sought) -> Option<f64> {
        distance_px(found.points_px.first()?, &sought.template_at_px?)
    }

    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64> {
        distance_px(a.points_px.first()?, b.points_px.first()?)
    }
}

fn distance_px(a: &[f64; 2], b: &[f64; 2]) -> Option<f64> {
    Some((a[0] - b[0]).hypot(a[1] - b[1]))
}
