//! Shapes of solids: their masses, their surfaces, meshes and hulls of these. Lengths are metres.

mod hull;
mod mass;
mod mesh;
mod shape;
mod surface;

pub use hull::{MOST_CORNERS, bounds, convex_hull, ellipsoid, simplified, solid_surface};
pub use mass::{UniformMass, uniform};
pub use mesh::Mesh;
pub use shape::Shape;
pub use surface::{Facet, Surface};
