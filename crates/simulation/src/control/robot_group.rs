//! Synchronous simulation of a group of robots: all robots sense, receive messages and decide at the same moment, and then all of
//! them advance by one step.

use nalgebra::Isometry3;

use super::super::experiment::Experiment;
use super::super::ground::ground_of;
use super::super::outcome::Outcome;
use super::super::run::{Rollout, Run, RunProgress};
use super::super::scene::SceneBody;
use super::super::watch::RunHooks;
use super::mount::{MountedSensor, outline};
use super::rule::RuleSelector;
use super::{Controller, Decision, Feedback, Heard, Log, Sensed, Steer, arena_from_start};
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Assembly;
use realgap_sensing::arena::Arena;
use realgap_sensing::radio::{Delivery, Message, Service, ServiceOptions};

/// One robot of the group during a run.
struct GroupRobot<'a> {
    name: &'a str,
    rollout: Rollout<'a>,
    progress: RunProgress,
    sensors: Vec<MountedSensor<'a>>,
    rule_selector: RuleSelector,
    arena_from_world: Isometry3<f64>,
    /// Messages that were sent to this robot, in the order of sending.
    inbox: Vec<Heard>,
}

/// Simulates an experiment with its controller. The feedback is called after the rules and may override them; the observer is
/// called for the experiment's own robot.
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
        .map(|(robot, (_, start))| experiment_of(experiment, controller, robot, *start))
        .collect::<Result<Vec<Experiment>>>()?;
    let assemblies: Vec<Assembly> = experiments
        .iter()
        .map(Experiment::adjusted_assembly)
        .collect();
    let mut group = Vec::with_capacity(starts.len());
    for (robot, (name, start)) in starts.iter().enumerate() {
        let mut rollout = Rollout::new(&experiments[robot], &assemblies[robot])?;
        let mut no_observer = None;
        let observer = if robot == 0 {
            &mut hooks.observer
        } else {
            &mut no_observer
        };
        let progress = match rollout.begin(&experiments[robot], observer)? {
            Ok(progress) => progress,
            Err(divergence) => {
                let outcome = Outcome::Diverged(divergence);
                return Ok((rollout.take_run(outcome), Log::default()));
            }
        };
        group.push(GroupRobot {
            name,
            rollout,
            progress,
            sensors: MountedSensor::all(
                controller,
                &assemblies[robot],
                robot,
                experiment.perturbation.draw,
            )?,
            rule_selector: RuleSelector::default(),
            arena_from_world: arena_from_start(*start),
            inbox: Vec::new(),
        });
    }
    let by_rule = controller.by_hinge(experiment)?;
    let channel = RadioChannel::new(controller, experiment.perturbation.draw)?;
    let mut log = Log::default();
    let timestep_s = experiment.solver.timestep_s;
    let (mut decisions, mut sendings) = (0_u64, 0_u64);
    for step in 1..=group[0].progress.steps {
        hooks.report_progress(step - 1, group[0].progress.steps)?;
        let now_s = (step - 1) as f64 * timestep_s;
        // Times of decisions are whole multiples of the period, so that rounding errors do not accumulate.
        if now_s + 1e-9 >= decisions as f64 / controller.rate_hz {
            decisions += 1;
            let poses: Vec<Vec<Isometry3<f64>>> = group.iter().map(GroupRobot::poses).collect();
            if let Some(channel) = channel
                .as_ref()
                .filter(|channel| channel.is_due(now_s, sendings))
            {
                channel.send(&mut group, now_s, sendings);
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
            let mut no_observer = None;
            let observer = if robot == 0 {
                &mut hooks.observer
            } else {
                &mut no_observer
            };
            let Some(mut divergence) = member.rollout.advance(&mut member.progress, step, observer)
            else {
                continue;
            };
            if robot > 0 {
                divergence.why = format!("robot {}: {}", member.name, divergence.why);
            }
            let outcome = Outcome::Diverged(divergence);
            return Ok((group[0].rollout.take_run(outcome), log));
        }
    }
    collect(group, &arena_from_start(start).inverse(), log)
}

/// The run of the experiment's own robot, and the log with the paths of the other robots in its frame.
fn collect(
    group: Vec<GroupRobot<'_>>,
    own_from_arena: &Isometry3<f64>,
    mut log: Log,
) -> Result<(Run, Log)> {
    let mut own = None;
    for mut member in group {
        let path = member.progress.finish()?;
        if own.is_none() {
            own = Some(member.rollout.take_run(Outcome::Completed(path)));
        } else {
            let path = moved(&path, &(own_from_arena * member.arena_from_world))?;
            log.others.push((member.name.to_owned(), path));
        }
    }
    let own = own.ok_or_else(|| Error::invalid("a group without robots"))?;
    Ok((own, log))
}

/// The experiment of one robot of the group: the same experiment, with the walls of the arena relative to the robot's own start.
fn experiment_of(
    experiment: &Experiment,
    controller: &Controller,
    robot: usize,
    start: [f64; 3],
) -> Result<Experiment> {
    let mut own = experiment.clone();
    if robot == 0 {
        return Ok(own);
    }
    let arena = Arena {
        start: Some(start),
        ..Arena::clone(&controller.arena)
    };
    if !arena.ground.is_plain() {
        own.ground = ground_of(&arena, true)?;
    }
    if !arena.objects.is_empty() {
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

impl GroupRobot<'_> {
    /// Poses of the robot's parts in the arena.
    fn poses(&self) -> Vec<Isometry3<f64>> {
        let parts = self.rollout.poses().into_iter();
        parts.map(|pose| self.arena_from_world * pose).collect()
    }

    /// Position of the robot's tracked module in the arena, metres.
    fn place_m(&self) -> [f64; 3] {
        let at = nalgebra::Point3::from(self.rollout.track().position_world_m);
        (self.arena_from_world * at).coords.into()
    }
}

/// Every robot reads its sensors at the present poses of all robots, and decides.
fn decide(
    (controller, by_rule): (&Controller, &[Vec<(usize, Steer)>]),
    assemblies: &[Assembly],
    poses: &[Vec<Isometry3<f64>>],
    group: &mut [GroupRobot<'_>],
    now_s: f64,
    feedback: &mut Option<Feedback<'_>>,
    log: &mut Log,
) -> Result<()> {
    let outlines: Vec<_> = assemblies
        .iter()
        .zip(poses)
        .map(|(a, poses)| outline(a, poses))
        .collect();
    for (robot, member) in group.iter_mut().enumerate() {
        let mut surroundings = Arena::clone(&controller.arena);
        for (_, outline) in outlines
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != robot)
        {
            surroundings.objects.extend(outline.iter().cloned());
        }
        let sensed = Sensed {
            robot,
            time_s: now_s,
            position_m: member.place_m(),
            readings: member
                .sensors
                .iter_mut()
                .map(|sensor| sensor.read(&surroundings, &poses[robot]))
                .collect(),
            angles_rad: member.rollout.angles_rad(),
            heard: last_heard(&member.inbox, now_s),
        };
        let rule = member.rule_selector.decide(controller, &sensed);
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

/// For every sender the latest message among those that have collect.
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

/// The radio channel that carries the messages.
struct RadioChannel<'a> {
    service: Service<'a>,
    every_s: f64,
}

impl<'a> RadioChannel<'a> {
    fn new(controller: &'a Controller, draw: Option<(u64, u64)>) -> Result<Option<Self>> {
        let Some(radio) = &controller.radio else {
            return Ok(None);
        };
        let (seed, repeat) = draw.unwrap_or_default();
        let options = ServiceOptions {
            // Each repeat has its own random shadowing and message losses.
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

    /// Every robot sends its present position to every other robot.
    fn send(&self, group: &mut [GroupRobot<'_>], at_s: f64, sending: u64) {
        let places: Vec<[f64; 3]> = group.iter().map(GroupRobot::place_m).collect();
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
