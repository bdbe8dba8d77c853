//! Meshes as convex hulls, one or several.

use std::path::Path;

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};

use super::note::Notes;
use crate::morphology::Shape;
use crate::morphology::body::{Form, Triple, simplified, uniform};

/// Largest mesh that is read, bytes: a million triangles of binary STL are 50 MB.
const MOST_BYTES: u64 = 64_000_000;
/// A hull that is thinner than this is a plate of this thickness, metres.
const THIN_M: f64 = 1e-3;
/// Corners are written to this many steps a metre.
const STEPS_1_M: f64 = 1e6;

/// A mesh as its file has it.
pub(super) struct Mesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// The vertices, each once.
    pub corners: Vec<Vector3<f64>>,
}

impl Mesh {
    /// Reads a file.
    ///
    /// # Errors
    /// What is wrong with it, as text.
    pub fn read(path: &Path, scale: &Vector3<f64>) -> Result<Self, String> {
        let bytes = std::fs::metadata(path).map_err(|e| e.to_string())?.len();
        if bytes > MOST_BYTES {
            return Err(format!(
                "it has {bytes} bytes, at most {MOST_BYTES} are read"
            ));
        }
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        if !["stl", "obj", "dae"].contains(&ending.to_lowercase().as_str()) {
            return Err(format!("a mesh of the kind `{ending}`"));
        }
        // A crate of somebody else reads a file of somebody else: what it panics on is an error of that file.
        let scene = std::panic::catch_unwind(|| mesh_loader::Loader::default().load(path))
            .map_err(|_| "it cannot be read".to_owned())?
            .map_err(|e| e.to_string())?;
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for mesh in &scene.meshes {
            let before = vertices.len() as u32;
            let all = mesh
                .vertices
                .iter()
                .map(|v| Vector3::from(v.map(f64::from)));
            vertices.extend(all.map(|vertex| vertex.component_mul(scale)));
            triangles.extend((mesh.faces.iter()).map(|face| face.map(|corner| before + corner)));
        }
        Self::of(vertices, triangles)
    }

    /// Of vertices and the triangles between them, which may be none.
    ///
    /// # Errors
    /// What is wrong with it, as text.
    pub fn of(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, String> {
        if !vertices.iter().flatten().all(|v| v.is_finite()) {
            return Err("it has coordinates that are no numbers".to_owned());
        }
        let corners = each_once(vertices.clone());
        if corners.len() < 3 {
            return Err("it is empty".to_owned());
        }
        Ok(Self {
            vertices,
            triangles,
            corners,
        })
    }

    /// Forms that fill it together, at most `most`, and where the frame of each is.
    pub fn forms(
        &self,
        most: usize,
        name: &str,
        line: Option<usize>,
        notes: &mut Notes,
    ) -> Vec<(Form, Vector3<f64>)> {
        let parts = match most > 1 && !self.triangles.is_empty() {
            true => self.parts(most),
            false => Vec::new(),
        };
        match parts.len() {
            0..=1 => vec![hull(&self.corners, name, line, notes)],
            _ => (parts.iter())
                .map(|part| hull(part, name, line, notes))
                .collect(),
        }
    }

    /// The corners of nearly convex parts, by voxels (V-HACD: Mamou and Ghorbel 2009, as Parry has it); none where that fails.
    fn parts(&self, most: usize) -> Vec<Vec<Vector3<f64>>> {
        let points: Vec<Vector> = (self.vertices.iter())
            .map(|p| Vector::new(p.x, p.y, p.z))
            .collect();
        let settings = VHACDParameters {
            max_convex_hulls: most as u32,
            ..VHACDParameters::default()
        };
        // Flat and torn meshes are more than the crate bargains for; their hull stands in.
        let parts = std::panic::catch_unwind(|| {
            VHACD::decompose(&settings, &points, &self.triangles, true)
                .compute_primitive_intersections(&points, &self.triangles)
        });
        (parts.unwrap_or_default().into_iter())
            .map(|part| each_once(part.iter().map(|p| Vector3::new(p.x, p.y, p.z)).collect()))
            .filter(|part| part.len() >= 4)
            .collect()
    }
}

/// Points in an order of their own, each once.
fn each_once(mut points: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    points.sort_by(|a, b| {
        let pairs = a.iter().zip(b.iter());
        pairs
            .map(|(a, b)| a.total_cmp(b))
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    points.dedup_by_key(|p| [p.x, p.y, p.z].map(f64::to_bits));
    points
}

/// The hull of corners as a form, in their frame, and where the form's frame is.
fn hull(
    points: &[Vector3<f64>],
    name: &str,
    line: Option<usize>,
    notes: &mut Notes,
) -> (Form, Vector3<f64>) {
    let low = points.iter().fold(points[0], |low, point| low.inf(point));
    let high = points.iter().fold(points[0], |high, point| high.sup(point));
    let (sides_m, middle_m) = (high - low, (low + high) / 2.0);
    let (corners, beyond_m) = simplified(points);
    if beyond_m > 0.01 * sides_m.max() {
        notes.changed(
            line,
            format!(
                "the hull of the mesh {name} has {} corners of {}; the mesh reaches up to {:.1} mm beyond",
                corners.len(),
                points.len(),
                1e3 * beyond_m
            ),
            "give it a collision shape of its own where that matters",
        );
    }
    let round = |x: f64| (x * STEPS_1_M).round() / STEPS_1_M;
    let rounded = |v: &Vector3<f64>| -> Triple { (round(v.x), round(v.y), round(v.z)) };
    let corners: Vec<Triple> = corners.iter().map(rounded).collect();
    let as_shape = Shape::Hull {
        points_m: corners
            .iter()
            .map(|&(x, y, z)| Vector3::new(x, y, z))
            .collect(),
    };
    if sides_m.min() < THIN_M || corners.len() < 4 || uniform(&as_shape).is_none() {
        notes.doubt(
            line,
            format!(
                "the mesh {name} is flat: a plate of {} mm stands in",
                1e3 * THIN_M
            ),
            "give it a thickness, or a box as collision shape",
        );
        let sides_m = sides_m.sup(&Vector3::repeat(THIN_M));
        return (
            Form::Box {
                sides_m: (sides_m.x, sides_m.y, sides_m.z),
            },
            middle_m,
        );
    }
    (Form::Hull { points_m: corners }, Vector3::zeros())
}
