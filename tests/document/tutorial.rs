//! Every command of the tutorial is run, in its order, in an empty folder.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;
use std::process::Command;

fn tutorial() -> String {
    std::fs::read_to_string(common::project().join("docs/start.md")).unwrap()
}

/// Fenced blocks of the language `sh`.
pub fn commands(page: &str) -> Vec<&str> {
    page.split("```sh\n")
        .skip(1)
        .map(|rest| rest.split_once("```").unwrap().0)
        .collect()
}

/// Runs lines of a shell in a folder, with the program of these tests as `realgap`.
pub fn shell(lines: &str, folder: &Path) {
    let binary = Path::new(env!("CARGO_BIN_EXE_realgap")).parent().unwrap();
    let search_path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap());
    let output = Command::new("bash")
        .args(["-euo", "pipefail", "-c", lines])
        .current_dir(folder)
        .env("PATH", &search_path)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{lines}\n{}{}",
        common::text(&output.stdout),
        common::text(&output.stderr)
    );
}

/// Files that the text, outside of the commands, sends its reader to.
fn promised(page: &str) -> Vec<&str> {
    let inline = page.split("```").step_by(2);
    let quoted = inline.flat_map(|text| text.split('`').skip(1).step_by(2));
    quoted
        .filter(|name| name.starts_with("results/") || name.ends_with("robot.png"))
        .collect()
}

#[test]
fn every_command_works_and_writes_the_files_that_the_text_names() {
    if !common::is_long_run("the commands of the tutorial") {
        return;
    }
    let page = tutorial();
    let blocks = commands(&page);
    assert!(blocks.len() >= 10, "{} blocks", blocks.len());
    let folder = tempfile::tempdir().unwrap();
    for block in blocks {
        shell(block, folder.path());
    }
    let promised = promised(&page);
    assert!(promised.len() >= 8, "{promised:?}");
    for file in promised {
        assert!(folder.path().join(file).exists(), "nothing wrote {file}");
    }
    let meta = common::read(folder.path(), "recordings/meta.ron");
    assert!(meta.contains("StandIn"), "{meta}");
}

#[test]
fn every_step_of_the_way_is_in_it() {
    let page = tutorial();
    let run: String = commands(&page).concat();
    for step in [
        "check",
        "simulate",
        "study record",
        "gap",
        "compare",
        "study sensitivity",
        "sweep",
        "study results",
        "tune",
        "ensemble",
        "predict",
        "search",
    ] {
        assert!(
            run.lines()
                .any(|line| line.starts_with(&format!("realgap {step} "))),
            "the tutorial does not run {step}"
        );
    }
}
