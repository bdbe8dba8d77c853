//! Masses and shapes of the bodies of an MJCF, as MuJoCo's compiler computes them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use std::rc::Rc;

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Translation3, Vector3};

use super::super::Options;
use super::super::mesh::forms;
use super::super::note::Notes;
use super::mesh::{self, Solid};
use super::model::{Body, Geom, GeomType, Model};
use super::settings::FromGeoms;
use crate::morphology::body::{Form, UniformMass, uniform};
use realgap_core::error::{Error, Result};

/// A mass, its centre and its inertia about the centre, in the body's frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mass {
    pub mass_kg: f64,
    pub centre_m: Vector3<f64>,
    pub inertia_kg_m2: Matrix3<f64>,
}

/// The meshes that were read, by model and name.
type Solids = BTreeMap<(usize, String), Option<Rc<Solid>>>;

/// Computes masses and shapes of the bodies of a model.
pub(super) struct MassReader<'a> {
    pub model: &'a Model,
    pub main: &'a Path,
    pub options: &'a Options,
    pub solids: RefCell<Solids>,
}

impl MassReader<'_> {
    /// The masses of all bodies; the world has none.
    pub fn all(&self, names: &[String], notes: &mut Notes) -> Result<Vec<Mass>> {
        let settings = &self.model.origins[0].settings;
        let mut all = vec![Mass::default()];
        for (body, name) in self.model.bodies.iter().zip(names).skip(1) {
            let mut mass = self.body(body, name, notes)?;
            mass.mass_kg = mass.mass_kg.max(settings.least_mass_kg);
            self.check(&mut mass, name, notes)?;
            all.push(mass);
        }
        let whole_kg: f64 = all.iter().map(|mass| mass.mass_kg).sum();
        if let Some(total_kg) = settings.total_mass_kg.filter(|_| whole_kg > 0.0) {
            for mass in &mut all {
                mass.mass_kg *= total_kg / whole_kg;
                mass.inertia_kg_m2 *= total_kg / whole_kg;
            }
            notes.changed(
                None,
                format!("all masses are scaled to a total of {total_kg} kg (settotalmass)"),
                "no action is needed: MuJoCo does the same",
            );
        }
        Ok(all)
    }

    /// The mass of one body: as the file states it, or that of its shapes.
    fn body(&self, body: &Body, name: &str, notes: &mut Notes) -> Result<Mass> {
        let settings = &self.model.origins[0].settings;
        let stated = match &body.inertial {
            None => None,
            Some((given, pose)) => {
                let inertia = match (
                    given.numbers::<6>("fullinertia")?,
                    given.numbers::<3>("diaginertia")?,
                ) {
                    (Some([xx, yy, zz, xy, xz, yz]), _) => {
                        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
                    }
                    (None, Some(list)) => Matrix3::from_diagonal(&Vector3::from(list)),
                    (None, None) => Matrix3::zeros(),
                };
                let turn = pose.rotation.to_rotation_matrix();
                Some(Mass {
                    mass_kg: given.number("mass", 0.0)?,
                    centre_m: pose.translation.vector,
                    inertia_kg_m2: turn * inertia * turn.transpose(),
                })
            }
        };
        let takes_shapes = match settings.from_geoms {
            FromGeoms::Always => true,
            FromGeoms::Never => false,
            FromGeoms::Auto => stated.is_none(),
        };
        if !takes_shapes {
            return Ok(stated.unwrap_or_default());
        }
        let [low, high] = settings.groups;
        let mut pieces = Vec::new();
        for geom in body
            .geoms
            .iter()
            .filter(|g| (low..=high).contains(&g.group))
        {
            pieces.extend(self.heavy(geom, name, notes)?);
        }
        let (mass_kg, centre_m, inertia_kg_m2) = UniformMass::together(&pieces);
        Ok(match (mass_kg > 0.0, stated) {
            (false, Some(stated)) => stated,
            _ => Mass {
                mass_kg,
                centre_m,
                inertia_kg_m2,
            },
        })
    }

    /// Applies the bounds of the compiler, and refuses or doubts an impossible inertia.
    fn check(&self, mass: &mut Mass, name: &str, notes: &mut Notes) -> Result<()> {
        let settings = &self.model.origins[0].settings;
        let impossible = |found: String| {
            Error::invalid(format!(
                "mass and inertia of `{name}` are physically impossible"
            ))
            .at_file(self.main)
            .found(found)
            .allowed("a mass and moments of 0 or more")
        };
        if !mass.mass_kg.is_finite() || !mass.inertia_kg_m2.iter().all(|value| value.is_finite()) {
            return Err(impossible("numbers that are not finite".to_owned()));
        }
        let eigen = SymmetricEigen::new(mass.inertia_kg_m2);
        let mut moments = eigen.eigenvalues;
        let least = settings.least_inertia_kg_m2;
        let is_bound = least > 0.0 && moments.min() < least;
        moments
            .iter_mut()
            .for_each(|moment| *moment = moment.max(least));
        // Rounding of a computed inertia leaves moments that are negative by less than this.
        let slack = 1e-9 * moments.amax();
        if mass.mass_kg < 0.0 || moments.min() < -slack {
            return Err(impossible(format!(
                "{} kg, smallest moment {:e} kg m^2",
                mass.mass_kg,
                moments.min()
            )));
        }
        let is_impossible = moments.sum() - 2.0 * moments.max() < -slack;
        if is_impossible && settings.balance {
            mass.inertia_kg_m2 = Matrix3::identity() * (moments.sum() / 3.0);
            return Ok(());
        }
        if is_impossible {
            notes.doubt(
                None,
                format!(
                    "the inertia of `{name}` is impossible: the largest principal moment {:.4e} kg m^2 exceeds the sum of the others, {:.4e}",
                    moments.max(),
                    moments.sum() - moments.max()
                ),
                "MuJoCo refuses this file: correct the inertia, or state balanceinertia=\"true\"",
            );
        }
        if is_bound {
            let axes = eigen.eigenvectors;
            mass.inertia_kg_m2 = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        }
        Ok(())
    }

    /// Size and pose of a shape, which may be fitted to a mesh.
    fn sized(
        &self,
        geom: &Geom,
        body: &str,
        notes: &mut Notes,
    ) -> Option<(Vector3<f64>, Isometry3<f64>)> {
        if geom.mesh.is_none() || geom.kind == GeomType::Mesh {
            return Some((geom.size, geom.pose));
        }
        let solid = self.solid(geom, body, notes)?;
        let origin = &self.model.origins[geom.element.origin];
        let (size, pose) = mesh::fitted(&solid, geom.kind, origin, geom.fit_scale);
        Some((size, geom.pose * pose))
    }

    /// Mass properties of a shape at unit density, and its density, kg/m³.
    fn heavy(
        &self,
        geom: &Geom,
        body: &str,
        notes: &mut Notes,
    ) -> Result<Option<(UniformMass, f64)>> {
        if matches!(geom.kind, GeomType::Plane | GeomType::Other) || geom.mass_kg == Some(0.0) {
            return Ok(None);
        }
        let Some((size, pose)) = self.sized(geom, body, notes) else {
            return Ok(None);
        };
        let mass = match geom.kind {
            GeomType::Mesh => self.solid(geom, body, notes).map(|solid| solid.mass),
            kind if geom.is_shell => shell(kind, &size),
            GeomType::Ellipsoid => Some(ellipsoid(&size)),
            kind => form(kind, &size).and_then(|form| uniform(&form.shape().0)),
        };
        let Some(mass) = mass.filter(|mass| mass.volume_m3 > 0.0) else {
            return Ok(None);
        };
        let density = geom.mass_kg.map_or(geom.density, |kg| kg / mass.volume_m3);
        if !density.is_finite() || density < 0.0 {
            let error = Error::invalid(format!(
                "a shape of `{body}` has a negative or non-finite mass or density"
            ));
            return Err(geom.element.error(error.found(density)));
        }
        Ok(Some((mass.posed(&pose), density)))
    }

    /// Collision shapes of a geom: several for a mesh that is split into parts, none for an unsupported geom.
    pub fn pieces(
        &self,
        geom: &Geom,
        body: &str,
        notes: &mut Notes,
    ) -> Vec<(Form, Isometry3<f64>)> {
        if matches!(geom.kind, GeomType::Plane | GeomType::Other) {
            let what = format!("a plane, height field or distance field of `{body}`");
            notes.left_out(None, what, "use boxes");
            return Vec::new();
        }
        if geom.kind == GeomType::Mesh {
            let Some(solid) = self.solid(geom, body, notes) else {
                return Vec::new();
            };
            let name = geom.mesh.clone().unwrap_or_default();
            let forms = forms(&solid.mesh, self.options.hulls, &name, None, notes).into_iter();
            return forms
                .map(|(form, middle_m)| (form, geom.pose * Translation3::from(middle_m)))
                .collect();
        }
        let Some((size, pose)) = self.sized(geom, body, notes) else {
            return Vec::new();
        };
        let form = form(geom.kind, &size);
        match form.filter(|form| form.shape().0.half_extents_m().min() > 0.0) {
            Some(form) => vec![(form, pose)],
            None => {
                notes.left_out(
                    None,
                    format!("a shape of `{body}` without size"),
                    "state its size",
                );
                Vec::new()
            }
        }
    }

    /// The mesh of a shape.
    fn solid(&self, geom: &Geom, body: &str, notes: &mut Notes) -> Option<Rc<Solid>> {
        let name = geom.mesh.clone().unwrap_or_default();
        let key = (geom.element.origin, name.clone());
        if let Some(known) = self.solids.borrow().get(&key) {
            return known.clone();
        }
        let origin = &self.model.origins[geom.element.origin];
        let solid = match origin.meshes.get(&name) {
            None => Err("no asset has this name".to_owned()),
            Some(asset) => mesh::read(asset, origin, self.main, self.options),
        };
        let solid = match solid {
            Ok(solid) => Some(Rc::new(solid)),
            Err(why) => {
                notes.doubt(
                    None,
                    format!("the mesh `{name}` of `{body}` is not used: {why}"),
                    "STL, OBJ and MSH in metres are read",
                );
                None
            }
        };
        self.solids.borrow_mut().insert(key, solid.clone());
        solid
    }
}

/// The form of a primitive of this size; `None` for other kinds of shapes.
fn form(kind: GeomType, size: &Vector3<f64>) -> Option<Form> {
    let (radius_m, length_m) = (size.x, 2.0 * size.y);
    Some(match kind {
        GeomType::Sphere => Form::Sphere { radius_m },
        GeomType::Capsule => Form::Capsule { radius_m, length_m },
        GeomType::Cylinder => Form::Cylinder { radius_m, length_m },
        GeomType::Box => Form::Box {
            sides_m: (2.0 * size.x, 2.0 * size.y, 2.0 * size.z),
        },
        GeomType::Ellipsoid => Form::Ellipsoid {
            radii_m: (size.x, size.y, size.z),
        },
        GeomType::Plane | GeomType::Mesh | GeomType::Other => return None,
    })
}

fn about_centre(volume_m3: f64, moments: Vector3<f64>) -> UniformMass {
    UniformMass {
        volume_m3,
        centre_m: Vector3::zeros(),
        inertia_m5: Matrix3::from_diagonal(&moments),
    }
}

/// The mass of an ellipsoid, whose collision shape is a hull of few points.
fn ellipsoid(half: &Vector3<f64>) -> UniformMass {
    let volume_m3 = 4.0 / 3.0 * PI * half.product();
    let squares = half.component_mul(half) * (volume_m3 / 5.0);
    about_centre(volume_m3, Vector3::repeat(squares.sum()) - squares)
}

/// The mass of the surface of a primitive (shellinertia): in place of the volume stands the area.
fn shell(kind: GeomType, size: &Vector3<f64>) -> Option<UniformMass> {
    let (r, half) = (size.x, size.y);
    Some(match kind {
        GeomType::Sphere => {
            let area = 4.0 * PI * r * r;
            about_centre(area, Vector3::repeat(2.0 / 3.0 * area * r * r))
        }
        GeomType::Capsule | GeomType::Cylinder => {
            let side = 4.0 * PI * r * half;
            let side_across = side * (r * r / 2.0 + half * half / 3.0);
            let (ends, ends_across, ends_along) = match kind {
                // Two hollow halves of a ball, whose centres of mass lie r/2 beyond the ends of the tube.
                GeomType::Capsule => {
                    let ends = 4.0 * PI * r * r;
                    let own = (2.0 / 3.0 - 0.25) * r * r;
                    (
                        ends,
                        ends * (own + (half + r / 2.0).powi(2)),
                        ends * 2.0 / 3.0 * r * r,
                    )
                }
                _ => {
                    let ends = 2.0 * PI * r * r;
                    (ends, ends * (r * r / 4.0 + half * half), ends * r * r / 2.0)
                }
            };
            let across = side_across + ends_across;
            about_centre(
                side + ends,
                Vector3::new(across, across, side * r * r + ends_along),
            )
        }
        GeomType::Box => {
            let areas = Vector3::new(size.y * size.z, size.x * size.z, size.x * size.y) * 8.0;
            // The second moment along x: the faces across x lie at its end, the others are spread.
            let squares = size.component_mul(size);
            let second = Vector3::from_fn(|axis, _| {
                squares[axis] * (areas[axis] + (areas.sum() - areas[axis]) / 3.0)
            });
            about_centre(areas.sum(), Vector3::repeat(second.sum()) - second)
        }
        // MuJoCo's own approximation: the area by Thomsen's formula, the inertia of a thin layer of two similar ellipsoids.
        GeomType::Ellipsoid => {
            let power = |a: f64, b: f64| (a * b).powf(1.6075);
            let mean =
                (power(size.x, size.y) + power(size.y, size.z) + power(size.x, size.z)) / 3.0;
            let area = 4.0 * PI * mean.powf(1.0 / 1.6075);
            const LAYER_M: f64 = 1e-6;
            let (inner, outer) = (ellipsoid(size), ellipsoid(&size.add_scalar(LAYER_M)));
            let share = area / (outer.volume_m3 - inner.volume_m3);
            about_centre(
                area,
                (outer.inertia_m5 - inner.inertia_m5).diagonal() * share,
            )
        }
        GeomType::Plane | GeomType::Mesh | GeomType::Other => return None,
    })
}
