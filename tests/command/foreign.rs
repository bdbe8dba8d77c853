//! Untrusted files: no content is skipped silently, controls a terminal or leads out of a folder.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{STANDIN_NUMERICS, project, quick_study, realgap, text};
use realgap::calibration::{Definition, Overrides, Study, read_parameters};
use realgap::file::Source;
use realgap::robot::genome::Individual;
use realgap::robot::morphology::Morphology;
use realgap::search::Search;
use realgap::store::{Fingerprint, Store, Trial};

/// A study whose recordings are copies in a folder of its own.
fn study_of_copies(folder: &Path, glob: &str) -> PathBuf {
    let runs = folder.join("runs");
    std::fs::create_dir(&runs).unwrap();
    let shipped = project().join("real_trajectories/tripod_standin");
    for name in ["run_00.csv", "run_01.csv", "meta.ron"] {
        std::fs::copy(shipped.join(name), runs.join(name)).unwrap();
    }
    std::fs::write(runs.join("README.md"), "What these are.").unwrap();
    common::study(
        folder,
        &format!(
            "morphology: \"{}/morphologies/tripod.ron\",
    recordings: [\"runs/{glob}\"],
    start: Settled,
    duration_s: 0.5,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
            project().display()
        ),
    )
}

#[cfg(unix)]
#[test]
fn every_match_of_recordings_counts_or_is_an_error_that_names_it() {
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let study = study_of_copies(folder.path(), "*");
    let runs = folder.path().join("runs");
    let count =
        || Study::read(&study, &Overrides::default()).map(|s| s.definition().recordings.len());
    assert_eq!(count().unwrap(), 2);
    symlink(runs.join("run_01.csv"), runs.join("run_02.csv")).unwrap();
    assert_eq!(count().unwrap(), 3);
    type Spoil = fn(&Path);
    let spoils: [(&str, Spoil); 5] = [
        ("gone.csv", |at| symlink("nowhere", at).unwrap()),
        ("loop.csv", |at| symlink(at, at).unwrap()),
        ("folder.csv", |at| std::fs::create_dir(at).unwrap()),
        ("notes.txt", |at| {
            std::fs::write(at, "not a recording").unwrap()
        }),
        ("pipe.csv", |at| {
            let made = std::process::Command::new("mkfifo").arg(at).status();
            assert!(made.unwrap().success());
        }),
    ];
    for (name, spoil) in spoils {
        let at = runs.join(name);
        spoil(&at);
        let error = count().unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
        // The command prints the same error and does nothing.
        let out = folder.path().join("out");
        let mut sweep = realgap();
        sweep.arg("sweep").arg(&study).arg("-o").arg(&out);
        let said = sweep.assert().code(1);
        assert!(text(&said.get_output().stderr).contains(name));
        assert!(!out.exists());
        let _ = std::fs::remove_file(&at);
        let _ = std::fs::remove_dir(&at);
    }
    let unreadable = runs.join(std::ffi::OsStr::from_bytes(b"run_\xff.csv"));
    std::fs::write(&unreadable, "").unwrap();
    let error = count().unwrap_err().to_string();
    assert!(error.contains("not UTF-8"), "{error}");
    std::fs::remove_file(&unreadable).unwrap();
    assert_eq!(count().unwrap(), 3);
    // A meta.ron that cannot be read is an error.
    std::fs::remove_file(runs.join("meta.ron")).unwrap();
    symlink("nowhere", runs.join("meta.ron")).unwrap();
    let error = count().unwrap_err().to_string();
    assert!(error.contains("meta.ron"), "{error}");
}

#[test]
fn names_that_lead_out_of_a_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let sound = std::fs::read_to_string(quick_study(folder.path(), 2)).unwrap();
    let long = format!("{}.ron", "x".repeat(101));
    for name in [
        "...ron",
        "-x.ron",
        ".ron",
        " x.ron",
        "a\nb.ron",
        "a\u{1b}[2J.ron",
        &long,
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, &sound).unwrap();
        let refused = Definition::read(&path, &Overrides::default()).unwrap_err();
        assert!(
            refused.to_string().contains("not a usable name"),
            "{refused}"
        );
        // The command prints the error without control characters, and makes no folder.
        let said = realgap().arg("sweep").arg("--").arg(&path).assert().code(1);
        let error = text(&said.get_output().stderr);
        assert!(
            !error.contains('\u{1b}') && error.matches("error:").count() == 1,
            "{error}"
        );
        std::fs::remove_file(&path).unwrap();
        let search = Source::new(
            folder.path().join(name),
            "Search(strategy: Evolution(population: 2, generations: 1, elites: 0), duration_s: 0.1)",
        );
        assert!(
            Search::parse(&search, &Default::default()).is_err(),
            "{name}"
        );
    }
    let robot = Morphology::read(project().join("morphologies/cube.ron")).unwrap();
    for name in ["../x", "-x", "", "a b"] {
        let named = robot
            .to_ron()
            .unwrap()
            .replacen("\"cube\"", &format!("{name:?}"), 1);
        assert!(
            Morphology::parse(&Source::new("robot.ron", named)).is_err(),
            "{name}"
        );
        assert!(Study::builder(name, robot.clone()).build().is_err());
        let genome = format!(
            "Genome(name: {name:?}, modules: 1, genes: [[{}]])",
            ["0.5"; 10].join(", ")
        );
        let refused = Individual::parse(&Source::new("genome.ron", genome)).unwrap_err();
        assert!(refused.to_string().contains("name"), "{refused}");
    }
}

#[test]
fn a_key_that_is_given_twice_is_an_error_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    let sound = std::fs::read_to_string(&study).unwrap();
    let sound = sound.replace(STANDIN_NUMERICS, "");
    for map in ["set", "truth"] {
        let twice = sound.replace(
            "    start: Settled,",
            &format!("    {map}: {{\n\"gravity_m_s2\": 9.8,\n\"gravity_m_s2\": 1.6 }},\n    start: Settled,"),
        );
        std::fs::write(&study, twice).unwrap();
        let error = Definition::read(&study, &Overrides::default()).unwrap_err();
        assert!(
            error.message().contains("`gravity_m_s2` is given twice"),
            "{error}"
        );
        assert!(error.line_column().is_some());
    }
    let best = folder.path().join("best.ron");
    std::fs::write(
        &best,
        "(parameters: {\"floor.friction\": 0.4, \"floor.friction\": 0.5})",
    )
    .unwrap();
    let error = read_parameters(&best).unwrap_err().to_string();
    assert!(error.contains("given twice"), "{error}");
    let search = Source::new(
        "search.ron",
        "Search(strategy: Evolution(population: 2, generations: 1, elites: 0), duration_s: 0.1, \
         set: {\"floor.friction\": 0.4, \"floor.friction\": 0.5})",
    );
    let error = Search::parse(&search, &Default::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("given twice"), "{error}");
}

#[test]
fn no_content_of_a_file_controls_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    let evil = "\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\u{202e}";
    let files = [
        put("robot.ron", &format!("(name: \"{evil}\", modules: [])")),
        put("key.ron", &format!("(parameters: {{\"{evil}\": 1.0}})")),
        put("field.ron", "(modules: [], gl\u{9b}ue: [])"),
        put(
            "meta.ron",
            &format!(
                "(robot: \"{evil}\", source: Real, description: \"{evil}\", frame: \"x\", licence: \"x\")"
            ),
        ),
        put(
            "column.csv",
            &format!("t_s,x_m,{evil}\n0,0,0\n1,1,1\n2,2,2\n"),
        ),
        put("value.csv", &format!("t_s,x_m,y_m\n0,{evil},0\n")),
        put(
            "condition.csv",
            &format!("condition,run,t_s,x_m,y_m\n{evil},1,0,0,0\n{evil},1,1,1,1\n{evil},1,2,2,2\n"),
        ),
    ];
    let words = "ab ".repeat(100_000);
    let long = [
        put("long.ron", &format!("(name: \"{words}\", modules: [])")),
        put(
            "long_meta.ron",
            &format!(
                "(robot: \"{words}\", source: Real, description: \"{words}\", frame: \"{words}\", licence: \"x\")"
            ),
        ),
        put(
            "long_condition.csv",
            &format!(
                "condition,run,t_s,x_m,y_m\n{words},1,0,0,0\n{words},1,1,1,1\n{words},1,2,2,2\n"
            ),
        ),
    ];
    for path in files.iter().chain(&long) {
        for format in ["table", "json"] {
            let mut check = realgap();
            check.arg("check").arg(path).args(["--format", format]);
            let said = check.output().unwrap();
            let said = text(&said.stdout) + &text(&said.stderr);
            let steers = |c: char| c != '\n' && (c.is_control() || c == '\u{202e}');
            assert!(!said.contains(steers), "{}: {said:?}", path.display());
            // JSON is not cut.
            assert!(
                said.len() < 8000 || format == "json",
                "{}: {} bytes",
                path.display(),
                said.len()
            );
        }
    }
    let compared = realgap()
        .args(["gap", "--recordings"])
        .arg(folder.path().join("condition.csv"))
        .output()
        .unwrap();
    let said = text(&compared.stdout) + &text(&compared.stderr);
    assert!(
        !said.contains(['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}']),
        "{said:?}"
    );
}

#[test]
fn a_foreign_picture_is_not_replaced_and_an_own_picture_is_drawn_again() {
    let folder = tempfile::tempdir().unwrap();
    let runs =
        ["run_00.csv", "run_01.csv"].map(|run| format!("real_trajectories/tripod_standin/{run}"));
    for name in ["a.png", "a.svg"] {
        let plot = folder.path().join(name);
        std::fs::write(&plot, "mine").unwrap();
        let draw = || {
            let mut compare = realgap();
            compare.arg("compare").args(&runs).arg("--plot").arg(&plot);
            compare.output().unwrap()
        };
        let refused = draw();
        assert!(text(&refused.stderr).contains("--force"), "{refused:?}");
        assert_eq!(common::read(folder.path(), name), "mine");
        std::fs::remove_file(&plot).unwrap();
        for _ in 0..2 {
            let drawn = draw();
            assert!(drawn.status.success(), "{}", text(&drawn.stderr));
        }
    }
}

#[test]
fn foreign_files_are_never_replaced_or_removed() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    let run = |out: &Path, more: &[&str]| {
        let mut sweep = realgap();
        sweep.arg("sweep").arg(&study).arg("-o").arg(out).args(more);
        sweep.output().unwrap()
    };
    // A file with the name of a result, in a folder without results.
    let out = folder.path().join("mine");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("best.ron"), "mine").unwrap();
    for more in [&[][..], &["--restart"]] {
        let refused = run(&out, more);
        assert_eq!(refused.status.code(), Some(1));
        assert!(text(&refused.stderr).contains("best.ron"));
    }
    assert_eq!(common::read(&out, "best.ron"), "mine");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);
    // A foreign database, which --restart must not delete.
    let out = folder.path().join("database");
    std::fs::create_dir(&out).unwrap();
    rusqlite::Connection::open(out.join("results.sqlite"))
        .unwrap()
        .execute_batch("CREATE TABLE diary (day TEXT); INSERT INTO diary VALUES ('today')")
        .unwrap();
    let before = std::fs::read(out.join("results.sqlite")).unwrap();
    let refused = run(&out, &["--restart"]);
    assert_eq!(refused.status.code(), Some(1), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(out.join("results.sqlite")).unwrap(), before);
    // Other files in a results folder are kept, also when the results are deleted.
    let out = folder.path().join("shared");
    assert!(run(&out, &[]).status.success());
    for name in ["notes.txt", "heatmap_of_mine.png", "best.txt"] {
        std::fs::write(out.join(name), "mine").unwrap();
    }
    assert!(run(&out, &["--restart"]).status.success());
    for name in ["notes.txt", "heatmap_of_mine.png", "best.txt"] {
        assert_eq!(common::read(&out, name), "mine");
    }
}

#[test]
fn values_that_are_too_large_are_refused_with_the_allowed_range() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2).display().to_string();
    let search = folder.path().join("search.ron");
    std::fs::write(
        &search,
        "Search(strategy: Evolution(population: 1000000000000, generations: 1000000000000, elites: 0), duration_s: 0.1)",
    )
    .unwrap();
    let search = search.display().to_string();
    for (args, words) in [
        (vec!["sweep", &study, "--jobs", "100000"], "1 to "),
        (vec!["sweep", &study, "--jobs", "0"], "1 to "),
        (
            vec!["tune", &study, "--budget", "18446744073709551615"],
            "at most 1000000",
        ),
        (vec!["search", &search], "at most 1000000"),
        (
            vec![
                "simulate",
                "morphologies/cube.ron",
                "--duration",
                "3600",
                "--timestep",
                "0.000001",
            ],
            "hours",
        ),
    ] {
        let refused = realgap()
            .args(&args)
            .args(["--format", "json"])
            .output()
            .unwrap();
        let error = text(&refused.stderr);
        assert!(
            !refused.status.success() && error.contains(words),
            "{args:?}: {error}"
        );
    }
}

#[test]
fn check_estimates_the_time_of_any_study_from_a_part_of_a_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 100);
    let slow = std::fs::read_to_string(&study).unwrap().replace(
        STANDIN_NUMERICS,
        "timestep_s: 0.000001,\n    substeps: 256,",
    );
    std::fs::write(&study, slow).unwrap();
    let said = realgap()
        .arg("check")
        .arg(&study)
        .args(["--format", "json"])
        .assert()
        .success();
    let report: serde_json::Value = serde_json::from_slice(&said.get_output().stdout).unwrap();
    let cpu_s = report[0]["contents"]["cpu_s"].as_f64().unwrap();
    // A single point of this study takes hours, and it has ten thousand.
    assert!(cpu_s > 1e6, "{cpu_s}");
}

#[test]
fn implausible_values_get_a_warning_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("robot.ron");
    std::fs::write(
        &robot,
        r#"(
            name: "odd",
            defaults: (side_m: 0.06, mass_kg: 0.1, servo: (law: Velocity(gain_1_s: 20.0), max_torque_nm: 0.5)),
            modules: [
                (name: "tail", kind: Active(face: PosX, axis: Tangent(axis: PosY),
                    gait: (amplitude_rad: 2.0, frequency_hz: 60.0))),
                (name: "head", kind: Passive(mass_kg: 200.0)),
            ],
            glue: [(parent: "tail", face: PosX, child: "head")],
        )"#,
    )
    .unwrap();
    let said = realgap()
        .arg("simulate")
        .arg(&robot)
        .args(["--duration", "0.1", "--set", "body.com_offset_x_m=0.05"])
        .output()
        .unwrap();
    let said = text(&said.stderr);
    for (code, change) in [
        ("bent-too-far", "amplitude_rad"),
        ("mass-ratio", "check the masses"),
        ("unlikely-mass", "kilograms"),
        ("gait-too-fast", "timestep_s"),
        ("centre-of-mass-outside", "body.com_offset_x_m"),
    ] {
        let line = said.lines().find(|line| line.contains(code));
        assert!(
            line.is_some_and(|line| line.contains(change)),
            "{code}: {said}"
        );
    }
}

#[test]
fn an_untrusted_store_controls_neither_the_terminal_nor_a_spreadsheet() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::<Trial>::create(folder.path(), &Fingerprint::new()).unwrap();
    let list = |name: &str| serde_json::json!([name]).to_string();
    store
        .describe([
            ("kind", "sweep\u{1b}[2J".to_owned()),
            ("study", "x\u{7}\u{202e}".repeat(200)),
            ("metric", "\u{9b}31m".to_owned()),
            ("unit", "=cmd|' /C calc'!A0".to_owned()),
            ("parameters", list("@SUM(1)\r")),
            ("recordings", list("=1+1")),
        ])
        .unwrap();
    store
        .insert(&[Trial {
            index: 0,
            values: vec![-1.5],
            cases: Vec::new(),
        }])
        .unwrap();
    drop(store);
    let list = |format: &str| {
        let mut command = realgap();
        command.args(["study", "results"]).arg(folder.path());
        let said = command
            .args(["--per-recording", "--format", format])
            .assert();
        text(&said.success().get_output().stdout)
    };
    let table = list("table");
    assert!(
        table.contains("\\u{1b}[2J") && table.contains(" ..."),
        "{table}"
    );
    let steers = |c: char| c != '\n' && (c.is_control() || c == '\u{202e}');
    assert!(!table.contains(steers), "{table:?}");
    let csv = list("csv");
    for words in ["'=cmd", "'@SUM", "-1.5"] {
        assert!(csv.contains(words), "{csv}");
    }
    for cell in csv.lines().flat_map(|line| line.split(',')) {
        assert!(!cell.trim_matches('"').starts_with(['=', '@']), "{csv}");
    }
}
