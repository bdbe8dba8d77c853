//! Robots: modules glued face to face or joined by hinges, parsed from RON into validated types, assembled into rigid parts and hinges.
//!
//! # The file
//!
//! A robot is one RON file. Lengths in m, masses in kg, angles in rad; every frame is right-handed, a module's
//! axes run along its faces, and faces are named by their outward normal: `PosX`, `NegX`, `PosY`, `NegY`, `PosZ`, `NegZ`.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::morphology::Morphology;
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
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! | field | meaning |
//! |---|---|
//! | `name` | letters, digits, `_`, `-`; at most 64 |
//! | `description` | optional, free text |
//! | `defaults` | optional `side_m`, `mass_kg`, `servo` for modules that do not say otherwise |
//! | `modules` | 1 to [`Morphology::MAX_MODULES`] of `(name, kind)`; names are unique |
//! | `glue` | which module sits on which face of which other; glue and hinges are one tree, see [`Attachment`] |
//! | `hinges` | optional list of hinges between modules that are not glued, see below |
//! | `never_touch` | optional list of pairs of names: modules that pass through each other |
//! | `mount_m` | optional `(x, y, z)`: the root is held there in the world, upright; else the robot moves freely |
//! | `track` | optional name of the module whose motion is recorded; the root by default |
//!
//! The **root** is the one module that is nobody's child; its frame at zero servo angles is the robot frame.
//!
//! `kind` is `Passive(...)` or `Active(...)`. Both take
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `side_m` | edge length of the cube; or `sides_m: (x, y, z)` for a box | 0.001 to 10 m |
//! | `boxes` | optional list of `(sides_m, centre_m)`: what the module consists of within that box; else the whole of it | |
//! | `mass_kg` | mass of the cube, without plate | 1e-6 to 1000 kg |
//! | `inertia_kg_m2` | optional `(ixx, iyy, izz)` about the centre of mass; else of uniform boxes (a cube: m s²/6) | 0 to 1e5 kg m², none larger than the two others together |
//! | `centre_of_mass_m` | optional `(x, y, z)` in the module's frame; else that of uniform boxes | inside the module |
//!
//! and `Active` also
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `face` | the driven face; whatever is glued onto it moves with it | |
//! | `axis` | `Normal(plate: (side_m, thickness_m, mass_kg))`: spins about its outward normal; or `Tangent(axis: PosY)`: bends about an axis through the centre of the face, at right angles to its normal | plate sides and masses as for cubes, thickness up to 10 m |
//! | `servo` | `(law, max_torque_nm, max_speed_rad_s)`; law `Velocity(gain_1_s)`, `Torque(stiffness_nm_rad, damping_nm_s_rad)` or `Motor(...)`, see [`Motor`] and [`GearFriction`] for its fields | torque above 0 to 1e4 N m; gain up to 1e5 1/s, stiffness and damping up to 1e6; speed above 0 to 1e4 rad/s, left out: no limit |
//! | `gait` | `(offset_rad, amplitude_rad, frequency_hz, phase_rad)`; offset and phase default to 0, no gait holds 0 rad | angles −1000 to 1000 rad, 0 to 100 Hz |
//!
//! The **plate** is a square slab on the outside of the driven face. Where a module is glued onto that face, the module
//! still sits without a gap, the plate moves and weighs but touches nothing, and it may be left out
//! (`Normal()`). A servo that moves nothing at all (bending, or without plate, and nothing glued on) is refused:
//! it would be a joint without a body.
//!
//! # Hinges
//!
//! A servo drives a face. Any other hinge is stated: between two modules that are not glued, with an axis anywhere.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::morphology::Morphology;
//!
//! let text = r#"(
//!     name: "pendulum",
//!     mount_m: (0, 0, 0.4),
//!     modules: [
//!         (name: "stand", kind: Passive(side_m: 0.05, mass_kg: 1)),
//!         (name: "arm", kind: Passive(sides_m: (0.02, 0.02, 0.2), mass_kg: 0.1)),
//!     ],
//!     hinges: [(name: "shoulder", parent: "stand", child: "arm", anchor_m: (0, 0.04, 0), child_anchor_m: (0, 0, 0.1),
//!         axis: (0, 1, 0), viscous_nm_s_rad: 1e-4)],
//! )"#;
//! let assembly = Morphology::parse(&Source::new("pendulum.ron", text))?.assemble();
//! assert_eq!(assembly.hinges[0].name, "shoulder");
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `name`, `parent`, `child` | its own name, and those of the two modules | |
//! | `anchor_m`, `child_anchor_m` | a point on the axis in the parent's frame, and the same point in the child's; the second defaults to the child's centre | ±10 m |
//! | `axis` | direction in the parent's frame, of any length; the child turns by +angle about it. At angle 0 both frames are parallel | not zero |
//! | `viscous_nm_s_rad`, `dry_nm` | optional friction: torque per speed, and largest torque of dry friction | 0 to 1e4 |
//! | `limits_rad` | optional `(smallest, largest)` angle; else it turns all round | 0 between them |
//! | `servo`, `gait` | optional, as for active modules; without a servo the hinge is passive | |
//!
//! A module may also hold on to its parent with its own driven face: then its cube moves, and the plate stays with
//! the parent.
//!
//! Refused as well: cycles, a child glued twice, modules that are not connected, two modules on one face, two driven
//! faces on each other, and boxes (of modules and free plates) that overlap by more than 1 µm at zero angles, unless a stated hinge
//! joins the two or `never_touch` names them.

mod absent;
mod assemble;
mod assembly;
mod attachment;
mod blueprint;
pub mod body;
mod dynamics;
mod face;
mod file;
mod flaw;
mod gait;
mod law;
mod layout;
mod module;
mod module_file;
mod motor;
mod pivot;
mod plausibility;
mod summary;
mod sweep;
mod tree;

use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector3;

pub use assembly::{
    Actuator, Assembly, Bearing, ClusterMass, Freedom, Gait, Hinge, Mark, Part, Role, Servo, Solid,
    Spring,
};
pub use attachment::Attachment;
pub use blueprint::Blueprint;
use blueprint::names;
pub use dynamics::Dynamics;
pub use face::Face;
pub use law::ServoLaw;
pub use module::{Drive, DriveAxis, Module, ModuleBox, Plate};
pub use motor::{GearFriction, MOST_LOAD, Motor};
pub use pivot::Pivot;
pub use realgap_solid::{Facet, Shape, Surface};
pub use summary::Summary;

use crate::import::{Note, Options, import, is_foreign};
use body::Structure;
pub use file::MorphologyFile;
use flaw::{Checked, Flaw};
use layout::Placement;
use realgap_core::Result;
use realgap_core::file::{Source, parse_ron, write_ron};
use tree::Tree;

/// A robot that can be built: one tree of modules, nothing overlapping, every number in range.
#[derive(Debug, Clone, PartialEq)]
pub struct Morphology {
    name: String,
    description: String,
    modules: Vec<Module>,
    attachments: Vec<Attachment>,
    pivots: Vec<Pivot>,
    collision_exclude: Vec<(usize, usize)>,
    mount_world_m: Option<Vector3<f64>>,
    track: usize,
    tree: Tree,
    placements: Vec<Placement>,
    built: Option<Arc<Built>>,
}

/// A robot that was stated as bodies.
#[derive(Debug, PartialEq)]
struct Built {
    structure: Structure,
    assembly: Assembly,
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

    /// Reads a RON file; or a URDF or MJCF, by its ending.
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
        if is_foreign(source.path()) {
            return Ok(Self::import(source, &Options::default())?.0);
        }
        if Structure::is_in(source) {
            let structure: Structure = parse_ron(source)?;
            return Self::check_structure(structure).map_err(|flaw| flaw.in_file(source));
        }
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
        if let Some(built) = &self.built {
            return write_ron(&built.structure);
        }
        write_ron(&MorphologyFile::from_morphology(self))
    }

    /// A robot of another program, URDF or MJCF, and what there is to say about it.
    ///
    /// # Errors
    /// As [`import`], and of what is no robot here.
    pub fn import(source: &Source, options: &Options) -> Result<(Self, Vec<Note>)> {
        let imported = import(source, options)?;
        let robot = Self::check_structure(imported.structure).map_err(|flaw| {
            let line = imported.lines.get(flaw.entry());
            let error = flaw.without_file().at_file(source.path());
            let error = match line {
                Some(line) => error.at_line(*line, 1),
                None => error,
            };
            error.or_hint("this is said of the robot as it was read: bodies[0] is its first link")
        })?;
        Ok((robot, imported.notes))
    }

    /// A robot of bodies.
    ///
    /// # Errors
    /// Whatever the [page of bodies](body) says is refused; the error names the place as in a file, e.g. `joints[2].child`.
    pub fn of_bodies(structure: Structure) -> Result<Self> {
        Self::check_structure(structure).map_err(Flaw::without_file)
    }

    fn check_structure(structure: Structure) -> Checked<Self> {
        let assembly = structure.build()?;
        let track = body::tracked(&structure, &assembly);
        Ok(Self {
            name: structure.name.clone(),
            description: structure.description.clone(),
            modules: body::modules(&structure, &assembly),
            attachments: Vec::new(),
            pivots: Vec::new(),
            collision_exclude: assembly.apart.clone(),
            mount_world_m: assembly
                .world_from_mount
                .map(|pose| pose.translation.vector),
            track,
            tree: Tree::nothing(),
            placements: Vec::new(),
            built: Some(Arc::new(Built {
                structure,
                assembly,
            })),
        })
    }

    /// The robot as bodies and joints, where its file states it so.
    pub fn structure(&self) -> Option<&Structure> {
        self.built.as_deref().map(|built| &built.structure)
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

    /// The modules, in the order of the file; of a robot of bodies the box around each body.
    pub fn modules(&self) -> &[Module] {
        &self.modules
    }

    /// The glue, in the order of the file.
    pub fn attachments(&self) -> &[Attachment] {
        &self.attachments
    }

    /// The stated hinges, in the order of the file.
    pub fn pivots(&self) -> &[Pivot] {
        &self.pivots
    }

    /// Pairs of modules that never touch, in the order of the file.
    pub fn collision_exclude(&self) -> &[(usize, usize)] {
        &self.collision_exclude
    }

    /// Whether two modules are stated never to touch.
    pub fn are_apart(&self, a: usize, b: usize) -> bool {
        self.collision_exclude.contains(&(a, b)) || self.collision_exclude.contains(&(b, a))
    }

    /// Where the root module is held, world frame, upright, m; `None` for a robot that moves freely.
    pub fn mount_world_m(&self) -> Option<Vector3<f64>> {
        self.mount_world_m
    }

    /// Index of the module that is nobody's child.
    pub fn root(&self) -> usize {
        match &self.built {
            Some(built) => built.assembly.parts[0].solids[0].module,
            None => self.tree.root,
        }
    }

    /// Index of the module whose motion is recorded.
    pub fn track(&self) -> usize {
        self.track
    }

    /// Lets the glue set: rigid parts joined by hinges, in the robot frame at zero servo angles.
    ///
    /// Part 0 contains the root. Parts are numbered from the root outwards, at each module first its free
    /// plate, then its children in the order of the glue, then those of stated hinges; hinge *k* moves part *k* + 1.
    pub fn assemble(&self) -> Assembly {
        match &self.built {
            Some(built) => built.assembly.clone(),
            None => assemble::assemble(self),
        }
    }

    /// The robot in a few numbers.
    pub fn summary(&self) -> Summary {
        summary::summarise(self)
    }

    /// Free plates that overlap another module at some angle of their gait, all other servos at zero: pairs of the module with
    /// the plate and the module that it hits. Such a servo is blocked, or a run starts with bodies inside each other.
    pub fn blocked_plates(&self) -> Vec<(usize, usize)> {
        if self.built.is_some() {
            return Vec::new();
        }
        sweep::blocked_plates(self)
    }
}
