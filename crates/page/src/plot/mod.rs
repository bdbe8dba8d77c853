//! Pictures and tables: plain data in, a file or a text out.
//!
//! | what | shows |
//! |---|---|
//! | `HeatMap` | the score over two parameters |
//! | [`LinePlot`] | the score over one parameter; lines, dots and bands over time or number of simulations; paths |
//! | `PanelGrid` | simulated paths at several parameter values, over the real ones |
//! | [`Cloud`] | recordings and simulations in the first two principal components ([`plane()`]) |
//! | [`BarChart`] | how much each of several causes changes a result |
//! | `ColumnChart` | a few values for each of several things |
//! | `IntervalChart` | parameters within their searched ranges: what the recordings allow |
//! | `Corner` | random draws of several quantities, each quantity against each other |
//! | `Stack` | several quantities over one axis, one above the other |
//! | `JointPlot` | recorded and simulated joint angles over time, and their residuals |
//! | [`Overlay`] | aligned trajectories over each other |
//! | `EnsemblePlot` | repeats by behaviour, their envelope over time, the real runs |
//! | `Animation` | a robot in motion, as the bytes of an animated PNG |
//! | [`Gallery`] | robots, shaded |
//! | [`TextTable`] | a table for the terminal |
//!
//! Every `draw_…` function writes PNG or SVG by the extension of the path. The file is complete or
//! it is not there, and the same data give the same bytes. A `HeatMap` and a [`LinePlot`] can also stand in a page as
//! inline SVG. Charts do not know where their data come from: callers fill the structs.

/// Names that every chart uses.
mod kit {
    pub(super) use std::path::Path;

    pub(super) use realgap_core::unit::{DisplayUnit, Unit};
    pub(super) use realgap_core::{Error, Result};
    pub(super) use realgap_drawing::{Align, Canvas, Letter, Point, RGBColor, Stroke, Weight};

    pub(super) use super::layout::axis::{
        self, AxisSpec, Truth, check_length, check_values, edges, nothing,
    };
    pub(super) use super::layout::colour::*;
    pub(super) use super::layout::font::{shorten, wrap};
    pub(super) use super::layout::frame::*;
    pub(super) use super::layout::heading::{Caption, Heading, HeadingAndLegend};
    pub(super) use super::layout::legend::*;
    pub(super) use super::layout::path::*;
    pub(super) use super::layout::scale::*;
    pub(super) use super::render::{self as picture, Picture};
}

mod chart;
mod layout;
pub(crate) mod render;
mod robot;
#[cfg(test)]
mod tests;

pub use chart::bar::{Bar, BarChart, draw_bars};
#[cfg(feature = "papers")]
pub(crate) use chart::column::{ColumnChart, ColumnSeries, draw_columns};
pub(crate) use chart::corner::Corner;
pub(crate) use chart::ensemble::{EnsembleBand, EnsembleGroup, EnsemblePlot};
pub(crate) use chart::heatmap::HeatMap;
#[cfg(feature = "papers")]
pub(crate) use chart::heatmap::draw_heat_map;
pub(crate) use chart::interval::{IntervalChart, ParameterInterval};
pub(crate) use chart::joint::{JointPanel, JointPlot};
pub(crate) use chart::line::BestPoint;
pub use chart::line::{LinePlot, draw_lines};
pub use chart::overlay::{Overlay, OverlayPath, draw_overlay};
pub(crate) use chart::panel::{Panel, PanelGrid};
pub use chart::plane::{Cloud, plane};
pub use chart::series::{Series, SeriesKind};
pub(crate) use chart::stack::{Stack, StackRow, draw_stack};
pub use layout::axis::AxisSpec;
pub(crate) use layout::axis::Truth;
pub use layout::heading::Caption;
pub(crate) use layout::path::PathPoint;
pub use layout::scale::ScoreScale;
pub use realgap_core::table::{Side, TextTable};
pub use realgap_core::unit::{DisplayUnit, number, quantity};
#[cfg(feature = "papers")]
pub(crate) use render::both;
pub use render::check_picture_path;
pub(crate) use render::inline::{Inline, InlineChart, legend};
pub(crate) use render::{Format, Picture, file_bytes};
pub(crate) use robot::animation::{Animation, Look, Moment, Trace, draw_animation};
pub use robot::block::{Block, BlockKind, DrivenFace, Motion};
pub use robot::gallery::{Command, Gallery, GalleryRobot, ModuleName, draw_gallery};
