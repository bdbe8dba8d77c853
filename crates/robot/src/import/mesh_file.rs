//! Reads the file of a mesh (STL, OBJ or Collada) with the crate `mesh-loader`, in a confined place.
//!
//! The crate believes the counts that a file states: it reserves memory for them, and indexes by them. Everything that could make it
//! take memory or time beyond the size of the file is therefore checked before; what is left ends in an error, not in a panic.

use std::io;
use std::path::Path;

use mesh_loader::{Loader, Scene};
use nalgebra::Vector3;
use realgap_core::confined::{self, PATIENCE};
use realgap_core::file::{XmlLimits, measure_xml, read_regular};
use realgap_solid::Mesh;
use roxmltree::{Document, Node};

use super::element::children;

/// The size of the largest mesh that is read, bytes: a million triangles of binary STL are 50 MB.
const MAX_BYTES: u64 = 64_000_000;
/// The largest sizes of a Collada file: a mesh has few elements with long texts.
const COLLADA: XmlLimits = XmlLimits {
    depth: 256,
    elements: 200_000,
    attributes: 256,
};
/// Bytes of a binary STL before its triangles, and of each triangle.
const STL_BYTES: (usize, usize) = (84, 50);

/// Reads a mesh from a file, and multiplies its coordinates by `scale`.
///
/// # Errors
/// The reason why the file cannot be read, as text.
pub(super) fn read(path: &Path, scale: &Vector3<f64>) -> Result<Mesh, String> {
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    if !["stl", "obj", "dae"].contains(&ending.as_str()) {
        return Err(format!("`{ending}` is no supported file format of meshes"));
    }
    of_bytes(&ending, bytes(path)?, scale)
}

/// The bytes of a mesh's file.
///
/// # Errors
/// The reason why the file cannot be read, as text.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    read_regular(path, MAX_BYTES, "mesh").map_err(|error| in_one_line(&error))
}

/// The mesh of a file's bytes; `ending` is the lower-case extension of its name.
fn of_bytes(ending: &str, bytes: Vec<u8>, scale: &Vector3<f64>) -> Result<Mesh, String> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for mesh in scene(ending, bytes)?.meshes {
        let (before, own) = (vertices.len() as u32, mesh.vertices.len() as u32);
        let all = mesh
            .vertices
            .iter()
            .map(|v| Vector3::from(v.map(f64::from)));
        vertices.extend(all.map(|vertex| vertex.component_mul(scale)));
        for face in mesh.faces {
            if face.iter().any(|corner| *corner >= own) {
                return Err("a triangle names a corner that the mesh does not have".to_owned());
            }
            triangles.push(face.map(|corner| before + corner));
        }
    }
    Mesh::of(vertices, triangles)
}

/// The error without the hint, in one line: it becomes part of a note.
fn in_one_line(error: &realgap_core::Error) -> String {
    let text = error.to_string();
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("hint:"));
    let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
    words.join(" ")
}

/// The scene of a file's bytes.
fn scene(ending: &str, bytes: Vec<u8>) -> Result<Scene, String> {
    // The loader chooses the format by the name. It must not see the folder: it would search there for materials.
    let name = format!("mesh.{ending}");
    let is_collada = ending == "dae";
    if ending == "stl" {
        check_stl(&bytes)?;
    }
    confined::within(PATIENCE, move || {
        if is_collada {
            check_collada(&bytes)?;
        }
        // Materials are not used, and an OBJ could name any file as one.
        let nothing = |_: &Path| -> io::Result<Vec<u8>> { Ok(Vec::new()) };
        Loader::default()
            .load_from_slice_with_reader(&bytes, &name, nothing)
            .map_err(|error| error.to_string().replace(&format!("{name}:"), "line "))
    })
    .unwrap_or_else(|mishap| Err(mishap.to_string()))
}

/// Refuses a binary STL that ends before its last triangle: its hull would be that of a part only.
fn check_stl(bytes: &[u8]) -> Result<(), String> {
    let (head, each) = STL_BYTES;
    let starts_as_text = bytes.trim_ascii_start().starts_with(b"solid");
    let Some(count) = bytes.get(head - 4..head).filter(|_| !starts_as_text) else {
        return Ok(());
    };
    let stated = count
        .iter()
        .rev()
        .fold(0, |sum, byte| 256 * sum + usize::from(*byte));
    let there = (bytes.len() - head) / each;
    if stated > there {
        return Err(format!(
            "its header states {stated} triangles, and the file has {there}: it is incomplete or broken"
        ));
    }
    Ok(())
}

/// Refuses a Collada file that states more values than it can contain.
fn check_collada(bytes: &[u8]) -> Result<(), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())?;
    measure_xml(text, COLLADA).map_err(|error| in_one_line(&error))?;
    let document = Document::parse(text).map_err(|error| format!("it is not XML: {error}"))?;
    for node in document.descendants().filter(Node::is_element) {
        // Each value takes a digit and a blank.
        let most = bytes.len() as u64;
        let refuse = |what: &str, found: u64| {
            let place = document.text_pos_at(node.range().start);
            let tag = node.tag_name().name();
            Err(format!(
                "line {}: <{tag}> states {found} {what}, more than its {most} bytes can contain",
                place.row
            ))
        };
        let number = |node: Node<'_, '_>, name| -> u64 {
            node.attribute(name)
                .and_then(|text| text.trim().parse().ok())
                .unwrap_or(0)
        };
        let count = number(node, "count");
        if count > most {
            return refuse("values", count);
        }
        let inside = |name| children(node, name);
        let corners: u64 = match node.tag_name().name() {
            "polylist" => inside("vcount")
                .flat_map(|list| list.text().unwrap_or_default().split_whitespace())
                .map(|word| word.parse().unwrap_or(0_u64))
                .fold(0, u64::saturating_add),
            "triangles" => 3 * count,
            "lines" => 2 * count,
            _ => continue,
        };
        let stride = inside("input").map(|input| number(input, "offset")).max();
        let indices = corners.saturating_mul(1 + stride.unwrap_or(0));
        if indices > most {
            return refuse("indices", indices);
        }
    }
    Ok(())
}
