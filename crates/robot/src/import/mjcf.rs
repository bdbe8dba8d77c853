//! MJCF, the format of MuJoCo, as `mjcf-rs` resolves it.

use std::collections::{BTreeMap, BTreeSet};

use mjcf_rs::Model;
use mjcf_rs::body::{Body as Given, Geom, GeomType, Joint as GivenJoint, JointType};
use mjcf_rs::equality::Equality;
use mjcf_rs::extras::{Actuator, ActuatorKind};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::Options;
use super::element::Place;
use super::mjcf_mass::Weighing;
use super::note::Notes;
use super::urdf::{Bearing, chained};
use crate::morphology::body::{Body, Driver, Frame, Joint, JointKind, Piece, Pose, Structure};
use crate::morphology::{Servo, ServoLaw};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// What the model's root is called here where it is the world.
const WORLD: &str = "world";
/// Largest torque of a motor that states none.
const MOST: f64 = 1e4;

/// A pose of the crate's as ours.
pub(super) fn isometry(pose: &mjcf_rs::Pose) -> Isometry3<f64> {
    let (t, q) = (pose.translation, pose.rotation);
    Isometry3::from_parts(
        Translation3::new(t.x, t.y, t.z),
        UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z)),
    )
}

/// Reads the model of a file, and of the files that it includes.
pub(super) fn read(
    source: &Source,
    root: Node<'_, '_>,
    options: &Options,
    notes: &mut Notes,
) -> Result<Structure> {
    let place = Place { source };
    let folder = source.path().parent().unwrap_or(std::path::Path::new(""));
    let model = match source.path().is_file() {
        true => Model::from_file(source.path()),
        false => Model::from_str(source.text(), folder),
    };
    let model = model.map_err(|error| {
        Error::invalid(format!("not an MJCF that can be read: {error}")).at_file(source.path())
    })?;
    let mut robot = Robot {
        source,
        model: &model,
        weighing: Weighing::new(&model, source, options),
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
            description: format!(
                "read from {}",
                source
                    .path()
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
            ),
            bodies: Vec::new(),
            joints: Vec::new(),
            actuators: Vec::new(),
            marks: Vec::new(),
            never_touch: Vec::new(),
            mount: None,
            track: None,
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
    robot.weighing.finish(&mut robot.structure, notes);
    Ok(robot.structure)
}

/// A name for every body, each once.
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

/// A robot in the making.
struct Robot<'a> {
    source: &'a Source,
    model: &'a Model,
    weighing: Weighing<'a>,
    names: Vec<String>,
    structure: Structure,
    /// What the joints of the file are called here, and how their coordinate differs.
    joint_names: BTreeMap<String, String>,
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
                    // The robot frame stands upright: the root's own may lie.
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
                        format!("{statics} shapes of the world beside the robot"),
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
        // The world weighs nothing.
        if id > 0 {
            self.weighing
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
                        "set floor.height_m and floor.slope_rad",
                    );
                }
                continue;
            }
            body.shapes.extend(
                self.weighing
                    .piece(geom, &body.name, notes)
                    .map(|(form, pose)| Piece {
                        form,
                        pose: Pose::of(&pose),
                    }),
            );
        }
        Ok(body)
    }

    /// Joins a body to its parent by the joints that it states.
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
            self.structure.joints.push(Joint {
                name: format!("{name}_fixed"),
                ..base
            });
            return;
        }
        if kinds.len() == 1 {
            let (own, kind) = kinds.remove(0);
            self.structure.joints.push(Joint {
                name: own,
                kind,
                ..base
            });
            return;
        }
        // One link of nothing after each joint but the last.
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

    /// What one joint of the file lets its body do.
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
        let anchored = |kind: JointKind| match kind {
            JointKind::Turn {
                axis,
                limits_rad,
                viscous_nm_s_rad,
                dry_nm,
                armature_kg_m2,
                spring,
                ..
            } => JointKind::Turn {
                axis,
                anchor_m: (joint.pos[0], joint.pos[1], joint.pos[2]),
                limits_rad,
                viscous_nm_s_rad,
                dry_nm,
                armature_kg_m2,
                spring,
            },
            other => other,
        };
        let axis = Vector3::from(joint.axis);
        if joint.ref_ != 0.0 {
            notes.changed(
                None,
                format!("joint `{name}` counts from its reference {}", joint.ref_),
                "add it to compare with MuJoCo's qpos",
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
                    format!("the ball joint `{name}` is three hinges about x, y and z"),
                    "at a pitch of 90 degrees it loses one freedom: keep away from there",
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
                notes.changed(None, format!("the free joint `{name}` of a body beside the root is three slides and three hinges"), "at a pitch of 90 degrees it loses one freedom: keep away from there");
                for (end, axis) in [("px", x), ("py", y), ("pz", z)] {
                    kinds.push((format!("{name}_{end}"), single.slide(&axis)));
                }
                for (end, axis) in [("x", x), ("y", y), ("z", z)] {
                    kinds.push((format!("{name}_{end}"), single.turn(&axis)));
                }
            }
        }
    }

    /// Bodies whose shapes pass through each other by their bits, and those that the file excludes.
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
        self.structure.never_touch = pairs.into_iter().collect();
    }

    fn actuators(&mut self, notes: &mut Notes) {
        let mut motors = 0;
        for actuator in &self.model.actuators {
            let name = actuator
                .name
                .clone()
                .unwrap_or_else(|| "without a name".to_owned());
            let joint = actuator
                .joint
                .as_ref()
                .and_then(|joint| self.joint_names.get(joint));
            let Some(joint) = joint.cloned() else {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`, which drives no joint"),
                    "tendons, sites and bodies are not driven here: give joints actuators",
                );
                continue;
            };
            if self
                .structure
                .actuators
                .iter()
                .any(|driver| driver.joint == joint)
            {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`: joint `{joint}` has one already"),
                    "make one of the two",
                );
                continue;
            }
            match law(actuator) {
                Some((law, max_torque_nm, viscous)) => {
                    motors += usize::from(law == ServoLaw::Direct);
                    self.add_viscous(&joint, viscous);
                    let servo = Servo {
                        law,
                        max_torque_nm,
                        max_speed_rad_s: f64::INFINITY,
                        delay_s: 0.0,
                    };
                    self.structure.actuators.push(Driver {
                        joint,
                        servo: servo.into(),
                        gait: None,
                        follows: None,
                    });
                }
                None => notes.left_out(
                    None,
                    format!(
                        "the actuator `{name}`: only motors, position and velocity servos are read"
                    ),
                    "state its servo in `actuators`",
                ),
            }
        }
        if motors > 0 {
            notes.assumed(None, format!("{motors} motors take torques as commands, and have none to follow: they exert nothing"), "give `actuators` gaits: their numbers are torques");
        }
    }

    /// Damping that an actuator brings to its joint.
    fn add_viscous(&mut self, joint: &str, more: f64) {
        let Some(joint) = self
            .structure
            .joints
            .iter_mut()
            .find(|known| known.name == joint)
        else {
            return;
        };
        match &mut joint.kind {
            JointKind::Turn {
                viscous_nm_s_rad, ..
            } => *viscous_nm_s_rad += more,
            JointKind::Slide { viscous_n_s_m, .. } => *viscous_n_s_m += more,
            JointKind::Fixed => {}
        }
    }

    /// Everything that is read by nobody, one note a kind.
    fn others(&self, root: Node<'_, '_>, place: &Place<'_>, notes: &mut Notes) {
        for equality in &self.model.equality {
            match equality {
                Equality::Connect(_) | Equality::Weld(_) => {
                    notes.doubt(None, "a closed loop (connect or weld) is open here", "the robot moves otherwise than MuJoCo's: leave the loop's branch out, or take another model");
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
                    "realgap has its own, and a study states them",
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
                "state what matters of it in the RON",
            );
        }
    }
}

/// Law, largest torque, and damping of an actuator; `None` for what is none of those here.
fn law(actuator: &Actuator) -> Option<(ServoLaw, f64, f64)> {
    let gear = actuator.gear[0].abs();
    let gear = if gear == 0.0 { 1.0 } else { gear };
    let at_most = |range: Option<[f64; 2]>| {
        range
            .map(|[low, high]| low.abs().max(high.abs()))
            .filter(|most| *most > 0.0)
    };
    let force = at_most(actuator.force_range).map(|most| most * gear);
    let bounded = |most: Option<f64>| most.map_or(MOST, |most| most.clamp(1e-9, MOST));
    let direct = |factor: f64, viscous: f64| {
        let command = at_most(actuator.ctrl_range).map(|most| most * gear * factor);
        let most = match (command, force) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Some((ServoLaw::Direct, bounded(most), viscous))
    };
    let position = |kp: f64, kv: f64| {
        let law = ServoLaw::Torque {
            stiffness_nm_rad: (kp * gear * gear).clamp(1e-9, 1e6),
            damping_nm_s_rad: (kv * gear * gear).clamp(0.0, 1e6),
        };
        Some((law, bounded(force), 0.0))
    };
    match actuator.kind {
        ActuatorKind::Motor => direct(1.0, 0.0),
        ActuatorKind::Position => position(actuator.kp.unwrap_or(1.0), actuator.kv.unwrap_or(0.0)),
        ActuatorKind::Velocity => {
            let kv = actuator.kv.unwrap_or(1.0);
            direct(kv, kv * gear * gear)
        }
        ActuatorKind::Damper => None,
        ActuatorKind::General => {
            let gain = actuator.gainprm.first().copied().unwrap_or(1.0);
            let bias = |k: usize| actuator.biasprm.get(k).copied().unwrap_or(0.0);
            let is_fixed = actuator
                .gain_type
                .as_deref()
                .is_none_or(|kind| kind == "fixed");
            let is_affine = actuator.bias_type.as_deref() == Some("affine");
            match (is_fixed, is_affine) {
                (true, true) if bias(1) < 0.0 => position(-bias(1), -bias(2)),
                (true, true) => direct(gain.abs(), -bias(2) * gear * gear),
                (true, false) => direct(gain.abs(), 0.0),
                (false, _) => None,
            }
        }
        ActuatorKind::IntVelocity | ActuatorKind::Other => None,
    }
}
