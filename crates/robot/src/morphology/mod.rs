//! Robot morphologies: modules that are attached face to face or connected by hinges, or bodies connected by joints; parsed from
//! RON into validated types and assembled into rigid parts and hinges.
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
//! | `defaults` | optional `side_m`, `mass_kg`, `servo` for modules that do not state them |
//! | `modules` | 1 to [`Morphology::MAX_MODULES`] of `(name, kind)`; names are unique |
//! | `glue` | the attachments: rigid connections between faces of modules; attachments and hinges form one tree, see [`Attachment`] |
//! | `hinges` | optional list of hinges between modules that are not attached to each other, see below |
//! | `never_touch` | optional list of pairs of names: modules between which no contacts are computed |
//! | `mount_m` | optional `(x, y, z)`: the root is fixed at this position in the world, upright; without it the robot moves freely |
//! | `track` | optional name of the module whose motion is recorded; the root by default |
//!
//! The **root** is the one module that is not the child of another module; its frame at zero servo angles is the robot frame.
//!
//! `kind` is `Passive(...)` or `Active(...)`. Both take
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `side_m` | edge length of the cube; or `sides_m: (x, y, z)` for a box | 0.001 to 10 m |
//! | `boxes` | optional list of `(sides_m, centre_m)`: the solid boxes of the module within that outer box; by default the module fills it | |
//! | `mass_kg` | mass of the cube, without plate | 1e-6 to 1000 kg |
//! | `inertia_kg_m2` | optional `(ixx, iyy, izz)` about the centre of mass; by default that of uniform boxes (a cube: m s²/6) | 0 to 1e5 kg m², none larger than the two others together |
//! | `centre_of_mass_m` | optional `(x, y, z)` in the module's frame; by default that of uniform boxes | inside the module |
//!
//! and `Active` also
//!
//! | field | meaning | range |
//! |---|---|---|
//! | `face` | the driven face; modules attached to it move with it | |
//! | `axis` | `Normal(plate: (side_m, thickness_m, mass_kg))`: spins about its outward normal; or `Tangent(axis: PosY)`: bends about an axis through the centre of the face, at right angles to its normal | plate sides and masses as for cubes, thickness up to 10 m |
//! | `servo` | `(law, max_torque_nm, max_speed_rad_s)`; law `Velocity(gain_1_s)`, `Torque(stiffness_nm_rad, damping_nm_s_rad)` or `Motor(...)`, see [`Motor`] and [`GearFriction`] for its fields | torque above 0 to 1e4 N m; gain up to 1e5 1/s, stiffness and damping up to 1e6; speed above 0 to 1e4 rad/s; without it there is no limit |
//! | `gait` | `(offset_rad, amplitude_rad, frequency_hz, phase_rad)`; offset and phase default to 0; without a gait the servo holds 0 rad | angles −1000 to 1000 rad, 0 to 100 Hz |
//!
//! The **plate** is a square slab on the outside of the driven face. If a module is attached to that face, it is still attached
//! without a gap: the plate then moves and has mass but takes part in no contacts, and it may be left out (`Normal()`). A servo
//! that moves nothing (a bending face, or a face without a plate, with no attached module) is refused because its joint would
//! have no child.
//!
//! # Hinges
//!
//! A servo of an active module drives a face. All other hinges are stated in `hinges`: each connects two modules that are not
//! attached to each other, with an axis at any position.
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
//! | `name`, `parent`, `child` | name of the hinge, and names of the two modules | |
//! | `anchor_m`, `child_anchor_m` | a point on the axis in the parent's frame, and the same point in the child's; the second defaults to the child's centre | ±10 m |
//! | `axis` | direction in the parent's frame, of any length; the child turns by +angle about it. At angle 0 both frames are parallel | not zero |
//! | `viscous_nm_s_rad`, `dry_nm` | optional friction: torque per speed, and largest torque of dry friction | 0 to 1e4 |
//! | `limits_rad` | optional `(smallest, largest)` angle; by default no limits | 0 between them |
//! | `servo`, `gait` | optional, as for active modules; without a servo the hinge is passive | |
//!
//! A module may also be attached to its parent by its own driven face: then its cube moves, and the plate stays with the parent.
//!
//! Also refused are cycles, a child that is attached twice, modules that are not connected, two modules on one face, two driven
//! faces attached to each other, and boxes (of modules and free plates) that overlap by more than 1 µm at zero angles, unless a
//! stated hinge connects the two or `never_touch` names them.

mod absent;
pub mod amendment;
mod assemble;
mod assembly;
mod attachment;
mod blueprint;
pub mod body;
mod command_scale;
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
mod stiffness;
mod summary;
mod sweep;
mod tree;
mod turning;
mod tyre;

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
pub use command_scale::CommandScale;
pub use dynamics::Dynamics;
pub use face::Face;
pub use law::ServoLaw;
pub use module::{Drive, DriveAxis, Module, ModuleBox, Plate};
pub use motor::{GearFriction, MOST_LOAD, Motor};
pub use pivot::Pivot;
pub use realgap_solid::{Facet, Shape, Surface};
pub use stiffness::StiffestJoint;
pub use summary::Summary;
pub use turning::TurningFriction;
pub use tyre::Tyre;

use crate::import::{Note, Options, import, is_foreign};
use body::Structure;
pub use file::MorphologyFile;
use flaw::{Checked, Flaw};
use layout::Placement;
use realgap_core::Result;
use realgap_core::file::{Source, parse_ron, write_ron};
use tree::Tree;

/// A valid robot: its modules form one tree, nothing overlaps, and every number is in range.
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

/// The structure and the assembly of a robot of bodies.
#[derive(Debug, PartialEq)]
struct Built {
    structure: Structure,
    assembly: Assembly,
}

impl Morphology {
    /// Largest number of modules of one robot.
    pub const MAX_MODULES: usize = 200;

    /// Checks a blueprint.
    ///
    /// # Errors
    /// A robot that the [module documentation](self) lists as refused; the error names the path of the value as in a file, e.g.
    /// `modules[2].kind.mass_kg`.
    pub fn new(blueprint: Blueprint) -> Result<Self> {
        Self::check(blueprint).map_err(Flaw::without_file)
    }

    /// Reads a robot from a RON file, or from a URDF or MJCF file, by the extension of the file.
    ///
    /// # Errors
    /// As [`Source::read`] and [`Morphology::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "morphology")?)
    }

    /// Parses a RON text.
    ///
    /// # Errors
    /// Text that is not RON of the form described in the [module documentation](self), or a robot that cannot be built; every
    /// error names file, line and column.
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

    /// Imports a robot from URDF or MJCF, with notes on everything that was left out, changed or assumed.
    ///
    /// # Errors
    /// As [`import`]; an imported robot that realgap cannot simulate.
    pub fn import(source: &Source, options: &Options) -> Result<(Self, Vec<Note>)> {
        let imported = import(source, options)?;
        let robot = Self::check_structure(imported.structure).map_err(|flaw| {
            let line = imported.lines.get(flaw.entry());
            let error = flaw.without_file().at_file(source.path());
            let error = match line {
                Some(line) => error.at_line(*line, 1),
                None => error,
            };
            error.or_hint("the error refers to the imported robot: bodies[0] is its first link")
        })?;
        Ok((robot, imported.notes))
    }

    /// A robot of bodies.
    ///
    /// # Errors
    /// A robot that the [module of bodies](body) cannot represent; the error names the path of the value as in a file, e.g.
    /// `joints[2].child`.
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
            collision_exclude: assembly.collision_exclude.clone(),
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

    /// The robot as bodies and joints, if its file states it in this form.
    pub fn structure(&self) -> Option<&Structure> {
        self.built.as_deref().map(|built| &built.structure)
    }

    /// Checks a name for a robot.
    ///
    /// # Errors
    /// A name with characters other than letters, digits, `_` and `-`, a name that begins with `-`, or one with more than
    /// [`Module::MAX_NAME`] characters.
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

    /// The modules, in the order of the file; for a robot of bodies the bounding box of each body.
    pub fn modules(&self) -> &[Module] {
        &self.modules
    }

    /// The attachments, in the order of the file.
    pub fn attachments(&self) -> &[Attachment] {
        &self.attachments
    }

    /// The stated hinges, in the order of the file.
    pub fn pivots(&self) -> &[Pivot] {
        &self.pivots
    }

    /// Pairs of modules between which no contacts are computed, in the order of the file.
    pub fn collision_exclude(&self) -> &[(usize, usize)] {
        &self.collision_exclude
    }

    /// Whether the robot's file excludes contacts between two modules.
    pub(crate) fn is_collision_excluded(&self, a: usize, b: usize) -> bool {
        self.collision_exclude.contains(&(a, b)) || self.collision_exclude.contains(&(b, a))
    }

    /// Position at which the root module is fixed, world frame, upright, m; `None` for a robot that moves freely.
    pub fn mount_world_m(&self) -> Option<Vector3<f64>> {
        self.mount_world_m
    }

    /// Index of the root: the module that is not the child of another module.
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

    /// Assembles the robot: rigid parts connected by hinges, in the robot frame at zero servo angles.
    ///
    /// Part 0 contains the root. Parts are numbered from the root outwards, at each module first its free plate, then its
    /// children in the order of the attachments, then those of stated hinges; hinge *k* moves part *k* + 1.
    pub fn assemble(&self) -> Assembly {
        match &self.built {
            Some(built) => built.assembly.clone(),
            None => assemble::assemble(self),
        }
    }

    /// Summary of the robot: counts, masses and sizes.
    pub fn summary(&self) -> Summary {
        summary::summarise(self)
    }

    /// Free plates that overlap another module at some angle of their gait while all other servos are at zero: pairs of the
    /// module with the plate and the module that the plate hits. The servo of such a plate is blocked, or a run starts with
    /// overlapping bodies.
    pub fn blocked_plates(&self) -> Vec<(usize, usize)> {
        if self.built.is_some() {
            return Vec::new();
        }
        sweep::blocked_plates(self)
    }
}
