//! The settings of MuJoCo's compiler, and orientations, which depend on them.

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::element::Element;
use realgap_core::error::{Error, Result};

/// Source of the masses of bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    Always,
    Never,
    /// Where the body states no inertia.
    Auto,
}

/// The settings of the compiler.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    pub degree: bool,
    pub euler: Vec<char>,
    pub autolimits: bool,
    pub from_geoms: FromGeoms,
    pub groups: [f64; 2],
    pub balance: bool,
    pub least_mass_kg: f64,
    pub least_inertia_kg_m2: f64,
    pub total_mass_kg: Option<f64>,
    pub mesh_folder: String,
    pub strip_path: bool,
    pub fit_box: bool,
}

impl Settings {
    /// Reads the `<compiler>` sections of a model; later ones override earlier ones.
    pub fn of(root: &Element) -> Result<Self> {
        let mut all = Element {
            tag: "compiler".to_owned(),
            ..root.clone()
        };
        all.attributes.clear();
        for section in root.named("compiler") {
            all.line = section.line;
            all.file = section.file.clone();
            all.attributes.extend(section.attributes.clone());
        }
        let is = |name: &str| all.truth(name);
        if all.get("coordinate") == Some("global") {
            return Err(
                all.error(Error::invalid("global coordinates are not supported").hint(
                    "MuJoCo removed them in version 2.3.4: save the model with an older MuJoCo",
                )),
            );
        }
        let euler: Vec<char> = all.get("eulerseq").unwrap_or("xyz").chars().collect();
        if euler.len() != 3 || !euler.iter().all(|c| "xyzXYZ".contains(*c)) {
            let error = Error::invalid("not a sequence of axes").found(String::from_iter(&euler));
            return Err(all.error(error.allowed("three of the letters x, y, z, X, Y, Z")));
        }
        let total_kg = all.number("settotalmass", -1.0)?;
        Ok(Self {
            degree: all.get("angle") != Some("radian"),
            euler,
            autolimits: is("autolimits").unwrap_or(true),
            from_geoms: match is("inertiafromgeom") {
                Some(true) => FromGeoms::Always,
                Some(false) => FromGeoms::Never,
                None => FromGeoms::Auto,
            },
            groups: all.numbers::<2>("inertiagrouprange")?.unwrap_or([0.0, 5.0]),
            balance: is("balanceinertia").unwrap_or(false),
            least_mass_kg: all.number("boundmass", 0.0)?,
            least_inertia_kg_m2: all.number("boundinertia", 0.0)?,
            total_mass_kg: (total_kg > 0.0).then_some(total_kg),
            mesh_folder: (all.get("meshdir").or(all.get("assetdir")))
                .unwrap_or_default()
                .to_owned(),
            strip_path: is("strippath").unwrap_or(false),
            fit_box: is("fitaabb").unwrap_or(false),
        })
    }

    /// An angle of the file in radians.
    pub fn angle_rad(&self, angle: f64) -> f64 {
        if self.degree {
            angle.to_radians()
        } else {
            angle
        }
    }

    /// The orientation that an element states; none is the identity.
    pub fn turn(&self, element: &Element) -> Result<UnitQuaternion<f64>> {
        let bad = |what: &str| element.error(Error::invalid(what.to_owned()));
        if let Some([x, y, z, angle]) = element.numbers::<4>("axisangle")? {
            let axis = nalgebra::Unit::try_new(Vector3::new(x, y, z), 1e-14)
                .ok_or_else(|| bad("the axis of `axisangle` has no direction"))?;
            return Ok(UnitQuaternion::from_axis_angle(
                &axis,
                self.angle_rad(angle),
            ));
        }
        if let Some(list) = element.numbers::<6>("xyaxes")? {
            let x = Vector3::new(list[0], list[1], list[2]);
            let y = Vector3::new(list[3], list[4], list[5]);
            let x = x.try_normalize(1e-14);
            let y = x.and_then(|x| (y - x * x.dot(&y)).try_normalize(1e-14));
            let (Some(x), Some(y)) = (x, y) else {
                return Err(bad("`xyaxes` states no two directions"));
            };
            let matrix = Matrix3::from_columns(&[x, y, x.cross(&y)]);
            return Ok(UnitQuaternion::from_rotation_matrix(
                &Rotation3::from_matrix_unchecked(matrix),
            ));
        }
        if let Some(list) = element.numbers::<3>("zaxis")? {
            let along = Vector3::from(list);
            return match along.norm() > 1e-14 {
                true => Ok(turn_of_z(&along)),
                false => Err(bad("`zaxis` has no direction")),
            };
        }
        if let Some(list) = element.numbers::<3>("euler")? {
            return Ok(self.of_euler(&list));
        }
        let Some([w, x, y, z]) = element.numbers::<4>("quat")? else {
            return Ok(UnitQuaternion::identity());
        };
        UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-14)
            .ok_or_else(|| bad("a quaternion of length 0 is not an orientation"))
    }

    /// Angles about the axes of the sequence: about moved axes (small letters) or fixed ones (capitals).
    pub fn of_euler(&self, angles: &[f64; 3]) -> UnitQuaternion<f64> {
        let mut turn = UnitQuaternion::identity();
        for (letter, angle) in self.euler.iter().zip(angles) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => Vector3::x_axis(),
                'y' => Vector3::y_axis(),
                _ => Vector3::z_axis(),
            };
            let one = UnitQuaternion::from_axis_angle(&axis, self.angle_rad(*angle));
            turn = match letter.is_ascii_lowercase() {
                true => turn * one,
                false => one * turn,
            };
        }
        turn
    }

    /// The pose that an element states.
    pub fn pose(&self, element: &Element) -> Result<Isometry3<f64>> {
        Ok(Isometry3::from_parts(
            Translation3::from(element.vector("pos")?),
            self.turn(element)?,
        ))
    }
}

/// The smallest rotation that turns the z axis into a direction.
pub(super) fn turn_of_z(along: &Vector3<f64>) -> UnitQuaternion<f64> {
    let along = along.normalize();
    let axis = Vector3::z().cross(&along);
    let sine = axis.norm();
    let axis = nalgebra::Unit::try_new(axis, 1e-10).unwrap_or_else(Vector3::x_axis);
    UnitQuaternion::from_axis_angle(&axis, sine.atan2(along.z))
}
