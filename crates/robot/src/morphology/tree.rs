//! Do glue and hinges make one tree?

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::attachment::Attachment;
use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::module::{DriveAxis, Module};
use super::pivot::Pivot;
use realgap_core::Error;

/// What joins two modules, by its place in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    /// Index of the glue.
    Attachment(usize),
    /// Index of the stated hinge.
    Pivot(usize),
}

impl Edge {
    /// Path in the file.
    pub(super) fn path(self) -> String {
        match self {
            Self::Attachment(index) => format!("glue[{index}]"),
            Self::Pivot(index) => format!("hinges[{index}]"),
        }
    }
}

/// Everything that joins modules.
#[derive(Debug, Clone, Copy)]
pub(super) struct Links<'a> {
    pub(super) attachments: &'a [Attachment],
    pub(super) pivots: &'a [Pivot],
}

impl Links<'_> {
    /// Parent and child.
    fn ends(&self, edge: Edge) -> (usize, usize) {
        match edge {
            Edge::Attachment(index) => (
                self.attachments[index].parent,
                self.attachments[index].child,
            ),
            Edge::Pivot(index) => (self.pivots[index].parent, self.pivots[index].child),
        }
    }

    fn edges(&self) -> impl Iterator<Item = Edge> {
        let attachments = (0..self.attachments.len()).map(Edge::Attachment);
        attachments.chain((0..self.pivots.len()).map(Edge::Pivot))
    }
}

/// How the modules hang together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tree {
    /// The module that is nobody's child.
    pub(super) root: usize,
    /// Every module once, parents before children, level by level, siblings in the order of the glue, then of the hinges.
    pub(super) order: Vec<usize>,
    /// Per module what makes it a child.
    pub(super) parent: Vec<Option<Edge>>,
    /// Per module what gives it children.
    pub(super) children: Vec<Vec<Edge>>,
}

impl Tree {
    /// That of no modules.
    pub(super) const fn nothing() -> Self {
        Self {
            root: 0,
            order: Vec::new(),
            parent: Vec::new(),
            children: Vec::new(),
        }
    }

    pub(super) fn grow(modules: &[Module], links: Links<'_>) -> Checked<Self> {
        let name = |index: usize| modules[index].name.as_str();
        let mut parent: Vec<Option<Edge>> = vec![None; modules.len()];
        let mut children: Vec<Vec<Edge>> = vec![Vec::new(); modules.len()];
        for edge in links.edges() {
            check_indices(edge, links, modules)?;
            let (onto, child) = links.ends(edge);
            if let Some(earlier) = parent[child].replace(edge) {
                return Err(Flaw::new(
                    format!("{}.child", edge.path()),
                    Error::invalid(format!("`{}` is glued twice as a child", name(child)))
                        .found(format!(
                            "onto `{}` and onto `{}`",
                            name(links.ends(earlier).0),
                            name(onto)
                        ))
                        .allowed("every module is a child at most once")
                        .hint("the robot is a tree: remove one of the two; modules that touch need no glue"),
                ));
            }
            children[onto].push(edge);
        }
        let root = find_root(modules, links, &parent)?;
        let mut order = vec![root];
        let mut next = 0;
        while let Some(&module) = order.get(next) {
            order.extend(children[module].iter().map(|&edge| links.ends(edge).1));
            next += 1;
        }
        // With one root and one parent for everyone else, whoever was not reached hangs on a cycle.
        if let Some(lost) = (0..modules.len()).find(|module| !order.contains(module)) {
            return Err(cycle(lost, modules, links, &parent));
        }
        check_faces(modules, links.attachments)?;
        check_drives(modules, links.attachments)?;
        Ok(Self {
            root,
            order,
            parent,
            children,
        })
    }
}

fn check_indices(edge: Edge, links: Links<'_>, modules: &[Module]) -> Checked<()> {
    let (parent, child) = links.ends(edge);
    for (field, module) in [("parent", parent), ("child", child)] {
        if module >= modules.len() {
            return Err(Flaw::new(
                format!("{}.{field}", edge.path()),
                Error::invalid("there is no such module")
                    .found(format!("module number {module}"))
                    .allowed(format!("0 to {}", modules.len() - 1)),
            ));
        }
    }
    if parent == child {
        return Err(Flaw::new(
            format!("{}.child", edge.path()),
            Error::invalid(format!("`{}` is glued onto itself", modules[child].name)),
        ));
    }
    if let Edge::Attachment(index) = edge
        && links.attachments[index].quarter_turns > 3
    {
        let turns = links.attachments[index].quarter_turns;
        return Err(quarter_turns_flaw(index, turns.into()));
    }
    Ok(())
}

pub(super) fn quarter_turns_flaw(index: usize, found: i64) -> Flaw {
    Flaw::new(
        format!("glue[{index}].quarter_turns"),
        Error::invalid("out of range")
            .found(found)
            .allowed("0, 1, 2, 3"),
    )
}

fn find_root(modules: &[Module], links: Links<'_>, parent: &[Option<Edge>]) -> Checked<usize> {
    let roots: Vec<usize> = (0..modules.len())
        .filter(|&module| parent[module].is_none())
        .collect();
    match roots.as_slice() {
        [] => Err(cycle(0, modules, links, parent)),
        [root] => Ok(*root),
        [_, second, ..] => {
            let mut names: Vec<String> = roots
                .iter()
                .take(8)
                .map(|&root| format!("`{}`", modules[root].name))
                .collect();
            if roots.len() > names.len() {
                names.push(format!("and {} more", roots.len() - names.len()));
            }
            Err(Flaw::new(
                format!("modules[{second}].name"),
                Error::invalid("the modules are not all glued together")
                    .found(format!(
                        "{} modules that are nobody's child: {}",
                        roots.len(),
                        names.join(", ")
                    ))
                    .allowed("exactly one, the root")
                    .hint(format!(
                        "glue `{}` onto a neighbour, or remove it",
                        modules[*second].name
                    )),
            ))
        }
    }
}

/// Climbs from a module that the root does not reach until a module comes up again.
fn cycle(start: usize, modules: &[Module], links: Links<'_>, parent: &[Option<Edge>]) -> Flaw {
    let mut climbed = vec![start];
    let mut last = Edge::Attachment(0);
    let mut module = start;
    while let Some(edge) = parent[module] {
        last = edge;
        module = links.ends(edge).0;
        if let Some(first) = climbed.iter().position(|&m| m == module) {
            climbed.drain(..first);
            break;
        }
        climbed.push(module);
    }
    climbed.push(module);
    let names: Vec<String> = climbed
        .iter()
        .rev()
        .map(|&m| format!("`{}`", modules[m].name))
        .collect();
    Flaw::new(
        last.path(),
        Error::invalid("the glue runs in a circle")
            .found(names.join(" > "))
            .allowed("a tree: one root, and every other module a child of one parent")
            .hint("remove one glue of the circle; modules that touch need no glue"),
    )
}

fn check_faces(modules: &[Module], attachments: &[Attachment]) -> Checked<()> {
    let mut taken: HashMap<(usize, Face), usize> = HashMap::new();
    for (index, joint) in attachments.iter().enumerate() {
        for (field, module, face, other) in [
            ("face", joint.parent, joint.face, joint.child),
            ("child_face", joint.child, joint.child_face, joint.parent),
        ] {
            match taken.entry((module, face)) {
                Entry::Vacant(free) => {
                    free.insert(other);
                }
                Entry::Occupied(neighbour) => {
                    return Err(Flaw::new(
                        format!("glue[{index}].{field}"),
                        Error::invalid(format!(
                            "two modules on face {} of `{}`",
                            face.name(),
                            modules[module].name
                        ))
                        .found(format!(
                            "`{}` and `{}`",
                            modules[*neighbour.get()].name,
                            modules[other].name
                        ))
                        .allowed("one module on a face"),
                    ));
                }
            }
        }
    }
    Ok(())
}

/// Every servo must move something, and each by itself.
fn check_drives(modules: &[Module], attachments: &[Attachment]) -> Checked<()> {
    for (index, joint) in attachments.iter().enumerate() {
        if modules[joint.parent].driven_face() == Some(joint.face)
            && modules[joint.child].driven_face() == Some(joint.child_face)
        {
            return Err(Flaw::new(
                format!("glue[{index}]"),
                Error::invalid("two driven faces are glued onto each other")
                    .found(format!(
                        "face {} of `{}` on face {} of `{}`",
                        joint.child_face.name(),
                        modules[joint.child].name,
                        joint.face.name(),
                        modules[joint.parent].name
                    ))
                    .hint(
                        "two servos would drive one glue joint: put a passive module between them",
                    ),
            ));
        }
    }
    for (index, module) in modules.iter().enumerate() {
        let Some(drive) = module.drive else { continue };
        if module.plate().is_some() || is_glued(attachments, index, drive.face) {
            continue;
        }
        let hint = match drive.axis {
            DriveAxis::Normal { .. } => {
                "give it a plate, glue a module onto that face, or make it Passive"
            }
            DriveAxis::Tangent { .. } => "glue a module onto that face, or make it Passive",
        };
        return Err(Flaw::new(
            format!("modules[{index}].kind.axis"),
            Error::invalid(format!("the servo of `{}` moves nothing", module.name))
                .found(format!("nothing on its driven face {}", drive.face.name()))
                .hint(hint),
        ));
    }
    Ok(())
}

/// True if another module sits on this face.
pub(super) fn is_glued(attachments: &[Attachment], module: usize, face: Face) -> bool {
    attachments.iter().any(|joint| {
        (joint.parent, joint.face) == (module, face)
            || (joint.child, joint.child_face) == (module, face)
    })
}
