//! Conversion of masses and shapes of MJCF bodies.

use std::path::PathBuf;
use std::sync::Arc;

use mjcf_rs::Model;
use mjcf_rs::body::{Body as Given, Geom, GeomType, InertiaSpec};
use mjcf_rs::compiler::InertiaFromGeom;
use nalgebra::{
    Isometry3, Matrix3, Quaternion, SymmetricEigen, Translation3, UnitQuaternion, Vector3,
};

use super::Options;
use super::mesh::forms;
use super::mesh_file;
use super::note::Notes;
use super::package::locate;
use crate::morphology::Shape;
use crate::morphology::body::{Body, Form, Structure, Tensor, UniformMass, uniform};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;
use realgap_solid::Mesh;

/// Density of a shape that states neither mass nor density, kg/m³.
const DENSITY_KG_M3: f64 = 1000.0;

/// Computes masses and shapes of the bodies of a model.
pub(super) struct MassReader<'a> {
    pub model: &'a Model,
    pub source: &'a Source,
    pub options: &'a Options,
}

/// A shape and its pose in the body's frame.
type Posed = (Form, Isometry3<f64>);

impl MassReader<'_> {
    /// Sets mass, centre of mass and inertia of a body: as the file states them, or those of the shapes.
    pub fn weigh(&self, body: &mut Body, given: &Given, notes: &mut Notes) -> Result<()> {
        let from_geoms = self.model.compiler.inertia_from_geom == InertiaFromGeom::True;
        if let Some(inertial) = given.inertial.as_ref().filter(|_| !from_geoms) {
            let pose = isometry(&inertial.pose);
            let own = match inertial.inertia {
                InertiaSpec::Diagonal([x, y, z]) => Matrix3::from_diagonal(&Vector3::new(x, y, z)),
                InertiaSpec::Full([xx, yy, zz, xy, xz, yz]) => {
                    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
                }
            };
            let least = SymmetricEigen::new(own).eigenvalues.min();
            let is_sound = inertial.mass >= 0.0
                && inertial.mass.is_finite()
                && (inertial.mass == 0.0 || least > 0.0);
            if !is_sound {
                return Err(Error::invalid(format!(
                    "mass and inertia of `{}` are physically impossible",
                    body.name
                ))
                .found(format!(
                    "{} kg, smallest moment {least:e} kg m^2",
                    inertial.mass
                ))
                .allowed("a mass and moments above 0"));
            }
            let turn = pose.rotation.to_rotation_matrix();
            let t = pose.translation.vector;
            body.mass_kg = inertial.mass;
            body.centre_of_mass_m = Some((t.x, t.y, t.z));
            body.inertia_kg_m2 =
                (inertial.mass > 0.0).then(|| Tensor::of(&(turn * own * turn.transpose())));
            return Ok(());
        }
        let mut pieces = Vec::new();
        for geom in &given.geoms {
            pieces.extend(self.heavy(geom, &body.name, notes)?);
        }
        let (mass_kg, centre_m, inertia) = UniformMass::together(&pieces);
        if mass_kg > 0.0 {
            body.mass_kg = mass_kg;
            body.centre_of_mass_m = Some((centre_m.x, centre_m.y, centre_m.z));
            body.inertia_kg_m2 = Some(Tensor::of(&inertia));
        }
        Ok(())
    }

    /// Mass properties of a shape at unit density, and its density, kg/m³. They are exact even if the collision shape is a hull
    /// of few points.
    fn heavy(
        &self,
        geom: &Geom,
        body: &str,
        notes: &mut Notes,
    ) -> Result<Option<(UniformMass, f64)>> {
        let (size, pose) = sized(geom);
        let exact = match geom.type_ {
            GeomType::Ellipsoid => {
                let volume_m3 = 4.0 / 3.0 * std::f64::consts::PI * size.product();
                let squares = size.component_mul(&size) * (volume_m3 / 5.0);
                let moments = Vector3::repeat(squares.sum()) - squares;
                Some((
                    UniformMass {
                        volume_m3,
                        centre_m: Vector3::zeros(),
                        inertia_m5: Matrix3::from_diagonal(&moments),
                    },
                    pose,
                ))
            }
            GeomType::Mesh => self.mesh(geom, body, notes).and_then(|mesh| {
                let shape = Shape::Hull {
                    points_m: Arc::from(mesh.corners),
                };
                Some((uniform(&shape)?, pose))
            }),
            _ => (self.pieces(geom, body, notes).first())
                .and_then(|(form, pose)| Some((uniform(&form.shape().0)?, *pose))),
        };
        let Some((mass, pose)) = exact else {
            return Ok(None);
        };
        let density = match (geom.mass, geom.density) {
            (Some(mass_kg), _) => mass_kg / mass.volume_m3,
            (None, density) => density.unwrap_or(DENSITY_KG_M3),
        };
        if !density.is_finite() || density < 0.0 {
            return Err(Error::invalid(format!(
                "a shape of `{body}` has a negative or non-finite mass or density"
            ))
            .found(density));
        }
        Ok(Some((mass.posed(&pose), density)))
    }

    /// Collision shapes of a geom: several for a mesh that is split into parts, none for an unsupported geom.
    pub fn pieces(&self, geom: &Geom, body: &str, notes: &mut Notes) -> Vec<Posed> {
        let (size, pose) = sized(geom);
        let (radius_m, length_m) = (size.x, 2.0 * size.y);
        let form = match geom.type_ {
            GeomType::Sphere => Form::Sphere { radius_m },
            GeomType::Capsule => Form::Capsule { radius_m, length_m },
            GeomType::Cylinder => Form::Cylinder { radius_m, length_m },
            GeomType::Box => Form::Box {
                sides_m: (2.0 * size.x, 2.0 * size.y, 2.0 * size.z),
            },
            GeomType::Ellipsoid => Form::Ellipsoid {
                radii_m: (size.x, size.y, size.z),
            },
            GeomType::Mesh => {
                let Some(mesh) = self.mesh(geom, body, notes) else {
                    return Vec::new();
                };
                let name = geom.mesh.clone().unwrap_or_default();
                let forms = forms(&mesh, self.options.hulls, &name, None, notes);
                let posed = forms.into_iter();
                return posed
                    .map(|(form, middle_m)| (form, pose * Translation3::from(middle_m)))
                    .collect();
            }
            GeomType::Plane | GeomType::Hfield | GeomType::Sdf => {
                let what = format!("a plane, height field or distance field of `{body}`");
                notes.left_out(None, what, "use boxes");
                return Vec::new();
            }
        };
        if form.shape().0.half_extents_m().min() <= 0.0 {
            notes.left_out(
                None,
                format!("a shape of `{body}` without size"),
                "state its size",
            );
            return Vec::new();
        }
        vec![(form, pose)]
    }

    /// The mesh of a shape.
    fn mesh(&self, geom: &Geom, body: &str, notes: &mut Notes) -> Option<Mesh> {
        let name = geom.mesh.clone().unwrap_or_default();
        let mut doubt = |why: String| {
            notes.doubt(
                None,
                format!("the mesh `{name}` of `{body}` is not used: {why}"),
                "STL and OBJ in metres are read",
            );
        };
        let Some(mesh) = self.model.assets.mesh(&name) else {
            doubt("no asset has this name".to_owned());
            return None;
        };
        let scale = Vector3::from(mesh.scale);
        if let Some(vertices) = &mesh.inline_vertices {
            let points = vertices.chunks_exact(3);
            let vertices = points.map(|p| Vector3::new(p[0], p[1], p[2]).component_mul(&scale));
            return Mesh::of(vertices.collect(), Vec::new()).map_err(doubt).ok();
        }
        let file = mesh.file.clone().unwrap_or_default();
        let compiler = &self.model.compiler;
        let folders = [
            compiler.mesh_dir.as_ref(),
            compiler.asset_dir.as_ref(),
            None,
        ];
        let found = folders.into_iter().find_map(|folder| {
            let named: PathBuf = folder.map_or_else(PathBuf::new, PathBuf::from).join(&file);
            locate(&named.to_string_lossy(), self.source.path(), self.options)
        });
        let Some(path) = found else {
            doubt(format!("{file} cannot be found"));
            return None;
        };
        mesh_file::read(&path, &scale).map_err(doubt).ok()
    }

    /// Applies the compiler's settings for masses (boundmass, boundinertia, settotalmass) to the finished robot.
    pub fn finish(&self, structure: &mut Structure, notes: &mut Notes) {
        let compiler = &self.model.compiler;
        let moves = |body: &Body| body.mass_kg > 0.0;
        for body in structure.bodies.iter_mut().filter(|body| moves(body)) {
            body.mass_kg = body.mass_kg.max(compiler.bound_mass);
            if let Some(tensor) = &mut body.inertia_kg_m2 {
                for moment in [&mut tensor.xx, &mut tensor.yy, &mut tensor.zz] {
                    *moment = moment.max(compiler.bound_inertia);
                }
            }
        }
        if compiler.set_total_mass > 0.0 {
            let whole_kg: f64 = structure.bodies.iter().map(|body| body.mass_kg).sum();
            let factor = compiler.set_total_mass / whole_kg;
            for body in &mut structure.bodies {
                body.mass_kg *= factor;
                if let Some(tensor) = &mut body.inertia_kg_m2 {
                    *tensor = Tensor::of(&(tensor.matrix() * factor));
                }
            }
            notes.changed(
                None,
                format!(
                    "all masses are scaled to a total of {} kg (settotalmass)",
                    compiler.set_total_mass
                ),
                "no action is needed: MuJoCo does the same",
            );
        }
    }
}

/// Size and pose of a shape, including shapes that are given by two end points (fromto).
fn sized(geom: &Geom) -> (Vector3<f64>, Isometry3<f64>) {
    let size = Vector3::from(geom.size);
    let Some([ax, ay, az, bx, by, bz]) = geom.fromto else {
        return (size, isometry(&geom.pose));
    };
    let (a, b) = (Vector3::new(ax, ay, az), Vector3::new(bx, by, bz));
    // MuJoCo aligns the z axis with the direction from the second point to the first.
    let along = a - b;
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    });
    let half_m = 0.5 * along.norm();
    let size = match geom.type_ {
        GeomType::Box | GeomType::Ellipsoid => Vector3::new(size.x, size.x, half_m),
        _ => Vector3::new(size.x, half_m, 0.0),
    };
    (size, Isometry3::from_parts(((a + b) / 2.0).into(), turn))
}

/// Converts a pose of `mjcf-rs` into an isometry.
pub(super) fn isometry(pose: &mjcf_rs::Pose) -> Isometry3<f64> {
    let (t, q) = (pose.translation, pose.rotation);
    Isometry3::from_parts(
        Translation3::new(t.x, t.y, t.z),
        UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z)),
    )
}
