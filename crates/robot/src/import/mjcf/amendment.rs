//! Changes of an MJCF: which attribute of which element states a number of the compiled model.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Isometry3, Matrix3};
use roxmltree::Node;

use super::super::Options;
use super::super::amendment::{
    Amendment, BodyMass, Editor, JointQuantity, Outcome, Target, Written, counted, each, scale,
    shifted,
};
use super::super::element::words;
use super::super::note::Notes;
use super::super::tidy::clean;
use super::actuator::Actuator;
use super::element::Element;
use super::mass::{Mass, MassReader};
use super::model::{Joint, JointType, Model, Place};
use super::robot::{joint_name, names};
use super::settings::FromGeoms;
use realgap_core::error::Result;
use realgap_core::file::Source;
use realgap_core::text::fits;

/// Whether something can be done, and why not.
type Possible<T> = std::result::Result<T, String>;

/// The numbers of a shape that MuJoCo uses where a file states none.
const GEOM_LISTS: [(&str, &str); 5] = [
    ("friction", "1 0.005 0.0001"),
    ("solref", "0.02 1"),
    ("solimp", "0.9 0.95 0.001 0.5 2"),
    ("margin", "0"),
    ("gap", "0"),
];
/// The same of joints: numbers that need no others beside them.
const JOINT_NUMBERS: [&str; 6] = [
    "damping",
    "armature",
    "frictionloss",
    "stiffness",
    "springref",
    "margin",
];
/// The same of the simulation.
const OPTION_LISTS: [(&str, &str); 6] = [
    ("timestep", "0.002"),
    ("gravity", "0 0 -9.81"),
    ("wind", "0 0 0"),
    ("density", "0"),
    ("viscosity", "0"),
    ("impratio", "1"),
];
/// Actuators that hold a position with a gain `kp`.
const POSITION: [&str; 3] = ["position", "intvelocity", "pid"];

/// Applies amendments to an MJCF whose text is `text`.
///
/// # Errors
/// A file that is no model.
pub(in crate::import) fn amend(
    source: &Source,
    text: &str,
    options: &Options,
    editor: &mut Editor<'_, '_>,
    amendments: &[Amendment],
) -> Result<Vec<Outcome>> {
    let model = Model::read(text, source.path())?;
    let names = names(&model);
    let reader = MassReader {
        model: &model,
        main: source.path(),
        options,
        solids: Default::default(),
    };
    let masses = reader.all(&names, &mut Notes::default())?;
    let mut drives = Vec::new();
    for given in model.section("actuator") {
        let origin = &model.origins[given.origin];
        let compiled = Actuator::of(
            &origin.defaults.actuators(given),
            origin.settings.autolimits,
        )?;
        drives.extend(compiled.map(|compiled| (compiled, given)));
    }
    let bodies = model.bodies.iter();
    let joints = bodies.flat_map(|body| &body.joints);
    let places = (joints.map(|joint| joint.place.at))
        .chain(model.bodies.iter().skip(1).map(|body| body.place.at))
        .chain(drives.iter().map(|(_, given)| given.at));
    let amender = Amender {
        main: source.path(),
        copies: counted(places),
        model: &model,
        names,
        masses,
        drives,
    };
    Ok(each(editor, amendments, |editor, target| {
        amender.apply(editor, target)
    }))
}

/// A model, and what of it the numbers of a robot are read from.
struct Amender<'a> {
    main: &'a Path,
    model: &'a Model,
    /// How many elements of the model come from the element that begins at a byte.
    copies: BTreeMap<usize, usize>,
    names: Vec<String>,
    masses: Vec<Mass>,
    drives: Vec<(Actuator, &'a Element)>,
}

impl Amender<'_> {
    fn apply(&self, editor: &mut Editor<'_, '_>, target: &Target) -> Outcome {
        match target {
            Target::Joint {
                joint,
                quantity,
                from,
                to,
            } => self.joint(editor, joint, *quantity, (*from, *to)),
            Target::Body { body, from, to } => {
                let mut ids = 1..self.names.len();
                let known =
                    ids.find(|id| self.names[*id] == *body || clean(&self.names[*id]) == *body);
                let id = known.ok_or_else(|| format!("the file has no body `{body}`"))?;
                self.body(editor, id, from, to)
            }
            Target::Gravity(m_s2) => Ok(vec![option(editor, "gravity", (2, -m_s2))]),
            Target::Field { name, to } => self.field(editor, name, *to),
        }
    }

    /// The element of a place, which must be in the file itself and stand for itself only.
    fn here<'d>(&self, editor: &Editor<'_, 'd>, place: &Place) -> Possible<Node<'d, 'd>> {
        if place.file.as_path() != self.main {
            let file = place.file.file_name().unwrap_or_default().to_string_lossy();
            return Err(format!(
                "it is stated in the included file {file}: apply the results to that file"
            ));
        }
        if self.copies.get(&place.at).is_some_and(|copies| *copies > 1) {
            return Err("one element of the file makes several copies of it".to_owned());
        }
        let missing = || "its element was not found in the file".to_owned();
        editor.element(place.at).ok_or_else(missing)
    }

    fn joint(
        &self,
        editor: &mut Editor<'_, '_>,
        name: &str,
        quantity: JointQuantity,
        (from, to): (f64, f64),
    ) -> Outcome {
        let mut all = self
            .model
            .bodies
            .iter()
            .zip(&self.names)
            .flat_map(|(body, own)| {
                let each = body.joints.iter().enumerate();
                each.map(move |(index, joint)| (joint, joint_name(body, index, own)))
            });
        let found = all.find(|(_, own)| own == name || clean(own) == name);
        let Some((joint, _)) = found else {
            return Err(format!("the file has no joint `{name}`"));
        };
        let (attribute, own) = match quantity {
            JointQuantity::Viscous if joint.spring_damper.is_some() => {
                return Err("the joint's springdamper determines its damping".to_owned());
            }
            JointQuantity::Viscous => ("damping", joint.damping),
            JointQuantity::Dry => ("frictionloss", joint.dry),
            JointQuantity::Armature => ("armature", joint.armature),
            JointQuantity::ServoStiffness
            | JointQuantity::ServoDamping
            | JointQuantity::ServoLimit => return self.servo(editor, joint, quantity, (from, to)),
        };
        let value = shifted(own, from, to)?;
        let node = self.here(editor, &joint.place)?;
        Ok(vec![editor.set_number(node, attribute, (0, value), &[])])
    }

    fn servo(
        &self,
        editor: &mut Editor<'_, '_>,
        joint: &Joint,
        quantity: JointQuantity,
        (from, to): (f64, f64),
    ) -> Outcome {
        let mut own = self
            .drives
            .iter()
            .filter(|(drive, _)| drive.joint.is_some() && drive.joint == joint.name);
        let Some((drive, given)) = own.next() else {
            return Err("no actuator of the file drives this joint".to_owned());
        };
        let gear = drive.gear;
        match quantity {
            JointQuantity::ServoStiffness => {
                self.stiffness(editor, drive, given, drive.gain[0] * to / from)
            }
            JointQuantity::ServoDamping => self.damping(editor, drive, given, to / (gear * gear)),
            _ if joint.force_range.is_some() => {
                let node = self.here(editor, &joint.place)?;
                let text = format!("{} {to}", -to);
                Ok(vec![editor.set(node, "actuatorfrcrange", text)])
            }
            _ => self.force_limit(editor, drive, given, to / gear.abs()),
        }
    }

    /// Sets `kp` of an actuator.
    fn stiffness(
        &self,
        editor: &mut Editor<'_, '_>,
        drive: &Actuator,
        given: &Element,
        kp: f64,
    ) -> Outcome {
        let node = self.here(editor, &Place::of(given))?;
        if drive.bias[2] > 0.0 {
            return Err("the actuator's dampratio couples its damping to its stiffness".to_owned());
        }
        match given.tag.as_str() {
            tag if POSITION.contains(&tag) => Ok(vec![editor.set_number(node, "kp", (0, kp), &[])]),
            "general" if drive.bias_kind == "affine" => {
                let usual = |list: &[f64; 3]| list.map(|number| number.to_string());
                Ok(vec![
                    editor.set_number(node, "gainprm", (0, kp), &usual(&drive.gain)),
                    editor.set_number(node, "biasprm", (1, -kp), &usual(&drive.bias)),
                ])
            }
            tag => Err(format!("an actuator of the kind <{tag}> has no stiffness")),
        }
    }

    /// Sets `kv` of an actuator.
    fn damping(
        &self,
        editor: &mut Editor<'_, '_>,
        drive: &Actuator,
        given: &Element,
        kv: f64,
    ) -> Outcome {
        let node = self.here(editor, &Place::of(given))?;
        if drive.bias[2] > 0.0 {
            return Err("the actuator's dampratio determines its damping".to_owned());
        }
        match given.tag.as_str() {
            "velocity" => Ok(vec![editor.set_number(node, "kv", (0, kv), &[])]),
            tag if POSITION.contains(&tag) => Ok(vec![editor.set_number(node, "kv", (0, kv), &[])]),
            "general" if drive.bias_kind == "affine" => {
                let usual = drive.bias.map(|number| number.to_string());
                Ok(vec![editor.set_number(node, "biasprm", (2, -kv), &usual)])
            }
            tag => Err(format!("an actuator of the kind <{tag}> has no damping")),
        }
    }

    /// Sets the force limit of an actuator, equal in both directions.
    fn force_limit(
        &self,
        editor: &mut Editor<'_, '_>,
        drive: &Actuator,
        given: &Element,
        most: f64,
    ) -> Outcome {
        if drive.force_range.is_none() && drive.command_range.is_some() && drive.bias[1] == 0.0 {
            return Err("the range of the command (ctrlrange) limits this actuator".to_owned());
        }
        let node = self.here(editor, &Place::of(given))?;
        let text = format!("{} {most}", -most);
        let mut written = vec![editor.set(node, "forcerange", text)];
        let origin = &self.model.origins[given.origin];
        if drive.force_range.is_none() && !origin.settings.autolimits {
            written.push(editor.set(node, "forcelimited", "true".to_owned()));
        }
        Ok(written)
    }

    fn body(
        &self,
        editor: &mut Editor<'_, '_>,
        id: usize,
        from: &BodyMass,
        to: &BodyMass,
    ) -> Outcome {
        let body = &self.model.bodies[id];
        let settings = &self.model.origins[0].settings;
        if settings.from_geoms == FromGeoms::Always {
            return Err("inertiafromgeom makes all masses those of the shapes".to_owned());
        }
        if settings.total_mass_kg.is_some() {
            return Err("settotalmass scales all masses".to_owned());
        }
        let Some((given, pose)) = &body.inertial else {
            let node = self.here(editor, &body.place)?;
            return Ok(whole_inertial(editor, node, to));
        };
        let node = self.here(editor, &Place::of(given))?;
        let mut written: Vec<Written> = Vec::new();
        if to.mass_kg != from.mass_kg {
            written.push(editor.set_number(node, "mass", (0, to.mass_kg), &[]));
        }
        if to.centre_m != from.centre_m {
            let is_in_frame = node
                .parent_element()
                .is_some_and(|above| !above.has_tag_name("body"));
            if is_in_frame {
                return Err("the <inertial> stands in a <frame>".to_owned());
            }
            let text = format!("{} {} {}", to.centre_m.x, to.centre_m.y, to.centre_m.z);
            written.push(editor.set(node, "pos", text));
        }
        if to.inertia_kg_m2 != from.inertia_kg_m2 {
            written.extend(moments(editor, node, (from, to), pose)?);
        }
        Ok(written)
    }

    fn field(&self, editor: &mut Editor<'_, '_>, name: &str, to: f64) -> Outcome {
        let (kind, rest) = name.split_once('.').unwrap_or((name, ""));
        let unknown = || format!("`{name}` is no field of an MJCF that can be written");
        if kind == "option" {
            let (attribute, index) = indexed(rest).ok_or_else(unknown)?;
            let is_known = OPTION_LISTS.iter().any(|(known, _)| *known == attribute);
            return match is_known {
                true => Ok(vec![option(editor, attribute, (index, to))]),
                false => Err(unknown()),
            };
        }
        let (form, quantity) = rest.rsplit_once('.').ok_or_else(unknown)?;
        let (attribute, index) = indexed(quantity).ok_or_else(unknown)?;
        let is_meant = |own: Option<&str>| own.is_some_and(|own| fits(form, own));
        let mut written = Vec::new();
        match kind {
            "joint" if JOINT_NUMBERS.contains(&attribute) && index == 0 => {
                let joints = self.model.bodies.iter().flat_map(|body| &body.joints);
                for joint in joints.filter(|joint| is_meant(joint.name.as_deref())) {
                    let node = self.here(editor, &joint.place)?;
                    let is_angle = matches!(joint.kind, JointType::Hinge | JointType::Ball);
                    let is_degree = self.model.origins[0].settings.degree && is_angle;
                    let value = match attribute == "springref" && is_degree {
                        true => to.to_degrees(),
                        false => to,
                    };
                    written.push(editor.set_number(node, attribute, (0, value), &[]));
                }
            }
            "geom" => {
                let lists = GEOM_LISTS.iter().find(|(known, _)| *known == attribute);
                let (_, usual) = lists.ok_or_else(unknown)?;
                let geoms = self.model.bodies.iter().flat_map(|body| &body.geoms);
                for geom in geoms.filter(|geom| is_meant(geom.element.get("name"))) {
                    let node = self.here(editor, &Place::of(&geom.element))?;
                    let stated = geom.element.get(attribute).unwrap_or_default();
                    let more = words(usual).skip(words(stated).count());
                    let usual: Vec<String> = words(stated).chain(more).map(str::to_owned).collect();
                    written.push(editor.set_number(node, attribute, (index, to), &usual));
                }
            }
            "body" if attribute == "mass" => {
                for id in 1..self.names.len() {
                    if is_meant(self.model.bodies[id].name.as_deref()) {
                        let from = self.mass(id);
                        let after = BodyMass {
                            mass_kg: to,
                            inertia_kg_m2: from.inertia_kg_m2 * (to / from.mass_kg),
                            ..from
                        };
                        written.extend(self.body(editor, id, &from, &after)?);
                    }
                }
            }
            "body" if attribute == "gravcomp" => {
                for body in &self.model.bodies[1..] {
                    if is_meant(body.name.as_deref()) {
                        let node = self.here(editor, &body.place)?;
                        written.push(editor.set_number(node, attribute, (0, to), &[]));
                    }
                }
            }
            "actuator" => {
                for (drive, given) in &self.drives {
                    if !is_meant(given.get("name")) {
                        continue;
                    }
                    written.extend(match attribute {
                        "kp" => self.stiffness(editor, drive, given, to)?,
                        "kv" => self.damping(editor, drive, given, to)?,
                        "forcerange" => self.force_limit(editor, drive, given, to)?,
                        "gear" => {
                            let node = self.here(editor, &Place::of(given))?;
                            vec![editor.set_number(node, "gear", (index, to), &[])]
                        }
                        _ => return Err(unknown()),
                    });
                }
            }
            _ => return Err(unknown()),
        }
        match written.is_empty() {
            true => Err(format!("the file has no {kind} with the name `{form}`")),
            false => Ok(written),
        }
    }

    fn mass(&self, id: usize) -> BodyMass {
        let Mass {
            mass_kg,
            centre_m,
            inertia_kg_m2,
        } = self.masses[id];
        BodyMass {
            mass_kg,
            centre_m,
            inertia_kg_m2,
        }
    }
}

/// Changes the moments that an `<inertial>` with this pose in its body states.
fn moments<'d>(
    editor: &mut Editor<'_, 'd>,
    node: Node<'d, 'd>,
    (from, to): (&BodyMass, &BodyMass),
    pose: &Isometry3<f64>,
) -> Outcome {
    let name = match node.has_attribute("fullinertia") {
        true => "fullinertia",
        false => "diaginertia",
    };
    let stated = node.attribute(name).unwrap_or_default();
    let stated: Option<Vec<f64>> = words(stated).map(|word| word.parse().ok()).collect();
    let stated = stated
        .filter(|all| !all.is_empty())
        .ok_or("its moments are not stated")?;
    if let Some(factor) = scale(from, to) {
        let scaled = stated.iter().map(|moment| (factor * moment).to_string());
        let text = scaled.collect::<Vec<_>>().join(" ");
        return Ok(vec![editor.set(node, name, text)]);
    }
    let turn = pose.rotation.to_rotation_matrix();
    let own = turn.transpose() * to.inertia_kg_m2 * turn;
    let is_turned = ["quat", "euler", "axisangle", "xyaxes", "zaxis"]
        .into_iter()
        .filter(|name| node.has_attribute(*name));
    let is_turned: Vec<&str> = is_turned.collect();
    // MuJoCo refuses an orientation beside a full tensor, which is then one along the axes of the body.
    let full = match is_turned.is_empty() {
        true => own,
        false => to.inertia_kg_m2,
    };
    is_turned.iter().for_each(|name| editor.remove(node, name));
    if name == "diaginertia" {
        editor.remove(node, name);
    }
    Ok(vec![editor.set(node, "fullinertia", full_tensor(&full))])
}

/// Adds an `<inertial>` to a body that has the mass of its shapes.
fn whole_inertial<'d>(
    editor: &mut Editor<'_, 'd>,
    body: Node<'d, 'd>,
    to: &BodyMass,
) -> Vec<Written> {
    let pos = format!("{} {} {}", to.centre_m.x, to.centre_m.y, to.centre_m.z);
    let attributes = [
        ("pos", pos),
        ("mass", to.mass_kg.to_string()),
        ("fullinertia", full_tensor(&to.inertia_kg_m2)),
    ];
    let set = attributes.into_iter();
    set.map(|(name, text)| editor.set_of_new_child(body, "inertial", name, text))
        .collect()
}

fn full_tensor(inertia: &Matrix3<f64>) -> String {
    let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    places.map(|place| inertia[place].to_string()).join(" ")
}

/// Sets a number of the `<option>` that holds, or of a new one.
fn option(editor: &mut Editor<'_, '_>, attribute: &str, (index, value): (usize, f64)) -> Written {
    let root = editor.document().root_element();
    let usual = OPTION_LISTS.iter().find(|(known, _)| *known == attribute);
    let usual: Vec<String> = usual
        .map(|(_, text)| words(text).map(str::to_owned).collect())
        .unwrap_or_default();
    let all = || root.children().filter(|node| node.has_tag_name("option"));
    let stating = all().rfind(|node| node.has_attribute(attribute));
    if let Some(node) = stating.or_else(|| all().next_back()) {
        return editor.set_number(node, attribute, (index, value), &usual);
    }
    let mut numbers = usual;
    if let Some(number) = numbers.get_mut(index) {
        *number = value.to_string();
    }
    editor.set_of_new_child(root, "option", attribute, numbers.join(" "))
}

/// The attribute and the number of it that a name like `solref[1]` means.
fn indexed(quantity: &str) -> Option<(&str, usize)> {
    match quantity.strip_suffix(']') {
        None => Some((quantity, 0)),
        Some(rest) => {
            let (attribute, index) = rest.split_once('[')?;
            Some((attribute, index.parse().ok().filter(|index| *index < 10)?))
        }
    }
}
