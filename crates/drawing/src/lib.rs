//! A picture is drawn once, on a [`Canvas`], in picture units (one pixel of the finished PNG); [`pixels`] and [`svg`]
//! set what was drawn.
//!
//! The canvas is a list and knows no format, so that no chart is compiled, or run, once for each of them. This is the
//! only crate that names plotters, whose rasterizer and SVG writer are behind it.

mod canvas;
mod pixel;
mod vector;

pub use canvas::{Align, Canvas, Letter, Point, Stroke};
pub use pixel::pixels;
pub use plotters::style::RGBColor;
pub use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
pub use realgap_core::font::Weight;
pub use vector::svg;
