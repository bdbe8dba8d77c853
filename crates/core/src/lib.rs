//! What every crate of realgap needs: errors, warnings, units, random streams, statistics, files.

pub mod error;
pub mod file;
pub mod font;
pub mod quantity;
pub mod random;
pub mod range;
#[cfg(feature = "schema")]
pub mod schema;
pub mod statistics;
pub mod table;
pub mod text;
pub mod unit;
pub mod warning;

pub use error::{Advice, Error, ErrorKind, Result};
pub use warning::Warning;

/// Methods of a trait that state one value each, in an implementation of it: `stated! { name: &'static str = "pca"; … }`.
#[macro_export]
macro_rules! stated {
    ($($name:ident: $type:ty = $value:expr;)*) => {
        $(fn $name(&self) -> $type {
            $value
        })*
    };
}
