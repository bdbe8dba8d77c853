//! Shared parts of the tests of every crate: paths, and notes about data or programs that are not installed.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The project's folder, above the crate whose tests these are.
pub fn project() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut above = here.ancestors();
    above
        .find(|folder| folder.join("sweeps").is_dir())
        .unwrap_or(here)
}

/// Output as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The real recordings, which are not part of the repository; prints a note where they are absent.
///
/// # Panics
/// Where they are absent and `REALGAP_REQUIRE_DATA` is set, so that tests cannot pass without the data.
pub fn shared_data(folder: &str) -> Option<PathBuf> {
    let path = project().join("../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    assert!(
        !is_set("REALGAP_REQUIRE_DATA"),
        "{} is not here, and REALGAP_REQUIRE_DATA is set",
        path.display()
    );
    skipped(&format!("{} is not here", path.display()));
    None
}

/// Whether an environment variable is set and not empty.
fn is_set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty())
}

/// Whether `REALGAP_LONG` enables the longest tests, as in `.ci/run`; prints a note where it does not.
pub fn is_long_run(what: &str) -> bool {
    let is_asked = is_set("REALGAP_LONG");
    if !is_asked {
        skipped(&format!("{what}: long, runs where REALGAP_LONG is set"));
    }
    is_asked
}

/// A study file in `folder` with this body inside `Study( … )`.
pub fn study(folder: &Path, body: &str) -> PathBuf {
    let path = folder.join("study.ron");
    std::fs::write(&path, format!("Study(\n{body}\n)\n")).unwrap();
    path
}

/// The contacts and joints that the tripod's own stand-ins were recorded with (as sweeps/tripod_self.ron), for a study
/// file: the fit has the same model, at a quarter of the cost of the defaults.
pub const STANDIN_NUMERICS: &str = "timestep_s: 0.004166666666666667,
    substeps: 8,
    joint: Impulse,
    set: {
        \"contact.natural_frequency_hz\": 60,
        \"contact.damping_ratio\": 10,
        \"solver.sweeps\": 1,
    },";

/// A quick study: the tripod for some tenths of a second on a small grid, with cheap numerics, against shipped stand-ins.
pub fn quick_study(folder: &Path, points: usize) -> PathBuf {
    study_of_tripod(folder, points, "")
}

/// The same with one run a point, for tests of everything but scores.
pub fn crude_study(folder: &Path, points: usize) -> PathBuf {
    study_of_tripod(folder, points, "score: Single,")
}

fn study_of_tripod(folder: &Path, points: usize, more: &str) -> PathBuf {
    let root = project().display();
    study(
        folder,
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    {STANDIN_NUMERICS}
    start: Settled,
    duration_s: 0.25,
    {more}
    parameters: [
        (name: \"floor.friction\", from: 0.1, to: 0.9, points: {points}),
        (name: \"floor.restitution\", from: 0.0, to: 0.8, points: {points}),
    ],"
        ),
    )
}

/// A Python that can import this package and numpy (`REALGAP_PYTHON`, else `python3`); prints a note where there is none.
pub fn python_with(package: &str) -> Option<String> {
    let python = std::env::var("REALGAP_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let importable = std::process::Command::new(&python)
        .args(["-c", &format!("import {package}, numpy")])
        .output()
        .is_ok_and(|done| done.status.success());
    if !importable {
        skipped(&format!(
            "{python} cannot import {package} and numpy (tools/requirements-*.txt, REALGAP_PYTHON)"
        ));
    }
    importable.then_some(python)
}

/// Prints that a test did nothing, also where it passes.
pub fn skipped(reason: &str) {
    use std::io::Write as _;
    // Not `eprintln!`, which the test harness hides where a test passes.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}

/// Every file below a folder but `timing.json`, which alone may differ between equal runs.
pub fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(some) = folders.pop() {
        for entry in std::fs::read_dir(&some).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != "timing.json") {
                let name = path.strip_prefix(folder).unwrap().to_path_buf();
                all.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    all
}

/// The folders hold the same files, byte for byte.
///
/// # Panics
/// Where they do not.
pub fn must_be_equal(whole: &Path, other: &Path) {
    let (whole, other) = (files(whole), files(other));
    assert_eq!(
        whole.keys().collect::<Vec<_>>(),
        other.keys().collect::<Vec<_>>()
    );
    for (name, bytes) in &whole {
        assert!(other[name] == *bytes, "{} differs", name.display());
    }
}

/// Reference values of other programs for the tests of this crate.
pub fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// A text file of a results folder.
pub fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file))
        .unwrap_or_else(|e| panic!("{}: {e}", folder.join(file).display()))
}
