//! Colours that people with a colour-vision deficiency can tell apart.

use realgap_drawing::{ColorMap, RGBColor, Stroke, ViridisRGB};

pub(in crate::plot) const WHITE: RGBColor = RGBColor(255, 255, 255);
pub(in crate::plot) const INK: RGBColor = RGBColor(26, 26, 26);
pub(in crate::plot) const FAINT_INK: RGBColor = RGBColor(89, 89, 89);
pub(in crate::plot) const GRID: RGBColor = RGBColor(226, 226, 226);
/// Ground and lines of the hatching that marks diverged points.
pub(in crate::plot) const DIVERGED: RGBColor = RGBColor(232, 232, 232);
pub(in crate::plot) const DIVERGED_LINE: RGBColor = RGBColor(150, 150, 150);

pub(in crate::plot) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(in crate::plot) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
/// A tint of sky blue for shaded regions, light enough for text and lines above it.
pub(in crate::plot) const SHADE: RGBColor = RGBColor(210, 232, 246);

/// Lines in the order in which they are used (Okabe and Ito, without black and yellow: the first is
/// the reference's, the second too faint on white).
const LINES: [RGBColor; 6] = [
    BLUE,
    VERMILLION,
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Lengths of dash and gap, in pixels; tells lines apart once the colours repeat.
const DASHES: [Option<(f64, f64)>; 3] = [None, Some((14.0, 8.0)), Some((4.0, 7.0))];

/// Colour and dash of line number `index`.
pub(in crate::plot) fn stroke_of(index: usize, width: f64) -> Stroke {
    let colour = LINES[index % LINES.len()];
    let dash = DASHES[(index / LINES.len()) % DASHES.len()];
    Stroke::new(width, colour).dashed(dash)
}

/// Viridis the other way round: 0 (a good score) is bright yellow, 1 (a bad one) dark violet.
pub(in crate::plot) fn score_colour(share: f64) -> RGBColor {
    let share = match share.is_finite() {
        true => share.clamp(0.0, 1.0),
        false => 1.0,
    };
    ViridisRGB.get_color((1.0 - share) as f32)
}

/// `colour` mixed with white; `share` of 1 leaves it as it is.
pub(in crate::plot) fn tint(colour: RGBColor, share: f64) -> RGBColor {
    let mix = |channel: u8| (255.0 - (255.0 - f64::from(channel)) * share).round() as u8;
    RGBColor(mix(colour.0), mix(colour.1), mix(colour.2))
}

/// The colour with this share of its light.
pub(in crate::plot) fn darken(colour: RGBColor, share: f64) -> RGBColor {
    let scale = |channel: u8| (f64::from(channel) * share).round() as u8;
    RGBColor(scale(colour.0), scale(colour.1), scale(colour.2))
}
