//! Checks that attachments and hinges connect all modules into one tree.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::attachment::Attachment;
use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::module::{DriveAxis, Module};
use super::pivot::Pivot;
use realgap_core::Error;

/// A connection of two modules, by its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    /// Index of an attachment.
    Attachment(usize),
    /// Index of a stated hinge.
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

/// All connections of modules.
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

/// The tree of modules.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tree {
    /// The root: the module that is not the child of another module.
    pub(super) root: usize,
    /// Every module once, parents before children, level by level, siblings in the order of the attachments, then of the hinges.
    pub(super) order: Vec<usize>,
    /// For each module the connection to its parent; `None` for the root.
    pub(super) parent: Vec<Option<Edge>>,
    /// For each module the connections to its children.
    pub(super) children: Vec<Vec<Edge>>,
}

impl Tree {
    /// A tree without modules.
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
                    Error::invalid(format!("`{}` is attached twice as a child", name(child)))
                        .found(format!(
                            "to `{}` and to `{}`",
                            name(links.ends(earlier).0),
                            name(onto)
                        ))
                        .allowed("every module is a child at most once")
                        .hint("the robot is a tree: remove one of the two attachments; modules that touch need no attachment"),
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
        // There is one root, and every other module has one parent, so a module that was not reached belongs to a cycle.
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
            Error::invalid(format!("`{}` is attached to itself", modules[child].name)),
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
                Error::invalid("the modules are not all connected")
                    .found(format!(
                        "{} modules without a parent: {}",
                        roots.len(),
                        names.join(", ")
                    ))
                    .allowed("exactly one, the root")
                    .hint(format!(
                        "attach `{}` to a neighbour, or remove it",
                        modules[*second].name
                    )),
            ))
        }
    }
}

/// Finds the cycle that contains or leads to a module which is not connected to the root, by following parents until a module
/// repeats.
fn cycle(start: usize, modules: &[Module], links: Links<'_>, parent: &[Option<Edge>]) -> Flaw {
    let mut visited = vec![start];
    let mut last = Edge::Attachment(0);
    let mut module = start;
    while let Some(edge) = parent[module] {
        last = edge;
        module = links.ends(edge).0;
        if let Some(first) = visited.iter().position(|&m| m == module) {
            visited.drain(..first);
            break;
        }
        visited.push(module);
    }
    visited.push(module);
    let names: Vec<String> = visited
        .iter()
        .rev()
        .map(|&m| format!("`{}`", modules[m].name))
        .collect();
    Flaw::new(
        last.path(),
        Error::invalid("the attachments form a cycle")
            .found(names.join(" > "))
            .allowed("a tree: one root, and every other module a child of one parent")
            .hint("remove one attachment of the cycle; modules that touch need no attachment"),
    )
}

fn check_faces(modules: &[Module], attachments: &[Attachment]) -> Checked<()> {
    let mut taken: HashMap<(usize, Face), usize> = HashMap::new();
    for (index, attachment) in attachments.iter().enumerate() {
        for (field, module, face, other) in [
            ("face", attachment.parent, attachment.face, attachment.child),
            (
                "child_face",
                attachment.child,
                attachment.child_face,
                attachment.parent,
            ),
        ] {
            match taken.entry((module, face)) {
                Entry::Vacant(free) => {
                    free.insert(other);
                }
                Entry::Occupied(neighbour) => {
                    return Err(Flaw::new(
                        format!("glue[{index}].{field}"),
                        Error::invalid(format!(
                            "two modules are attached to face {} of `{}`",
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

/// Checks that every servo moves at least one part, and that no two servos drive the same connection.
fn check_drives(modules: &[Module], attachments: &[Attachment]) -> Checked<()> {
    for (index, attachment) in attachments.iter().enumerate() {
        if modules[attachment.parent].driven_face() == Some(attachment.face)
            && modules[attachment.child].driven_face() == Some(attachment.child_face)
        {
            return Err(Flaw::new(
                format!("glue[{index}]"),
                Error::invalid("two driven faces are attached to each other")
                    .found(format!(
                        "face {} of `{}` on face {} of `{}`",
                        attachment.child_face.name(),
                        modules[attachment.child].name,
                        attachment.face.name(),
                        modules[attachment.parent].name
                    ))
                    .hint(
                        "two servos would drive one attachment: put a passive module between them",
                    ),
            ));
        }
    }
    for (index, module) in modules.iter().enumerate() {
        let Some(drive) = module.drive else { continue };
        if module.plate().is_some() || is_attached(attachments, index, drive.face) {
            continue;
        }
        let hint = match drive.axis {
            DriveAxis::Normal { .. } => {
                "add a plate, attach a module to that face, or make it Passive"
            }
            DriveAxis::Tangent { .. } => "attach a module to that face, or make it Passive",
        };
        return Err(Flaw::new(
            format!("modules[{index}].kind.axis"),
            Error::invalid(format!("the servo of `{}` moves nothing", module.name))
                .found(format!(
                    "no plate and no module on its driven face {}",
                    drive.face.name()
                ))
                .hint(hint),
        ));
    }
    Ok(())
}

/// Whether another module is attached to this face.
pub(super) fn is_attached(attachments: &[Attachment], module: usize, face: Face) -> bool {
    attachments.iter().any(|attachment| {
        (attachment.parent, attachment.face) == (module, face)
            || (attachment.child, attachment.child_face) == (module, face)
    })
}
