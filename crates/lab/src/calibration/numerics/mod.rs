//! Numerical settings of the runs of a study: which are equally valid, what they change, and what a run costs.

pub(super) mod audit;
pub(super) mod cost;
pub(super) mod engines;
pub(super) mod setting;
