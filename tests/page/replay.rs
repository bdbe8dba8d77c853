//! Replays: one file that needs no network, holds the simulated motion, and runs no foreign text.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::browser::Browser;
use common::{realgap, text};
use nalgebra::{Isometry3, Vector3};
use realgap::report::{Replay, SIMULATION};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{
    Experiment, Film, Floor, Sampling, SceneBody, SceneBox, SceneMotion, film, run,
};
use realgap::trajectory::{self, Reading, Trajectory, write_with_bodies};
use realgap::warning::Code;

const RUNS: &str = "real_trajectories/tripod_standin";
/// A hostile text for names, descriptions and files.
const HOSTILE: &str = "</script><script>document.title='run'</script><img src=x onerror=alert(1)>]]>\"'&\u{202e}{{answer}}";

fn tripod() -> Morphology {
    Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap()
}

fn two_seconds(robot: &Morphology) -> Experiment {
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 2.0;
    // Every sample is a step: nothing between two steps is interpolated.
    experiment.sampling = Sampling::Rate(60.0);
    experiment
}

#[test]
fn a_film_is_the_run_and_parts_follow_from_the_joints() {
    let robot = tripod();
    let experiment = two_seconds(&robot);
    let (_, film) = film(&experiment).unwrap();
    let film = film.unwrap();
    let plain = run(&experiment).unwrap().outcome.into_result().unwrap();
    assert_eq!(film.track.positions_world_m(), plain.positions_world_m());
    assert_eq!(film.parts.len(), experiment.assembly.parts.len());

    // Written, read, and the same to the last bit; nothing is said to be ignored.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parts.csv");
    write_with_bodies(&file, &film.track, &film.bodies().unwrap()).unwrap();
    let recording = trajectory::read(&file, Reading::default()).unwrap();
    let ignored = |code| code == Code::ColumnsIgnored;
    assert!(
        !recording.warnings.iter().any(|w| ignored(w.code)),
        "{:?}",
        recording.warnings
    );
    let back = Film::of_recording(&experiment.assembly, &recording);
    assert_eq!(
        back.track.positions_world_m(),
        film.track.positions_world_m()
    );
    assert_eq!(back.track.joints(), film.track.joints());
    let places = |film: &Film| -> Vec<_> {
        let all = film.parts.iter().flatten().flatten();
        all.map(|pose| pose.translation.vector).collect()
    };
    assert_eq!(places(&back), places(&film));

    // Without the parts' columns they follow from the tracked module and the joints: this robot's hinges hold.
    let mut without = recording.clone();
    without.bodies.clear();
    let followed = Film::of_recording(&experiment.assembly, &without);
    for (a, b) in places(&followed).iter().zip(places(&film)) {
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
    // Without joints only the part of the tracked module is known.
    let real = trajectory::read(
        common::project().join(RUNS).join("run_00.csv"),
        Reading::default(),
    );
    let real = Film::of_recording(&experiment.assembly, &real.unwrap());
    assert_eq!(real.parts.iter().flatten().count(), 1);
}

#[test]
fn an_arm_with_recorded_joints_only_is_shown_in_its_recorded_poses() {
    let arm = Morphology::read(common::project().join("morphologies/so101_arm.ron")).unwrap();
    let experiment = two_seconds(&arm);
    let (_, film) = film(&experiment).unwrap();
    let film = film.unwrap();
    let nowhere = vec![Vector3::zeros(); film.track.len()];
    let joints = Trajectory::new(film.track.times_s().to_vec(), nowhere)
        .and_then(|path| path.with_joints(film.track.joints().to_vec()))
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("joints.csv");
    trajectory::write(&file, &joints).unwrap();
    let recording = trajectory::read(&file, Reading::default()).unwrap();
    assert!(recording.trajectory.is_of_joints());
    let shown = Film::of_recording(&experiment.assembly, &recording);
    let pairs = shown.parts.iter().zip(&film.parts);
    for (part, (shown, film)) in pairs.enumerate() {
        let (shown, film) = (shown.as_ref().unwrap(), film.as_ref().unwrap());
        for (a, b) in shown.iter().zip(film) {
            let apart_m = (a.translation.vector - b.translation.vector).norm();
            assert!(apart_m < 1e-4, "part {part}: {apart_m} m");
        }
    }
    let paths = [&shown.track, &film.track].map(|track| track.positions_world_m().last().copied());
    let apart_m = (paths[0].unwrap() - paths[1].unwrap()).norm();
    assert!(apart_m < 1e-4, "tip: {apart_m} m");
}

#[test]
fn a_body_beside_the_robot_moves_in_the_film_and_on_the_page() {
    let robot = tripod();
    let mut experiment = two_seconds(&robot);
    let start: Isometry3<f64> = Isometry3::translation(0.5, 0.5, 0.3);
    experiment.scene.push(SceneBody {
        name: "box".to_owned(),
        boxes: vec![SceneBox {
            sides_m: Vector3::repeat(0.05),
            body_from_box: Isometry3::identity(),
        }],
        friction: 0.5,
        motion: SceneMotion::Free {
            world_from_body: start,
            mass_kg: 0.1,
        },
    });
    let film = film(&experiment).unwrap().1.unwrap();
    let heights: Vec<f64> = film.scene[0].iter().map(|p| p.translation.z).collect();
    assert_eq!(heights.len(), film.track.len());
    // It lies on the floor at the end: half an edge above it.
    let last = heights[heights.len() - 1];
    assert!((last - 0.025).abs() < 0.002, "{last}");
    let replay = |scene| {
        let replay = Replay {
            robot: Some(&robot),
            run: &film,
            run_name: SIMULATION,
            recordings: &[],
            align: true,
            floor: Floor::default(),
            scene,
            warnings: &[],
            provenance: &[],
        };
        replay.page().unwrap()
    };
    let (with, without) = (replay(&experiment.scene), replay(&[]));
    assert!(with.contains("\"kind\":\"scene\"") && !without.contains("\"kind\":\"scene\""));
    assert!(with.len() > without.len() + 1000);
}

fn write_page(folder: &Path, args: &[&str]) -> (PathBuf, String) {
    let page = folder.join("replay.html");
    let output = realgap()
        .args(args)
        .args(["-o", page.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let text = std::fs::read_to_string(&page).unwrap();
    (page, text)
}

fn tripod_page(folder: &Path) -> (PathBuf, String) {
    let runs = [0, 1, 2].map(|k| format!("{RUNS}/run_{k:02}.csv"));
    let mut args = vec!["replay", "morphologies/tripod.ron", "--against"];
    args.extend(runs.iter().map(String::as_str));
    write_page(folder, &args)
}

#[test]
fn a_page_is_small_asks_no_network_and_is_readable_without_scripts() {
    let folder = tempfile::tempdir().unwrap();
    let (_, page) = tripod_page(folder.path());
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    // Names of XML dialects are no addresses.
    let page_without_names = page.replace("http://www.w3.org/", "");
    for reference in [
        "http://", "https://", "src=\"", "href=\"", "url(", "@import",
    ] {
        assert!(!page_without_names.contains(reference), "{reference}");
    }
    for said in [
        "default-src 'none'",
        "stand-ins",
        "run_02",
        "net displacement",
        "sha256",
        "<svg",
    ] {
        assert!(page.contains(said), "{said}");
    }
    assert!(
        !page.contains("'unsafe-"),
        "the content policy allows what it should not"
    );
    // Same data, same bytes.
    let again = tempfile::tempdir().unwrap();
    let (_, second) = tripod_page(again.path());
    let without_command = |page: &str| page.split("<dt>command").next().unwrap().to_owned();
    assert_eq!(without_command(&page), without_command(&second));
}

#[test]
fn a_run_of_a_file_is_shown_with_all_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("parts.csv");
    let simulated = folder.path().join("simulated.html");
    let [parts_arg, page_arg] = [&parts, &simulated].map(|p| p.to_str().unwrap());
    realgap()
        .args(["simulate", "morphologies/tripod.ron", "--duration", "1"])
        .args(["--parts", parts_arg, "--replay", page_arg])
        .assert()
        .success();
    let robot = ["--robot", "morphologies/tripod.ron"];
    let (_, page) = write_page(folder.path(), &["replay", parts_arg, robot[0], robot[1]]);
    let motion = |page: &str| {
        let start = page.split_once("id=\"motion-data\">").unwrap().1;
        start.split_once('<').unwrap().0.to_owned()
    };
    let simulated = std::fs::read_to_string(simulated).unwrap();
    assert_eq!(motion(&simulated), motion(&page));
    let (_, point) = write_page(folder.path(), &["replay", &format!("{RUNS}/run_00.csv")]);
    assert!(point.contains("path only"));
}

#[test]
fn a_page_that_cannot_be_written_is_an_error_before_the_work() {
    for (args, said) in [
        (
            vec!["replay", "morphologies/tripod.ron", "-o", "page.txt"],
            ".html",
        ),
        (
            vec![
                "replay",
                "real_trajectories/tripod_standin/run_00.csv",
                "--duration",
                "3",
            ],
            "--duration",
        ),
        (
            vec![
                "replay",
                "morphologies/tripod.ron",
                "--robot",
                "morphologies/cube.ron",
            ],
            "--robot",
        ),
    ] {
        let output = realgap().args(&args).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(
            text(&output.stderr).contains(said),
            "{}",
            text(&output.stderr)
        );
    }
}

/// A page in which every foreign text is hostile.
fn hostile_page() -> String {
    let robot = tripod();
    let experiment = two_seconds(&robot);
    let (_, film) = film(&experiment).unwrap();
    let film = film.unwrap();
    let path = common::project().join(RUNS).join("run_00.csv");
    let mut recording = trajectory::read(path, Reading::default()).unwrap();
    recording.name = HOSTILE.to_owned();
    let warnings = [Code::ReadAs.warning(HOSTILE)];
    let replay = Replay {
        robot: Some(&robot),
        run: &film,
        run_name: HOSTILE,
        recordings: &[recording],
        align: true,
        floor: Floor::default(),
        scene: &[],
        warnings: &warnings,
        provenance: &[(HOSTILE.to_owned(), HOSTILE.to_owned())],
    };
    assert_ne!(replay.run_name, SIMULATION);
    replay.page().unwrap()
}

#[test]
fn no_foreign_text_becomes_markup() {
    let page = hostile_page();
    assert!(!page.contains("<img") && !page.contains("<script>document.title"));
    assert!(!page.contains('\u{202e}'));
    assert_eq!(
        page.matches("<script>").count(),
        7,
        "the page's own scripts"
    );
    // The template's name inside of a foreign text is that text.
    assert!(page.contains("{{answer}}"));
}

#[test]
fn a_browser_runs_no_foreign_script_of_a_hostile_page() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("hostile.html");
    std::fs::write(&page, hostile_page()).unwrap();
    browser.open(&page, "#t=0.5");
    // The page's own scripts run.
    browser.wait("realgap.ready === true");
    assert_eq!(browser.value("document.title"), "tripod: replay");
    assert_eq!(browser.value("document.querySelectorAll('img').length"), 0);
    browser.is_quiet("the hostile page");
}
