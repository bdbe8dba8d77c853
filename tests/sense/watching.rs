//! `realgap sense picture --watch` and `--ride` with `--robot`: pictures of the robot that made a run.

use std::path::{Path, PathBuf};

use crate::common;

/// A scene with a small camera and mounts for small robots, and files of runs.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.write(
            "pen.ron",
            "Scene(name: \"pen\", room_m: (2, 2, 1), lights: { \"well\": (ambient_lux: 100, lamps: [(place_m: (1, 1, 0.9), intensity_cd: 30)]) },
            posters: [(centre_m: (1, 1.99, 0.2), width_m: 0.3, facing_deg: -90, motif: Disc)],
            cameras: { \"model\": (resolution_px: (80, 60), exposure_s: 0.01, electrons_per_cd_s: 9000, read_noise_e: 8) },
            mounts: {
                \"middle\": (start_m: (1, 1), facing_deg: 90),
                \"leg\": (body: \"part1\", place_m: (0, 0, 0.06), start_m: (1, 1)),
            },
            views: [(name: \"side\", place_m: (1, 0.1, 0.2), look_at_m: (1, 1, 0.1)), (name: \"top\", place_m: (0.5, 0.5, 0.9), look_at_m: (1, 1, 0))])",
        );
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn run(&self, threads: &str, args: &[&str]) -> (bool, String) {
        let done = common::realgap()
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(self.0.path())
            .args(args)
            .output()
            .unwrap();
        (done.status.success(), common::text(&done.stderr))
    }

    fn done(&self, threads: &str, args: &[&str]) {
        let (is_done, said) = self.run(threads, args);
        assert!(is_done, "{args:?}: {said}");
    }

    /// Adds a run of two seconds with every part of the tripod.
    fn with_parts(self) -> Self {
        let tripod = robot("tripod");
        let args = [
            "simulate",
            &tripod,
            "--duration",
            "2",
            "--parts",
            "parts.csv",
        ];
        self.done("2", &args);
        self
    }
}

fn robot(name: &str) -> String {
    let file = format!("morphologies/{name}.ron");
    common::project().join(file).to_str().unwrap().to_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let files = common::files(folder).into_keys();
    let names = files.map(|file| file.file_name().unwrap().to_str().unwrap().to_owned());
    names.filter(|name| name.ends_with(".png")).collect()
}

#[test]
fn a_robot_is_watched_from_every_viewpoint_with_the_same_bytes_on_any_number_of_threads() {
    let desk = Desk::new().with_parts();
    let tripod = robot("tripod");
    let watch = [
        "sense",
        "picture",
        "pen.ron",
        "--watch",
        "middle",
        "--run",
        "parts.csv",
        "--robot",
        &tripod,
    ];
    for (threads, folder) in [("1", "a"), ("3", "b")] {
        let args = [&watch[..], &["--every", "1", "-o", folder]].concat();
        desk.done(threads, &args);
    }
    common::must_be_equal(&desk.path("a"), &desk.path("b"));
    let expected: Vec<String> = ["side", "top"]
        .iter()
        .flat_map(|view| (0..3).map(move |s| format!("{view}_t_00{s}.000.png")))
        .collect();
    assert_eq!(names(&desk.path("a")), expected);
    let views = common::read(&desk.path("a"), "views.ron");
    assert!(
        views.contains("side_t_001.000") && views.contains("Simulated"),
        "{views}"
    );
    let args = [&watch[..], &["--every", "2", "--view", "top", "-o", "c"]].concat();
    desk.done("2", &args);
    assert_eq!(
        names(&desk.path("c")),
        ["top_t_000.000.png", "top_t_002.000.png"]
    );
    // A picture does not depend on the other pictures of the command.
    let of = |folder: &str| std::fs::read(desk.path(folder).join("top_t_000.000.png")).unwrap();
    assert_eq!(of("a"), of("c"));
}

#[test]
fn a_camera_on_a_leg_sees_the_robot_only_where_it_is_named() {
    let desk = Desk::new().with_parts();
    let tripod = robot("tripod");
    let ride = [
        "sense",
        "picture",
        "pen.ron",
        "--ride",
        "leg",
        "--run",
        "parts.csv",
        "--every",
        "2",
    ];
    desk.done("2", &[&ride[..], &["-o", "alone"]].concat());
    desk.done(
        "2",
        &[&ride[..], &["--robot", &tripod, "-o", "whole"]].concat(),
    );
    let of = |folder: &str| std::fs::read(desk.path(folder).join("t_002.000.png")).unwrap();
    assert_ne!(of("alone"), of("whole"));
}

#[test]
fn a_plain_motion_of_one_body_and_a_body_of_a_study_are_watched() {
    let desk = Desk::new();
    let cube = robot("cube");
    desk.write(
        "toss.csv",
        "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,5,5,0.5,1,0,0,0\n1,5.2,5,0.06,0.7,0.7,0,0.14\n",
    );
    let args = [
        "sense", "picture", "pen.ron", "--watch", "middle", "--run", "toss.csv", "--view", "side",
    ];
    desk.done(
        "2",
        &[&args[..], &["--robot", &cube, "-o", "toss"]].concat(),
    );
    assert_eq!(names(&desk.path("toss")).len(), 2);
    desk.write(
        "study.ron",
        &format!(
            "Study(morphology: {cube:?}, recordings: [\"none.csv\"], start: FromRecording, scene: [
                (name: \"ball\", motion: Recorded, boxes: [(sides_m: (0.1, 0.1, 0.1))]),
                (name: \"step\", motion: Fixed(position_m: (5, 5.4, 0.05)), boxes: [(sides_m: (0.3, 0.1, 0.1))]),
            ], parameters: [(name: \"floor.friction\", from: 0.2, to: 0.4, points: 2)], metric: \"rms\")"
        ),
    );
    desk.write(
        "push.csv",
        "t_s,x_m,y_m,z_m,qw,qx,qy,qz,ball_x_m,ball_y_m,ball_z_m,ball_qw,ball_qx,ball_qy,ball_qz\n\
         0,5,5,0.06,1,0,0,0,5,5.2,0.05,1,0,0,0\n1,5.2,5,0.06,1,0,0,0,5.2,5.2,0.05,1,0,0,0\n",
    );
    let args = [
        "sense", "picture", "pen.ron", "--watch", "middle", "--run", "push.csv", "--view", "side",
    ];
    desk.done(
        "2",
        &[&args[..], &["--robot", "study.ron", "-o", "push"]].concat(),
    );
    // The orientation of the robot must not be used for the ball.
    let bare = "t_s,x_m,y_m,z_m,qw,qx,qy,qz,ball_x_m,ball_y_m,ball_z_m\n\
        0,5,5,0.06,1,0,0,0,5,5.2,0.05\n1,5.2,5,0.06,1,0,0,0,5.2,5.2,0.05\n";
    desk.write("bare.csv", bare);
    let of_bare = args.map(|arg| if arg == "push.csv" { "bare.csv" } else { arg });
    let of_study = ["--robot", "study.ron", "-o", "no"];
    let (is_done, said) = desk.run("2", &[&of_bare[..], &of_study].concat());
    assert!(
        !is_done && said.contains("ball") && said.contains("without orientations"),
        "{said}"
    );
    let (is_done, said) = desk.run("2", &[&args[..], &["--robot", &cube, "-o", "no"]].concat());
    assert!(
        !is_done && said.contains("ball") && said.contains("a study whose scene"),
        "{said}"
    );
}

#[test]
fn runs_that_do_not_fit_the_robot_or_the_room_are_refused_before_any_picture() {
    let desk = Desk::new().with_parts();
    let header = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
    desk.write("plain.csv", "t_s,x_m,y_m\n0,0,0\n1,0.1,0\n");
    desk.write("heading.csv", "t_s,x_m,y_m,theta_rad\n0,0,0,0\n1,0.1,0,0\n");
    desk.write(
        "core.csv",
        &format!("{header}0,0,0,0.05,1,0,0,0\n1,0.1,0,0.05,1,0,0,0\n"),
    );
    desk.write(
        "far.csv",
        &format!("{header}0,0,0,0.05,1,0,0,0\n1,9,0,0.05,1,0,0,0\n"),
    );
    desk.write(
        "mm.csv",
        &format!("{header}0,0,0,60,1,0,0,0\n1,300,0,60,1,0,0,0\n"),
    );
    desk.write(
        "nan.csv",
        &format!("{header}0,0,0,0.05,1,0,0,0\n1,NaN,0,0.05,1,0,0,0\n"),
    );
    desk.write("empty.csv", "");
    let (cube, tripod, two) = (robot("cube"), robot("tripod"), robot("two_module"));
    for (run, robot, expected) in [
        (
            "parts.csv",
            &two,
            ["part3", "name the robot that made the run"],
        ),
        (
            "parts.csv",
            &cube,
            ["part1", "name the robot that made the run"],
        ),
        (
            "plain.csv",
            &cube,
            ["without orientations", "simulate --parts"],
        ),
        (
            "core.csv",
            &tripod,
            [
                "position of this part of the robot is not known",
                "simulate --parts",
            ],
        ),
        ("far.csv", &cube, ["leaves the room", "start_m"]),
        ("mm.csv", &cube, ["leaves the room", "another unit"]),
        ("nan.csv", &cube, ["nan.csv:3", "NaN"]),
        ("empty.csv", &cube, ["empty.csv", "empty"]),
        ("nowhere.csv", &cube, ["nowhere.csv", "check the path"]),
    ] {
        let args = [
            "sense", "picture", "pen.ron", "--watch", "middle", "--run", run, "--robot", robot,
        ];
        let (is_done, said) = desk.run("1", &[&args[..], &["-o", "out"]].concat());
        let all_said = expected.iter().all(|word| said.contains(word));
        assert!(!is_done && all_said, "{run}, {expected:?}: {said}");
        assert!(!desk.path("out").exists());
    }
    let args = [
        "sense", "picture", "pen.ron", "--watch", "middle", "--run", "mm.csv", "--robot", &cube,
    ];
    desk.done(
        "2",
        &[
            &args[..],
            &[
                "--column",
                "x=x_m in mm",
                "--column",
                "y=y_m in mm",
                "--column",
                "z=z_m in mm",
                "-o",
                "out",
            ],
        ]
        .concat(),
    );
    for args in [
        &["--watch", "middle", "--run", "parts.csv"][..],
        &[
            "--watch",
            "middle",
            "--ride",
            "leg",
            "--run",
            "parts.csv",
            "--robot",
            &tripod,
        ],
        &["--run", "parts.csv"],
        &["--robot", &tripod],
    ] {
        let (is_done, said) = desk.run(
            "1",
            &[&["sense", "picture", "pen.ron", "-o", "x"], args].concat(),
        );
        assert!(!is_done && said.contains("--"), "{args:?}: {said}");
    }
}
