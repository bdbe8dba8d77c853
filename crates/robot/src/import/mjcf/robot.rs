//! Conversion of a resolved MJCF into a robot of bodies.

use std::cell::{LazyCell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::super::note::Notes;
use super::super::urdf::file_name;
use super::super::urdf_joint::{Bearing, chained};
use super::super::{MOST_SHAPES, Options, refuse_count};
use super::actuator::Actuator;
use super::mass::{Mass, MassReader};
use super::matrix::Inertia;
use super::model::{Body as GivenBody, Geom, GeomType, Joint as GivenJoint, JointType, Model};
use crate::morphology::body::{
    Body, Frame, Joint, JointKind, MAX_BODIES, Piece, Pose, Structure, Tensor,
};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// Name of the root body when the root is MuJoCo's world.
const WORLD: &str = "world";
/// The largest damping, dry friction and armature of a joint.
const MOST: f64 = 1e9;

/// Reads the model of a file, and of the files that it includes.
pub(in crate::import) fn read(
    source: &Source,
    text: &str,
    options: &Options,
    notes: &mut Notes,
) -> Result<Structure> {
    let model = Model::read(text, source.path())?;
    if model.bodies.len() < 2 {
        return Err(Error::invalid("a model without bodies")
            .at_file(source.path())
            .hint("a file that others include is not a robot: read the one that includes it"));
    }
    limit_size(&model).map_err(|error| error.at_file(source.path()))?;
    let names = names(&model);
    let reader = MassReader {
        model: &model,
        main: source.path(),
        options,
        solids: RefCell::default(),
    };
    let masses = reader.all(&names, notes)?;
    let mut drives = Vec::new();
    for given in model.section("actuator") {
        let origin = &model.origins[given.origin];
        drives.extend(Actuator::of(
            &origin.defaults.actuators(given),
            origin.settings.autolimits,
        )?);
    }
    let armatures = armatures(&model, &drives);
    let stem = source
        .path()
        .file_stem()
        .unwrap_or(Path::new("").as_os_str());
    let structure = Structure {
        name: (model.name.clone())
            .filter(|name| !name.is_empty())
            .unwrap_or_else(|| stem.to_string_lossy().into_owned()),
        description: format!("read from {}", file_name(source)),
        ..Structure::default()
    };
    let of_joints = armatures.clone();
    let mut robot = Robot {
        source,
        model: &model,
        inertia: LazyCell::new(Box::new(|| Inertia::of(&model, &masses, &of_joints))),
        masses: &masses,
        armatures,
        reader,
        free_root: free_root(&model, &masses, &drives),
        names,
        structure,
        drives,
        joint_names: BTreeMap::new(),
    };
    robot.bodies(notes);
    robot.masks();
    robot.actuators(notes)?;
    robot.keyframe(options.keyframe.as_deref(), notes)?;
    robot.surroundings(notes)?;
    robot.track_a_moving_body(notes);
    robot.others(notes);
    Ok(robot.structure)
}

/// The name in this robot of one of the joints of a body, whose own name is `body`.
pub(super) fn joint_name(given: &GivenBody, index: usize, body: &str) -> String {
    let stated = given.joints[index].name.clone();
    stated.unwrap_or_else(|| match given.joints.len() {
        1 => format!("{body}_joint"),
        _ => format!("{body}_joint{index}"),
    })
}

/// Refuses a model with more bodies or shapes than are read.
fn limit_size(model: &Model) -> Result<()> {
    let shapes = model.bodies.iter().map(|body| body.geoms.len()).sum();
    refuse_count("bodies", model.bodies.len() - 1, MAX_BODIES)?;
    refuse_count("shapes", shapes, MOST_SHAPES)
}

/// A unique name for every body.
pub(super) fn names(model: &Model) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let bodies = model.bodies.iter().enumerate();
    bodies
        .map(|(id, body)| {
            let name = match (&body.name, id) {
                (_, 0) => WORLD.to_owned(),
                (Some(name), _) if !name.is_empty() => name.clone(),
                _ => format!("body{id}"),
            };
            match taken.insert(name.clone()) {
                true => name,
                false => format!("{name}_{id}"),
            }
        })
        .collect()
}

/// The body on the world that contains each body, by index.
pub(super) fn tops(model: &Model) -> Vec<usize> {
    let mut tops = vec![0; model.bodies.len()];
    for id in 1..model.bodies.len() {
        let parent = model.bodies[id].parent;
        tops[id] = if parent == 0 { id } else { tops[parent] };
    }
    tops
}

/// The root of a robot that moves freely: the heaviest body on the world that has a free joint, together with what hangs on it. Of a
/// robot that is held, actuators drive joints of a body without a free joint; it has no such root.
fn free_root(model: &Model, masses: &[Mass], drives: &[Actuator]) -> Option<usize> {
    let tops = tops(model);
    let is_free = |id: usize| {
        let mut joints = model.bodies[id].joints.iter();
        joints.any(|joint| joint.kind == JointType::Free)
    };
    let is_driven = |joint: &GivenJoint| {
        joint.name.is_some() && drives.iter().any(|drive| drive.joint == joint.name)
    };
    let mut bodies = model.bodies.iter().zip(&tops).skip(1);
    if bodies.any(|(body, top)| !is_free(*top) && body.joints.iter().any(is_driven)) {
        return None;
    }
    let weight_kg = |root: usize| -> f64 {
        let own = masses.iter().zip(&tops).filter(|(_, top)| **top == root);
        own.map(|(mass, _)| mass.mass_kg).sum()
    };
    let free = (1..model.bodies.len()).filter(|id| model.bodies[*id].parent == 0 && is_free(*id));
    // Of equally heavy ones the first is taken.
    free.rev()
        .max_by(|a, b| weight_kg(*a).total_cmp(&weight_kg(*b)))
}

/// The armatures of all joints, with those of the actuators that drive them.
fn armatures(model: &Model, drives: &[Actuator]) -> Vec<Vec<f64>> {
    let of = |joint: &GivenJoint| {
        let own = drives
            .iter()
            .filter(|drive| drive.joint.is_some() && drive.joint == joint.name);
        joint.armature
            + own
                .map(|drive| drive.armature * drive.gear * drive.gear)
                .sum::<f64>()
    };
    let bodies = model.bodies.iter();
    bodies
        .map(|body| body.joints.iter().map(of).collect())
        .collect()
}

/// A robot while it is being built from the file.
pub(super) struct Robot<'a> {
    pub source: &'a Source,
    pub model: &'a Model,
    /// Computed when a value needs it: its cost grows with the cube of the number of joints.
    pub inertia: LazyCell<Inertia, Box<dyn FnOnce() -> Inertia + 'a>>,
    pub masses: &'a [Mass],
    armatures: Vec<Vec<f64>>,
    reader: MassReader<'a>,
    pub free_root: Option<usize>,
    pub names: Vec<String>,
    pub structure: Structure,
    pub drives: Vec<Actuator>,
    /// The name in this robot of each joint of the file with one degree of freedom, and its place: body and number.
    pub joint_names: BTreeMap<String, (String, (usize, usize))>,
}

impl Robot<'_> {
    fn bodies(&mut self, notes: &mut Notes) {
        let model = self.model;
        match self.free_root {
            Some(root) => self.start(root),
            None => {
                self.structure.mount = Some(Pose::default());
                let world = self.body(0, notes);
                self.structure.bodies.push(world);
            }
        }
        let beside = self.ids_beside();
        for id in (1..model.bodies.len()).filter(|id| !beside.contains(id)) {
            let body = self.body(id, notes);
            self.structure.bodies.push(body);
            for (index, (name, pose)) in model.bodies[id].sites.iter().enumerate() {
                let name = name.clone().filter(|name| !name.is_empty());
                self.structure.marks.push(Frame {
                    name: name.unwrap_or_else(|| format!("{}_site{index}", self.names[id])),
                    body: self.names[id].clone(),
                    pose: Pose::of(pose),
                });
            }
            if self.free_root != Some(id) {
                self.hang(id, notes);
            }
        }
    }

    /// Places a root that moves freely.
    fn start(&mut self, root: usize) {
        let pose = self.model.bodies[root].pose;
        if self.reader.options.mounted {
            let place = Isometry3::from_parts(pose.translation, UnitQuaternion::identity());
            self.structure.mount = Some(Pose::of(&place));
        }
        let turn = pose.rotation;
        if turn.w.abs() < 1.0 - 1e-12 {
            // The robot frame is upright, while the root body of the file may be rotated.
            let name = format!("{}_start", self.names[root]);
            self.structure.bodies.push(Body {
                name: name.clone(),
                ..Body::default()
            });
            self.structure.joints.push(Joint {
                name: format!("{}_turned", self.names[root]),
                parent: name,
                child: self.names[root].clone(),
                pose: Pose::of(&Isometry3::from_parts(Translation3::identity(), turn)),
                kind: JointKind::Fixed,
                start: None,
            });
        }
    }

    fn body(&mut self, id: usize, notes: &mut Notes) -> Body {
        let given = &self.model.bodies[id];
        let mut body = Body {
            name: self.names[id].clone(),
            gravity_compensation: given.gravity_compensation,
            ..Body::default()
        };
        let mass = &self.masses[id];
        if mass.mass_kg > 0.0 {
            let c = mass.centre_m;
            body.mass_kg = mass.mass_kg;
            body.centre_of_mass_m = Some((c.x, c.y, c.z));
            body.inertia_kg_m2 = Some(Tensor::of(&mass.inertia_kg_m2));
        }
        for geom in given.geoms.iter().filter(|geom| geom.touches()) {
            if geom.kind == GeomType::Plane && id == 0 {
                // It is the floor of the `world`.
                continue;
            }
            let posed = self.reader.pieces(geom, &body.name, notes).into_iter();
            let turning = self.turning_of(geom);
            body.shapes.extend(posed.map(|(form, pose)| Piece {
                form,
                pose: Pose::of(&pose),
                tyre: None,
                turning,
            }));
        }
        body
    }

    /// Connects a body to its parent by the joints that the body states.
    fn hang(&mut self, id: usize, notes: &mut Notes) {
        let given = &self.model.bodies[id];
        let name = self.names[id].clone();
        let base = Joint {
            name: name.clone(),
            parent: self.names[given.parent].clone(),
            child: name.clone(),
            pose: Pose::of(&given.pose),
            kind: JointKind::Fixed,
            start: None,
        };
        let mut kinds: Vec<(String, JointKind)> = Vec::new();
        for (index, joint) in given.joints.iter().enumerate() {
            let own = joint_name(given, index, &name);
            self.freedoms(joint, &own, (id, index), &mut kinds, notes);
        }
        if kinds.is_empty() {
            kinds.push((format!("{name}_fixed"), JointKind::Fixed));
        }
        // A link without mass and shape is inserted after each joint but the last.
        let first = self.structure.joints.len();
        let chain = kinds
            .iter()
            .map(|(own, kind)| (own.as_str(), kind.clone()))
            .collect();
        chained(&mut self.structure, &base, chain);
        for (joint, (own, _)) in self.structure.joints[first..].iter_mut().zip(&kinds) {
            joint.name.clone_from(own);
        }
    }

    /// Friction, spring and limits of a joint of the file, in the coordinate that is 0 at the start.
    fn bearing(&self, joint: &GivenJoint, (body, index): (usize, usize)) -> Bearing {
        let (mut stiffness, mut damping) = (joint.stiffness, joint.damping);
        if let Some([time_s, ratio]) = joint.spring_damper
            && let Some(inertia) = self.inertia.free(body, index)
        {
            stiffness = inertia / (time_s * time_s * ratio * ratio);
            damping = 2.0 * inertia / time_s;
        }
        let own = self
            .drives
            .iter()
            .filter(|drive| drive.joint.is_some() && drive.joint == joint.name);
        damping += own
            .map(|drive| drive.damping * drive.gear * drive.gear)
            .sum::<f64>();
        let limits = joint.range.filter(|[low, high]| low < high);
        Bearing {
            viscous: damping,
            dry: joint.dry,
            armature: self.armatures[body][index],
            spring: (stiffness > 0.0).then_some((stiffness, joint.rest - joint.reference)),
            limits: limits.map(|[low, high]| (low - joint.reference, high - joint.reference)),
            ..Bearing::default()
        }
    }

    /// Appends the degrees of freedom of one joint of the file to `kinds`.
    fn freedoms(
        &mut self,
        joint: &GivenJoint,
        name: &str,
        place: (usize, usize),
        kinds: &mut Vec<(String, JointKind)>,
        notes: &mut Notes,
    ) {
        let mut bearing = self.bearing(joint, place);
        for (what, value) in [
            ("damping", &mut bearing.viscous),
            ("dry friction", &mut bearing.dry),
            ("armature", &mut bearing.armature),
        ] {
            if *value > MOST {
                notes.changed(
                    None,
                    format!("the {what} {value} of joint `{name}` is reduced to {MOST}"),
                    "a joint that is not to move is stated as fixed: leave it out of the file",
                );
                *value = MOST;
            }
        }
        let bearing = bearing;
        let anchored = |mut kind: JointKind| {
            if let JointKind::Turn { anchor_m, .. } = &mut kind {
                let p = joint.pos_m;
                *anchor_m = (p.x, p.y, p.z);
            }
            kind
        };
        if joint.reference != 0.0 {
            notes.changed(
                None,
                format!(
                    "the coordinate of joint `{name}` is measured from its reference {}",
                    joint.reference
                ),
                "add the reference before a comparison with MuJoCo's qpos",
            );
        }
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let single = Bearing {
            limits: None,
            spring: None,
            ..bearing
        };
        match joint.kind {
            JointType::Hinge | JointType::Slide => {
                if let Some(own) = &joint.name {
                    self.joint_names
                        .insert(own.clone(), (name.to_owned(), place));
                }
                let kind = match joint.kind {
                    JointType::Slide => bearing.slide(&joint.axis),
                    _ => anchored(bearing.turn(&joint.axis)),
                };
                kinds.push((name.to_owned(), kind));
            }
            JointType::Ball => {
                notes.changed(
                    None,
                    format!("the ball joint `{name}` is replaced by three hinges about x, y and z"),
                    "at a pitch of 90 degrees it loses one degree of freedom (gimbal lock): avoid that orientation",
                );
                if bearing.limits.is_some() || bearing.spring.is_some() {
                    notes.left_out(
                        None,
                        format!("limit and spring of the ball joint `{name}`"),
                        "state those of the three hinges",
                    );
                }
                for (end, axis) in [("x", x), ("y", y), ("z", z)] {
                    kinds.push((format!("{name}_{end}"), anchored(single.turn(&axis))));
                }
            }
            JointType::Free => {
                notes.changed(None, format!("the free joint `{name}` of a body other than the root is replaced by three slides and three hinges"), "at a pitch of 90 degrees it loses one degree of freedom (gimbal lock): avoid that orientation");
                for (end, axis) in [("px", x), ("py", y), ("pz", z)] {
                    kinds.push((format!("{name}_{end}"), single.slide(&axis)));
                }
                for (end, axis) in [("x", x), ("y", y), ("z", z)] {
                    kinds.push((format!("{name}_{end}"), single.turn(&axis)));
                }
            }
        }
    }

    /// Collects the pairs of bodies that do not collide because of their contact bits (contype, conaffinity) or because the file
    /// excludes them.
    fn masks(&mut self) {
        let touching = |id: usize| -> Vec<&Geom> {
            let geoms = self.model.bodies[id].geoms.iter();
            geoms
                .filter(|g| g.touches() && g.kind != GeomType::Plane)
                .collect()
        };
        let all: Vec<Vec<&Geom>> = (0..self.model.bodies.len()).map(touching).collect();
        let first = usize::from(self.structure.mount.is_none());
        let mut pairs = BTreeSet::new();
        for a in first..all.len() {
            for b in a + 1..all.len() {
                let meets = all[a].iter().any(|g| {
                    all[b]
                        .iter()
                        .any(|h| g.contype & h.conaffinity != 0 || h.contype & g.conaffinity != 0)
                });
                let known = |id: usize| {
                    self.structure
                        .bodies
                        .iter()
                        .any(|b| b.name == self.names[id])
                };
                let touches = !all[a].is_empty() && !all[b].is_empty();
                if !meets && touches && known(a) && known(b) {
                    pairs.insert((self.names[a].clone(), self.names[b].clone()));
                }
            }
        }
        for exclude in self
            .model
            .section("contact")
            .filter(|pair| pair.tag == "exclude")
        {
            let known = |name: &String| self.structure.bodies.iter().any(|body| body.name == *name);
            let of = |name: &str| exclude.get(name).unwrap_or_default().to_owned();
            let pair = (of("body1"), of("body2"));
            let is_there =
                pairs.contains(&pair) || pairs.contains(&(pair.1.clone(), pair.0.clone()));
            if known(&pair.0) && known(&pair.1) && !is_there {
                pairs.insert(pair);
            }
        }
        self.structure.collision_exclude = pairs.into_iter().collect();
    }
}
