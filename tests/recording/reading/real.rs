//! Correct recordings get no warnings: shipped stand-ins, and real recordings where they are installed.

use realgap::calibration::{Definition, Overrides};
use realgap::trajectory::{Recording, Source, read_all, read_meta_beside};
use realgap::unit::LengthUnit;
use realgap::warning::Code;

use super::common::{project, shared_data};

/// Warnings that doubt a recording.
const DOUBTS: [Code; 9] = [
    Code::DuplicateSamples,
    Code::Hole,
    Code::LostSamples,
    Code::QuaternionOrder,
    Code::SamplesSorted,
    Code::SeveralRobots,
    Code::Standstill,
    Code::UnlikelyLength,
    Code::UnlikelyTime,
];

fn doubted(all: &[Recording]) -> Vec<String> {
    let warnings = all.iter().flat_map(|r| &r.warnings);
    let doubts = warnings.filter(|w| DOUBTS.contains(&w.code));
    doubts.map(ToString::to_string).collect()
}

#[test]
fn nothing_is_doubted_of_the_shipped_stand_ins() {
    let root = project().join("real_trajectories");
    let mut count = 0;
    for folder in std::fs::read_dir(&root).unwrap() {
        let folder = folder.unwrap().path();
        // Of real recordings some are rightly doubted: a run of a wheeled robot has a hole.
        let meta = read_meta_beside(&folder.join("run.csv")).unwrap();
        if meta.is_none_or(|meta| meta.source == Source::Real) {
            continue;
        }
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "csv") {
                let doubts = doubted(&read_all(&path, LengthUnit::Metre).unwrap());
                assert!(doubts.is_empty(), "{}: {doubts:?}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= 40);
    // Nor by a study, which knows how large the robot is.
    for name in ["tripod_floor", "tripod_self"] {
        let path = project().join(format!("sweeps/{name}.ron"));
        let definition = Definition::read(path, &Overrides::default()).unwrap();
        assert!(!definition.warnings.iter().any(|w| DOUBTS.contains(&w.code)));
    }
}

#[test]
fn nothing_is_doubted_of_real_tosses() {
    let Some(folder) = shared_data("cube_tosses") else {
        return;
    };
    let glob = folder.join("*.csv").display().to_string();
    let overrides = Overrides {
        recordings: vec![glob],
        ..Overrides::default()
    };
    let study = project().join("sweeps/cube_toss_fit.ron");
    let definition = Definition::read(study, &overrides).unwrap();
    assert!(definition.recordings.len() > 300);
    let doubts: Vec<_> = definition
        .warnings
        .iter()
        .filter(|w| DOUBTS.contains(&w.code))
        .collect();
    assert!(doubts.is_empty(), "{doubts:?}");
}

#[test]
fn of_real_runs_of_a_wheeled_robot_only_true_holes_are_doubted() {
    let Some(folder) = shared_data("two_wheel_runs") else {
        return;
    };
    let all = read_all(folder.join("runs.csv"), LengthUnit::Metre).unwrap();
    assert_eq!(all.len(), 74);
    let doubts = doubted(&all);
    // Two of the runs whose notes call them failed: nothing for 0.5 and 0.7 s, six and eight usual intervals.
    assert_eq!(doubts.len(), 2, "{doubts:?}");
    for (doubt, run) in doubts.iter().zip(["us_bayesian/0", "us_bayesian/1"]) {
        assert!(doubt.contains(run) && doubt.contains("[hole]"), "{doubt}");
    }
}
