//! Genomes, and how a robot develops from one.
//!
//! A genome is ten numbers per module (paper 003, section 2.1), and as many genes as modules. A robot is built as in the
//! paper's reference \[6\] (Brodbeck, Hauser, Iida 2015, PLOS ONE 10(6) e0128444, figure 1): for every gene, in order, the
//! part built so far is turned, the new module is turned, and it is glued on top. Our sources publish that a gene holds
//! the kind of module, the construction and the control of its motor, but **not which number means what**: the third
//! column says what is assumed here.
//!
//! | # | number | published? | 0 to 1 means |
//! |---|---|---|---|
//! | 1 | `kind` | that there are active and passive modules; the coding is assumed | passive below `passive_share` (0.5), active from there on |
//! | 2 | `roll_part` | that the part is turned; by quarter turns and about which axes is assumed | 0, 1, 2 or 3 right-handed quarter turns about x |
//! | 3 | `pitch_part` | as above | then 0, 1, 2 or 3 quarter turns about y |
//! | 4 | `face_module` | that the module is turned; by which angles is assumed | the driven face looks along +x, −x, +y, −y, +z, −z; a sixth of the range each, passive modules ignore it |
//! | 5 | `place_x` | that it is placed on top; where is assumed | which column of cubes along x, equal shares |
//! | 6 | `place_y` | as above | which of the columns at that x, along y, equal shares; the module lands on the highest cube of it |
//! | 7 | `amplitude` | that the gene controls the motor; the coding is assumed | `amplitude_rad`, linear |
//! | 8 | `frequency` | assumed | `frequency_hz`, linear |
//! | 9 | `phase` | assumed | `phase_rad`, linear |
//! | 10 | `offset` | assumed | `offset_rad`, linear |
//!
//! Also assumed: modules stand centre on centre (a lattice, no partial shifts), both kinds have the same side, and the
//! first gene's turns turn nothing. The robot walks in the attitude in which it was finished. [`Development`] holds
//! every setting; the number of modules is bounded by its `max_modules`.
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
//! let specimen = Individual::parse(&Source::new("sitter.ron", text))?;
//! let robot = specimen.develop()?;
//! assert_eq!(robot.modules().len(), 2);
//! assert_eq!(Individual::parse(&Source::new("again.ron", specimen.to_ron()?))?, specimen);
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! `name` and `development` may be left out. A genome either develops or says why not: [`DevelopmentError`].

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
