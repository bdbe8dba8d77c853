//! Robots come from URDF and MJCF, and what does not come is said.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::Path;

use common::{realgap, text};
use realgap::file::Source;
use realgap::import::Options;
use realgap::robot::morphology::Morphology;

fn import(urdf: &str) -> (Morphology, Vec<String>) {
    let source = Source::new("robot.urdf", urdf);
    let (robot, notes) = Morphology::import(&source, &Options::default()).unwrap();
    (robot, notes.iter().map(ToString::to_string).collect())
}

const LINK: &str = r#"<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="2e-4" izz="3e-4"/></inertial>
    <collision><geometry><box size="0.1 0.06 0.04"/></geometry></collision>"#;

#[test]
fn what_is_exported_comes_back_with_the_same_masses_moments_and_places() {
    for name in ["elbow", "tripod", "chain3"] {
        let folder = tempfile::tempdir().unwrap();
        let urdf = folder.path().join("robot.urdf");
        let shipped = format!("morphologies/{name}.ron");
        realgap()
            .args(["export", &shipped, "--format", "urdf", "-o"])
            .arg(&urdf)
            .assert()
            .success();
        let ron = folder.path().join("robot.ron");
        realgap()
            .arg("import")
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
fn an_imported_pendulum_swings_as_its_length_says() {
    let urdf = format!(
        r#"<robot name="swing"><link name="world"/><link name="bob">{LINK}</link><link name="arm">{LINK}</link>
        <joint name="fix" type="fixed"><origin xyz="0 0 1"/><parent link="world"/><child link="bob"/></joint>
        <joint name="pivot" type="revolute"><origin xyz="0 0 -0.1" rpy="0 0 1.5707963267948966"/><parent link="bob"/><child link="arm"/>
        <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="0.5" velocity="3"/><dynamics damping="0.01" friction="0.002"/></joint></robot>"#
    );
    let (robot, left_out) = import(&urdf);
    let assembly = robot.assemble();
    let hinge = &assembly.hinges[0];
    // The joint's frame is turned by a quarter: its x is the robot's y.
    assert!(
        (hinge.axis_robot.y - 1.0).abs() < 1e-9,
        "{:?}",
        hinge.axis_robot
    );
    assert_eq!(hinge.bearing.limits_rad, Some((-1.0, 1.0)));
    assert!((hinge.bearing.viscous_nm_s_rad - 0.01).abs() < 1e-12);
    assert!(
        left_out
            .iter()
            .any(|said| said.contains("the servos of 1 joints")),
        "{left_out:?}"
    );
    // Moments turn with the frame.
    let arm = assembly.parts[hinge.child_part].mass(&nalgebra::Isometry3::identity());
    assert!(
        (arm.inertia_kg_m2[(0, 0)] - 2e-4).abs() < 1e-9,
        "{}",
        arm.inertia_kg_m2
    );
    assert!(assembly.world_from_mount.is_some());
}

#[test]
fn links_that_are_fixed_to_each_other_are_one_body() {
    let (robot, _) = import(&format!(
        r#"<robot name="two"><link name="a">{LINK}</link><link name="b">{LINK}</link>
        <joint name="j" type="fixed"><origin xyz="0.1 0 0"/><parent link="a"/><child link="b"/></joint></robot>"#
    ));
    let assembly = robot.assemble();
    assert_eq!(assembly.parts.len(), 1);
    let mass = assembly.parts[0].mass(&nalgebra::Isometry3::identity());
    assert!((mass.mass_kg - 0.4).abs() < 1e-12);
    // Steiner: two masses of 0.2 kg, each 5 cm from the middle.
    let expected = 2.0 * 2e-4 + 0.4 * 0.05 * 0.05;
    assert!(
        (mass.inertia_kg_m2[(1, 1)] - expected).abs() < 1e-9,
        "{}",
        mass.inertia_kg_m2
    );
}

#[test]
fn what_realgap_did_not_write_is_not_replaced() {
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
            .arg("import")
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
    // It ends with the commands that come next.
    for next in ["realgap check", "realgap simulate", "realgap replay"] {
        assert!(said.contains(next), "{said}");
    }
    // What it wrote itself it replaces, and the report is JSON where that is asked for.
    let (code, said) = import(&["--format", "json"]);
    assert!(code == Some(0) && said.contains("\"notes\""), "{said}");
    let missing = realgap().args(["import", "no_such.urdf"]).output().unwrap();
    assert_eq!(missing.status.code(), Some(1));
    assert!(text(&missing.stderr).contains("no_such.urdf") && !Path::new("no_such.urdf").exists());
}
