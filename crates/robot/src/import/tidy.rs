//! Clean-up of every imported robot: valid names, links without mass, overlapping shapes, and warnings about implausible sizes.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::query;

use super::note::Notes;
use super::{Options, driven};
use crate::morphology::body::{JointKind, MAX_BODIES, Pose, Structure, solid_surface};
use crate::morphology::{Assembly, Module, Morphology, Solid};

/// Largest allowed overlap at the start between shapes of bodies that no joint connects, metres.
const DEEPEST_M: f64 = 1e-4;
/// The import adds a doubt about a robot that is longer than this, metres.
const LARGEST_M: f64 = 50.0;
/// The usual timestep of an experiment, and the shortest one that is chosen for a robot, seconds.
const USUAL_S: f64 = 1.0 / 480.0;
const SHORTEST_S: f64 = 2.5e-4;

/// A distance from the root that no part of the robot exceeds in any posture, metres: the sum of the distances between joints and
/// of their travels, and the size of the robot.
fn reach_m(structure: &Structure) -> f64 {
    let links_m = structure.joints.iter().map(|joint| {
        let (x, y, z) = joint.pose.at_m;
        let travel_m = match joint.kind {
            JointKind::Slide { limits_m, .. } => {
                limits_m.map_or(0.0, |(low, high)| low.abs().max(high.abs()))
            }
            _ => 0.0,
        };
        (x * x + y * y + z * z).sqrt() + travel_m
    });
    let size_m = Morphology::of_bodies(structure.clone())
        .map_or(0.0, |robot| robot.summary().size_m().norm());
    links_m.sum::<f64>() + size_m
}

/// Cleans up an imported robot.
pub(super) fn tidy(structure: &mut Structure, options: &Options, notes: &mut Notes) {
    if structure.bodies.len() > MAX_BODIES {
        // `Morphology::of_bodies` refuses such a robot with an error.
        return;
    }
    rename(structure, notes);
    weld_weightless(structure, notes);
    hold_weightless_root(structure, notes);
    if options.mounted && structure.mount.is_none() {
        structure.mount = Some(Pose::default());
    }
    let height_m = if options.lifted {
        reach_m(structure)
    } else {
        0.0
    };
    if let Some(mount) = &mut structure.mount {
        mount.at_m.2 += height_m;
    }
    if options.lifted && !structure.world.bodies.is_empty() {
        // Joints alone were recorded, and these bodies would only fall.
        structure.world.bodies.clear();
        notes.left_out(
            None,
            "the bodies beside the robot, which is held above the floor",
            "import the robot without lifting it to simulate them",
        );
    }
    driven::drive(structure, options, notes);
    let moving: BTreeSet<&str> = structure
        .joints
        .iter()
        .filter(|joint| joint.kind != JointKind::Fixed)
        .map(|joint| joint.name.as_str())
        .collect();
    structure
        .actuators
        .retain(|driver| moving.contains(driver.joint.as_str()));
    let Ok(robot) = Morphology::of_bodies(structure.clone()) else {
        // The caller's own call of `Morphology::of_bodies` returns the error.
        return;
    };
    let assembly = robot.assemble();
    let size_m = robot.summary().size_m();
    if size_m.max() > LARGEST_M {
        let what = format!("the robot is {:.0} m long", size_m.max());
        notes.doubt(
            None,
            what,
            "if its meshes are in millimetres, they need scale=\"0.001 0.001 0.001\"",
        );
    }
    choose_timestep(structure, &assembly, notes);
    raise(structure, &assembly, notes);
    let pairs = overlapping(&assembly);
    if !pairs.is_empty() {
        let shown: Vec<String> = pairs
            .iter()
            .take(6)
            .map(|(a, b)| format!("`{a}` and `{b}`"))
            .collect();
        let more = if pairs.len() > shown.len() {
            ", and others"
        } else {
            ""
        };
        let what = format!(
            "{} pairs of bodies overlap at the start, and no contacts are computed between them: {}{more}",
            pairs.len(),
            shown.join(", ")
        );
        notes.changed(
            None,
            what,
            "correct their collision shapes, and remove the pairs from `never_touch`",
        );
        structure.collision_exclude.extend(pairs);
    }
}

/// States a timestep that follows the fastest vibration of a joint on its spring or servo.
fn choose_timestep(structure: &mut Structure, assembly: &Assembly, notes: &mut Notes) {
    let Some(stiffest) = assembly.stiffest_joint() else {
        return;
    };
    let timestep_s = stiffest.timestep_s.max(SHORTEST_S);
    if timestep_s >= USUAL_S {
        return;
    }
    structure.world.timestep_s = Some(timestep_s);
    notes.assumed(
        None,
        format!(
            "the timestep is {:.2} ms, because joint `{}` vibrates on its spring or servo with {:.0} Hz",
            1e3 * timestep_s,
            assembly.hinges[stiffest.hinge].name,
            1.0 / (std::f64::consts::TAU * stiffest.timestep_s)
        ),
        "give the joint its damping or its armature if it does not vibrate in reality, or state `timestep_s`",
    );
}

/// Lifts a held robot of which a moving part would start inside the floor, which would throw it out: files of arms and hands place
/// the root at the origin, and state no floor.
fn raise(structure: &mut Structure, assembly: &Assembly, notes: &mut Notes) {
    let Some(mount) = structure.mount else {
        return;
    };
    let moved = assembly.moved(&start(assembly));
    let world_from_robot = mount.isometry();
    let down = -Vector3::z();
    let moving = assembly.parts.iter().enumerate().skip(1);
    let depths_m = moving.flat_map(|(part, cluster)| {
        let solids = cluster.solids.iter().filter(|solid| solid.has_surface());
        let world_from_part = world_from_robot * moved[part];
        solids.map(move |solid| {
            let pose = world_from_part * solid.robot_from_solid;
            let direction = pose.rotation.inverse() * down;
            solid.shape.reach_m(&direction) - pose.translation.z
        })
    });
    let depth_m = depths_m.fold(0.0, f64::max);
    if depth_m <= DEEPEST_M {
        return;
    }
    let height_m = reach_m(structure);
    if let Some(mount) = &mut structure.mount {
        mount.at_m.2 += height_m;
    }
    for body in &mut structure.world.bodies {
        body.pose.at_m.2 += height_m;
    }
    notes.assumed(
        None,
        format!(
            "a part of the held robot would start {:.1} mm below the floor at height 0: the robot is held {height_m:.3} m higher, where no posture reaches the floor",
            1e3 * depth_m
        ),
        "state in `mount` where the robot is held",
    );
}

/// The joint coordinates at the start: those that the file states, else the ones nearest to 0 that the limits allow.
fn start(assembly: &Assembly) -> Vec<f64> {
    let hinges = assembly.hinges.iter();
    let nearest = hinges.map(|hinge| {
        let limits = hinge.bearing.limits_rad;
        let stated = hinge.start_rad.unwrap_or(0.0);
        limits.map_or(stated, |(low, high)| stated.clamp(low, high))
    });
    nearest.collect()
}

/// Renames everything whose name is not valid in realgap.
fn rename(structure: &mut Structure, notes: &mut Notes) {
    let mut one = vec![std::mem::take(&mut structure.name)];
    let mut changed = usable(one.iter_mut());
    structure.name = one.remove(0);
    let bodies = usable(structure.bodies.iter_mut().map(|body| &mut body.name));
    let joints = usable(structure.joints.iter_mut().map(|joint| &mut joint.name));
    changed.extend(usable(
        structure.marks.iter_mut().map(|mark| &mut mark.name),
    ));
    let give = |renamed: &[(String, String)], name: &mut String| {
        if let Some((_, new)) = renamed.iter().find(|(old, _)| old == name) {
            name.clone_from(new);
        }
    };
    for joint in &mut structure.joints {
        give(&bodies, &mut joint.parent);
        give(&bodies, &mut joint.child);
    }
    for mark in &mut structure.marks {
        give(&bodies, &mut mark.body);
    }
    if let Some(track) = &mut structure.track {
        give(&bodies, track);
    }
    for (a, b) in &mut structure.collision_exclude {
        give(&bodies, a);
        give(&bodies, b);
    }
    for driver in &mut structure.actuators {
        give(&joints, &mut driver.joint);
        if let Some(follow) = &mut driver.follows {
            give(&joints, &mut follow.joint);
        }
    }
    for (old, new) in changed.into_iter().chain(bodies).chain(joints) {
        let what = format!("the name {old:?} is changed to `{new}`");
        notes.changed(
            None,
            what,
            "names consist of letters, digits, `_` and `-`, and every name is unique",
        );
    }
    let mut cases: BTreeMap<String, &str> = BTreeMap::new();
    for body in &structure.bodies {
        if let Some(other) = cases.insert(body.name.to_lowercase(), &body.name) {
            let what = format!(
                "the names `{other}` and `{}` differ in case only",
                body.name
            );
            notes.doubt(
                None,
                what,
                "if these are two bodies, give them names that differ by more than case",
            );
        }
    }
}

/// A name of letters, digits, `_` and `-`, which stands for another name.
pub(super) fn clean(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let clean: String = name
        .chars()
        .take(Module::MAX_NAME - 4)
        .map(|c| if plain(c) { c } else { '_' })
        .collect();
    match clean.strip_prefix('-') {
        Some(rest) => format!("_{rest}"),
        None if clean.is_empty() => "_".to_owned(),
        None => clean,
    }
}

/// Turns names into unique names of letters, digits, `_` and `-`; returns old and new of those that changed.
fn usable<'a>(names: impl Iterator<Item = &'a mut String>) -> Vec<(String, String)> {
    let mut taken = BTreeSet::new();
    let mut changed = Vec::new();
    for name in names {
        let clean = clean(name);
        let mut new = clean.clone();
        let mut number = 1;
        while !taken.insert(new.clone()) {
            number += 1;
            new = format!("{clean}_{number}");
        }
        if *name != new {
            changed.push((std::mem::replace(name, new.clone()), new));
        }
    }
    changed
}

/// Mass of each body together with all its descendants, kg.
fn subtrees_kg(structure: &Structure) -> BTreeMap<String, f64> {
    let mut beyond: BTreeMap<String, f64> = structure
        .bodies
        .iter()
        .map(|body| (body.name.clone(), body.mass_kg))
        .collect();
    // Joints are not sorted. Each iteration propagates masses by one level of the tree, and the loop ends when nothing changes.
    let own = beyond.clone();
    for _ in 0..structure.bodies.len() {
        let mut next = own.clone();
        for joint in &structure.joints {
            let child_kg = beyond.get(&joint.child).copied().unwrap_or(0.0);
            if let Some(kg) = next.get_mut(&joint.parent) {
                *kg += child_kg;
            }
        }
        if next == beyond {
            break;
        }
        beyond = next;
    }
    beyond
}

/// Fixes every joint whose child and descendants have no mass, because nothing would resist its motion: the child becomes part of
/// its parent.
fn weld_weightless(structure: &mut Structure, notes: &mut Notes) {
    let beyond = subtrees_kg(structure);
    for joint in &mut structure.joints {
        let weighs = beyond.get(&joint.child).is_some_and(|kg| *kg > 0.0);
        if joint.kind != JointKind::Fixed && !weighs {
            joint.kind = JointKind::Fixed;
            let what = format!(
                "the links beyond joint `{}` have no mass: `{}` is fixed to `{}`",
                joint.name, joint.child, joint.parent
            );
            notes.changed(None, what, "give it an <inertial>");
        }
    }
}

/// Mounts a robot whose root has no mass but carries moving joints: such a root stands for the place to which the robot is fixed.
fn hold_weightless_root(structure: &mut Structure, notes: &mut Notes) {
    if structure.mount.is_some() {
        return;
    }
    let children: BTreeSet<&str> = structure.joints.iter().map(|j| j.child.as_str()).collect();
    let root = structure
        .bodies
        .iter()
        .find(|body| !children.contains(body.name.as_str()));
    let Some(root) = root.map(|body| body.name.clone()) else {
        return;
    };
    // All bodies that are fixed to the root.
    let mut rigid: BTreeSet<String> = BTreeSet::from([root.clone()]);
    for _ in 0..structure.bodies.len() {
        let before = rigid.len();
        for joint in structure
            .joints
            .iter()
            .filter(|joint| joint.kind == JointKind::Fixed)
        {
            if rigid.contains(&joint.parent) {
                rigid.insert(joint.child.clone());
            }
        }
        if rigid.len() == before {
            break;
        }
    }
    let weighs =
        |body: &&crate::morphology::body::Body| rigid.contains(&body.name) && body.mass_kg > 0.0;
    let moves = structure
        .joints
        .iter()
        .any(|joint| joint.kind != JointKind::Fixed);
    if moves && structure.bodies.iter().find(weighs).is_none() {
        structure.mount = Some(Pose::default());
        let what = format!("the root `{root}` has no mass: the robot is mounted");
        notes.assumed(
            None,
            what,
            "give it an <inertial> for a robot that moves freely",
        );
    }
}

/// Pairs of bodies that overlap at the start although no joint connects them.
fn overlapping(assembly: &Assembly) -> Vec<(String, String)> {
    let start = start(assembly);
    let joined: BTreeSet<(usize, usize)> = assembly
        .hinges
        .iter()
        .map(|hinge| {
            (
                hinge.parent_part.min(hinge.child_part),
                hinge.parent_part.max(hinge.child_part),
            )
        })
        .collect();
    let mut pairs = BTreeSet::new();
    let still = vec![0.0; start.len()];
    for coordinates in [&still, &start] {
        let moved = assembly.moved(coordinates);
        let mut all: Vec<(usize, &Solid, Isometry3<f64>)> = Vec::new();
        for (part, cluster) in assembly.parts.iter().enumerate() {
            let solids = cluster.solids.iter().filter(|solid| solid.has_surface());
            all.extend(solids.map(|solid| (part, solid, moved[part] * solid.robot_from_solid)));
        }
        let surfaces: Vec<_> = all
            .iter()
            .map(|(_, solid, pose)| solid_surface(&solid.shape, pose))
            .collect();
        for (first, (a, one, here)) in all.iter().enumerate() {
            for (second, (b, other, there)) in all.iter().enumerate().skip(first + 1) {
                let pair = (one.module.min(other.module), one.module.max(other.module));
                let is_joined = joined.contains(&(*a.min(b), *a.max(b)));
                let distance_m = (here.translation.vector - there.translation.vector).norm();
                let reach_m = one.half_extents_m().norm() + other.half_extents_m().norm();
                if a == b
                    || is_joined
                    || distance_m > reach_m
                    || pairs.contains(&pair)
                    || assembly.is_collision_excluded(pair.0, pair.1)
                {
                    continue;
                }
                let (Some((p, s)), Some((q, t))) = (&surfaces[first], &surfaces[second]) else {
                    continue;
                };
                let depth = query::contact(p, &**s, q, &**t, 0.0);
                if let Ok(Some(contact)) = depth
                    && contact.dist < -DEEPEST_M
                {
                    pairs.insert(pair);
                }
            }
        }
    }
    let name = |index: usize| assembly.module_names[index].clone();
    pairs.into_iter().map(|(a, b)| (name(a), name(b))).collect()
}
