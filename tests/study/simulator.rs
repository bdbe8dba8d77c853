//! A study of somebody else's simulator as a user runs it: consent, answers, failures, resume.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};
use std::time::Duration;

use common::{read, realgap, summary, text};

/// A simulator in awk: a mass on a spring that is released at rest, `x = x0 cos(sqrt(k / m) t)`.
const SPRING: &str = r#"# spring
function value(name,    rest) { rest = $0; if (!sub(".*\"" name "\":", "", rest)) return "none"; return rest + 0 }
/"hello"/ {
    print "{\"realgap\":1,\"name\":\"spring\",\"parameters\":[" \
        "{\"name\":\"k\",\"unit\":\"N/m\",\"from\":1,\"to\":100,\"default\":30}," \
        "{\"name\":\"x0\",\"unit\":\"m\",\"from\":0.01,\"to\":1,\"default\":0.1}]}"; fflush(); next
}
{
    rest = $0; sub(/.*"parameters":/, "", rest); sub(/\}.*/, "", rest); k = rest; sub(/.*"k":/, "", k); k += 0
    x0 = rest; sub(/.*"x0":/, "", x0); x0 += 0
    FAULT
    times = $0; sub(/.*"times_s":\[/, "", times); sub(/\].*/, "", times); n = split(times, t, ",")
    x = ""; y = ""
    for (i = 1; i <= n; i++) { x = x (i > 1 ? "," : "") sprintf("%.12g", x0 * cos(sqrt(k) * t[i])); y = y (i > 1 ? "," : "") "0" }
    print "{\"id\":" value("id") ",\"channels\":{\"x_m\":[" x "],\"y_m\":[" y "]}}"; fflush()
}
"#;

/// The program: awk may read ahead, so that each question has an awk of its own.
const LOOP: &str =
    "while IFS= read -r line; do printf '%s\\n' \"$line\" | awk -f spring.awk || exit 1; done";

/// A folder with two recordings of a spring of 42 N/m, the simulator, and its study.
fn study(folder: &Path, fault: &str) -> PathBuf {
    for (index, phase) in [0.0, 1.0].into_iter().enumerate() {
        let mut table = "t_s,x_m,y_m\n".to_owned();
        for sample in 0..100 {
            let t_s = 0.02 * f64::from(sample);
            let noise_m = 1e-3 * (1e3 * t_s + phase).sin();
            let x_m = 0.1 * (42.0_f64.sqrt() * t_s).cos() + noise_m;
            table.push_str(&format!("{t_s:.3},{x_m:.9},{noise_m:.9}\n"));
        }
        std::fs::write(folder.join(format!("run_{index}.csv")), table).unwrap();
    }
    std::fs::write(folder.join("spring.awk"), SPRING.replace("FAULT", fault)).unwrap();
    std::fs::write(folder.join("spring.sh"), LOOP).unwrap();
    let text = r#"(
        simulator: Program(command: ["sh", "spring.sh"], files: ["spring.awk"], answer_limit_s: 2),
        recordings: ["run_*.csv"],
        start: Settled,
        parameters: [(name: "k", from: 20, to: 60, points: 9)],
        metric: "rms",
        align: World,
    )"#;
    let path = folder.join("study.ron");
    std::fs::write(&path, text).unwrap();
    path
}

fn sweep(study: &Path, out: &Path) -> assert_cmd::Command {
    let mut command = realgap();
    command
        .arg("sweep")
        .arg(study)
        .arg("-o")
        .arg(out)
        .arg("--allow-command");
    command
}

#[test]
fn a_command_is_run_only_with_consent() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), "");
    // A simulator that leaves a trace when it is started.
    let traced = SPRING.replace("FAULT", "").replace(
        "# spring",
        "BEGIN { print 1 > \"trace\"; close(\"trace\") }",
    );
    std::fs::write(folder.path().join("spring.awk"), traced).unwrap();
    let trace = folder.path().join("trace");
    let out = folder.path().join("out");
    let refused = realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&out)
        .assert()
        .failure();
    let said = text(&refused.get_output().stderr);
    assert!(
        said.contains("--allow-command") && said.contains("sh spring.sh"),
        "{said}"
    );
    let checked = realgap().arg("check").arg(&study).assert().success();
    let said = text(&checked.get_output().stdout);
    assert!(
        said.contains("spring.awk, sha256") && said.contains("was not run"),
        "{said}"
    );
    assert!(!trace.exists());
    let checked = realgap()
        .arg("check")
        .arg(&study)
        .arg("--allow-command")
        .assert()
        .success();
    let said = text(&checked.get_output().stdout);
    assert!(
        said.contains("k from 1 to 100 N/m") && trace.exists(),
        "{said}"
    );
}

#[test]
fn a_spring_is_found_and_resumed_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), "");
    let out = folder.path().join("out");
    sweep(&study, &out).args(["--jobs", "2"]).assert().success();
    let best = summary(&out)["best"]["parameters"]["sim.k"]
        .as_f64()
        .unwrap();
    assert!((best - 42.0).abs() < 3.0, "{best}");
    let alone = folder.path().join("alone");
    sweep(&study, &alone)
        .args(["--jobs", "1"])
        .assert()
        .success();
    assert_eq!(read(&out, "points.csv"), read(&alone, "points.csv"));
    sweep(&study, &out).arg("--resume").assert().success();
    assert_eq!(read(&out, "points.csv"), read(&alone, "points.csv"));
    // A changed script is another simulator.
    std::fs::write(
        folder.path().join("spring.awk"),
        SPRING.replace("FAULT", "# changed"),
    )
    .unwrap();
    let refused = sweep(&study, &out).arg("--resume").assert().failure();
    let said = text(&refused.get_output().stderr);
    assert!(said.contains("spring.awk"), "{said}");
}

#[test]
fn a_simulator_that_dies_or_hangs_costs_a_run_and_not_the_study() {
    for fault in [
        r#"if (k > 50) { print "torque limit" > "/dev/stderr"; exit 1 }"#,
        r#"if (k > 58) { system("sleep 60") }"#,
        r#"if (k > 50) { print "{\"id\":" value("id") ",\"channels\":{\"x_m\":[NaN]}}"; fflush(); next }"#,
    ] {
        let folder = tempfile::tempdir().unwrap();
        let study = study(folder.path(), fault);
        let out = folder.path().join("out");
        sweep(&study, &out)
            .timeout(Duration::from_secs(120))
            .assert()
            .success();
        let best = summary(&out)["best"]["parameters"]["sim.k"]
            .as_f64()
            .unwrap();
        assert!((best - 42.0).abs() < 3.0, "{fault}: {best}");
        assert!(read(&out, "points.csv").contains("diverged"), "{fault}");
    }
}

#[test]
fn names_that_the_simulator_does_not_have_are_refused_with_those_that_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), "");
    let out = folder.path().join("out");
    for (option, expected) in [
        ("sim.x1=0.2", "x0"),
        ("floor.friction=0.3", "sim.NAME"),
        ("sim.x0=7", "0.01 to 1"),
    ] {
        let refused = sweep(&study, &out)
            .args(["--set", option])
            .assert()
            .failure();
        let said = text(&refused.get_output().stderr);
        assert!(said.contains(expected), "{option}: {said}");
    }
}

#[test]
fn every_kind_of_recorded_command_is_told_and_what_no_simulator_reads_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    // It keeps what it is asked, and reads the question without its commands.
    let study = study(
        folder.path(),
        r#"print > "asked"; fflush("asked"); close("asked"); sub(/,"commands":.*/, "")"#,
    );
    let kinds = ["rad", "rad_s", "nm", "a", "duty"];
    let names: String = kinds
        .iter()
        .map(|kind| format!(",joint_{kind}_command_{kind}"))
        .collect();
    for index in 0..2 {
        let path = folder.path().join(format!("run_{index}.csv"));
        let table = std::fs::read_to_string(&path).unwrap();
        let rows = table.lines().enumerate().map(|(row, line)| match row {
            0 => format!("{line}{names}\n"),
            _ => format!("{line}{}\n", ",0.25".repeat(kinds.len())),
        });
        std::fs::write(&path, rows.collect::<String>()).unwrap();
    }
    let out = folder.path().join("out");
    sweep(&study, &out).assert().success();
    let asked = std::fs::read_to_string(folder.path().join("asked")).unwrap();
    for kind in kinds {
        let channel = format!("\"joint_{kind}_command_{kind}\":[0.25");
        assert!(asked.contains(&channel), "{channel}: {asked}");
    }
    let stated = std::fs::read_to_string(&study).unwrap();
    std::fs::write(&study, stated.replace("align:", "contacts: false, align:")).unwrap();
    let refused = sweep(&study, &out).arg("--restart").assert().failure();
    let said = text(&refused.get_output().stderr);
    assert!(
        said.contains("contacts") && said.contains("own simulator"),
        "{said}"
    );
}

#[test]
fn a_simulator_of_named_numbers_alone_is_fitted_and_one_of_paths_predicts() {
    let folder = tempfile::tempdir().unwrap();
    let path = study(folder.path(), "");
    let awk = folder.path().join("spring.awk");
    let run = |words: &[&str]| {
        let done = realgap()
            .current_dir(folder.path())
            .args(words)
            .output()
            .unwrap();
        (
            done.status.success(),
            text(&done.stdout),
            text(&done.stderr),
        )
    };
    // What the answers of a path say without a recording; a stiffness decides where the run ends.
    let predict = [
        "predict",
        "study.ron",
        "--repeats",
        "10",
        "--success-m",
        "0.01",
    ];
    let consented = [&predict[..], &["--allow-command"]].concat();
    let (done, _, error) = run(&consented);
    assert!(
        !done && error.contains("`body_length_m` in its answer"),
        "{error}"
    );
    let own = std::fs::read_to_string(&awk).unwrap();
    let sized = own.replace(
        r#"{\"realgap\":1,"#,
        r#"{\"realgap\":1,\"body_length_m\":0.02,"#,
    );
    assert_ne!(own, sized);
    std::fs::write(&awk, sized).unwrap();
    let (done, said, error) = run(&consented);
    assert!(done && said.contains("study"), "{error}");
    assert!(error.contains("all repeats are the same run"), "{error}");
    // With the draws of a fit, they differ, and lie where the recordings are, which are compared as they are.
    let fit = [
        "tune",
        "study.ron",
        "--optimizer",
        "cma-es",
        "--budget",
        "30",
    ];
    let (done, _, error) =
        run(&[&fit[..], &["--allow-command", "--no-report", "-o", "fit"]].concat());
    assert!(done, "{error}");
    let drawn = [
        "ensemble",
        "study.ron",
        "--parameters",
        "fit/best.ron",
        "--repeats",
        "20",
    ];
    let (done, said, error) = run(&[&drawn[..], &["--allow-command", "-o", "drawn"]].concat());
    assert!(done && !said.contains("not predicted"), "{said}{error}");
    assert!(!error.contains("all repeats are the same run"), "{error}");
    let (done, _, error) = run(&predict);
    assert!(!done && error.contains("--allow-command"), "{error}");
    // Recordings and answers with columns of other names only.
    let own = std::fs::read_to_string(&awk).unwrap();
    std::fs::write(&awk, own.replace("x_m", "load").replace("y_m", "heat")).unwrap();
    for index in 0..2 {
        let file = folder.path().join(format!("run_{index}.csv"));
        let table = std::fs::read_to_string(&file).unwrap();
        std::fs::write(file, table.replace("x_m,y_m", "load,heat")).unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap();
    let channels = "metric: \"joints\", channels: [(columns: \"loa*\", noise: 0.001)],";
    let text = text
        .replace("metric: \"rms\",", channels)
        .replace("align: World,", "");
    std::fs::write(&path, text).unwrap();
    let tune = [
        "tune",
        "study.ron",
        "--optimizer",
        "gauss-newton",
        "--budget",
        "20",
        "--allow-command",
    ];
    let (done, _, error) = run(&[&tune[..], &["-o", "out", "--no-report"]].concat());
    assert!(done, "{error}");
    let best = summary(&folder.path().join("out"))["best"]["parameters"]["sim.k"].as_f64();
    assert!((best.unwrap() - 42.0).abs() < 0.5, "{best:?}");
    // What needs paths or joints says so.
    for (command, part) in [
        ("evaluate", "errors of joints need joints"),
        ("ensemble", "judged by their paths"),
        ("predict", "judged by their paths"),
    ] {
        let (done, _, error) = run(&[command, "study.ron", "--allow-command"]);
        assert!(!done && error.contains(part), "{command}: {error}");
    }
    let (done, said, error) = run(&["gap", "study.ron", "--allow-command", "-o", "gap"]);
    assert!(done && said.contains("away from reality"), "{error}");
}
