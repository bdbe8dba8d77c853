//! A link of a URDF as boxes, mass and moments, in axes that the whole robot shares.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::element::{Place, child, children};
use realgap_core::error::{Error, Result};

/// Directions farther apart than this are no quarter turns of each other, radians.
const QUARTER_TURN_RAD: f64 = 1e-3;
/// Products of inertia above this share of the largest moment are worth a word.
const PRODUCT_SHARE: f64 = 0.01;

/// A box with its faces along the robot's axes, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub centre_m: Vector3<f64>,
    pub sides_m: Vector3<f64>,
}

/// A link, or several that are fixed to each other: origin at the first one's frame, axes of the robot.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub name: String,
    pub blocks: Vec<Block>,
    pub mass_kg: f64,
    /// Mass times place of its centre, kg m.
    pub moment_kg_m: Vector3<f64>,
    /// About the origin, kg m².
    pub inertia_kg_m2: Matrix3<f64>,
    /// Whether every mass in it has moments.
    pub has_inertia: bool,
}

impl Body {
    /// The link of an element, whose frame is turned like this in the robot.
    ///
    /// # Errors
    /// Boxes that are not turned by quarter turns, numbers that are none.
    pub fn new(
        place: &Place<'_>,
        link: Node<'_, '_>,
        robot_from_link: &UnitQuaternion<f64>,
        said: &mut Vec<String>,
    ) -> Result<Self> {
        let name = place.text(link, "name")?.to_owned();
        let mut body = Self {
            name,
            blocks: Vec::new(),
            mass_kg: 0.0,
            moment_kg_m: Vector3::zeros(),
            inertia_kg_m2: Matrix3::zeros(),
            has_inertia: true,
        };
        let mut shapes: Vec<Node<'_, '_>> = children(link, "collision").collect();
        if shapes.is_empty() {
            shapes = children(link, "visual").collect();
            if !shapes.is_empty() {
                said.push(format!(
                    "link `{}` has no collision shapes: its visual ones are taken",
                    body.name
                ));
            }
        }
        for shape in shapes {
            let in_link = place.origin(shape)?;
            let pose = robot_from_link * in_link;
            body.blocks
                .extend(block(place, shape, &pose, &body.name, said)?);
        }
        if let Some(inertial) = child(link, "inertial") {
            body.weigh(place, inertial, robot_from_link, said)?;
        }
        Ok(body)
    }

    fn weigh(
        &mut self,
        place: &Place<'_>,
        inertial: Node<'_, '_>,
        robot_from_link: &UnitQuaternion<f64>,
        said: &mut Vec<String>,
    ) -> Result<()> {
        let Some(mass) = child(inertial, "mass") else {
            return Ok(());
        };
        let [mass_kg] = place.numbers(mass, "value")?;
        let pose = robot_from_link * place.origin(inertial)?;
        let centre_m = pose.translation.vector;
        self.mass_kg = mass_kg;
        self.moment_kg_m = centre_m * mass_kg;
        let Some(inertia) = child(inertial, "inertia") else {
            self.has_inertia = false;
            return Ok(());
        };
        let entry = |name| -> Result<f64> { Ok(place.number(inertia, name)?.unwrap_or(0.0)) };
        let (xy, xz, yz) = (entry("ixy")?, entry("ixz")?, entry("iyz")?);
        let own = Matrix3::new(
            entry("ixx")?,
            xy,
            xz, //
            xy,
            entry("iyy")?,
            yz, //
            xz,
            yz,
            entry("izz")?,
        );
        let turned = pose.rotation.to_rotation_matrix();
        let about_centre = turned.matrix() * own * turned.matrix().transpose();
        let largest = about_centre.diagonal().amax();
        let products = [(0, 1), (0, 2), (1, 2)].map(|at| about_centre[at].abs());
        if products
            .iter()
            .any(|product| *product > PRODUCT_SHARE * largest)
        {
            said.push(format!(
                "the products of inertia of link `{}`: moments here are about axes along the module's",
                self.name
            ));
        }
        self.inertia_kg_m2 = about_centre + about_origin(mass_kg, &centre_m);
        Ok(())
    }

    /// This body with another fixed to it, whose origin is there.
    pub fn with(mut self, other: &Self, at_m: &Vector3<f64>) -> Self {
        self.blocks.extend(other.blocks.iter().map(|block| Block {
            centre_m: block.centre_m + at_m,
            ..*block
        }));
        if other.mass_kg > 0.0 {
            let centre_m = other.moment_kg_m / other.mass_kg;
            let about_centre = other.inertia_kg_m2 - about_origin(other.mass_kg, &centre_m);
            self.inertia_kg_m2 += about_centre + about_origin(other.mass_kg, &(centre_m + at_m));
            self.moment_kg_m += (centre_m + at_m) * other.mass_kg;
            self.mass_kg += other.mass_kg;
            self.has_inertia &= other.has_inertia;
        }
        self
    }

    /// The box around all of its blocks.
    pub fn bounds(&self) -> Block {
        let ends = |sign: f64| {
            self.blocks
                .iter()
                .map(move |block| block.centre_m + sign * block.sides_m / 2.0)
        };
        let low = ends(-1.0).fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(&b));
        let high = ends(1.0).fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(&b));
        Block {
            centre_m: (low + high) / 2.0,
            sides_m: high - low,
        }
    }

    /// Its principal moments about its centre of mass, along the robot's axes; `None` where they are not known.
    pub fn moments_kg_m2(&self) -> Option<[f64; 3]> {
        let centre_m = self.moment_kg_m / self.mass_kg;
        let about_centre = self.inertia_kg_m2 - about_origin(self.mass_kg, &centre_m);
        let moments = about_centre.diagonal();
        (self.has_inertia && moments.iter().all(|moment| *moment > 0.0)).then(|| moments.into())
    }
}

/// What a mass at a place adds to moments about the origin (Steiner).
fn about_origin(mass_kg: f64, at_m: &Vector3<f64>) -> Matrix3<f64> {
    mass_kg * (Matrix3::identity() * at_m.norm_squared() - at_m * at_m.transpose())
}

/// The box of a shape; `None` for what is left out.
fn block(
    place: &Place<'_>,
    shape: Node<'_, '_>,
    pose: &Isometry3<f64>,
    link: &str,
    said: &mut Vec<String>,
) -> Result<Option<Block>> {
    let Some(geometry) = child(shape, "geometry") else {
        return Ok(None);
    };
    let own_sides_m = if let Some(solid) = child(geometry, "box") {
        place.vector(solid, "size")?
    } else if let Some(solid) = child(geometry, "cylinder") {
        let ([radius], [length]) = (
            place.numbers(solid, "radius")?,
            place.numbers(solid, "length")?,
        );
        said.push(format!(
            "a cylinder of link `{link}` became the box around it"
        ));
        Vector3::new(2.0 * radius, 2.0 * radius, length)
    } else if let Some(solid) = child(geometry, "sphere") {
        let [radius] = place.numbers(solid, "radius")?;
        said.push(format!(
            "a sphere of link `{link}` became the box around it"
        ));
        Vector3::repeat(2.0 * radius)
    } else {
        said.push(format!(
            "a shape of link `{link}`: it is neither box, cylinder nor sphere"
        ));
        return Ok(None);
    };
    let turned = pose.rotation.to_rotation_matrix();
    let sides_m = turned.matrix().abs() * own_sides_m;
    let is_quarter_turn = turned.matrix().iter().all(|entry| {
        entry.abs() < QUARTER_TURN_RAD || (entry.abs() - 1.0).abs() < QUARTER_TURN_RAD
    });
    if !is_quarter_turn {
        let error = Error::invalid("a box that stands askew to the robot cannot be a module")
            .found(format!("link `{link}`"))
            .allowed("boxes turned by quarter turns, at zero angles of all joints")
            .hint("choose other frames in the URDF, or the box around it");
        return Err(place.at(shape, error));
    }
    Ok(Some(Block {
        centre_m: pose.translation.vector,
        sides_m,
    }))
}
