//! The Unified Robot Description Format of ROS.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Vector3};
use roxmltree::Node;

use super::Options;
use super::element::{Place, child, children, words};
use super::note::Notes;
use super::urdf_link::Reader;
use crate::morphology::body::{
    Body, Driver, Follow, Joint, JointKind, Pose, Structure, TurnSpring,
};
use crate::morphology::{Servo, ServoLaw};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// How strongly the servo that stands in for the one URDF does not describe answers an error of its angle, 1/s.
const GAIN_1_S: f64 = 20.0;
/// Limits farther away than this are none, radians or metres.
const FAR: f64 = 1e3;
/// Largest torque and speed that a servo may have.
const MOST: f64 = 1e4;

/// Reads the robot under the root element.
pub(super) fn read(
    source: &Source,
    root: Node<'_, '_>,
    options: &Options,
    notes: &mut Notes,
    lines: &mut Vec<usize>,
) -> Result<Structure> {
    let place = Place { source };
    let name = match root.attribute("name") {
        Some(name) => name.to_owned(),
        None => {
            let stem = source.path().file_stem().unwrap_or_default();
            notes.assumed(
                place.line(root),
                "the robot has no name: the file's is taken",
                "add name=\"...\" to <robot>",
            );
            stem.to_string_lossy().into_owned()
        }
    };
    let collides = children(root, "link").any(|link| child(link, "collision").is_some());
    if !collides {
        notes.assumed(
            None,
            "no link has collision shapes: the visual ones are taken",
            "add <collision> elements",
        );
    }
    let reader = Reader {
        place,
        options,
        visuals_collide: !collides,
    };
    let mut robot = Robot {
        reader,
        structure: Structure {
            name,
            description: format!("read from {}", file_name(source)),
            bodies: Vec::new(),
            joints: Vec::new(),
            actuators: Vec::new(),
            marks: Vec::new(),
            never_touch: Vec::new(),
            mount: None,
            track: None,
        },
        lines: BTreeMap::new(),
        servos: 0,
    };
    robot.links(root, notes)?;
    robot.joints(root, notes)?;
    robot.roots(root, notes)?;
    robot.others(root, notes);
    let bodies = robot.structure.bodies.iter();
    lines.extend(bodies.map_while(|body| robot.lines.get(&body.name)));
    Ok(robot.structure)
}

fn file_name(source: &Source) -> String {
    let name = source.path().file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// A robot in the making.
struct Robot<'a> {
    reader: Reader<'a>,
    structure: Structure,
    /// Where links stand, by name.
    lines: BTreeMap<String, usize>,
    servos: usize,
}

impl Robot<'_> {
    fn links(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        for link in children(root, "link") {
            let body = self.reader.body(link, notes)?;
            let line = self.reader.place.line(link).unwrap_or(0);
            if let Some(first) = self.lines.insert(body.name.clone(), line) {
                let error = Error::invalid("two links have the same name")
                    .found(format!("`{}`, also in line {first}", body.name));
                return Err(self.reader.place.at(link, error));
            }
            self.structure.bodies.push(body);
        }
        Ok(())
    }

    fn joints(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        let mut names = BTreeSet::new();
        for (index, node) in children(root, "joint").enumerate() {
            let name = match node.attribute("name") {
                Some(name) => name.to_owned(),
                None => format!("joint{index}"),
            };
            if !names.insert(name.clone()) {
                let error =
                    Error::invalid("two joints have the same name").found(format!("`{name}`"));
                return Err(self.reader.place.at(node, error));
            }
            self.joint(node, name, notes)?;
        }
        if self.servos > 0 {
            notes.assumed(
                None,
                format!(
                    "the servos of {} joints: URDF has their limits only; each turns to its command at {GAIN_1_S} 1/s times its error, and holds 0 where nothing else is said",
                    self.servos
                ),
                "state laws and gaits in `actuators`, or import its joints passive",
            );
        }
        Ok(())
    }

    fn joint(&mut self, node: Node<'_, '_>, name: String, notes: &mut Notes) -> Result<()> {
        let place = self.reader.place;
        let line = place.line(node);
        let end = |tag: &'static str| -> Result<String> {
            let end = child(node, tag).ok_or_else(|| {
                place.at(
                    node,
                    Error::invalid(format!("the joint `{name}` has no <{tag}>")),
                )
            })?;
            let link = place.text(end, "link")?;
            if self.lines.contains_key(link) {
                return Ok(link.to_owned());
            }
            let names = self.lines.keys().map(String::as_str);
            Err(place.at(end, realgap_core::file::unknown_name("link", link, names)))
        };
        let (parent, child_name) = (end("parent")?, end("child")?);
        let pose = Pose::of(&place.origin(node)?);
        let axis = match child(node, "axis") {
            Some(axis) => place.vector(axis, "xyz")?,
            None => Vector3::x(),
        };
        let kind = place.text(node, "type")?;
        let joint = |kind: JointKind| Joint {
            name: name.clone(),
            parent: parent.clone(),
            child: child_name.clone(),
            pose,
            kind,
        };
        let moves = matches!(kind, "revolute" | "continuous" | "prismatic");
        if moves && axis.norm() < 1e-9 {
            return Err(place.at(
                node,
                Error::invalid(format!("the axis of joint `{name}` has no direction"))
                    .found("0 0 0"),
            ));
        }
        let bearing = self.bearing(node, kind, &name, notes)?;
        match kind {
            "fixed" => self.structure.joints.push(joint(JointKind::Fixed)),
            "revolute" | "continuous" => self.structure.joints.push(joint(bearing.turn(&axis))),
            "prismatic" => self.structure.joints.push(joint(bearing.slide(&axis))),
            "floating" | "planar" | "spherical" => {
                self.many(&joint(JointKind::Fixed), kind, line, notes);
            }
            other => {
                let error = Error::invalid("no such type of joint")
                    .found(format!("{other} of `{name}`"))
                    .allowed("fixed, revolute, continuous, prismatic, floating, planar, spherical");
                return Err(place.at(node, error));
            }
        }
        if moves && !self.reader.options.passive {
            self.servo(node, &name, bearing.effort, bearing.velocity, notes)?;
        }
        Ok(())
    }

    /// Friction and limits of a joint.
    fn bearing(
        &self,
        node: Node<'_, '_>,
        kind: &str,
        name: &str,
        notes: &mut Notes,
    ) -> Result<Bearing> {
        let place = self.reader.place;
        let mut bearing = Bearing::default();
        if let Some(dynamics) = child(node, "dynamics") {
            let mut read = |attribute: &str| -> Result<f64> {
                let value = place.number(dynamics, attribute)?.unwrap_or(0.0);
                if value < 0.0 {
                    let what = format!("the {attribute} of joint `{name}` is {value}: 0 is taken");
                    notes.changed(
                        place.line(dynamics),
                        what,
                        "friction takes energy: state 0 or more",
                    );
                }
                Ok(value.max(0.0))
            };
            (bearing.viscous, bearing.dry) = (read("damping")?, read("friction")?);
            let stiffness = place
                .number(dynamics, "stiffness")?
                .or(place.number(dynamics, "spring_stiffness")?);
            let rest = place.number(dynamics, "spring_reference")?.unwrap_or(0.0);
            bearing.spring = stiffness.filter(|k| *k > 0.0).map(|k| (k, rest));
        }
        let Some(limit) = child(node, "limit") else {
            if kind == "prismatic" || kind == "revolute" {
                let what = format!("the {kind} joint `{name}` has no limits");
                notes.assumed(
                    place.line(node),
                    what,
                    "add <limit lower=... upper=... effort=... velocity=.../>",
                );
            }
            return Ok(bearing);
        };
        bearing.effort = place.number(limit, "effort")?.unwrap_or(0.0);
        bearing.velocity = place.number(limit, "velocity")?.unwrap_or(0.0);
        let end = |name: &str| -> Result<f64> {
            // Some say inf for no limit.
            match limit
                .attribute(name)
                .and_then(|text| text.trim().parse().ok())
            {
                Some(value) if f64::is_infinite(value) => Ok(value),
                _ => Ok(place.number(limit, name)?.unwrap_or(0.0)),
            }
        };
        let (lower, upper) = (end("lower")?, end("upper")?);
        let is_limited = kind == "revolute" || kind == "prismatic";
        // Beyond any robot: somebody's way to say that there are none.
        let are_far = lower <= -FAR && upper >= FAR;
        bearing.limits = (is_limited && lower < upper && !are_far).then_some((lower, upper));
        if is_limited && lower >= upper {
            let what = format!(
                "the limits {lower} to {upper} of joint `{name}` leave nothing: it has none here"
            );
            notes.changed(place.line(limit), what, "state the range, or make it fixed");
        }
        Ok(bearing)
    }

    /// A joint with several freedoms as a chain of single ones, with links of nothing between them.
    fn many(&mut self, joint: &Joint, kind: &str, line: Option<usize>, notes: &mut Notes) {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let free = Bearing::default();
        let chain: Vec<(&str, JointKind)> = match kind {
            "planar" => vec![
                ("x", free.slide(&x)),
                ("y", free.slide(&y)),
                ("turn", free.turn(&z)),
            ],
            "spherical" => vec![
                ("roll", free.turn(&x)),
                ("pitch", free.turn(&y)),
                ("yaw", free.turn(&z)),
            ],
            _ => vec![
                ("x", free.slide(&x)),
                ("y", free.slide(&y)),
                ("z", free.slide(&z)),
                ("roll", free.turn(&x)),
                ("pitch", free.turn(&y)),
                ("yaw", free.turn(&z)),
            ],
        };
        let what = format!(
            "the {kind} joint `{}` is a chain of {} joints with one freedom each",
            joint.name,
            chain.len()
        );
        notes.changed(
            line,
            what,
            "at a pitch of 90 degrees it loses one freedom: keep away from there",
        );
        chained(&mut self.structure, joint, chain);
    }

    fn servo(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        effort: f64,
        velocity: f64,
        notes: &mut Notes,
    ) -> Result<()> {
        let place = self.reader.place;
        let mimic = child(node, "mimic");
        if effort <= 0.0 {
            if let Some(mimic) = mimic {
                let what =
                    format!("that joint `{name}` mimics another: it has no effort to do it with");
                notes.left_out(place.line(mimic), what, "give its limit an effort");
            }
            return Ok(());
        }
        if effort > MOST || velocity > MOST {
            let what = format!(
                "the effort {effort} or velocity {velocity} of joint `{name}`: at most {MOST} here"
            );
            notes.changed(place.line(node), what, "state what its motor can do");
        }
        let follows = match mimic {
            None => None,
            Some(mimic) => Some(Follow {
                joint: place.text(mimic, "joint")?.to_owned(),
                factor: place.number(mimic, "multiplier")?.unwrap_or(1.0),
                offset_rad: place.number(mimic, "offset")?.unwrap_or(0.0),
            }),
        };
        if let (Some(follow), Some(mimic)) = (&follows, mimic) {
            let what = format!(
                "joint `{name}` is not geared to `{}`: a servo of its own copies that one's command",
                follow.joint
            );
            notes.changed(
                place.line(mimic),
                what,
                "the two part where a load parts them",
            );
        }
        let servo = Servo {
            law: ServoLaw::Velocity { gain_1_s: GAIN_1_S },
            max_torque_nm: effort.min(MOST),
            max_speed_rad_s: if velocity > 0.0 {
                velocity.min(MOST)
            } else {
                f64::INFINITY
            },
            delay_s: 0.0,
        };
        self.servos += 1;
        self.structure.actuators.push(Driver {
            joint: name.to_owned(),
            servo: servo.into(),
            gait: None,
            follows,
        });
        Ok(())
    }

    /// Whether the root is the world, and followers whose leaders have no servo.
    fn roots(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        let structure = &mut self.structure;
        let driven: BTreeSet<String> = structure
            .actuators
            .iter()
            .map(|d| d.joint.clone())
            .collect();
        for driver in &mut structure.actuators {
            if let Some(follow) = driver
                .follows
                .take_if(|follow| !driven.contains(&follow.joint))
            {
                let what = format!(
                    "that joint `{}` mimics `{}`, which has no servo",
                    driver.joint, follow.joint
                );
                notes.left_out(None, what, "give the limit of that joint an effort");
            }
        }
        if structure.bodies.is_empty() {
            return Err(self
                .reader
                .place
                .at(root, Error::invalid("a robot without links")));
        }
        let children: BTreeSet<&str> = structure.joints.iter().map(|j| j.child.as_str()).collect();
        let mut parents = BTreeMap::new();
        for joint in &structure.joints {
            if let Some(first) = parents.insert(joint.child.as_str(), &joint.name) {
                let line = self.lines.get(&joint.child).copied().unwrap_or(1);
                return Err(Error::invalid(format!(
                    "link `{}` hangs on two joints: a closed loop",
                    joint.child
                ))
                .at_file(self.reader.place.source.path())
                .at_line(line, 1)
                .found(format!("`{first}` and `{}`", joint.name))
                .allowed("one joint above every link")
                .hint("open the loop: remove one of the two joints"));
            }
        }
        let roots: Vec<&Body> = structure
            .bodies
            .iter()
            .filter(|b| !children.contains(b.name.as_str()))
            .collect();
        let [only] = roots.as_slice() else {
            let names: Vec<String> = roots
                .iter()
                .take(8)
                .map(|body| {
                    let line = self.lines.get(&body.name).copied().unwrap_or(0);
                    format!("`{}` (line {line})", body.name)
                })
                .collect();
            let error = match roots.is_empty() {
                true => Error::invalid("the joints go round in a circle")
                    .found("no link that hangs on nothing"),
                false => Error::invalid("a robot has one link that hangs on nothing: its root")
                    .found(format!("{}: {}", roots.len(), names.join(", ")))
                    .hint("join the others to it, or put them into a file of their own"),
            };
            return Err(self.reader.place.at(root, error));
        };
        if only.name == "world" || self.reader.options.mounted {
            structure.mount = Some(Pose::of(&Isometry3::identity()));
        }
        Ok(())
    }

    /// Everything that is neither link nor joint, and what is unknown in them, one note a kind.
    fn others(&self, root: Node<'_, '_>, notes: &mut Notes) {
        let mut seen: BTreeMap<String, (usize, Option<usize>)> = BTreeMap::new();
        let known = |parent: &str, tag: &str| match parent {
            "robot" => ["link", "joint", "material"].contains(&tag),
            "link" => ["inertial", "visual", "collision"].contains(&tag),
            "joint" => [
                "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
            ]
            .contains(&tag),
            _ => true,
        };
        let elements = root.descendants().filter(Node::is_element);
        for node in elements {
            let Some(parent) = node.parent_element() else {
                continue;
            };
            let (above, tag) = (parent.tag_name().name(), node.tag_name().name());
            let is_inside = parent == root || parent.parent_element() == Some(root);
            if is_inside && !known(above, tag) {
                let entry = seen.entry(format!("<{tag}> in <{above}>"));
                entry.or_insert((0, self.reader.place.line(node))).0 += 1;
            }
        }
        let lists = root.descendants().flat_map(|node| {
            let named = ["xyz", "rpy", "size", "scale"].into_iter();
            named.filter_map(move |name| Some((node, node.attribute(name)?)))
        });
        for (node, text) in lists {
            if text.contains(',') || words(text).count() > 3 {
                let what = format!("the list {text:?} has commas or more than three numbers");
                let remedy = "write three numbers, separated by blanks";
                notes.changed(self.reader.place.line(node), what, remedy);
            }
        }
        for (what, (count, line)) in seen {
            notes.left_out(
                line,
                format!("{what} ({count})"),
                "state what matters of it in the RON",
            );
        }
    }
}

/// Friction, limits and motor of a joint, in radians or metres.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bearing {
    pub viscous: f64,
    pub dry: f64,
    pub armature: f64,
    pub spring: Option<(f64, f64)>,
    pub limits: Option<(f64, f64)>,
    pub effort: f64,
    pub velocity: f64,
}

impl Bearing {
    /// A joint that turns.
    pub fn turn(&self, axis: &Vector3<f64>) -> JointKind {
        JointKind::Turn {
            axis: (axis.x, axis.y, axis.z),
            anchor_m: (0.0, 0.0, 0.0),
            limits_rad: self.limits,
            viscous_nm_s_rad: self.viscous,
            dry_nm: self.dry,
            armature_kg_m2: self.armature,
            spring: self.spring.map(|(stiffness_nm_rad, rest_rad)| TurnSpring {
                stiffness_nm_rad,
                rest_rad,
            }),
        }
    }

    /// A joint that slides.
    pub fn slide(&self, axis: &Vector3<f64>) -> JointKind {
        JointKind::Slide {
            axis: (axis.x, axis.y, axis.z),
            limits_m: self.limits,
            viscous_n_s_m: self.viscous,
            dry_n: self.dry,
            armature_kg: self.armature,
            spring: self.spring.map(|(stiffness_n_m, rest_m)| {
                crate::morphology::body::SlideSpring {
                    stiffness_n_m,
                    rest_m,
                }
            }),
        }
    }
}

/// Adds a chain of joints in place of one, with bodies of nothing between them; the pose is that of the first.
pub(super) fn chained(structure: &mut Structure, joint: &Joint, chain: Vec<(&str, JointKind)>) {
    let count = chain.len();
    let mut parent = joint.parent.clone();
    for (index, (name, kind)) in chain.into_iter().enumerate() {
        let is_last = index + 1 == count;
        let child = match is_last {
            true => joint.child.clone(),
            false => format!("{}_{name}", joint.child),
        };
        if !is_last {
            structure.bodies.push(Body {
                name: child.clone(),
                ..Body::default()
            });
        }
        structure.joints.push(Joint {
            name: format!("{}_{name}", joint.name),
            parent: std::mem::replace(&mut parent, child.clone()),
            child,
            pose: if index == 0 {
                joint.pose
            } else {
                Pose::default()
            },
            kind,
        });
    }
}
