//! The unchecked description of a modular robot, and the checks that turn it into a [`Morphology`].

use std::collections::HashMap;

use nalgebra::Vector3;

use super::flaw::{Checked, Flaw, Range};
use super::tree::{Links, Tree};
use super::{Attachment, Module, Morphology, Pivot, layout, module, pivot};
use realgap_core::Error;

/// An unchecked description of a modular robot; [`Morphology::new`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct Blueprint {
    /// Name of the robot: letters, digits, `_` and `-`.
    pub name: String,
    /// Free text.
    pub description: String,
    /// The modules.
    pub modules: Vec<Module>,
    /// The attachments between modules, by index of module.
    pub attachments: Vec<Attachment>,
    /// Hinges stated by anchor and axis, by index of module.
    pub pivots: Vec<Pivot>,
    /// Pairs of modules between which no contacts are computed.
    pub collision_exclude: Vec<(usize, usize)>,
    /// Position at which the root module is fixed, world frame, upright, m; `None` for a robot that moves freely.
    pub mount_world_m: Option<Vector3<f64>>,
    /// Index of the module whose motion is recorded; the root when `None`.
    pub track: Option<usize>,
}

impl Morphology {
    pub(super) fn check(blueprint: Blueprint) -> Checked<Self> {
        let Blueprint {
            name,
            description,
            modules,
            attachments,
            pivots,
            collision_exclude,
            mount_world_m,
            track,
        } = blueprint;
        module::check_name(&name, "a robot", "name")?;
        check_count(modules.len())?;
        for (index, module) in modules.iter().enumerate() {
            module.check(&format!("modules[{index}]"))?;
        }
        names(&modules)?;
        pivot::check_names(&pivots, &modules)?;
        check_collision_exclude(&collision_exclude, modules.len())?;
        check_mount(mount_world_m)?;
        let links = Links {
            attachments: &attachments,
            pivots: &pivots,
        };
        let tree = Tree::grow(&modules, links)?;
        let track = track.unwrap_or(tree.root);
        if track >= modules.len() {
            return Err(Flaw::new(
                "track",
                Error::invalid("there is no module with this number")
                    .found(format!("module number {track}"))
                    .allowed(format!("0 to {}", modules.len() - 1)),
            ));
        }
        let placements = layout::place(&modules, links, &tree);
        let blocks = layout::blocks(&modules, &attachments, &placements);
        let is_excluded = |a: usize, b: usize| {
            collision_exclude.contains(&(a, b))
                || collision_exclude.contains(&(b, a))
                || pivots.iter().any(|pivot| {
                    let ends = (pivot.parent, pivot.child);
                    ends == (a, b) || ends == (b, a)
                })
        };
        layout::check_overlap(&modules, &tree, &blocks, is_excluded)?;
        Ok(Self {
            name,
            description,
            modules,
            attachments,
            pivots,
            collision_exclude,
            mount_world_m,
            track,
            tree,
            placements,
            built: None,
        })
    }
}

fn check_collision_exclude(pairs: &[(usize, usize)], modules: usize) -> Checked<()> {
    for (index, &(a, b)) in pairs.iter().enumerate() {
        if a == b || a >= modules || b >= modules {
            return Err(Flaw::new(
                format!("never_touch[{index}]"),
                Error::invalid("not a pair of modules")
                    .found(format!("numbers {a} and {b}"))
                    .allowed("two different modules of this robot"),
            ));
        }
    }
    Ok(())
}

fn check_mount(mount_world_m: Option<Vector3<f64>>) -> Checked<()> {
    for (index, value) in mount_world_m.iter().flatten().enumerate() {
        Range::within(-1000.0, 1000.0, "m").check(*value, &format!("mount_m[{index}]"))?;
    }
    Ok(())
}

fn check_count(modules: usize) -> Checked<()> {
    if (1..=Morphology::MAX_MODULES).contains(&modules) {
        return Ok(());
    }
    let problem = if modules == 0 {
        "a robot without modules"
    } else {
        "too many modules"
    };
    Err(Flaw::new(
        "modules",
        Error::invalid(problem)
            .found(modules)
            .allowed(format!("1 to {}", Morphology::MAX_MODULES)),
    ))
}

/// Index of each module by name; refuses duplicate names.
pub(super) fn names(modules: &[Module]) -> Checked<HashMap<&str, usize>> {
    let mut names: HashMap<&str, usize> = HashMap::new();
    for (index, module) in modules.iter().enumerate() {
        if let Some(first) = names.insert(&module.name, index) {
            return Err(Flaw::new(
                format!("modules[{index}].name"),
                Error::invalid("two modules have the same name")
                    .found(format!("`{}` is also modules[{first}]", module.name))
                    .allowed("a unique name for every module"),
            ));
        }
    }
    Ok(names)
}
