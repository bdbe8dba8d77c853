//! Import of robots from URDF and MJCF files.
//!
//! Everything that the import leaves out, changes or assumes, and everything that looks wrong, is reported as a [`Note`] with its
//! line and a remedy. URDF values are read by this module and not by the crate `urdf-rs`, because that crate reports no line
//! numbers, silently fills in missing values, and refuses files that simulators accept (docs/robots.md). MJCF is compiled
//! as MuJoCo compiles it (docs/validation/compiled.md).
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_robot::import::{Options, import};
//! use realgap_robot::morphology::Morphology;
//!
//! let urdf = r#"<robot name="one"><link name="body">
//!     <inertial><mass value="0.3"/></inertial>
//!     <collision><geometry><sphere radius="0.1"/></geometry></collision>
//! </link></robot>"#;
//! let imported = import(&Source::new("one.urdf", urdf), &Options::default())?;
//! assert!(imported.notes[0].what.contains("inertia"));
//! let robot = Morphology::of_bodies(imported.structure)?;
//! assert_eq!(robot.name(), "one");
//! # Ok::<(), realgap_core::Error>(())
//! ```

pub mod amendment;
mod assumption;
mod driven;
mod element;
mod mesh;
mod mesh_file;
mod mjcf;
mod note;
mod package;
mod tidy;
mod urdf;
mod urdf_joint;
mod urdf_link;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::Document;

pub use assumption::AssumedLaw;
pub use note::{Note, NoteKind};

use crate::morphology::body::{MAX_BODIES, Structure};
use note::Notes;
use realgap_core::confined::on_large_stack;
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, XmlLimits, measure_xml};

/// The largest sizes of a robot's XML: a body may lie in each of the bodies before it, in a few elements around all.
const ROBOT: XmlLimits = XmlLimits {
    depth: MAX_BODIES + 24,
    elements: 200_000,
    attributes: 256,
};
/// The largest number of shapes of a robot.
const MOST_SHAPES: usize = 20_000;

/// Refuses a robot with more of something than is read.
fn refuse_count(what: &str, found: usize, most: usize) -> Result<()> {
    if found <= most {
        return Ok(());
    }
    Err(Error::invalid(format!("a robot with too many {what}"))
        .found(found)
        .allowed(format!("at most {most}")))
}

/// Settings of an import, in addition to the robot's file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Folders of ROS packages by name: the places that `package://NAME/` refers to.
    pub packages: Vec<(String, PathBuf)>,
    /// Whether the root is fixed to the world, even if the file does not say so.
    pub mounted: bool,
    /// Whether a root that is held is lifted so high that no posture reaches the floor.
    pub lifted: bool,
    /// Whether joints stay passive for which a URDF states only the limits of a servo.
    pub passive: bool,
    /// The control law that is assumed for servos of which a URDF states only the limits.
    pub law: AssumedLaw,
    /// Joints that recordings command, each with the law of its servo: it replaces `law`, and a joint without a servo gets one.
    pub driven: BTreeMap<String, AssumedLaw>,
    /// Joints whose firmware turns commanded angles into torques, each with its gains: they replace the law of its servo, and a joint
    /// without a servo gets one.
    pub gains: BTreeMap<String, PositionGains>,
    /// The keyframe of an MJCF in which joints start; `home`, or the only one, if none is asked for.
    pub keyframe: Option<String>,
    /// Largest number of convex hulls into which a mesh is split; with 0 or 1 the mesh is replaced by its convex hull.
    pub hulls: usize,
}

/// The gains of a position loop: torque = stiffness · (command − angle) − damping · speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionGains {
    /// Proportional gain, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Derivative gain, N m s/rad.
    pub damping_nm_s_rad: f64,
}

/// A robot from another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The robot.
    pub structure: Structure,
    /// Notes on everything that was left out, changed or assumed or that looks wrong, sorted by line.
    pub notes: Vec<Note>,
    /// Lines in the file of bodies and joints, by their path in the structure, e.g. `bodies[0]` and `joints[2]`; empty if the
    /// lines are unknown.
    pub lines: BTreeMap<String, usize>,
}

/// Whether the extension of a file is that of a URDF or MJCF file, or of a file that can be turned into one.
pub fn is_foreign(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        ["urdf", "xml", "mjcf", "xacro", "sdf"]
            .contains(&ending.to_string_lossy().to_lowercase().as_str())
    })
}

/// Reads a URDF or an MJCF; meshes and included files are searched for relative to the path of the source.
///
/// # Errors
/// Text that is neither URDF nor MJCF; links that do not form a tree; physically impossible values. Every error names the file
/// and, if it is known, the line.
pub fn import(source: &Source, options: &Options) -> Result<Imported> {
    // Bodies may be nested as deep as a robot may be large, and the reader calls itself for each.
    on_large_stack(|| read(source, options)).unwrap_or_else(|mishap| {
        Err(
            Error::invalid(format!("the robot cannot be imported: {mishap}"))
                .at_file(source.path())
                .hint("please report this file: an import should never fail in this way"),
        )
    })
}

fn read(source: &Source, options: &Options) -> Result<Imported> {
    let mut notes = Notes::default();
    let text = readable(source, &mut notes)?;
    let document = Document::parse(&text).map_err(|error| not_xml(source, &error))?;
    let root = document.root_element();
    let ends = element::line_ends(&text);
    let place = element::XmlSource {
        source,
        ends: &ends,
    };
    refuse_xacro(place, root)?;
    let mut lines = BTreeMap::new();
    let mut structure = match root.tag_name().name() {
        "robot" => urdf::read(place, root, options, &mut notes, &mut lines)?,
        "mujoco" => mjcf::read(source, &text, options, &mut notes)?,
        other => {
            let hint = match other {
                "sdf" => {
                    "an SDF is turned into a URDF by the converter of its makers: gz sdf -p FILE.sdf checks it and writes it in full, and `sdformat_urdf` or MuJoCo's `sdf2mjcf` converts it"
                }
                "mujocoinclude" => {
                    "this file is a part that others include: read the file that includes it"
                }
                _ => "URDF begins with <robot>, MJCF with <mujoco>",
            };
            let error = Error::invalid("neither a URDF nor an MJCF")
                .found(format!("<{other}>"))
                .allowed("<robot>, <mujoco>")
                .hint(hint);
            return Err(place.at(root, error));
        }
    };
    tidy::tidy(&mut structure, options, &mut notes);
    Ok(Imported {
        structure,
        notes: notes.sorted(),
        lines,
    })
}

/// Refuses a URDF with macros: its elements would be left out, and the rest would be another robot.
fn refuse_xacro(place: element::XmlSource<'_>, root: roxmltree::Node<'_, '_>) -> Result<()> {
    // `readable` replaces the colon of a prefix that is not declared.
    let is_macro = |node: &roxmltree::Node<'_, '_>| {
        let tag = node.tag_name();
        let is_declared = tag.namespace().is_some_and(|space| space.contains("xacro"));
        node.is_element() && (is_declared || tag.name().starts_with("xacro_"))
    };
    let Some(node) = root.descendants().find(is_macro) else {
        return Ok(());
    };
    let error = Error::invalid("the file contains macros of xacro")
        .found(format!("<{}>", node.tag_name().name()))
        .allowed("a URDF whose macros are expanded")
        .hint("expand it: `xacro FILE.xacro > FILE.urdf`, a program of ROS (also `pip install xacro`)");
    Err(place.at(node, error))
}

/// The text with its comments replaced by blanks: many comments contain `--`, which XML forbids and other readers accept.
fn without_comments(text: &str) -> String {
    let (mut bare, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(start) = rest.find("<!--") {
        let Some(end) = rest[start + 4..].find("-->").map(|end| start + 4 + end + 3) else {
            break;
        };
        bare.push_str(&rest[..start]);
        bare.push_str(&blank(&rest[start..end]));
        rest = &rest[end..];
    }
    bare + rest
}

/// As many blanks as a text has bytes, in the same lines.
fn blank(text: &str) -> String {
    let blank = |byte| if byte == b'\n' { '\n' } else { ' ' };
    text.bytes().map(blank).collect()
}

/// The text as strict XML: errors that other readers of URDF accept are repaired without moving any byte of an element to another place.
fn readable(source: &Source, notes: &mut Notes) -> Result<String> {
    let mut text = without_comments(source.text());
    measure_xml(&text, ROBOT).map_err(|error| error.at_file(source.path()))?;
    if let Some(at) = text.find("<!DOCTYPE")
        && let Some(length) = text[at..].find(['>', '['])
        && text[at + length..].starts_with('>')
    {
        let instead = blank(&text[at..=at + length]);
        text.replace_range(at..=at + length, &instead);
        notes.left_out(None, "the document type", "remove <!DOCTYPE ...>");
    }
    if let Some(at) = text.find("<?xml").filter(|at| *at > 0)
        && let Some(length) = text[at..].find("?>")
    {
        // XML allows a declaration only at the very beginning of the text.
        text.replace_range(at..at + length + 2, &" ".repeat(length + 2));
        notes.changed(
            None,
            "the XML declaration is not at the beginning of the file",
            "move it to the first line",
        );
    }
    const END: &str = "</robot>";
    if let Some(end) = text.rfind(END).map(|at| at + END.len())
        && !text[end..].trim().is_empty()
    {
        text.truncate(end);
        notes.changed(None, "the text after </robot> is not XML", "remove it");
    }
    // Each iteration repairs one undeclared namespace prefix.
    for _ in 0..32 {
        match Document::parse(&text) {
            Err(roxmltree::Error::UnknownNamespace(prefix, place)) if !prefix.is_empty() => {
                let line = place.row as usize;
                notes.changed(
                    Some(line),
                    format!("the namespace prefix `{prefix}:` is not declared"),
                    "declare it with xmlns, or leave these elements out",
                );
                for (old, new) in [("<", "<"), ("</", "</"), (" ", " ")] {
                    text = text.replace(&format!("{old}{prefix}:"), &format!("{new}{prefix}_"));
                }
            }
            Ok(_) => return Ok(text),
            Err(error) => return Err(not_xml(source, &error)),
        }
    }
    Ok(text)
}

fn not_xml(source: &Source, error: &roxmltree::Error) -> Error {
    let place = error.pos();
    let hint = match error {
        roxmltree::Error::DtdDetected => {
            "entities are not expanded here: xmllint --noent FILE writes the file without them"
        }
        _ if source.text().starts_with("version https://git-lfs") => {
            "this is a pointer of Git LFS: `git lfs pull` fetches the file itself"
        }
        _ => "run `xmllint FILE` for details",
    };
    Error::invalid(format!("not XML: {error}"))
        .at_file(source.path())
        .at_line(place.row as usize, place.col as usize)
        .hint(hint)
}
