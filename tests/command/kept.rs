//! No command replaces a file of the user.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common::{project, realgap, text};

/// The path of a file of the user, and the command that would write there; `@` is the project's folder.
const COMMANDS: &[(&str, &str)] = &[
    (
        "run.csv",
        "simulate @/morphologies/cube.ron --duration 0.1 -o run.csv",
    ),
    (
        "parts.csv",
        "simulate @/morphologies/cube.ron --duration 0.1 --parts parts.csv",
    ),
    (
        "r.html",
        "simulate @/morphologies/cube.ron --duration 0.1 --replay r.html",
    ),
    (
        "c.html",
        "replay @/morphologies/cube.ron --duration 0.1 -o c.html",
    ),
    (
        "c.png",
        "replay @/morphologies/cube.ron --duration 0.1 -o c.png",
    ),
    (
        "c.mcap",
        "replay @/morphologies/cube.ron --duration 0.1 -o c.mcap",
    ),
    (
        "c.glb",
        "replay @/morphologies/cube.ron --duration 0.1 -o c.glb",
    ),
    ("robot.ron", "robot import one.urdf -o robot.ron"),
    (
        "x.xml",
        "robot export @/morphologies/tripod.ron --format mjcf -o x.xml",
    ),
    (
        "x.urdf",
        "robot export @/morphologies/tripod.ron --format urdf -o x.urdf",
    ),
    ("g.ron", "robot genome random -o g.ron"),
    ("s.ron", "study new study -o s.ron"),
    (
        "id.ron",
        "study identify @/sweeps/cube_toss_fit.ron -o id.ron",
    ),
    (
        "out/run_00.csv",
        "study record @/morphologies/cube.ron -o out --repeats 2 --duration 0.1",
    ),
    ("out/files/study.json", "study schema -o out"),
    ("out/morphologies/cube.ron", "study examples copy out"),
    ("log.csv", "sense draw ultrasonic -o log.csv"),
    (
        "belief.png",
        "sense belief ultrasonic --distances 2,20 --plot belief.png",
    ),
    (
        "scan.ron",
        "sense graph fit @/real_trajectories/radio_flat/scans.csv -o scan.ron",
    ),
    ("way.csv", "sense graph log @/arenas/cartons.ron -o way.csv"),
    (
        "radio.ron",
        "sense radio fit @/real_trajectories/radio_flat/poses.csv --session 0 --arena @/arenas/flat.ron -o radio.ron",
    ),
    (
        "e.png",
        "sense vision extract @/docs/images/seen.png -o e.png",
    ),
    ("gap.png", "compare @/A @/B --plot gap.png"),
    ("over.png", "compare @/A @/B --over-time over.png"),
    ("plane.png", "compare @/A @/B --plane plane.png"),
    ("basis.json", "compare @/A @/B --save-basis basis.json"),
    (
        "robot.png",
        "check @/morphologies/tripod.ron --plot robot.png",
    ),
    (
        "bars.png",
        "study sensitivity @/sweeps/cube_toss.ron --limit-recordings 1 --plot bars.png",
    ),
    (
        "study.ron",
        "start @/real_trajectories/cube_tosses/toss_003.csv --cube 0.1 0.37 -o study.ron",
    ),
    (
        "out/plan.json",
        "cluster plan @/sweeps/cube_toss.ron --shards 2 -o out",
    ),
    (
        "out/points.csv",
        "sweep @/sweeps/cube_toss.ron --points 2 --limit-recordings 1 -o out",
    ),
];

#[test]
fn no_command_replaces_what_realgap_did_not_write() {
    let folder = tempfile::tempdir().unwrap();
    let project = project().display().to_string();
    let urdf = r#"<robot name="one"><link name="a"><inertial><mass value="1"/></inertial>
        <collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"#;
    std::fs::write(folder.path().join("one.urdf"), urdf).unwrap();
    for (file, command) in COMMANDS {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, "mine, measured by hand").unwrap();
        let command = command
            .replace("@/A", "@/real_trajectories/tripod_standin/run_00.csv")
            .replace("@/B", "@/real_trajectories/tripod_standin/run_01.csv")
            .replace('@', &project);
        let mut process = realgap();
        process.args(command.split(' ')).current_dir(folder.path());
        let said = process.output().unwrap();
        let error = text(&said.stderr);
        assert_eq!(said.status.code(), Some(1), "{command}: {error}");
        let name = Path::new(file).file_name().unwrap().to_string_lossy();
        assert!(error.contains(&*name), "{command}: {error}");
        let kept = std::fs::read_to_string(&path).unwrap();
        assert_eq!(kept, "mine, measured by hand", "{command}");
        if file.starts_with("out/") {
            std::fs::remove_dir_all(folder.path().join("out")).unwrap();
        }
    }
}
