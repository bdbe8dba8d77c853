//! The command that exports.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[test]
fn the_command_line_writes_the_file_and_says_what_is_missing() {
    let out = tempfile::tempdir().unwrap();
    let file = out.path().join("tripod.urdf");
    let run = |arguments: &[&str]| {
        assert_cmd::Command::cargo_bin("realgap")
            .unwrap()
            .current_dir(crate::common::project())
            .args(arguments)
            .output()
            .unwrap()
    };
    let robot = "morphologies/tripod.ron";
    let to_file = run(&[
        "robot",
        "export",
        robot,
        "--format",
        "urdf",
        "-o",
        file.to_str().unwrap(),
    ]);
    assert!(to_file.status.success() && to_file.stdout.is_empty());
    let said = String::from_utf8(to_file.stderr).unwrap();
    assert!(
        said.contains("urdf does not carry: gait and servo law"),
        "{said}"
    );
    let to_stdout = run(&["robot", "export", robot, "--format", "urdf"]);
    assert_eq!(to_stdout.stdout, std::fs::read(&file).unwrap());
    assert_eq!(
        run(&["robot", "export", robot, "--format", "sdf"])
            .status
            .code(),
        Some(2)
    );
}
