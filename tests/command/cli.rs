//! The command line as a user meets it: help, exit codes, JSON, errors.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::{project, realgap, text};

#[test]
fn help_shows_the_usual_order_of_commands() {
    let out = realgap().arg("--help").assert().success();
    let help = text(&out.get_output().stdout);
    for word in [
        "realgap check",
        "realgap simulate",
        "realgap compare",
        "realgap sweep",
        "Exit codes",
    ] {
        assert!(help.contains(word), "{word} is missing from\n{help}");
    }
}

#[test]
fn wrong_usage_exits_with_2_and_a_failure_with_1() {
    realgap().arg("conquer").assert().code(2);
    realgap().assert().code(2);
    realgap().args(["compare", "only_one.csv"]).assert().code(2);
    realgap()
        .args([
            "simulate",
            "morphologies/cube.ron",
            "--set",
            "floor.friction=slippery",
        ])
        .assert()
        .code(2);
    realgap().args(["simulate", "nowhere.ron"]).assert().code(1);
}

#[test]
fn every_shipped_file_is_sound() {
    let files: Vec<_> = ["morphologies", "sweeps", "scenes"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(project().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .collect();
    assert!(files.len() >= 9, "{files:?}");
    let out = realgap().arg("check").args(&files).assert().success();
    let report = text(&out.get_output().stdout);
    assert!(
        report.contains("morphology \"tripod\": 4 modules, 3 hinges, 4 rigid parts"),
        "{report}"
    );
    assert!(report.contains("441 points"), "{report}");
}

/// A clone of this repository must be enough: paths in shipped files stay inside of it.
#[test]
fn no_shipped_file_points_outside_of_the_repository() {
    let project = project().canonicalize().unwrap();
    let folders = [
        "arenas",
        "controllers",
        "radios",
        "morphologies",
        "scenes",
        "sensors",
        "sweeps",
        "vehicles",
    ];
    let mut offences = Vec::new();
    for folder in folders {
        for entry in std::fs::read_dir(project.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let file = std::fs::read_to_string(&path).unwrap();
            for (number, line) in file.lines().enumerate() {
                let code = line.split("//").next().unwrap_or_default();
                // What stands between quotation marks: every second piece.
                for quoted in code.split('"').skip(1).step_by(2) {
                    let climbs = quoted.split('/').filter(|step| *step == "..").count();
                    if climbs > 1 || quoted.starts_with('/') {
                        offences.push(format!("{}:{}: {quoted}", path.display(), number + 1));
                    }
                }
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn a_path_that_is_not_there_is_named_with_a_hint() {
    let out = realgap().args(["check", "no/such.ron"]).assert().code(1);
    let error = text(&out.get_output().stderr);
    assert!(
        error.contains("no/such.ron") && error.contains("hint:"),
        "{error}"
    );
}

#[test]
fn simulate_reports_what_happened_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("run.csv");
    let out = realgap()
        .args("simulate morphologies/tripod.ron --duration 1 --rate 30 --format json -o".split(' '))
        .arg(&csv)
        .args(["--set", "floor.friction=0.4"])
        .assert()
        .success();
    let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    // 1 s at the default timestep.
    assert_eq!(report["steps"], 480);
    assert_eq!(report["simulated_s"], 1.0);
    assert!(report["cpu_s"].as_f64().unwrap() > 0.0);
    assert!(report["net_displacement_m"].as_f64().unwrap() > 0.0);
    assert_eq!(report["status"]["status"], "completed");
    // 30 Hz from 0 to 1 s, both ends, and a header.
    assert_eq!(std::fs::read_to_string(&csv).unwrap().lines().count(), 32);
}

#[test]
fn a_passive_cube_goes_nowhere() {
    let out = realgap()
        .args("simulate morphologies/cube.ron --duration 1 --format json".split(' '))
        .assert()
        .success();
    let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert!(report["net_displacement_m"].as_f64().unwrap() < 1e-5);
}

#[test]
fn compare_prints_the_golden_columns() {
    let curves = project().join("crates/path/tests/golden/curves");
    let out = realgap()
        .args(["compare", "--format", "json"])
        .args([
            curves.join("real.csv"),
            curves.join("real.csv"),
            curves.join("scaled.csv"),
        ])
        .assert()
        .success();
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(rows[0]["trajectory"], "real");
    assert_eq!(rows[0]["rms_m"], 0.0);
    assert_eq!(rows[1]["trajectory"], "scaled");
    let rms = rows[1]["rms_m"].as_f64().unwrap();
    assert!((rms / 0.116806236 - 1.0).abs() < 1e-6, "{rms}");
    // Every metric that needs positions only is printed by default.
    let row = rows[1].as_object().unwrap();
    for metric in realgap::comparison::position_metrics() {
        assert!(row[metric.column()].is_number(), "{}", metric.name());
    }
}

#[test]
fn compare_draws_what_it_compares() {
    let folder = tempfile::tempdir().unwrap();
    let curves = project().join("crates/path/tests/golden/curves");
    let plot = folder.path().join("gap.png");
    realgap()
        .arg("compare")
        .args([curves.join("real.csv"), curves.join("far.csv")])
        .args(["--metric", "frechet", "--plot"])
        .arg(&plot)
        .assert()
        .success();
    assert_eq!(&std::fs::read(&plot).unwrap()[1..4], b"PNG");
    let out = realgap()
        .arg("compare")
        .args([curves.join("real.csv"), curves.join("far.csv")])
        .args(["--plot", "gap.jpg"])
        .assert()
        .code(2);
    assert!(text(&out.get_output().stderr).contains(".png"));
}

#[test]
fn an_unknown_metric_lists_the_known_ones() {
    let curves = project().join("crates/path/tests/golden/curves");
    let out = realgap()
        .arg("compare")
        .args([curves.join("real.csv"), curves.join("far.csv")])
        .args(["--metric", "frechett"])
        .assert()
        .code(2);
    assert!(text(&out.get_output().stderr).contains("hausdorff, frechet, dtw"));
}

#[test]
fn files_in_centimetres_are_read_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cm.csv");
    std::fs::write(&path, "t_s,x_cm,y_cm\n0,0,0\n1,100,0\n2,200,50\n").unwrap();
    let out = realgap()
        .arg("check")
        .arg(&path)
        .args(["--unit", "cm"])
        .assert()
        .success();
    assert!(text(&out.get_output().stdout).contains("path 2.1180 m"));
    // The names of the columns say so without an option, too.
    let out = realgap().arg("check").arg(&path).assert().success();
    assert!(text(&out.get_output().stdout).contains("path 2.1180 m"));
}

#[test]
fn no_colour_codes_reach_a_pipe() {
    let out = realgap().args(["study", "parameters"]).assert().success();
    assert!(!out.get_output().stdout.contains(&0x1b));
    let out = realgap().args(["check", "nowhere.ron"]).assert().code(1);
    assert!(!out.get_output().stderr.contains(&0x1b));
}

#[test]
fn completions_name_every_command_and_parameter() {
    for shell in ["bash", "zsh", "fish"] {
        let out = realgap().args(["completions", shell]).assert().success();
        let script = text(&out.get_output().stdout);
        assert!(
            ["sweep", "compare", "record", "floor.friction="]
                .iter()
                .all(|command| script.contains(command)),
            "{shell}"
        );
    }
}

#[test]
fn a_simulation_that_diverges_is_an_error_with_advice() {
    // Without friction, 20 s down a slope of 0.7 rad are more than a kilometre.
    let out = realgap()
        .args(["simulate", "morphologies/cube.ron", "--duration", "20"])
        .args(["--set", "floor.slope_rad=0.7", "--set", "floor.friction=0"])
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert!(
        error.contains("diverged") && error.contains("--timestep"),
        "{error}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_a_failure() {
    let full = std::fs::File::create("/dev/full").unwrap();
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_realgap"))
        .args(["study", "parameters"])
        .stdout(full)
        .stderr(std::process::Stdio::null())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(1));
}

#[test]
fn a_setting_without_effect_gets_a_warning() {
    let out = realgap()
        .args("simulate morphologies/cube.ron --duration 0.1 --set servo.gain=3".split(' '))
        .args(["--set", "recording.length_scale=2"])
        .assert()
        .success();
    let warnings = text(&out.get_output().stderr);
    assert!(
        warnings.contains("servo.gain has no effect")
            && warnings.contains("recording.length_scale has no effect")
    );
}

#[test]
fn runs_of_different_length_are_compared_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let short = folder.path().join("short.csv");
    realgap()
        .args("simulate morphologies/tripod.ron --duration 2 -o".split(' '))
        .arg(&short)
        .assert()
        .success();
    let out = realgap()
        .args(["compare", "real_trajectories/tripod_standin/run_00.csv"])
        .arg(&short)
        .args(["--time", "fraction"])
        .assert()
        .success();
    assert!(text(&out.get_output().stderr).contains("different-durations"));
}

#[test]
fn values_from_options_that_cannot_be_used_are_wrong_usage() {
    let curves = project().join("crates/path/tests/golden/curves");
    for arguments in [
        ["--components", "0"],
        ["--variance", "2"],
        ["--body-length", "0.1"],
        ["--metric", "no_such"],
    ] {
        realgap()
            .arg("compare")
            .args([curves.join("real.csv"), curves.join("far.csv")])
            .args(arguments)
            .assert()
            .code(2);
    }
    realgap()
        .args(["simulate", "morphologies/cube.ron", "--duration", "-1"])
        .assert()
        .code(2);
    realgap()
        .args(["sweep", "sweeps/tripod_floor.ron", "--points", "1"])
        .assert()
        .code(2);
}

#[test]
fn an_error_names_the_kind_of_a_wrong_file() {
    let cases = [
        (
            &["simulate"][..],
            "sweeps/tripod_self.ron",
            "a study",
            "realgap sweep",
        ),
        (
            &["robot", "export", "--format", "urdf"],
            "sweeps/cube_toss_best.ron",
            "a parameter file",
            "--parameters",
        ),
        (
            &["sweep"],
            "morphologies/cube.ron",
            "a morphology",
            "realgap simulate",
        ),
        (
            &["evaluate"],
            "morphologies/cube.ron",
            "a morphology",
            "realgap simulate",
        ),
        (
            &["study", "identify"],
            "sweeps/cube_toss_best.ron",
            "a parameter file",
            "--parameters",
        ),
        (
            &["sweep"],
            "real_trajectories/tripod_mujoco/run_00.csv",
            "a trajectory",
            "realgap compare",
        ),
    ];
    for (command, file, kind, hint) in cases {
        let mut call = realgap();
        call.args(command).arg(project().join(file));
        let error = text(&call.assert().code(2).get_output().stderr);
        assert!(
            error.contains(&format!("found:   {kind}")),
            "{command:?}: {error}"
        );
        assert!(error.contains(hint), "{command:?}: {error}");
    }
    // A broken file of the right kind keeps its own error.
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("robot.ron");
    std::fs::write(&broken, "(name: \"x\", modules: [])").unwrap();
    let out = realgap().arg("simulate").arg(&broken).assert().code(1);
    let error = text(&out.get_output().stderr);
    assert!(!error.contains("not a morphology"), "{error}");
}

#[test]
fn check_refuses_a_folder_and_suggests_its_files() {
    let out = realgap()
        .arg("check")
        .arg(project().join("sweeps"))
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert!(
        error.contains("this is a folder") && error.contains("*.ron"),
        "{error}"
    );
}

#[test]
fn check_prints_the_same_contents_as_json() {
    let out = realgap()
        .arg("check")
        .arg(project().join("morphologies/tripod.ron"))
        .arg(project().join("real_trajectories/tripod_mujoco/run_00.csv"))
        .args(["nowhere.ron", "--format", "json"])
        .assert()
        .code(1);
    let reports: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    let [robot, run, missing] = reports.as_array().unwrap().as_slice() else {
        panic!("{reports}");
    };
    assert!(robot["ok"] == true && robot["kind"] == "morphology");
    assert_eq!(robot["contents"]["modules"], 4);
    assert!(run["kind"] == "trajectory");
    let samples = &run["contents"]["recordings"][0]["samples"];
    assert!(samples.as_u64().unwrap() > 100);
    assert!(missing["ok"] == false && missing["error"]["text"].is_string());
}

#[test]
fn record_prints_what_it_wrote_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    let out = realgap()
        .args(["study", "record"])
        .arg(project().join("morphologies/cube.ron"))
        .args("--repeats 1 --duration 0.2 --set floor.friction=0.4".split(' '))
        .args(["--format", "json", "-o"])
        .arg(&runs)
        .assert()
        .success();
    let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(report["source"], "StandIn");
    assert_eq!(report["parameters"]["floor.friction"], 0.4);
    for file in [&report["recordings"][0], &report["meta"]] {
        let file = std::path::Path::new(file.as_str().unwrap());
        assert!(file.is_file(), "{}", file.display());
    }
}

#[test]
fn simulate_checks_its_output_file_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let started = std::time::Instant::now();
    let out = realgap()
        .arg("simulate")
        .arg(project().join("morphologies/chain30.ron"))
        .args(["--duration", "3600", "-o"])
        .arg(folder.path().join("missing/run.csv"))
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert!(error.contains("cannot write the file"), "{error}");
    // An hour of chain30 takes minutes.
    assert!(started.elapsed().as_secs() < 20);
}

#[test]
fn help_shows_the_defaults_that_are_used() {
    let out = realgap().args(["simulate", "--help"]).assert().success();
    let help = text(&out.get_output().stdout);
    let solver = realgap::simulation::Solver::default();
    for default in [
        format!("[default: 1/{:.0},", 1.0 / solver.timestep_s),
        format!("[default: {},", solver.substeps),
        format!(
            "[default: {},",
            format!("{:?}", solver.joint).to_lowercase()
        ),
    ] {
        // Long lines are wrapped.
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains(&default),
            "{default} is missing from\n{help}"
        );
    }
}

/// Heights and distances over time, which a picture from above does not show.
#[test]
fn trajectories_are_drawn_over_time_with_heights_and_distances() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("time.svg");
    let runs = [0, 1].map(|k| format!("real_trajectories/tripod_standin/run_0{k}.csv"));
    let output = realgap()
        .arg("compare")
        .args(&runs)
        .arg("--over-time")
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let drawn = std::fs::read_to_string(file).unwrap();
    for word in [
        "ahead (cm)",
        "to the left",
        "height",
        "distance (",
        "time (s)",
        "not hardware",
        "run_01",
    ] {
        assert!(drawn.contains(word), "{word}");
    }
}
