//! Does the glue make one tree?

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::face::Face;
use super::flaw::{Checked, Flaw};
use super::glue::Glue;
use super::module::{DriveAxis, Module};
use crate::Error;

/// How the modules hang together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tree {
    /// The module that is nobody's child.
    pub(super) root: usize,
    /// Every module once, parents before children, level by level, siblings in the order of the glue.
    pub(super) order: Vec<usize>,
    /// Per module the index of the glue that makes it a child.
    pub(super) parent_glue: Vec<Option<usize>>,
    /// Per module the indices of the glue that gives it children.
    pub(super) child_glue: Vec<Vec<usize>>,
}

impl Tree {
    pub(super) fn grow(modules: &[Module], glue: &[Glue]) -> Checked<Self> {
        let name = |index: usize| modules[index].name.as_str();
        let mut parent_glue: Vec<Option<usize>> = vec![None; modules.len()];
        let mut child_glue: Vec<Vec<usize>> = vec![Vec::new(); modules.len()];
        for (index, joint) in glue.iter().enumerate() {
            check_indices(index, joint, modules)?;
            if let Some(earlier) = parent_glue[joint.child].replace(index) {
                return Err(Flaw::new(
                    format!("glue[{index}].child"),
                    Error::invalid(format!("`{}` is glued twice as a child", name(joint.child)))
                        .found(format!(
                            "onto `{}` and onto `{}`",
                            name(glue[earlier].parent),
                            name(joint.parent)
                        ))
                        .allowed("every module is a child at most once")
                        .hint("the robot is a tree: remove one of the two; modules that touch need no glue"),
                ));
            }
            child_glue[joint.parent].push(index);
        }
        let root = find_root(modules, glue, &parent_glue)?;
        let mut order = vec![root];
        let mut next = 0;
        while let Some(&module) = order.get(next) {
            order.extend(child_glue[module].iter().map(|&index| glue[index].child));
            next += 1;
        }
        // With one root and one parent for everyone else, whoever was not reached hangs on a cycle.
        let reached: Vec<bool> = order
            .iter()
            .fold(vec![false; modules.len()], |mut seen, &m| {
                seen[m] = true;
                seen
            });
        if let Some(lost) = reached.iter().position(|&seen| !seen) {
            return Err(cycle(lost, modules, glue, &parent_glue));
        }
        check_faces(modules, glue)?;
        check_drives(modules, glue)?;
        Ok(Self {
            root,
            order,
            parent_glue,
            child_glue,
        })
    }
}

fn check_indices(index: usize, joint: &Glue, modules: &[Module]) -> Checked<()> {
    for (field, module) in [("parent", joint.parent), ("child", joint.child)] {
        if module >= modules.len() {
            return Err(Flaw::new(
                format!("glue[{index}].{field}"),
                Error::invalid("there is no such module")
                    .found(format!("module number {module}"))
                    .allowed(format!("0 to {}", modules.len() - 1)),
            ));
        }
    }
    if joint.parent == joint.child {
        return Err(Flaw::new(
            format!("glue[{index}].child"),
            Error::invalid(format!(
                "`{}` is glued onto itself",
                modules[joint.child].name
            )),
        ));
    }
    if joint.quarter_turns > 3 {
        return Err(quarter_turns_flaw(index, joint.quarter_turns.into()));
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

fn find_root(modules: &[Module], glue: &[Glue], parent_glue: &[Option<usize>]) -> Checked<usize> {
    let roots: Vec<usize> = (0..modules.len())
        .filter(|&module| parent_glue[module].is_none())
        .collect();
    match roots.as_slice() {
        [] => Err(cycle(0, modules, glue, parent_glue)),
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
fn cycle(start: usize, modules: &[Module], glue: &[Glue], parent_glue: &[Option<usize>]) -> Flaw {
    let mut climbed = vec![start];
    let mut last_glue = 0;
    let mut module = start;
    while let Some(index) = parent_glue[module] {
        last_glue = index;
        module = glue[index].parent;
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
        format!("glue[{last_glue}]"),
        Error::invalid("the glue runs in a circle")
            .found(names.join(" > "))
            .allowed("a tree: one root, and every other module a child of one parent")
            .hint("remove one glue of the circle; modules that touch need no glue"),
    )
}

fn check_faces(modules: &[Module], glue: &[Glue]) -> Checked<()> {
    let mut taken: HashMap<(usize, Face), usize> = HashMap::new();
    for (index, joint) in glue.iter().enumerate() {
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
fn check_drives(modules: &[Module], glue: &[Glue]) -> Checked<()> {
    for (index, joint) in glue.iter().enumerate() {
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
        if module.plate().is_some() || is_glued(glue, index, drive.face) {
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
pub(super) fn is_glued(glue: &[Glue], module: usize, face: Face) -> bool {
    glue.iter().any(|joint| {
        (joint.parent, joint.face) == (module, face)
            || (joint.child, joint.child_face) == (module, face)
    })
}
