//! Equal runs write equal folders, byte for byte, for any number of threads; only `timing.json` differs.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::{files, quick_study, realgap};

#[test]
fn commands_that_write_one_file_write_the_same_bytes_again() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2).display().to_string();
    let (robot, run) = (
        "morphologies/tripod.ron",
        "real_trajectories/tripod_standin/run_00.csv",
    );
    let other = "real_trajectories/tripod_standin/run_01.csv";
    for (name, args) in [
        (
            "run.csv",
            vec!["simulate", robot, "--duration", "0.5", "-o"],
        ),
        (
            "recordings",
            vec![
                "study",
                "record",
                robot,
                "--repeats",
                "2",
                "--duration",
                "0.5",
                "-o",
            ],
        ),
        (
            "robot.xml",
            vec!["robot", "export", robot, "--format", "mjcf", "-o"],
        ),
        (
            "genome.ron",
            vec![
                "robot",
                "genome",
                "random",
                "--modules",
                "3",
                "--seed",
                "2",
                "-o",
            ],
        ),
        ("robot.png", vec!["check", robot, "--plot"]),
        ("paths.svg", vec!["compare", run, other, "--plot"]),
        (
            "bars.png",
            vec!["study", "sensitivity", &study, "--jobs", "2", "--plot"],
        ),
        (
            "repeat.csv",
            vec!["ensemble", "sweeps/tripod_self.ron", "--only", "3", "-o"],
        ),
    ] {
        let write = || {
            let out = tempfile::tempdir_in(folder.path()).unwrap();
            let said = realgap()
                .args(&args)
                .arg(out.path().join(name))
                .output()
                .unwrap();
            assert!(
                said.status.success(),
                "{args:?}: {}",
                common::text(&said.stderr)
            );
            files(out.path())
        };
        let first = write();
        assert!(!first.is_empty(), "{args:?}");
        assert!(first == write(), "{args:?}");
    }
}

#[test]
fn every_command_writes_the_same_bytes_for_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 3).display().to_string();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let search = write(
        "search.ron",
        "Search(strategy: MapElites(initial: 8, batch: 4, evaluations: 16, variation: (max_modules: 3), axes: [(name: \"modules\", from: 1, to: 4, cells: 3)]), \
         duration_s: 0.2, repeats: 2, finalists: (count: 2, repeats: 2))",
    );
    let noise = write("noise.ron", "(start_heading_rad: Normal(0.02))");
    let robot = "morphologies/tripod.ron";
    let ensemble = ["--repeats", "5", "--noise", &noise];
    for (args, more) in [
        (vec!["sweep", &study], &[][..]),
        (
            vec!["tune", &study, "--metric", "rms", "--budget", "30"],
            &[],
        ),
        (vec!["search", &search], &[]),
        (vec!["ensemble", &study], &ensemble),
        (vec!["gap", &study], &ensemble),
        (
            vec!["predict", robot, "--repeats", "5", "--duration", "0.5"],
            &[],
        ),
        (
            vec![
                "gap",
                "--recordings",
                "real_trajectories/tripod_standin/*.csv",
            ],
            &[],
        ),
    ] {
        let run = |jobs: &str| {
            let out = tempfile::tempdir_in(folder.path()).unwrap();
            let mut command = realgap();
            command.args(&args).args(more).args(["--jobs", jobs, "-o"]);
            // The path is the same each time, because it may be part of a result.
            command.arg("out").current_dir(out.path());
            let root = common::project();
            for (name, place) in [
                ("morphologies", "morphologies"),
                ("real_trajectories", "real_trajectories"),
            ] {
                std::os::unix::fs::symlink(root.join(place), out.path().join(name)).unwrap();
            }
            command.assert().success();
            let folder = out.path().join("out");
            assert!(folder.join("timing.json").exists(), "{args:?}");
            files(&folder)
        };
        let (one, three) = (run("1"), run("3"));
        let names: Vec<_> = one.keys().collect();
        assert_eq!(names, three.keys().collect::<Vec<_>>(), "{args:?}");
        assert!(names.len() > 1, "{args:?}: {names:?}");
        for (name, bytes) in &one {
            assert!(
                three[name] == *bytes,
                "{args:?}: {} differs",
                name.display()
            );
        }
    }
}
