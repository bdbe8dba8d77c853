//! Default classes: the attributes that elements have without stating them.

use std::collections::BTreeMap;

use super::super::element::words;
use super::element::Element;

/// Attributes of which an element may state the first numbers only; the others keep their default.
const PARTIAL: [&str; 8] = [
    "size",
    "gear",
    "friction",
    "gainprm",
    "biasprm",
    "dynprm",
    "stiffness",
    "damping",
];

/// Elements that share one default, because they are all actuators.
pub(super) const ACTUATORS: [&str; 14] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "plugin",
    "pid",
    "dcmotor",
    "orientation",
    "thruster",
];

/// The default classes of a model.
#[derive(Debug, Clone, Default)]
pub(super) struct Defaults {
    classes: BTreeMap<String, Class>,
}

#[derive(Debug, Clone, Default)]
struct Class {
    parent: Option<String>,
    elements: Vec<Element>,
}

/// The name of the class of all elements without a class.
const MAIN: &str = "main";

impl Defaults {
    /// Collects the classes of the `<default>` sections of a model.
    pub fn of(root: &Element) -> Self {
        let mut all = Self::default();
        for section in root.named("default") {
            let name = section.get("class").unwrap_or(MAIN).to_owned();
            all.add(section, &name, None);
        }
        all
    }

    fn add(&mut self, section: &Element, name: &str, parent: Option<&str>) {
        let class = self.classes.entry(name.to_owned()).or_default();
        class.parent = class.parent.take().or(parent.map(str::to_owned));
        let own = section
            .children
            .iter()
            .filter(|child| child.tag != "default");
        class.elements.extend(own.cloned());
        for inner in section.named("default") {
            if let Some(inner_name) = inner.get("class") {
                self.add(inner, inner_name, Some(name));
            }
        }
    }

    /// The names of a class and of those it inherits from, the most general first.
    fn chain(&self, class: Option<&str>) -> Vec<&Class> {
        let mut chain = Vec::new();
        let mut next = class.or(Some(MAIN)).and_then(|name| self.get(name));
        while let Some(class) = next.filter(|_| chain.len() <= self.classes.len()) {
            chain.push(class);
            next = class.parent.as_deref().and_then(|name| self.get(name));
        }
        chain.reverse();
        chain
    }

    /// A class; the outermost class of a file may have any name.
    fn get(&self, name: &str) -> Option<&Class> {
        self.classes.get(name).or_else(|| {
            let mut roots = self.classes.values().filter(|class| class.parent.is_none());
            (name == MAIN).then(|| roots.next()).flatten()
        })
    }

    /// Whether a class is known.
    pub fn knows(&self, class: &str) -> bool {
        class == MAIN || self.classes.contains_key(class)
    }

    /// The element with the attributes of its class, or else of the class of its surroundings.
    pub fn resolved(&self, element: &Element, around: Option<&str>) -> Element {
        let mut whole = Element {
            children: element.children.clone(),
            attributes: BTreeMap::new(),
            tag: element.tag.clone(),
            file: element.file.clone(),
            ..*element
        };
        for class in self.chain(element.get("class").or(around)) {
            for given in class
                .elements
                .iter()
                .filter(|given| given.tag == element.tag)
            {
                overlay(&mut whole.attributes, &given.attributes);
            }
        }
        overlay(&mut whole.attributes, &element.attributes);
        whole
    }

    /// The actuators of the class of an actuator, the most general first, and the actuator itself: each changes what those before
    /// it state.
    pub fn actuators(&self, element: &Element) -> Vec<Element> {
        let chain = self.chain(element.get("class")).into_iter();
        let given = chain.flat_map(|class| &class.elements);
        (given.filter(|given| ACTUATORS.contains(&given.tag.as_str())))
            .chain([element])
            .cloned()
            .collect()
    }
}

/// Puts attributes over others.
fn overlay(below: &mut BTreeMap<String, String>, above: &BTreeMap<String, String>) {
    for (name, value) in above {
        let value = match below.get(name) {
            Some(old) if PARTIAL.contains(&name.as_str()) => {
                let stated: Vec<&str> = words(value).collect();
                let kept = words(old).skip(stated.len());
                stated
                    .iter()
                    .copied()
                    .chain(kept)
                    .collect::<Vec<_>>()
                    .join(" ")
            }
            _ => value.clone(),
        };
        below.insert(name.clone(), value);
    }
}
