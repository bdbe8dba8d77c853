//! Builds stores with finished results for the tests, and changes stores directly by SQL.
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::path::Path;

use realgap_store::{
    CaseOutcome, CaseResult, CaseRow, Fingerprint, RobotOutcome, RobotRow, STORE_FILE, Store,
    TravelRow, Trial, TrialScore,
};

pub fn fingerprint() -> Fingerprint {
    Fingerprint::new().with("realgap", "1").with("points", 40)
}

pub fn trial(index: usize) -> Trial {
    let outcome = |case: usize| CaseRow {
        steps: 480 + index as u64,
        outcome: if (index + case).is_multiple_of(7) {
            CaseOutcome::Diverged(format!("part {case} left the world"))
        } else {
            CaseOutcome::Completed(CaseResult {
                net_displacement_m: 0.1 * index as f64,
                scores: vec![0.01 * index as f64; 3],
                path_xy_m: (0..30).map(|i| [0.1 * i as f64, index as f64]).collect(),
            })
        },
    };
    Trial {
        index,
        values: vec![0.3, index as f64],
        cases: (0..3).map(outcome).collect(),
    }
}

pub fn score(index: usize) -> TrialScore {
    TrialScore {
        index,
        score: (!index.is_multiple_of(7)).then_some(1.0 / (1.0 + index as f64)),
        displacement_error_m: Some(0.02),
        recordings: vec![0.1, 0.2],
    }
}

pub fn robot(index: usize) -> RobotRow {
    let travel = |repeat: usize| TravelRow {
        displacement_m: 0.1 * repeat as f64,
        path_length_m: 0.3,
        turned_rad: -0.1,
        servo_j: (!repeat.is_multiple_of(2)).then_some(2.5),
    };
    RobotRow {
        index,
        genome: (0..30).map(|i| (i as f64 / 30.0).sin()).collect(),
        outcome: if index.is_multiple_of(5) {
            RobotOutcome::Failed {
                reason: "toppled".to_owned(),
                seen: "it lies on its side".to_owned(),
            }
        } else {
            RobotOutcome::Walked {
                fitness: 0.2 * index as f64,
                repeats: (0..8).map(travel).collect(),
                descriptors: vec![3.0, 0.5],
            }
        },
    }
}

/// Writes the results of a finished study into this folder.
pub fn study(folder: &Path) {
    let mut store = Store::create(folder, &fingerprint()).unwrap();
    let list = |names: &[&str]| serde_json::json!(names).to_string();
    store
        .describe([
            ("kind", "sweep".to_owned()),
            ("study", "floor".to_owned()),
            ("metric", "rms".to_owned()),
            ("unit", "m".to_owned()),
            ("parameters", list(&["floor.friction", "floor.restitution"])),
            ("recordings", list(&["a", "b"])),
        ])
        .unwrap();
    for index in 0..40 {
        store.insert(&[trial(index)]).unwrap();
    }
    let scores: Vec<TrialScore> = (0..40).map(score).collect();
    store.insert_scores(&scores).unwrap();
    store.complete().unwrap();
}

/// Writes the results of a finished search into this folder.
pub fn search(folder: &Path) {
    let mut store = Store::create(folder, &fingerprint()).unwrap();
    store
        .describe([
            ("kind", "search".to_owned()),
            ("search", "best".to_owned()),
            ("objective", "displacement, mean".to_owned()),
            ("unit", "m".to_owned()),
            (
                "descriptors",
                serde_json::json!(["modules", "height_m"]).to_string(),
            ),
        ])
        .unwrap();
    let robots: Vec<RobotRow> = (0..60).map(robot).collect();
    store.insert(&robots).unwrap();
    store.complete().unwrap();
}

/// Changes a store directly by SQL, without updating its checksums.
pub fn tamper(folder: &Path, sql: &str) {
    let connection = rusqlite::Connection::open(folder.join(STORE_FILE)).unwrap();
    connection.execute_batch(sql).unwrap();
}
