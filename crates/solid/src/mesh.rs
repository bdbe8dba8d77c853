//! Reads meshes from files, and decomposes them into nearly convex parts.

use std::path::Path;

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};

/// The size of the largest mesh that is read, bytes: a million triangles of binary STL are 50 MB.
const MAX_BYTES: u64 = 64_000_000;

/// A triangle mesh, as its file describes it.
pub struct Mesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// The vertices without duplicates.
    pub corners: Vec<Vector3<f64>>,
}

impl Mesh {
    /// Reads a mesh from a file, and multiplies its coordinates by `scale`.
    ///
    /// # Errors
    /// The reason why the file cannot be read, as text.
    pub fn read(path: &Path, scale: &Vector3<f64>) -> Result<Self, String> {
        let bytes = std::fs::metadata(path).map_err(|e| e.to_string())?.len();
        if bytes > MAX_BYTES {
            return Err(format!(
                "it has {bytes} bytes; at most {MAX_BYTES} bytes are read"
            ));
        }
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        if !["stl", "obj", "dae"].contains(&ending.to_lowercase().as_str()) {
            return Err(format!("`{ending}` is no supported file format of meshes"));
        }
        // The external crate may panic on a broken file; a panic is reported as an error of the file.
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

    /// A mesh of these vertices and the triangles between them; there may be no triangles.
    ///
    /// # Errors
    /// The reason why the mesh is unusable, as text.
    pub fn of(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, String> {
        if !vertices.iter().flatten().all(|v| v.is_finite()) {
            return Err("it has coordinates that are not finite numbers".to_owned());
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

    /// The vertices and the triangles between them, as the file states them; a mesh of points has no triangles.
    pub fn faces(&self) -> (&[Vector3<f64>], &[[u32; 3]]) {
        (&self.vertices, &self.triangles)
    }

    /// The corners of at most `most` nearly convex parts, by a voxel decomposition (V-HACD: Mamou and Ghorbel 2009, as implemented in
    /// Parry); empty if the decomposition fails, or if only one part is wanted.
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
        // The crate may panic on flat or torn meshes; then there are no parts, and the caller uses the hull of the whole mesh.
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

/// The points sorted by their coordinates, without duplicates.
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
