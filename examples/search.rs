//! Searches for the robot of up to four modules that walks farthest on a floor whose friction is known only as a range, without files.
//!
//! ```console
//! cargo run --release --example search
//! ```
#![allow(clippy::print_stdout)]

use realgap::optimization::RunOptions;
use realgap::search::{Evolution, FinalsSettings, Search};

fn main() -> realgap::Result<()> {
    let evolution = Evolution {
        population: 8,
        generations: 4,
        ..Evolution::default()
    };
    let finals = FinalsSettings {
        count: 2,
        repeats: 20,
        ..FinalsSettings::default()
    };
    let search = Search::builder(evolution)
        .uncertain("floor.friction", 0.4, 0.6)
        .duration_s(5.0)
        .repeats(4)
        .finals(finals)
        .build()?;
    let options = RunOptions::default();
    let results = search.run(&options)?;
    for finalist in search.finalists(&results, &options)? {
        println!("{}", finalist.card());
    }
    Ok(())
}
