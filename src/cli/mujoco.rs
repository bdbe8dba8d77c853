//! Runs the finalists of a search in MuJoCo, too, with the script tools/rerun_finalists.py.

use std::process::Command;

use realgap::prediction::Rerun;
use realgap::search::{Finalist, Search, rank};
use serde::Deserialize;

use super::kit::*;

/// The scripts, compiled into the program.
const SCRIPTS: [(&str, &str); 2] = [
    (
        "rerun_finalists.py",
        include_str!("../../tools/rerun_finalists.py"),
    ),
    ("standin.py", include_str!("../../tools/standin.py")),
];

/// The script's result for one robot.
#[derive(Debug, Deserialize)]
struct Seen {
    robot: String,
    realgap_m: Vec<f64>,
    mujoco_m: Vec<f64>,
}

#[derive(Debug, Deserialize)]
struct Said {
    robots: Vec<Seen>,
}

/// Runs the finalists whose files are in `folder` in MuJoCo with this Python, and ranks them again: a robot whose displacement
/// differs too much there does not survive.
pub fn rerun(
    python: &str,
    folder: &Path,
    search: &Search,
    finalists: Vec<Finalist>,
) -> Result<Vec<Finalist>> {
    let scratch = std::env::temp_dir().join(format!("realgap-mujoco-{}", std::process::id()));
    std::fs::create_dir_all(&scratch)
        .map_err(|e| Error::io("make a folder for the script", &scratch, &e))?;
    let said = run(python, folder, &scratch);
    // A failure is ignored, because the folder is temporary.
    let _removed = std::fs::remove_dir_all(&scratch);
    let said = said?;
    let reruns = finalists.into_iter().map(|finalist| {
        // Files are named by rank and robot.
        let ending = format!("_{}", finalist.robot.name());
        let seen = said
            .robots
            .iter()
            .find(|seen| seen.robot.ends_with(&ending));
        let rerun = rerun_of(seen, search.finals().tolerance);
        finalist.with_rerun(rerun)
    });
    Ok(rank(reruns.collect()))
}

/// Runs the script.
fn run(python: &str, folder: &Path, scratch: &Path) -> Result<Said> {
    for (name, text) in SCRIPTS {
        realgap::file::write_atomic(scratch.join(name), text.as_bytes())?;
    }
    let said = scratch.join("mujoco.json");
    let done = Command::new(python)
        .arg(scratch.join(SCRIPTS[0].0))
        .arg(folder)
        .arg("--output")
        .arg(&said)
        .output();
    let remedy =
        "python3 -m pip install mujoco numpy, or name a Python that has them: --mujoco=PYTHON";
    let done = done.map_err(|e| {
        Error::invalid(format!("{python} cannot be started: {e}"))
            .field("--mujoco")
            .hint(remedy)
    })?;
    if !done.status.success() {
        let last = String::from_utf8_lossy(&done.stderr);
        let last = last.lines().rfind(|line| !line.trim().is_empty());
        return Err(Error::invalid("the finalists did not run in MuJoCo")
            .field("--mujoco")
            .found(last.unwrap_or("no message").to_owned())
            .hint(remedy));
    }
    let text =
        std::fs::read_to_string(&said).map_err(|e| Error::io("read what MuJoCo did", &said, &e))?;
    serde_json::from_str(&text)
        .map_err(|e| Error::invalid(format!("the script's answer cannot be read: {e}")))
}

fn rerun_of(seen: Option<&Seen>, tolerance: f64) -> Rerun {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let means = seen.map(|seen| (mean(&seen.realgap_m), mean(&seen.mujoco_m)));
    let change = means
        .map(|(here_m, there_m)| there_m / here_m - 1.0)
        .filter(|change| change.is_finite());
    Rerun {
        settings: "MuJoCo",
        mean_displacement_m: means.map(|(_, there_m)| there_m).filter(|m| m.is_finite()),
        change,
        failure: change
            .is_none()
            .then(|| "no draw could be compared".to_owned()),
        survives: change.is_some_and(|change| change.abs() <= tolerance),
    }
}
