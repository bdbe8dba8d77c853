//! Pictures and tables: plain data in, a file or a text out.
//!
//! | what | function | shows |
//! |---|---|---|
//! | [`HeatMap`] | [`draw_heat_map`] | the score over two parameters |
//! | [`Curve`] | [`draw_curve`] | the score over one parameter |
//! | [`PanelGrid`] | [`draw_panels`] | simulated paths at several parameter values, over the real ones |
//! | [`LinePlot`] | [`draw_lines`] | lines, dots and bands over time or number of simulations |
//! | [`Cloud`] | [`plane()`], [`draw_lines`] | recordings and simulations in the first two principal components |
//! | [`BarChart`] | [`draw_bars`] | what each of many causes changes |
//! | [`ColumnChart`] | [`draw_columns`] | a few values for each of several things |
//! | [`Corner`] | [`draw_corner`] | draws of several quantities, each against each |
//! | [`Stack`] | [`draw_stack`] | several quantities over one axis, one above the other |
//! | [`JointPlot`] | [`draw_joints`] | recorded and simulated joints over time, and what is left between them |
//! | [`Overlay`] | [`draw_overlay`] | aligned trajectories over each other |
//! | [`EnsemblePlot`] | [`draw_ensemble`] | repeats by behaviour, their envelope over time, the real runs |
//! | [`Animation`] | [`draw_animation`] | a robot in motion, as the bytes of an animated PNG |
//! | [`Gallery`] | [`draw_gallery`] | robots, shaded |
//! | [`TextTable`] | [`TextTable::render`] | a table for the terminal |
//!
//! Every `draw_…` function writes PNG or SVG by the extension of the path. The file is complete or
//! it is not there, and the same data give the same bytes. Nothing here knows where the data come
//! from: callers fill the structs.

/// What every chart is drawn with.
mod kit {
    pub(super) use std::path::Path;

    pub(super) use realgap_core::unit::{DisplayUnit, Unit};
    pub(super) use realgap_core::{Error, Result};
    pub(super) use realgap_drawing::{Align, Canvas, Letter, Point, RGBColor, Stroke, Weight};

    pub(super) use super::axis::{
        self, AxisSpec, Truth, check_length, check_values, edges, nothing,
    };
    pub(super) use super::colour::*;
    pub(super) use super::font::{shorten, wrap};
    pub(super) use super::frame::*;
    pub(super) use super::heading::{Caption, Heading, Sheet};
    pub(super) use super::legend::*;
    pub(super) use super::path::*;
    pub(super) use super::picture::{self, Picture};
    pub(super) use super::scale::*;
}

mod animation;
mod axis;
mod bar;
mod block;
mod colour;
mod column;
mod corner;
mod curve;
mod ensemble;
mod font;
mod frame;
mod gallery;
mod heading;
mod heatmap;
mod joint;
mod legend;
mod line;
mod overlay;
mod panel;
mod path;
mod picture;
mod plane;
mod scale;
mod stack;
mod surface;
#[cfg(test)]
mod tests;

pub use animation::{Animation, Look, Moment, Trace, draw_animation};
pub use axis::{AxisSpec, Truth};
pub use bar::{Bar, BarChart, draw_bars};
pub use block::{Block, BlockKind, DrivenFace, Motion};
pub(crate) use colour::score_hex;
pub use column::{ColumnChart, ColumnSeries, draw_columns};
pub use corner::{Corner, draw_corner};
pub use curve::{Curve, draw_curve};
pub use ensemble::{EnsembleBand, EnsembleGroup, EnsemblePlot, draw_ensemble};
pub use gallery::{Command, Gallery, GalleryRobot, ModuleName, draw_gallery};
pub use heading::Caption;
pub use heatmap::{HeatMap, draw_heat_map};
pub use joint::{JointPanel, JointPlot, draw_joints};
pub use line::{LinePlot, Series, SeriesKind, draw_lines};
pub use overlay::{Overlay, OverlayPath, draw_overlay};
pub use panel::{Panel, PanelGrid, draw_panels};
pub use path::PathPoint;
pub(crate) use picture::both;
pub use picture::check_picture_path;
pub use plane::{Cloud, plane};
pub use realgap_core::table::{Side, TextTable};
pub use realgap_core::unit::{DisplayUnit, number, quantity};
pub(crate) use scale::Scale;
pub use scale::ScoreScale;
pub use stack::{Stack, StackRow, draw_stack};
