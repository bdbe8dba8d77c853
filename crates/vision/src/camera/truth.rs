//! Computes the known truth of a simulated picture: the positions of posters in it.

use super::super::lettering::print_text;
use super::super::picture::{Grey, Region};
use super::super::views::ViewFile;
use super::cast::{Caster, Thing};
use super::lens::Pose;
use super::poster::Motif;
use super::scene::{Camera, Poster, Scene};
use super::vector::less;
use realgap_core::error::Result;

/// The text of the learning picture that is written together with pictures.
pub const ALPHABET_TEXT: &str = "ABCDEFGHIJKLM\nNOPQRSTUVWXYZ\n0123456789";

/// Size of the start contour of a snake, relative to the outline.
const AROUND: f64 = 1.3;
const START_POINTS: usize = 32;
const OUTLINE_POINTS: usize = 160;
/// Size of the region of text, as a share of its poster, so that the region contains no part of the wall.
const WITHIN: f64 = 0.95;
/// Smallest side of a region of text, pixels.
const LEAST_PX: f64 = 16.0;

/// The learning picture.
///
/// # Errors
/// None.
pub fn alphabet_picture() -> Result<Grey> {
    print_text(ALPHABET_TEXT, 64.0, 0.1)
}

/// Positions of points of a poster in a picture; `None` unless all of them are inside of the picture and not occluded.
fn seen(
    scene: &Scene,
    camera: &Camera,
    pose: &Pose,
    index: usize,
    points: &[[f64; 2]],
) -> Option<Vec<(f64, f64)>> {
    let caster = Caster::new(scene);
    let poster = &scene.posters[index];
    let (width, height) = (camera.lens.width_px as f64, camera.lens.height_px as f64);
    points
        .iter()
        .map(|[u, v]| {
            let point = poster.point_m(*u, *v);
            let [x, y] = camera.lens.project_px(pose, point)?;
            let is_inside = x >= 0.0 && y >= 0.0 && x <= width - 1.0 && y <= height - 1.0;
            let away = less(point, pose.place_m);
            let length = super::vector::dot(away, away).sqrt();
            let hit = caster.first(pose.place_m, super::vector::times(away, 1.0 / length));
            let is_free = hit.thing == Thing::Poster(index) || hit.distance_m > length - 1e-3;
            (is_inside && is_free).then_some((x, y))
        })
        .collect()
}

/// The smaller side of the bounding box of some points, pixels.
fn size(points: &[(f64, f64)]) -> f64 {
    let side = |of: fn(&(f64, f64)) -> f64| {
        let values = points.iter().map(of);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        high - low
    };
    side(|p| p.0).min(side(|p| p.1))
}

/// The known truth of a view from this pose: the centre of the logo, the contour of the larger disc or bottle, and the text.
pub fn known(scene: &Scene, camera: &Camera, pose: &Pose, name: &str) -> ViewFile {
    let corners = |share: f64| {
        [
            [-share, -share],
            [share, -share],
            [share, share],
            [-share, share],
        ]
    };
    let mut view = ViewFile {
        name: name.to_owned(),
        ..ViewFile::default()
    };
    let mut largest = 0.0;
    for (index, poster) in scene.posters.iter().enumerate() {
        let places = |points: &[[f64; 2]]| seen(scene, camera, pose, index, points);
        match &poster.motif {
            Motif::Logo => {
                if places(&corners(1.0)).is_some() && view.template_at_px.is_none() {
                    view.template_at_px = places(&[[0.0, 0.0]]).map(|p| p[0]);
                }
            }
            Motif::Text(text) => {
                let region = places(&corners(WITHIN)).and_then(|p| inner(&p));
                if let (Some(region), None) = (region, &view.text_region) {
                    view.text_region = Some(region);
                    view.text = Some(text.clone());
                }
            }
            Motif::Disc | Motif::Bottle => {
                let Some((start, outline)) = contour(poster, places) else {
                    continue;
                };
                if size(&outline) > largest {
                    largest = size(&outline);
                    view.start_px = start;
                    view.outline_px = outline;
                }
            }
        }
    }
    view
}

type Points = Vec<(f64, f64)>;

fn contour(
    poster: &Poster,
    places: impl Fn(&[[f64; 2]]) -> Option<Points>,
) -> Option<(Points, Points)> {
    let outline = poster.motif.outline(OUTLINE_POINTS);
    let (mut left, mut right, mut top, mut low) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for [u, v] in &outline {
        (left, right) = (left.min(*u), right.max(*u));
        (top, low) = (top.min(*v), low.max(*v));
    }
    // The start contour is an ellipse around the outline, within the poster.
    let half = |low: f64, high: f64| (0.5 * (high - low) * AROUND).min(0.97);
    let (a, b) = (half(left, right), half(top, low));
    let start: Vec<[f64; 2]> = (0..START_POINTS)
        .map(|k| {
            let (sin, cos) = (k as f64 / START_POINTS as f64 * std::f64::consts::TAU).sin_cos();
            [0.5 * (left + right) + a * cos, 0.5 * (top + low) + b * sin]
        })
        .collect();
    Some((places(&start)?, places(&outline)?))
}

/// The upright rectangle inside of four corners (clockwise from the top left).
fn inner(corners: &[(f64, f64)]) -> Option<Region> {
    let [a, b, c, d] = corners else {
        return None;
    };
    let (left, right) = (a.0.max(d.0).ceil(), b.0.min(c.0).floor());
    let (top, low) = (a.1.max(b.1).ceil(), c.1.min(d.1).floor());
    (right - left >= LEAST_PX && low - top >= LEAST_PX).then_some(Region {
        x_px: left as usize,
        y_px: top as usize,
        width_px: (right - left) as usize,
        height_px: (low - top) as usize,
    })
}
