//! Pictures and tables: plain data in, a file or a text out.
//!
//! | what | function | shows |
//! |---|---|---|
//! | [`HeatMap`] | [`draw_heat_map`] | the score over two parameters |
//! | [`PanelGrid`] | [`draw_panels`] | simulated paths at several parameter values, over the real ones |
//! | [`LinePlot`] | [`draw_lines`] | the score over one parameter; lines, dots and bands over time or number of simulations |
//! | [`Cloud`] | [`plane()`], [`draw_lines`] | recordings and simulations in the first two principal components |
//! | [`BarChart`] | [`draw_bars`] | how much each of several causes changes a result |
//! | [`ColumnChart`] | [`draw_columns`] | a few values for each of several things |
//! | [`Corner`] | [`draw_corner`] | random draws of several quantities, each quantity against each other |
//! | [`Stack`] | [`draw_stack`] | several quantities over one axis, one above the other |
//! | [`JointPlot`] | [`draw_joints`] | recorded and simulated joint angles over time, and their residuals |
//! | [`Overlay`] | [`draw_overlay`] | aligned trajectories over each other |
//! | [`EnsemblePlot`] | [`draw_ensemble`] | repeats by behaviour, their envelope over time, the real runs |
//! | [`Animation`] | [`draw_animation`] | a robot in motion, as the bytes of an animated PNG |
//! | [`Gallery`] | [`draw_gallery`] | robots, shaded |
//! | [`TextTable`] | [`TextTable::render`] | a table for the terminal |
//!
//! Every `draw_…` function writes PNG or SVG by the extension of the path. The file is complete or
//! it is not there, and the same data give the same bytes. A [`HeatMap`] and a [`LinePlot`] can also stand in a page as
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
pub use chart::column::{ColumnChart, ColumnSeries, draw_columns};
pub use chart::corner::{Corner, draw_corner};
pub use chart::ensemble::{EnsembleBand, EnsembleGroup, EnsemblePlot, draw_ensemble};
pub use chart::heatmap::{HeatMap, draw_heat_map};
pub use chart::joint::{JointPanel, JointPlot, draw_joints};
pub use chart::line::{BestPoint, LinePlot, ParameterGrid, Series, SeriesKind, draw_lines};
pub use chart::overlay::{Overlay, OverlayPath, draw_overlay};
pub use chart::panel::{Panel, PanelGrid, draw_panels};
pub use chart::plane::{Cloud, plane};
pub use chart::stack::{Stack, StackRow, draw_stack};
pub use layout::axis::{AxisSpec, Truth};
pub use layout::heading::Caption;
pub use layout::path::PathPoint;
pub use layout::scale::ScoreScale;
pub use realgap_core::table::{Side, TextTable};
pub use realgap_core::unit::{DisplayUnit, number, quantity};
#[cfg(feature = "papers")]
pub(crate) use render::both;
pub use render::check_picture_path;
pub(crate) use render::inline::{Inline, InlineChart, legend};
pub(crate) use render::{Format, Picture, file_bytes};
pub use robot::animation::{Animation, Look, Moment, Trace, draw_animation};
pub use robot::block::{Block, BlockKind, DrivenFace, Motion};
pub use robot::gallery::{Command, Gallery, GalleryRobot, ModuleName, draw_gallery};
