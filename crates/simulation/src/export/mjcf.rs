//! Export to MJCF, the format of MuJoCo: the whole experiment except restitution and contact softness.

use nalgebra::{Point3, UnitQuaternion, Vector3};

use super::format::{Exported, Format};
use super::ground;
use super::robot::{Robot, origin_robot_m, quaternion, seen_from};
use super::stand::{stand, switched};
use super::xml::{Element, numbers, vector};
use crate::servo::speed_damping_nm_s_rad;
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{
    Actuator, CommandScale, Freedom, Hinge, Motor, Part, Servo, ServoLaw, Shape, Solid,
    TurningFriction,
};

/// MuJoCo's XML.
pub(super) struct Mjcf;

/// Time per step, s. Light parts behind saturated servos need it this short (docs/validation.md).
const TIMESTEP_S: f64 = 1.0 / 8000.0;
/// Contact parameters with a time constant twenty times shorter than MuJoCo's default, whose softness alone can reverse the
/// direction in which a robot walks (docs/validation.md).
const SOLREF: &str = "0.002 1";
const SOLIMP: &str = "0.95 0.99 0.001";
/// Height above the floor at the start, m.
const GAP_M: f64 = 0.001;

impl Format for Mjcf {
    fn name(&self) -> &'static str {
        "mjcf"
    }

    fn doc(&self) -> &'static str {
        "MuJoCo XML: bodies, hinges, servos, floor; the gait as custom numbers"
    }

    fn render(&self, robot: &Robot<'_>) -> Exported {
        let warnings = warnings(robot);
        let comments = robot.comments("", &warnings);
        let mut root = Element::new("mujoco")
            .with("model", robot.name)
            .child(
                Element::new("compiler")
                    .with("angle", "radian")
                    .with("autolimits", "true")
                    .with("inertiafromgeom", "false"),
            )
            .child(switched(
                robot,
                Element::new("option")
                    .with("timestep", numbers([TIMESTEP_S]))
                    .with("gravity", numbers([0.0, 0.0, -robot.gravity_m_s2]))
                    // MuJoCo's Euler integrator treats servo damping explicitly, so that light joints oscillate; a friction
                    // pyramid favours the directions of its axes.
                    .with("integrator", "implicitfast")
                    .with("cone", "elliptic"),
            ))
            .child(
                Element::new("default").child(
                    Element::new("geom")
                        .with("condim", "3")
                        .with("solref", SOLREF)
                        .with("solimp", SOLIMP),
                ),
            );
        root.push(custom(robot));
        let meshes: Vec<Element> = robot.hulls().map(mesh_of(robot)).collect();
        let heights = ground::heights_asset(robot);
        if !meshes.is_empty() || heights.is_some() {
            let asset = Element::new("asset");
            let all = meshes.into_iter().chain(heights);
            root.push(all.fold(asset, Element::child));
        }
        let mut world = Element::new("worldbody");
        world.comment(
            "Because of the floor's priority, its friction is that of every pair with the floor; the friction of two modules is its square, as in realgap.",
        );
        world.push(floor(robot));
        for geom in ground::geoms(robot) {
            world.push(geom);
        }
        world.push(body(robot, 0, &[]));
        root.push(world);
        let hinges = &robot.assembly.hinges;
        if !hinges.is_empty() {
            let mut contact = Element::new("contact");
            let mut actuator = Element::new("actuator");
            let joined = hinges
                .iter()
                .map(|hinge| (hinge.parent_part, hinge.child_part));
            // A part without mass and shape becomes an additional joint of the next part, so the neighbours to exclude are those
            // of the whole chain.
            let is_body = |part: usize| part == 0 || !is_joint_of_next(robot, part);
            let pairs = joined.chain(robot.excluded_part_pairs());
            for (a, b) in pairs.filter(|(a, b)| is_body(*a) && is_body(*b)) {
                contact.push(
                    Element::new("exclude")
                        .with("body1", name_of(robot, a))
                        .with("body2", name_of(robot, b)),
                );
            }
            for (hinge, driven) in robot.driven_hinges() {
                actuator.push(motor(&hinge.name, driven));
            }
            root.push(contact);
            if robot.has_servos() {
                root.push(actuator);
            }
        }
        Exported {
            text: root.document(&comments),
            warnings,
            files: Vec::new(),
        }
    }
}

fn warnings(robot: &Robot<'_>) -> Vec<Warning> {
    let mut warnings = vec![
        Code::RestitutionNotExported.warning(format!(
            "restitution {} (MuJoCo has no restitution coefficient; its contacts hardly bounce)",
            robot.floor.restitution
        )),
        Code::SolverNotExported.warning(
            "realgap's timestep, substeps and contact settings (the file has its own, stiffer MuJoCo settings)",
        ),
    ];
    warnings.extend(ground::not_carried(robot));
    if robot.assembly.is_compliant() {
        warnings
            .push(Code::SpringNotExported.warning("the compliance of bearings (hinge.bearing_hz)"));
    }
    // MuJoCo compensates weight at the centre of mass of a whole body.
    let is_aside = |part: &Part| {
        let centre_m = part.mass(&nalgebra::Isometry3::identity()).centre_m;
        (part.compensated()).is_some_and(|(_, place_m)| (place_m - centre_m).norm() > 1e-9)
    };
    if robot.assembly.parts.iter().any(is_aside) {
        warnings.push(Code::CompensationNotExported.warning(
            "the place where the compensation of weight acts: it acts at the centre of mass of each part",
        ));
    }
    if robot.assembly.has_turning_shapes() {
        warnings.push(Code::TurningNotExported.warning(
            "that rolling and torsional friction of two shapes add up: the file states those of each shape with the floor, which MuJoCo uses for all of its contacts (as the sliding friction of such a shape)",
        ));
    }
    warnings.extend(robot.of_wheels(
        "that a throttle's torque falls with the speed backwards, too: it is that of forward driving",
    ));
    if robot.mount.is_some() {
        warnings.push(Code::SpringNotExported.warning(
            "that the stand carries the robot's moment about it from the start (in MuJoCo the robot tilts until the ball joint's spring carries it; the weight is in `springref`)",
        ));
    }
    if robot.has_servos() {
        warnings.push(Code::GaitNeedsProgram.warning(
            "the gait as motion (it is in <custom>; tools/record_standin.py reads it and drives the servos)",
        ));
    }
    warnings
}

/// Gait and servo law as custom elements, which programs can read.
fn custom(robot: &Robot<'_>) -> Element {
    let mut custom = Element::new("custom");
    custom.comment("gait_*: offset rad, amplitude rad, frequency Hz, phase rad. Command: offset + amplitude sin(2 pi frequency t + phase).");
    custom.comment("servo_* with law velocity: gain 1/s, max speed rad/s (-1: no limit), max torque N m. ctrl: clamp(gain (command - angle), +-max speed).");
    custom.comment("servo_* with law torque: stiffness N m/rad, damping N m s/rad, max torque N m. ctrl: command.");
    let text = |name: &str, data: &str| Element::new("text").with("name", name).with("data", data);
    let numeric = |name: String, data: String| {
        Element::new("numeric")
            .with("name", name)
            .with("data", data)
    };
    custom.push(text("robot", robot.name));
    custom.push(text(
        "track",
        &robot.assembly.module_names[track_module(robot)],
    ));
    custom.push(numeric(
        "body_length_m".to_owned(),
        numbers([robot.assembly.body_length_m]),
    ));
    for (hinge, Actuator { servo, gait, .. }) in robot.driven_hinges() {
        let name = &hinge.name;
        custom.push(numeric(
            format!("gait_{name}"),
            numbers([
                gait.offset_rad,
                gait.amplitude_rad,
                gait.frequency_hz,
                gait.phase_rad,
            ]),
        ));
        let Servo {
            law,
            max_torque_nm,
            max_speed_rad_s,
            ..
        } = *servo;
        let (law, data) = match law {
            ServoLaw::Velocity { gain_per_s } => {
                let speed = if max_speed_rad_s.is_finite() {
                    max_speed_rad_s
                } else {
                    -1.0
                };
                ("velocity", [gain_per_s, speed, max_torque_nm])
            }
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => (
                "torque",
                [stiffness_nm_rad, damping_nm_s_rad, max_torque_nm],
            ),
            ServoLaw::Motor(motor) => (
                "torque",
                [
                    motor.stiffness_nm_rad(),
                    motor.damping_nm_s_rad(),
                    max_torque_nm.min(motor.stall_nm()),
                ],
            ),
            ServoLaw::Direct => ("direct", [0.0, 0.0, max_torque_nm]),
            ServoLaw::Throttle => ("throttle", [0.0, max_speed_rad_s, max_torque_nm]),
        };
        custom.push(text(&format!("law_{name}"), law));
        custom.push(numeric(format!("servo_{name}"), numbers(data)));
    }
    custom
}

/// The module whose cube is nearest to the tracked position.
fn track_module(robot: &Robot<'_>) -> usize {
    let track_m = robot.assembly.robot_from_track.translation.vector;
    robot.assembly.parts[robot.assembly.track_part]
        .solids
        .iter()
        .filter(|solid| solid.role == realgap_robot::morphology::Role::Cube)
        .min_by(|a, b| {
            let away = |s: &Solid| (s.robot_from_solid.translation.vector - track_m).norm();
            away(a).total_cmp(&away(b))
        })
        .map_or(0, |solid| solid.module)
}

fn floor(robot: &Robot<'_>) -> Element {
    let half = robot.floor.slope_rad / 2.0;
    let element = Element::new("geom")
        .with("name", "floor")
        .with("type", "plane")
        .with("size", "0 0 1")
        .with("pos", numbers([0.0, 0.0, robot.floor.height_m]))
        .with("quat", numbers([half.cos(), 0.0, half.sin(), 0.0]))
        .with("priority", "1");
    rubbing(element, robot.floor.friction, &turning_of_floor(robot))
}

/// Friction against rolling and spinning of the floor, without that of a shape.
pub(super) fn turning_of_floor(robot: &Robot<'_>) -> TurningFriction {
    TurningFriction {
        rolling_m: robot.floor.rolling_m.unwrap_or(0.0),
        torsional_m: robot.floor.torsional_m.unwrap_or(0.0),
    }
}

/// A shape with its friction, and with the dimension of its contacts that makes MuJoCo use all of it.
pub(super) fn rubbing(geom: Element, friction: f64, turning: &TurningFriction) -> Element {
    let numbers = numbers([friction, turning.torsional_m, turning.rolling_m]);
    let geom = geom.with("friction", numbers);
    match (turning.torsional_m > 0.0, turning.rolling_m > 0.0) {
        (false, false) => geom,
        (true, false) => geom.with("condim", "4"),
        (_, true) => geom.with("condim", "6"),
    }
}

/// Whether a part is exported as an additional joint of the next part: a link without mass and shape that carries one joint.
fn is_joint_of_next(robot: &Robot<'_>, part: usize) -> bool {
    part > 0 && robot.is_empty_link(part) && robot.hinges_on(part).count() == 1
}

/// Name of a part; the name `world` is reserved by MuJoCo.
fn name_of(robot: &Robot<'_>, part: usize) -> String {
    match robot.part_name(part) {
        name if name == "world" => "world.held".to_owned(),
        name => name,
    }
}

/// A hull as a mesh asset; MuJoCo computes the convex hull of the vertices.
fn mesh_of<'a>(robot: &'a Robot<'_>) -> impl Fn((&'a Solid, &'a [Vector3<f64>])) -> Element + 'a {
    |(solid, points_m)| {
        Element::new("mesh")
            .with("name", robot.solid_name(solid))
            .with("vertex", numbers(points_m.iter().flatten().copied()))
    }
}

/// A part with the joints that move it. Several joints with links without mass and shape between them are joints of one body in
/// MuJoCo.
fn body(robot: &Robot<'_>, part: usize, hinges: &[&Hinge]) -> Element {
    let cluster = &robot.assembly.parts[part];
    let on_it: Vec<&Hinge> = robot.hinges_on(part).collect();
    if let ([next], false) = (on_it.as_slice(), hinges.is_empty())
        && is_joint_of_next(robot, part)
    {
        return body(robot, next.child_part, &[hinges, &[*next]].concat());
    }
    let origin_m = origin_robot_m(cluster);
    let mut element = Element::new("body").with("name", name_of(robot, part));
    if let Some((compensated_kg, _)) = cluster.compensated() {
        element = element.with("gravcomp", numbers([compensated_kg / cluster.mass_kg()]));
    }
    match hinges.first() {
        None if robot.assembly.world_from_mount.is_some() => {
            let mount = robot.assembly.world_from_mount.unwrap_or_default();
            element = element.with("pos", vector(&(mount * Point3::from(origin_m)).coords));
            if mount.rotation != UnitQuaternion::identity() {
                element = element.with("quat", numbers(quaternion(&mount.rotation)));
            }
            for joint in stand(robot, &mount.rotation, &origin_m) {
                element.push(joint);
            }
        }
        None => {
            let height_m = robot.floor.height_m + robot.clearance_m() + GAP_M;
            element = element
                .with(
                    "pos",
                    numbers([origin_m.x, origin_m.y, origin_m.z + height_m]),
                )
                .child(Element::new("freejoint").with("name", "robot.free"));
        }
        Some(hinge) => {
            let parent_m = origin_robot_m(&robot.assembly.parts[hinge.parent_part]);
            element = element.with("pos", vector(&(origin_m - parent_m)));
            for hinge in hinges {
                element.push(joint(hinge, &origin_m));
            }
        }
    }
    let mass = cluster.mass(&nalgebra::Isometry3::identity());
    let i = mass.inertia_kg_m2;
    let inertial = || {
        Element::new("inertial")
            .with("pos", vector(&(mass.centre_m - origin_m)))
            .with("mass", numbers([mass.mass_kg]))
            .with(
                "fullinertia",
                numbers([
                    i[(0, 0)],
                    i[(1, 1)],
                    i[(2, 2)],
                    i[(0, 1)],
                    i[(0, 2)],
                    i[(1, 2)],
                ]),
            )
    };
    // A fixed part may have no mass.
    if mass.mass_kg > 0.0 {
        element.push(inertial());
    }
    for solid in cluster.solids.iter().filter(|s| s.shape != Shape::Nothing) {
        element.push(geom(robot, solid, &origin_m));
    }
    if part == robot.assembly.track_part {
        let pose = seen_from(&origin_m, &robot.assembly.robot_from_track);
        element.push(
            Element::new("site")
                .with("name", "track")
                .with("pos", vector(&pose.translation.vector))
                .with("quat", numbers(quaternion(&pose.rotation))),
        );
    }
    for mark in robot.assembly.marks.iter().filter(|m| m.part == part) {
        let pose = seen_from(&origin_m, &mark.robot_from_mark);
        element.push(
            Element::new("site")
                .with("name", &mark.name)
                .with("pos", vector(&pose.translation.vector))
                .with("quat", numbers(quaternion(&pose.rotation))),
        );
    }
    for hinge in on_it {
        element.push(body(robot, hinge.child_part, &[hinge]));
    }
    element
}

fn joint(hinge: &Hinge, origin_m: &Vector3<f64>) -> Element {
    let mut joint = Element::new("joint")
        .with("name", &hinge.name)
        .with(
            "type",
            match hinge.freedom {
                Freedom::Turn => "hinge",
                Freedom::Slide => "slide",
            },
        )
        .with("axis", vector(&hinge.axis_robot))
        .with("pos", vector(&(hinge.anchor_robot_m - origin_m)));
    let bearing = &hinge.bearing;
    // MuJoCo's joint friction does not depend on load, so only the dry and viscous parts of a gear's friction are exported.
    let motor = hinge.actuator.as_ref().and_then(|a| a.servo.law.motor());
    let gear = motor.map(|motor| motor.friction).unwrap_or_default();
    let viscous_nm_s_rad = bearing.viscous_nm_s_rad + gear.viscous_nm_s_rad;
    if viscous_nm_s_rad > 0.0 {
        joint = joint.with("damping", numbers([viscous_nm_s_rad]));
    }
    let dry_nm = bearing.dry_nm + gear.dry_nm;
    if dry_nm > 0.0 {
        joint = joint.with("frictionloss", numbers([dry_nm]));
    }
    let armature_kg_m2 = bearing.armature_kg_m2 + motor.map_or(0.0, |motor| motor.armature_kg_m2);
    if armature_kg_m2 > 0.0 {
        joint = joint.with("armature", numbers([armature_kg_m2]));
    }
    if let Some(spring) = bearing.spring {
        joint = joint
            .with("stiffness", numbers([spring.stiffness_nm_rad]))
            .with("springref", numbers([spring.rest_rad]));
    }
    if let Some((low_rad, high_rad)) = bearing.limits_rad {
        joint = joint.with("range", numbers([low_rad, high_rad]));
    }
    joint
}

fn geom(robot: &Robot<'_>, solid: &Solid, origin_robot_m: &Vector3<f64>) -> Element {
    let pose = seen_from(origin_robot_m, &solid.robot_from_solid);
    let element = Element::new("geom").with("name", robot.solid_name(solid));
    let element = match &solid.shape {
        Shape::Hull { .. } => element
            .with("type", "mesh")
            .with("mesh", robot.solid_name(solid)),
        Shape::Sphere { radius_m } => element
            .with("type", "sphere")
            .with("size", numbers([*radius_m])),
        Shape::Cylinder {
            radius_m,
            half_length_m,
        } => element
            .with("type", "cylinder")
            .with("size", numbers([*radius_m, *half_length_m])),
        Shape::Capsule {
            radius_m,
            half_length_m,
        } => element
            .with("type", "capsule")
            .with("size", numbers([*radius_m, *half_length_m])),
        Shape::Box { .. } | Shape::Nothing => element
            .with("type", "box")
            .with("size", vector(&solid.half_extents_m())),
    };
    let element = element
        .with("pos", vector(&pose.translation.vector))
        .with("quat", numbers(quaternion(&pose.rotation)));
    let own = &solid.turning;
    let element = match own.is_none() {
        true => rubbing(element, robot.floor.friction.powi(2), own),
        // The floor's priority would hide the shape's own.
        false => {
            let floor = turning_of_floor(robot);
            let both = TurningFriction {
                rolling_m: floor.rolling_m + own.rolling_m,
                torsional_m: floor.torsional_m + own.torsional_m,
            };
            rubbing(element, robot.floor.friction, &both).with("priority", "2")
        }
    };
    if solid.collides {
        element
    } else {
        element.with("contype", "0").with("conaffinity", "0")
    }
}

/// A spring whose command is in the actuator's own unit.
fn spring(
    motor: Element,
    stiffness_nm_rad: f64,
    damping_nm_s_rad: f64,
    command: &CommandScale,
) -> Element {
    let offset_nm = stiffness_nm_rad * command.offset;
    let factor = stiffness_nm_rad * command.factor;
    motor.with("gainprm", numbers([factor])).with(
        "biasprm",
        numbers([offset_nm, -stiffness_nm_rad, -damping_nm_s_rad]),
    )
}

fn motor(name: &str, Actuator { servo, command, .. }: &Actuator) -> Element {
    let stall_nm = servo.law.motor().map_or(f64::INFINITY, Motor::stall_nm);
    let most_nm = servo.max_torque_nm.min(stall_nm);
    let limit = numbers([-most_nm, most_nm]);
    let (gain, bias) = match servo.law {
        ServoLaw::Throttle => ("affine", "none"),
        _ => ("fixed", "affine"),
    };
    let mut motor = Element::new("general")
        .with("name", name)
        .with("joint", name)
        .with("forcerange", limit)
        .with("gaintype", gain)
        .with("biastype", bias);
    if let (Some((low, high)), false) = (
        command.range,
        matches!(servo.law, ServoLaw::Velocity { .. }),
    ) {
        motor = motor.with("ctrlrange", numbers([low, high]));
    }
    match servo.law {
        ServoLaw::Velocity { .. } => {
            let top_rad_s = servo.max_speed_rad_s;
            let damping_nm_s_rad = speed_damping_nm_s_rad(servo);
            let motor = motor
                .with("gainprm", numbers([damping_nm_s_rad]))
                .with("biasprm", numbers([0.0, 0.0, -damping_nm_s_rad]));
            if top_rad_s.is_finite() {
                motor.with("ctrlrange", numbers([-top_rad_s, top_rad_s]))
            } else {
                motor
            }
        }
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => spring(motor, stiffness_nm_rad, damping_nm_s_rad, command),
        // The limit of the duty is not exported, except for the torque at standstill.
        ServoLaw::Motor(law) => spring(
            motor,
            law.stiffness_nm_rad(),
            law.damping_nm_s_rad(),
            command,
        ),
        ServoLaw::Direct => motor
            .with("gainprm", numbers([command.factor]))
            .with("biasprm", numbers([command.offset, 0.0, 0.0])),
        // A gain that falls with the speed is that of forward driving.
        ServoLaw::Throttle => {
            let stall_nm = servo.max_torque_nm * command.factor;
            let per_speed = -stall_nm / servo.max_speed_rad_s;
            motor.with("gainprm", numbers([stall_nm, 0.0, per_speed]))
        }
    }
}
