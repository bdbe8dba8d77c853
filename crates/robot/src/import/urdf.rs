//! The Unified Robot Description Format of ROS: boxes and hinges of it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use nalgebra::{Isometry3, Vector3};
use roxmltree::{Document, Node};

use super::element::{Place, child, children};
use super::link::Body;
use crate::morphology::{Module, Morphology};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// Longest chain of joints.
const DEEPEST: usize = 1000;

/// A robot from another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The robot in RON.
    pub text: String,
    /// What was left out or changed.
    pub left_out: Vec<String>,
}

/// A joint, as it is written.
struct Joint<'n, 'd> {
    node: Node<'n, 'd>,
    name: &'n str,
    kind: &'n str,
    child: &'n str,
}

/// What has been made of the robot so far.
#[derive(Default)]
struct Robot {
    bodies: Vec<Body>,
    hinges: Vec<Hinge>,
    left_out: Vec<String>,
    /// Where the root is fixed to the world.
    mount_m: Option<Vector3<f64>>,
}

struct Hinge {
    name: String,
    parent: usize,
    child: usize,
    /// In the frame of the parent's body, robot's axes.
    at_m: Vector3<f64>,
    axis: Vector3<f64>,
    limits_rad: Option<[f64; 2]>,
    viscous_nm_s_rad: f64,
    dry_nm: f64,
}

/// Reads a URDF of boxes and hinges: links become modules of boxes with their masses and moments, revolute and continuous joints
/// become hinges, links behind fixed joints become part of what they are fixed to.
///
/// # Errors
/// Text that is no URDF; a tree that is none; joints that slide; boxes askew to each other; links without a shape or a mass.
pub fn from_urdf(source: &Source) -> Result<Imported> {
    let document = Document::parse(source.text()).map_err(|e| {
        let place = e.pos();
        Error::invalid(format!("not XML: {e}"))
            .at_file(source.path())
            .at_line(place.row as usize, place.col as usize)
    })?;
    let place = Place { source };
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let error = Error::invalid("not a URDF")
            .found(format!("<{}>", root.tag_name().name()))
            .allowed("<robot>")
            .hint("a xacro file is turned into one by: xacro FILE");
        return Err(place.at(root, error));
    }
    let name = place.text(root, "name")?;
    let mut links: BTreeMap<&str, Node<'_, '_>> = BTreeMap::new();
    for link in children(root, "link") {
        if links.insert(place.text(link, "name")?, link).is_some() {
            return Err(place.at(link, Error::invalid("two links have the same name")));
        }
    }
    let mut below: BTreeMap<&str, Vec<Joint<'_, '_>>> = BTreeMap::new();
    let mut parents: BTreeMap<&str, &str> = BTreeMap::new();
    for node in children(root, "joint") {
        let end = |tag: &'static str| -> Result<&str> {
            let end = child(node, tag).ok_or_else(|| {
                place.at(node, Error::invalid(format!("a joint without `{tag}`")))
            })?;
            let link = place.text(end, "link")?;
            match links.contains_key(link) {
                true => Ok(link),
                false => Err(place.at(end, Error::invalid("no such link").found(link))),
            }
        };
        let (parent, child) = (end("parent")?, end("child")?);
        if parents.insert(child, parent).is_some() {
            let error = Error::invalid("a link hangs on two joints: this is no tree").found(child);
            return Err(place.at(node, error));
        }
        below.entry(parent).or_default().push(Joint {
            node,
            name: place.text(node, "name")?,
            kind: place.text(node, "type")?,
            child,
        });
    }
    let mut roots = links.keys().filter(|link| !parents.contains_key(*link));
    let (Some(first), None) = (roots.next(), roots.next()) else {
        let error = Error::invalid("a robot has one link that hangs on nothing")
            .found(links.keys().filter(|l| !parents.contains_key(*l)).count());
        return Err(place.at(root, error));
    };
    let mut robot = Robot::default();
    robot.grow(&place, &links, &below, first)?;
    robot.rename();
    let text = robot.ron(name, source)?;
    // What is written is a robot, or says what is not.
    let checked = Source::new(source.path(), &text);
    Morphology::parse(&checked).map_err(|error| {
        error.or_hint("this is said of the robot as it was read; see what was left out")
    })?;
    Ok(Imported {
        text,
        left_out: robot.left_out,
    })
}

impl Robot {
    /// All links from the first on, parents before children.
    fn grow(
        &mut self,
        place: &Place<'_>,
        links: &BTreeMap<&str, Node<'_, '_>>,
        below: &BTreeMap<&str, Vec<Joint<'_, '_>>>,
        first: &str,
    ) -> Result<()> {
        let mut first = first;
        let root = Body::new(
            place,
            links[first],
            &Isometry3::identity().rotation,
            &mut self.left_out,
        )?;
        let mut start = Isometry3::identity();
        // A link of nothing with one fixed joint is the world.
        let mut base = root;
        if let (true, Some([only])) = (
            base.blocks.is_empty() && base.mass_kg == 0.0,
            below.get(first).map(Vec::as_slice),
        ) && only.kind == "fixed"
        {
            start = place.origin(only.node)?;
            self.mount_m = Some(start.translation.vector);
            start.translation.vector = Vector3::zeros();
            first = only.child;
            base = Body::new(place, links[first], &start.rotation, &mut self.left_out)?;
        }
        self.bodies.push(base);
        // Link, its body, and the pose of its frame in that body (robot's axes).
        let mut open = vec![(first, 0_usize, start, 0_usize)];
        while let Some((link, body, pose, depth)) = open.pop() {
            if depth > DEEPEST {
                return Err(place.at(
                    links[link],
                    Error::invalid("the joints go round in a circle"),
                ));
            }
            for joint in below.get(link).into_iter().flatten() {
                let frame = pose * place.origin(joint.node)?;
                let grown = Body::new(
                    place,
                    links[joint.child],
                    &frame.rotation,
                    &mut self.left_out,
                )?;
                match joint.kind {
                    "fixed" => {
                        let whole = self.bodies[body].clone();
                        self.bodies[body] = whole.with(&grown, &frame.translation.vector);
                        open.push((joint.child, body, frame, depth + 1));
                    }
                    "revolute" | "continuous" => {
                        let child = self.bodies.len();
                        self.bodies.push(grown);
                        let hinge = self.hinge(place, joint, body, child, &frame)?;
                        self.hinges.push(hinge);
                        let own = Isometry3::from_parts(Vector3::zeros().into(), frame.rotation);
                        open.push((joint.child, child, own, depth + 1));
                    }
                    other => {
                        let error = Error::invalid("a joint that is no hinge")
                            .found(format!("{other} `{}`", joint.name))
                            .allowed("revolute, continuous, fixed");
                        return Err(place.at(joint.node, error));
                    }
                }
            }
        }
        Ok(())
    }

    /// Gives modules and hinges names that they can have here.
    fn rename(&mut self) {
        let modules = self.bodies.iter_mut().map(|body| &mut body.name);
        let mut changed = usable(modules);
        changed.extend(usable(self.hinges.iter_mut().map(|hinge| &mut hinge.name)));
        let changed = changed.into_iter();
        self.left_out
            .extend(changed.map(|(old, new)| format!("the name `{old}`: here it is `{new}`")));
    }

    fn hinge(
        &mut self,
        place: &Place<'_>,
        joint: &Joint<'_, '_>,
        parent: usize,
        child_body: usize,
        frame: &Isometry3<f64>,
    ) -> Result<Hinge> {
        let axis = match child(joint.node, "axis") {
            Some(axis) => place.vector(axis, "xyz")?,
            None => Vector3::x(),
        };
        let (mut viscous_nm_s_rad, mut dry_nm) = (0.0, 0.0);
        if let Some(dynamics) = child(joint.node, "dynamics") {
            viscous_nm_s_rad = place.number(dynamics, "damping")?.unwrap_or(0.0);
            dry_nm = place.number(dynamics, "friction")?.unwrap_or(0.0);
        }
        let mut limits_rad = None;
        if let Some(limit) = child(joint.node, "limit") {
            if joint.kind == "revolute" {
                let lower = place.number(limit, "lower")?.unwrap_or(0.0);
                limits_rad = Some([lower, place.number(limit, "upper")?.unwrap_or(0.0)]);
            }
            if place.number(limit, "effort")?.unwrap_or(0.0) > 0.0 {
                self.left_out.push(format!(
                    "the servo of joint `{}`: URDF says its limits, not its law or gait; add `servo` and `gait` to the hinge",
                    joint.name
                ));
            }
        }
        if child(joint.node, "mimic").is_some() {
            self.left_out
                .push(format!("that joint `{}` mimics another", joint.name));
        }
        Ok(Hinge {
            name: joint.name.to_owned(),
            parent,
            child: child_body,
            at_m: frame.translation.vector,
            axis: frame.rotation * axis,
            limits_rad,
            viscous_nm_s_rad,
            dry_nm,
        })
    }

    /// The robot as people write it.
    fn ron(&self, name: &str, source: &Source) -> Result<String> {
        let file = source.path().file_name().unwrap_or_default();
        let mut text = String::new();
        // Writing into a text does not fail.
        let _ = writeln!(
            text,
            "// Read from {}.",
            file.display().to_string().escape_debug()
        );
        for left_out in &self.left_out {
            let plain: String = left_out.chars().filter(|c| !c.is_control()).collect();
            let _ = writeln!(text, "// Left out or changed: {plain}.");
        }
        let _ = writeln!(text, "(\n    name: {name:?},\n    modules: [");
        for body in &self.bodies {
            if body.blocks.is_empty() || body.mass_kg <= 0.0 {
                return Err(Error::invalid("a link that moves has a box and a mass")
                    .at_file(source.path())
                    .found(format!("link `{}`", body.name))
                    .hint("add them, or fix the link to another"));
            }
            let bounds = body.bounds();
            let _ = write!(
                text,
                "        (name: {:?}, kind: Passive(sides_m: {}, mass_kg: {:?}",
                body.name,
                triple(&bounds.sides_m),
                body.mass_kg
            );
            if body.blocks.len() > 1 {
                let boxes: Vec<String> = body
                    .blocks
                    .iter()
                    .map(|block| {
                        let centre_m = block.centre_m - bounds.centre_m;
                        format!(
                            "(sides_m: {}, centre_m: {})",
                            triple(&block.sides_m),
                            triple(&centre_m)
                        )
                    })
                    .collect();
                let _ = write!(text, ", boxes: [{}]", boxes.join(", "));
            }
            let centre_m = body.moment_kg_m / body.mass_kg - bounds.centre_m;
            let _ = write!(text, ", centre_of_mass_m: {}", triple(&centre_m));
            if let Some([x, y, z]) = body.moments_kg_m2() {
                let _ = write!(text, ", inertia_kg_m2: ({x:?}, {y:?}, {z:?})");
            }
            text.push_str(")),\n");
        }
        text.push_str("    ],\n");
        if !self.hinges.is_empty() {
            text.push_str("    hinges: [\n");
            for hinge in &self.hinges {
                let parent_centre_m = self.bodies[hinge.parent].bounds().centre_m;
                let child_centre_m = self.bodies[hinge.child].bounds().centre_m;
                let _ = write!(
                    text,
                    "        (name: {:?}, parent: {:?}, child: {:?}, anchor_m: {}, child_anchor_m: {}, axis: {}",
                    hinge.name,
                    self.bodies[hinge.parent].name,
                    self.bodies[hinge.child].name,
                    triple(&(hinge.at_m - parent_centre_m)),
                    triple(&-child_centre_m),
                    triple(&hinge.axis)
                );
                if hinge.viscous_nm_s_rad > 0.0 {
                    let _ = write!(text, ", viscous_nm_s_rad: {:?}", hinge.viscous_nm_s_rad);
                }
                if hinge.dry_nm > 0.0 {
                    let _ = write!(text, ", dry_nm: {:?}", hinge.dry_nm);
                }
                if let Some([low, high]) = hinge.limits_rad {
                    let _ = write!(text, ", limits_rad: ({low:?}, {high:?})");
                }
                text.push_str("),\n");
            }
            text.push_str("    ],\n");
        }
        if let Some(mount_m) = &self.mount_m {
            let centre_m = self.bodies[0].bounds().centre_m;
            let _ = writeln!(text, "    mount_m: {},", triple(&(mount_m + centre_m)));
        }
        text.push_str(")\n");
        Ok(text)
    }
}

/// Turns names into letters, digits, `_` and `-`, each another one; old and new of those that changed.
fn usable<'a>(names: impl Iterator<Item = &'a mut String>) -> Vec<(String, String)> {
    let mut taken = BTreeSet::new();
    let mut changed = Vec::new();
    for name in names {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let clean: String = name
            .chars()
            .take(Module::MAX_NAME - 4)
            .map(|c| if plain(c) { c } else { '_' })
            .collect();
        let clean = match clean.strip_prefix('-') {
            Some(rest) => format!("_{rest}"),
            None if clean.is_empty() => "_".to_owned(),
            None => clean,
        };
        let mut new = clean.clone();
        let mut number = 1;
        while !taken.insert(new.clone()) {
            number += 1;
            new = format!("{clean}_{number}");
        }
        if *name != new {
            changed.push((std::mem::replace(name, new.clone()), new));
        }
    }
    changed
}

/// A vector as RON, without the noise of turning it there and back.
fn triple(vector: &Vector3<f64>) -> String {
    let clean = |x: f64| {
        let rounded = (x * 1e12).round() / 1e12;
        if rounded == 0.0 { 0.0 } else { rounded }
    };
    format!(
        "({:?}, {:?}, {:?})",
        clean(vector.x),
        clean(vector.y),
        clean(vector.z)
    )
}
