//! Any file is read or refused with an error: no panic, no endless message, no control of the terminal.
//!
//! Shipped files are mutated and read again, as what they are and as what they are not. Every round has a seed of its own and can
//! be repeated; those that once found a fault stay in `FOUND`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use rand::{Rng, RngExt};
use realgap::calibration::{Definition, Overrides, read_noise, read_parameters};
use realgap::file::Source;
use realgap::robot::genome::{Genome, Individual};
use realgap::robot::morphology::Morphology;
use realgap::search::{Search, generator};
use realgap::simulation::{Experiment, run};
use realgap::trajectory::{self, Reading, prepare, read_meta};
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

/// The largest file of the corpus, bytes; of longer ones the start.
const LONGEST: usize = 6000;

fn corpus() -> Vec<(PathBuf, Vec<u8>)> {
    let root = common::project();
    let mut files = Vec::new();
    for folder in [
        "morphologies",
        "sweeps",
        "real_trajectories",
        "real_trajectories/tripod_standin",
    ] {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(root.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| {
                path.extension()
                    .is_some_and(|e| e == "ron" || e == "csv" || e == "tum")
            })
            .collect();
        paths.sort();
        paths.truncate(12);
        for path in paths {
            let mut bytes = std::fs::read(&path).unwrap();
            if bytes.len() > LONGEST {
                let end = bytes[..LONGEST].iter().rposition(|b| *b == b'\n').unwrap();
                bytes.truncate(end + 1);
            }
            files.push((path, bytes));
        }
    }
    let genome = Genome::random(4, &mut generator(1, 0)).unwrap();
    let genome = Individual::new("four", genome).to_ron().unwrap();
    files.push((root.join("sweeps/genome.ron"), genome.into_bytes()));
    let more = [
        (
            "best.ron",
            "(description: \"best\", parameters: {\"floor.friction\": 0.4, \"gravity_m_s2\": 9.8})",
        ),
        (
            "noise.ron",
            "(start_heading_rad: Normal(0.02), servo_latency_s: Uniform(0.0, 0.02), mass_relative: LogNormal(0.02))",
        ),
        (
            "run.tum",
            "0 0 0 0 0 0 0 1\n0.1 0.1 0 0 0 0 0 1\n0.2 0.2 0 0 0 0 0 1\n",
        ),
        (
            "poses.kitti",
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n",
        ),
        (
            "data.csv",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n0,1,2,3,1,0,0,0\n2000,1,2,4,1,0,0,0\n",
        ),
        (
            "set.csv",
            "condition,run,t_s,x_m,y_m\na,1,0,0,0\na,1,1,1,1\na,1,2,2,1\nb,1,0,0,0\nb,1,1,1,0\nb,1,2,3,0\n",
        ),
        (
            "run.jsonl",
            "{\"t\": 0, \"position\": [0, 1, 2], \"q\": {\"pan\": 1}}\n{\"t\": 0.1, \"position\": [0.1, 1, 2], \"q\": {\"pan\": 2}}\n",
        ),
        (
            "juggled.csv",
            "__time,/a/cmd,/odom/x,/odom/y\n0,,0,0\n0.1,1,,\n0.2,,1,1\n0.3,,2,2\n",
        ),
        (
            "vicon.csv",
            "TRAJECTORIES\n100,Hz\n,a:b,,\nField #,X,Y,Z\n1,1,2,3\n2,2,2,3\n3,3,2,3\n",
        ),
    ];
    // A log of PX4: header, one structure, one topic, two messages.
    let mut log = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let messages: [(u8, &[u8]); 4] = [
        (
            b'F',
            b"vehicle_local_position:uint64_t timestamp;float x;float y;float z;",
        ),
        (b'A', b"\0\0\0vehicle_local_position"),
        (b'D', &[0; 22]),
        (
            b'D',
            &[
                0, 0, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 0, 0,
            ],
        ),
    ];
    for (kind, body) in messages {
        log.extend([body.len() as u8, 0, kind]);
        log.extend(body);
    }
    files.push((root.join("sweeps/run.ulg"), log));
    files.extend(
        more.map(|(name, text)| (root.join("sweeps").join(name), text.as_bytes().to_vec())),
    );
    files
}

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
fn round(seed: u64, corpus: &[(PathBuf, Vec<u8>)], folder: &Path, simulates: bool) {
    let mut rng = generator(seed, 0);
    let (name, bytes) = &corpus[rng.random_range(0..corpus.len())];
    let (_, other) = &corpus[rng.random_range(0..corpus.len())];
    let mutated = mutate(bytes.clone(), other, &mut rng);
    // Beside links to what studies name.
    let path = folder.join("file.ron");
    std::fs::write(&path, &mutated).unwrap();
    let said = catch_unwind(AssertUnwindSafe(|| read(&path, &mutated, simulates)));
    let shown = || String::from_utf8_lossy(&mutated).into_owned();
    let name = name.display();
    let Ok(errors) = said else {
        panic!("round {seed}, from {name}:\n{}", shown());
    };
    for error in errors {
        let said = error.to_string();
        let steers = |c: char| c != '\n' && !realgap::text::is_plain(c);
        assert!(
            !said.contains(steers) && said.len() < 8000,
            "round {seed}, from {name}: {said:?}"
        );
    }
}

fn rounds(seeds: impl Iterator<Item = u64>, simulates_every: u64) {
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
    for seed in seeds {
        round(seed, &corpus, &sweeps, seed % simulates_every == 0);
    }
}

#[test]
fn a_mutated_file_is_read_or_refused_with_an_error() {
    rounds(FOUND.iter().copied().chain(0..1500), 50);
}

#[test]
#[ignore = "minutes; the short one runs always"]
fn many_mutated_files_are_read_or_refused_with_an_error() {
    rounds(1500..200_000, 20);
}
