//! The extractor `contour`: the outline of an object by a greedy snake that shrinks onto it. Figures 8 to 10 of paper 002.

use super::extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
use super::picture::Grey;
use super::snake::{Ending, Snake, evenly, mean_distance_px};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::warning::Code;

/// Extraction of an outline by a greedy snake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contour {
    /// Weights and window of the snake.
    pub snake: Snake,
}

impl Contour {
    /// The settings of the registry.
    pub const PAPER: Self = Self {
        snake: Snake::PAPER,
    };
}

/// There is a warning if more than this share of points is not on an edge.
const MANY_STUCK: f64 = 0.25;

/// The picture with a closed line drawn over it.
fn over(picture: &Grey, points_px: &[[f64; 2]]) -> Grey {
    let line = evenly(points_px, 4000);
    let mut is_line = vec![false; picture.width() * picture.height()];
    for [x, y] in line {
        let (x, y) = (x.round().max(0.0) as usize, y.round().max(0.0) as usize);
        if x < picture.width() && y < picture.height() {
            is_line[y * picture.width() + x] = true;
        }
    }
    picture.drawn_over(|x, y| is_line[y * picture.width() + x])
}

impl Extractor for Contour {
    constant_methods! {
        name: &'static str = "contour";
        doc: &'static str = "the outline of an object, by a greedy snake that starts around it";
        figure: u8 = 8;
        error_measure: Option<Measure> = Some(Measure {
            name: "mean snake distance",
            unit: "px",
        });
        distance_measure: Measure = Measure {
            name: "mean distance of the contours",
            unit: "px",
        };
    }

    fn is_sought(&self, sought: &Sought) -> bool {
        !sought.start_px.is_empty()
    }

    fn extract(&self, picture: &Grey, sought: &Sought) -> Result<Extraction> {
        if sought.start_px.is_empty() {
            return Err(Error::invalid("there is no contour to start from").field("start_px"));
        }
        let edges = self.snake.edges(picture);
        let settled = self.snake.settle(&edges, &sought.start_px)?;
        let count = settled.points_px.len();
        let (stuck, share) = (
            settled.stuck.len(),
            settled.stuck.len() as f64 / count as f64,
        );
        let mut warnings = Vec::new();
        let is_in = |[x, y]: &[f64; 2]| {
            (0.0..=picture.width() as f64).contains(x)
                && (0.0..=picture.height() as f64).contains(y)
        };
        if !sought.outline_px.is_empty() && !sought.outline_px.iter().any(is_in) {
            let [x, y] = sought.outline_px[0];
            warnings.push(Code::OutlineOutside.warning(format!(
                "the true outline of the object, beginning at ({x}, {y}) px, is outside of the picture of {} x {} px",
                picture.width(),
                picture.height()
            )));
        }
        if share > MANY_STUCK {
            warnings.push(Code::ContourStuck.warning(format!(
                "{stuck} of {count} points of a contour are not on an edge"
            )));
        }
        if settled.ending == Ending::OutOfRounds {
            warnings.push(Code::ContourStuck.warning(format!(
                "a contour still moves after {} rounds",
                settled.rounds
            )));
        }
        let step = |name, picture| Step { name, picture };
        Ok(Extraction {
            steps: vec![
                step("picture", picture.clone()),
                step("inverted Sobel", edges.map(|v| 1.0 - v)),
                step("start", over(picture, &sought.start_px)),
                step("at rest", over(picture, &settled.points_px)),
            ],
            remarks: vec![format!(
                "{count} points, {stuck} of them not on an edge, after {} rounds",
                settled.rounds
            )],
            feature: Feature {
                points_px: settled.points_px,
                ..Feature::default()
            },
            warnings,
        })
    }

    fn error(&self, found: &Feature, sought: &Sought) -> Option<f64> {
        mean_distance_px(&found.points_px, &sought.outline_px)
    }

    /// The mean of the distances in both directions, so that the distance is symmetric.
    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64> {
        let there = mean_distance_px(&a.points_px, &b.points_px)?;
        let back = mean_distance_px(&b.points_px, &a.points_px)?;
        Some(0.5 * (there + back))
    }
}
