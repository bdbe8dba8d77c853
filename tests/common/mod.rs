//! What the integration tests share.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "every test binary uses its own part")]

pub mod browser;
pub mod ron;
pub mod schema;
mod shared;

use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::Command;

pub use shared::*;

/// The command, started in the project's folder.
pub fn realgap() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_realgap"));
    command.current_dir(project());
    command
}

/// Starts the command in the project's folder; its output is read later.
pub fn start(args: &[&str]) -> Child {
    std::process::Command::new(env!("CARGO_BIN_EXE_realgap"))
        .args(args)
        .current_dir(project())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Starts a command that writes a folder, on one thread.
pub fn start_on_one_thread(command: &str, file: &Path, out: &Path) -> Child {
    let [file, out] = [file, out].map(|path| path.to_str().unwrap());
    start(&[command, file, "--jobs", "1", "-o", out])
}

/// A search file in `folder` with this body inside `Search( … )`.
pub fn search_file(folder: &Path, body: &str) -> PathBuf {
    let path = folder.join("quick.ron");
    std::fs::write(&path, format!("Search(\n{body}\n)\n")).unwrap();
    path
}

/// The body of a search that takes seconds.
pub const SMALL_SEARCH: &str = "strategy: Evolution(population: 6, generations: 3, variation: (max_modules: 3)), duration_s: 1.0, repeats: 3,
    parameters: [(name: \"floor.friction\", low: 0.4, high: 0.6)],
    finalists: (count: 2, repeats: 5),";

/// The summary of a results folder.
pub fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&read(folder, "summary.json")).unwrap()
}

/// Waits until the store holds at least `count` points.
pub fn wait_for_points(folder: &Path, count: usize) {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(60) {
        if let Ok(store) = realgap::store::Store::<realgap::store::Trial>::look(folder)
            && store
                .finished()
                .is_ok_and(|finished| finished.len() >= count)
        {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no {count} points in {} after a minute", folder.display());
}
