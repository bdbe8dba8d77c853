//! Export to URDF, the format of ROS and PyBullet: bodies, hinges and servo limits only.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::format::{Exported, Format};
use super::robot::{Robot, origin_robot_m};
use super::xml::{Element, numbers, vector};
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::body::convex_hull;
use realgap_robot::morphology::{Bearing, Freedom, Hinge, Shape, Solid};

/// The Unified Robot Description Format.
pub(super) struct Urdf;

/// Limits that are written for a slide without limits, metres.
const UNLIMITED_M: f64 = 1e3;
/// Speed limit that is written for a servo without one, because URDF requires a number, rad/s.
const UNLIMITED_RAD_S: f64 = 1e4;

impl Format for Urdf {
    fn name(&self) -> &'static str {
        "urdf"
    }

    fn doc(&self) -> &'static str {
        "ROS and PyBullet: bodies, hinges, limits of torque and speed; no gait, no floor"
    }

    fn render(&self, robot: &Robot<'_>) -> Exported {
        let warnings = warnings(robot);
        let comments = robot.comments(
            " PyBullet: load with URDF_USE_INERTIA_FROM_FILE.",
            &warnings,
        );
        let mut root = Element::new("robot").with("name", robot.name);
        // In URDF a root link named `world` is fixed to the world.
        let mount = robot.assembly.world_from_mount.as_ref();
        if let Some(mount) = mount.filter(|_| robot.part_name(0) != MOUNT) {
            root.push(Element::new("link").with("name", MOUNT));
            root.push(held(robot, mount));
        }
        root.push(link(robot, 0, &origin_robot_m(&robot.assembly.parts[0])));
        // Parents precede their children in the assembly, as readers of URDF expect.
        for hinge in &robot.assembly.hinges {
            root.push(link(robot, hinge.child_part, &hinge.anchor_robot_m));
            root.push(joint(robot, hinge));
        }
        let files = robot
            .hulls()
            .map(|(solid, points_m)| (mesh_name(robot, solid), stl(points_m)));
        Exported {
            text: root.document(&comments),
            warnings,
            files: files.collect(),
        }
    }
}

fn warnings(robot: &Robot<'_>) -> Vec<Warning> {
    let track = robot.assembly.robot_from_track.translation.vector
        - link_origin_robot_m(robot, robot.assembly.track_part);
    let mut warnings = vec![
        Code::FloorNotExported.warning(format!(
            "the floor, its friction {} and restitution {}{}, and gravity",
            robot.floor.friction,
            robot.floor.restitution,
            match robot.ground.is_plain() {
                true => "",
                false => ", its regions, steps and height field",
            }
        )),
        Code::TrackNotExported.warning(format!(
            "the tracked point (link {}, at {} m in its frame)",
            robot.part_name(robot.assembly.track_part),
            vector(&track)
        )),
    ];
    let floor = [robot.floor.rolling_m, robot.floor.torsional_m];
    let is_stated = floor.into_iter().flatten().any(|value| value > 0.0);
    if is_stated || robot.assembly.has_turning_shapes() {
        warnings.push(
            Code::TurningNotExported
                .warning("rolling and torsional friction of floor and shapes (`turning`)"),
        );
    }
    if robot.has_servos() {
        warnings.push(
            Code::GaitNotExported
                .warning("gait and servo law (only the limits of torque and speed are here)"),
        );
    }
    let mut bearings = robot.assembly.hinges.iter().map(|hinge| &hinge.bearing);
    let springs = |bearing: &Bearing| {
        bearing.spring.is_some() || bearing.armature_kg_m2 > 0.0 || bearing.is_compliant()
    };
    if bearings.any(springs) || !robot.assembly.marks.is_empty() {
        warnings.push(
            Code::SpringNotExported
                .warning("springs, armatures and compliance of joints, and marks"),
        );
    }
    warnings.extend(robot.of_wheels("that a throttle's torque falls with the speed"));
    if robot.mount.is_some() {
        warnings.push(
            Code::SpringNotExported
                .warning("the spring of the stand (mount.*): the robot is held rigidly"),
        );
    }
    if !robot.has_contacts {
        warnings.push(
            Code::ExclusionNotExported.warning(
                "that contacts are off (contact.on): switch them off in the other program",
            ),
        );
    }
    if !robot.assembly.hinges.is_empty() {
        warnings.push(Code::ExclusionNotExported.warning(
            "the exclusion of collisions between parts joined by a hinge (most readers assume it, URDF cannot state it)",
        ));
        if robot
            .driven_hinges()
            .any(|(_, driven)| driven.servo.max_speed_rad_s.is_infinite())
        {
            warnings.push(Code::SpeedLimitInvented.warning(format!(
                "servos without a speed limit (URDF requires one: {UNLIMITED_RAD_S} rad/s is written)"
            )));
        }
    }
    warnings
}

/// Origin of a link's frame: the anchor of the hinge that moves it, as URDF requires.
fn link_origin_robot_m(robot: &Robot<'_>, part: usize) -> Vector3<f64> {
    robot
        .assembly
        .hinges
        .iter()
        .find(|hinge| hinge.child_part == part)
        .map_or_else(
            || origin_robot_m(&robot.assembly.parts[part]),
            |hinge| hinge.anchor_robot_m,
        )
}

fn origin(position_m: &Vector3<f64>, rotation: &UnitQuaternion<f64>) -> Element {
    let (roll, pitch, yaw) = rotation.euler_angles();
    Element::new("origin")
        .with("xyz", vector(position_m))
        .with("rpy", numbers([roll, pitch, yaw]))
}

fn link(robot: &Robot<'_>, part: usize, origin_m: &Vector3<f64>) -> Element {
    let cluster = &robot.assembly.parts[part];
    let mass = cluster.mass(&Isometry3::identity());
    let i = mass.inertia_kg_m2;
    let moment = |row: usize, column: usize| numbers([i[(row, column)]]);
    let mut link = Element::new("link").with("name", robot.part_name(part));
    if mass.mass_kg > 0.0 {
        link.push(
            Element::new("inertial")
                .child(origin(
                    &(mass.centre_m - origin_m),
                    &UnitQuaternion::identity(),
                ))
                .child(Element::new("mass").with("value", numbers([mass.mass_kg])))
                .child(
                    Element::new("inertia")
                        .with("ixx", moment(0, 0))
                        .with("ixy", moment(0, 1))
                        .with("ixz", moment(0, 2))
                        .with("iyy", moment(1, 1))
                        .with("iyz", moment(1, 2))
                        .with("izz", moment(2, 2)),
                ),
        );
    }
    for solid in cluster.solids.iter().filter(|s| s.shape != Shape::Nothing) {
        link.push(shape("visual", robot, solid, origin_m));
        if solid.collides {
            link.push(shape("collision", robot, solid, origin_m));
        }
    }
    link
}

fn shape(kind: &'static str, robot: &Robot<'_>, solid: &Solid, origin_m: &Vector3<f64>) -> Element {
    let pose = &solid.robot_from_solid;
    Element::new(kind)
        .with("name", robot.solid_name(solid))
        .child(origin(
            &(pose.translation.vector - origin_m),
            &pose.rotation,
        ))
        .child(Element::new("geometry").child(geometry(robot, solid)))
}

fn geometry(robot: &Robot<'_>, solid: &Solid) -> Element {
    let round = |name, radius_m: f64, half_length_m: f64| {
        Element::new(name)
            .with("radius", numbers([radius_m]))
            .with("length", numbers([2.0 * half_length_m]))
    };
    match &solid.shape {
        Shape::Sphere { radius_m } => Element::new("sphere").with("radius", numbers([*radius_m])),
        Shape::Cylinder {
            radius_m,
            half_length_m,
        } => round("cylinder", *radius_m, *half_length_m),
        Shape::Capsule {
            radius_m,
            half_length_m,
        } => round("capsule", *radius_m, *half_length_m),
        Shape::Hull { .. } => Element::new("mesh").with("filename", mesh_name(robot, solid)),
        Shape::Box { .. } | Shape::Nothing => {
            Element::new("box").with("size", vector(&(solid.half_extents_m() * 2.0)))
        }
    }
}

/// Name of the mesh file of a hull.
fn mesh_name(robot: &Robot<'_>, solid: &Solid) -> String {
    format!("{}.{}.stl", robot.name, robot.solid_name(solid))
}

/// A hull as binary STL: a header of 80 bytes, the number of triangles, and for each triangle its normal, its corners and two
/// unused bytes.
fn stl(points_m: &[Vector3<f64>]) -> Vec<u8> {
    let (corners_m, triangles) = convex_hull(points_m).unwrap_or_default();
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| corners_m[corner]);
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_default();
        for value in [normal, a, b, c].iter().flatten() {
            bytes.extend((*value as f32).to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn joint(robot: &Robot<'_>, hinge: &Hinge) -> Element {
    let parent_m = link_origin_robot_m(robot, hinge.parent_part);
    let limits_rad = hinge.bearing.limits_rad;
    let kind = if hinge.freedom == Freedom::Slide {
        "prismatic"
    } else if limits_rad.is_some() {
        "revolute"
    } else {
        "continuous"
    };
    let mut joint = Element::new("joint")
        .with("name", &hinge.name)
        .with("type", kind)
        .child(origin(
            &(hinge.anchor_robot_m - parent_m),
            &UnitQuaternion::identity(),
        ))
        .child(Element::new("parent").with("link", robot.part_name(hinge.parent_part)))
        .child(Element::new("child").with("link", robot.part_name(hinge.child_part)))
        .child(Element::new("axis").with("xyz", vector(&hinge.axis_robot)));
    let bearing = &hinge.bearing;
    if bearing.has_friction() {
        joint.push(
            Element::new("dynamics")
                .with("damping", numbers([bearing.viscous_nm_s_rad]))
                .with("friction", numbers([bearing.dry_nm])),
        );
    }
    let mut limit = Element::new("limit");
    // URDF requires limits for a slide.
    let unlimited = (hinge.freedom == Freedom::Slide).then_some((-UNLIMITED_M, UNLIMITED_M));
    if let Some((low_rad, high_rad)) = limits_rad.or(unlimited) {
        limit = limit
            .with("lower", numbers([low_rad]))
            .with("upper", numbers([high_rad]));
    }
    // A passive hinge has no actuator, so its effort is 0.
    let (effort_nm, speed_rad_s) = hinge.actuator.map_or((0.0, UNLIMITED_RAD_S), |driven| {
        let top_rad_s = driven.servo.max_speed_rad_s.min(UNLIMITED_RAD_S);
        (driven.servo.max_torque_nm, top_rad_s)
    });
    joint.push(
        limit
            .with("effort", numbers([effort_nm]))
            .with("velocity", numbers([speed_rad_s])),
    );
    joint
}

/// Name of the link to which a mounted robot is fixed.
const MOUNT: &str = "world";

fn held(robot: &Robot<'_>, mount: &Isometry3<f64>) -> Element {
    let origin_m = mount * Point3::from(origin_robot_m(&robot.assembly.parts[0]));
    Element::new("joint")
        .with("name", "mount")
        .with("type", "fixed")
        .child(origin(&origin_m.coords, &mount.rotation))
        .child(Element::new("parent").with("link", MOUNT))
        .child(Element::new("child").with("link", robot.part_name(0)))
}
