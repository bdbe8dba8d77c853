//! `best/`: every finalist as a robot, a genome, a model for MuJoCo and a prediction card.

use std::path::Path;

use super::draw::draws;
use super::remove;
use super::summary::BestRobot;
use crate::error::{Error, Result};
use crate::export::{Robot, format_named};
use crate::file::write_atomic;
use crate::results::write_report;
use crate::robot::genome::Specimen;
use crate::search::{Body, Finalist, Search};

/// The folder in the results folder.
const FOLDER: &str = "best";
/// What the files of one robot end with.
const ENDINGS: [&str; 5] = [".ron", ".genome.ron", ".xml", ".json", ".draws.json"];

pub(super) fn write(folder: &Path, search: &Search, finalist: &Finalist) -> Result<BestRobot> {
    let best = folder.join(FOLDER);
    std::fs::create_dir_all(&best).map_err(|e| Error::io("make the folder", &best, &e))?;
    let robot = &finalist.robot;
    let file = format!("{:02}_{}", finalist.finals.rank, robot.name());
    let at = |ending: &str| best.join(format!("{file}{ending}"));
    write_atomic(at(".ron"), robot.to_ron()?.as_bytes())?;
    if let Body::Developed(development) = search.body() {
        let specimen = Specimen {
            name: robot.name().to_owned(),
            genome: finalist.evaluated.genome.clone(),
            development: development.clone(),
        };
        write_atomic(at(".genome.ron"), specimen.to_ron()?.as_bytes())?;
    }
    let exported = format_named("mjcf")?.render(&Robot::new(robot, &search.experiment(robot)));
    write_atomic(at(".xml"), exported.text.as_bytes())?;
    write_report(&best, &format!("{file}.json"), &finalist.card())?;
    write_report(
        &best,
        &format!("{file}.draws.json"),
        &draws(search, finalist)?,
    )?;
    Ok(BestRobot::new(file, finalist))
}

/// Removes the robots of an earlier search: none must outlive it.
pub(super) fn remove_others(folder: &Path, kept: &[BestRobot]) -> Result<()> {
    let best = folder.join(FOLDER);
    let Ok(entries) = std::fs::read_dir(&best) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let stem = ENDINGS
            .iter()
            .filter_map(|ending| name.strip_suffix(ending))
            .find(|stem| is_ours(stem));
        if stem.is_some_and(|stem| kept.iter().all(|robot| robot.file != stem)) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Whether a file is called as [`write`] calls one: `01_robot_00042`.
fn is_ours(stem: &str) -> bool {
    let digits =
        |text: &str, least: usize| text.len() >= least && text.bytes().all(|b| b.is_ascii_digit());
    stem.split_once("_robot_")
        .is_some_and(|(rank, index)| digits(rank, 2) && digits(index, 5))
}

#[cfg(test)]
mod tests {
    use super::is_ours;

    #[test]
    fn only_what_was_written_is_ours() {
        assert!(is_ours("01_robot_00042") && is_ours("10_robot_123456"));
        for other in [
            "robot_00042",
            "01_robot_42",
            "01_robot_00042.genome",
            "01_robot_mine",
        ] {
            assert!(!is_ours(other), "{other}");
        }
    }
}
