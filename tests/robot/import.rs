//! `robot import` reads the files of `robot export`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common::{self, realgap, text};
use realgap::file::Source;
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, JointFormulation, JointState, watch};

#[test]
fn an_exported_robot_is_imported_with_the_same_masses_moments_and_places() {
    for name in ["elbow", "tripod", "chain3"] {
        let folder = tempfile::tempdir().unwrap();
        let urdf = folder.path().join("robot.urdf");
        let shipped = format!("morphologies/{name}.ron");
        realgap()
            .args(["robot", "export", &shipped, "--format", "urdf", "-o"])
            .arg(&urdf)
            .assert()
            .success();
        let ron = folder.path().join("robot.ron");
        realgap()
            .args(["robot", "import"])
            .arg(&urdf)
            .arg("-o")
            .arg(&ron)
            .assert()
            .success();
        let before = Morphology::read(common::project().join(&shipped))
            .unwrap()
            .assemble();
        let after = Morphology::read(&ron).unwrap().assemble();
        assert_eq!(before.parts.len(), after.parts.len(), "{name}");
        assert_eq!(before.hinges.len(), after.hinges.len(), "{name}");
        // The robot's frame is its root module's, and that is another one here.
        let masses = |assembly: &realgap::robot::morphology::Assembly| {
            let parts = assembly.parts.iter();
            let mut all: Vec<_> = parts
                .map(|part| part.mass(&nalgebra::Isometry3::identity()))
                .collect();
            all.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
            all
        };
        let total = |assembly| masses(assembly).iter().map(|m| m.mass_kg).sum::<f64>();
        assert!((total(&before) - total(&after)).abs() < 1e-9, "{name}");
        for (one, other) in masses(&before).iter().zip(masses(&after)) {
            assert!((one.mass_kg - other.mass_kg).abs() < 1e-9);
            let difference = one.inertia_kg_m2.diagonal() - other.inertia_kg_m2.diagonal();
            let scale = one.inertia_kg_m2.diagonal().amax();
            assert!(difference.amax() < 1e-6 * scale, "{name}: {difference}");
        }
        let spans = |assembly: &realgap::robot::morphology::Assembly| {
            let hinges = assembly.hinges.iter();
            let at: Vec<_> = hinges.map(|hinge| hinge.anchor_robot_m).collect();
            at.iter()
                .map(|one| (one - at[0]).norm())
                .collect::<Vec<_>>()
        };
        for (one, other) in spans(&before).iter().zip(spans(&after)) {
            assert!((one - other).abs() < 1e-9, "{name}");
        }
    }
}

#[test]
fn a_file_that_is_not_there_is_named_and_not_made() {
    let said = realgap()
        .args(["robot", "import", "no_such.urdf"])
        .output()
        .unwrap();
    assert_eq!(said.status.code(), Some(1));
    assert!(text(&said.stderr).contains("no_such.urdf"));
    assert!(!Path::new("no_such.urdf").exists());
}

const LINK: &str = r#"<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="2e-4" izz="3e-4"/></inertial>
    <collision><geometry><box size="0.1 0.06 0.04"/></geometry></collision>"#;

#[test]
fn files_that_realgap_did_not_write_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (urdf, ron) = (folder.path().join("r.urdf"), folder.path().join("r.ron"));
    std::fs::write(
        &urdf,
        format!(r#"<robot name="r"><link name="a">{LINK}</link></robot>"#),
    )
    .unwrap();
    std::fs::write(&ron, "// mine").unwrap();
    let import = |more: &[&str]| {
        let said = realgap()
            .args(["robot", "import"])
            .arg(&urdf)
            .arg("-o")
            .arg(&ron)
            .args(more)
            .output()
            .unwrap();
        (
            said.status.code(),
            text(&said.stdout).to_owned() + &text(&said.stderr),
        )
    };
    let (code, said) = import(&[]);
    assert!(code != Some(0) && said.contains("--force"), "{said}");
    assert_eq!(std::fs::read_to_string(&ron).unwrap(), "// mine");
    let (code, said) = import(&["--force"]);
    assert_eq!(code, Some(0), "{said}");
    // It ends with the three commands that come next, which work as they are printed.
    let next = said
        .lines()
        .filter_map(|line| line.strip_prefix("  realgap "));
    let next: Vec<&str> = next.collect();
    assert_eq!(next.len(), 3, "{said}");
    for command in next {
        let mut process = realgap();
        process.args(command.split(' ')).current_dir(folder.path());
        let said = process.output().unwrap();
        assert!(said.status.success(), "{command}: {}", text(&said.stderr));
    }
    // It replaces files that it wrote itself, and prints the report as JSON with --format json.
    let (code, said) = import(&["--format", "json"]);
    assert!(code == Some(0) && said.contains("\"notes\""), "{said}");
    let missing = realgap()
        .args(["robot", "import", "no_such.urdf"])
        .output()
        .unwrap();
    assert_eq!(missing.status.code(), Some(1));
    assert!(text(&missing.stderr).contains("no_such.urdf") && !Path::new("no_such.urdf").exists());
}

#[test]
fn a_light_link_keeps_the_moment_of_each_of_its_axes() {
    // Moments that differ by a few 1e-6 kg m²: about the hinge the smallest, in the middle, the largest.
    for [x, y, z] in [
        [4e-6, 1e-6, 4.5e-6],
        [1e-6, 3e-6, 3.5e-6],
        [2e-6, 3e-6, 1.5e-6],
    ] {
        let text = format!(
            r#"(
            name: "light",
            bodies: [(name: "stand", mass_kg: 1, inertia_kg_m2: (xx: 1, yy: 1, zz: 1)),
                (name: "link", mass_kg: 0.02, centre_of_mass_m: (0, 0, -0.01), inertia_kg_m2: (xx: {x:e}, yy: {y:e}, zz: {z:e}))],
            joints: [(name: "j", parent: "stand", child: "link", kind: Turn(axis: (0, 1, 0)))],
            mount: (at_m: (0, 0, 1)),
        )"#
        );
        let robot = Morphology::parse(&Source::new("light.ron", text)).unwrap();
        // A quarter of a period of a physical pendulum from 0.02 rad.
        let (moment, inertia) = (0.02 * 0.01, y + 0.02 * 0.01 * 0.01);
        let quarter_s = 0.25 * std::f64::consts::TAU * (inertia / (moment * 9.81_f64)).sqrt();
        for kind in [JointFormulation::Impulse, JointFormulation::Multibody] {
            let mut experiment = Experiment::new(robot.assemble());
            experiment.solver.joint = kind;
            experiment.solver.timestep_s = 1e-3;
            experiment.start_joints = vec![JointState {
                angle_rad: 0.02,
                speed_rad_s: 0.0,
            }];
            experiment.duration_s = 2.0 * quarter_s;
            let mut film: Vec<(f64, f64)> = Vec::new();
            let run = watch(&experiment, &[], &mut |s| {
                film.push((s.time_s, s.hinges[0].angle_rad));
            });
            assert!(run.unwrap().outcome.is_completed());
            let zero = film.iter().position(|(_, angle)| *angle <= 0.0).unwrap();
            let ((t, a), (u, b)) = (film[zero - 1], film[zero]);
            let measured_s = t + (u - t) * a / (a - b);
            let off = measured_s / quarter_s - 1.0;
            assert!(
                off.abs() < 1e-2,
                "{kind:?}, {y} kg m2: {measured_s} s is not {quarter_s} s"
            );
        }
    }
}
