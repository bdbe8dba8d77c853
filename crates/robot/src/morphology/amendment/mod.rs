//! Changes of single numbers in the RON file of a robot. Everything else stays as it was: comments, order, blanks.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::morphology::Morphology;
//! use realgap_robot::morphology::amendment::amend;
//!
//! let text = "(name: \"cube\", /* steel */ modules: [(name: \"a\", kind: Passive(side_m: 0.1, mass_kg: 2))])";
//! let source = Source::new("cube.ron", text);
//! let robot = Morphology::parse(&source)?;
//! let mut fitted = robot.assemble();
//! fitted.parts[0].solids[0].mass_kg = 2.5;
//! fitted.parts[0].solids[0].inertia_kg_m2 *= 1.25;
//! let changes: Vec<_> = robot.changes(&fitted).into_iter().map(|change| (change, "weighed".to_owned())).collect();
//! let expected = format!("// weighed\n{}", text.replace("mass_kg: 2)", "mass_kg: 2.5)"));
//! assert_eq!(amend(&source, &changes)?.text, expected);
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod difference;
mod number;

pub use difference::largest_difference;

use std::collections::{BTreeMap, BTreeSet};

use super::Morphology;
use super::assembly::{Assembly, Hinge, Role};
use crate::import::amendment::{Amended, Outcome, Written};
use number::{command, drive, gait, mass_of_body, mass_of_module, servo, world};
use realgap_core::Error;
use realgap_core::Result;
use realgap_core::file::{RonEditor, Source};

/// A number, or several that belong together, of a robot's file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stated {
    /// One number.
    Number(f64),
    /// A group of three.
    Triple([f64; 3]),
    /// The elements xx, yy, zz, xy, xz, yz of a tensor.
    Tensor([f64; 6]),
}

impl Stated {
    fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Number(number) => vec![*number],
            Self::Triple(all) => all.to_vec(),
            Self::Tensor(all) => all.to_vec(),
        }
    }
}

/// Names of the elements of a tensor in files.
const ELEMENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// A number of a robot's file that is another for a changed robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Its path in the file: that of what it belongs to, e.g. `joints[2]`.
    pub owner: String,
    /// What it belongs to, for people: `joint elbow`.
    pub element: String,
    /// The path from there: `kind.dry_nm`.
    pub field: String,
    /// What the robot has.
    pub from: Stated,
    /// What the changed robot has.
    pub to: Stated,
}

impl Change {
    /// Path in the file.
    pub fn path(&self) -> String {
        format!("{}.{}", self.owner, self.field)
    }

    /// Its size, relative to the new number.
    pub fn difference(&self) -> f64 {
        let (from, to) = (self.from.numbers(), self.to.numbers());
        let each = from.iter().zip(&to).map(|(from, to)| (from - to).powi(2));
        let size = to.iter().map(|to| to * to).sum::<f64>();
        each.sum::<f64>().sqrt() / size.sqrt().max(f64::MIN_POSITIVE)
    }
}

/// Where numbers of one thing stand.
pub(super) struct Owner {
    path: String,
    element: String,
}

impl Owner {
    fn new(path: String, kind: &str, name: &str) -> Self {
        Self {
            path,
            element: format!("{kind} {name}").trim_end().to_owned(),
        }
    }

    /// The numbers that differ.
    fn push(
        &self,
        changes: &mut Vec<Change>,
        numbers: impl IntoIterator<Item = (String, Stated, Stated)>,
    ) {
        let differing = numbers.into_iter().filter(|(_, from, to)| from != to);
        changes.extend(differing.map(|(field, from, to)| Change {
            owner: self.path.clone(),
            element: self.element.clone(),
            field,
            from,
            to,
        }));
    }
}

impl Morphology {
    /// The numbers of the robot's file that are others for a robot `to`, whose parts and hinges are those of this one. A number
    /// that no such file states is left out.
    pub fn changes(&self, to: &Assembly) -> Vec<Change> {
        let from = self.assemble();
        let mut changes = Vec::new();
        for (old, new) in from.hinges.iter().zip(&to.hinges) {
            self.hinge_changes(old, new, &mut changes);
        }
        for (module, name) in from.module_names.iter().enumerate() {
            let old = mass_of_module(self, &from, module);
            let new = mass_of_module(self, to, module);
            match self.structure() {
                Some(structure) => {
                    let owner = Owner::new(format!("bodies[{module}]"), "body", name);
                    owner.push(
                        &mut changes,
                        mass_of_body(&structure.bodies[module], &old, &new),
                    );
                }
                None => {
                    let owner = Owner::new(format!("modules[{module}].kind"), "module", name);
                    owner.push(
                        &mut changes,
                        number::mass(&self.modules[module], &old, &new),
                    );
                }
            }
        }
        let solids = |robot: &Assembly| -> Vec<_> {
            robot
                .parts
                .iter()
                .flat_map(|part| part.solids.clone())
                .collect()
        };
        for (old, new) in solids(&from).iter().zip(&solids(to)) {
            let name = &from.module_names[old.module];
            if old.role == Role::Plate {
                let owner = Owner::new(format!("modules[{}].kind", old.module), "module", name);
                owner.push(
                    &mut changes,
                    [(
                        "axis.plate.mass_kg".to_owned(),
                        Stated::Number(old.mass_kg),
                        Stated::Number(new.mass_kg),
                    )],
                );
            }
            if let (Some(old_tyre), Some(new_tyre)) = (&old.tyre, &new.tyre) {
                let path = format!("bodies[{}].shapes[{}].tyre", old.module, old.number);
                Owner::new(path, "tyre of", name)
                    .push(&mut changes, number::tyre(old_tyre, new_tyre));
            }
        }
        if self.built.is_some() {
            Owner::new("world".to_owned(), "world", "")
                .push(&mut changes, world(&from.surroundings, &to.surroundings));
        }
        changes
    }

    fn hinge_changes(&self, old: &Hinge, new: &Hinge, changes: &mut Vec<Change>) {
        let name = &old.name;
        let is_own = |known: &String| known == name;
        let (bearing, actuator) = match self.structure() {
            Some(structure) => {
                let joint = structure
                    .joints
                    .iter()
                    .position(|joint| is_own(&joint.name));
                let driver = structure
                    .actuators
                    .iter()
                    .position(|driver| is_own(&driver.joint));
                (
                    joint.map(|index| format!("joints[{index}]")),
                    driver.map(|index| {
                        (
                            format!("actuators[{index}]"),
                            structure.actuators[index].follows.is_some(),
                        )
                    }),
                )
            }
            None if old.is_stated => {
                let pivot = self.pivots.iter().position(|pivot| is_own(&pivot.name));
                let path = pivot.map(|index| format!("hinges[{index}]"));
                (path.clone(), path.map(|path| (path, false)))
            }
            None => (None, Some((format!("modules[{}].kind", old.module), false))),
        };
        if let Some(path) = bearing {
            let owner = Owner::new(path, "joint", name);
            owner.push(changes, drive(old, new, self.built.is_some()));
        }
        let (Some((path, follows)), Some(old), Some(new)) =
            (actuator, &old.actuator, &new.actuator)
        else {
            return;
        };
        let owner = Owner::new(path, "actuator of", name);
        owner.push(changes, servo(&old.servo, &new.servo));
        // What copies the command of another joint has no gait of its own.
        if !follows {
            owner.push(changes, gait(&old.gait, &new.gait));
        }
        if self.built.is_some() {
            owner.push(changes, command(&old.command, &new.command));
        }
    }
}

/// Changes numbers of the RON file of a robot; each with the comment that is put before its line.
///
/// # Errors
/// A text that is not understood, or that is no robot after the changes. A change that the file cannot express is no error, but an
/// [`Outcome`].
pub fn amend(source: &Source, changes: &[(Change, String)]) -> Result<Amended> {
    let unclear = || {
        Error::invalid("the layout of this file is not understood, so that it cannot be changed")
            .at_file(source.path())
            .hint("please report this file: this should never happen")
    };
    let mut editor = RonEditor::new(source).ok_or_else(unclear)?;
    let shared = shared(&editor, changes);
    let mut outcomes: Vec<Outcome> = Vec::new();
    for (index, (change, remark)) in changes.iter().enumerate() {
        let before = editor.clone();
        let written = match inherited(&editor, change) {
            None => put(&mut editor, &change.owner, &change.field, change),
            Some(_) if shared.contains(&index) => {
                put(&mut editor, "defaults", &change.field, change)
            }
            Some(top) => own(&mut editor, top, change, changes),
        };
        match &written {
            Ok(_) => editor.remark(remark),
            Err(_) => editor = before,
        }
        outcomes.push(written);
    }
    let text = editor.finish();
    // Nothing is handed out that cannot be read.
    Morphology::parse(&Source::new(source.path(), text.clone()))?;
    Ok(Amended { text, outcomes })
}

/// The field of `defaults` from which a module has the number of a change.
fn inherited(editor: &RonEditor<'_>, change: &Change) -> Option<&'static str> {
    let top = ["servo", "mass_kg"].into_iter().find(|top| {
        let rest = change.field.strip_prefix(top);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })?;
    let has_own = editor.has(&format!("{}.{top}", change.owner));
    let is_module = change.owner.starts_with("modules[");
    (is_module && !has_own && editor.has(&format!("defaults.{top}"))).then_some(top)
}

/// The changes of what modules have from `defaults`, where all of these modules get the same: they change `defaults`.
fn shared(editor: &RonEditor<'_>, changes: &[(Change, String)]) -> BTreeSet<usize> {
    let heirs = |top: &str| {
        let modules = (0..).map(|index| format!("modules[{index}].kind"));
        let all = modules.take_while(|path| editor.has(path));
        // A passive module has no servo.
        let can = all.filter(|path| top != "servo" || editor.has(&format!("{path}.face")));
        can.filter(|path| !editor.has(&format!("{path}.{top}")))
            .count()
    };
    let mut alike: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, (change, _)) in changes.iter().enumerate() {
        if inherited(editor, change).is_some() {
            alike.entry(&change.field).or_default().push(index);
        }
    }
    let mut shared = BTreeSet::new();
    for indices in alike.values() {
        let first = &changes[indices[0]].0;
        let is_same = indices.iter().all(|index| changes[*index].0.to == first.to);
        let count = inherited(editor, first).map_or(0, heirs);
        if is_same && indices.len() == count {
            shared.extend(indices);
        }
    }
    shared
}

/// Gives a module what it had from `defaults`, with its own numbers.
fn own(
    editor: &mut RonEditor<'_>,
    top: &str,
    change: &Change,
    changes: &[(Change, String)],
) -> Outcome {
    let defaults = format!("defaults.{top}");
    let mine = changes
        .iter()
        .filter(|(other, _)| other.owner == change.owner);
    let edits = mine.filter_map(|(other, _)| {
        let path = spelled(editor, format!("defaults.{}", other.field));
        let inner = path.strip_prefix(&defaults)?.strip_prefix('.')?;
        Some((inner.to_owned(), text(&other.to)))
    });
    let edits: Vec<(String, String)> = edits.collect();
    if edits.is_empty() {
        return put(editor, &change.owner, &change.field, change);
    }
    let missing = || format!("the file has no `{defaults}`");
    let copied = editor.copy_with(&defaults, &edits).ok_or_else(missing)??;
    let replaced = editor.set(&format!("{}.{top}", change.owner), &copied)?;
    Ok(vec![Written {
        line: replaced.line,
        element: change.element.clone(),
        attribute: change.field.clone(),
        before: None,
        now: text(&change.to),
    }])
}

/// Writes what a change says.
fn put(editor: &mut RonEditor<'_>, owner: &str, field: &str, change: &Change) -> Outcome {
    let path = spelled(editor, format!("{owner}.{field}"));
    let parts = |names: Vec<String>, from: &[f64], to: &[f64]| {
        let all = names.into_iter().zip(from.iter().zip(to));
        let differing = all.filter(|(_, (from, to))| from != to);
        differing
            .map(|(name, (_, to))| (format!("{path}{name}"), to.to_string()))
            .collect::<Vec<_>>()
    };
    let is_stated = editor.has(&path) && editor.text_at(&path) != Some("None");
    let edits = match (&change.from, &change.to) {
        (Stated::Triple(from), Stated::Triple(to)) if is_stated => {
            parts((0..3).map(|index| format!("[{index}]")).collect(), from, to)
        }
        (Stated::Tensor(from), Stated::Tensor(to)) if is_stated => {
            parts(ELEMENTS.map(|name| format!(".{name}")).to_vec(), from, to)
        }
        _ => vec![(path.clone(), text(&change.to))],
    };
    let mut written = Vec::new();
    for (path, now) in edits {
        let replaced = editor.set(&path, &now)?;
        let attribute = path.strip_prefix(owner).unwrap_or(&path);
        written.push(Written {
            line: replaced.line,
            element: if owner == "defaults" {
                "defaults".to_owned()
            } else {
                change.element.clone()
            },
            attribute: attribute.trim_start_matches('.').to_owned(),
            before: replaced.before,
            now,
        });
    }
    Ok(written)
}

/// The path under the other name of a field, where the file uses that.
fn spelled(editor: &RonEditor<'_>, path: String) -> String {
    let other = path
        .strip_suffix("gain_1_s")
        .map(|rest| format!("{rest}gain_per_s"));
    other.filter(|other| editor.has(other)).unwrap_or(path)
}

/// A value as a file states it.
fn text(value: &Stated) -> String {
    let list = |all: Vec<String>| format!("({})", all.join(", "));
    match value {
        Stated::Number(number) => number.to_string(),
        Stated::Triple(all) => list(all.iter().map(f64::to_string).collect()),
        Stated::Tensor(all) => {
            let each = ELEMENTS.iter().zip(all).enumerate();
            // Products of inertia that are left out are 0.
            let needed = each.filter(|(index, (_, number))| *index < 3 || **number != 0.0);
            list(
                needed
                    .map(|(_, (name, number))| format!("{name}: {number}"))
                    .collect(),
            )
        }
    }
}
