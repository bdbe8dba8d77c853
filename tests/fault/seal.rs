//! Checksums of a results folder: every command that reads a changed file refuses it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{quick_study, realgap, text};
use rand::RngExt;
use realgap::search::generator;

/// The folder of a small sweep, and its study.
fn swept(folder: &Path) -> (PathBuf, String) {
    let study = quick_study(folder, 3).display().to_string();
    let out = folder.join("out");
    let args = ["sweep", &study, "--score", "single", "-o"];
    realgap().args(args).arg(&out).assert().success();
    (out, study)
}

fn say(words: &[&str]) -> (bool, String) {
    let said = realgap().args(words).output().unwrap();
    (
        said.status.success(),
        text(&said.stdout) + &text(&said.stderr),
    )
}

/// The commands that read this file of the folder; pictures are read by the page only.
fn readers(out: &str, study: &str, file: &str) -> Vec<Vec<String>> {
    let mut all = vec![vec!["report", out], vec!["study", "results", out]];
    let at = format!("{out}/{file}");
    let page = format!("{out}/../replay.html");
    let noise = format!("{out}/../noise.ron");
    let repeats = ["--noise", &noise, "--repeats", "2", "-o"];
    let other = format!("{out}/../other");
    let evaluated = ["evaluate", study, "--parameters", &at];
    let ensemble = ["ensemble", study, "--model-error", "on", "--posterior", out];
    let search = format!("{out}/../quick.ron");
    let searched = ["search", &search, "--posterior", out, "-o", &other];
    match file {
        "best.ron" => {
            all.push(evaluated.to_vec());
            all.push(vec!["replay", &at, "-o", &page]);
        }
        "indistinguishable.csv" => {
            all.push([&ensemble[..], &repeats[..], &[&other]].concat());
            all.push(searched.to_vec());
        }
        _ => {}
    }
    let owned = |words: Vec<&str>| words.into_iter().map(str::to_owned).collect();
    all.into_iter().map(owned).collect()
}

#[test]
fn every_command_refuses_a_changed_digit_a_lost_line_and_a_lost_file() {
    let folder = tempfile::tempdir().unwrap();
    common::search_file(folder.path(), common::SMALL_SEARCH);
    let noise = "(start_heading_rad: Normal(0.02))";
    std::fs::write(folder.path().join("noise.ron"), noise).unwrap();
    let (out, study) = swept(folder.path());
    let name = out.to_str().unwrap();
    let sealed = std::fs::read_to_string(out.join("SHA256SUMS")).unwrap();
    let files: Vec<&str> = sealed.lines().skip(1).map(|l| &l[66..]).collect();
    for expected in [
        "points.csv",
        "best.ron",
        "page.json",
        "report.html",
        "heatmap.png",
    ] {
        assert!(files.contains(&expected), "{expected}: {sealed}");
    }
    assert!(say(&["report", name]).0 && say(&["study", "results", name]).0);
    for (number, file) in [
        "points.csv",
        "page.json",
        "best.ron",
        "indistinguishable.csv",
        "SHA256SUMS",
    ]
    .iter()
    .enumerate()
    {
        let path = out.join(file);
        let whole = std::fs::read(&path).unwrap();
        let mut rng = generator(30, number as u64);
        let digits: Vec<usize> = (0..whole.len())
            .filter(|i| whole[*i].is_ascii_digit())
            .collect();
        let at = digits[rng.random_range(0..digits.len())];
        let mut changed = whole.clone();
        changed[at] = b'0' + (changed[at] - b'0' + 1) % 10;
        let lines: Vec<&[u8]> = whole.split_inclusive(|b| *b == b'\n').collect();
        let shorter = lines[..lines.len() - 1].concat();
        for damaged in [changed, shorter] {
            std::fs::write(&path, damaged).unwrap();
            for words in readers(name, &study, file) {
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                let (fine, said) = say(&words);
                assert!(!fine, "{file}, {words:?}: {said}");
                assert!(
                    said.contains(file) && said.contains("--accept"),
                    "{file}, {words:?}: {said}"
                );
            }
        }
        std::fs::write(&path, whole).unwrap();
    }
    // The page is not made without what only `page.json` holds, unless this is accepted; the answer needs none of it.
    let kept = std::fs::read(out.join("page.json")).unwrap();
    std::fs::remove_file(out.join("page.json")).unwrap();
    let (fine, said) = say(&["report", name]);
    assert!(
        !fine && said.contains("page.json") && said.contains("--accept"),
        "{said}"
    );
    assert!(say(&["study", "results", name]).0);
    std::fs::write(out.join("page.json"), kept).unwrap();
    // Without checksums, changes cannot be detected, so the folder is refused.
    std::fs::remove_file(out.join("SHA256SUMS")).unwrap();
    let (fine, said) = say(&["report", name]);
    assert!(!fine && said.contains("no SHA256SUMS"), "{said}");
    let (fine, said) = say(&[
        "search",
        &format!("{name}/../quick.ron"),
        "--posterior",
        name,
    ]);
    assert!(!fine && said.contains("--accept"), "{said}");
    // The command itself writes the changed files again, and `report --accept` accepts an intended change.
    realgap()
        .args(["sweep", &study, "--score", "single", "-o"])
        .arg(&out)
        .assert()
        .success();
    assert_eq!(
        std::fs::read_to_string(out.join("SHA256SUMS")).unwrap(),
        sealed
    );
    let best = std::fs::read_to_string(out.join("best.ron")).unwrap();
    std::fs::write(out.join("best.ron"), format!("// Mine.\n{best}")).unwrap();
    std::fs::remove_file(out.join("heatmap.png")).unwrap();
    assert!(!say(&["report", name]).0);
    assert!(say(&["report", name, "--accept"]).0);
    assert!(say(&["report", name]).0 && say(&["study", "results", name]).0);
}
