//! Meshes of an MJCF: their mass as MuJoCo computes it, and the primitives that are fitted to them.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use super::super::Options;
use super::super::mesh_file;
use super::super::package::locate;
use super::element::Element;
use super::model::{GeomType, Origin};
use super::principal::{principal, stored};
use realgap_solid::{Mesh, Shape, UniformMass, uniform};

/// How a mesh gets its mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Filling {
    /// The sum of the unsigned volumes of pyramids over the faces.
    Legacy,
    /// The sum of their signed volumes.
    Exact,
    /// The convex hull.
    Convex,
    /// The surface.
    Shell,
}

/// A mesh in the frame of its asset, and its mass at unit density.
pub(super) struct Solid {
    pub mesh: Mesh,
    pub mass: UniformMass,
}

/// Reads a mesh asset; the error says why it cannot be used.
pub(super) fn read(
    asset: &Element,
    origin: &Origin,
    main: &Path,
    options: &Options,
) -> Result<Solid, String> {
    let text = |error: realgap_core::Error| error.to_string();
    if asset.get("builtin").is_some_and(|kind| kind != "none") {
        return Err("generated meshes (builtin) are not supported".to_owned());
    }
    let (mut vertices, mut triangles) = match asset.get("vertex") {
        Some(_) => (inline(asset).map_err(text)?, Vec::new()),
        None => file(asset, origin, main, options)?,
    };
    if asset.get("face").is_some() {
        let list = asset.list("face").map_err(text)?;
        triangles = list
            .chunks_exact(3)
            .map(|f| [f[0] as u32, f[1] as u32, f[2] as u32])
            .collect();
    }
    if (triangles.iter().flatten()).any(|corner| *corner as usize >= vertices.len()) {
        return Err("a face refers to a vertex that does not exist".to_owned());
    }
    let place = asset.vector("refpos").map_err(text)?;
    let turn = match asset.numbers::<4>("refquat").map_err(text)? {
        Some([w, x, y, z]) => {
            UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
        }
        None => UnitQuaternion::identity(),
    };
    let scale = asset
        .numbers::<3>("scale")
        .map_err(text)?
        .map_or(Vector3::repeat(1.0), Vector3::from);
    for vertex in &mut vertices {
        *vertex = (turn.inverse() * (*vertex - place)).component_mul(&scale);
    }
    let filling = match asset.get("inertia") {
        Some("convex") => Filling::Convex,
        Some("exact") => Filling::Exact,
        Some("shell") => Filling::Shell,
        _ => Filling::Legacy,
    };
    let mesh = Mesh::of(vertices, triangles)?;
    let mass = mass(&mesh, filling).ok_or("it has no volume")?;
    Ok(Solid { mesh, mass })
}

/// The vertices that the asset itself states, in single precision as MuJoCo stores them.
fn inline(asset: &Element) -> realgap_core::error::Result<Vec<Vector3<f64>>> {
    let list = asset.list("vertex")?;
    let single = |value: f64| f64::from(value as f32);
    Ok(list
        .chunks_exact(3)
        .map(|p| Vector3::new(p[0], p[1], p[2]).map(single))
        .collect())
}

type Faces = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

fn file(asset: &Element, origin: &Origin, main: &Path, options: &Options) -> Result<Faces, String> {
    let stated = asset.get("file").unwrap_or_default();
    let name = match origin.settings.strip_path {
        true => Path::new(stated)
            .file_name()
            .map(PathBuf::from)
            .unwrap_or_default(),
        false => PathBuf::from(stated),
    };
    let inside = Path::new(&origin.settings.mesh_folder).join(&name);
    let direct = origin.folder.join(&inside);
    let path = match direct.is_file() {
        true => Some(direct),
        false => [inside, name]
            .iter()
            .find_map(|path| locate(&path.to_string_lossy(), main, options)),
    };
    let path = path.ok_or_else(|| format!("{stated} cannot be found"))?;
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    if ending == "msh" {
        return binary(&path);
    }
    let mesh = mesh_file::read(&path, &Vector3::repeat(1.0))?;
    let (vertices, triangles) = mesh.faces();
    Ok((vertices.to_vec(), triangles.to_vec()))
}

/// A mesh in MuJoCo's own binary format: four counts (vertices, normals, texture coordinates, faces) and the numbers, all of 4 bytes.
fn binary(path: &Path) -> Result<Faces, String> {
    let bytes = mesh_file::bytes(path)?;
    let words: Vec<[u8; 4]> = (bytes.chunks_exact(4))
        .filter_map(|w| w.try_into().ok())
        .collect();
    let count = |index: usize| {
        let word = words.get(index).map(|word| i32::from_le_bytes(*word));
        word.and_then(|count| usize::try_from(count).ok())
            .ok_or("it is broken".to_owned())
    };
    let (vertices, normals, texture, faces) = (count(0)?, count(1)?, count(2)?, count(3)?);
    let place = |from: usize, length: usize| {
        let end = from.checked_add(length).ok_or("it is broken")?;
        words.get(from..end).ok_or("it ends too early")
    };
    let start = normals
        .checked_mul(3)
        .and_then(|n| {
            n.checked_add(texture.checked_mul(2)?)?
                .checked_add(vertices.checked_mul(3)?)?
                .checked_add(4)
        })
        .ok_or("it is broken")?;
    let points = place(4, 3 * vertices)?;
    let points = points
        .chunks_exact(3)
        .map(|p| Vector3::new(p[0], p[1], p[2]).map(|word| f64::from(f32::from_le_bytes(word))));
    let faces = place(start, faces.checked_mul(3).ok_or("it is broken")?)?;
    let faces = faces
        .chunks_exact(3)
        .map(|f| [f[0], f[1], f[2]].map(u32::from_le_bytes));
    Ok((points.collect(), faces.collect()))
}

/// A face: its area, its normal and its centre.
fn face([a, b, c]: [Vector3<f64>; 3]) -> (f64, Vector3<f64>, Vector3<f64>) {
    let normal = (b - a).cross(&(c - a));
    let length = normal.norm();
    let centre = (a + b + c) / 3.0;
    match length < 1e-15 {
        true => (0.0, Vector3::zeros(), centre),
        false => (0.5 * length, normal / length, centre),
    }
}

/// The mass of a mesh at unit density: pyramids over its faces, with their tips in the mean of the faces for the centre of mass, and
/// in the centre of mass for volume and inertia.
fn mass(mesh: &Mesh, filling: Filling) -> Option<UniformMass> {
    let hull = || {
        uniform(&Shape::Hull {
            points_m: std::sync::Arc::from(mesh.corners.clone()),
        })
    };
    let (vertices, triangles) = mesh.faces();
    if filling == Filling::Convex || (triangles.is_empty() && filling != Filling::Shell) {
        return hull();
    }
    let corners = |t: &[u32; 3]| t.map(|corner| vertices[corner as usize]);
    let (mut area_m2, mut middle) = (0.0, Vector3::zeros());
    for triangle in triangles {
        let (area, _, centre) = face(corners(triangle));
        area_m2 += area;
        middle += centre * area;
    }
    let middle = middle / area_m2;
    let content = |area: f64, height: f64| match filling {
        Filling::Shell => area,
        Filling::Legacy => (area * height / 3.0).abs(),
        Filling::Exact | Filling::Convex => area * height / 3.0,
    };
    let (mut whole, mut moment) = (0.0, Vector3::zeros());
    for triangle in triangles {
        let (area, normal, centre) = face(corners(triangle));
        let part = content(area, (centre - middle).dot(&normal));
        whole += part;
        moment += part
            * match filling {
                Filling::Shell => centre,
                _ => centre * 0.75 + middle * 0.25,
            };
    }
    let centre_m = moment / whole;
    let (mut content_m3, mut products) = (0.0, Matrix3::zeros());
    for triangle in triangles {
        let points = corners(triangle).map(|point| point - centre_m);
        let (area, normal, centre) = face(points);
        let part = content(area, centre.dot(&normal));
        content_m3 += part;
        let sum = points[0] + points[1] + points[2];
        let squares: Matrix3<f64> = points.iter().map(|p| p * p.transpose()).sum();
        let share = if filling == Filling::Shell {
            12.0
        } else {
            20.0
        };
        products += (squares + sum * sum.transpose()) * (part / share);
    }
    (content_m3 > 1e-15).then(|| UniformMass {
        volume_m3: content_m3,
        centre_m,
        inertia_m5: stored(&(Matrix3::identity() * products.trace() - products)),
    })
}

/// Size and pose (in the mesh's frame) of the primitive that is fitted to a mesh.
pub(super) fn fitted(
    solid: &Solid,
    kind: GeomType,
    origin: &Origin,
    scale: f64,
) -> (Vector3<f64>, Isometry3<f64>) {
    let (moments, turn) = principal(&solid.mass.inertia_m5);
    let pose = Isometry3::from_parts(Translation3::from(solid.mass.centre_m), turn);
    if !origin.settings.fit_box {
        let half = |a: usize, b: usize, c: usize| {
            0.5 * (6.0 * (moments[a] + moments[b] - moments[c]) / solid.mass.volume_m3)
                .max(0.0)
                .sqrt()
        };
        let sides = Vector3::new(half(1, 2, 0), half(0, 2, 1), half(0, 1, 2));
        let radius = 0.5 * (sides.x + sides.y);
        let size = match kind {
            GeomType::Sphere => Vector3::repeat(sides.sum() / 3.0),
            GeomType::Capsule => Vector3::new(radius, (sides.z - 0.5 * radius).max(0.0), 0.0),
            GeomType::Cylinder => Vector3::new(radius, sides.z, 0.0),
            _ => sides,
        };
        return (size * scale, pose);
    }
    let own: Vec<Vector3<f64>> = (solid.mesh.corners.iter())
        .map(|corner| {
            pose.inverse_transform_point(&nalgebra::Point3::from(*corner))
                .coords
        })
        .collect();
    let [low, high] = realgap_solid::bounds(&own);
    let middle = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let radius = half.x.max(half.y);
    let size = match kind {
        GeomType::Sphere => Vector3::repeat(half.max()),
        GeomType::Cylinder => Vector3::new(radius, half.z, 0.0),
        GeomType::Capsule => Vector3::new(radius, half.z - radius, 0.0),
        _ => half,
    };
    (size * scale, pose * Translation3::from(middle))
}
