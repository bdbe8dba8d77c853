//! Genomes, and the development of a robot from a genome.
//!
//! A genome is ten numbers per module (paper 003, section 2.1), and as many genes as modules. A robot is built as in the paper's
//! reference \[6\] (Brodbeck, Hauser, Iida 2015, PLOS ONE 10(6) e0128444, figure 1): for every gene, in order, the part built so
//! far is turned, the new module is turned, and it is attached on top. The sources publish that a gene holds the kind of module,
//! the construction and the control of its motor, but **not which number means what**: the third column says what is assumed
//! here.
//!
//! | # | number | published? | 0 to 1 means |
//! |---|---|---|---|
//! | 1 | `kind` | existence of active and passive modules; the coding is assumed | passive below `passive_share` (0.5), active from there on |
//! | 2 | `roll_part` | the part is turned; quarter turns and the choice of the axes are assumed | 0, 1, 2 or 3 right-handed quarter turns about x |
//! | 3 | `pitch_part` | as above | 0, 1, 2 or 3 quarter turns about y, after those about x |
//! | 4 | `face_module` | the module is turned; the angles are assumed | the driven face points along +x, −x, +y, −y, +z or −z; each direction takes a sixth of the range; passive modules ignore the number |
//! | 5 | `place_x` | the module is placed on top; the position is assumed | column of cubes along x, equal shares |
//! | 6 | `place_y` | as above | column along y among the columns at that x, equal shares; the module is placed on the highest cube of the column |
//! | 7 | `amplitude` | the gene controls the motor; the coding is assumed | `amplitude_rad`, linear |
//! | 8 | `frequency` | assumed | `frequency_hz`, linear |
//! | 9 | `phase` | assumed | `phase_rad`, linear |
//! | 10 | `offset` | assumed | `offset_rad`, linear |
//!
//! Also assumed: modules stand centre on centre (a lattice, no partial shifts), active and passive modules have the same edge
//! length, and the turns of the first gene have no effect. The robot walks in the attitude in which it was finished.
//! [`Development`] holds every setting; the number of modules is bounded by its `max_modules`.
//!
//! # The file
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::genome::Individual;
//!
//! let text = "Genome(
//!     name: \"sitter\",
//!     modules: 2,
//!     // kind, roll_part, pitch_part, face_module, place_x, place_y, amplitude, frequency, phase, offset
//!     genes: [
//!         [0.9, 0, 0, 0.1, 0, 0, 0.8, 0.5, 0.25, 0.5],
//!         [0.2, 0, 0.3, 0, 0, 0, 0, 0, 0, 0],
//!     ],
//!     development: (max_modules: 8),
//! )";
//! let individual = Individual::parse(&Source::new("sitter.ron", text))?;
//! let robot = individual.develop()?;
//! assert_eq!(robot.modules().len(), 2);
//! assert_eq!(Individual::parse(&Source::new("again.ron", individual.to_ron()?))?, individual);
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! `name` and `development` may be left out. A genome that cannot be built is refused with a [`DevelopmentError`].

mod develop;
mod development;
mod development_error;
mod file;
mod lattice;
mod locus;
mod sequence;

pub use development::Development;
pub use development_error::DevelopmentError;
pub use file::Individual;
#[cfg(feature = "schema")]
pub use file::IndividualFile;
pub use locus::Locus;
pub use sequence::{Gene, Genome};
