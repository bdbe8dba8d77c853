//! Conversion of meshes into one or several convex hulls.

use nalgebra::Vector3;

use super::note::Notes;
use crate::morphology::body::{Form, Triple};
use realgap_core::confined::quietly;
use realgap_solid::{Mesh, Shape, bounds, simplified, uniform};

/// A hull that is thinner than this is replaced by a plate of this thickness, metres.
const THIN_M: f64 = 1e-3;
/// Corners are rounded to this many steps per metre.
const STEPS_1_M: f64 = 1e6;

/// The shapes, at most `most`, that approximate a mesh together, and the position of each shape's frame, metres.
pub(super) fn forms(
    mesh: &Mesh,
    most: usize,
    name: &str,
    line: Option<usize>,
    notes: &mut Notes,
) -> Vec<(Form, Vector3<f64>)> {
    // The decomposition may panic on torn meshes; the hull of the whole mesh is used then.
    let parts = quietly(|| mesh.parts(most)).unwrap_or_default();
    match parts.len() {
        0..=1 => vec![hull(&mesh.corners, name, line, notes)],
        _ => (parts.iter())
            .map(|part| hull(part, name, line, notes))
            .collect(),
    }
}

/// The convex hull of points as a shape, and the position of the shape's frame, metres.
fn hull(
    points: &[Vector3<f64>],
    name: &str,
    line: Option<usize>,
    notes: &mut Notes,
) -> (Form, Vector3<f64>) {
    let [low, high] = bounds(points);
    let (sides_m, middle_m) = (high - low, (low + high) / 2.0);
    let (corners, beyond_m) = simplified(points);
    if beyond_m > 0.01 * sides_m.max() {
        notes.changed(
            line,
            format!(
                "the hull of the mesh {name} keeps {} of {} corners; the mesh extends up to {:.1} mm beyond the hull",
                corners.len(),
                points.len(),
                1e3 * beyond_m
            ),
            "state a collision shape for this link if that distance matters",
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
                "the mesh {name} is flat: it is replaced by a plate of {} mm",
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
