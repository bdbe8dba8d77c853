//! Parts that charts share: axes, frames, headings, legends, colours and text.

pub(super) mod axis;
pub(super) mod colour;
pub(super) mod font;
pub(super) mod frame;
pub(super) mod heading;
pub(super) mod legend;
pub(super) mod path;
pub(super) mod scale;
