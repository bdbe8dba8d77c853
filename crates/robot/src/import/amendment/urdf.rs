//! Changes of a URDF.

use nalgebra::{Matrix3, UnitQuaternion};
use roxmltree::Node;

use super::super::element::{child, words};
use super::super::tidy::clean;
use super::{Amendment, BodyMass, Editor, JointQuantity, Outcome, Target, Written, each, shifted};

/// Applies amendments to a URDF.
pub(super) fn amend(editor: &mut Editor<'_, '_>, amendments: &[Amendment]) -> Vec<Outcome> {
    each(editor, amendments, |editor, target| match target {
        Target::Joint {
            joint,
            quantity,
            from,
            to,
        } => change_joint(
            editor,
            named(editor, "joint", joint)?,
            *quantity,
            (*from, *to),
        ),
        Target::Body { body, from, to } => {
            change_link(editor, named(editor, "link", body)?, from, to)
        }
        Target::Gravity(_) => Err("a URDF says nothing about gravity".to_owned()),
        Target::Field { .. } => {
            Err("this is a field of an MJCF, and the file is a URDF".to_owned())
        }
    })
}

fn named<'d>(editor: &Editor<'_, 'd>, tag: &str, name: &str) -> Result<Node<'d, 'd>, String> {
    let root = editor.document().root_element();
    let all = || root.children().filter(|node| node.has_tag_name(tag));
    let own = |node: &Node<'d, 'd>| node.attribute("name").unwrap_or_default();
    let exact = all().find(|node| own(node) == name);
    let found = exact.or_else(|| all().find(|node| clean(own(node)) == name));
    found.ok_or_else(|| format!("the file has no {tag} `{name}`"))
}

/// A number of an attribute; 0 where there is none.
fn number(node: Option<Node<'_, '_>>, attribute: &str) -> f64 {
    let text = node.and_then(|node| node.attribute(attribute));
    let word = text.and_then(|text| words(text).next());
    word.and_then(|word| word.parse().ok()).unwrap_or(0.0)
}

fn change_joint<'d>(
    editor: &mut Editor<'_, 'd>,
    joint: Node<'d, 'd>,
    quantity: JointQuantity,
    (from, to): (f64, f64),
) -> Outcome {
    let (tag, attribute) = match quantity {
        JointQuantity::Viscous => ("dynamics", "damping"),
        JointQuantity::Dry => ("dynamics", "friction"),
        JointQuantity::ServoLimit => ("limit", "effort"),
        JointQuantity::Armature => {
            return Err("a URDF cannot state an inertia of a joint (armature)".to_owned());
        }
        JointQuantity::ServoStiffness | JointQuantity::ServoDamping => {
            return Err("a URDF cannot state the gains of a servo".to_owned());
        }
    };
    let own = child(joint, tag);
    let value = shifted(number(own, attribute), from, to)?;
    Ok(vec![match own {
        Some(own) => editor.set_number(own, attribute, (0, value), &[]),
        None => editor.set_of_new_child(joint, tag, attribute, value.to_string()),
    }])
}

fn change_link<'d>(
    editor: &mut Editor<'_, 'd>,
    link: Node<'d, 'd>,
    from: &BodyMass,
    to: &BodyMass,
) -> Outcome {
    let inertial = child(link, "inertial").ok_or("the link states no <inertial>")?;
    let mass = child(inertial, "mass").ok_or("the link states no <mass>")?;
    let mut written: Vec<Written> = Vec::new();
    if to.mass_kg != from.mass_kg {
        written.push(editor.set_number(mass, "value", (0, to.mass_kg), &[]));
    }
    let origin = child(inertial, "origin");
    if to.centre_m != from.centre_m {
        let text = format!("{} {} {}", to.centre_m.x, to.centre_m.y, to.centre_m.z);
        written.push(match origin {
            Some(origin) => editor.set(origin, "xyz", text),
            None => editor.set_of_new_child(inertial, "origin", "xyz", text),
        });
    }
    if to.inertia_kg_m2 != from.inertia_kg_m2 {
        let stated = child(inertial, "inertia");
        let inertia = stated.ok_or("the link states no <inertia>")?;
        if origin.is_some_and(|origin| origin.has_attribute("quat_xyzw")) {
            return Err("the inertia is stated in a frame with a quaternion".to_owned());
        }
        let rpy = origin.and_then(|origin| origin.attribute("rpy"));
        let rpy: Vec<f64> = words(rpy.unwrap_or_default())
            .filter_map(|word| word.parse().ok())
            .collect();
        let turn = match rpy[..] {
            [roll, pitch, yaw] => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            _ => UnitQuaternion::identity(),
        };
        let turn = turn.to_rotation_matrix();
        let own: Matrix3<f64> = turn.transpose() * to.inertia_kg_m2 * turn;
        let stated = own_or_scaled(inertia, from, to);
        let at = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        for (index, (name, place)) in names.into_iter().zip(at).enumerate() {
            let value = stated.map_or(own[place], |scaled| scaled[index]);
            if value != number(Some(inertia), name) {
                written.push(editor.set_number(inertia, name, (0, value), &[]));
            }
        }
    }
    Ok(written)
}

/// The stated moments times one factor, where that is the whole change: they keep zeros and equal values.
fn own_or_scaled(inertia: Node<'_, '_>, from: &BodyMass, to: &BodyMass) -> Option<[f64; 6]> {
    let factor = scale(from, to)?;
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    Some(names.map(|name| factor * number(Some(inertia), name)))
}

/// The factor between two inertias; `None` where they differ by more than that.
pub(in crate::import) fn scale(from: &BodyMass, to: &BodyMass) -> Option<f64> {
    let trace = from.inertia_kg_m2.trace();
    let factor = to.inertia_kg_m2.trace() / trace;
    let rest = to.inertia_kg_m2 - from.inertia_kg_m2 * factor;
    (factor.is_finite() && rest.amax() <= 1e-12 * trace.abs()).then_some(factor)
}
