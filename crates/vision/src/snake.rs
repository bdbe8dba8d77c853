//! Greedy snakes (active contours; Williams & Shah 1992) with the energies of equation 1 of paper 002.

use super::filter::{gauss, steepness};
use super::picture::Grey;
use realgap_core::error::{Error, Result};

/// Weights and window of a greedy snake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snake {
    /// Number of points of the contour.
    pub points: usize,
    /// Weight of the internal energy: the mean distance to the two neighbours.
    pub spacing: f64,
    /// Weight of the constraint energy: the curvature over three consecutive points.
    pub curvature: f64,
    /// Weight of the image energy: the inverted normalised Sobel value of the pixel.
    pub image: f64,
    /// Side of the window in which a point may move, pixels: 3 or 9 in the paper, any odd number.
    pub window_px: usize,
    /// Standard deviation of the Gaussian filter before the Sobel operator, pixels.
    pub sigma_px: f64,
    /// Largest number of rounds over all points.
    pub rounds: usize,
}

/// The reason why a snake ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// No point moved.
    AtRest,
    /// Points oscillated between positions.
    Swinging,
    /// The largest number of rounds was reached.
    OutOfRounds,
}

/// The final contour of a snake.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// The contour, closed.
    pub points_px: Vec<[f64; 2]>,
    /// Indices of the points that are not on an edge.
    pub stuck: Vec<usize>,
    /// Number of rounds.
    pub rounds: usize,
    /// The reason why the snake ended.
    pub ending: Ending,
}

/// A point is on an edge if its gradient is at least this share of the largest gradient of the picture.
const ON_EDGE: f32 = 0.25;
/// Smallest number of points of a contour.
const LEAST_POINTS: usize = 4;

impl Snake {
    /// The settings of the registry.
    pub const PAPER: Self = Self {
        points: 48,
        spacing: 1.0,
        curvature: 1.0,
        image: 0.7,
        window_px: 9,
        sigma_px: 1.5,
        rounds: 400,
    };

    /// The gradient picture, normalised to 1 at the pixel with the largest gradient.
    pub fn edges(&self, picture: &Grey) -> Grey {
        let steep = steepness(&gauss(picture, self.sigma_px));
        let most = steep.values().iter().fold(0.0_f32, |a, b| a.max(*b));
        steep.map(|v| if most > 0.0 { v / most } else { 0.0 })
    }

    /// Moves a closed contour until it is at rest.
    ///
    /// # Errors
    /// Fewer than four points, points outside of the picture, an even window.
    pub fn settle(&self, edges: &Grey, start_px: &[[f64; 2]]) -> Result<Settled> {
        self.check(edges, start_px)?;
        let mut points: Vec<[i64; 2]> = evenly(start_px, self.points)
            .iter()
            .map(|p| {
                let last = [edges.width() as i64 - 1, edges.height() as i64 - 1];
                [0, 1].map(|i| (p[i].round() as i64).clamp(0, last[i]))
            })
            .collect();
        let mut before: Vec<Vec<[i64; 2]>> = Vec::new();
        let (mut rounds, mut ending) = (0, Ending::OutOfRounds);
        while rounds < self.rounds {
            rounds += 1;
            let old = points.clone();
            let spacing_px = mean_spacing_px(&points);
            for index in 0..points.len() {
                points[index] = self.best_place(edges, &points, index, spacing_px);
            }
            if points == old {
                ending = Ending::AtRest;
                break;
            }
            // A contour that occurs again would repeat the same cycle for ever.
            if before.iter().rev().take(8).any(|b| *b == points) {
                ending = Ending::Swinging;
                break;
            }
            before.push(old);
            if before.len() > 8 {
                before.remove(0);
            }
        }
        let stuck = (0..points.len())
            .filter(|i| edges.at(points[*i][0], points[*i][1]) < ON_EDGE)
            .collect();
        Ok(Settled {
            points_px: points.iter().map(|p| p.map(|v| v as f64)).collect(),
            stuck,
            rounds,
            ending,
        })
    }

    fn check(&self, edges: &Grey, start_px: &[[f64; 2]]) -> Result<()> {
        if start_px.len() < LEAST_POINTS || self.points < LEAST_POINTS {
            return Err(Error::invalid("too few points for a contour")
                .field("start_px")
                .found(start_px.len().min(self.points))
                .allowed(format!("{LEAST_POINTS} or more")));
        }
        if self.window_px.is_multiple_of(2) {
            return Err(
                Error::invalid("a window must have an odd number of pixels on each side")
                    .field("window_px")
                    .found(self.window_px)
                    .allowed("odd numbers"),
            );
        }
        let is_outside = |p: &&[f64; 2]| {
            let inside = |v: f64, side: usize| (-0.5..=side as f64 - 0.5).contains(&v);
            !(inside(p[0], edges.width()) && inside(p[1], edges.height()))
        };
        match start_px.iter().find(is_outside) {
            None => Ok(()),
            Some(point) => Err(Error::invalid("the contour begins outside of the picture")
                .field("start_px")
                .found(format!("({}, {})", point[0], point[1]))
                .allowed(format!("within {} x {} px", edges.width(), edges.height()))),
        }
    }

    /// The position with the smallest energy in the window around a point. Distances are divided by the mean spacing of the contour, and
    /// curvature by its square, so that the weights do not depend on the size of the contour or of the window.
    fn best_place(
        &self,
        edges: &Grey,
        points: &[[i64; 2]],
        index: usize,
        spacing_px: f64,
    ) -> [i64; 2] {
        let count = points.len();
        let [x, y] = points[index];
        let previous = points[(index + count - 1) % count];
        let next = points[(index + 1) % count];
        let energy = |cx: i64, cy: i64| {
            let to = |p: [i64; 2]| ((p[0] - cx) as f64).hypot((p[1] - cy) as f64);
            let bend = [
                previous[0] - 2 * cx + next[0],
                previous[1] - 2 * cy + next[1],
            ];
            let squared = (bend[0] * bend[0] + bend[1] * bend[1]) as f64;
            self.spacing * 0.5 * (to(previous) + to(next)) / spacing_px
                + self.curvature * squared / (spacing_px * spacing_px)
                + self.image * (1.0 - f64::from(edges.at(cx, cy)))
        };
        let reach = (self.window_px / 2) as i64;
        let (last_x, last_y) = (edges.width() as i64 - 1, edges.height() as i64 - 1);
        let mut best = ([x, y], energy(x, y));
        for cy in (y - reach).max(0)..=(y + reach).min(last_y) {
            for cx in (x - reach).max(0)..=(x + reach).min(last_x) {
                let its = energy(cx, cy);
                // The current position is preferred, so that a contour does not move between positions of equal energy.
                if its < best.1 - 1e-12 {
                    best = ([cx, cy], its);
                }
            }
        }
        best.0
    }
}

/// Mean distance between neighbouring points, at least one pixel.
fn mean_spacing_px(points: &[[i64; 2]]) -> f64 {
    let after = points.iter().cycle().skip(1);
    let sum: f64 = points
        .iter()
        .zip(after)
        .map(|(a, b)| ((a[0] - b[0]) as f64).hypot((a[1] - b[1]) as f64))
        .sum();
    (sum / points.len() as f64).max(1.0)
}

/// `count` evenly spaced points along a closed contour, beginning with its first point.
pub fn evenly(contour: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let n = contour.len();
    let length = |i: usize| {
        let (a, b) = (contour[i], contour[(i + 1) % n]);
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    let whole: f64 = (0..n).map(length).sum();
    if n == 0 || whole <= 0.0 {
        return contour.iter().cycle().take(count.min(n)).copied().collect();
    }
    let (mut side, mut passed) = (0, 0.0);
    (0..count)
        .map(|k| {
            let at = whole * k as f64 / count as f64;
            while side + 1 < n && passed + length(side) <= at {
                passed += length(side);
                side += 1;
            }
            let (a, b) = (contour[side], contour[(side + 1) % n]);
            let share = ((at - passed) / length(side).max(1e-300)).clamp(0.0, 1.0);
            [0, 1].map(|i| a[i] + (b[i] - a[i]) * share)
        })
        .collect()
}

/// Mean distance of points to a closed outline, pixels; `None` if there are no points or the outline is empty.
pub fn mean_distance_px(points_px: &[[f64; 2]], outline_px: &[[f64; 2]]) -> Option<f64> {
    if points_px.is_empty() || outline_px.is_empty() {
        return None;
    }
    let n = outline_px.len();
    let to_outline = |p: &[f64; 2]| {
        (0..n)
            .map(|i| to_side(*p, outline_px[i], outline_px[(i + 1) % n]))
            .fold(f64::INFINITY, f64::min)
    };
    Some(points_px.iter().map(to_outline).sum::<f64>() / points_px.len() as f64)
}

fn to_side(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 {
        (((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p[0] - a[0] - share * along[0]).hypot(p[1] - a[1] - share * along[1])
}
