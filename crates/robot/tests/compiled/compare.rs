//! Compares an imported robot with what MuJoCo compiles from the same file.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use realgap_robot::import::Imported;
use realgap_robot::morphology::ServoLaw;
use realgap_robot::morphology::body::{Driver, Joint, JointKind, Pose};
use serde_json::Value;

/// Largest relative difference of the contract.
pub const MOST: f64 = 1e-9;
/// Torque limit of an actuator for which the file states none.
const UNLIMITED: f64 = 1e4;

/// The numbers of a list.
fn list<const N: usize>(value: &Value) -> [f64; N] {
    let all = value.as_array().expect("a list");
    std::array::from_fn(|index| all[index].as_f64().expect("a number"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from(list::<3>(value))
}

fn turn(value: &Value) -> UnitQuaternion<f64> {
    let [w, x, y, z] = list::<4>(value);
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let (x, y, z) = pose.at_m;
    let (w, i, j, k) = pose.quaternion.unwrap_or((1.0, 0.0, 0.0, 0.0));
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::new(x, y, z), turn)
}

/// A name as the import changes it.
fn clean(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect()
}

/// Compares the numbers of an imported robot with those that MuJoCo compiled, and returns the largest differences by field.
pub struct Comparison<'a> {
    imported: &'a Imported,
    /// Largest relative difference of each field, and where.
    pub largest: BTreeMap<&'static str, (f64, String)>,
    /// Values of the file that are not in the robot and of which a note speaks.
    pub said: BTreeSet<String>,
    /// The same, of which no note speaks.
    pub unsaid: Vec<String>,
    /// How many numbers were compared.
    pub numbers: usize,
}

impl<'a> Comparison<'a> {
    pub fn of(imported: &'a Imported, compiled: &Value) -> Self {
        let mut all = Self {
            imported,
            largest: BTreeMap::new(),
            said: BTreeSet::new(),
            unsaid: Vec::new(),
            numbers: 0,
        };
        all.bodies(compiled);
        for joint in compiled["joints"].as_array().expect("joints") {
            all.joint(joint);
        }
        all
    }

    /// Fields that differ by more than the contract allows.
    pub fn broken(&self) -> Vec<String> {
        let beyond = self
            .largest
            .iter()
            .filter(|(_, (size, _))| *size > MOST || size.is_nan());
        (beyond.map(|(field, (size, place))| format!("{field} of {place}: {size:.2e}")))
            .chain(self.unsaid.iter().map(|what| format!("unsaid: {what}")))
            .collect()
    }

    /// Whether a note speaks of this name.
    fn is_said(&self, name: &str, about: &str) -> bool {
        let mut notes = self.imported.notes.iter();
        notes.any(|note| note.what.contains(name) && note.what.contains(about))
    }

    fn miss(&mut self, name: &str, about: &str, what: String) {
        match self.is_said(name, about) {
            true => drop(self.said.insert(what)),
            false => self.unsaid.push(what),
        }
    }

    fn differ(
        &mut self,
        field: &'static str,
        place: &str,
        ours: &[f64],
        theirs: &[f64],
        least: f64,
    ) {
        let size = theirs.iter().fold(least, |a, b| a.max(b.abs()));
        let off = ours
            .iter()
            .zip(theirs)
            .map(|(a, b)| (a - b).abs() / size)
            .fold(0.0, f64::max);
        let off = if ours.iter().all(|value| value.is_finite()) {
            off
        } else {
            f64::NAN
        };
        self.numbers += ours.len();
        let known = self.largest.entry(field).or_insert((0.0, String::new()));
        if off > known.0 || off.is_nan() {
            *known = (off, format!("{place} ({ours:?} for {theirs:?})"));
        }
    }

    fn bodies(&mut self, compiled: &Value) {
        let structure = &self.imported.structure;
        let bodies = compiled["bodies"].as_array().expect("bodies");
        let names: Vec<&str> = bodies.iter().map(|body| text(&body["name"])).collect();
        for body in bodies {
            let name = clean(text(&body["name"]));
            let Some(ours) = structure.bodies.iter().find(|ours| ours.name == name) else {
                self.miss(&name, "", format!("body {name}"));
                continue;
            };
            let mass = number(&body["mass"]);
            self.differ("mass", &name, &[ours.mass_kg], &[mass], 1e-12);
            self.differ(
                "gravcomp",
                &name,
                &[ours.gravity_compensation],
                &[number(&body["gravcomp"])],
                1e-12,
            );
            if mass > 0.0 {
                let (x, y, z) = ours.centre_of_mass_m.unwrap_or_default();
                self.differ(
                    "centre of mass",
                    &name,
                    &[x, y, z],
                    vector(&body["ipos"]).as_slice(),
                    1e-3,
                );
                let own = ours
                    .inertia_kg_m2
                    .map_or(Matrix3::zeros(), |tensor| tensor.matrix());
                let axes = turn(&body["iquat"]).to_rotation_matrix();
                let theirs =
                    axes * Matrix3::from_diagonal(&vector(&body["inertia"])) * axes.transpose();
                self.differ("inertia", &name, own.as_slice(), theirs.as_slice(), 1e-300);
            }
            // The pose of a body is that of the first joint above it; a free root has none.
            let parent = body["parent"].as_u64().expect("an index") as usize;
            let parent = if parent == 0 {
                "world"
            } else {
                names[parent - 1]
            };
            let mut above = structure.joints.iter().find(|joint| joint.child == name);
            while let Some(joint) = above.filter(|joint| joint.parent != clean(parent)) {
                above = structure
                    .joints
                    .iter()
                    .find(|other| other.child == joint.parent);
            }
            if let Some(joint) = above {
                let pose = isometry(&joint.pose);
                let at = pose.translation.vector;
                self.differ(
                    "position of a body",
                    &name,
                    at.as_slice(),
                    vector(&body["pos"]).as_slice(),
                    1e-3,
                );
                let own = pose.rotation.to_rotation_matrix();
                let theirs: Rotation3<f64> = turn(&body["quat"]).to_rotation_matrix();
                self.differ(
                    "orientation of a body",
                    &name,
                    own.matrix().as_slice(),
                    theirs.matrix().as_slice(),
                    1.0,
                );
            }
        }
    }

    fn joint(&mut self, given: &Value) {
        let name = clean(text(&given["name"]));
        let structure = &self.imported.structure;
        let Some(joint) = structure.joints.iter().find(|joint| joint.name == name) else {
            self.miss(&name, "", format!("joint {name}"));
            return;
        };
        let Some(motion) = Motion::of(joint) else {
            self.miss(&name, "have no mass", format!("joint {name} is fixed"));
            return;
        };
        let drives = given["drives"].as_array().expect("drives");
        let reference = number(&given["reference"]);
        self.differ(
            "axis",
            &name,
            motion.axis.as_slice(),
            vector(&given["axis"]).as_slice(),
            1.0,
        );
        if !given["slides"].as_bool().expect("a truth") {
            self.differ(
                "anchor",
                &name,
                motion.anchor_m.as_slice(),
                vector(&given["anchor"]).as_slice(),
                1e-3,
            );
        }
        match (motion.limits, given["range"].is_null()) {
            (Some((low, high)), false) => {
                self.differ(
                    "range",
                    &name,
                    &[low, high],
                    &list::<2>(&given["range"]),
                    1e-3,
                );
            }
            (None, true) => {}
            (ours, _) => self
                .unsaid
                .push(format!("range of {name}: {ours:?} for {}", given["range"])),
        }
        let (stiffness, rest) = motion.spring.unwrap_or_default();
        self.differ(
            "stiffness",
            &name,
            &[stiffness],
            &[number(&given["stiffness"])],
            1e-12,
        );
        if stiffness > 0.0 {
            self.differ("rest", &name, &[rest], &[number(&given["rest"])], 1e-3);
        }
        self.differ(
            "frictionloss",
            &name,
            &[motion.dry],
            &[number(&given["dry"])],
            1e-12,
        );
        let driver = structure
            .actuators
            .iter()
            .find(|driver| driver.joint == name);
        // MuJoCo adds armature and damping of an actuator at run time, reflected by its gear.
        let reflected = |field: &str| {
            let each = drives
                .iter()
                .map(|drive| number(&drive[field]) * number(&drive["gear"]).powi(2));
            number(&given[field]) + each.sum::<f64>()
        };
        self.differ(
            "armature",
            &name,
            &[motion.armature],
            &[reflected("armature")],
            1e-12,
        );
        let mut damping = reflected("damping");
        match (driver, drives.first()) {
            (Some(driver), Some(drive)) => {
                let bias = list::<3>(&drive["bias"]);
                let gear = number(&drive["gear"]);
                if driver.servo.law == ServoLaw::Direct {
                    damping += (-bias[2] * gear * gear).max(0.0);
                }
                self.drive(&name, driver, drive, &given["force"], reference);
            }
            (None, Some(drive)) => {
                let own = clean(text(&drive["name"]));
                self.miss(
                    text(&drive["name"]),
                    "",
                    format!("actuator {own} of {name}"),
                );
            }
            (Some(_), None) => self
                .unsaid
                .push(format!("an actuator at {name} that the file lacks")),
            (None, None) => {}
        }
        self.differ("damping", &name, &[motion.viscous], &[damping], 1e-12);
        for more in drives.iter().skip(1) {
            self.miss(
                text(&more["name"]),
                "already",
                format!("second actuator of {name}"),
            );
        }
    }

    fn drive(
        &mut self,
        joint: &str,
        driver: &Driver,
        drive: &Value,
        force: &Value,
        reference: f64,
    ) {
        let (gear, gain, bias) = (
            number(&drive["gear"]),
            number(&drive["gain"][0]),
            list::<3>(&drive["bias"]),
        );
        if drive["dynamics"] != 0 {
            self.miss(joint, "activation", format!("activation of {joint}"));
        }
        // Torque at the joint: a · command + b − k · coordinate − d · speed.
        let (a, b) = (gear * gain, gear * (bias[0] + bias[1] * gear * reference));
        let (k, d) = (-bias[1] * gear * gear, -bias[2] * gear * gear);
        let scale = driver.command.unwrap_or_default();
        match driver.servo.law {
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => {
                // A servo of speeds scales commands by its damping.
                let by = if stiffness_nm_rad > 0.0 {
                    stiffness_nm_rad
                } else {
                    damping_nm_s_rad
                };
                self.differ("kp", joint, &[stiffness_nm_rad], &[k], 1e-12);
                if d < 0.0 {
                    self.miss(
                        text(&drive["name"]),
                        "negative damping",
                        format!("negative damping of {joint}"),
                    );
                } else {
                    self.differ("kv", joint, &[damping_nm_s_rad], &[d], 1e-12);
                }
                self.differ("gear and gain", joint, &[scale.factor * by], &[a], 1e-12);
                self.differ("offset", joint, &[scale.offset * by], &[b], 1e-3 * by);
            }
            ServoLaw::Direct => {
                self.differ("kp", joint, &[0.0], &[k], 1e-12);
                self.differ("gear and gain", joint, &[scale.factor], &[a], 1e-12);
                self.differ("offset", joint, &[scale.offset], &[b], 1e-3);
            }
            other => self.unsaid.push(format!("law of {joint}: {other:?}")),
        }
        // The bounds of the torque, and those of the command.
        let mut bound: Option<[f64; 2]> = None;
        if !drive["force"].is_null() {
            let [low, high] = list::<2>(&drive["force"]).map(|value| value * gear);
            bound = Some([low.min(high), low.max(high)]);
        }
        if !force.is_null() {
            let [low, high] = list::<2>(force);
            bound = Some(bound.map_or([low, high], |[a, b]| [a.max(low), b.min(high)]));
        }
        let commands = (!drive["command"].is_null()).then(|| list::<2>(&drive["command"]));
        match (scale.range, commands) {
            (Some((low, high)), Some(theirs)) => {
                self.differ("command range", joint, &[low, high], &theirs, 1e-3);
            }
            (None, None) => {}
            // The torque limit of a motor bounds a symmetric command, too.
            (None, Some([low, high])) if driver.servo.law == ServoLaw::Direct && low == -high => {
                bound = Some(bound.map_or([a * low, a * high], |[x, y]| {
                    [x.max(a * low), y.min(a * high)]
                }));
            }
            (ours, theirs) => self
                .unsaid
                .push(format!("commands of {joint}: {ours:?} for {theirs:?}")),
        }
        let most = bound.map_or(UNLIMITED, |[low, high]| low.abs().max(high.abs()));
        let by_command = match (driver.servo.law, commands) {
            (ServoLaw::Direct, Some([low, high])) => (a * low + b).abs().max((a * high + b).abs()),
            _ => f64::INFINITY,
        };
        let asymmetric = bound.is_some_and(|[low, high]| (low + high).abs() > 1e-9 * most);
        if asymmetric && by_command > most {
            self.miss(joint, "limited", format!("asymmetric force of {joint}"));
        }
        if most > UNLIMITED {
            self.miss("", "reduced", format!("force limit {most} of {joint}"));
        }
        let theirs = most.min(by_command).min(UNLIMITED);
        self.differ(
            "force range",
            joint,
            &[driver.servo.max_torque_nm],
            &[theirs],
            1e-9,
        );
    }
}

/// The motion of a joint, turning or sliding.
struct Motion {
    axis: Vector3<f64>,
    anchor_m: Vector3<f64>,
    limits: Option<(f64, f64)>,
    viscous: f64,
    dry: f64,
    armature: f64,
    spring: Option<(f64, f64)>,
}

impl Motion {
    fn of(joint: &Joint) -> Option<Self> {
        let vector = |(x, y, z): (f64, f64, f64)| Vector3::new(x, y, z);
        Some(match joint.kind {
            JointKind::Fixed => return None,
            JointKind::Turn {
                axis,
                anchor_m,
                limits_rad,
                viscous_nm_s_rad,
                dry_nm,
                armature_kg_m2,
                spring,
            } => Self {
                axis: vector(axis),
                anchor_m: vector(anchor_m),
                limits: limits_rad,
                viscous: viscous_nm_s_rad,
                dry: dry_nm,
                armature: armature_kg_m2,
                spring: spring.map(|s| (s.stiffness_nm_rad, s.rest_rad)),
            },
            JointKind::Slide {
                axis,
                limits_m,
                viscous_n_s_m,
                dry_n,
                armature_kg,
                spring,
            } => Self {
                axis: vector(axis),
                anchor_m: Vector3::zeros(),
                limits: limits_m,
                viscous: viscous_n_s_m,
                dry: dry_n,
                armature: armature_kg,
                spring: spring.map(|s| (s.stiffness_n_m, s.rest_m)),
            },
        })
    }
}
