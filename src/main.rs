//! The `realgap` command.
fn main() {}
