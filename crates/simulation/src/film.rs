//! Poses of all parts of a robot over a run: simulated, read from a file, or computed from the tracked module and the joints.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::control::Log;
use super::experiment::Experiment;
use super::kinematics::{part_from_track, robot_from_part_at_zero, robot_from_parts};
use super::run::{Run, run_with};
use super::watch::{RunHooks, Snapshot};
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Recording, Trajectory};
use realgap_robot::morphology::{Assembly, Solid};

/// The motion of the tracked module and of every part whose motion is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// The tracked module, with the joints where they are known.
    pub track: Trajectory,
    /// Poses of the parts' own frames ([`part_from_solid`]), in the assembly's order, at the times of `track`; `None` for a part
    /// whose poses are unknown.
    pub parts: Vec<Option<Vec<Isometry3<f64>>>>,
    /// Poses of the bodies of the scene at the same times, in the experiment's order; empty for a recorded run.
    pub scene: Vec<Vec<Isometry3<f64>>>,
}

/// Simulates the experiment as [`run`](super::run()) does and records all parts and joints at its sample times. The film is
/// `None` for a run that diverged.
///
/// # Errors
/// As [`run_with`]; a vehicle has no parts.
pub fn film(experiment: &Experiment) -> Result<(Run, Option<Film>)> {
    film_with(experiment, RunHooks::default()).map(|(run, film, _)| (run, film))
}

/// As [`film`], with hooks as in [`run_with`] and with the log of the controller's decisions.
///
/// # Errors
/// As [`film`] and [`run_with`].
pub fn film_with(experiment: &Experiment, hooks: RunHooks<'_>) -> Result<(Run, Option<Film>, Log)> {
    let mut experiment = experiment.clone();
    experiment.records_joints = !experiment.assembly.hinges.is_empty();
    let times_s = experiment.sample_times_s();
    let slack_s = 1e-9 * experiment.solver.timestep_s.max(1e-3);
    let mut parts = vec![Vec::with_capacity(times_s.len()); experiment.assembly.parts.len()];
    let mut before: Option<Snapshot> = None;
    let mut scene = vec![Vec::with_capacity(times_s.len()); experiment.scene.len()];
    let mut next = 0;
    let mut further = hooks.observer;
    let mut observer = |now: &Snapshot| {
        if let Some(further) = &mut further {
            further(now);
        }
        while next < times_s.len() && times_s[next] <= now.time_s + slack_s {
            let share = before.as_ref().map_or(1.0, |before| {
                let share = (times_s[next] - before.time_s) / (now.time_s - before.time_s);
                share.clamp(0.0, 1.0)
            });
            let mixed = |of: &dyn Fn(&Snapshot) -> Isometry3<f64>| match &before {
                Some(before) => between(&of(before), &of(now), share),
                None => of(now),
            };
            for (index, poses) in parts.iter_mut().enumerate() {
                poses.push(mixed(&|at| at.parts[index].world_from_part));
            }
            for (index, poses) in scene.iter_mut().enumerate() {
                poses.push(mixed(&|at| at.scene[index]));
            }
            next += 1;
        }
        before = Some(now.clone());
    };
    // Shortens the lifetimes of the caller's hooks to that of the new observer.
    let hooks = RunHooks {
        observer: Some(&mut observer),
        feedback: hooks.feedback.map(|feedback| feedback as _),
        clock: hooks.clock.map(|clock| clock as _),
    };
    let (run, log) = run_with(&experiment, hooks)?;
    let film = run.outcome.get().map(|track| Film {
        track: track.clone(),
        parts: parts.into_iter().map(Some).collect(),
        scene,
    });
    Ok((run, film, log))
}

fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, share: f64) -> Isometry3<f64> {
    a.try_lerp_slerp(b, share, 1e-12).unwrap_or(*b)
}

/// Pose of a box in the frame of its part: origin at the centre of the part's first box, axes of the robot at zero angles.
pub fn part_from_solid(assembly: &Assembly, part: usize, solid: &Solid) -> Isometry3<f64> {
    robot_from_part_at_zero(assembly, part).inverse() * solid.robot_from_solid
}

/// Name of a part in the columns of a file.
pub fn part_name(part: usize) -> String {
    format!("part{part}")
}

impl Film {
    /// The film of a recorded run. The poses come from the columns `part0_x_m` and so on, if every part has them; otherwise they
    /// follow from the tracked module's orientation and the recorded joints, or, for a mounted robot, from the joints alone.
    /// Parts beyond a joint without a recording are unknown.
    pub fn of_recording(assembly: &Assembly, recording: &Recording) -> Self {
        let track = recording.trajectory.clone();
        let count = assembly.parts.len();
        let columns: Option<Vec<_>> = (0..count)
            .map(|part| {
                let name = part_name(part);
                let mut bodies = recording.bodies.iter();
                let motion = &bodies.find(|(body, _)| *body == name)?.1;
                Some(poses(motion)?.collect())
            })
            .collect();
        if let Some(columns) = columns {
            let parts = columns.into_iter().map(Some).collect();
            return Self {
                track,
                parts,
                scene: Vec::new(),
            };
        }
        let joints: Vec<_> = (assembly.hinges.iter())
            .map(|hinge| track.joint(&hinge.name))
            .collect();
        let held = assembly.world_from_mount.filter(|_| track.is_of_joints());
        let tracked = poses(&track).map(Iterator::collect::<Vec<_>>);
        if tracked.is_none() && held.is_none() {
            return Self {
                track,
                parts: vec![None; count],
                scene: Vec::new(),
            };
        }
        // The root of a mounted robot is known without any joint.
        let start = if held.is_some() {
            0
        } else {
            assembly.track_part
        };
        let known = known_parts(assembly, start, |hinge| joints[hinge].is_some());
        let part_from_track = part_from_track(assembly);
        let mut places = Vec::with_capacity(track.len());
        let mut parts = vec![Vec::with_capacity(track.len()); count];
        for sample in 0..track.len() {
            let angles: Vec<f64> = (joints.iter())
                .map(|joint| joint.map_or(0.0, |joint| joint.angles_rad[sample]))
                .collect();
            let robot_from_parts = robot_from_parts(assembly, &angles);
            let robot_from_track = robot_from_parts[assembly.track_part] * part_from_track;
            let world_from_robot = match (&tracked, held) {
                (Some(world_from_track), _) => {
                    world_from_track[sample] * robot_from_track.inverse()
                }
                (None, world_from_mount) => world_from_mount.unwrap_or_default(),
            };
            places.push((world_from_robot * robot_from_track).translation.vector);
            for (poses, robot_from_part) in parts.iter_mut().zip(&robot_from_parts) {
                poses.push(world_from_robot * robot_from_part);
            }
        }
        let track = match held.and(Trajectory::new(track.times_s().to_vec(), places).ok()) {
            Some(path) if known[assembly.track_part] => path,
            _ => track,
        };
        let parts = (parts.into_iter().zip(known))
            .map(|(poses, known)| known.then_some(poses))
            .collect();
        Self {
            track,
            parts,
            scene: Vec::new(),
        }
    }

    /// The parts as bodies for [`write_with_bodies`](realgap_path::trajectory::write_with_bodies): `part0` carries the root module.
    ///
    /// # Errors
    /// Poses that make no trajectory.
    pub fn bodies(&self) -> Result<Vec<(String, Trajectory)>> {
        let known = self.parts.iter().enumerate();
        known
            .filter_map(|(part, poses)| Some((part, poses.as_ref()?)))
            .map(|(part, poses)| {
                let places = poses.iter().map(|pose| pose.translation.vector).collect();
                let turns = poses.iter().map(|pose| pose.rotation).collect();
                let motion = Trajectory::new(self.track.times_s().to_vec(), places)?;
                Ok((part_name(part), motion.with_orientations(turns)?))
            })
            .collect()
    }

    /// The film rotated about the world's z axis and then shifted.
    ///
    /// # Errors
    /// Positions that are no longer finite.
    pub fn moved(&self, turn_rad: f64, shift_m: Vector3<f64>) -> Result<Self> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
        let old = &self.track;
        let places = old.positions_world_m().iter();
        let places: Vec<_> = places.map(|p| turn * p + shift_m).collect();
        if !places.iter().all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(Error::invalid("the path is too long to be moved"));
        }
        let mut track = Trajectory::new(old.times_s().to_vec(), places)?;
        if let Some(turns) = old.orientations_world_from_body() {
            track = track.with_orientations(turns.iter().map(|q| turn * q).collect())?;
        }
        let to = Isometry3::from_parts(shift_m.into(), turn);
        let parts = self.parts.iter().map(|poses| {
            let poses = poses.as_ref()?;
            Some(poses.iter().map(|pose| to * pose).collect())
        });
        Ok(Self {
            track: track.with_joints(old.joints().to_vec())?,
            parts: parts.collect(),
            scene: self
                .scene
                .iter()
                .map(|poses| poses.iter().map(|pose| to * pose).collect())
                .collect(),
        })
    }
}

/// Poses of a motion with orientations.
fn poses(motion: &Trajectory) -> Option<impl Iterator<Item = Isometry3<f64>> + '_> {
    let turns = motion.orientations_world_from_body()?;
    let places = motion.positions_world_m().iter();
    Some((places.zip(turns)).map(|(place, turn)| Isometry3::from_parts((*place).into(), *turn)))
}

/// For each part whether it is connected to the part `start` by joints with known coordinates.
fn known_parts(assembly: &Assembly, start: usize, is_known: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut known = vec![false; assembly.parts.len()];
    known[start] = true;
    // Every iteration reaches at least one more part, or none is left to reach.
    for _ in 0..assembly.parts.len() {
        for (index, hinge) in assembly.hinges.iter().enumerate() {
            if is_known(index) && (known[hinge.parent_part] || known[hinge.child_part]) {
                known[hinge.parent_part] = true;
                known[hinge.child_part] = true;
            }
        }
    }
    known
}
