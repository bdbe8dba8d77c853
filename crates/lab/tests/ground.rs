//! Studies on a floor with regions, and on a height field.

use std::path::{Path, PathBuf};

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::Code;
use realgap_core::file::Source;
use realgap_lab::calibration::{Overrides, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_path::trajectory::State;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Sampling, Start, read_arena, run};

const PUCK: &str = "(name: \"puck\", bodies: [(name: \"puck\", mass_kg: 0.2, shapes: [(form: Box(sides_m: (0.2, 0.2, 0.02)))])])";
const SMOOTH: f64 = 0.2;
const ROUGH: f64 = 0.5;

fn arena(smooth: f64, rough: f64) -> String {
    format!(
        "(name: \"two\", size_m: (4.0, 4.0), boundary: Open, regions: [
            (name: \"smooth\", corners_m: [(-1, -1), (0.5, -1), (0.5, 1), (-1, 1)], friction: {smooth:?}),
            (name: \"rough\", corners_m: [(0.5, -1), (3, -1), (3, 1), (0.5, 1)], friction: {rough:?})])"
    )
}

/// Writes pucks that slide with these speeds from one region into the other, and the study that seeks both frictions.
fn recorded(folder: &Path, speeds_m_s: &[f64]) -> PathBuf {
    let robot = Morphology::parse(&Source::new("puck.ron", PUCK)).unwrap();
    let truth = Source::new("two.ron", arena(SMOOTH, ROUGH));
    let (_, ground) = read_arena(&truth, false).unwrap();
    for (index, speed) in speeds_m_s.iter().enumerate() {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.ground = ground.clone();
        experiment.floor.restitution = 0.0;
        experiment.duration_s = 0.8;
        experiment.sampling = Sampling::Rate(240.0);
        experiment.start = Start::State(State {
            position_world_m: Vector3::z() * 0.01,
            orientation_world_from_body: UnitQuaternion::identity(),
            velocity_world_m_s: Vector3::x() * *speed,
            angular_velocity_body_rad_s: Vector3::zeros(),
        });
        let motion = run(&experiment).unwrap().outcome.completed().unwrap();
        let mut text = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
        let turns = motion.orientations_world_from_body().unwrap();
        let places = motion.times_s().iter().zip(motion.positions_world_m());
        for ((t, p), q) in places.zip(turns) {
            text += &format!(
                "{t},{},{},{},{},{},{},{}\n",
                p.x, p.y, p.z, q.w, q.i, q.j, q.k
            );
        }
        std::fs::write(folder.join(format!("run_{index}.csv")), text).unwrap();
    }
    std::fs::write(folder.join("puck.ron"), PUCK).unwrap();
    std::fs::write(folder.join("two.ron"), arena(0.3, 0.3)).unwrap();
    let path = folder.join("study.ron");
    let text = "Study(morphology: \"puck.ron\", recordings: [\"run_*.csv\"], start: FromRecording, arena: \"two.ron\",
        metric: \"pose\", align: World, score: Single, set: {\"floor.restitution\": 0},
        parameters: [(name: \"floor.smooth.friction\", from: 0.05, to: 0.8), (name: \"floor.rough.friction\", from: 0.05, to: 0.8)])";
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn both_frictions_of_a_floor_of_two_regions_are_found_from_pucks_that_slide_over_both() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), &[1.2, 1.6, 2.0]);
    let study = Study::read(path, &Overrides::default()).unwrap();
    let mut doubts = study.warnings().iter();
    assert!(doubts.all(|warning| warning.code != Code::RegionUntouched));
    let answer = study.tune(
        &TuneOptions {
            optimizer: optimizer_by_name("gauss-newton").unwrap(),
            budget: 60,
            patience: None,
        },
        &RunOptions::default(),
    );
    let fit = answer.unwrap().report.tuning.unwrap().least_squares;
    for (estimate, truth) in fit.iter().zip([SMOOTH, ROUGH]) {
        let off = (estimate.value / truth - 1.0).abs();
        assert!(off < 0.05, "{truth}: {estimate:?}");
    }
}

#[test]
fn a_study_of_a_region_that_no_run_touches_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), &[0.5, 0.7]);
    let study = Study::read(path, &Overrides::default()).unwrap();
    let own = study.warnings().iter();
    let own: Vec<_> = own.filter(|w| w.code == Code::RegionUntouched).collect();
    assert_eq!(own.len(), 1, "{own:?}");
    assert!(own[0].message.contains("floor.rough.friction"), "{own:?}");
}

#[test]
fn the_heights_of_a_ground_are_part_of_a_studys_fingerprint() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path(), &[0.5]);
    let arena = arena(0.2, 0.2).replace(
        "regions:",
        "ground: HeightField(file: \"h.csv\", from_m: (-1, -1), size_m: (4, 2)), regions:",
    );
    std::fs::write(folder.path().join("two.ron"), arena).unwrap();
    let print = |heights: &str| {
        std::fs::write(folder.path().join("h.csv"), heights).unwrap();
        let study = Study::read(&path, &Overrides::default()).unwrap();
        study.fingerprint()
    };
    let flat = print("0,0\n0,0\n");
    assert!(flat.must_equal(&print("0,0\n0,0\n")).is_ok());
    assert!(flat.must_equal(&print("0,0\n0,0.001\n")).is_err());
}
