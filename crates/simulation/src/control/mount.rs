//! Mounted sensors: their poses on the robot, and their readings.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::super::kinematics::robot_from_part_at_zero;
use super::{Controller, Mounted, Reads};
use realgap_core::error::{Error, Result};
use realgap_core::random::{Generator, Numbered};
use realgap_robot::morphology::{Assembly, Role};
use realgap_sensing::arena::{Arena, Object, Shape};
use realgap_sensing::range::{Beam, InSession, RangeSensor as _};

/// A sensor whose beam is steeper than this returns no reading: the cosine of the beam's angle to the floor.
const STEEP: f64 = 0.1;
/// Height of the objects of an arena, metres: beams above it pass over the objects.
const HEIGHT_M: f64 = 0.5;

/// One mounted sensor during a run.
pub(super) struct MountedSensor<'a> {
    mounted: &'a Mounted,
    part: usize,
    part_from_sensor: Isometry3<f64>,
    session: Option<InSession<'a>>,
    rng: Option<Generator>,
}

/// The part that carries a sensor, and the sensor's pose in that part's frame.
pub(super) fn mounting_pose(
    assembly: &Assembly,
    mounted: &Mounted,
) -> Result<(usize, Isometry3<f64>)> {
    let (part, robot_from_carrier) = carrier(assembly, &mounted.on)
        .map_err(|error| error.field(format!("sensors.{}.on", mounted.name)))?;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), mounted.turn_rad);
    let carrier_from_sensor = Isometry3::from_parts(Translation3::from(mounted.at_m), turn);
    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
    Ok((
        part,
        part_from_robot * robot_from_carrier * carrier_from_sensor,
    ))
}

/// The part to which a mark, module or body belongs, and its pose in the robot frame at zero angles.
///
/// # Errors
/// A name that the robot does not have.
pub(in super::super) fn carrier(
    assembly: &Assembly,
    name: &str,
) -> Result<(usize, Isometry3<f64>)> {
    let mark = assembly.marks.iter().find(|mark| mark.name == name);
    match mark {
        Some(mark) => Ok((mark.part, mark.robot_from_mark)),
        None => module(assembly, name).ok_or_else(|| {
            let marks = assembly.marks.iter().map(|mark| mark.name.as_str());
            let modules = assembly.module_names.iter().map(String::as_str);
            let known: Vec<&str> = marks.chain(modules).collect();
            Error::invalid("the robot has no mark, module or body of this name")
                .found(name)
                .allowed(known.join(", "))
        }),
    }
}

/// The part of a module or body, and the pose of its first solid.
fn module(assembly: &Assembly, name: &str) -> Option<(usize, Isometry3<f64>)> {
    let index = assembly
        .module_names
        .iter()
        .position(|known| known == name)?;
    assembly.parts.iter().enumerate().find_map(|(part, own)| {
        let mut solids = own.solids.iter();
        let solid = solids.find(|s| s.module == index && s.role == Role::Cube)?;
        Some((part, solid.robot_from_solid))
    })
}

impl<'a> MountedSensor<'a> {
    /// The sensors of one robot of the group; each sensor has its own random stream.
    pub fn all(
        controller: &'a Controller,
        assembly: &Assembly,
        robot: usize,
        draw: Option<(u64, u64)>,
    ) -> Result<Vec<Self>> {
        controller
            .sensors
            .iter()
            .enumerate()
            .map(|(index, mounted)| {
                let (part, part_from_sensor) = mounting_pose(assembly, mounted)?;
                // The stream numbers of repeats, robots and sensors never coincide, because there are fewer than 256 robots and
                // fewer than 256 sensors.
                let number = |repeat: u64| (repeat << 16) | ((robot as u64) << 8) | index as u64;
                let session = match (&mounted.reads, draw) {
                    (Reads::Range(model), Some((seed, repeat))) => {
                        let mut rng = Numbered::SensorSession.generator(seed, number(repeat));
                        Some(model.in_session(&mut rng))
                    }
                    _ => None,
                };
                Ok(Self {
                    mounted,
                    part,
                    part_from_sensor,
                    session,
                    rng: draw.map(|(seed, repeat)| {
                        Numbered::MountedSensor.generator(seed, number(repeat))
                    }),
                })
            })
            .collect()
    }

    /// The present reading; `None` if there is none.
    pub fn read(&mut self, arena: &Arena, arena_from_parts: &[Isometry3<f64>]) -> Option<f64> {
        let pose = arena_from_parts[self.part] * self.part_from_sensor;
        let at_m = pose.translation.vector;
        let along = pose.rotation * Vector3::x();
        let level = along.x.hypot(along.y);
        if level.is_nan() || level < STEEP {
            return None;
        }
        let heading_rad = libm::atan2(along.y, along.x);
        match &self.mounted.reads {
            Reads::Scan { graph, segment } => {
                Some(graph.range_m([at_m.x, at_m.y], heading_rad, *segment))
            }
            Reads::Range(model) => {
                let (near_m, far_m) = model.range_m();
                let mut beam = cast_beam(arena, at_m, along, heading_rad, level)
                    .filter(|beam| beam.distance_m <= far_m)?;
                // At distances below its range the sensor reads as at the near end of its range.
                beam.distance_m = beam.distance_m.max(near_m);
                match (&self.session, &mut self.rng) {
                    (Some(session), Some(rng)) => session.draw(&beam, rng),
                    _ => Some(model.mean(&beam)),
                }
            }
        }
    }
}

/// The first object that a beam in space cast_beam: an upright object of the arena, or the floor.
fn cast_beam(
    arena: &Arena,
    at_m: Vector3<f64>,
    along: Vector3<f64>,
    heading_rad: f64,
    level: f64,
) -> Option<Beam> {
    let wall = arena.cast([at_m.x, at_m.y], heading_rad).map(|hit| Beam {
        distance_m: hit.distance_m / level,
        incidence_rad: libm::acos((level * libm::cos(hit.incidence_rad)).clamp(0.0, 1.0)),
        offset_rad: 0.0,
    });
    let wall = wall.filter(|beam| at_m.z + along.z * beam.distance_m <= HEIGHT_M);
    let floor = (along.z < 0.0 && at_m.z > 0.0).then(|| Beam {
        distance_m: -at_m.z / along.z,
        incidence_rad: libm::acos((-along.z).clamp(0.0, 1.0)),
        offset_rad: 0.0,
    });
    wall.into_iter()
        .chain(floor)
        .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

/// Outline of a robot as other robots detect it: for every solid the rectangle of its bounding box, seen along the box axis that
/// is closest to vertical.
pub(super) fn outline(assembly: &Assembly, arena_from_parts: &[Isometry3<f64>]) -> Vec<Object> {
    let mut objects = Vec::new();
    for (part, own) in assembly.parts.iter().enumerate() {
        let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
        for solid in own.solids.iter().filter(|solid| solid.collides) {
            let pose = arena_from_parts[part] * part_from_robot * solid.robot_from_solid;
            let half_m = solid.half_extents_m();
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| pose.rotation * axis);
            let upright = (0..3).max_by(|a, b| axes[*a].z.abs().total_cmp(&axes[*b].z.abs()));
            let (first, second) = match upright {
                Some(0) => (1, 2),
                Some(1) => (2, 0),
                _ => (0, 1),
            };
            let length = axes[first].x.hypot(axes[first].y);
            objects.push(Object {
                centre_m: [pose.translation.x, pose.translation.y],
                shape: Shape::Box {
                    half_m: [half_m[first], half_m[second]],
                    turn: [axes[first].x / length, axes[first].y / length],
                },
                material: "robot".to_owned(),
            });
        }
    }
    objects
}
