//! Triangle meshes, and their decomposition into nearly convex parts.

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};

/// A triangle mesh, as its file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// The vertices without duplicates.
    pub corners: Vec<Vector3<f64>>,
}

impl Mesh {
    /// A mesh of these vertices and the triangles between them; there may be no triangles.
    ///
    /// # Errors
    /// The reason why the mesh is unusable, as text.
    pub fn of(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, String> {
        if !vertices.iter().flatten().all(|v| v.is_finite()) {
            return Err("it has coordinates that are not finite numbers".to_owned());
        }
        if triangles
            .iter()
            .flatten()
            .any(|&at| at as usize >= vertices.len())
        {
            return Err("a triangle names a corner that the mesh does not have".to_owned());
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
