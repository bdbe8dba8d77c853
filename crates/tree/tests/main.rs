//! The tree solver against closed forms.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;
mod contact;
mod flight;
