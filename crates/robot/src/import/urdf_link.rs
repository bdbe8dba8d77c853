//! Conversion of URDF links into bodies.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Translation3, Vector3};
use roxmltree::Node;

use super::Options;
use super::element::{XmlSource, child, children};
use super::mesh::forms;
use super::mesh_file;
use super::note::Notes;
use super::package::locate;
use crate::morphology::body::{Body, Form, Piece, Pose, Tensor, Triple};
use realgap_core::error::{Error, Result};

/// Density for links without a stated mass, and of the ball that replaces a link without shapes, kg/m³: that of water, as MuJoCo
/// assumes.
pub(super) const DENSITY_KG_M3: f64 = 1000.0;

/// Reads the links of a URDF.
pub(super) struct Reader<'a> {
    pub place: XmlSource<'a>,
    pub options: &'a Options,
    /// Whether visual shapes are used for collisions because no link has collision shapes.
    pub visuals_collide: bool,
}

fn triple(v: &Vector3<f64>) -> Triple {
    (v.x, v.y, v.z)
}

impl Reader<'_> {
    fn robot(&self) -> &Path {
        self.place.source.path()
    }

    /// Reads the link of an element.
    ///
    /// # Errors
    /// Malformed numbers; masses and moments of inertia that are physically impossible.
    pub fn body(&self, link: Node<'_, '_>, notes: &mut Notes) -> Result<Body> {
        let name = self.place.text(link, "name")?.to_owned();
        let mut body = Body {
            name,
            ..Body::default()
        };
        if let Some(inertial) = child(link, "inertial") {
            self.weigh(&mut body, inertial, notes)?;
        }
        let mut is_standing_in = false;
        for shape in children(link, "collision") {
            let pieces = self.pieces(shape, &body.name, notes)?;
            is_standing_in |= pieces.is_empty();
            body.shapes.extend(pieces);
        }
        let has_collision = child(link, "collision").is_some();
        if (is_standing_in && body.shapes.is_empty()) || (self.visuals_collide && !has_collision) {
            for shape in children(link, "visual") {
                body.shapes.extend(self.pieces(shape, &body.name, notes)?);
            }
        }
        if is_standing_in && body.shapes.is_empty() {
            let stand_in = box_of_equal_inertia(&body);
            let what = match stand_in {
                Some(_) => format!(
                    "the collision shape of link `{}` is replaced by a box of equal inertia",
                    body.name
                ),
                None => format!("link `{}` has no collision shape", body.name),
            };
            let remedy = "supply its mesh files, or state the folder of their package";
            notes.assumed(self.place.line(link), what, remedy);
            body.shapes.extend(stand_in);
        }
        self.guess_inertia(&mut body, link, notes)?;
        Ok(body)
    }

    fn weigh(&self, body: &mut Body, inertial: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        let place = &self.place;
        let line = place.line(inertial);
        let Some(mass) = child(inertial, "mass") else {
            notes.left_out(
                line,
                format!("link `{}` has moments but no mass", body.name),
                "add <mass value=\"...\"/>",
            );
            return Ok(());
        };
        let [mass_kg] = place.numbers(mass, "value")?;
        if mass_kg < 0.0 {
            let error = Error::invalid("a negative mass")
                .found(format!("{mass_kg} kg"))
                .allowed("0 or more");
            return Err(place.at(mass, error));
        }
        let pose = place.origin(inertial)?;
        body.mass_kg = mass_kg;
        body.centre_of_mass_m = Some(triple(&pose.translation.vector));
        let Some(inertia) = child(inertial, "inertia") else {
            return Ok(());
        };
        let entry = |name| -> Result<f64> { Ok(place.number(inertia, name)?.unwrap_or(0.0)) };
        let (xy, xz, yz) = (entry("ixy")?, entry("ixz")?, entry("iyz")?);
        let (xx, yy, zz) = (entry("ixx")?, entry("iyy")?, entry("izz")?);
        let own = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        if own.amax() < 1e-20 {
            return Ok(());
        }
        if mass_kg == 0.0 {
            let what = format!(
                "link `{}` has moments of inertia but no mass: kept",
                body.name
            );
            notes.doubt(
                place.line(inertia),
                what,
                "state its mass, or remove its <inertial>",
            );
        }
        let moments = SymmetricEigen::new(own).eigenvalues;
        if moments.min() < -1e-9 * moments.amax() {
            let error = Error::invalid(format!(
                "the inertia of link `{}` is physically impossible",
                body.name
            ))
            .found(format!(
                "principal moments {:.6e}, {:.6e}, {:.6e} kg m^2",
                moments.x, moments.y, moments.z
            ))
            .allowed("moments of 0 or more")
            .hint("correct <inertia>, or remove it to get the inertia of a uniform shape");
            return Err(place.at(inertia, error));
        }
        if moments.min() <= 1e-9 * moments.amax() {
            notes.doubt(
                place.line(inertia),
                format!(
                    "link `{}` has a principal moment of 0: kept, because other links may be fixed to it",
                    body.name
                ),
                "recompute its inertia",
            );
        } else if 2.0 * moments.max() > moments.sum() * (1.0 + 1e-6) {
            notes.doubt(
                place.line(inertia),
                format!("link `{}` has a moment of inertia larger than the sum of the two others, which is physically impossible: kept", body.name),
                "measure or recompute its inertia",
            );
        }
        let turn = pose.rotation.to_rotation_matrix();
        let turned = match pose.rotation.w.abs() == 1.0 {
            true => own,
            false => turn * own * turn.transpose(),
        };
        body.inertia_kg_m2 = Some(Tensor::of(&turned));
        Ok(())
    }

    /// Chooses an inertia for a link that states a mass but no inertia, and adds a note about the choice.
    fn guess_inertia(&self, body: &mut Body, link: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        if body.mass_kg == 0.0 || body.inertia_kg_m2.is_some() {
            return Ok(());
        }
        let line = self.place.line(link);
        let remedy = "add <inertia> with its six values";
        if body.mass().is_some() {
            let what = format!(
                "the inertia of link `{}` is computed from its shapes and its mass",
                body.name
            );
            notes.assumed(line, what, remedy);
            return Ok(());
        }
        let mut seen = Body {
            mass_kg: body.mass_kg,
            ..Body::default()
        };
        for shape in children(link, "visual") {
            seen.shapes.extend(self.pieces(shape, &body.name, notes)?);
        }
        let inertia = match seen.mass() {
            Some((_, _, inertia)) => {
                let what = format!(
                    "the inertia of link `{}` is computed from its visual shapes and its mass",
                    body.name
                );
                notes.assumed(line, what, remedy);
                Tensor::of(&inertia)
            }
            None => {
                let what = format!(
                    "the inertia of link `{}` is that of a ball with its mass and a density of {DENSITY_KG_M3} kg/m3",
                    body.name
                );
                notes.assumed(line, what, remedy);
                ball(body.mass_kg)
            }
        };
        body.inertia_kg_m2 = Some(inertia);
        Ok(())
    }

    /// The shapes of a collision or visual element: several for a mesh that is split into parts, none if its mesh cannot be read.
    fn pieces(&self, shape: Node<'_, '_>, link: &str, notes: &mut Notes) -> Result<Vec<Piece>> {
        let place = &self.place;
        let line = place.line(shape);
        let Some(geometry) = child(shape, "geometry") else {
            notes.left_out(
                line,
                format!("a shape of link `{link}` has no geometry"),
                "add <geometry>",
            );
            return Ok(Vec::new());
        };
        let pose = place.origin(shape)?;
        let Some(solid) = geometry.children().find(Node::is_element) else {
            notes.left_out(
                line,
                format!("a shape of link `{link}` has an empty geometry"),
                "add a shape element to it",
            );
            return Ok(Vec::new());
        };
        let mut size = |found: Vector3<f64>| {
            if found.min() < 0.0 {
                let what = format!(
                    "a size of a shape of link `{link}` is negative: its absolute value is used"
                );
                notes.changed(line, what, "state sizes above 0");
            }
            found.abs()
        };
        let mut one = |name: &str| -> Result<f64> {
            let [found] = place.numbers(solid, name)?;
            Ok(size(Vector3::repeat(found)).x)
        };
        let form = match solid.tag_name().name() {
            "box" => {
                let sides_m = size(place.vector(solid, "size")?);
                Form::Box {
                    sides_m: triple(&sides_m),
                }
            }
            "sphere" => Form::Sphere {
                radius_m: one("radius")?,
            },
            "cylinder" => Form::Cylinder {
                radius_m: one("radius")?,
                length_m: one("length")?,
            },
            "capsule" => Form::Capsule {
                radius_m: one("radius")?,
                length_m: one("length")?,
            },
            "mesh" => {
                let forms = self.mesh(solid, link, notes)?.into_iter();
                let posed = forms.map(|(form, middle_m)| Piece {
                    form,
                    pose: Pose::of(&(pose * Translation3::from(middle_m))),
                    tyre: None,
                    turning: Default::default(),
                });
                return Ok(posed.collect());
            }
            other => {
                let what = format!("a shape of link `{link}` is <{other}>, which is not supported");
                notes.left_out(line, what, "use box, sphere, cylinder, capsule or mesh");
                return Ok(Vec::new());
            }
        };
        if form_is_nothing(&form) {
            notes.left_out(
                line,
                format!("a shape of link `{link}` has no size"),
                "state its size in metres",
            );
            return Ok(Vec::new());
        }
        Ok(vec![Piece {
            form,
            pose: Pose::of(&pose),
            tyre: None,
            turning: Default::default(),
        }])
    }

    fn mesh(
        &self,
        mesh: Node<'_, '_>,
        link: &str,
        notes: &mut Notes,
    ) -> Result<Vec<(Form, Vector3<f64>)>> {
        let place = &self.place;
        let line = place.line(mesh);
        let name = mesh
            .attribute("filename")
            .or_else(|| mesh.attribute("file"));
        let name = name.unwrap_or_default();
        let scale = match mesh.attribute("scale") {
            None => Vector3::repeat(1.0),
            Some(text) if text.split_whitespace().count() == 1 => {
                Vector3::repeat(place.numbers::<1>(mesh, "scale")?[0])
            }
            Some(_) => place.vector(mesh, "scale")?,
        };
        let Some(path) = locate(name, self.robot(), self.options) else {
            let what = format!("the mesh {name} of link `{link}` cannot be found");
            notes.doubt(line, what, "state the folder of its package");
            return Ok(Vec::new());
        };
        match mesh_file::read(&path, &scale) {
            Ok(mesh) => Ok(forms(&mesh, self.options.hulls, name, line, notes)),
            Err(why) => {
                notes.doubt(
                    line,
                    format!("the mesh {name} of link `{link}` is not used: {why}"),
                    "STL, OBJ and DAE in metres are read",
                );
                Ok(Vec::new())
            }
        }
    }
}

/// The inertia of a ball of this mass with the density of water.
pub(super) fn ball(mass_kg: f64) -> Tensor {
    let radius_m = (0.75 * mass_kg / (std::f64::consts::PI * DENSITY_KG_M3)).cbrt();
    Tensor::of(&Matrix3::from_diagonal_element(
        0.4 * mass_kg * radius_m * radius_m,
    ))
}

fn form_is_nothing(form: &Form) -> bool {
    let (shape, _) = form.shape();
    shape.half_extents_m().min() <= 0.0
}

/// The uniform box that has a body's mass and moments of inertia, at the body's centre of mass.
fn box_of_equal_inertia(body: &Body) -> Option<Piece> {
    let tensor = body.inertia_kg_m2.filter(|_| body.mass_kg > 0.0)?.matrix();
    let eigen = SymmetricEigen::new(tensor);
    let moments = eigen.eigenvalues;
    // m/12 (y² + z²) = Ixx and so on.
    let squares = (Vector3::repeat(moments.sum()) - 2.0 * moments) * (6.0 / body.mass_kg);
    let sides_m = squares.map(|square| square.max(1e-6).sqrt());
    // Principal axes, turned into a right-handed system.
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        let flipped = -axes.column(2);
        axes.set_column(2, &flipped);
    }
    let axes = nalgebra::Rotation3::from_matrix_unchecked(axes);
    let (x, y, z) = body.centre_of_mass_m.unwrap_or_default();
    let pose = Isometry3::from_parts(Translation3::new(x, y, z), axes.into());
    Some(Piece {
        form: Form::Box {
            sides_m: triple(&sides_m),
        },
        pose: Pose::of(&pose),
        tyre: None,
        turning: Default::default(),
    })
}
