//! Copies of elements: `<replicate>` and `<attach>` become frames with renamed contents.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3};

use super::element::{Element, FileReader, MOST_ELEMENTS};
use super::model::Origin;
use realgap_core::error::{Error, Result};

/// Attributes that name or refer to elements of the tree of bodies.
const NAMES: [&str; 16] = [
    "name",
    "joint",
    "jointinparent",
    "body",
    "site",
    "tendon",
    "body1",
    "body2",
    "joint1",
    "joint2",
    "geom1",
    "geom2",
    "site1",
    "site2",
    "refsite",
    "target",
];

/// Replaces `<replicate>` and `<attach>` in a model.
pub(super) struct Copier<'a> {
    pub origins: &'a mut Vec<Origin>,
    /// The names inside each `<replicate>`, and the endings that its copies have.
    pub families: Vec<(BTreeSet<String>, Vec<String>)>,
    /// Sections (actuators, excludes) that attached bodies bring with them.
    pub brought: Vec<Element>,
    elements: usize,
}

impl<'a> Copier<'a> {
    pub fn new(origins: &'a mut Vec<Origin>) -> Self {
        Self {
            origins,
            families: Vec::new(),
            brought: Vec::new(),
            elements: 0,
        }
    }

    /// Expands an element of the tree of bodies and everything in it.
    pub fn expand(&mut self, element: &mut Element) -> Result<()> {
        let children = std::mem::take(&mut element.children);
        for mut child in children {
            self.elements += 1;
            if self.elements > MOST_ELEMENTS {
                let error = Error::invalid("too many elements");
                return Err(child.error(error.allowed(format!("{MOST_ELEMENTS}, with all copies"))));
            }
            match child.tag.as_str() {
                "replicate" => {
                    self.expand(&mut child)?;
                    let copies = self.replicate(&child)?;
                    element.children.extend(copies);
                }
                "attach" => {
                    let attached = self.attach(&child)?;
                    element.children.push(attached);
                }
                _ => {
                    self.expand(&mut child)?;
                    element.children.push(child);
                }
            }
        }
        Ok(())
    }

    fn replicate(&mut self, given: &Element) -> Result<Vec<Element>> {
        let count = given.number("count", 1.0)?;
        let inside = given.count();
        if !(1.0..=1e6).contains(&count) || count * inside as f64 > MOST_ELEMENTS as f64 {
            let error = Error::invalid("not a number of copies").found(count);
            return Err(given.error(error.allowed(format!("1 to {MOST_ELEMENTS} elements"))));
        }
        let settings = &self.origins[given.origin].settings;
        let turn = settings.of_euler(&given.numbers::<3>("euler")?.unwrap_or_default());
        let step = Isometry3::from_parts(Translation3::from(given.vector("offset")?), turn);
        let separator = given.get("sep").unwrap_or_default();
        let count = count as usize;
        let digits = (count - 1).max(1).to_string().len();
        let mut at = Isometry3::identity();
        let mut names = BTreeSet::new();
        given
            .children
            .iter()
            .for_each(|child| collect(child, &mut names));
        let mut frames = Vec::with_capacity(count);
        let mut endings = Vec::with_capacity(count);
        for index in 0..count {
            let ending = format!("{separator}{index:0digits$}");
            let mut frame = frame_at(given, &at);
            frame.children.clone_from(&given.children);
            for child in &mut frame.children {
                rename(child, &|name| {
                    names.contains(name).then(|| format!("{name}{ending}"))
                });
            }
            frames.push(frame);
            endings.push(ending);
            at *= step;
        }
        self.elements += count * inside;
        self.families.push((names, endings));
        Ok(frames)
    }

    fn attach(&mut self, given: &Element) -> Result<Element> {
        let model = given.get("model").unwrap_or_default();
        let stated = self.origins[given.origin].models.get(model).cloned();
        let Some(path) = stated else {
            let error = Error::invalid("the model to attach is not among the assets").found(model);
            return Err(given.error(error));
        };
        if self.origins.len() > 100 {
            return Err(given.error(Error::invalid("more than 100 models are attached")));
        }
        let folder = path.parent().unwrap_or(std::path::Path::new("")).to_owned();
        let mut reader = FileReader::new(&folder, self.origins.len());
        let text = reader.text(&path).map_err(|error| given.error(error))?;
        let mut root = reader.root(&text, &path)?;
        self.origins.push(Origin::of(&root, &folder)?);
        let prefix = given.get("prefix").unwrap_or_default().to_owned();
        let mut world = Element::default();
        for section in root.named("worldbody") {
            world.children.extend(section.children.iter().cloned());
        }
        self.expand(&mut world)?;
        let mut frame = frame_at(given, &Isometry3::identity());
        match given.get("body") {
            None => frame.children = world.children,
            Some(name) => {
                let Some(body) = find(&world, name) else {
                    let error =
                        Error::invalid("the body to attach is not in the model").found(name);
                    return Err(given.error(error));
                };
                frame.children.push(body.clone());
            }
        }
        let mut names = BTreeSet::new();
        frame
            .children
            .iter()
            .for_each(|child| collect(child, &mut names));
        for child in &mut frame.children {
            rename(child, &|name| Some(format!("{prefix}{name}")));
        }
        for section in &mut root.children {
            if !["actuator", "contact", "equality", "tendon"].contains(&section.tag.as_str()) {
                continue;
            }
            section.children.retain(|child| {
                let mut refers = NAMES[1..].iter().filter_map(|name| child.get(name));
                child.tag == "fixed" || refers.all(|name| names.contains(name))
            });
            for child in &mut section.children {
                rename(child, &|name| Some(format!("{prefix}{name}")));
            }
            self.brought.push(section.clone());
        }
        Ok(frame)
    }

    /// The copies of an element outside the tree of bodies that refers to elements which were replicated.
    pub fn copies(families: &[(BTreeSet<String>, Vec<String>)], element: &Element) -> Vec<Element> {
        let mut all = vec![element.clone()];
        for (names, endings) in families {
            let mut next = Vec::new();
            for one in all {
                let refers = NAMES[1..].iter().filter_map(|name| one.get(name));
                if !refers.into_iter().any(|name| names.contains(name)) {
                    next.push(one);
                    continue;
                }
                next.extend(endings.iter().map(|ending| {
                    let mut copy = one.clone();
                    let own = copy
                        .attributes
                        .get("name")
                        .map(|name| format!("{name}{ending}"));
                    rename(&mut copy, &|name| {
                        names.contains(name).then(|| format!("{name}{ending}"))
                    });
                    if let Some(own) = own {
                        copy.attributes.insert("name".to_owned(), own);
                    }
                    copy
                }));
            }
            all = next;
        }
        all
    }
}

/// A frame at a pose, in place of another element.
fn frame_at(given: &Element, at: &Isometry3<f64>) -> Element {
    let (t, q) = (at.translation.vector, at.rotation);
    let text = |numbers: &[f64]| {
        let each = numbers.iter().map(f64::to_string);
        each.collect::<Vec<_>>().join(" ")
    };
    Element {
        tag: "frame".to_owned(),
        attributes: BTreeMap::from([
            ("pos".to_owned(), text(&[t.x, t.y, t.z])),
            ("quat".to_owned(), text(&[q.w, q.i, q.j, q.k])),
        ]),
        children: Vec::new(),
        file: given.file.clone(),
        ..*given
    }
}

fn find<'a>(element: &'a Element, name: &str) -> Option<&'a Element> {
    element.children.iter().find_map(|child| {
        match child.tag == "body" && child.get("name") == Some(name) {
            true => Some(child),
            false => find(child, name),
        }
    })
}

/// Collects the names of an element and of everything in it.
fn collect(element: &Element, names: &mut BTreeSet<String>) {
    names.extend(element.get("name").map(str::to_owned));
    element
        .children
        .iter()
        .for_each(|child| collect(child, names));
}

/// Renames an element, everything in it and what they refer to.
fn rename(element: &mut Element, to: &dyn Fn(&str) -> Option<String>) {
    for (attribute, value) in &mut element.attributes {
        if NAMES.contains(&attribute.as_str())
            && let Some(new) = to(value)
        {
            *value = new;
        }
    }
    for child in &mut element.children {
        rename(child, to);
    }
}
