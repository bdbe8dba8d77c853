//! Any file is read or refused with an error: no panic, no endless message, no control of the terminal.
//!
//! Shipped files are mutated and read again, as what they are and as what they are not. Every round has a seed of its own and can
//! be repeated; those that once found a fault stay in `FOUND`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::corpus::corpus;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use rand::{Rng, RngExt};
use realgap::calibration::{Definition, Overrides, read_noise, read_parameters};
use realgap::file::Source;
use realgap::robot::genome::Individual;
use realgap::robot::import::{self, Options};
use realgap::robot::morphology::Morphology;
use realgap::search::{Search, generator};
use realgap::sensing::arena::Arena;
use realgap::simulation::{Controller, Experiment, Vehicle, run};
use realgap::trajectory::{self, InferredReading, Reading, prepare, read_meta};
use realgap::vision::Picture;
use realgap::vision::camera::{Camera, Scene};
use realgap::{Error, Result};

/// Rounds that once found a fault.
const FOUND: &[u64] = &[];

/// Texts of common mistakes and of attacks.
const TOKENS: &[&str] = &[
    "0",
    "-0.0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "NaN",
    "inf",
    "-inf",
    "9223372036854775807",
    "18446744073709551616",
    "\"",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ":",
    ",",
    "/*",
    "//",
    "Some(",
    "None",
    "r#\"",
    "\\u{0}",
    "'",
    "true",
    "..",
    "../../x",
    "\u{1b}[2J",
    "\u{202e}",
    "\u{feff}",
    "\0",
    "\r",
    "\t",
    "-x",
    "e",
    "0x1F",
    "1_000",
    ".5",
    "5.",
    "#![enable(unwrap_newtypes)]",
    "t_s",
    "x_m",
    "condition",
    "run",
    ";",
    "\n\n",
    "modules",
    "glue",
    "parent",
    "side_m",
    "mass_kg",
    "gait",
    "PosX",
    "NegZ",
];

/// A part of a text.
fn span(length: usize, rng: &mut dyn Rng) -> std::ops::Range<usize> {
    let start = rng.random_range(0..=length);
    let most = [1, 4, 16, 200][rng.random_range(0..4)];
    start..(start + rng.random_range(0..=most)).min(length)
}

/// Where a number stands, if there is one behind a random place.
fn number(bytes: &[u8], rng: &mut dyn Rng) -> Option<std::ops::Range<usize>> {
    let from = rng.random_range(0..=bytes.len());
    let start = from + bytes[from..].iter().position(u8::is_ascii_digit)?;
    let is_part = |b: &u8| b.is_ascii_digit() || b".eE+-_".contains(b);
    let length = bytes[start..].iter().position(|b| !is_part(b));
    Some(start..length.map_or(bytes.len(), |length| start + length))
}

fn mutate(mut bytes: Vec<u8>, other: &[u8], rng: &mut dyn Rng) -> Vec<u8> {
    for _ in 0..rng.random_range(1..=4) {
        let range = span(bytes.len(), rng);
        let token = TOKENS[rng.random_range(0..TOKENS.len())].bytes();
        match rng.random_range(0..9) {
            0 if !range.is_empty() => bytes[range.start] ^= 1 << rng.random_range(0..8),
            1 => drop(bytes.drain(range)),
            2 => {
                let copy = bytes[range.clone()].to_vec();
                bytes.splice(range.end..range.end, copy);
            }
            3 => drop(bytes.splice(range.start..range.start, token)),
            4 => drop(bytes.splice(range, token)),
            5 => {
                let from = span(other.len(), rng);
                bytes.splice(range, other[from].to_vec());
            }
            6 => {
                let times = rng.random_range(1..200);
                let text: Vec<u8> = token.collect::<Vec<_>>().repeat(times);
                bytes.splice(range.start..range.start, text);
            }
            _ => {
                if let Some(number) = number(&bytes, rng) {
                    bytes.splice(number, token);
                }
            }
        }
    }
    bytes
}

/// Reads a file as every kind of file.
fn read(path: &Path, bytes: &[u8], simulates: bool) -> Vec<Error> {
    let source = || Source::from_bytes(path, bytes.to_vec(), "file");
    let mut errors = Vec::new();
    let mut note = |read: Result<()>| errors.extend(read.err());
    note(source().and_then(|source| {
        let robot = Morphology::parse(&source)?;
        let again = Morphology::parse(&Source::new("again.ron", robot.to_ron()?))?;
        assert_eq!(robot, again);
        let _ = (robot.summary(), robot.warnings());
        if simulates && robot.modules().len() < 12 {
            let mut experiment = Experiment::new(robot.assemble());
            experiment.duration_s = 0.05;
            run(&experiment)?;
        }
        Ok(())
    }));
    note(source().and_then(|source| {
        let specimen = Individual::parse(&source)?;
        let again = Individual::parse(&Source::new("again.ron", specimen.to_ron()?))?;
        assert_eq!(specimen, again);
        let _ = specimen.develop();
        Ok(())
    }));
    note(source().and_then(|source| Search::parse(&source, &Default::default()).map(drop)));
    note(Definition::read_without_recordings(path, &Overrides::default()).map(drop));
    note(read_parameters(path).map(drop));
    note(read_noise(path).map(drop));
    note(source().and_then(|source| Reading::parse(&source).map(drop)));
    note(read_meta(path).map(drop));
    note(source().and_then(|source| Arena::parse(&source).map(drop)));
    note(source().and_then(|source| Controller::parse(&source).map(drop)));
    note(source().and_then(|source| Scene::parse(&source).map(drop)));
    note(Vehicle::read(path, None).map(drop));
    note(Camera::read(path).map(drop));
    note(Picture::decode(bytes).map(drop));
    for name in ["arm.urdf", "arm.xml"] {
        let robot = Source::from_bytes(path.with_file_name(name), bytes.to_vec(), "robot");
        note(robot.and_then(|source| import::import(&source, &Options::default()).map(drop)));
    }
    for name in [
        "run.csv",
        "run.tum",
        "run.kitti",
        "run.mcap",
        "run.db3",
        "run.ulg",
        "run.parquet",
        "run.npy",
        "run.npz",
        "run.jsonl",
        "run.tsv",
        "run.json",
    ] {
        let path = path.with_file_name(name);
        let reading = Reading {
            rate_hz: Some(10.0),
            ..Reading::default()
        };
        let read = trajectory::parse_all(&path, bytes.to_vec(), reading);
        note(read.and_then(|all| {
            all.iter()
                .try_for_each(|recording| prepare(&recording.trajectory).map(drop))
        }));
    }
    errors
}

/// One round: one file, mutated and read.
fn round<'a>(
    seed: u64,
    corpus: &'a [(PathBuf, Vec<u8>)],
    folder: &Path,
    simulates: bool,
) -> &'a Path {
    let mut rng = generator(seed, 0);
    let (name, bytes) = &corpus[rng.random_range(0..corpus.len())];
    let (_, other) = &corpus[rng.random_range(0..corpus.len())];
    let mutated = mutate(bytes.clone(), other, &mut rng);
    // Beside links to what studies name.
    let path = folder.join("file.ron");
    std::fs::write(&path, &mutated).unwrap();
    // Under its own name, so that what people run first looks at it, too.
    let own = folder.join(name.file_name().unwrap());
    std::fs::write(&own, &mutated).unwrap();
    let said = catch_unwind(AssertUnwindSafe(|| {
        let mut errors = read(&path, &mutated, simulates);
        errors.extend(InferredReading::of_file(&own, &Reading::default()).err());
        errors
    }));
    std::fs::remove_file(&own).unwrap();
    let shown = || String::from_utf8_lossy(&mutated).into_owned();
    let shown_name = name.display();
    let Ok(errors) = said else {
        panic!("round {seed}, from {shown_name}:\n{}", shown());
    };
    for error in errors {
        let said = error.to_string();
        let steers = |c: char| c != '\n' && !realgap::text::is_plain(c);
        assert!(
            !said.contains(steers) && said.len() < 8000,
            "round {seed}, from {shown_name}: {said:?}"
        );
    }
    name
}

/// Runs rounds, and returns how many mutants of each kind of file there were.
fn rounds(seeds: impl Iterator<Item = u64>, simulates_every: u64) -> BTreeMap<String, usize> {
    let corpus = corpus();
    assert!(corpus.len() > 15, "{}", corpus.len());
    let folder = tempfile::tempdir().unwrap();
    let sweeps = folder.path().join("sweeps");
    std::fs::create_dir(&sweeps).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(
        common::project().join("morphologies"),
        folder.path().join("morphologies"),
    )
    .unwrap();
    let mut counts = BTreeMap::new();
    for seed in seeds {
        let path = round(seed, &corpus, &sweeps, seed.is_multiple_of(simulates_every));
        let ending = path.extension().unwrap_or_default();
        *counts
            .entry(ending.to_string_lossy().into_owned())
            .or_default() += 1;
    }
    counts
}

#[test]
fn a_mutated_file_is_read_or_refused_with_an_error() {
    rounds(FOUND.iter().copied().chain(0..1500), 50);
}

/// The number in an environment variable.
fn asked(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(
        text.parse()
            .unwrap_or_else(|_| panic!("{name} is a whole number, not {text}")),
    )
}

/// Every run has a seed of its own, which is printed and can be given again: `REALGAP_SEED`. `REALGAP_MUTANTS` is the number of mutants;
/// without it they take a minute.
#[test]
#[ignore = "a minute, with other mutants every time; .ci/run runs it"]
fn mutants_of_every_reader_for_a_minute() {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let seed = asked("REALGAP_SEED").unwrap_or_else(|| now.unwrap().as_secs());
    let most = asked("REALGAP_MUTANTS");
    println!("mutants of seed {seed}: REALGAP_SEED={seed} makes them again");
    let begun = std::time::Instant::now();
    let goes_on = |count: u64| match most {
        Some(most) => count < most,
        None => begun.elapsed().as_secs() < 60,
    };
    // Seeds far apart, so that those of two runs are different.
    let first = seed.wrapping_mul(1_000_000_007);
    let seeds = (0..).take_while(|count| goes_on(*count));
    let counts = rounds(seeds.map(|count| first.wrapping_add(count)), 50);
    let all: usize = counts.values().sum();
    println!("{all} mutants were read or refused with an error: {counts:?}");
    assert!(all >= most.map_or(100, |most| most as usize), "{all}");
}
