//! The error of the model in the commands.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{realgap, text};

#[test]
fn the_command_line_switches_it_off_and_takes_the_posterior_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("indistinguishable.csv");
    std::fs::write(&set, "floor.friction\n0.2\n0.6\n").unwrap();
    let folder = folder.path().display().to_string();
    let predict = |more: &[&str]| {
        let mut command = realgap();
        command.args([
            "predict",
            "morphologies/two_module.ron",
            "--duration",
            "0.5",
        ]);
        let output = command
            .args(["--repeats", "4"])
            .args(more)
            .output()
            .unwrap();
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (code, said, _) = predict(&["--model-error", "off"]);
    assert!(code == Some(0) && !said.contains("model error"), "{said}");
    let (code, said, _) = predict(&["--posterior", &folder]);
    assert_eq!(code, Some(0));
    assert!(said.contains("model error       10 other models"), "{said}");
    assert!(said.contains("confidence set"), "{said}");
    let (code, _, error) = predict(&["--model-error", "off", "--posterior", &folder]);
    assert_eq!(code, Some(2), "{error}");
    let (code, _, error) = predict(&["--posterior", "nowhere"]);
    assert!(code == Some(1) && error.contains("nowhere"), "{error}");
}

#[test]
fn who_says_what_another_engine_would_do_is_chosen_and_named() {
    let predict = |more: &[&str]| {
        let mut command = realgap();
        command.args(["predict", "morphologies/two_module.ron"]);
        command.args(["--duration", "0.5", "--repeats", "4"]);
        let output = command.args(more).output().unwrap();
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (code, said, _) = predict(&["--other-engine", "table"]);
    assert_eq!(code, Some(0));
    assert!(
        said.contains("(learned from 391 other robots in MuJoCo)"),
        "{said}"
    );
    let nowhere = ["--python", "/nowhere/python3", "--format", "json"];
    let (code, said, _) = predict(&nowhere);
    let card: serde_json::Value = serde_json::from_str(&said).unwrap();
    let opinion = &card["model"]["third_opinion"];
    assert_eq!((code, &opinion["by"]), (Some(0), &"table".into()));
    let why = opinion["not_asked"].as_str().unwrap();
    assert!(
        why.contains("`/nowhere/python3` cannot be started"),
        "{why}"
    );
    let (code, _, error) = predict(&["--other-engine", "mujoco", "--python", "/nowhere/python3"]);
    assert!(
        code == Some(1) && error.contains("pip install mujoco"),
        "{error}"
    );
    let (code, _, error) = predict(&["--model-error", "off", "--other-engine", "table"]);
    assert!(
        code == Some(2) && error.contains("--other-engine"),
        "{error}"
    );
}
