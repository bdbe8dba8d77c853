//! Joints and commands in logs of ROS: the command line lists their topics and takes the choice.

use std::path::Path;

use realgap::warning::Code;

use super::common::{python_with, realgap, text};
use super::python;

const SCRIPT: &str = include_str!("joint_log.py");

fn file(folder: &Path, name: &str, ending: &str) -> std::path::PathBuf {
    let name = format!("{name}_{ending}");
    folder.join(&name).join(format!("{name}.{ending}"))
}

#[test]
fn the_command_line_lists_the_topics_and_takes_the_choice() {
    let Some(program) = python_with("rosbags") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    python(&program, folder, SCRIPT);
    let log = file(folder, "both", "mcap");
    let refused = realgap().arg("check").arg(&log).assert().failure();
    let said = text(&refused.get_output().stderr);
    for words in [
        "/arm/joint_trajectory",
        "/leg/joint_trajectory",
        "--command-topic",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let chosen = ["--command-topic", "/leg/joint_trajectory"];
    let checked = realgap().arg("check").arg(&log).args(chosen).assert();
    let said = checked.success();
    let said = text(&said.get_output().stdout) + &text(&said.get_output().stderr);
    assert!(said.contains("/leg/joint_trajectory"), "{said}");
    assert!(said.contains(Code::ColumnsIgnored.name()), "{said}");
}
