//! Files of other formats, as the tools of these formats write and read them.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;
mod joint_log;
#[cfg(feature = "parquet")]
mod lerobot;
mod log;
mod parquet;
mod text;
mod tool;
mod ulog;

use std::path::{Path, PathBuf};

use common::text;
use realgap::trajectory::Recording;
use realgap::warning::Code;

/// Runs Python in `folder`; the script is to do something there.
fn python(program: &str, folder: &Path, script: &str) {
    let done = std::process::Command::new(program)
        .args(["-c", script])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", text(&done.stderr));
}

fn put(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn codes(recording: &Recording) -> Vec<Code> {
    recording.warnings.iter().map(|w| w.code).collect()
}
