//! Conversion of URDF joints; a joint with several degrees of freedom becomes a chain of joints with one each.

use nalgebra::Vector3;
use roxmltree::Node;

use super::element::child;
use super::note::Notes;
use super::urdf::Robot;
use crate::morphology::Servo;
use crate::morphology::body::{
    Body, Driver, Follow, Joint, JointKind, Pose, SlideSpring, Structure, TurnSpring,
};
use realgap_core::error::{Error, Result};

/// Limits beyond this value count as no limits, radians or metres.
const FAR: f64 = 1e3;
/// Largest allowed torque (N m) and speed (rad/s) of a servo.
const MOST: f64 = 1e4;

impl Robot<'_> {
    pub(super) fn joint(
        &mut self,
        node: Node<'_, '_>,
        name: String,
        notes: &mut Notes,
    ) -> Result<()> {
        let place = self.reader.place;
        let line = place.line(node);
        let end = |tag: &'static str| -> Result<String> {
            let end = child(node, tag).ok_or_else(|| {
                place.at(
                    node,
                    Error::invalid(format!("the joint `{name}` has no <{tag}>")),
                )
            })?;
            let link = place.text(end, "link")?;
            if self.lines.contains_key(link) {
                return Ok(link.to_owned());
            }
            let names = self.lines.keys().map(String::as_str);
            Err(place.at(end, realgap_core::file::unknown_name("link", link, names)))
        };
        let (parent, child_name) = (end("parent")?, end("child")?);
        let pose = Pose::of(&place.origin(node)?);
        let axis = match child(node, "axis") {
            Some(axis) => place.vector(axis, "xyz")?,
            None => Vector3::x(),
        };
        let kind = place.text(node, "type")?;
        let joint = |kind: JointKind| Joint {
            name: name.clone(),
            parent: parent.clone(),
            child: child_name.clone(),
            pose,
            kind,
            start: None,
        };
        let moves = matches!(kind, "revolute" | "continuous" | "prismatic");
        if moves && axis.norm() < 1e-9 {
            return Err(place.at(
                node,
                Error::invalid(format!("the axis of joint `{name}` has no direction"))
                    .found("0 0 0"),
            ));
        }
        let bearing = self.bearing(node, kind, &name, notes)?;
        match kind {
            "fixed" => self.structure.joints.push(joint(JointKind::Fixed)),
            "revolute" | "continuous" => self.structure.joints.push(joint(bearing.turn(&axis))),
            "prismatic" => self.structure.joints.push(joint(bearing.slide(&axis))),
            "floating" | "planar" | "spherical" | "ball" => {
                self.many(&joint(JointKind::Fixed), kind, line, notes);
            }
            other => {
                let error = Error::invalid("unknown type of joint")
                    .found(format!("{other} of `{name}`"))
                    .allowed("fixed, revolute, continuous, prismatic, floating, planar, spherical");
                return Err(place.at(node, error));
            }
        }
        if moves && !self.reader.options.passive {
            self.servo(node, &name, bearing.effort, bearing.velocity, notes)?;
        }
        Ok(())
    }

    /// Friction and limits of a joint.
    fn bearing(
        &self,
        node: Node<'_, '_>,
        kind: &str,
        name: &str,
        notes: &mut Notes,
    ) -> Result<Bearing> {
        let place = self.reader.place;
        let mut bearing = Bearing::default();
        if let Some(dynamics) = child(node, "dynamics") {
            let mut read = |attribute: &str| -> Result<f64> {
                let value = place.number(dynamics, attribute)?.unwrap_or(0.0);
                if value < 0.0 {
                    let what = format!("the {attribute} of joint `{name}` is {value}: 0 is used");
                    notes.changed(
                        place.line(dynamics),
                        what,
                        "friction dissipates energy: state a value of 0 or more",
                    );
                }
                Ok(value.max(0.0))
            };
            (bearing.viscous, bearing.dry) = (read("damping")?, read("friction")?);
            let stiffness = place
                .number(dynamics, "stiffness")?
                .or(place.number(dynamics, "spring_stiffness")?);
            let rest = place.number(dynamics, "spring_reference")?.unwrap_or(0.0);
            bearing.spring = stiffness.filter(|k| *k > 0.0).map(|k| (k, rest));
        }
        let Some(limit) = child(node, "limit") else {
            if kind == "prismatic" || kind == "revolute" {
                let what = format!("the {kind} joint `{name}` has no limits");
                notes.assumed(
                    place.line(node),
                    what,
                    "add <limit lower=... upper=... effort=... velocity=.../>",
                );
            }
            return Ok(bearing);
        };
        let end = |name: &str| -> Result<f64> {
            // Some files write `inf` for an absent limit.
            match limit
                .attribute(name)
                .and_then(|text| text.trim().parse().ok())
            {
                Some(value) if f64::is_infinite(value) => Ok(value),
                _ => Ok(place.number(limit, name)?.unwrap_or(0.0)),
            }
        };
        (bearing.effort, bearing.velocity) = (end("effort")?, end("velocity")?);
        let (lower, upper) = (end("lower")?, end("upper")?);
        let is_limited = kind == "revolute" || kind == "prismatic";
        // Such limits exceed those of any robot; some files write them instead of leaving the limits out.
        let are_far = lower <= -FAR && upper >= FAR;
        bearing.limits = (is_limited && lower < upper && !are_far).then_some((lower, upper));
        if is_limited && lower >= upper {
            let what = format!(
                "the limits {lower} to {upper} of joint `{name}` leave no range: they are ignored"
            );
            notes.changed(
                place.line(limit),
                what,
                "state the range, or make the joint fixed",
            );
        }
        Ok(bearing)
    }

    /// Converts a joint with several degrees of freedom into a chain of joints with one each, connected by links without mass and
    /// shape.
    fn many(&mut self, joint: &Joint, kind: &str, line: Option<usize>, notes: &mut Notes) {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let free = Bearing::default();
        let chain: Vec<(&str, JointKind)> = match kind {
            "planar" => vec![
                ("x", free.slide(&x)),
                ("y", free.slide(&y)),
                ("turn", free.turn(&z)),
            ],
            "spherical" | "ball" => vec![
                ("roll", free.turn(&x)),
                ("pitch", free.turn(&y)),
                ("yaw", free.turn(&z)),
            ],
            _ => vec![
                ("x", free.slide(&x)),
                ("y", free.slide(&y)),
                ("z", free.slide(&z)),
                ("roll", free.turn(&x)),
                ("pitch", free.turn(&y)),
                ("yaw", free.turn(&z)),
            ],
        };
        let what = format!(
            "the {kind} joint `{}` is replaced by a chain of {} joints with one degree of freedom each",
            joint.name,
            chain.len()
        );
        notes.changed(
            line,
            what,
            "at a pitch of 90 degrees it loses one degree of freedom (gimbal lock): avoid that orientation",
        );
        chained(&mut self.structure, joint, chain);
    }

    fn servo(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        effort: f64,
        velocity: f64,
        notes: &mut Notes,
    ) -> Result<()> {
        let place = self.reader.place;
        let mimic = child(node, "mimic");
        let driven = self.reader.options.driven.get(name).copied();
        if effort <= 0.0 {
            self.passive += usize::from(driven.is_none());
            if let Some(mimic) = mimic {
                let what =
                    format!("the mimic relation of joint `{name}`, which states no effort above 0");
                notes.left_out(place.line(mimic), what, "state an effort in its limit");
            }
            return Ok(());
        }
        if effort > MOST || velocity > MOST {
            let what = format!(
                "the effort {effort} or velocity {velocity} of joint `{name}`: reduced to at most {MOST}"
            );
            notes.changed(place.line(node), what, "state the limits of its motor");
        }
        let follows = match mimic {
            None => None,
            Some(mimic) => Some(Follow {
                joint: place.text(mimic, "joint")?.to_owned(),
                factor: place.number(mimic, "multiplier")?.unwrap_or(1.0),
                offset_rad: place.number(mimic, "offset")?.unwrap_or(0.0),
            }),
        };
        if let (Some(follow), Some(mimic)) = (&follows, mimic) {
            let what = format!(
                "joint `{name}` is not coupled to `{}`: it has its own servo, which copies the command of `{}`",
                follow.joint, follow.joint
            );
            notes.changed(
                place.line(mimic),
                what,
                "their angles differ where a load deflects one of them",
            );
        }
        let max_torque_nm = effort.min(MOST);
        let servo = Servo {
            law: driven.unwrap_or(self.reader.options.law).of(max_torque_nm),
            max_torque_nm,
            max_speed_rad_s: if velocity > 0.0 {
                velocity.min(MOST)
            } else {
                f64::INFINITY
            },
            delay_s: 0.0,
            torque_constant_nm_a: None,
        };
        // Gains that a user states replace this law.
        let is_given = self.reader.options.gains.contains_key(name);
        if let Some(law) = driven
            && !is_given
        {
            let what = format!(
                "the servo of joint `{name}`, which the recordings command: URDF states only its limits; it {}",
                law.words()
            );
            notes.assumed(
                place.line(node),
                what,
                "state its control law in `actuators`",
            );
        }
        self.servos += usize::from(driven.is_none() && !is_given);
        self.structure.actuators.push(Driver {
            joint: name.to_owned(),
            servo,
            gait: None,
            follows,
            command: None,
        });
        Ok(())
    }
}

/// Friction, limits and servo limits of a joint, in radians or metres.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bearing {
    pub viscous: f64,
    pub dry: f64,
    pub armature: f64,
    pub spring: Option<(f64, f64)>,
    pub limits: Option<(f64, f64)>,
    pub effort: f64,
    pub velocity: f64,
}

impl Bearing {
    /// The kind of joint for a rotation about an axis.
    pub fn turn(&self, axis: &Vector3<f64>) -> JointKind {
        JointKind::Turn {
            axis: (axis.x, axis.y, axis.z),
            anchor_m: (0.0, 0.0, 0.0),
            limits_rad: self.limits,
            viscous_nm_s_rad: self.viscous,
            dry_nm: self.dry,
            armature_kg_m2: self.armature,
            spring: self.spring.map(|(stiffness_nm_rad, rest_rad)| TurnSpring {
                stiffness_nm_rad,
                rest_rad,
            }),
        }
    }

    /// The kind of joint for a translation along an axis.
    pub fn slide(&self, axis: &Vector3<f64>) -> JointKind {
        JointKind::Slide {
            axis: (axis.x, axis.y, axis.z),
            limits_m: self.limits,
            viscous_n_s_m: self.viscous,
            dry_n: self.dry,
            armature_kg: self.armature,
            spring: self.spring.map(|(stiffness_n_m, rest_m)| SlideSpring {
                stiffness_n_m,
                rest_m,
            }),
        }
    }
}

/// Adds a chain of joints in place of one, with bodies without mass and shape between them; the first joint gets the pose.
pub(super) fn chained(structure: &mut Structure, joint: &Joint, chain: Vec<(&str, JointKind)>) {
    let count = chain.len();
    let mut parent = joint.parent.clone();
    for (index, (name, kind)) in chain.into_iter().enumerate() {
        let is_last = index + 1 == count;
        let child = match is_last {
            true => joint.child.clone(),
            false => format!("{}_{name}", joint.child),
        };
        if !is_last {
            structure.bodies.push(Body {
                name: child.clone(),
                ..Body::default()
            });
        }
        structure.joints.push(Joint {
            name: format!("{}_{name}", joint.name),
            parent: std::mem::replace(&mut parent, child.clone()),
            child,
            pose: if index == 0 {
                joint.pose
            } else {
                Pose::default()
            },
            kind,
            start: joint.start.filter(|_| is_last),
        });
    }
}
