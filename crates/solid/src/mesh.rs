//! Meshes: read, and parted into what is nearly convex.

use std::path::Path;

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};

/// Largest mesh that is read, bytes: a million triangles of binary STL are 50 MB.
const MOST_BYTES: u64 = 64_000_000;

/// A mesh as its file has it.
pub struct Mesh {
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

    /// The corners of nearly convex parts, by voxels (V-HACD: Mamou and Ghorbel 2009, as Parry has it); none where that fails,
    /// or where no more than one is wanted.
    pub fn parts(&self, most: usize) -> Vec<Vec<Vector3<f64>>> {
        if most <= 1 || self.triangles.is_empty() {
            return Vec::new();
        }
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
