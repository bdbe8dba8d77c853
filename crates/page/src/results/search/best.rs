//! `best/`: every finalist as a robot, a genome, a model for MuJoCo and a prediction card.

use std::path::Path;

use super::draw::draws;
use super::summary::BestRobot;
use crate::results::write_report;
use realgap_core::error::{Error, Result};
use realgap_core::file::write_atomic;
use realgap_lab::search::{Body, Finalist, Search};
use realgap_robot::genome::Individual;
use realgap_simulation::export::{Robot, format_named};

/// The folder in the results folder.
const FOLDER: &str = "best";
/// Endings of the files of one robot.
const ENDINGS: [&str; 5] = [".ron", ".genome.ron", ".xml", ".json", ".draws.json"];

pub(super) fn write(folder: &Path, search: &Search, finalist: &Finalist) -> Result<BestRobot> {
    let best = folder.join(FOLDER);
    std::fs::create_dir_all(&best).map_err(|e| Error::io("make the folder", &best, &e))?;
    let robot = &finalist.robot;
    let file = format!("{:02}_{}", finalist.finals.rank, robot.name());
    let at = |ending: &str| best.join(format!("{file}{ending}"));
    write_atomic(at(".ron"), robot.to_ron()?.as_bytes())?;
    if let Body::Developed(development) = search.body() {
        let specimen = Individual {
            name: robot.name().to_owned(),
            genome: finalist.evaluated.genome.clone(),
            development: development.clone(),
        };
        write_atomic(at(".genome.ron"), specimen.to_ron()?.as_bytes())?;
    }
    let exported = format_named("mjcf")?.render(&Robot::new(robot, &search.experiment(robot)));
    write_atomic(at(".xml"), exported.text.as_bytes())?;
    write_report(&best, &format!("{file}.json"), &finalist.card())?;
    let draws = draws(search, finalist)?;
    write_report(&best, &format!("{file}.draws.json"), &draws)?;
    Ok(BestRobot::new(file, finalist))
}

/// Whether [`write`] calls a file like this: `best/01_robot_00042.genome.ron`.
pub(in crate::results) fn is_ours(name: &str) -> bool {
    let digits =
        |text: &str, least: usize| text.len() >= least && text.bytes().all(|b| b.is_ascii_digit());
    let file = Path::new(name).strip_prefix(FOLDER).ok();
    let stem = file.and_then(Path::to_str).and_then(|file| {
        let endings = ENDINGS.iter();
        let stems = endings.filter_map(|ending| file.strip_suffix(ending));
        stems.min_by_key(|stem| stem.len())
    });
    let parts = stem.and_then(|stem| stem.split_once("_robot_"));
    parts.is_some_and(|(rank, index)| digits(rank, 2) && digits(index, 5))
}

#[cfg(test)]
mod tests {
    use super::is_ours;

    #[test]
    fn only_what_was_written_is_ours() {
        for ours in ["best/01_robot_00042.ron", "best/10_robot_123456.genome.ron"] {
            assert!(is_ours(ours), "{ours}");
        }
        for other in [
            "01_robot_00042.ron",
            "best/robot_00042.ron",
            "best/01_robot_42.ron",
            "best/01_robot_00042.txt",
            "best/01_robot_mine.json",
            "best/mujoco.json",
        ] {
            assert!(!is_ours(other), "{other}");
        }
    }
}
