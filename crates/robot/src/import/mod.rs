//! Robots of other programs: URDF and MJCF.
//!
//! Nothing is dropped unsaid: what was left out, changed, assumed or looks wrong is a [`Note`] with its line and remedy. Values are
//! read here rather than by `urdf-rs`: that crate names no lines, fills in what is missing, and refuses files that simulators take
//! (docs/robots.md). MJCF is read by `mjcf-rs`, which resolves includes, defaults and angles.
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

mod assumption;
mod element;
mod mesh;
mod mjcf;
mod mjcf_actuator;
mod mjcf_mass;
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
pub use note::{Note, Sort};

use crate::morphology::body::Structure;
use note::Notes;
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// What a person says about a robot beside its file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Folders of packages, by name: where `package://NAME/` is.
    pub packages: Vec<(String, PathBuf)>,
    /// Whether the root is held where it is, whatever the file says.
    pub mounted: bool,
    /// Whether joints are left without the servos that URDF gives only the limits of.
    pub passive: bool,
    /// What the servos are that URDF gives only the limits of.
    pub law: AssumedLaw,
    /// Most convex hulls that a mesh becomes; with 0 or 1 it is its own hull.
    pub hulls: usize,
}

/// A robot from another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The robot.
    pub structure: Structure,
    /// What was left out, changed, assumed or looks wrong, by line.
    pub notes: Vec<Note>,
    /// Lines of bodies and joints by their place here, e.g. `bodies[0]` and `joints[2]`; none where nobody knows them.
    pub lines: BTreeMap<String, usize>,
}

/// Whether a file's name says that it is a robot of another program.
pub fn is_foreign(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        ["urdf", "xml", "mjcf"].contains(&ending.to_string_lossy().to_lowercase().as_str())
    })
}

/// Reads a URDF or an MJCF; meshes and included files are looked for around the source's path.
///
/// # Errors
/// Text that is neither; trees that are none; numbers that no robot can have; always with file and, where it is known, line.
pub fn import(source: &Source, options: &Options) -> Result<Imported> {
    let mut notes = Notes::default();
    let text = readable(source, &mut notes)?;
    let document = Document::parse(&text).map_err(|error| not_xml(source, &error))?;
    let root = document.root_element();
    let ends = element::line_ends(&text);
    let place = element::Place {
        source,
        ends: &ends,
    };
    let mut lines = BTreeMap::new();
    let mut structure = match root.tag_name().name() {
        "robot" => urdf::read(place, root, options, &mut notes, &mut lines)?,
        "mujoco" => mjcf::read(place, root, options, &mut notes)?,
        other => {
            let error = Error::invalid("neither a URDF nor an MJCF")
                .found(format!("<{other}>"))
                .allowed("<robot>, <mujoco>")
                .hint("a xacro file is turned into a URDF by: xacro FILE; SDF and mujocoinclude are not read");
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

/// The text with blanks in place of comments: many hold `--`, which XML forbids and other readers forgive.
fn without_comments(text: &str) -> String {
    let (mut bare, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(start) = rest.find("<!--") {
        let Some(end) = rest[start + 4..].find("-->").map(|end| start + 4 + end + 3) else {
            break;
        };
        bare.push_str(&rest[..start]);
        bare.extend(
            rest[start..end]
                .chars()
                .map(|c| if c == '\n' { c } else { ' ' }),
        );
        rest = &rest[end..];
    }
    bare + rest
}

/// The text as strict XML: what other readers of URDF forgive is mended, without moving anything to another line.
fn readable(source: &Source, notes: &mut Notes) -> Result<String> {
    let mut text = without_comments(source.text());
    if let Some(at) = text.find("<!DOCTYPE")
        && let Some(length) = text[at..].find(['>', '['])
        && text[at + length..].starts_with('>')
    {
        text.replace_range(at..=at + length, "");
        notes.left_out(None, "the document type", "remove <!DOCTYPE ...>");
    }
    if let Some(at) = text.find("<?xml").filter(|at| *at > 0)
        && let Some(length) = text[at..].find("?>")
    {
        // A declaration that does not stand at the very beginning is no XML.
        text.replace_range(at..at + length + 2, &" ".repeat(length + 2));
        notes.changed(
            None,
            "the XML declaration does not stand first",
            "move it to the first line",
        );
    }
    const END: &str = "</robot>";
    if let Some(end) = text.rfind(END).map(|at| at + END.len())
        && !text[end..].trim().is_empty()
    {
        text.truncate(end);
        notes.changed(None, "what stands behind </robot> is no XML", "remove it");
    }
    // Each round mends one prefix that nobody declares.
    for _ in 0..32 {
        match Document::parse(&text) {
            Err(roxmltree::Error::UnknownNamespace(prefix, place)) if !prefix.is_empty() => {
                let line = place.row as usize;
                notes.changed(
                    Some(line),
                    format!("the prefix `{prefix}:` is declared nowhere"),
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
        _ => "xmllint FILE says more",
    };
    Error::invalid(format!("not XML: {error}"))
        .at_file(source.path())
        .at_line(place.row as usize, place.col as usize)
        .hint(hint)
}
