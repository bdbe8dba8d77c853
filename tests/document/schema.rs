//! Files and answers are valid by their schemas.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use common::ron::as_json;
use common::schema::{answer, held, schema};
use common::{SMALL_SEARCH, project, quick_study, realgap, search_file, text};
use serde_json::Value;

/// Validates a RON or JSON file by the schema of its kind.
fn file_held(kind: &str, text: &str) -> Result<(), String> {
    let schema = schema(&format!("files/{kind}"));
    let value = match text.trim_start().starts_with('{') {
        true => serde_json::from_str(text).unwrap(),
        false => as_json(text, &schema),
    };
    held(&schema, &value).map_err(|fault| format!("{fault} in {value}"))
}

fn ron_files(folder: &str) -> Vec<PathBuf> {
    let pattern = project().join(folder).join("*.ron");
    let files = glob::glob(pattern.to_str().unwrap()).unwrap();
    files.map(Result::unwrap).collect()
}

/// The kind of a shipped file, by its place and its first word.
fn kind_of(file: &Path, text: &str) -> String {
    let folder = file
        .parent()
        .unwrap()
        .file_name()
        .unwrap()
        .to_str()
        .unwrap();
    let first = text.lines().find(|line| !line.starts_with("//")).unwrap();
    let stem = file.file_stem().unwrap().to_str().unwrap();
    match folder {
        "templates" => stem.to_owned(),
        "sweeps" if first.starts_with("Study") => "study".to_owned(),
        "sweeps" if first.starts_with("Search") => "search".to_owned(),
        "sweeps" => "parameters".to_owned(),
        "morphologies" if text.contains("bodies: [") => "bodies".to_owned(),
        "morphologies" => "robot".to_owned(),
        _ if stem == "meta" => "meta".to_owned(),
        other => other.trim_end_matches('s').to_owned(),
    }
}

#[test]
fn shipped_files_are_valid_by_their_schemas() {
    let mut kinds = BTreeSet::new();
    for folder in [
        "assets/templates",
        "arenas",
        "controllers",
        "morphologies",
        "radios",
        "real_trajectories/*",
        "scenes",
        "sensors",
        "sweeps",
        "vehicles",
    ] {
        for file in ron_files(folder) {
            let text = std::fs::read_to_string(&file).unwrap();
            let kind = kind_of(&file, &text);
            if let Err(fault) = file_held(&kind, &text) {
                panic!("{}: {fault}", file.display());
            }
            kinds.insert(kind);
        }
    }
    let expected = [
        "arena",
        "bodies",
        "controller",
        "meta",
        "noise",
        "parameters",
        "radio",
        "robot",
        "scene",
        "search",
        "sensor",
        "study",
        "vehicle",
    ];
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), expected);
}

#[test]
fn schemas_refuse_wrong_fields_and_values() {
    let robot = std::fs::read_to_string(project().join("morphologies/tripod.ron")).unwrap();
    assert!(file_held("robot", &robot).is_ok());
    for (good, bad) in [
        ("name:", "nam:"),
        ("mass_kg: ", "mass_kg: \"heavy\", mass_g: "),
        ("Active(", "Lively("),
        ("PosX", "Posx"),
    ] {
        let wrong = robot.replacen(good, bad, 1);
        assert_ne!(wrong, robot, "{good}");
        assert!(file_held("robot", &wrong).is_err(), "{bad}");
    }
}

/// The output of a command, which must succeed.
fn run(args: &[&str]) -> String {
    let output = realgap().args(args).output().unwrap();
    assert!(
        output.status.success(),
        "{args:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

#[test]
fn answers_about_robots_and_paths_are_valid_by_their_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let robot = "morphologies/tripod.ron";
    let simulated = path("run.csv");
    let (genome, runs) = (path("genome.ron"), path("runs"));
    let json = |args: &[&str]| run(&[args, &["--format", "json"]].concat());

    answer("parameters", &json(&["study", "parameters"]));
    answer(
        "genome",
        &json(&["robot", "genome", "random", "-o", &genome]),
    );
    file_held("genome", &std::fs::read_to_string(&genome).unwrap()).unwrap();
    answer("develop", &json(&["robot", "develop", &genome]));
    let (urdf, imported) = (path("tripod.urdf"), path("imported.ron"));
    run(&["robot", "export", robot, "--format", "urdf", "-o", &urdf]);
    answer(
        "import",
        &json(&["robot", "import", &urdf, "-o", &imported]),
    );
    let wrong = path("wrong.ron");
    let doubled = std::fs::read_to_string(&genome)
        .unwrap()
        .replacen("modules: 3", "modules: 4", 1);
    std::fs::write(&wrong, doubled).unwrap();
    let shipped = |folder: &str| {
        let files = ron_files(folder).into_iter();
        files.map(|file| file.to_str().unwrap().to_owned())
    };
    let mut all: Vec<String> = vec![
        genome.clone(),
        wrong,
        "real_trajectories/tripod_standin/run_00.csv".to_owned(),
    ];
    for folder in [
        "arenas",
        "controllers",
        "morphologies",
        "sensors",
        "vehicles",
        "real_trajectories/tripod_standin",
    ] {
        all.extend(shipped(folder));
    }
    all.push("sweeps/best_robot.ron".to_owned());
    all.push("sweeps/cube_toss_best.ron".to_owned());
    let mut args = vec!["check", "--format", "json"];
    args.extend(all.iter().map(String::as_str));
    let checked = realgap().args(&args).output().unwrap();
    let reports = answer("check", &text(&checked.stdout));
    let sound = reports
        .as_array()
        .unwrap()
        .iter()
        .filter(|report| report["ok"] == true);
    assert_eq!(sound.count(), all.len() - 1, "{reports}");
    answer(
        "simulate",
        &json(&[
            "simulate",
            robot,
            "--duration",
            "1",
            "--energy",
            "-o",
            &simulated,
        ]),
    );
    let recorded = json(&[
        "study",
        "record",
        robot,
        "--duration",
        "1",
        "--repeats",
        "2",
        "-o",
        &runs,
    ]);
    answer("record", &recorded);
    let runs = [0, 1].map(|number| format!("{runs}/run_0{number}.csv"));
    let [first, second] = &runs;
    let basis = path("basis.json");
    answer(
        "compare",
        &json(&["compare", first, second, &simulated, "--save-basis", &basis]),
    );
    file_held("basis", &std::fs::read_to_string(&basis).unwrap()).unwrap();
    answer(
        "compare-metric",
        &json(&[
            "compare", first, second, "--metric", "dtw", "--basis", &basis,
        ]),
    );
    let both = format!("{}/run_0*.csv", path("runs"));
    answer("floor", &json(&["gap", "--recordings", &both]));
    let set = |robot: &str| {
        let runs = format!("real_trajectories/{robot}_mujoco/run_0[0-4].csv");
        project().join(runs).display().to_string()
    };
    let (first_set, second_set) = (set("tripod"), set("two_module"));
    let between = ["gap", "--between", &first_set, "--and", &second_set];
    answer("between", &json(&between));
    answer("verify", &json(&["verify", "--joint", "multibody"]));
    answer(
        "belief",
        &json(&["sense", "belief", "infrared", "--trials", "3"]),
    );
    let log = path("sensed.csv");
    run(&["sense", "draw", "infrared", "--readings", "20", "-o", &log]);
    let model = path("model.ron");
    answer("sensor-fit", &json(&["sense", "fit", &log, "-o", &model]));
    file_held("sensor", &std::fs::read_to_string(&model).unwrap()).unwrap();
}

#[test]
fn answers_and_files_of_studies_and_searches_are_valid_by_their_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let study = quick_study(folder.path(), 3);
    let noisy = std::fs::read_to_string(&study).unwrap().replacen(
        "start: Settled,",
        "start: Settled, score: Single, noise: Noise(start_heading_rad: Normal(0.02)),",
        1,
    );
    std::fs::write(&study, noisy).unwrap();
    let study = study.to_str().unwrap();
    let json = |args: &[&str]| run(&[args, &["--format", "json"]].concat());
    let left = |out: &str, name: &str| std::fs::read_to_string(Path::new(out).join(name)).unwrap();

    let sweep = path("sweep");
    let said = json(&["sweep", study, "-o", &sweep, "--no-report"]);
    answer("sweep", &said);
    assert_eq!(left(&sweep, "summary.json").trim(), said.trim());
    file_held("parameters", &left(&sweep, "best.ron")).unwrap();
    file_held("basis", &left(&sweep, "basis.json")).unwrap();
    answer("results", &json(&["study", "results", &sweep]));
    let tune = path("tune");
    answer(
        "sweep",
        &json(&[
            "tune",
            study,
            "-o",
            &tune,
            "--budget",
            "26",
            "--metric",
            "rms",
            "--no-report",
        ]),
    );
    answer("results", &json(&["study", "results", &tune]));
    answer("sensitivity", &json(&["study", "sensitivity", study]));
    let floor = [
        "--set",
        "floor.friction=0.4",
        "--set",
        "floor.restitution=0.2",
    ];
    answer(
        "evaluate",
        &json(&[&["evaluate", study], &floor[..]].concat()),
    );
    let repeats = |command: &str, out: &str| {
        let args = [command, study, "-o", out, "--repeats", "8", "--no-report"];
        json(&[&args, &floor[..]].concat())
    };
    let [ensemble, gap] = ["ensemble", "gap"].map(&path);
    answer("ensemble", &repeats("ensemble", &ensemble));
    answer("ensemble", &left(&ensemble, "ensemble.json"));
    answer("gap", &repeats("gap", &gap));
    answer("gap", &left(&gap, "gap.json"));
    let card = json(&[
        "predict",
        "morphologies/tripod.ron",
        "--duration",
        "1",
        "--repeats",
        "8",
    ]);
    answer("predict", &card);

    let search = search_file(folder.path(), SMALL_SEARCH);
    file_held("search", &std::fs::read_to_string(&search).unwrap()).unwrap();
    let best = path("best");
    let search = search.to_str().unwrap();
    answer(
        "search",
        &json(&["search", search, "-o", &best, "--no-report"]),
    );
    answer("search", &left(&best, "summary.json"));
    answer("results", &json(&["study", "results", &best]));

    pictures(folder.path());

    let plan = path("plan");
    answer(
        "status",
        &json(&["cluster", "plan", study, "-o", &plan, "--shards", "2"]),
    );
    file_held("plan", &left(&plan, "plan.json")).unwrap();
    run(&["cluster", "run", &plan, "--shard", "0"]);
    answer("status", &json(&["cluster", "status", &plan]));
}

/// A small camera in the shipped room, found from pictures of another.
fn pictures(folder: &Path) {
    let room = std::fs::read_to_string(project().join("scenes/room.ron")).unwrap();
    let (before, rest) = room.split_once("cameras: {").unwrap();
    let (_, views) = rest.split_once("views: [").unwrap();
    let model = "resolution_px: (160, 120), exposure_s: 0.016, electrons_per_cd_s: 3400, gain: 1.5";
    let cameras = format!(
        "cameras: {{ \"model\": ({model}), \"standin\": (stand_in: true, blur_px: 0.5, {model}) }},\n    views: ["
    );
    let scene = folder.join("room.ron");
    std::fs::write(&scene, format!("{before}{cameras}{views}")).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (real, found) = (path("real"), path("camera.ron"));
    let scene = scene.to_str().unwrap();
    run(&[
        "sense", "picture", scene, "--camera", "standin", "-o", &real,
    ]);
    file_held(
        "views",
        &std::fs::read_to_string(format!("{real}/views.ron")).unwrap(),
    )
    .unwrap();
    let tune = [
        "sense", "vision", "tune", scene, &real, "--budget", "20", "-o", &found,
    ];
    answer(
        "vision-tune",
        &run(&[&tune[..], &["--format", "json"]].concat()),
    );
    file_held("camera", &std::fs::read_to_string(&found).unwrap()).unwrap();
}

/// Every answer is validated against its schema in some test.
#[test]
fn every_schema_is_used_by_a_test() {
    let mut tests = String::new();
    for pattern in ["tests/*.rs", "tests/*/*.rs"] {
        let pattern = project().join(pattern);
        for file in glob::glob(pattern.to_str().unwrap()).unwrap() {
            let text = std::fs::read_to_string(file.unwrap()).unwrap();
            tests.extend(text.split_whitespace());
        }
    }
    let names = |folder: &str| {
        let pattern = project().join("schemas").join(folder).join("*.json");
        let files = glob::glob(pattern.to_str().unwrap()).unwrap();
        files.map(|file| {
            file.unwrap()
                .file_stem()
                .unwrap()
                .to_str()
                .unwrap()
                .to_owned()
        })
    };
    let unused: Vec<String> = names("answers")
        .filter(|name| !tests.contains(&format!("answer(\"{name}\"")))
        .collect();
    assert!(unused.is_empty(), "{unused:?}");
}

#[test]
fn the_command_lists_prints_and_writes_every_schema() {
    let folder = tempfile::tempdir().unwrap();
    let list = run(&["study", "schema"]);
    assert!(
        list.contains("files/study") && list.contains("answers/sweep"),
        "{list}"
    );
    let printed: Value = serde_json::from_str(&run(&["study", "schema", "study"])).unwrap();
    assert_eq!(printed, schema("files/study"));
    assert_eq!(
        run(&["study", "schema", "answers/genome"]),
        run(&["study", "schema", "answers/genome.json"])
    );
    let out = folder.path().to_str().unwrap();
    run(&["study", "schema", "-o", out]);
    let written = std::fs::read(folder.path().join("answers/gap.json")).unwrap();
    let shipped = std::fs::read(project().join("schemas/answers/gap.json")).unwrap();
    assert_eq!(written, shipped);
    for (name, expected) in [
        ("genome", "files/genome or answers/genome"),
        ("studdy", "did you mean `study`?"),
    ] {
        let said = realgap().args(["study", "schema", name]).output().unwrap();
        assert_eq!(said.status.code(), Some(2), "{name}");
        assert!(
            text(&said.stderr).contains(expected),
            "{}",
            text(&said.stderr)
        );
    }
}
