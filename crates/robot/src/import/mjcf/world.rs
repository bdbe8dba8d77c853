//! The world around the robot of an MJCF: gravity, the floor with its friction, and boxes beside the robot.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3, Vector3};

use super::super::note::Notes;
use super::model::{Geom, GeomType, JointType, Model};
use super::robot::{Robot, tops};
use crate::morphology::body::{Beside, BesideBox, Frame, Pose};
use realgap_core::error::Result;

/// MuJoCo's gravity where a file states none, m/s².
const GRAVITY_M_S2: f64 = 9.81;
/// A plane that is steeper is a wall, radians.
const STEEPEST_RAD: f64 = 1.2;
/// The highest and lowest floor, metres.
const HIGHEST_M: f64 = 10.0;
/// Masses of free bodies beside a robot, kg.
const MASSES_KG: std::ops::RangeInclusive<f64> = 1e-6..=1000.0;
/// Bodies that are named in a note.
const NAMED: usize = 6;

/// A plane of the world.
struct Plane<'a> {
    geom: &'a Geom,
    normal_world: Vector3<f64>,
    /// Height above the origin.
    height_m: f64,
}

impl<'a> Plane<'a> {
    fn of(geom: &'a Geom) -> Option<Self> {
        let normal = geom.pose.rotation * Vector3::z();
        let height_m = geom.pose.translation.vector.dot(&normal) / normal.z;
        let can_be_floor = normal.z > STEEPEST_RAD.cos() && height_m.abs() < HIGHEST_M;
        can_be_floor.then_some(Self {
            geom,
            normal_world: normal,
            height_m,
        })
    }

    /// The slope about y, if the plane leans in no other direction.
    fn slope_rad(&self) -> Option<f64> {
        let n = self.normal_world;
        (n.y.abs() < 1e-9).then(|| n.x.atan2(n.z))
    }
}

/// Friction of two shapes, that of the one with the higher priority, else the larger one: sliding, and torsional and rolling
/// friction in metres.
pub(super) fn pair_friction(a: &Geom, b: &Geom) -> [f64; 3] {
    let contact = |geom: &Geom| (geom.friction, geom.condim);
    let (friction, condim) = match a.priority.cmp(&b.priority) {
        std::cmp::Ordering::Greater => contact(a),
        std::cmp::Ordering::Less => contact(b),
        std::cmp::Ordering::Equal => (
            [0, 1, 2].map(|kind| a.friction[kind].max(b.friction[kind])),
            a.condim.max(b.condim),
        ),
    };
    // A contact of one dimension has no friction, and one of three has sliding friction alone.
    let [sliding, torsional_m, rolling_m] = friction;
    [
        if condim > 1 { sliding } else { 0.0 },
        if condim > 3 { torsional_m } else { 0.0 },
        if condim > 5 { rolling_m } else { 0.0 },
    ]
}

pub(super) fn meet(a: &Geom, b: &Geom) -> bool {
    a.contype & b.conaffinity != 0 || b.contype & a.conaffinity != 0
}

/// The number of planes of the world, and those of them that can be a floor, the highest one first.
fn floors(model: &Model) -> (usize, Vec<Plane<'_>>) {
    let on_world = model.bodies[0].geoms.iter();
    let planes: Vec<&Geom> = on_world
        .filter(|geom| geom.kind == GeomType::Plane && geom.touches())
        .collect();
    let mut floors: Vec<Plane<'_>> = planes.iter().filter_map(|geom| Plane::of(geom)).collect();
    floors.sort_by(|a, b| b.height_m.total_cmp(&a.height_m));
    (planes.len(), floors)
}

/// The plane that is the floor, if there is one that leans towards x or not at all.
pub(super) fn plane(model: &Model) -> Option<&Geom> {
    let (_, floors) = floors(model);
    let floor = floors.first()?;
    floor.slope_rad().map(|_| floor.geom)
}

impl Robot<'_> {
    /// Reads gravity, floor and boxes beside the robot.
    pub(super) fn surroundings(&mut self, notes: &mut Notes) -> Result<()> {
        let said = [self.gravity(notes)?, self.floor(notes)];
        let said: Vec<String> = said.into_iter().flatten().collect();
        if !said.is_empty() {
            notes.assumed(
                None,
                format!("experiments with this robot begin with {}", said.join("; ")),
                "other values stand in `world`, or in the `set` of a study (gravity_m_s2, floor.friction, floor.height_m, floor.slope_rad)",
            );
        }
        self.stand_beside(notes);
        self.mocap(notes);
        Ok(())
    }

    fn gravity(&mut self, notes: &mut Notes) -> Result<Option<String>> {
        let mut gravity = Vector3::new(0.0, 0.0, -GRAVITY_M_S2);
        let (mut fluid, mut is_touching) = (Vec::new(), true);
        for option in self.model.sections.iter().filter(|s| s.tag == "option") {
            if let Some(stated) = option.numbers::<3>("gravity")? {
                gravity = Vector3::from(stated);
            }
            for name in ["density", "viscosity", "wind"] {
                if option.list(name)?.iter().any(|value| *value != 0.0) {
                    fluid.push(name);
                }
            }
            for flag in option.named("flag") {
                if flag.get("gravity") == Some("disable") {
                    gravity = Vector3::zeros();
                }
                is_touching &= flag.get("contact") != Some("disable");
            }
        }
        if !fluid.is_empty() {
            notes.left_out(
                None,
                format!("the fluid around the robot ({})", fluid.join(", ")),
                "the robot moves in a vacuum: expect less resistance than in MuJoCo",
            );
        }
        if !is_touching {
            notes.left_out(
                None,
                "contacts are switched off in the file, and on here",
                "set contact.on to 0 in the study",
            );
        }
        let down_m_s2 = -gravity.z;
        if gravity.xy().norm() > 1e-9 * gravity.norm() || !(0.0..=100.0).contains(&down_m_s2) {
            notes.left_out(
                None,
                format!("gravity ({}, {}, {})", gravity.x, gravity.y, gravity.z),
                "gravity points down here: lean the floor instead (floor.slope_rad), or turn the model",
            );
            return Ok(None);
        }
        if down_m_s2 == GRAVITY_M_S2 {
            return Ok(None);
        }
        self.structure.world.gravity_m_s2 = Some(down_m_s2);
        Ok(Some(format!("a gravity of {down_m_s2} m/s²")))
    }

    /// Takes the highest plane of the world as the floor.
    fn floor(&mut self, notes: &mut Notes) -> Option<String> {
        let (planes, floors) = floors(self.model);
        let others = planes - floors.len().min(1);
        if others > 0 {
            notes.left_out(
                None,
                format!("{others} planes of the world beside the floor: one floor is simulated"),
                "walls of boxes stand in `world`, or in the `scene` of a study",
            );
        }
        let floor = floors.first()?;
        let Some(slope_rad) = floor.slope_rad() else {
            let n = floor.normal_world;
            notes.left_out(
                None,
                format!("the floor leans in the direction ({:.4}, {:.4}): the floor here is level", n.x, n.y),
                "the floor leans towards x only (floor.slope_rad): turn the model about z until it does",
            );
            return None;
        };
        let (height_m, plane) = (floor.height_m, floor.geom);
        let mut said = Vec::new();
        let frictions = self.frictions(plane);
        let nearest = frictions.first().map(|(_, friction)| friction[0]);
        let friction = nearest.unwrap_or(plane.friction[0]).min(10.0);
        let all = || frictions.iter().map(|(_, friction)| friction[0]);
        let (least, most) = (
            all().fold(friction, f64::min),
            all().fold(friction, f64::max),
        );
        said.push(match least < most {
            true => format!(
                "a floor with friction {friction}, that of the lowest shape with the plane: shapes have {least} to {most} there, and one number holds for all here (of two shapes MuJoCo takes the larger coefficient, or that of the higher priority)"
            ),
            false => format!(
                "a floor with friction {friction} (of two shapes MuJoCo takes the larger coefficient, or that of the higher priority)"
            ),
        });
        self.structure.world.floor_friction = Some(friction);
        said.extend(self.turning_of_floor(plane));
        if height_m != 0.0 {
            self.structure.world.floor_height_m = Some(height_m);
            said.push(format!("at height {height_m:.4} m"));
        }
        if slope_rad.abs() > 1e-9 {
            self.structure.world.floor_slope_rad = Some(slope_rad);
            said.push(format!(
                "that slopes by {:.2} degrees",
                slope_rad.to_degrees()
            ));
        }
        Some(said.join(", "))
    }

    /// Friction of the robot's shapes with another shape, from the lowest shape on.
    fn frictions(&self, other: &Geom) -> Vec<(f64, [f64; 3])> {
        let poses = self.poses_world();
        let beside = self.ids_beside();
        let mut all = Vec::new();
        for (id, body) in self.model.bodies.iter().enumerate().skip(1) {
            if beside.contains(&id) {
                continue;
            }
            let touching = body.geoms.iter();
            let touching = touching.filter(|g| g.kind != GeomType::Plane && meet(g, other));
            all.extend(touching.map(|geom| {
                let pose = poses[id] * geom.pose;
                let low_m = pose.translation.z - down_m(geom, &pose);
                (low_m, pair_friction(geom, other))
            }));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// Poses of all bodies with joints at their reference.
    fn poses_world(&self) -> Vec<Isometry3<f64>> {
        let mut poses: Vec<Isometry3<f64>> = vec![Isometry3::identity()];
        for body in self.model.bodies.iter().skip(1) {
            poses.push(poses[body.parent] * body.pose);
        }
        poses
    }

    /// The bodies that are not part of the robot: of a robot that moves freely all that do not hang on its root, beside a held robot
    /// what lies loosely and consists of boxes.
    pub(super) fn ids_beside(&self) -> BTreeSet<usize> {
        let tops = tops(self.model);
        let is_beside = |top: usize| match self.free_root {
            Some(root) => top != root,
            None => self.is_loose_box(top, &tops),
        };
        (1..tops.len()).filter(|id| is_beside(tops[*id])).collect()
    }

    /// Whether a body on the world moves freely, as a whole, and touches others with boxes alone.
    fn is_loose_box(&self, top: usize, tops: &[usize]) -> bool {
        let own = (1..tops.len()).filter(|id| tops[*id] == top);
        let (mut joints, mut boxes, mut mass_kg) = (Vec::new(), 0, 0.0);
        for id in own {
            let body = &self.model.bodies[id];
            joints.extend(body.joints.iter().map(|joint| (id, joint.kind)));
            for geom in body.geoms.iter().filter(|geom| geom.touches()) {
                if geom.kind != GeomType::Box || !is_usual_box(geom) {
                    return false;
                }
                boxes += 1;
            }
            mass_kg += self.masses[id].mass_kg;
        }
        joints == [(top, JointType::Free)] && boxes > 0 && MASSES_KG.contains(&mass_kg)
    }

    /// Adds fixed and free bodies of boxes beside the robot, and says which bodies are not taken. What stands fixed beside a held robot
    /// is part of it.
    fn stand_beside(&mut self, notes: &mut Notes) {
        let poses = self.poses_world();
        let tops = tops(self.model);
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut shift = Translation3::identity();
        let mut who = "the robot".to_owned();
        if let Some(root) = self.free_root {
            // The robot starts above the origin.
            let place = self.model.bodies[root].pose.translation.vector;
            shift = Translation3::new(-place.x, -place.y, 0.0);
            groups.insert(0, vec![0]);
            who = format!("the robot, whose root is `{}`,", self.names[root]);
        }
        for id in self.ids_beside() {
            groups.entry(tops[id]).or_default().push(id);
        }
        let (mut taken, mut lost, mut rounded) = (Vec::new(), Vec::new(), Vec::new());
        let mut turning = false;
        for (top, ids) in groups {
            let solid =
                |geom: &&Geom| geom.touches() && !(top == 0 && geom.kind == GeomType::Plane);
            let count: usize = (ids.iter())
                .map(|id| self.model.bodies[*id].geoms.iter().filter(solid).count())
                .sum();
            let name = format!("`{}`", self.names[top]);
            let joints: Vec<JointType> = (ids.iter())
                .flat_map(|id| self.model.bodies[*id].joints.iter().map(|joint| joint.kind))
                .collect();
            let is_free = joints == [JointType::Free] && self.model.bodies[top].joints.len() == 1;
            if count == 0 && joints.is_empty() {
                // Nothing can touch it: a mark, a light or a picture.
                continue;
            }
            if !(joints.is_empty() || is_free) {
                lost.push(name);
                continue;
            }
            let world_from_top = poses[top];
            let mut boxes = Vec::new();
            let mut friction: Option<f64> = None;
            for id in &ids {
                let here = world_from_top.inverse() * poses[*id];
                for geom in self.model.bodies[*id].geoms.iter().filter(solid) {
                    if geom.kind != GeomType::Box || !is_usual_box(geom) {
                        continue;
                    }
                    let sides = geom.size * 2.0;
                    boxes.push(BesideBox {
                        sides_m: (sides.x, sides.y, sides.z),
                        pose: Pose::of(&(here * geom.pose)),
                    });
                    let touching = self.frictions(geom);
                    turning |= touching.iter().any(|(_, f)| f[1] > 0.0 || f[2] > 0.0);
                    friction = friction.or(touching.first().map(|(_, friction)| friction[0]));
                }
            }
            let mass_kg: f64 = ids.iter().map(|id| self.masses[*id].mass_kg).sum();
            if boxes.is_empty() || (is_free && !MASSES_KG.contains(&mass_kg)) {
                lost.push(name);
                continue;
            }
            if boxes.len() < count {
                rounded.push(format!("{} of {name}", count - boxes.len()));
            }
            taken.push(name.clone());
            self.structure.world.bodies.push(Beside {
                name: plain(&self.names[top], self.structure.world.bodies.len()),
                pose: Pose::of(&(shift * world_from_top)),
                boxes,
                friction: friction.unwrap_or(1.0).min(10.0),
                mass_kg: is_free.then_some(mass_kg),
            });
        }
        let listed = |names: &[String]| {
            let more = if names.len() > NAMED {
                ", and others"
            } else {
                ""
            };
            format!("{}{more}", names[..names.len().min(NAMED)].join(", "))
        };
        if !taken.is_empty() {
            notes.assumed(
                None,
                format!(
                    "{} bodies beside {who} stand in its `world` as boxes: {}",
                    taken.len(),
                    listed(&taken)
                ),
                "remove them from `world` where they were not there",
            );
        }
        if turning {
            notes.left_out(
                None,
                "torsional and rolling friction (condim 4 and 6) against bodies beside the robot: these have the floor's",
                "set floor.torsional_m and floor.rolling_m in the study where it matters",
            );
        }
        if !rounded.is_empty() {
            notes.left_out(
                None,
                format!(
                    "shapes beside the robot that are no boxes: {}",
                    listed(&rounded)
                ),
                "state boxes in `world` in their place",
            );
        }
        if !lost.is_empty() {
            notes.left_out(
                None,
                format!(
                    "{} bodies beside {who} the heaviest body with a free joint: {}",
                    lost.len(),
                    listed(&lost)
                ),
                "bodies of boxes without joints are taken: state them in `world`, or take out of the file what is not to be the robot",
            );
        }
    }

    /// Says which bodies another program moves.
    fn mocap(&self, notes: &mut Notes) {
        let bodies = self.model.bodies.iter().zip(&self.names);
        let moved: Vec<String> = bodies
            .filter(|(body, _)| body.is_mocap)
            .map(|(_, name)| format!("`{name}`"))
            .collect();
        if !moved.is_empty() {
            notes.left_out(
                None,
                format!(
                    "bodies that MuJoCo moves from outside (mocap) stand still: {}",
                    moved.join(", ")
                ),
                "a body of the `scene` of a study follows a recorded track (motion: Recorded)",
            );
        }
    }

    /// Tracks a body that moves in a robot that is held: the one at the end of the longest chain of joints.
    pub(super) fn track_a_moving_body(&mut self, notes: &mut Notes) {
        if self.structure.mount.is_none() {
            return;
        }
        let bodies = &self.model.bodies;
        let beside = self.ids_beside();
        let mut count = vec![0_usize; bodies.len()];
        let mut best: Option<(usize, usize)> = None;
        for id in 1..bodies.len() {
            count[id] = count[bodies[id].parent] + bodies[id].joints.len();
            let is_free = bodies[id].joints.iter().any(|j| j.kind == JointType::Free);
            let is_longer = best.is_none_or(|(most, _)| count[id] > most);
            let is_moved = count[id] > 0 && !is_free && !beside.contains(&id);
            if is_moved && self.masses[id].mass_kg > 0.0 && is_longer {
                best = Some((count[id], id));
            }
        }
        let Some((_, tip)) = best else {
            return;
        };
        // The origin of the body may lie on the axis of its joint, where it would not move.
        let centre_m = self.masses[tip].centre_m;
        let mark = format!("{}_centre", usual(&self.names[tip]));
        self.structure.marks.push(Frame {
            name: mark.clone(),
            body: self.names[tip].clone(),
            pose: Pose {
                at_m: (centre_m.x, centre_m.y, centre_m.z),
                ..Pose::default()
            },
        });
        self.structure.track = Some(mark);
        notes.assumed(
            None,
            format!(
                "the root is held, and the motion of the centre of mass of `{}` is recorded, the first body at the end of the longest chain of joints",
                self.names[tip]
            ),
            "name another body or mark in `track`",
        );
    }
}

/// Whether a box has sides that a body beside a robot may have.
fn is_usual_box(geom: &Geom) -> bool {
    let sides_m = geom.size * 2.0;
    sides_m.min() >= 1e-4 && sides_m.max() <= 100.0
}

/// A name in the signs that names have here.
fn usual(name: &str) -> String {
    let is_usual = |c: char| c.is_ascii_alphanumeric() || c == '_';
    (name.chars().take(40))
        .map(|c| if is_usual(c) { c } else { '_' })
        .collect()
}

/// A name that a body beside the robot may have.
fn plain(name: &str, number: usize) -> String {
    format!("{}_{number}", usual(name))
}

/// How far a shape reaches below its centre, metres; meshes count as points.
fn down_m(geom: &Geom, pose: &Isometry3<f64>) -> f64 {
    let down = (pose.rotation.inverse() * -Vector3::z()).abs();
    let size = geom.size;
    match geom.kind {
        GeomType::Sphere => size.x,
        GeomType::Capsule => size.x + down.z * size.y,
        GeomType::Cylinder => size.x * down.xy().norm() + down.z * size.y,
        GeomType::Box => down.dot(&size),
        GeomType::Ellipsoid => down.component_mul(&size).norm(),
        GeomType::Plane | GeomType::Mesh | GeomType::Other => 0.0,
    }
}
