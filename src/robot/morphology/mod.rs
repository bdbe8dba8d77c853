//! Robots: cube modules glued face to face, parsed from RON into validated types, assembled into rigid parts and hinges.
//!
//! # The file
//!
//! A robot is one RON file. Lengths in m, masses in kg, angles in rad; every frame is right-handed, a module's
//! axes run along its faces, and faces are named by their outward normal: `PosX`, `NegX`, `PosY`, `NegY`, `PosZ`, `NegZ`.
//!
//! ```
//! use realgap::file::Source;
//! use realgap::robot::morphology::Morphology;
//!
//! let text = r#"(
//!     name: "wagger",
//!     description: "a cube that wags a second one and spins a plate",
//!     defaults: (side_m: 0.06, mass_kg: 0.07, servo: (law: Velocity(gain_1_s: 30.0), max_torque_nm: 0.2, max_speed_rad_s: 8.0)),
//!     modules: [
//!         (name: "core", kind: Active(face: PosX, axis: Tangent(axis: PosY), gait: (amplitude_rad: 0.7, frequency_hz: 1.0))),
//!         (name: "tail", kind: Passive(mass_kg: 0.03)),
//!         (name: "foot", kind: Active(face: NegY, axis: Normal(plate: (side_m: 0.066, thickness_m: 0.01, mass_kg: 0.012)),
//!             gait: (offset_rad: 0.8, amplitude_rad: 0.7, frequency_hz: 1.0, phase_rad: 1.57))),
//!     ],
//!     glue: [
//!         (parent: "core", face: PosX, child: "tail"),
//!         (parent: "core", face: NegX, child: "foot", child_face: PosX, quarter_turns: 1),
//!     ],
//!     track: "core",
//! )"#;
//! let morphology = Morphology::parse(&Source::new("wagger.ron", text))?;
//! let assembly = morphology.assemble();
//! assert_eq!((assembly.parts.len(), assembly.hinges.len()), (3, 2));
//! # Ok::<(), realgap::Error>(())
//! ```
//!
//! | field | meaning |
//! |---|---|
//! | `name` | letters, digits, `_`, `-`; at most 64 |
//! | `description` | optional, free text |
//! | `defaults` | optional `side_m`, `mass_kg`, `servo` for modules that do not say otherwise |
//! | `modules` | 1 to [`Morphology::MAX_MODULES`] of `(name, kind)`; names are unique |
//! | `glue` | which module sits on which face of which other; one tree, see [`Glue`] |
//! | `track` | optional name of the module whose motion is recorded; the root by default |
//!
//! The **root** is the one module that is nobody's child; its frame at zero servo angles is the robot frame.
//!
//! `kind` is `Passive(...)` or `Active(...)`. Both take
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `side_m` | edge length of the cube | 0.001 to 10 m |
//! | `mass_kg` | mass of the cube, without plate | 1e-6 to 1000 kg |
//! | `inertia_kg_m2` | optional `(ixx, iyy, izz)` about the centre of mass; else a solid cube, m s²/6 | 0 to 1e5 kg m², none larger than the two others together |
//! | `centre_of_mass_m` | optional `(x, y, z)` in the module's frame; else the centre | inside the cube |
//!
//! and `Active` also
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `face` | the driven face; whatever is glued onto it moves with it | |
//! | `axis` | `Normal(plate: (side_m, thickness_m, mass_kg))`: spins about its outward normal; or `Tangent(axis: PosY)`: bends about an axis through the centre of the face, at right angles to its normal | plate sides and masses as for cubes, thickness up to 10 m |
//! | `servo` | `(law, max_torque_nm, max_speed_rad_s)`; law `Velocity(gain_1_s)` or `Torque(stiffness_nm_rad, damping_nm_s_rad)` | torque above 0 to 1e4 N m; gain up to 1e5 1/s, stiffness and damping up to 1e6; speed above 0 to 1e4 rad/s, left out: no limit |
//! | `gait` | `(offset_rad, amplitude_rad, frequency_hz, phase_rad)`; offset and phase default to 0, no gait holds 0 rad | angles −1000 to 1000 rad, 0 to 100 Hz |
//!
//! The **plate** is a square slab on the outside of the driven face. Where a module is glued onto that face, the module
//! still sits without a gap, the plate moves and weighs but touches nothing, and it may be left out
//! (`Normal()`). A servo that moves nothing at all (bending, or without plate, and nothing glued on) is refused:
//! it would be a joint without a body.
//!
//! A module may also hold on to its parent with its own driven face: then its cube moves, and the plate stays with
//! the parent.
//!
//! Refused as well: cycles, a child glued twice, modules that are not connected, two modules on one face, two driven
//! faces on each other, and boxes (cubes and free plates) that overlap by more than 1 µm at zero angles.

mod assemble;
mod assembly;
mod face;
mod file;
mod flaw;
mod glue;
mod layout;
mod module;
mod plausibility;
mod summary;
mod sweep;
mod tree;

use std::collections::HashMap;
use std::path::Path;

pub use assembly::{Assembly, ClusterMass, Gait, Hinge, Part, Role, Servo, ServoLaw, Solid};
pub use face::Face;
pub use glue::Glue;
pub use module::{Drive, DriveAxis, Module, Plate};
pub use summary::Summary;

use crate::file::{Source, parse_ron, write_ron};
use crate::{Error, Result};
use file::MorphologyFile;
use flaw::{Checked, Flaw};
use layout::Placement;
use tree::Tree;

/// A robot as somebody wants it, not yet checked; [`Morphology::new`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct Blueprint {
    /// Name of the robot: letters, digits, `_` and `-`.
    pub name: String,
    /// Free text.
    pub description: String,
    /// The modules.
    pub modules: Vec<Module>,
    /// The glue, by index of module.
    pub glue: Vec<Glue>,
    /// Index of the module whose motion is recorded; the root when `None`.
    pub track: Option<usize>,
}

/// A robot that can be built: one tree of modules, nothing overlapping, every number in range.
#[derive(Debug, Clone, PartialEq)]
pub struct Morphology {
    name: String,
    description: String,
    modules: Vec<Module>,
    glue: Vec<Glue>,
    track: usize,
    tree: Tree,
    placements: Vec<Placement>,
}

impl Morphology {
    /// Most modules of one robot.
    pub const MAX_MODULES: usize = 200;

    /// Checks a blueprint.
    ///
    /// # Errors
    /// Whatever the [module page](self) says is refused; the error names the place as in a file, e.g. `modules[2].kind.mass_kg`.
    pub fn new(blueprint: Blueprint) -> Result<Self> {
        Self::check(blueprint).map_err(Flaw::without_file)
    }

    /// Reads a RON file.
    ///
    /// # Errors
    /// As [`Source::read`] and [`Morphology::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "morphology")?)
    }

    /// Parses a RON text.
    ///
    /// # Errors
    /// Text that is not RON of the form described on the [module page](self), or a robot that cannot be
    /// built; always with file, line and column.
    pub fn parse(source: &Source) -> Result<Self> {
        parse_ron::<MorphologyFile>(source)?
            .into_blueprint()
            .and_then(Self::check)
            .map_err(|flaw| flaw.in_file(source))
    }

    /// The robot as a RON text that [`Morphology::parse`] turns into an equal morphology.
    ///
    /// # Errors
    /// None is known: every validated morphology can be written.
    pub fn to_ron(&self) -> Result<String> {
        write_ron(&MorphologyFile::from_morphology(self))
    }

    fn check(blueprint: Blueprint) -> Checked<Self> {
        let Blueprint {
            name,
            description,
            modules,
            glue,
            track,
        } = blueprint;
        module::check_name(&name, "a robot", "name")?;
        check_count(modules.len())?;
        let mut names: HashMap<&str, usize> = HashMap::new();
        for (index, module) in modules.iter().enumerate() {
            module.check(&format!("modules[{index}]"))?;
            if let Some(first) = names.insert(&module.name, index) {
                return Err(Flaw::new(
                    format!("modules[{index}].name"),
                    Error::invalid("two modules have the same name")
                        .found(format!("`{}` is also modules[{first}]", module.name))
                        .allowed("a name of its own for every module"),
                ));
            }
        }
        let tree = Tree::grow(&modules, &glue)?;
        let track = track.unwrap_or(tree.root);
        if track >= modules.len() {
            return Err(Flaw::new(
                "track",
                Error::invalid("there is no such module")
                    .found(format!("module number {track}"))
                    .allowed(format!("0 to {}", modules.len() - 1)),
            ));
        }
        let placements = layout::place(&modules, &glue, &tree);
        let blocks = layout::blocks(&modules, &glue, &placements);
        layout::check_overlap(&modules, &tree, &blocks)?;
        Ok(Self {
            name,
            description,
            modules,
            glue,
            track,
            tree,
            placements,
        })
    }

    /// Checks what a robot would be called.
    ///
    /// # Errors
    /// Anything but letters, digits, `_` and `-`, the last not in front; over [`Module::MAX_NAME`] characters.
    pub fn check_name(name: &str) -> Result<()> {
        module::check_name(name, "a robot", "name").map_err(Flaw::without_file)
    }

    /// Name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Free text about the robot, possibly empty.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The modules, in the order of the file.
    pub fn modules(&self) -> &[Module] {
        &self.modules
    }

    /// The glue, in the order of the file.
    pub fn glue(&self) -> &[Glue] {
        &self.glue
    }

    /// Index of the module that is nobody's child.
    pub fn root(&self) -> usize {
        self.tree.root
    }

    /// Index of the module whose motion is recorded.
    pub fn track(&self) -> usize {
        self.track
    }

    /// Lets the glue set: rigid parts joined by hinges, in the robot frame at zero servo angles.
    ///
    /// Part 0 contains the root. Parts are numbered from the root outwards, at each module first its free
    /// plate, then its children in the order of the glue; hinge *k* moves part *k* + 1.
    pub fn assemble(&self) -> Assembly {
        assemble::assemble(self)
    }

    /// The robot in a few numbers.
    pub fn summary(&self) -> Summary {
        summary::summarise(self)
    }

    /// Free plates that overlap another module at some angle of their gait, all other servos at zero: pairs of the module with
    /// the plate and the module that it hits. Such a servo is blocked, or a run starts with bodies inside each other.
    pub fn blocked_plates(&self) -> Vec<(usize, usize)> {
        sweep::blocked_plates(self)
    }
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
