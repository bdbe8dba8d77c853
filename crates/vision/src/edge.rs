//! The extractor `edges`: Canny's edge detector (1986) with Gaussian filter, Sobel operator, non-maximum suppression and hysteresis.
//! Figures 2 and 5 of paper 002.

use super::extractor::{Extraction, Extractor, Feature, Measure, Sought, Step};
use super::filter::{gauss, slopes, steepness};
use super::picture::Grey;
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::warning::Code;

/// The largest number of pixels of a step that is shown.
const MOST_SHOWN: f64 = 4e6;

/// Canny's edge detector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edges {
    /// Standard deviation of the Gauss filter, pixels.
    pub sigma_px: f64,
    /// Lower threshold of the gradient, grey value per pixel (0 to 1): a pixel above it belongs to an edge if it is connected to a
    /// pixel above the upper threshold.
    pub low: f32,
    /// Upper threshold of the gradient, above which a pixel always belongs to an edge.
    pub high: f32,
    /// Standard deviation, in pixels, of the Gaussian filter that is applied to edge pictures before they are correlated. Edges at about
    /// this distance from each other still count as similar; with 0, edges are compared pixel by pixel.
    pub tolerance_px: f64,
}

impl Edges {
    /// The settings of the registry; the thresholds are those of scikit-image (0.1 and 0.2 of Sobel's kernel without the division by 8).
    pub const PAPER: Self = Self {
        sigma_px: 1.4,
        low: 0.0125,
        high: 0.025,
        tolerance_px: 1.0,
    };

    /// The steps for people, and the picture that is 1 on edges and 0 elsewhere. Each step is dropped as soon as the next one is there,
    /// because a large picture is in memory at every step.
    fn find(&self, picture: &Grey) -> (Vec<Step>, Grey) {
        let step = |name, picture: Grey| Step { name, picture };
        let mut steps = vec![step("picture", shown(picture))];
        let smooth = gauss(picture, self.sigma_px);
        steps.push(step("Gauss", shown(&smooth)));
        let steep = steepness(&smooth);
        steps.push(step("Sobel", shown(&steep).stretched()));
        let thin = thinned(&steep, &smooth);
        drop((smooth, steep));
        steps.push(step("non-maximum suppression", shown(&thin).stretched()));
        let edges = connected(&thin, self.low, self.high);
        steps.push(step("hysteresis", shown(&edges)));
        (steps, edges)
    }
}

/// The picture of a step as it is shown: large ones are reduced.
fn shown(picture: &Grey) -> Grey {
    let pixels = (picture.width() * picture.height()) as f64;
    let scale = (MOST_SHOWN / pixels).sqrt();
    if scale >= 1.0 {
        return picture.clone();
    }
    let side = |pixels: usize| (scale * pixels as f64).round() as usize;
    picture.resized(side(picture.width()), side(picture.height()))
}

/// Non-maximum suppression: keeps pixels whose gradient is largest along its own direction; the gradient of neighbours is interpolated.
fn thinned(steep: &Grey, smooth: &Grey) -> Grey {
    let (width, height) = (steep.width(), steep.height());
    Grey::from_fn(width, height, |x, y| {
        // Pixels at the border have no neighbours on all sides, so they are never edges.
        if x == 0 || y == 0 || x + 1 >= width || y + 1 >= height {
            return 0.0;
        }
        let here = y * width + x;
        let value = steep.values()[here];
        if value <= 0.0 {
            return 0.0;
        }
        let (gx, gy) = slopes(smooth, x, y);
        let (x, y) = (x as i64, y as i64);
        let (sx, sy) = (if gx < 0.0 { -1 } else { 1 }, if gy < 0.0 { -1 } else { 1 });
        let beside = |sign: i64| {
            let (sx, sy) = (sign * sx, sign * sy);
            let diagonal = steep.at(x + sx, y + sy);
            if gx.abs() >= gy.abs() {
                let share = gy.abs() / gx.abs();
                steep.at(x + sx, y) * (1.0 - share) + diagonal * share
            } else {
                let share = gx.abs() / gy.abs();
                steep.at(x, y + sy) * (1.0 - share) + diagonal * share
            }
        };
        if value >= beside(1) && value >= beside(-1) {
            value
        } else {
            0.0
        }
    })
}

/// Hysteresis: 1 for pixels above `low` that are connected to a pixel above `high` by such pixels (8 neighbours).
fn connected(thin: &Grey, low: f32, high: f32) -> Grey {
    let (width, height) = (thin.width(), thin.height());
    let mut is_edge = vec![false; width * height];
    let mut open: Vec<usize> = (0..width * height)
        .filter(|i| thin.values()[*i] >= high)
        .collect();
    open.iter().for_each(|i| is_edge[*i] = true);
    while let Some(here) = open.pop() {
        let (x, y) = (here % width, here / width);
        for ny in y.saturating_sub(1)..=(y + 1).min(height - 1) {
            for nx in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                let next = ny * width + nx;
                if !is_edge[next] && thin.values()[next] >= low {
                    is_edge[next] = true;
                    open.push(next);
                }
            }
        }
    }
    Grey::from_fn(width, height, |x, y| {
        f32::from(u8::from(is_edge[y * width + x]))
    })
}

/// Pearson's correlation of two pictures; `None` if their sizes differ or if one is uniform.
pub fn correlation(a: &Grey, b: &Grey) -> Option<f64> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return None;
    }
    let mean = |picture: &Grey| {
        let values = picture.values();
        values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
    };
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.values().iter().zip(b.values()) {
        let (x, y) = (f64::from(*x) - mean_a, f64::from(*y) - mean_b);
        aa += x * x;
        ab += x * y;
        bb += y * y;
    }
    (aa > 0.0 && bb > 0.0).then(|| (ab / (aa * bb).sqrt()).clamp(-1.0, 1.0))
}

impl Extractor for Edges {
    constant_methods! {
        name: &'static str = "edges";
        doc: &'static str = "Canny's edges; the distance of two pictures is 1 minus the correlation of their edges";
        figure: u8 = 5;
        error_measure: Option<Measure> = None;
        distance_measure: Measure = Measure {
            name: "1 - edge correlation",
            unit: "",
        };
    }

    fn is_sought(&self, _: &Sought) -> bool {
        true
    }

    fn extract(&self, picture: &Grey, _: &Sought) -> Result<Extraction> {
        let (steps, edges) = self.find(picture);
        let on = edges.values().iter().filter(|v| **v > 0.0).count();
        Ok(Extraction {
            steps,
            remarks: vec![format!(
                "{:.2} % of the pixels are on edges",
                100.0 * on as f64 / edges.values().len() as f64
            )],
            feature: Feature {
                map: Some(edges),
                ..Feature::default()
            },
            warnings: if on == 0 {
                vec![Code::NoEdges.warning("the picture has no edges")]
            } else {
                Vec::new()
            },
        })
    }

    /// There is no error, because the true positions of edges are not known.
    fn error(&self, _: &Feature, _: &Sought) -> Option<f64> {
        None
    }

    /// 1 − r of the two edge pictures, each smoothed with the tolerance. The distance is 0 for two pictures without edges, and 1 if only
    /// one of them has edges.
    fn distance(&self, a: &Feature, b: &Feature) -> Option<f64> {
        let (a, b) = (a.map.as_ref()?, b.map.as_ref()?);
        if (a.width(), a.height()) != (b.width(), b.height()) {
            return None;
        }
        if a == b {
            return Some(0.0);
        }
        let smooth = |edges: &Grey| gauss(edges, self.tolerance_px);
        Some(1.0 - correlation(&smooth(a), &smooth(b)).unwrap_or(0.0))
    }
}
