//! Robots of other programs: URDF of boxes and hinges.
//!
//! What a robot here cannot be (meshes, wheels on ground planes, sliding joints) is refused or left out, and whatever is left out
//! is said. Export, which knows experiments, goes the other way.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::import::from_urdf;
//! use realgap_robot::morphology::Morphology;
//!
//! let urdf = r#"<robot name="one"><link name="body">
//!     <inertial><mass value="0.3"/></inertial>
//!     <collision><geometry><box size="0.1 0.06 0.04"/></geometry></collision>
//! </link></robot>"#;
//! let imported = from_urdf(&Source::new("one.urdf", urdf))?;
//! let robot = Morphology::parse(&Source::new("one.ron", &imported.text))?;
//! assert_eq!(robot.name(), "one");
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod element;
mod link;
mod urdf;

pub use urdf::{Imported, from_urdf};
