#![allow(clippy::all, clippy::print_stdout, clippy::unwrap_used)]
#[path="timing.rs"] #[allow(dead_code)] mod timing;
fn main(){ timing::sequence(&std::env::args().nth(1).unwrap()); }
