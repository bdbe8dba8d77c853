//! Checks that bodies and joints form a tree: one root, and one joint above every other body.

use std::collections::HashMap;

use super::super::flaw::{Checked, Flaw};
use super::Structure;
use realgap_core::Error;
use realgap_core::file::unknown_name;

/// The tree of bodies.
pub(super) struct Tree {
    /// All bodies, parents before children.
    pub order: Vec<usize>,
    /// For each body the joint that connects it to its parent; `None` for the root.
    pub up: Vec<Option<usize>>,
    /// Parent and child of every joint.
    pub ends: Vec<(usize, usize)>,
}

impl Structure {
    pub(super) fn tree(&self, bodies: &HashMap<&str, usize>) -> Checked<Tree> {
        let mut up: Vec<Option<usize>> = vec![None; self.bodies.len()];
        let mut down: Vec<Vec<usize>> = vec![Vec::new(); self.bodies.len()];
        let mut ends = Vec::with_capacity(self.joints.len());
        for (index, joint) in self.joints.iter().enumerate() {
            let at = |field: &str| format!("joints[{index}].{field}");
            let parent = look_up(&joint.parent, bodies, "body", at("parent"))?;
            let child = look_up(&joint.child, bodies, "body", at("child"))?;
            if let Some(earlier) = up[child].replace(index) {
                return Err(Flaw::new(
                    at("child"),
                    Error::invalid(format!(
                        "`{}` is the child of two joints: the bodies do not form a tree",
                        joint.child
                    ))
                    .found(format!(
                        "`{}` and `{}`",
                        self.joints[earlier].name, joint.name
                    ))
                    .allowed("every body is the child of at most one joint")
                    .hint("closed loops are not supported: remove one of the two joints"),
                ));
            }
            down[parent].push(child);
            ends.push((parent, child));
        }
        let roots: Vec<usize> = (0..up.len()).filter(|&body| up[body].is_none()).collect();
        let [root] = roots.as_slice() else {
            let names = roots
                .iter()
                .take(8)
                .map(|&root| format!("`{}`", self.bodies[root].name));
            let names: Vec<String> = names.collect();
            return Err(Flaw::new(
                roots.get(1).map_or_else(
                    || "joints".to_owned(),
                    |root| format!("bodies[{root}].name"),
                ),
                Error::invalid("a robot needs exactly one root: a body that is not a child")
                    .found(format!("{}: {}", roots.len(), names.join(", ")))
                    .hint("connect the other bodies to it by joints, or remove them"),
            ));
        };
        let mut order = vec![*root];
        let mut next = 0;
        while let Some(&body) = order.get(next) {
            order.extend(&down[body]);
            next += 1;
        }
        if order.len() < self.bodies.len() {
            let lost = (0..self.bodies.len()).find(|body| !order.contains(body));
            let joint = lost.and_then(|body| up[body]).unwrap_or(0);
            return Err(Flaw::new(
                format!("joints[{joint}]"),
                Error::invalid("the joints form a cycle")
                    .found(format!("`{}`", self.joints[joint].name))
                    .allowed("a tree: one root, and every other body a child of one parent"),
            ));
        }
        Ok(Tree { order, up, ends })
    }
}

pub(super) fn by_name<'a>(
    names: impl Iterator<Item = &'a String>,
    list: &str,
) -> Checked<HashMap<&'a str, usize>> {
    let mut known = HashMap::new();
    for (index, name) in names.enumerate() {
        if let Some(first) = known.insert(name.as_str(), index) {
            return Err(Flaw::new(
                format!("{list}[{index}].name"),
                Error::invalid("the same name is used twice")
                    .found(format!("`{name}` is also {list}[{first}]")),
            ));
        }
    }
    Ok(known)
}

pub(super) fn look_up(
    name: &str,
    known: &HashMap<&str, usize>,
    what: &str,
    at: String,
) -> Checked<usize> {
    known.get(name).copied().ok_or_else(|| {
        let mut names: Vec<&str> = known.keys().copied().collect();
        names.sort_unstable();
        Flaw::new(at, unknown_name(what, name, names))
    })
}
