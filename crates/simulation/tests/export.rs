//! Tests of exported robots: they are complete, well formed, and accepted by the target simulators.
//!
//! The tests with simulators need Python with `mujoco` or `pybullet` (tools/requirements-engines.txt), as `REALGAP_PYTHON` or
//! `python3`. Without these packages the tests print a message and pass.
#![allow(clippy::unwrap_used)] // a test may fail loudly

use crate::common;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::python_with;
use realgap_core::file::Source;
use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{FORMATS, Robot, format_named};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Experiment, JointFormulation, JointState, run};
use roxmltree::{Document, Node};

fn folder() -> PathBuf {
    common::project().to_path_buf()
}

fn shipped() -> Vec<Morphology> {
    let mut paths: Vec<_> = std::fs::read_dir(folder().join("morphologies"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths.iter().map(|p| Morphology::read(p).unwrap()).collect()
}

fn named(name: &str) -> Morphology {
    Morphology::read(folder().join(format!("morphologies/{name}.ron"))).unwrap()
}

/// A servo whose cube is attached to its parent by the driven face, so that axis and cube are reversed.
fn hanging() -> Morphology {
    let text = r#"(
        name: "hanging",
        description: "-- <&> \"quoted\" --",
        defaults: (side_m: 0.06, mass_kg: 0.1, servo: (law: Velocity(gain_1_s: 20.0), max_torque_nm: 0.3)),
        modules: [
            (name: "root", kind: Passive(centre_of_mass_m: (0.01, 0.0, -0.02))),
            (name: "arm", kind: Active(face: NegX, axis: Normal(plate: (side_m: 0.05, thickness_m: 0.004, mass_kg: 0.02)),
                gait: (offset_rad: 0.2, amplitude_rad: 0.3, frequency_hz: 1.0))),
            (name: "tip", kind: Passive(inertia_kg_m2: (1e-4, 2e-4, 2.5e-4))),
        ],
        glue: [
            (parent: "root", face: PosX, child: "arm", child_face: NegX, quarter_turns: 1),
            (parent: "arm", face: PosY, child: "tip", child_face: PosZ, quarter_turns: 3),
        ],
        track: "tip",
    )"#;
    Morphology::parse(&Source::new("hanging.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

fn render(morphology: &Morphology, format: &str, values: &[(&str, f64)]) -> String {
    let set = values
        .iter()
        .fold(ParameterSet::new(), |set, (name, value)| {
            set.with(format!("{name}={value}").parse().unwrap())
        });
    let experiment = set.apply(&Experiment::new(morphology.assemble()));
    format_named(format)
        .unwrap()
        .render(&Robot::new(morphology, &experiment))
        .text
}

fn all<'a>(document: &'a Document<'a>, tag: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |n| n.has_tag_name(tag))
}

fn numbers(node: Node<'_, '_>, attribute: &str) -> Vec<f64> {
    let text = node.attribute(attribute).unwrap();
    text.split(' ').map(|word| word.parse().unwrap()).collect()
}

#[test]
fn every_robot_is_well_formed_complete_and_its_names_are_unique() {
    for morphology in shipped().into_iter().chain([hanging()]) {
        let assembly = morphology.assemble();
        let mass_kg = morphology.summary().mass_kg;
        for format in FORMATS {
            let exported =
                format.render(&Robot::new(&morphology, &Experiment::new(assembly.clone())));
            let document = Document::parse(&exported.text)
                .unwrap_or_else(|e| panic!("{} {}: {e}", morphology.name(), format.name()));
            let masses: f64 = all(&document, "inertial")
                .map(|n| match format.name() {
                    "mjcf" => numbers(n, "mass")[0],
                    _ => {
                        let mass = n.children().find(|c| c.has_tag_name("mass"));
                        numbers(mass.unwrap(), "value")[0]
                    }
                })
                .sum();
            assert!(
                (masses - mass_kg).abs() < 1e-12 * mass_kg,
                "{masses} is not {mass_kg}"
            );
            let part = if format.name() == "mjcf" {
                "body"
            } else {
                "link"
            };
            // URDF fixes a mounted robot by a joint to a link of the world.
            let world = part == "link" && assembly.world_from_mount.is_some();
            let bodies = assembly.parts.len() + usize::from(world);
            assert_eq!(all(&document, part).count(), bodies);
            for tag in [
                "body",
                "geom",
                "joint",
                "link",
                "general",
                "numeric",
                "text",
                "collision",
            ] {
                let mut seen = HashSet::new();
                for name in all(&document, tag).filter_map(|n| n.attribute("name")) {
                    assert!(
                        seen.insert(name),
                        "two {tag} {name} in {}",
                        morphology.name()
                    );
                }
            }
            let hinges = all(&document, "joint").filter(|n| n.has_attribute("type"));
            assert_eq!(hinges.count(), assembly.hinges.len() + usize::from(world));
        }
    }
}

#[test]
fn warnings_about_missing_properties_are_comments_in_the_file() {
    for format in FORMATS {
        let morphology = named("tripod");
        let robot = Robot::new(&morphology, &Experiment::new(morphology.assemble()));
        let exported = format.render(&robot);
        assert!(!exported.warnings.is_empty() && !format.doc().is_empty());
        for warning in &exported.warnings {
            assert!(
                exported.text.contains(&warning.message),
                "{warning} is missing"
            );
        }
    }
}

#[test]
fn missing_compliance_of_bearings_gives_a_warning() {
    for format in ["mjcf", "urdf"] {
        let of = |hz: f64| render(&named("elbow"), format, &[("hinge.bearing_hz", hz)]);
        assert!(of(200.0).contains("compliance") || of(200.0).contains("hinge.bearing_hz"));
        assert!(!of(0.0).contains("compliance") && !of(0.0).contains("hinge.bearing_hz"));
    }
}

#[test]
fn mjcf_contains_gait_servo_floor_and_calibrated_values() {
    let text = render(
        &named("tripod"),
        "mjcf",
        &[
            ("floor.friction", 0.7),
            ("floor.height_m", 0.01),
            ("gait.frequency_scale", 2.0),
            ("body.mass_scale", 1.5),
        ],
    );
    let document = Document::parse(&text).unwrap();
    let custom = |name: &str| {
        let node = all(&document, "numeric").find(|n| n.attribute("name") == Some(name));
        numbers(node.unwrap(), "data")
    };
    assert_eq!(custom("gait_leg_b"), [0.4451, 0.9525, 2.5, 3.987]);
    assert_eq!(custom("servo_leg_b"), [30.0, 8.0, 0.2]);
    let floor = all(&document, "geom").find(|n| n.attribute("name") == Some("floor"));
    assert_eq!(numbers(floor.unwrap(), "friction")[0], 0.7);
    assert_eq!(numbers(floor.unwrap(), "pos"), [0.0, 0.0, 0.01]);
    let mass: f64 = all(&document, "inertial")
        .map(|n| numbers(n, "mass")[0])
        .sum();
    assert!((mass - 1.5 * 0.27).abs() < 1e-12);
    let excluded = all(&document, "exclude").count();
    assert_eq!(excluded, 3, "joined parts must not collide");
}

/// Runs a Python script with arguments; returns `None` and prints a message if the package is missing.
fn python(package: &str, script: &str, arguments: &[&Path]) -> Option<String> {
    let python = python_with(package)?;
    let done = Command::new(&python)
        .arg("-c")
        .arg(script)
        .args(arguments)
        // The script imports modules from the folder of tools, where no compiled copies may be left.
        .env("PYTHONPATH", folder().join("tools"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(
        done.status.success(),
        "{said}\n{}",
        String::from_utf8_lossy(&done.stderr)
    );
    Some(said)
}

fn write_all(format: &str, to: &Path) -> Vec<PathBuf> {
    shipped()
        .into_iter()
        .chain([hanging()])
        .map(|morphology| {
            let path = to.join(format!("{}.{format}", morphology.name()));
            std::fs::write(&path, render(&morphology, format, &[])).unwrap();
            path
        })
        .collect()
}

#[test]
fn mujoco_loads_and_simulates_every_robot() {
    let folder = tempfile::tempdir().unwrap();
    let files = write_all("mjcf", folder.path());
    let script = r"
import sys, numpy as np
from standin import Robot
for path in sys.argv[1:]:
    robot = Robot(path)
    data = robot.place()
    robot.settle(data)
    t, p, q = robot.walk(data, 0.5, 30)
    # A mounted robot may hang high above the floor: what counts is that none jumps, falls or flies off.
    assert np.isfinite(p).all() and np.abs(p - p[0]).max() < 1, (path, p)
    assert not robot.is_free or abs(p[:, 2]).max() < 1, (path, p)
    up = robot.model.body_mass.sum()
    print(robot.name, len(t), up)
";
    let arguments: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let Some(said) = python("mujoco", script, &arguments) else {
        return;
    };
    assert_eq!(said.lines().count(), files.len(), "{said}");
}

#[test]
fn mujoco_and_realgap_compute_the_same_mass_properties() {
    let morphology = hanging();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hanging.mjcf");
    std::fs::write(&path, render(&morphology, "mjcf", &[])).unwrap();
    // Centre of mass and inertia of the whole robot about it, at zero angles, root at the origin.
    let script = r"
import sys, numpy as np, mujoco
m = mujoco.MjModel.from_xml_path(sys.argv[1]); d = mujoco.MjData(m)
d.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]; mujoco.mj_forward(m, d)
c = sum(m.body_mass[b] * d.xipos[b] for b in range(1, m.nbody)) / m.body_mass.sum()
I = np.zeros((3, 3))
for b in range(1, m.nbody):
    R = d.ximat[b].reshape(3, 3); r = d.xipos[b] - c
    I += R @ np.diag(m.body_inertia[b]) @ R.T + m.body_mass[b] * (r @ r * np.eye(3) - np.outer(r, r))
print(*c, *I.ravel(), *d.site('track').xpos)
";
    let Some(said) = python("mujoco", script, &[&path]) else {
        return;
    };
    let seen: Vec<f64> = said
        .split_whitespace()
        .map(|w| w.parse().unwrap())
        .collect();
    let assembly = morphology.assemble();
    let centre = morphology.summary().centre_of_mass_robot_m;
    let mut inertia = nalgebra::Matrix3::zeros();
    for solid in assembly.parts.iter().flat_map(|part| &part.solids) {
        let turn = solid.robot_from_solid.rotation.to_rotation_matrix();
        let at = solid.robot_from_solid * nalgebra::Point3::from(solid.centre_of_mass_solid_m);
        let d = at.coords - centre;
        inertia += turn * solid.inertia_kg_m2 * turn.transpose()
            + (nalgebra::Matrix3::identity() * d.norm_squared() - d * d.transpose())
                * solid.mass_kg;
    }
    let track = assembly.robot_from_track.translation.vector;
    let expected = centre.iter().chain(&inertia).chain(&track);
    assert_eq!(seen.len(), 15);
    for (expected, seen) in expected.zip(&seen) {
        assert!((expected - seen).abs() < 1e-9, "{expected} is not {seen}");
    }
}

/// An arm of two boxes on a mounted stand, with friction and limits.
fn pendulum() -> Morphology {
    let text = r#"(
        name: "pendulum",
        mount_m: (0, 0, 1),
        modules: [
            (name: "stand", kind: Passive(side_m: 0.05, mass_kg: 1)),
            (name: "arm", kind: Passive(sides_m: (0.06, 0.02, 0.2), mass_kg: 0.2, centre_of_mass_m: (0.004, 0, -0.01),
                boxes: [(sides_m: (0.02, 0.02, 0.2)), (sides_m: (0.06, 0.02, 0.04), centre_m: (0, 0, -0.08))])),
        ],
        hinges: [(name: "shoulder", parent: "stand", child: "arm", anchor_m: (0, 0.05, 0), child_anchor_m: (0, 0, 0.1),
            axis: (0, 1, 0.2), viscous_nm_s_rad: 1e-3, dry_nm: 0.004, limits_rad: (-1.2, 1.2))],
        never_touch: [("stand", "arm")],
    )"#;
    Morphology::parse(&Source::new("pendulum.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn hinges_with_friction_and_limits_and_mounts_are_in_both_formats() {
    let robot = pendulum();
    let text = render(&robot, "mjcf", &[("hinge.dry_nm", 0.01)]);
    let document = Document::parse(&text).unwrap();
    let joint = all(&document, "joint").next().unwrap();
    assert_eq!(joint.attribute("name"), Some("shoulder"));
    assert_eq!(numbers(joint, "damping"), [1e-3]);
    assert_eq!(numbers(joint, "frictionloss"), [0.01]);
    assert_eq!(numbers(joint, "range"), [-1.2, 1.2]);
    assert_eq!(
        all(&document, "freejoint").count() + all(&document, "general").count(),
        0
    );
    let text = render(&robot, "urdf", &[]);
    let document = Document::parse(&text).unwrap();
    let kind = |name: &str| {
        let joint = all(&document, "joint").find(|n| n.attribute("name") == Some(name));
        joint.unwrap().attribute("type").unwrap().to_owned()
    };
    assert_eq!(
        (kind("mount"), kind("shoulder")),
        ("fixed".to_owned(), "revolute".to_owned())
    );
    let dynamics = all(&document, "dynamics").next().unwrap();
    assert_eq!(numbers(dynamics, "friction"), [0.004]);
}

#[test]
fn mujoco_swings_a_pendulum_as_realgap_does() {
    let robot = pendulum();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pendulum.mjcf");
    std::fs::write(&path, render(&robot, "mjcf", &[])).unwrap();
    let script = r"
import sys, mujoco
m = mujoco.MjModel.from_xml_path(sys.argv[1]); d = mujoco.MjData(m)
d.qpos[0] = 1.0
while d.time < 1.5 - 1e-9: mujoco.mj_step(m, d)
print(d.qpos[0], d.qvel[0])
";
    let Some(said) = python("mujoco", script, &[&path]) else {
        return;
    };
    let seen: Vec<f64> = said
        .split_whitespace()
        .map(|w| w.parse().unwrap())
        .collect();
    for kind in [JointFormulation::Impulse, JointFormulation::Multibody] {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.solver.joint = kind;
        experiment.solver.timestep_s = 1.0 / 2000.0;
        experiment.duration_s = 1.5;
        experiment.start_joints = vec![JointState {
            angle_rad: 1.0,
            speed_rad_s: 0.0,
        }];
        let motion = run(&experiment).unwrap().outcome.completed().unwrap();
        let joint = motion.joint("shoulder").unwrap();
        let angle_rad = joint.angles_rad[joint.angles_rad.len() - 1];
        assert!(
            (angle_rad - seen[0]).abs() < 0.02,
            "{kind:?}: {angle_rad} is not {}",
            seen[0]
        );
    }
}

#[test]
fn pybullet_loads_and_simulates_every_robot() {
    let folder = tempfile::tempdir().unwrap();
    let files = write_all("urdf", folder.path());
    let script = r"
import sys, pybullet as p
for path in sys.argv[1:]:
    client = p.connect(p.DIRECT)
    p.setGravity(0, 0, -9.81); p.setTimeStep(1 / 240)
    p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
    robot = p.loadURDF(path, [0, 0, 0.5], flags=p.URDF_USE_INERTIA_FROM_FILE)
    joints = [p.getJointInfo(robot, j)[2] for j in range(p.getNumJoints(robot))]
    mass = sum(p.getDynamicsInfo(robot, link)[0] for link in range(-1, len(joints)))
    for _ in range(480): p.stepSimulation()
    x, y, z = p.getBasePositionAndOrientation(robot)[0]
    mounted = joints.count(p.JOINT_FIXED)
    # A mounted robot stays where it is put; all others fall on the floor and not through it.
    assert z == 0.5 if mounted else 0 < z < 0.5, (path, mounted, z)
    print('REALGAP', path.split('/')[-1].split('.')[0], mounted, joints.count(p.JOINT_REVOLUTE), mass)
    p.disconnect(client)
";
    let arguments: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let Some(said) = python("pybullet", script, &arguments) else {
        return;
    };
    for morphology in shipped().into_iter().chain([hanging()]) {
        let line = said
            .lines()
            .find_map(|l| l.strip_prefix(&format!("REALGAP {} ", morphology.name())))
            .unwrap_or_else(|| panic!("{} is missing in {said}", morphology.name()));
        let assembly = morphology.assemble();
        let seen: Vec<f64> = line
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        let [mounted, hinges, mass_kg] = seen[..] else {
            panic!("{line}")
        };
        assert_eq!(
            mounted == 1.0,
            assembly.world_from_mount.is_some(),
            "{line}"
        );
        assert_eq!(hinges as usize, assembly.hinges.len(), "{line}");
        assert!((mass_kg - morphology.summary().mass_kg).abs() < 1e-6);
    }
}
