//! Assembly of a robot of bodies: combines bodies that are fixed to each other into rigid parts that joints connect.

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, Point3, SymmetricEigen, Unit, Vector3};

use super::super::assembly::{Actuator, Assembly, Gait, Hinge, Mark, Part, Role, Solid};
use super::super::flaw::{Checked, Flaw};
use super::super::law::ServoLaw;
use super::super::module::{check_actuator, check_name};
use super::check::{SINGULAR, check_body, check_joint, check_pose};
use super::motion::Motion;
use super::tree::{Tree, by_name, look_up};
use super::{Structure, vector};
use realgap_core::Error;
use realgap_core::file::unknown_name;
use realgap_solid::Shape;

/// Largest number of bodies of one robot.
pub(crate) const MAX_BODIES: usize = 1000;

impl Structure {
    /// Checks the structure and assembles it; bodies connected by fixed joints become one part.
    pub(in crate::morphology) fn build(&self) -> Checked<Assembly> {
        check_name(&self.name, "a robot", "name")?;
        if self.bodies.is_empty() || self.bodies.len() > MAX_BODIES {
            return Err(Flaw::new(
                "bodies",
                Error::invalid("the number of bodies is out of range")
                    .found(self.bodies.len())
                    .allowed(format!("1 to {MAX_BODIES}")),
            ));
        }
        for (index, body) in self.bodies.iter().enumerate() {
            check_body(body, &format!("bodies[{index}]"))?;
        }
        for (index, joint) in self.joints.iter().enumerate() {
            check_joint(joint, &format!("joints[{index}]"))?;
        }
        let bodies = by_name(self.bodies.iter().map(|body| &body.name), "bodies")?;
        by_name(self.joints.iter().map(|joint| &joint.name), "joints")?;
        let tree = self.tree(&bodies)?;
        let mut builder = AssemblyBuilder {
            structure: self,
            parts: Vec::new(),
            hinges: Vec::new(),
            part_of: vec![0; self.bodies.len()],
            robot_from_body: vec![Isometry3::identity(); self.bodies.len()],
        };
        for &body in &tree.order {
            builder.add(body, &tree)?;
        }
        builder.check_weights(&tree)?;
        builder.drive()?;
        builder.finish(&tree, &bodies)
    }
}

/// The assembly while it is being built.
struct AssemblyBuilder<'a> {
    structure: &'a Structure,
    parts: Vec<Part>,
    hinges: Vec<Hinge>,
    part_of: Vec<usize>,
    robot_from_body: Vec<Isometry3<f64>>,
}

impl AssemblyBuilder<'_> {
    /// Adds a body to its part; a moving joint above the body creates that part.
    fn add(&mut self, index: usize, tree: &Tree) -> Checked<()> {
        let body = &self.structure.bodies[index];
        if let Some(joint) = tree.up[index] {
            let parent = tree.ends[joint].0;
            let pose = self.structure.joints[joint].pose.isometry();
            self.robot_from_body[index] = self.robot_from_body[parent] * pose;
            self.part_of[index] = match self.hinge(joint, index, self.part_of[parent]) {
                None => self.part_of[parent],
                Some(hinge) => {
                    self.hinges.push(hinge);
                    self.parts.push(Part { solids: Vec::new() });
                    self.parts.len() - 1
                }
            };
        } else {
            self.parts.push(Part { solids: Vec::new() });
        }
        let robot_from_body = self.robot_from_body[index];
        let Some((mass_kg, centre_m, inertia_kg_m2)) = body.mass() else {
            return Err(Flaw::new(
                format!("bodies[{index}]"),
                Error::invalid(
                    "the inertia is missing, and there is no shape from which it could be computed",
                )
                .found(format!("`{}` of {} kg", body.name, body.mass_kg))
                .hint("add `inertia_kg_m2: (xx: ..., yy: ..., zz: ...)` or a shape"),
            ));
        };
        let part = &mut self.parts[self.part_of[index]];
        // The solid that carries the mass comes first, so that the part's frame is that of its first body.
        part.solids.push(Solid {
            module: index,
            role: Role::Cube,
            number: body.shapes.len(),
            shape: Shape::Nothing,
            robot_from_solid: robot_from_body,
            mass_kg,
            centre_of_mass_solid_m: centre_m,
            inertia_kg_m2,
            gravity_compensation: body.gravity_compensation,
            collides: false,
            tyre: None,
            turning: Default::default(),
        });
        for (number, piece) in body.shapes.iter().enumerate() {
            let (shape, own) = piece.form.shape();
            part.solids.push(Solid {
                module: index,
                role: Role::Cube,
                number,
                shape,
                robot_from_solid: robot_from_body * piece.pose.isometry() * own,
                mass_kg: 0.0,
                centre_of_mass_solid_m: Vector3::zeros(),
                inertia_kg_m2: Matrix3::zeros(),
                gravity_compensation: 0.0,
                collides: true,
                tyre: piece.tyre,
                turning: piece.turning,
            });
        }
        Ok(())
    }

    /// The hinge for a moving joint; `None` for a fixed joint.
    fn hinge(&self, joint: usize, child: usize, parent_part: usize) -> Option<Hinge> {
        let joint = &self.structure.joints[joint];
        let Motion {
            freedom,
            axis,
            anchor_m,
            bearing,
        } = joint.kind.motion()?;
        let pose = &self.robot_from_body[child];
        Some(Hinge {
            name: joint.name.clone(),
            module: child,
            parent_part,
            child_part: self.parts.len(),
            anchor_robot_m: (pose * Point3::from(vector(anchor_m))).coords,
            axis_robot: Unit::new_normalize(pose.rotation * vector(axis)),
            freedom,
            actuator: None,
            bearing,
            is_stated: true,
            start_rad: joint.start,
        })
    }

    /// Refuses moving joints whose child and descendants have no mass (nothing would resist their motion), singular inertias, and
    /// a robot without mass.
    fn check_weights(&self, tree: &Tree) -> Checked<()> {
        let mut beyond_kg: Vec<f64> = self.parts.iter().map(Part::mass_kg).collect();
        for hinge in self.hinges.iter().rev() {
            beyond_kg[hinge.parent_part] += beyond_kg[hinge.child_part];
        }
        for hinge in &self.hinges {
            if beyond_kg[hinge.child_part] <= 0.0 {
                let joint = tree.up[hinge.module].unwrap_or(0);
                return Err(Flaw::new(
                    format!("joints[{joint}]"),
                    Error::invalid("the bodies that this joint moves have no mass")
                        .found(format!("`{}`", hinge.name))
                        .hint("give the body a mass, or make the joint Fixed"),
                ));
            }
        }
        for part in &self.parts {
            let mass = part.mass(&Isometry3::identity());
            let moments = SymmetricEigen::new(mass.inertia_kg_m2).eigenvalues;
            if mass.mass_kg > 0.0 && moments.min() <= SINGULAR * moments.max() {
                let body = part.solids[0].module;
                return Err(Flaw::new(
                    format!("bodies[{body}].inertia_kg_m2"),
                    Error::invalid(format!(
                        "`{}`, together with the bodies fixed to it, has a moment of inertia of 0 or less",
                        self.structure.bodies[body].name
                    ))
                    .found(format!(
                        "principal moments {:.3e}, {:.3e}, {:.3e} kg m^2",
                        moments.x, moments.y, moments.z
                    ))
                    .allowed("moments above 0")
                    .hint("correct the inertia, or leave it out to use that of uniform shapes"),
                ));
            }
        }
        if beyond_kg.first().is_some_and(|kg| *kg <= 0.0) {
            return Err(Flaw::new("bodies", Error::invalid("a robot without mass")));
        }
        Ok(())
    }

    /// Adds the actuators to the hinges.
    fn drive(&mut self) -> Checked<()> {
        let drivers = &self.structure.actuators;
        let hinges: HashMap<&str, usize> = self
            .hinges
            .iter()
            .enumerate()
            .map(|(index, hinge)| (hinge.name.as_str(), index))
            .collect();
        let mut driven: Vec<(usize, Actuator)> = Vec::with_capacity(drivers.len());
        for (index, driver) in drivers.iter().enumerate() {
            let at = format!("actuators[{index}]");
            let hinge = look_up(
                &driver.joint,
                &hinges,
                "moving joint",
                format!("{at}.joint"),
            )?;
            if driven.iter().any(|(known, _)| *known == hinge) {
                return Err(Flaw::new(
                    format!("{at}.joint"),
                    Error::invalid("two actuators at one joint")
                        .found(format!("`{}`", driver.joint)),
                ));
            }
            let limits = self.hinges[hinge].bearing.limits_rad;
            // The command of a direct law or a throttle is a torque or its share, which no limit of the joint's coordinate shifts.
            let rest_rad = match driver.servo.law {
                ServoLaw::Direct | ServoLaw::Throttle => 0.0,
                _ => limits.map_or(0.0, |(low, high)| 0.0_f64.clamp(low, high)),
            };
            let actuator = Actuator {
                servo: driver.servo,
                gait: driver.gait.unwrap_or(Gait::hold(rest_rad)),
                command: driver.command.unwrap_or_default(),
            };
            actuator.command.check(&format!("{at}.command"))?;
            check_actuator(&actuator, &at)?;
            driven.push((hinge, actuator));
        }
        for (index, driver) in drivers.iter().enumerate() {
            if driver.follows.is_some() {
                driven[index].1.gait = self.followed(index, &driven, 0)?;
            }
        }
        for (hinge, actuator) in driven {
            self.hinges[hinge].actuator = Some(actuator);
        }
        Ok(())
    }

    /// The gait of an actuator, which may be copied from another actuator.
    fn followed(&self, index: usize, driven: &[(usize, Actuator)], depth: usize) -> Checked<Gait> {
        let drivers = &self.structure.actuators;
        let Some(follow) = &drivers[index].follows else {
            return Ok(driven[index].1.gait);
        };
        let leader = drivers.iter().position(|other| other.joint == follow.joint);
        let flaw = |what: &str| {
            Flaw::new(
                format!("actuators[{index}].follows"),
                Error::invalid(what.to_owned()).found(format!("`{}`", follow.joint)),
            )
        };
        let leader = leader.ok_or_else(|| flaw("the joint to follow has no actuator"))?;
        if depth > drivers.len() {
            return Err(flaw("joints follow each other in a cycle"));
        }
        let gait = self.followed(leader, driven, depth + 1)?;
        Ok(Gait {
            offset_rad: follow.factor * gait.offset_rad + follow.offset_rad,
            amplitude_rad: follow.factor * gait.amplitude_rad,
            ..gait
        })
    }

    fn finish(self, tree: &Tree, bodies: &HashMap<&str, usize>) -> Checked<Assembly> {
        let structure = self.structure;
        let mut marks = Vec::with_capacity(structure.marks.len());
        for (index, mark) in structure.marks.iter().enumerate() {
            let at = format!("marks[{index}]");
            check_name(&mark.name, "a mark", &format!("{at}.name"))?;
            check_pose(&mark.pose, &format!("{at}.pose"))?;
            let body = look_up(&mark.body, bodies, "body", format!("{at}.body"))?;
            marks.push(Mark {
                name: mark.name.clone(),
                part: self.part_of[body],
                robot_from_mark: self.robot_from_body[body] * mark.pose.isometry(),
            });
        }
        by_name(structure.marks.iter().map(|mark| &mark.name), "marks")?;
        let mut collision_exclude = Vec::new();
        for (index, (a, b)) in structure.collision_exclude.iter().enumerate() {
            let at = || format!("never_touch[{index}]");
            let pair = (
                look_up(a, bodies, "body", at())?,
                look_up(b, bodies, "body", at())?,
            );
            collision_exclude.push(pair);
        }
        collision_exclude.extend(self.neighbours_across_empty_links());
        if let Some(mount) = &structure.mount {
            check_pose(mount, "mount")?;
        }
        structure.world.check()?;
        let root = tree.order[0];
        let (track, robot_from_track, track_part) = match &structure.track {
            None => (root, self.robot_from_body[root], 0),
            Some(name) => match (
                bodies.get(name.as_str()),
                marks.iter().position(|m| m.name == *name),
            ) {
                (Some(&body), _) => (body, self.robot_from_body[body], self.part_of[body]),
                (None, Some(mark)) => {
                    let body = look_up(
                        &structure.marks[mark].body,
                        bodies,
                        "body",
                        "track".to_owned(),
                    )?;
                    (body, marks[mark].robot_from_mark, marks[mark].part)
                }
                (None, None) => {
                    let names = bodies
                        .keys()
                        .copied()
                        .chain(marks.iter().map(|m| m.name.as_str()));
                    return Err(Flaw::new(
                        "track",
                        unknown_name("body or mark", name, names),
                    ));
                }
            },
        };
        let body_length_m = self.length_m(track);
        Ok(Assembly {
            name: structure.name.clone(),
            module_names: structure
                .bodies
                .iter()
                .map(|body| body.name.clone())
                .collect(),
            parts: self.parts,
            hinges: self.hinges,
            is_modular: false,
            collision_exclude,
            world_from_mount: structure.mount.map(|pose| pose.isometry()),
            marks,
            track_part,
            robot_from_track,
            body_length_m,
            surroundings: structure.world.clone(),
        })
    }

    /// Pairs of bodies between which there are only links without mass and surface: they count as neighbours, so no contacts are
    /// computed between them.
    fn neighbours_across_empty_links(&self) -> Vec<(usize, usize)> {
        let is_empty_link = |part: usize| {
            let mut solids = self.parts[part].solids.iter();
            solids.all(|solid| solid.shape == Shape::Nothing && solid.mass_kg == 0.0)
        };
        let up = |part: usize| self.hinges.iter().find(|hinge| hinge.child_part == part);
        let of = |part: usize| {
            let bodies = 0..self.part_of.len();
            bodies.filter(move |&body| self.part_of[body] == part)
        };
        let mut pairs = Vec::new();
        for hinge in &self.hinges {
            let mut above = hinge.parent_part;
            if !is_empty_link(above) || is_empty_link(hinge.child_part) {
                continue;
            }
            while let Some(next) = up(above).filter(|_| is_empty_link(above)) {
                above = next.parent_part;
            }
            for a in of(above) {
                pairs.extend(of(hinge.child_part).map(|b| (a, b)));
            }
        }
        pairs
    }

    /// Longest edge of the bounding box of a body's shapes, metres; that of the whole robot if the body has no shapes.
    fn length_m(&self, body: usize) -> f64 {
        let longest = |is_in: &dyn Fn(&Solid) -> bool| {
            let solids = self.parts.iter().flat_map(|part| &part.solids);
            let solids = solids.filter(|solid| solid.has_surface() && is_in(solid));
            let mut bounds: Option<(Vector3<f64>, Vector3<f64>)> = None;
            for solid in solids {
                let (low, high) = solid.bounds_robot_m();
                bounds = Some(bounds.map_or((low, high), |(a, b)| (a.inf(&low), b.sup(&high))));
            }
            bounds.map(|(low, high)| (high - low).max())
        };
        let places = self
            .robot_from_body
            .iter()
            .map(|pose| pose.translation.vector.norm());
        longest(&|solid| solid.module == body)
            .or_else(|| longest(&|_| true))
            .unwrap_or_else(|| places.fold(0.1, f64::max))
    }
}
