//! A picture is drawn once, on a [`Canvas`], in picture units (one pixel of the finished PNG); [`pixels`] and [`svg`]
//! turn the canvas into an image.
//!
//! The canvas is a list that knows no file format, so that the code of a chart is compiled and run once, and not once for each
//! format. No other crate depends on plotters, whose rasterizer and SVG writer this crate uses.

mod canvas;
mod pixel;
mod vector;

pub use canvas::{Align, Canvas, Letter, Point, Stroke};
pub use pixel::pixels;
pub use plotters::style::RGBColor;
pub use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
pub use realgap_core::font::Weight;
pub use vector::svg;
