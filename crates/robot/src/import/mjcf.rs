//! Import of MJCF, the format of MuJoCo, which the crate `mjcf-rs` parses and resolves.

use std::collections::{BTreeMap, BTreeSet};

use mjcf_rs::Model;
use mjcf_rs::body::{Body as Given, Geom, GeomType, Joint as GivenJoint, JointType};
use mjcf_rs::equality::Equality;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::element::XmlSource;
use super::mjcf_mass::{MassReader, isometry};
use super::note::Notes;
use super::urdf::file_name;
use super::urdf_joint::{Bearing, chained};
use super::{MOST_SHAPES, Options, includes, refuse_count};
use crate::morphology::body::{Body, Frame, Joint, JointKind, MAX_BODIES, Piece, Pose, Structure};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// Name of the root body when the root is MuJoCo's world.
const WORLD: &str = "world";

/// Reads the model of a file, and of the files that it includes.
pub(super) fn read(
    place: XmlSource<'_>,
    root: Node<'_, '_>,
    options: &Options,
    notes: &mut Notes,
) -> Result<Structure> {
    let source = place.source;
    let model = includes::model(place, root)?;
    limit_size(&model).map_err(|error| place.at(root, error))?;
    let mut robot = Robot {
        source,
        model: &model,
        mass_reader: MassReader {
            model: &model,
            source,
            options,
        },
        names: names(&model),
        structure: Structure {
            name: model
                .name
                .clone()
                .filter(|name| !name.is_empty())
                .unwrap_or_else(|| {
                    let stem = source.path().file_stem().unwrap_or_default();
                    stem.to_string_lossy().into_owned()
                }),
            description: format!("read from {}", file_name(source)),
            ..Structure::default()
        },
        joint_names: BTreeMap::new(),
    };
    if model.bodies.len() < 2 {
        let error = Error::invalid("a model without bodies")
            .hint("a file that others include is not a robot: read the one that includes it");
        return Err(place.at(root, error));
    }
    robot.bodies(options, notes)?;
    robot.masks();
    robot.actuators(notes);
    robot.others(root, &place, notes);
    robot.mass_reader.finish(&mut robot.structure, notes);
    Ok(robot.structure)
}

/// Refuses a model with more bodies or shapes than are read.
fn limit_size(model: &Model) -> Result<()> {
    let shapes = model
        .bodies
        .iter()
        .map(|entry| entry.body.geoms.len())
        .sum();
    refuse_count("bodies", model.bodies.len() - 1, MAX_BODIES)?;
    refuse_count("shapes", shapes, MOST_SHAPES)
}

/// A unique name for every body.
fn names(model: &Model) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let bodies = model.bodies.iter().enumerate();
    bodies
        .map(|(id, entry)| {
            let name = match (&entry.body.name, id) {
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

/// A robot while it is being built from the file.
pub(super) struct Robot<'a> {
    source: &'a Source,
    pub model: &'a Model,
    mass_reader: MassReader<'a>,
    names: Vec<String>,
    pub structure: Structure,
    /// The name in this robot of each joint of the file.
    pub joint_names: BTreeMap<String, String>,
}

impl Robot<'_> {
    fn bodies(&mut self, options: &Options, notes: &mut Notes) -> Result<()> {
        let model = self.model;
        let is_free = |id: usize| {
            let joints = &model.bodies[id].body.joints;
            joints.iter().any(|joint| joint.type_ == JointType::Free)
        };
        let on_world: Vec<usize> = (1..model.bodies.len())
            .filter(|&id| model.bodies[id].parent == Some(0))
            .collect();
        let free_root = match on_world.as_slice() {
            [only] if is_free(*only) => Some(*only),
            _ => None,
        };
        match free_root {
            Some(root) => {
                let pose = isometry(&model.bodies[root].body.pose);
                if options.mounted {
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
                    });
                }
                let statics = model.bodies[0]
                    .body
                    .geoms
                    .iter()
                    .filter(|g| g.type_ != GeomType::Plane)
                    .count();
                if statics > 0 {
                    notes.left_out(
                        None,
                        format!("{statics} shapes of the world that are not part of the robot"),
                        "state them as the scene of an experiment",
                    );
                }
            }
            None => {
                self.structure.mount = Some(Pose::default());
                let world = self.body(0, notes)?;
                self.structure.bodies.push(world);
            }
        }
        for id in 1..model.bodies.len() {
            let body = self.body(id, notes)?;
            self.structure.bodies.push(body);
            for (index, site) in model.bodies[id].body.sites.iter().enumerate() {
                let name = site.name.clone().filter(|name| !name.is_empty());
                self.structure.marks.push(Frame {
                    name: name.unwrap_or_else(|| format!("{}_site{index}", self.names[id])),
                    body: self.names[id].clone(),
                    pose: Pose::of(&isometry(&site.pose)),
                });
            }
            if free_root != Some(id) {
                self.hang(id, notes);
            }
        }
        Ok(())
    }

    fn body(&mut self, id: usize, notes: &mut Notes) -> Result<Body> {
        let given: &Given = &self.model.bodies[id].body;
        let mut body = Body {
            name: self.names[id].clone(),
            ..Body::default()
        };
        // The world has no mass.
        if id > 0 {
            self.mass_reader
                .weigh(&mut body, given, notes)
                .map_err(|error| error.at_file(self.source.path()))?;
        }
        for geom in given
            .geoms
            .iter()
            .filter(|g| g.contype != 0 || g.conaffinity != 0)
        {
            if geom.type_ == GeomType::Plane && id == 0 {
                let at = isometry(&geom.pose);
                let up = at.rotation * Vector3::z();
                if up.z < 1.0 - 1e-9 || at.translation.z != 0.0 {
                    notes.left_out(
                        None,
                        "a plane of the world that is not the floor at height 0",
                        "set the parameters floor.height_m and floor.slope_rad",
                    );
                }
                continue;
            }
            let posed = self.mass_reader.pieces(geom, &body.name, notes).into_iter();
            body.shapes.extend(posed.map(|(form, pose)| Piece {
                form,
                pose: Pose::of(&pose),
            }));
        }
        Ok(body)
    }

    /// Connects a body to its parent by the joints that the body states.
    fn hang(&mut self, id: usize, notes: &mut Notes) {
        let entry = &self.model.bodies[id];
        let name = self.names[id].clone();
        let parent = self.names[entry.parent.unwrap_or(0)].clone();
        let base = Joint {
            name: name.clone(),
            parent,
            child: name.clone(),
            pose: Pose::of(&isometry(&entry.body.pose)),
            kind: JointKind::Fixed,
        };
        let mut kinds: Vec<(String, JointKind)> = Vec::new();
        for (index, joint) in entry.body.joints.iter().enumerate() {
            let own = joint.name.clone().filter(|name| !name.is_empty());
            let own = own.unwrap_or_else(|| match entry.body.joints.len() {
                1 => format!("{name}_joint"),
                _ => format!("{name}_joint{index}"),
            });
            self.freedoms(joint, &own, &mut kinds, notes);
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

    /// Appends the degrees of freedom of one joint of the file to `kinds`.
    fn freedoms(
        &mut self,
        joint: &GivenJoint,
        name: &str,
        kinds: &mut Vec<(String, JointKind)>,
        notes: &mut Notes,
    ) {
        let is_limited = joint
            .limited
            .resolve(self.model.compiler.autolimits, joint.range.is_some());
        let bearing = Bearing {
            viscous: joint.damping,
            dry: joint.frictionloss,
            armature: joint.armature,
            spring: (joint.stiffness > 0.0)
                .then_some((joint.stiffness, joint.springref - joint.ref_)),
            limits: joint
                .range
                .filter(|[low, high]| is_limited && low < high)
                .map(|[low, high]| (low - joint.ref_, high - joint.ref_)),
            ..Bearing::default()
        };
        let anchored = |mut kind: JointKind| {
            if let JointKind::Turn { anchor_m, .. } = &mut kind {
                *anchor_m = joint.pos.into();
            }
            kind
        };
        let axis = Vector3::from(joint.axis);
        if joint.ref_ != 0.0 {
            notes.changed(
                None,
                format!(
                    "the coordinate of joint `{name}` is measured from its reference {}",
                    joint.ref_
                ),
                "add the reference before a comparison with MuJoCo's qpos",
            );
        }
        if joint.springdamper.is_some() {
            notes.left_out(
                None,
                format!("springdamper of joint `{name}`"),
                "state its stiffness and damping",
            );
        }
        if let Some(own) = &joint.name {
            self.joint_names.insert(own.clone(), name.to_owned());
        }
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let single = Bearing {
            limits: None,
            spring: None,
            ..bearing
        };
        match joint.type_ {
            JointType::Hinge => kinds.push((name.to_owned(), anchored(bearing.turn(&axis)))),
            JointType::Slide => kinds.push((name.to_owned(), bearing.slide(&axis))),
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
            let geoms = self.model.bodies[id].body.geoms.iter();
            geoms
                .filter(|g| (g.contype != 0 || g.conaffinity != 0) && g.type_ != GeomType::Plane)
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
                if !meets && !all[a].is_empty() && !all[b].is_empty() {
                    pairs.insert((self.names[a].clone(), self.names[b].clone()));
                }
            }
        }
        for exclude in &self.model.contact.excludes {
            let known = |name: &String| self.structure.bodies.iter().any(|body| body.name == *name);
            let pair = (exclude.body1.clone(), exclude.body2.clone());
            let is_there =
                pairs.contains(&pair) || pairs.contains(&(pair.1.clone(), pair.0.clone()));
            if known(&pair.0) && known(&pair.1) && !is_there {
                pairs.insert(pair);
            }
        }
        self.structure.collision_exclude = pairs.into_iter().collect();
    }

    /// Adds one note for each kind of element that the import ignores.
    fn others(&self, root: Node<'_, '_>, place: &XmlSource<'_>, notes: &mut Notes) {
        for equality in &self.model.equality {
            match equality {
                Equality::Connect(_) | Equality::Weld(_) => {
                    notes.doubt(None, "a closed loop (connect or weld) is left open", "the robot moves differently from MuJoCo's: remove one branch of the loop, or use another model");
                }
                Equality::Joint(_) | Equality::Tendon(_) => {
                    notes.left_out(
                        None,
                        "a coupling of joints or tendons (equality)",
                        "let one actuator follow the other: `follows`",
                    );
                }
            }
        }
        let known = [
            "compiler",
            "option",
            "size",
            "visual",
            "statistic",
            "default",
            "asset",
            "worldbody",
            "contact",
            "actuator",
            "equality",
            "include",
        ];
        let quiet = ["visual", "statistic", "size"];
        let mut seen: BTreeMap<&str, (usize, Option<usize>)> = BTreeMap::new();
        for node in root.children().filter(Node::is_element) {
            let tag = node.tag_name().name();
            if !known.contains(&tag) && !quiet.contains(&tag) {
                let inside = node.children().filter(Node::is_element).count();
                seen.entry(tag).or_insert((0, place.line(node))).0 += inside;
            }
            if tag == "option" {
                notes.left_out(
                    place.line(node),
                    "the solver's settings (<option>)",
                    "set realgap's own solver parameters in the study",
                );
            }
        }
        let in_bodies = [
            "composite",
            "flexcomp",
            "plugin",
            "replicate",
            "camera",
            "light",
        ];
        for node in root
            .descendants()
            .filter(|node| in_bodies.contains(&node.tag_name().name()))
        {
            let inside_world = node
                .ancestors()
                .any(|above| above.has_tag_name("worldbody"));
            if inside_world {
                seen.entry(node.tag_name().name())
                    .or_insert((0, place.line(node)))
                    .0 += 1;
            }
        }
        for (tag, (count, line)) in seen {
            notes.left_out(
                line,
                format!("<{tag}> ({count})"),
                "add what you need of it to the RON file",
            );
        }
    }
}
