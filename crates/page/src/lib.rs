//! What people look at: pictures, pages, replays, results folders.

pub mod plot;
pub mod report;
pub mod results;
