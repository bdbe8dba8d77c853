//! `realgap sense picture --ride`: pictures by a camera on a body that moves as in a recorded run.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

#[test]
fn a_camera_rides_along_a_recorded_run_and_a_run_that_leaves_the_room_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = |threads: &str, args: &[&str]| {
        let done = common::realgap()
            .env("RAYON_NUM_THREADS", threads)
            .args(["sense", "picture", "scenes/room.ron"])
            .args(args)
            .output()
            .unwrap();
        (done.status.success(), common::text(&done.stderr))
    };
    let recorded = "real_trajectories/tripod_standin/run_00.csv";
    let (first, second) = (out("a"), out("b"));
    for (threads, folder) in [("1", &first), ("3", &second)] {
        let args = [
            "--ride", "tripod", "--run", recorded, "--every", "8", "-o", folder,
        ];
        let (is_done, said) = run(threads, &args);
        assert!(is_done, "{said}");
    }
    common::must_be_equal(first.as_ref(), second.as_ref());
    let views = common::read(first.as_ref(), "views.ron");
    assert!(
        views.contains("t_000.000") && views.contains("t_008.000"),
        "{views}"
    );
    let plain = out("plain.csv");
    std::fs::write(&plain, "t_s,x_m,y_m\n0,0,0\n1,1,0\n").unwrap();
    let far = out("far.csv");
    std::fs::write(
        &far,
        "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n9,90,0,0,1,0,0,0\n",
    )
    .unwrap();
    for (args, expected) in [
        (
            ["--ride", "nose", "--run", recorded, "--every", "8"],
            "unknown mount",
        ),
        (
            ["--ride", "tripod", "--run", &plain, "--every", "8"],
            "without orientations",
        ),
        (
            ["--ride", "tripod", "--run", &far, "--every", "8"],
            "leaves the room",
        ),
        (
            ["--ride", "tripod", "--run", recorded, "--every", "0"],
            "above 0",
        ),
        (
            ["--ride", "tripod", "--run", recorded, "--every", "1e-9"],
            "too many pictures",
        ),
        (
            ["--ride", "tripod", "--run", "nowhere.csv", "--every", "8"],
            "nowhere.csv",
        ),
    ] {
        let mut args = args.to_vec();
        let other = out("c");
        args.extend(["-o", &other]);
        let (is_done, said) = run("1", &args);
        assert!(!is_done && said.contains(expected), "{expected}: {said}");
    }
}
