//! What every optimizer must do.

mod contract;
