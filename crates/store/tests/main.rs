//! What is kept, and what damages it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod damage;
mod finished;
