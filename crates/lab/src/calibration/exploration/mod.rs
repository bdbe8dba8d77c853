//! Exploration of the parameter space: which points are simulated, and where their results go.

pub(super) mod information_gain;
pub(super) mod least_squares;
pub(super) mod method;
pub(super) mod other_start;
pub(super) mod sweep;
pub(super) mod trial_sink;
pub(super) mod tune;
pub(super) mod tune_problem;
pub(super) mod wave;
