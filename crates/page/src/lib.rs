//! What people look at: pictures, pages, replays, results folders.

mod markup;
pub mod plot;
pub mod report;
pub mod results;
