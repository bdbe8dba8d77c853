//! The tree solver against closed forms.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may fail loudly and says what it measured"
)]

mod common;
mod cone;
mod contact;
mod flight;
mod joint;
mod led;
mod mount;
mod pair;
mod turning;
mod tyre;
