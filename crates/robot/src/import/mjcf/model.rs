//! The bodies of an MJCF with all defaults, frames and copies resolved.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::copies::Copier;
use super::defaults::Defaults;
use super::element::{Element, FileReader};
use super::settings::{Settings, turn_of_z};
use realgap_core::error::{Error, Result};

/// A file with its settings, defaults and assets: the main model, or one that it attaches.
pub(super) struct Origin {
    pub settings: Settings,
    pub defaults: Defaults,
    pub folder: PathBuf,
    pub meshes: BTreeMap<String, Element>,
    pub models: BTreeMap<String, PathBuf>,
}

impl Origin {
    pub fn of(root: &Element, folder: &Path) -> Result<Self> {
        let defaults = Defaults::of(root);
        let (mut meshes, mut models) = (BTreeMap::new(), BTreeMap::new());
        let assets = root.named("asset").flat_map(|section| &section.children);
        for asset in assets {
            let file = asset.get("file").unwrap_or_default();
            let stem = Path::new(file).file_stem().unwrap_or_default();
            let stem = stem.to_string_lossy().into_owned();
            let name = asset.get("name").map_or(stem, str::to_owned);
            match asset.tag.as_str() {
                "mesh" => drop(meshes.insert(name, defaults.resolved(asset, None))),
                "model" => drop(models.insert(name, folder.join(file))),
                _ => {}
            }
        }
        Ok(Self {
            settings: Settings::of(root)?,
            defaults,
            folder: folder.to_owned(),
            meshes,
            models,
        })
    }
}

/// The place of an element: its file, and its first byte there.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Place {
    pub file: Rc<PathBuf>,
    pub at: usize,
}

impl Place {
    pub fn of(element: &Element) -> Self {
        Self {
            file: Rc::clone(&element.file),
            at: element.at,
        }
    }
}

/// The kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum JointType {
    Hinge,
    Slide,
    Ball,
    Free,
}

/// A joint of a body, in the body's frame, in metres and radians.
pub(super) struct Joint {
    pub name: Option<String>,
    pub place: Place,
    pub kind: JointType,
    pub pos_m: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub range: Option<[f64; 2]>,
    pub stiffness: f64,
    pub damping: f64,
    pub rest: f64,
    pub reference: f64,
    pub spring_damper: Option<[f64; 2]>,
    pub armature: f64,
    pub dry: f64,
    pub force_range: Option<[f64; 2]>,
    /// Properties that have no counterpart here.
    pub unknown: Vec<&'static str>,
}

/// The kind of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GeomType {
    Plane,
    Sphere,
    Capsule,
    Ellipsoid,
    Cylinder,
    Box,
    Mesh,
    Other,
}

/// MuJoCo's friction of a shape that states none.
const FRICTION: [f64; 3] = [1.0, 0.005, 0.0001];

/// A shape of a body.
pub(super) struct Geom {
    pub kind: GeomType,
    pub size: Vector3<f64>,
    pub pose: Isometry3<f64>,
    pub mass_kg: Option<f64>,
    pub density: f64,
    pub is_shell: bool,
    pub group: f64,
    pub contype: u32,
    pub conaffinity: u32,
    /// Sliding friction, and torsional and rolling friction in metres.
    pub friction: [f64; 3],
    /// Dimension of its contacts: with 1 they have no friction, from 4 on torsional friction, with 6 rolling friction, too.
    pub condim: u32,
    /// Of two shapes the one with the higher priority decides.
    pub priority: i32,
    pub mesh: Option<String>,
    pub fit_scale: f64,
    pub element: Element,
}

impl Geom {
    /// Whether the shape can touch anything.
    pub fn touches(&self) -> bool {
        self.contype != 0 || self.conaffinity != 0
    }
}

/// A body; body 0 is the world.
#[derive(Default)]
pub(super) struct Body {
    pub name: Option<String>,
    pub place: Place,
    pub parent: usize,
    pub pose: Isometry3<f64>,
    pub gravity_compensation: f64,
    /// Whether other programs move it.
    pub is_mocap: bool,
    pub inertial: Option<(Element, Isometry3<f64>)>,
    pub joints: Vec<Joint>,
    pub geoms: Vec<Geom>,
    pub sites: Vec<(Option<String>, Isometry3<f64>)>,
}

/// A model with everything resolved.
pub(super) struct Model {
    pub name: Option<String>,
    pub origins: Vec<Origin>,
    pub bodies: Vec<Body>,
    /// The sections of the file, without the tree of bodies, with the copies that `<replicate>` makes.
    pub sections: Vec<Element>,
    /// Elements of the tree of bodies that have no counterpart here, and their number.
    pub unknown: BTreeMap<String, usize>,
    /// Names of classes that are used and not defined.
    pub classes: BTreeSet<String>,
}

impl Model {
    /// Reads a model and all its files.
    pub fn read(text: &str, path: &Path) -> Result<Self> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut root = FileReader::new(folder, 0).root(text, path)?;
        let mut origins = vec![Origin::of(&root, folder)?];
        let mut world = Element::default();
        for section in root.named("worldbody") {
            world.file = section.file.clone();
            world.children.extend(section.children.iter().cloned());
        }
        let mut copier = Copier::new(&mut origins);
        copier.expand(&mut world)?;
        let (families, brought) = (copier.families, copier.brought);
        root.children.retain(|section| section.tag != "worldbody");
        root.children.extend(brought);
        for section in &mut root.children {
            let children = std::mem::take(&mut section.children);
            let copies = children
                .iter()
                .flat_map(|child| Copier::copies(&families, child));
            section.children = copies.collect();
        }
        let mut model = Self {
            name: root.get("model").map(str::to_owned),
            origins,
            bodies: vec![Body::default()],
            sections: root.children,
            unknown: BTreeMap::new(),
            classes: BTreeSet::new(),
        };
        model.contents(&world, 0, None, &Isometry3::identity())?;
        Ok(model)
    }

    /// The elements in all sections of a name.
    pub fn section<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        let sections = self
            .sections
            .iter()
            .filter(move |section| section.tag == tag);
        sections.flat_map(|section| &section.children)
    }

    /// Adds the contents of a body, or of a frame in it.
    fn contents(
        &mut self,
        element: &Element,
        id: usize,
        class: Option<&str>,
        frame: &Isometry3<f64>,
    ) -> Result<()> {
        for child in &element.children {
            let stated = child.get("class").or(child.get("childclass"));
            let origin = &self.origins[child.origin];
            self.classes.extend(
                stated
                    .filter(|class| !origin.defaults.knows(class))
                    .map(str::to_owned),
            );
            let whole = || origin.defaults.resolved(child, class);
            match child.tag.as_str() {
                "body" => {
                    let pose = frame * origin.settings.pose(child)?;
                    let body = Body {
                        name: child.get("name").map(str::to_owned),
                        place: Place::of(child),
                        parent: id,
                        pose,
                        gravity_compensation: child.number("gravcomp", 0.0)?,
                        is_mocap: child.truth("mocap") == Some(true),
                        ..Body::default()
                    };
                    self.bodies.push(body);
                    let own = child.get("childclass").or(class);
                    self.contents(child, self.bodies.len() - 1, own, &Isometry3::identity())?;
                }
                "frame" => {
                    let pose = frame * origin.settings.pose(child)?;
                    let own = child.get("childclass").or(class);
                    self.contents(child, id, own, &pose)?;
                }
                "inertial" => {
                    let pose = frame * origin.settings.pose(child)?;
                    self.bodies[id].inertial = Some((child.clone(), pose));
                }
                "joint" | "freejoint" => {
                    let whole = match child.tag.as_str() {
                        "joint" => whole(),
                        _ => child.clone(),
                    };
                    let joint = joint(&whole, &origin.settings, frame)?;
                    self.bodies[id].joints.push(joint);
                }
                "geom" => {
                    let geom = geom(whole(), &origin.settings, frame)?;
                    self.bodies[id].geoms.push(geom);
                }
                "site" => {
                    let whole = whole();
                    let pose = match whole.numbers::<6>("fromto")? {
                        Some(ends) => between(&ends).0,
                        None => origin.settings.pose(&whole)?,
                    };
                    let name = child.get("name").map(str::to_owned);
                    self.bodies[id].sites.push((name, frame * pose));
                }
                other => *self.unknown.entry(other.to_owned()).or_default() += 1,
            }
        }
        Ok(())
    }
}

fn joint(given: &Element, settings: &Settings, frame: &Isometry3<f64>) -> Result<Joint> {
    let kind = match (given.tag.as_str(), given.get("type")) {
        ("freejoint", _) | (_, Some("free")) => JointType::Free,
        (_, None | Some("hinge")) => JointType::Hinge,
        (_, Some("slide")) => JointType::Slide,
        (_, Some("ball")) => JointType::Ball,
        (_, Some(other)) => {
            let error = Error::invalid("unknown type of joint").found(other);
            return Err(given.error(error.allowed("hinge, slide, ball, free")));
        }
    };
    let angle = |value: f64| match kind {
        JointType::Hinge | JointType::Ball => settings.angle_rad(value),
        JointType::Slide | JointType::Free => value,
    };
    let axis = given
        .numbers::<3>("axis")?
        .map_or(Vector3::z(), Vector3::from);
    let Some(axis) = axis.try_normalize(1e-14) else {
        return Err(given.error(Error::invalid("the axis of a joint has no direction")));
    };
    let range = given.numbers::<2>("range")?;
    let force_range = given.numbers::<2>("actuatorfrcrange")?;
    let mut unknown = Vec::new();
    let has_more = |name: &str| -> Result<bool> {
        Ok(given.list(name)?.iter().skip(1).any(|more| *more != 0.0))
    };
    if has_more("stiffness")? || has_more("damping")? {
        unknown.push("stiffness or damping that grows with the coordinate (polynomial)");
    }
    if given.number("springyield", 0.0)? > 0.0 {
        unknown.push("yielding of the spring (springyield)");
    }
    if given.truth("actuatorgravcomp") == Some(true) {
        unknown.push("gravity compensation by the actuator (actuatorgravcomp)");
    }
    Ok(Joint {
        name: given
            .get("name")
            .filter(|name| !name.is_empty())
            .map(str::to_owned),
        place: Place::of(given),
        kind,
        pos_m: (frame * nalgebra::Point3::from(given.vector("pos")?)).coords,
        axis: frame.rotation * axis,
        range: range
            .filter(|range| given.is_limited("limited", Some(*range), settings.autolimits))
            .map(|range| range.map(angle)),
        stiffness: given.number("stiffness", 0.0)?,
        damping: given.number("damping", 0.0)?,
        rest: angle(given.number("springref", 0.0)?),
        reference: angle(given.number("ref", 0.0)?),
        spring_damper: given
            .numbers::<2>("springdamper")?
            .filter(|[time, ratio]| *time > 0.0 && *ratio > 0.0),
        armature: given.number("armature", 0.0)?,
        dry: given.number("frictionloss", 0.0)?,
        force_range: force_range.filter(|range| {
            given.is_limited("actuatorfrclimited", Some(*range), settings.autolimits)
        }),
        unknown,
    })
}

/// The pose of a shape between two points, and half of their distance: z points from the second to the first.
fn between(ends: &[f64; 6]) -> (Isometry3<f64>, f64) {
    let (a, b) = (
        Vector3::from_row_slice(&ends[..3]),
        Vector3::from_row_slice(&ends[3..]),
    );
    let along = a - b;
    let turn = match along.norm() > 0.0 {
        true => turn_of_z(&along),
        false => UnitQuaternion::identity(),
    };
    let middle = Translation3::from((a + b) / 2.0);
    (Isometry3::from_parts(middle, turn), 0.5 * along.norm())
}

fn geom(whole: Element, settings: &Settings, frame: &Isometry3<f64>) -> Result<Geom> {
    let mesh = whole.get("mesh").map(str::to_owned);
    let kind = match whole.get("type") {
        None | Some("sphere") => GeomType::Sphere,
        Some("plane") => GeomType::Plane,
        Some("capsule") => GeomType::Capsule,
        Some("ellipsoid") => GeomType::Ellipsoid,
        Some("cylinder") => GeomType::Cylinder,
        Some("box") => GeomType::Box,
        Some("mesh") => GeomType::Mesh,
        Some("hfield" | "sdf") => GeomType::Other,
        Some(other) => {
            let error = Error::invalid("unknown type of shape").found(other);
            return Err(whole.error(error));
        }
    };
    let list = whole.list("size")?;
    let mut size = Vector3::zeros();
    size.iter_mut()
        .zip(&list)
        .for_each(|(to, from)| *to = *from);
    let mut pose = settings.pose(&whole)?;
    if let Some(ends) = whole.numbers::<6>("fromto")? {
        let (between, half_m) = between(&ends);
        pose = between;
        size = match kind {
            GeomType::Box | GeomType::Ellipsoid => Vector3::new(size.x, size.x, half_m),
            _ => Vector3::new(size.x, half_m, 0.0),
        };
    }
    let bits = |name: &str| Ok::<_, Error>(whole.number(name, 1.0)? as u32);
    Ok(Geom {
        kind,
        size,
        pose: frame * pose,
        mass_kg: whole.list("mass")?.first().copied(),
        density: whole.number("density", 1000.0)?,
        is_shell: whole.truth("shellinertia") == Some(true),
        group: whole.number("group", 0.0)?,
        contype: bits("contype")?,
        conaffinity: bits("conaffinity")?,
        friction: friction(&whole)?,
        condim: whole.number("condim", 3.0)? as u32,
        priority: whole.number("priority", 0.0)? as i32,
        mesh,
        fit_scale: whole.number("fitscale", 1.0)?,
        element: whole,
    })
}

/// The friction of a shape; what the file leaves out is MuJoCo's default.
fn friction(whole: &Element) -> Result<[f64; 3]> {
    let mut friction = FRICTION;
    for (value, stated) in friction.iter_mut().zip(whole.list("friction")?) {
        *value = stated;
    }
    Ok(friction)
}
