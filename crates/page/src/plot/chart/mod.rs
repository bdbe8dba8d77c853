//! Charts: what each shows as plain data, and how it is drawn.

pub(super) mod bar;
#[cfg(feature = "papers")]
pub(super) mod column;
pub(super) mod corner;
pub(super) mod ensemble;
pub(super) mod heatmap;
pub(super) mod interval;
pub(super) mod joint;
pub(super) mod line;
pub(super) mod overlay;
pub(super) mod panel;
pub(super) mod plane;
pub(super) mod series;
pub(super) mod stack;
