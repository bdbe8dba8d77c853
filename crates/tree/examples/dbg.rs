#![allow(clippy::all, clippy::print_stdout, clippy::unwrap_used)]
#[path="timing.rs"] #[allow(dead_code)] mod timing;
fn main(){ let a: Vec<String> = std::env::args().collect(); if a.len() > 2 { timing::only(&a[1], a[2].parse().unwrap(), 300.0, a[3].parse().unwrap(), 100); } else { timing::sequence(&a[1]); } }
