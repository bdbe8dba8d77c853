//! Where a sensor is, and what it reads there.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::super::kinematics::robot_from_part_at_zero;
use super::{Controller, Mounted, Reads};
use realgap_core::error::{Error, Result};
use realgap_core::random::{Generator, Numbered};
use realgap_robot::morphology::{Assembly, Role};
use realgap_sensing::arena::{Arena, Object, Shape};
use realgap_sensing::range::{Beam, InSession, RangeSensor as _};

/// A beam steeper than this does not say what is around a robot: the cosine of its angle to the floor.
const STEEP: f64 = 0.1;
/// What stands in an arena is so high, metres: higher beams pass over it.
const HEIGHT_M: f64 = 0.5;

/// One sensor at work.
pub(super) struct Eye<'a> {
    mounted: &'a Mounted,
    part: usize,
    part_from_sensor: Isometry3<f64>,
    session: Option<InSession<'a>>,
    rng: Option<Generator>,
}

/// The part that carries a sensor, and the sensor's pose in that part's frame.
pub(super) fn seat(assembly: &Assembly, mounted: &Mounted) -> Result<(usize, Isometry3<f64>)> {
    let mark = assembly.marks.iter().find(|mark| mark.name == mounted.on);
    let (part, robot_from_carrier) = match mark {
        Some(mark) => (mark.part, mark.robot_from_mark),
        None => module(assembly, &mounted.on).ok_or_else(|| {
            let marks = assembly.marks.iter().map(|mark| mark.name.as_str());
            let modules = assembly.module_names.iter().map(String::as_str);
            let known: Vec<&str> = marks.chain(modules).collect();
            Error::invalid("the robot has no mark, module or body of this name")
                .field(format!("sensors.{}.on", mounted.name))
                .found(&mounted.on)
                .allowed(known.join(", "))
        })?,
    };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), mounted.turn_rad);
    let carrier_from_sensor = Isometry3::from_parts(Translation3::from(mounted.at_m), turn);
    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
    Ok((
        part,
        part_from_robot * robot_from_carrier * carrier_from_sensor,
    ))
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

impl<'a> Eye<'a> {
    /// The sensors of one robot of the group; what is random of each has a stream of its own.
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
                let (part, part_from_sensor) = seat(assembly, mounted)?;
                // Repeats, robots and sensors never share numbers: fewer than 256 of each of the latter.
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

    /// What it reads now; `None` where nothing comes.
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
                let mut beam = meets(arena, at_m, along, heading_rad, level)
                    .filter(|beam| beam.distance_m <= far_m)?;
                // Nearer than its range it reads as at the near end.
                beam.distance_m = beam.distance_m.max(near_m);
                match (&self.session, &mut self.rng) {
                    (Some(session), Some(rng)) => session.draw(&beam, rng),
                    _ => Some(model.mean(&beam)),
                }
            }
        }
    }
}

/// What a beam in space meets first: something upright that stands in the arena, or the floor.
fn meets(
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

/// What others see of a robot: the plan of every solid, the box around it along the axis that is most upright.
pub(super) fn plan(assembly: &Assembly, arena_from_parts: &[Isometry3<f64>]) -> Vec<Object> {
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
