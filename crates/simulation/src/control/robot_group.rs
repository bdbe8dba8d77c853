//! Robots in step: what each senses, hears and decides at the same moment, and then one step of all.

use nalgebra::Isometry3;

use super::super::experiment::Experiment;
use super::super::outcome::Outcome;
use super::super::run::{Course, Rollout, Run};
use super::super::scene::SceneBody;
use super::super::watch::RunHooks;
use super::mount::{Eye, plan};
use super::rule::Mind;
use super::{Controller, Decision, Feedback, Heard, Log, Sensed, Steer, arena_from_start};
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Assembly;
use realgap_sensing::arena::Arena;
use realgap_sensing::radio::{Delivery, Message, Service, ServiceOptions};

/// One robot among the others.
struct Member<'a> {
    name: &'a str,
    rollout: Rollout<'a>,
    course: Course,
    eyes: Vec<Eye<'a>>,
    mind: Mind,
    arena_from_world: Isometry3<f64>,
    /// What was sent to it, in the order of sending.
    inbox: Vec<Heard>,
}

/// Simulates an experiment with its controller. The feedback decides after the rules; the observer sees the experiment's own robot.
pub(in super::super) fn steered(
    experiment: &Experiment,
    controller: &Controller,
    mut hooks: RunHooks<'_>,
) -> Result<(Run, Log)> {
    controller.check(experiment)?;
    let start = controller.arena.start.unwrap_or([0.0; 3]);
    let mut starts = vec![(controller.name.as_str(), start)];
    starts.extend(controller.others.iter().map(|o| (o.name.as_str(), o.start)));
    let experiments = starts
        .iter()
        .enumerate()
        .map(|(robot, (_, start))| among_walls(experiment, controller, robot, *start))
        .collect::<Result<Vec<Experiment>>>()?;
    let assemblies: Vec<Assembly> = experiments
        .iter()
        .map(Experiment::adjusted_assembly)
        .collect();
    let mut group = Vec::with_capacity(starts.len());
    for (robot, (name, start)) in starts.iter().enumerate() {
        let mut rollout = Rollout::new(&experiments[robot], &assemblies[robot])?;
        let mut nobody = None;
        let watched = if robot == 0 {
            &mut hooks.observer
        } else {
            &mut nobody
        };
        let course = match rollout.begin(&experiments[robot], watched)? {
            Ok(course) => course,
            Err(divergence) => {
                let outcome = Outcome::Diverged(divergence);
                return Ok((rollout.told(outcome), Log::default()));
            }
        };
        group.push(Member {
            name,
            rollout,
            course,
            eyes: Eye::all(
                controller,
                &assemblies[robot],
                robot,
                experiment.perturbation.draw,
            )?,
            mind: Mind::default(),
            arena_from_world: arena_from_start(*start),
            inbox: Vec::new(),
        });
    }
    let by_rule = controller.by_hinge(experiment)?;
    let air = Air::new(controller, experiment.perturbation.draw)?;
    let mut log = Log::default();
    let timestep_s = experiment.solver.timestep_s;
    let (mut decisions, mut sendings) = (0_u64, 0_u64);
    for step in 1..=group[0].course.steps {
        hooks.tell(step - 1, group[0].course.steps)?;
        let now_s = (step - 1) as f64 * timestep_s;
        // Times of decisions are whole multiples of the period, so that rounding does not add up.
        if now_s + 1e-9 >= decisions as f64 / controller.rate_hz {
            decisions += 1;
            let poses: Vec<Vec<Isometry3<f64>>> = group.iter().map(Member::poses).collect();
            if let Some(air) = air.as_ref().filter(|air| air.is_due(now_s, sendings)) {
                air.send(&mut group, now_s, sendings);
                sendings += 1;
            }
            decide(
                (controller, &by_rule),
                &assemblies,
                &poses,
                &mut group,
                now_s,
                &mut hooks.feedback,
                &mut log,
            )?;
        }
        for (robot, member) in group.iter_mut().enumerate() {
            let mut nobody = None;
            let watched = if robot == 0 {
                &mut hooks.observer
            } else {
                &mut nobody
            };
            let Some(mut divergence) = member.rollout.advance(&mut member.course, step, watched)
            else {
                continue;
            };
            if robot > 0 {
                divergence.why = format!("robot {}: {}", member.name, divergence.why);
            }
            let outcome = Outcome::Diverged(divergence);
            return Ok((group[0].rollout.told(outcome), log));
        }
    }
    arrived(group, &arena_from_start(start).inverse(), log)
}

/// What the robot did, and the others in its frame.
fn arrived(
    group: Vec<Member<'_>>,
    own_from_arena: &Isometry3<f64>,
    mut log: Log,
) -> Result<(Run, Log)> {
    let mut own = None;
    for mut member in group {
        let path = member.course.finish()?;
        if own.is_none() {
            own = Some(member.rollout.told(Outcome::Completed(path)));
        } else {
            let path = moved(&path, &(own_from_arena * member.arena_from_world))?;
            log.others.push((member.name.to_owned(), path));
        }
    }
    let own = own.ok_or_else(|| Error::invalid("a group without robots"))?;
    Ok((own, log))
}

/// The experiment of one robot: the same, where it begins in the arena.
fn among_walls(
    experiment: &Experiment,
    controller: &Controller,
    robot: usize,
    start: [f64; 3],
) -> Result<Experiment> {
    let mut own = experiment.clone();
    if robot > 0 && !controller.arena.objects.is_empty() {
        let arena = Arena {
            start: Some(start),
            ..Arena::clone(&controller.arena)
        };
        own.scene.retain(|body| body.name != SceneBody::ARENA);
        own.scene.push(SceneBody::of_arena(&arena, true)?);
    }
    Ok(own)
}

fn moved(path: &Trajectory, by: &Isometry3<f64>) -> Result<Trajectory> {
    let places = path
        .positions_world_m()
        .iter()
        .map(|at| by * nalgebra::Point3::from(*at));
    let moved = Trajectory::new(
        path.times_s().to_vec(),
        places.map(|at| at.coords).collect(),
    )?;
    match path.orientations_world_from_body() {
        Some(turns) => {
            moved.with_orientations(turns.iter().map(|turn| by.rotation * turn).collect())
        }
        None => Ok(moved),
    }
}

impl Member<'_> {
    /// Poses of its parts in the arena.
    fn poses(&self) -> Vec<Isometry3<f64>> {
        let parts = self.rollout.poses().into_iter();
        parts.map(|pose| self.arena_from_world * pose).collect()
    }

    /// Where its tracked module is in the arena, metres.
    fn place_m(&self) -> [f64; 3] {
        let at = nalgebra::Point3::from(self.rollout.track().position_world_m);
        (self.arena_from_world * at).coords.into()
    }
}

/// Every robot senses where all are now, and decides.
fn decide(
    (controller, by_rule): (&Controller, &[Vec<(usize, Steer)>]),
    assemblies: &[Assembly],
    poses: &[Vec<Isometry3<f64>>],
    group: &mut [Member<'_>],
    now_s: f64,
    feedback: &mut Option<Feedback<'_>>,
    log: &mut Log,
) -> Result<()> {
    let plans: Vec<_> = assemblies
        .iter()
        .zip(poses)
        .map(|(a, poses)| plan(a, poses))
        .collect();
    for (robot, member) in group.iter_mut().enumerate() {
        let mut seen = Arena::clone(&controller.arena);
        for (_, plan) in plans
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != robot)
        {
            seen.objects.extend(plan.iter().cloned());
        }
        let sensed = Sensed {
            robot,
            time_s: now_s,
            position_m: member.place_m(),
            readings: member
                .eyes
                .iter_mut()
                .map(|eye| eye.read(&seen, &poses[robot]))
                .collect(),
            angles_rad: member.rollout.angles_rad(),
            heard: last_heard(&member.inbox, now_s),
        };
        let rule = member.mind.decide(controller, &sensed);
        let steering = member.rollout.steering();
        steering.fill(Steer::Own);
        for (hinge, steer) in rule.iter().flat_map(|rule| &by_rule[*rule]) {
            steering[*hinge] = *steer;
        }
        if let Some(feedback) = feedback {
            feedback(&sensed, steering)?;
        }
        log.decisions.push(Decision { sensed, rule });
    }
    Ok(())
}

/// Of every sender the message that was sent last of those that have arrived.
fn last_heard(inbox: &[Heard], now_s: f64) -> Vec<Heard> {
    let mut last: Vec<Heard> = Vec::new();
    for heard in inbox.iter().filter(|heard| heard.arrived_s <= now_s + 1e-9) {
        match last.iter_mut().find(|known| known.from == heard.from) {
            Some(known) => *known = heard.clone(),
            None => last.push(heard.clone()),
        }
    }
    last.sort_by_key(|heard| heard.from);
    last
}

/// What messages go through.
struct Air<'a> {
    service: Service<'a>,
    every_s: f64,
}

impl<'a> Air<'a> {
    fn new(controller: &'a Controller, draw: Option<(u64, u64)>) -> Result<Option<Self>> {
        let Some(radio) = &controller.radio else {
            return Ok(None);
        };
        let (seed, repeat) = draw.unwrap_or_default();
        let options = ServiceOptions {
            // Repeats have places and messages of their own.
            seed: seed ^ (repeat << 32),
            noise: draw.is_some(),
            ..radio.service
        };
        Ok(Some(Self {
            service: Service::new(&radio.model, &controller.arena, options)?,
            every_s: radio.every_s,
        }))
    }

    fn is_due(&self, now_s: f64, sendings: u64) -> bool {
        now_s + 1e-9 >= sendings as f64 * self.every_s
    }

    /// Every robot tells every other where it is now.
    fn send(&self, group: &mut [Member<'_>], at_s: f64, sending: u64) {
        let places: Vec<[f64; 3]> = group.iter().map(Member::place_m).collect();
        let count = places.len() as u64;
        for (to, member) in group.iter_mut().enumerate() {
            for (from, from_m) in places.iter().enumerate().filter(|(from, _)| *from != to) {
                let message = Message {
                    number: (sending * count + from as u64) * count + to as u64,
                    from_m: *from_m,
                    to_m: places[to],
                    at_s,
                };
                let Delivery::Delivered {
                    at_s: arrived_s,
                    strength_dbm,
                } = self.service.send(&message)
                else {
                    continue;
                };
                member.inbox.push(Heard {
                    from,
                    position_m: *from_m,
                    sent_s: at_s,
                    arrived_s,
                    strength_dbm,
                });
            }
        }
    }
}
