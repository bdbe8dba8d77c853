//! Shapes of solids: mass properties, surfaces, meshes and convex hulls. All lengths are in metres.

mod hull;
mod mass;
mod mesh;
mod shape;
mod surface;

pub use hull::{MAX_CORNERS, bounds, convex_hull, ellipsoid, simplified, solid_surface};
pub use mass::{UniformMass, uniform};
pub use mesh::Mesh;
pub use shape::Shape;
pub use surface::{Facet, Surface};
