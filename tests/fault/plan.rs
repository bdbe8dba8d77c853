//! A run cut into shards ends with the bytes of one machine's, whatever happens to the shards on the way.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{SMALL_SEARCH, files, must_be_equal, quick_study, realgap, search_file, text};
use realgap::store::{Fingerprint, Store, Trial};

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for (name, bytes) in files(from) {
        std::fs::write(to.join(name), bytes).unwrap();
    }
}

/// Runs the command with these words; its exit code, and all that it said.
fn say(words: &[&str]) -> (i32, String) {
    let mut command = realgap();
    if ["run", "merge", "status"].contains(&words[0]) {
        command.arg("cluster");
    }
    let said = command.args(words).output().unwrap();
    let all = text(&said.stdout) + &text(&said.stderr);
    (said.status.code().unwrap(), all)
}

fn fine(words: &[&str]) -> String {
    let (code, said) = say(words);
    assert_eq!(code, 0, "{words:?}: {said}");
    said
}

/// Runs all shards of every round, each in a process of its own and in turn on one thread and two, and merges. How many rounds
/// there were.
fn run_to_the_end(plan: &str) -> usize {
    for round in 0..40 {
        let pending = fine(&["status", plan, "--pending"]);
        if pending.is_empty() {
            assert!(!fine(&["status", plan, "--answered"]).is_empty());
            return round;
        }
        // The last begins.
        for (number, shard) in [2, 0, 1].iter().enumerate() {
            let (shard, jobs) = (shard.to_string(), (number % 2 + 1).to_string());
            fine(&["run", plan, "--shard", &shard, "--jobs", &jobs]);
        }
        fine(&["merge", plan, "--jobs", "2"]);
    }
    panic!("{plan} has no end");
}

/// The same run on one machine and in three shards. How many rounds the latter took.
fn same_bytes(folder: &Path, command: &str, file: &Path, options: &[&str]) -> usize {
    let whole = folder.join(format!("{command}_whole"));
    let plan = folder.join(format!("{command}_plan"));
    let (file, plan_name) = (file.to_str().unwrap(), plan.to_str().unwrap());
    let mut words = vec![command, file, "-o", whole.to_str().unwrap()];
    words.extend(options);
    fine(&words);
    let mut words = vec![
        "plan",
        file,
        "--as",
        command,
        "--shards",
        "3",
        "--no-measure",
    ];
    words.extend(["-o", plan_name, "--"]);
    words.extend(options);
    fine(&words);
    let rounds = run_to_the_end(plan_name);
    must_be_equal(&whole, &plan.join("results"));
    rounds
}

#[test]
fn a_sweep_in_shards_leaves_the_bytes_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    // The grid, and waves of what may be the best.
    assert_eq!(same_bytes(folder.path(), "sweep", &study, &[]), 4);
}

/// Robots with recordings, values and weights of their own, in every shard.
#[test]
fn a_sweep_of_many_robots_in_shards_leaves_the_bytes_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = common::project().join("real_trajectories/fleet_mujoco");
    let robot = |name: &str, more: &str| {
        let own = fleet.join(name);
        let (file, runs) = (own.join("robot.ron"), own.join("*.csv"));
        format!("(morphology: {file:?}, recordings: [{runs:?}], {more})")
    };
    let robots = [
        robot("random_0005", "weight: 2.0"),
        robot("random_0022", "set: {\"body.mass_scale\": 1.1}"),
        robot("random_0068", ""),
    ];
    let study = folder.path().join("fleet.ron");
    let text = format!(
        "Study(robots: [{}], start: Settled, duration_s: 1.0, metric: \"displacement\",
        parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 4)])",
        robots.join(", ")
    );
    std::fs::write(&study, text).unwrap();
    assert!(same_bytes(folder.path(), "sweep", &study, &[]) > 0);
    let summary = folder.path().join("sweep_plan/results/summary.json");
    let summary = std::fs::read_to_string(summary).unwrap();
    assert!(summary.contains("\"transfer\""), "{summary}");

    // The page shows the counts of the summary, and no others.
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let page = folder.path().join("sweep_plan/results/report.html");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, table) = page
        .rsplit_once("How many robots do what was recorded")
        .unwrap();
    let (table, _) = table.split_once("</table>").unwrap();
    let rows: Vec<&str> = table.split("<tr>").skip(2).collect();
    let kinds = ["within_floor", "alike", "goes_nowhere", "other_path"];
    assert_eq!(rows.len(), kinds.len(), "{table}");
    for (kind, row) in kinds.iter().zip(rows) {
        let count = &summary["reproduction"][kind]["count"];
        assert!(row.contains(&format!("{count} of 3<")), "{kind}: {row}");
    }
}

#[test]
fn a_tuning_in_shards_leaves_the_bytes_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 5);
    let options = ["--metric", "rms", "--budget", "32", "--score", "single"];
    let rounds = same_bytes(folder.path(), "tune", &study, &options);
    assert!(rounds > 1, "one batch only");
}

#[test]
fn a_search_in_shards_leaves_the_bytes_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let search = search_file(folder.path(), SMALL_SEARCH);
    // One a generation.
    assert_eq!(same_bytes(folder.path(), "search", &search, &[]), 3);
}

#[test]
fn repeats_in_shards_leave_the_bytes_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    let noise = folder.path().join("noise.ron");
    std::fs::write(
        &noise,
        "Noise(servo_phase_rad: Normal(0.1), start_tilt_rad: Normal(0.0175))",
    )
    .unwrap();
    let noise = noise.to_str().unwrap();
    for command in ["ensemble", "gap"] {
        let options = ["--repeats", "7", "--noise", noise];
        assert_eq!(same_bytes(folder.path(), command, &study, &options), 1);
    }
}

/// A plan of nine points in three shards, one run a point, with shards 0 and 1 run.
fn two_of_three(folder: &Path) -> (PathBuf, String) {
    let study = quick_study(folder, 3);
    let plan = folder.join("plan");
    let name = plan.to_str().unwrap().to_owned();
    let words = [
        "plan",
        study.to_str().unwrap(),
        "--shards",
        "3",
        "-o",
        &name,
    ];
    let said = fine(&[&words[..], &["--", "--score", "single", "--metric", "rms"]].concat());
    assert!(
        said.contains("runs of") && said.contains("CPU each"),
        "{said}"
    );
    fine(&["run", &name, "--shard", "0-1"]);
    (plan, name)
}

#[test]
fn what_is_missing_twice_there_damaged_or_of_others_is_named_and_the_rest_is_merged() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, name) = two_of_three(folder.path());
    let round = plan.join("shards/round_0000");
    // Missing: shard 2.
    let (code, said) = say(&["merge", &name]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("3 of 9 rows are missing"), "{said}");
    assert!(
        said.contains(&format!("realgap cluster run {name} --shard 2")),
        "{said}"
    );
    assert_eq!(fine(&["status", &name, "--pending"]).trim(), "2");

    // Twice there: shard 1 under another name. Nothing changes.
    copy(&round.join("shard_00001"), &round.join("shard_00001_copy"));
    let (_, said) = say(&["merge", &name]);
    assert!(said.contains("9 were known to the bit"), "{said}");
    std::fs::remove_dir_all(round.join("shard_00001_copy")).unwrap();

    // Damaged: a byte of shard 2.
    fine(&["run", &name, "--shard", "2"]);
    let store = round.join("shard_00002/results.sqlite");
    let whole = std::fs::read(&store).unwrap();
    let mut damaged = whole.clone();
    let table = text(&whole).len().min(whole.len()) / 2;
    for byte in &mut damaged[table..table + 64] {
        *byte ^= 0x55;
    }
    std::fs::write(&store, damaged).unwrap();
    let (code, said) = say(&["merge", &name]);
    assert!(code == 1 && said.contains("shard_00002"), "{said}");
    assert!(
        said.contains("damaged") || said.contains("malformed"),
        "{said}"
    );

    // Of another version of the program.
    std::fs::remove_dir_all(round.join("shard_00002")).unwrap();
    let other = Fingerprint::new().with("realgap", "0.0.1");
    drop(Store::<Trial>::create(&round.join("shard_00002"), &other).unwrap());
    let (code, said) = say(&["merge", &name]);
    assert!(code == 1 && said.contains("stored 0.0.1"), "{said}");
    let (code, said) = say(&["run", &name, "--shard", "2"]);
    assert!(code == 1 && said.contains("stored 0.0.1"), "{said}");

    // Done at last, with the note of the round lost.
    std::fs::remove_dir_all(round.join("shard_00002")).unwrap();
    fine(&["run", &name, "--shard", "2"]);
    std::fs::remove_file(plan.join("round.json")).unwrap();
    let said = fine(&["merge", &name, "--tidy"]);
    assert!(said.contains("3 new rows merged"), "{said}");
    assert!(plan.join("results/best.ron").exists());
    assert!(!round.exists());
    assert!(fine(&["status", &name]).contains("complete, 9 rows"));
    // Once more, and nothing happens.
    fine(&["merge", &name]);
    assert!(fine(&["run", &name, "--shard", "1"]).contains("nothing is left"));
}

#[test]
fn a_study_that_changes_under_its_plan_is_noticed_by_the_shard() {
    let folder = tempfile::tempdir().unwrap();
    let (_, name) = two_of_three(folder.path());
    let study = folder.path().join("study.ron");
    let changed = std::fs::read_to_string(&study)
        .unwrap()
        .replace("to: 0.9", "to: 0.8");
    std::fs::write(&study, changed).unwrap();
    let (code, said) = say(&["run", &name, "--shard", "2"]);
    assert_eq!(code, 1);
    assert!(
        said.contains("parameter floor.friction") && said.contains("plan.json"),
        "{said}"
    );
}

#[test]
fn wrong_numbers_and_options_are_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, name) = two_of_three(folder.path());
    let study = folder.path().join("study.ron");
    let study = study.to_str().unwrap();
    for (words, said) in [
        (vec!["run", &name, "--shard", "3"], "0 to 2"),
        (vec!["run", &name, "--shard", "-1"], "whole numbers from 0"),
        (
            vec!["plan", study, "--shards", "0", "-o", "x"],
            "1 to 100000",
        ),
        (
            vec!["plan", study, "--shards", "2", "-o", "x", "--", "--resume"],
            "decides this itself",
        ),
        (
            vec![
                "plan",
                study,
                "--shards",
                "2",
                "-o",
                "x",
                "--",
                "--polits=3",
            ],
            "--polits",
        ),
        (vec!["plan", study, "-o", "x"], "--shards"),
    ] {
        let (code, all) = say(&words);
        assert!(code == 2 && all.contains(said), "{words:?}: {code} {all}");
    }
    assert!(!common::project().join("x").exists());
    let (code, said) = say(&["merge", study]);
    assert!(code == 1, "{said}");
    let (code, said) = say(&[
        "run",
        plan.parent().unwrap().to_str().unwrap(),
        "--shard",
        "0",
    ]);
    assert!(code == 1 && said.contains("no plan here"), "{said}");
}
