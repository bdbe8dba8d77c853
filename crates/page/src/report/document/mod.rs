//! The HTML document of a page: its head and scripts, its sections, tables and packed numbers.

pub(in crate::report) mod base64;
pub(in crate::report) mod packed;
pub(in crate::report) mod page;
pub(crate) mod picture;
pub(in crate::report) mod section;
pub(in crate::report) mod value;
