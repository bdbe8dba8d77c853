//! The README does what it says: every command in it is run, in its order, beside the examples that the program holds. Grids and the search are
//! smaller than there.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::project;
use crate::tutorial::{commands, shell};

/// Whole commands, one a line; those that build something are left out, as other tests are those builds.
fn programs(readme: &str) -> Vec<String> {
    let lines = commands(readme).concat().replace("\\\n", " ");
    let lines = lines.lines().map(|line| {
        let (command, _comment) = line.split_once("   #").unwrap_or((line, ""));
        command.trim().replace("cargo run --release --", "realgap")
    });
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("cargo "))
        .collect()
}

#[test]
fn every_command_of_the_readme_works_with_the_shipped_examples() {
    if !crate::common::is_long_run("the commands of the README") {
        return;
    }
    let readme = std::fs::read_to_string(project().join("README.md")).unwrap();
    let programs = programs(&readme);
    assert!(programs.len() >= 20, "{programs:?}");
    let folder = tempfile::tempdir().unwrap();
    shell("realgap study examples copy .", folder.path());
    let search = folder.path().join("sweeps/best_robot.ron");
    let few = [
        ("initial: 60", "initial: 20"),
        ("batch: 10", "batch: 2"),
        ("evaluations: 160", "evaluations: 22"),
        ("runs: 40, duration_s: 4.0", "runs: 8, duration_s: 2.0"),
        ("least: 0.5", "least: 0.05"),
        ("duration_s: 20.0", "duration_s: 6.0"),
        ("count: 5, repeats: 12", "count: 1, repeats: 6"),
    ];
    let small = few.iter().fold(
        std::fs::read_to_string(&search).unwrap(),
        |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        },
    );
    std::fs::write(&search, small).unwrap();
    for program in programs {
        assert!(program.starts_with("realgap "), "{program}");
        let fewer = match program.split_whitespace().nth(1) {
            Some("sweep") => " --points 3",
            Some("tune") => " --budget 40",
            Some("gap" | "predict") => " --repeats 8",
            _ => "",
        };
        let begun = std::time::Instant::now();
        shell(&format!("{program}{fewer}"), folder.path());
        println!("{:5.1} s  {program}{fewer}", begun.elapsed().as_secs_f64());
    }
    for made in [
        "results/cube_toss/report.html",
        "replay.html",
        "study.ron",
        "radio.ron",
    ] {
        assert!(folder.path().join(made).exists(), "nothing wrote {made}");
    }
}
