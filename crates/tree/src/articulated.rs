//! The articulated-body algorithm on the level of velocities and impulses (Featherstone 2008, chapter 7).
//!
//! Instead of a mass matrix, every body has its articulated inertia and its response J M⁻¹ Jᵀ, both six by six. Together they
//! contain everything that contacts need, and computing them takes a time proportional to the number of bodies.

use parry3d_f64::math::Vec3;

use crate::forest::{Body, Forest, Freedom, Tree};
use crate::kinematics::Node;
use crate::spatial::{Spatial, Symmetric};

/// Articulated inertias from the leaves inwards (equations 7.33 to 7.43), then responses from the root outwards.
///
/// `stiff` is the amount that a joint adds to the inertia about its axis: the rotor, and the implicit terms of dampers, springs
/// and servos over a step of `time_s`. Returns false if a joint or a root has no inertia.
pub(crate) fn factor(forest: &Forest, nodes: &mut [Node], stiff: &[f64], time_s: f64) -> bool {
    for (body, node) in forest.bodies.iter().zip(nodes.iter_mut()) {
        node.articulated = Symmetric::rigid(body.mass_kg, node.arm_m, &node.inertia_world);
    }
    let mut sound = true;
    for index in (0..nodes.len()).rev() {
        let body = &forest.bodies[index];
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        match body.freedom {
            Freedom::Mounted => node.response = Symmetric::ZERO,
            Freedom::Free => {
                if let Some(mount) = &body.mount {
                    let grip = mount.grip(node, time_s);
                    node.articulated.add(&grip);
                }
                let inverse = node.articulated.inverse();
                sound &= inverse.is_some();
                node.response = inverse.unwrap_or(Symmetric::ZERO);
            }
            Freedom::Turning | Freedom::Sliding => {
                let u = node.articulated.times(&node.axis);
                let d = node.axis.dot(&u) + stiff[index];
                sound &= d > 0.0;
                node.inverse_d = 1.0 / d;
                node.u_over_d = u * node.inverse_d;
                let parent = &mut above[body.parent];
                parent.articulated.add(&node.articulated);
                parent.articulated.add_outer(&u, &-node.u_over_d);
            }
        }
    }
    for index in 0..nodes.len() {
        let body = &forest.bodies[index];
        if body.is_root() {
            continue;
        }
        let (above, below) = nodes.split_at_mut(index);
        let (parent, node) = (&above[body.parent], &mut below[0]);
        respond(parent, node);
    }
    sound
}

/// Λ = Lᵀ Λ_parent L + S Sᵀ / D, where L = 1 − (U / D) Sᵀ maps an impulse on a child to the impulse that its parent receives.
fn respond(parent: &Node, node: &mut Node) {
    node.recoil = parent.response.times(&node.u_over_d);
    node.give = node.inverse_d + node.u_over_d.dot(&node.recoil);
    let (axis, half) = (node.axis, node.axis * (0.5 * node.give) - node.recoil);
    node.response = parent.response;
    node.response.add_outer(&axis, &half);
    node.response.add_outer(&half, &axis);
}

/// Velocities after a step of `time_s` in which only the given impulses and the contact impulses of the previous step (`warm`)
/// act.
///
/// Velocity products are taken in the middle of the step, at the mean of the velocities before and after (a predictor and a
/// corrector): taken at its beginning they let a pendulum's energy grow in proportion to the step. `foreseen` is true if the step
/// has been solved before, so that the change of velocity over the step is already known.
pub(crate) fn free_velocities(
    tree: &Tree,
    forest: &Forest,
    nodes: &mut [Node],
    time_s: f64,
    given: &[Spatial],
    foreseen: bool,
) {
    let bodies = &forest.bodies[tree.root..tree.end];
    if !foreseen {
        for node in &mut nodes[tree.root..tree.end] {
            (node.coming_turn, node.coming_speed) = (Vec3::ZERO, 0.0);
        }
        accelerate(tree, bodies, nodes, time_s, given);
        for node in &mut nodes[tree.root..tree.end] {
            (node.coming_turn, node.coming_speed) = (node.change.angular(), node.speed_change);
        }
    }
    accelerate(tree, bodies, nodes, time_s, given);
    for (index, body) in (tree.root..tree.end).zip(bodies) {
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        if body.is_root() {
            node.velocity += node.change;
        } else {
            node.speed += node.speed_change;
            node.velocity = above[body.parent].velocity;
            node.velocity.add_scaled(&node.axis, node.speed);
        }
    }
}

/// Changes of velocity and speed over a step, with velocity products at the mean of the velocities before and after it.
fn accelerate(tree: &Tree, bodies: &[Body], nodes: &mut [Node], time_s: f64, given: &[Spatial]) {
    velocity_products(tree, bodies, nodes, time_s, given);
    gather(tree, bodies, nodes);
    spread(tree, bodies, nodes);
}

/// Impulse on every body: the given impulse, minus velocity products v ×* I v (equation 7.29); and the change of velocity due to
/// the motion of its joint axis.
///
/// All is computed in a frame that translates with the root, so that the result does not depend on the common velocity of the
/// tree.
fn velocity_products(
    tree: &Tree,
    bodies: &[Body],
    nodes: &mut [Node],
    time_s: f64,
    given: &[Spatial],
) {
    for (index, body) in (tree.root..tree.end).zip(bodies) {
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        if body.is_root() {
            let turning = node.velocity.angular() + node.coming_turn * 0.5;
            node.relative = Spatial::new(turning, Vec3::ZERO);
            node.drift = Spatial::ZERO;
        } else {
            let own = node.axis * (node.speed + node.coming_speed * 0.5);
            node.relative = above[body.parent].relative + own;
            node.drift = node.relative.cross_motion(&own) * time_s;
        }
        let (w, v) = (node.relative.angular(), node.relative.linear());
        let momentum = (v + w.cross(node.arm_m)) * body.mass_kg;
        let angular = node.inertia_world * w + node.arm_m.cross(momentum);
        let products = Spatial::new(w.cross(angular) + v.cross(momentum), w.cross(momentum));
        node.impulse = given[index] + node.warm;
        node.impulse.add_scaled(&products, -time_s);
    }
}

/// Propagates impulses and efforts from the leaves inwards; stores in `speed_change` the generalised impulse that remains for the
/// joint.
fn gather(tree: &Tree, bodies: &[Body], nodes: &mut [Node]) {
    for (index, body) in (tree.root..tree.end).zip(bodies).rev() {
        if body.is_root() {
            continue;
        }
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        let left = node.effort + node.axis.dot(&node.impulse);
        let dragged = node.articulated.times(&node.drift);
        node.speed_change = left;
        let mut passed = node.impulse - dragged;
        passed.add_scaled(&node.u_over_d, node.axis.dot(&dragged) - left);
        above[body.parent].impulse += passed;
    }
}

/// Changes of velocity from the root outwards.
fn spread(tree: &Tree, bodies: &[Body], nodes: &mut [Node]) {
    for (index, body) in (tree.root..tree.end).zip(bodies) {
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        if body.is_root() {
            // Nothing changes the velocity of a mounted root but the one who leads it.
            node.change = match body.freedom {
                Freedom::Mounted => node.led - node.velocity,
                _ => node.response.times(&node.impulse),
            };
            continue;
        }
        node.change = above[body.parent].change + node.drift;
        node.speed_change = node.speed_change * node.inverse_d - node.u_over_d.dot(&node.change);
        node.change.add_scaled(&node.axis, node.speed_change);
    }
}

/// Gravity as an impulse over a time, less the part that is compensated.
pub(crate) fn weight(body: &Body, node: &Node, gravity_world_m_s2: Vec3, time_s: f64) -> Spatial {
    let mut all = Spatial::at(node.arm_m, gravity_world_m_s2 * (body.mass_kg * time_s));
    let (compensated_kg, away_body_m) = body.compensated;
    if compensated_kg != 0.0 {
        let arm_m = node.arm_m + node.rotation * away_body_m;
        all += Spatial::at(arm_m, gravity_world_m_s2 * (-compensated_kg * time_s));
    }
    all
}
