//! Changes of single numbers in the file of a robot. Everything else stays as it was: comments, order, blanks, included files.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::import::Options;
//! use realgap_robot::import::amendment::{Amendment, JointQuantity, Target, amend};
//!
//! let urdf = r#"<robot name="arm"><link name="base"/><link name="arm"/>
//!   <joint name="elbow" type="continuous">
//!     <parent link="base"/><child link="arm"/>
//!     <dynamics damping="0.1"/> <!-- guessed -->
//!   </joint></robot>"#;
//! let fitted = Amendment {
//!     target: Target::Joint {
//!         joint: "elbow".to_owned(),
//!         quantity: JointQuantity::Viscous,
//!         from: 0.1,
//!         to: 0.23,
//!     },
//!     remark: "fitted".to_owned(),
//! };
//! let amended = amend(&Source::new("arm.urdf", urdf), &Options::default(), &[fitted])?;
//! assert!(amended.text.contains(r#"<dynamics damping="0.23"/> <!-- guessed -->"#));
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod editor;
mod urdf;

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Document;

pub(in crate::import) use editor::Editor;
pub(in crate::import) use urdf::scale;

use super::note::Notes;
use super::{Options, mjcf, not_xml, readable};
use realgap_core::confined::on_large_stack;
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// A number of a joint or its servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointQuantity {
    /// Torque against the motion per speed, N m s/rad.
    Viscous,
    /// Dry friction, N m.
    Dry,
    /// Inertia that resists only the motion of the joint, kg m².
    Armature,
    /// Stiffness of the servo, N m/rad.
    ServoStiffness,
    /// Damping of the servo, N m s/rad.
    ServoDamping,
    /// Torque limit of the servo, N m.
    ServoLimit,
}

impl JointQuantity {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Viscous,
        Self::Dry,
        Self::Armature,
        Self::ServoStiffness,
        Self::ServoDamping,
        Self::ServoLimit,
    ];
}

/// Mass properties of a body in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyMass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, metres.
    pub centre_m: Vector3<f64>,
    /// Inertia about the centre of mass, kg m².
    pub inertia_kg_m2: Matrix3<f64>,
}

/// What is changed.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// A number of a joint, by its name in the imported robot: from the value that the import reads to another.
    Joint {
        /// Name of the joint.
        joint: String,
        /// Which number.
        quantity: JointQuantity,
        /// Value that the import of the file gives.
        from: f64,
        /// Value that the import of the amended file is to give.
        to: f64,
    },
    /// The mass properties of a body, by its name in the imported robot.
    Body {
        /// Name of the body.
        body: String,
        /// Those that the import of the file gives.
        from: BodyMass,
        /// Those that the import of the amended file is to give.
        to: BodyMass,
    },
    /// The magnitude of gravity, m/s².
    Gravity(f64),
    /// A field of an MJCF by its own name, in MuJoCo's units (radians): `joint.elbow.damping`, `geom.*.friction`,
    /// `option.timestep`; `*` stands for any letters.
    Field {
        /// The name.
        name: String,
        /// The value.
        to: f64,
    },
}

/// One change, and the comment that is put before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Amendment {
    /// What is changed.
    pub target: Target,
    /// The comment.
    pub remark: String,
}

/// A number that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Line in the file as it was, from 1.
    pub line: usize,
    /// The element: `joint elbow`.
    pub element: String,
    /// The attribute.
    pub attribute: String,
    /// Its text before; `None` where the file left it to a default.
    pub before: Option<String>,
    /// Its text now.
    pub now: String,
}

/// The text of a file after its changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Amended {
    /// The text.
    pub text: String,
    /// Of each amendment what was written, or why the file cannot say it.
    pub outcomes: Vec<Outcome>,
}

/// What was written for an amendment, or why the file cannot say it.
pub type Outcome = std::result::Result<Vec<Written>, String>;

/// Changes single numbers of a URDF or an MJCF.
///
/// # Errors
/// As [`import`](super::import). A change that the file cannot express is no error, but an [`Outcome`].
pub fn amend(source: &Source, options: &Options, amendments: &[Amendment]) -> Result<Amended> {
    on_large_stack(|| amended(source, options, amendments)).unwrap_or_else(|mishap| {
        Err(
            Error::invalid(format!("the robot cannot be changed: {mishap}"))
                .at_file(source.path())
                .hint("please report this file: this should never fail in this way"),
        )
    })
}

fn amended(source: &Source, options: &Options, amendments: &[Amendment]) -> Result<Amended> {
    let text = readable(source, &mut Notes::default())?;
    let document = Document::parse(&text).map_err(|error| not_xml(source, &error))?;
    let mut editor = Editor::new(source.text(), &document);
    let outcomes = match document.root_element().tag_name().name() {
        "robot" => urdf::amend(&mut editor, amendments),
        "mujoco" => mjcf::amend(source, &text, options, &mut editor, amendments)?,
        other => {
            let error = Error::invalid("neither a URDF nor an MJCF");
            let error = error.at_file(source.path()).found(format!("<{other}>"));
            return Err(error.allowed("<robot>, <mujoco>"));
        }
    };
    Ok(Amended {
        text: editor.finish(),
        outcomes,
    })
}

/// Applies one amendment after the other. One that fails halfway leaves nothing behind.
pub(in crate::import) fn each<'t, 'd>(
    editor: &mut Editor<'t, 'd>,
    amendments: &[Amendment],
    one: impl Fn(&mut Editor<'t, 'd>, &Target) -> Outcome,
) -> Vec<Outcome> {
    let apply = |amendment: &Amendment| {
        let before = editor.clone();
        let outcome = one(editor, &amendment.target);
        match &outcome {
            Ok(_) => editor.remark(&amendment.remark),
            Err(_) => *editor = before,
        }
        outcome
    };
    amendments.iter().map(apply).collect()
}

/// The value that an attribute gets so that a sum with it goes from one value to another: exactly the new one where it is the
/// whole sum.
pub(in crate::import) fn shifted(own: f64, from: f64, to: f64) -> std::result::Result<f64, String> {
    let value = if own == from { to } else { own + (to - from) };
    if value < 0.0 {
        return Err(format!(
            "other numbers of the file add {} to it already, more than the fitted {to}",
            from - own
        ));
    }
    Ok(value)
}

/// How many elements stand at each place of the file: more than one where a file makes copies.
pub(in crate::import) fn counted<T: Ord>(all: impl Iterator<Item = T>) -> BTreeMap<T, usize> {
    let mut counts = BTreeMap::new();
    all.for_each(|one| *counts.entry(one).or_default() += 1);
    counts
}
