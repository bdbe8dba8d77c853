//! One time step: collision detection, velocities without constraints, sweeps over all constraint rows, and new positions.

use parry3d_f64::math::Vec3;

use crate::articulated::{factor, free_velocities, weight};
use crate::contact::{Group, Point, Side, Softness, Step};
use crate::forest::{Forest, NONE};
use crate::joint::{JointForces, JointImpulse, limit_reach};
use crate::kinematics::{self, Node};
use crate::model::Cone;
use crate::spatial::Spatial;
use crate::sweep::{begin_sweeps, finish_sweeps, respond, tops};
use crate::touch::Kept;
use crate::turning::{Couple, TurningFriction};
use crate::world::World;

/// Largest number of times that a step is solved again because a servo reached its limit.
const MOST_ATTEMPTS: usize = 4;
/// A step is solved again if its velocity products were taken at velocities so different from the result that a velocity would
/// change by more than this, m/s.
const RESOLVE_THRESHOLD_M_S: f64 = 1e-4;
/// Contacts that do more work than this fraction of the kinetic energy plus the work of lifting everything by `EXCESS_M` (m)
/// count as a solver failure.
const EXCESS: f64 = 0.02;
const EXCESS_M: f64 = 1e-3;
/// Largest number of parts into which one step is divided.
const MOST_PARTS: usize = 64;

impl World {
    /// Advances the world by one timestep, which is divided into parts if a body would turn too far in one.
    pub fn step(&mut self) {
        self.earlier.clear();
        for actor in &mut self.actors {
            actor.done = JointImpulse::default();
        }
        let time_s = self.settings.timestep_s;
        let turn = kinematics::fastest_turn(&self.forest, &self.nodes) * time_s;
        let parts = ((turn / self.settings.max_turn_rad).ceil() as usize).clamp(1, MOST_PARTS);
        for part in 0..parts {
            self.part(time_s / parts as f64);
            if part + 1 < parts {
                for point in &self.rows.points {
                    self.earlier.push(self.contact(point));
                }
            }
        }
        self.wrenches.fill(Spatial::ZERO);
    }

    fn part(&mut self, time_s: f64) {
        self.touches.clear();
        self.collision.find(&self.nodes, time_s, &mut self.touches);
        if self.settings.cone == Cone::Relaxed {
            self.touches.retain(|touch| touch.distance_m <= 0.0);
        }
        self.before.clear();
        let state = self.nodes.iter().map(|node| (node.velocity, node.speed));
        self.before.extend(state);
        let ratio = time_s / self.last_time_s;
        self.solve_until_foreseen(time_s, ratio);
        if self.contacts_make_energy() {
            // With Coulomb friction a bounded solution may not exist. Without friction every sweep dissipates energy, from any
            // start.
            self.frictionless_steps += 1;
            self.restore();
            for touch in &mut self.touches {
                (touch.impulse_world_n_s, touch.friction) = (Vec3::ZERO, 0.0);
                touch.turning = TurningFriction::default();
            }
            self.solve_until_foreseen(time_s, 1.0);
        }
        for point in &self.rows.points {
            let kept = Kept {
                impulse_world_n_s: point.impulse_world(),
                couple_world_n_m_s: self.rows.couple_world(point),
            };
            self.collision.remember(point.memory, kept);
        }
        for (index, actor) in self.actors.iter_mut().enumerate() {
            let (body, node) = (&self.forest.bodies[index], &self.nodes[index]);
            if !body.is_root() {
                actor.finish(body, node.speed, time_s);
            }
        }
        kinematics::advance(&self.forest, &mut self.nodes, time_s);
        self.collision.lead(time_s);
        self.last_time_s = time_s;
        self.fresh = false;
    }

    /// Solves the step, and solves it again if a servo reached its limit (it then becomes a row) or if the resulting velocities
    /// differ from those that were assumed for the velocity products, as in impacts. Both are rare, because most velocities
    /// change little from step to step.
    fn solve_until_foreseen(&mut self, time_s: f64, ratio: f64) {
        self.solve(time_s, ratio, false);
        for attempt in 2..=MOST_ATTEMPTS {
            let mut again = false;
            for (actor, node) in self.actors.iter_mut().zip(&self.nodes) {
                again |= actor.exceeds(node.speed);
            }
            if !again
                && (attempt > 2 || self.acceleration_residual() * time_s < RESOLVE_THRESHOLD_M_S)
            {
                break;
            }
            if attempt == MOST_ATTEMPTS {
                self.actors.iter_mut().for_each(JointForces::unfold);
            }
            for index in 0..self.rows.points.len() {
                let point = &self.rows.points[index];
                let touch = &mut self.touches[point.touch];
                touch.impulse_world_n_s = point.impulse_world();
                touch.couple_world_n_m_s = self.rows.couple_world(point);
            }
            self.restore();
            self.solve(time_s, 1.0, true);
        }
    }

    /// Difference between the velocities and those at which the velocity products were taken, as an acceleration, m/s².
    fn acceleration_residual(&self) -> f64 {
        let (mut off, mut turn) = (0.0_f64, 0.0_f64);
        for (index, (body, node)) in self.forest.bodies.iter().zip(&self.nodes).enumerate() {
            let mean = |index: usize| (self.nodes[index].velocity + self.before[index].0) * 0.5;
            let together = Spatial::new(Vec3::ZERO, mean(body.root).linear());
            let by = mean(index) - together - node.relative;
            off = off.max(by.velocity_at(node.arm_m).length_squared());
            turn = turn.max(mean(index).angular().length_squared());
        }
        (off * turn).sqrt()
    }

    /// Restores the velocities before the step, and keeps the computed changes as the expected changes.
    fn restore(&mut self) {
        for (node, (velocity, speed)) in self.nodes.iter_mut().zip(&self.before) {
            node.coming_turn = (node.velocity - *velocity).angular();
            node.coming_speed = node.speed - speed;
            (node.velocity, node.speed) = (*velocity, *speed);
        }
    }

    /// Whether contacts did more work than the reduction of penetration requires. An impulse does its work at the mean of the
    /// velocities before and after the step.
    fn contacts_make_energy(&self) -> bool {
        let mut work = 0.0;
        for point in &self.rows.points {
            let touch = &self.touches[point.touch];
            let mean = |body: usize| (self.nodes[body].velocity + self.before[body].0) * 0.5;
            let other = (touch.b != NONE).then(|| (&self.rows.sides[point.b], mean(touch.b)));
            work += point.work(&mean(touch.a), other);
            if let Some(couple) = self.rows.couples.get(point.couple) {
                let other = other.map(|(_, velocity)| velocity);
                work += couple.work(&mean(touch.a), other.as_ref());
            }
        }
        let moving = || self.kinetic_energy_j();
        work > EXCESS_M * self.weight_n && work > EXCESS_M * self.weight_n + EXCESS * moving()
    }

    /// Velocities at the end of a step, from those at its beginning.
    fn solve(&mut self, time_s: f64, ratio: f64, foreseen: bool) {
        let bodies = &self.forest.bodies;
        for (index, actor) in self.actors.iter_mut().enumerate() {
            self.stiff[index] = if bodies[index].is_root() {
                0.0
            } else {
                actor.prepare(&bodies[index], &self.nodes[index], time_s, ratio)
            };
        }
        factor(&self.forest, &mut self.nodes, &self.stiff, time_s);
        // In the first step the velocities go from the beginning of the step to its middle (leapfrog), so steady forces act only
        // half of the step.
        let kick_s = if self.fresh { 0.5 * time_s } else { time_s };
        for (index, body) in bodies.iter().enumerate() {
            let node = &mut self.nodes[index];
            node.warm = Spatial::ZERO;
            self.given[index] = weight(body, node, self.gravity_world_m_s2, kick_s);
            self.given[index].add_scaled(&self.wrenches[index], kick_s);
        }
        self.carry(kick_s);
        let step = Step {
            time_s,
            gravity_world_m_s2: self.gravity_world_m_s2,
            softness: Softness::new(&self.settings, time_s),
        };
        let impact = self.build_rows(&step, ratio);
        for (index, actor) in self.actors.iter_mut().enumerate() {
            let (body, node) = (&self.forest.bodies[index], &mut self.nodes[index]);
            if !body.is_root() {
                let reach = limit_reach(body, node, time_s);
                actor.approach(body, node, &step.softness, reach);
                node.effort = actor.effort(body, node, time_s);
            }
        }
        for tree in &self.forest.trees {
            free_velocities(
                tree,
                &self.forest,
                &mut self.nodes,
                kick_s,
                &self.given,
                foreseen,
            );
        }
        self.sweep(impact, time_s);
    }

    /// Adds the impulses of mounts with springs. In the first step, each takes over the weight of its tree.
    fn carry(&mut self, time_s: f64) {
        for (index, body) in self.forest.bodies.iter().enumerate() {
            let Some(mount) = &body.mount else {
                continue;
            };
            let load = *self.carried[index].get_or_insert_with(|| {
                mount.load(&self.forest, &self.nodes, index, self.gravity_world_m_s2)
            });
            let node = &self.nodes[index];
            self.given[index] += mount.impulse(body, node, time_s);
            self.given[index] += mount.carried(node, load, time_s);
        }
    }

    /// Builds the contact rows. They are warm started: their impulses of the previous step are part of the given impulses.
    /// Returns true if there is an impact.
    fn build_rows(&mut self, step: &Step, ratio: f64) -> bool {
        let (forest, rows) = (&self.forest, &mut self.rows);
        rows.points.clear();
        rows.sides.clear();
        rows.couples.clear();
        rows.groups.clear();
        let mut impact = false;
        for (index, touch) in self.touches.iter_mut().enumerate() {
            touch.impulse_world_n_s *= ratio;
            touch.couple_world_n_m_s *= ratio;
            rows.points
                .push(Point::new(touch, index, forest, &self.nodes, step));
            let Some(point) = rows.points.last_mut() else {
                continue;
            };
            impact |= point.is_impact;
            let last = rows.groups.last();
            if !last.is_some_and(|group| group.a == touch.a && group.b == touch.b) {
                rows.groups.push(Group {
                    a: touch.a,
                    b: touch.b,
                    meeting: touch.meeting,
                    first: index,
                    end: index,
                    next: NONE,
                });
            }
            let Some(group) = rows.groups.last_mut() else {
                continue;
            };
            group.end = index + 1;
            if touch.b == NONE {
                let response = &self.nodes[touch.a].response;
                point.a.response = point.a.jacobian.map(|row| response.times(&row));
                point.weigh(None);
            } else {
                let mut side = Side {
                    jacobian: point.basis.map(|axis| -Spatial::at(point.arm_b, axis)),
                    ..Side::default()
                };
                compute_responses(&mut point.a, &mut side, group, forest, &mut self.nodes);
                point.weigh(Some(&mut side));
                point.b = rows.sides.len();
                for (row, impulse) in side.jacobian.iter().zip(point.impulse) {
                    self.nodes[touch.b].warm.add_scaled(row, impulse);
                }
                rows.sides.push(side);
            }
            for (row, impulse) in point.a.jacobian.iter().zip(point.impulse) {
                self.nodes[touch.a].warm.add_scaled(row, impulse);
            }
            if !touch.turning.is_none() {
                point.couple = rows.couples.len();
                let whole_k = point.whole_k;
                let couple = Couple::new(touch, point.basis);
                rows.couples
                    .push(coupled(couple, group, whole_k, forest, &mut self.nodes));
            }
        }
        rows.link(forest.bodies.len());
        impact
    }

    fn sweep(&mut self, impact: bool, time_s: f64) {
        let tolerance_m_s = self.settings.tolerance_m_s2 * time_s;
        let (forest, rows) = (&self.forest, &mut self.rows);
        let no_rows = rows.points.is_empty() && !self.actors.iter().any(JointForces::has_rows);
        let most = match (no_rows, impact) {
            (true, _) => 0,
            (false, true) => self.settings.impact_sweeps.max(self.settings.sweeps),
            (false, false) => self.settings.sweeps,
        };
        begin_sweeps(forest, &mut self.nodes);
        for _ in 0..most {
            let mut worst = 0.0_f64;
            for tree in &forest.trees {
                worst = worst.max(rows.sweep(tree, forest, &mut self.nodes, &mut self.actors));
            }
            worst = worst.max(rows.between(forest, &mut self.nodes));
            self.sweeps_done += 1;
            if worst < tolerance_m_s {
                break;
            }
        }
        finish_sweeps(forest, &mut self.nodes);
    }
}

/// Completes the rows of a couple, and adds its stored angular impulse to the given impulses.
fn coupled(
    mut couple: Couple,
    group: &Group,
    whole_k: f64,
    forest: &Forest,
    nodes: &mut [Node],
) -> Couple {
    if group.b == NONE {
        let response = &nodes[group.a].response;
        couple.a.response = couple.a.jacobian.map(|row| response.times(&row));
        couple.b = Side::default();
    } else {
        compute_responses(&mut couple.a, &mut couple.b, group, forest, nodes);
    }
    couple.weigh(whole_k);
    for (body, side) in [(group.a, &couple.a), (group.b, &couple.b)] {
        let Some(node) = nodes.get_mut(body) else {
            continue;
        };
        for (row, impulse) in side.jacobian.iter().zip(couple.impulse) {
            node.warm.add_scaled(row, impulse);
        }
    }
    couple
}

/// Computes the responses of both bodies to impulses of a contact between them.
fn compute_responses(
    a: &mut Side,
    b: &mut Side,
    group: &Group,
    forest: &Forest,
    nodes: &mut [Node],
) {
    let tops = tops(group, forest);
    for k in 0..3 {
        if group.meeting == NONE {
            a.response[k] = nodes[group.a].response.times(&a.jacobian[k]);
            b.response[k] = nodes[group.b].response.times(&b.jacobian[k]);
        } else {
            let ends = [(group.a, a.jacobian[k]), (group.b, b.jacobian[k])];
            respond(forest, nodes, tops[0], ends);
            a.response[k] = nodes[group.a].change;
            b.response[k] = nodes[group.b].change;
        }
    }
}
