//! Pictures of moving robots, and pictures by cameras on them.

use std::sync::Arc;

use realgap::calibration::Overrides;
use realgap::file::{look_up, unknown_name};
use realgap::report::{ShownSolid, shown_body, shown_parts};
use realgap::robot::morphology::{Assembly, Shape};
use realgap::simulation::{Film, SceneBody, SceneMotion, part_name};
use realgap::trajectory::{self, Reading, Recording, Trajectory};
use realgap::vision::camera::{Body, BodyBox, Mount, Plane, Ride, Scene, Watch};

use super::{Album, Picture, numbered};
use crate::cli::kind::{is_study, read_definition};
use crate::cli::kit::*;

/// Largest number of pictures of one viewpoint.
const MOST_PICTURES: f64 = 10_000.0;

/// A motion and the bodies that move in it.
pub(super) struct Moving {
    recording: Recording,
    mount: Mount,
    /// The bodies that are shown; empty without `--robot`.
    bodies: Vec<Body>,
    /// Name of the body that carries the mount.
    carrier: String,
    /// Times of the pictures, seconds after the first sample.
    times_s: Vec<f64>,
}

impl Moving {
    /// Reads the motion that the options name; `None` if no option names one.
    pub(super) fn read(options: &Picture, scene: &Scene) -> Result<Option<Self>> {
        let Some(run) = &options.run else {
            return Ok(None);
        };
        let (option, name) = match (&options.ride, &options.watch) {
            (Some(name), _) => ("--ride", name),
            (None, Some(name)) => ("--watch", name),
            (None, None) => return Ok(None),
        };
        let mount = scene
            .mount(name)
            .map_err(|e| e.field(option).into_usage())?
            .clone();
        if !(options.every > 0.0 && options.every.is_finite()) {
            return Err(Error::usage("not a time between pictures")
                .field("--every")
                .found(options.every)
                .allowed("seconds above 0"));
        }
        let reading = options.reading.reading()?;
        let (recording, (bodies, tracked)) = match &options.robot {
            None => (trajectory::read(run, reading)?, Default::default()),
            Some(robot) => {
                let cast = Cast::read(robot, run, reading)?;
                let recording = trajectory::read(run, cast.reading.clone())?;
                let company = cast.company(&recording).map_err(|e| about(run, e))?;
                (recording, company)
            }
        };
        terminal::print_warnings(&recording.warnings);
        let carrier = mount.body.clone().unwrap_or(tracked);
        let mut moving = Self {
            recording,
            mount,
            bodies,
            carrier,
            times_s: Vec::new(),
        };
        moving.times_s = times_s(moving.motion()?.duration_s(), options.every)?;
        let fits = moving.check(options, scene);
        fits.map_err(|e| about(run, e))?;
        Ok(Some(moving))
    }

    /// Checks the whole motion, so that no picture is written of a motion that does not fit the room.
    fn check(&self, options: &Picture, scene: &Scene) -> Result<()> {
        if options.ride.is_none() {
            let watch = self.watching(scene)?;
            return self.times_s.iter().try_for_each(|t| watch.check(*t));
        }
        let ride = self.riding(scene)?;
        let mut times_s = self.times_s.iter();
        times_s.try_for_each(|t| ride.pose_at(*t).map(drop))
    }

    fn riding<'a>(&'a self, scene: &'a Scene) -> Result<Ride<'a>> {
        let ride = Ride::new(scene, &self.mount, self.motion()?)?;
        Ok(ride.with_bodies(&self.bodies, &self.carrier))
    }

    fn watching<'a>(&'a self, scene: &'a Scene) -> Result<Watch<'a>> {
        let motion = self.motion()?;
        Ok(Watch::new(scene, &self.mount, motion, &self.bodies))
    }

    /// The motion of the mount's body; the motion of the tracked module if the mount names no body.
    fn motion(&self) -> Result<&Trajectory> {
        let Some(name) = &self.mount.body else {
            return Ok(&self.recording.trajectory);
        };
        let body = look_up("body", name, &self.recording.bodies, |(n, _)| n);
        let body = body.map_err(|e| {
            e.at_file(&self.recording.path)
                .or_hint("`realgap simulate --parts` writes every part")
        })?;
        Ok(&body.1)
    }

    /// Takes all pictures.
    pub(super) fn take(
        &self,
        options: &Picture,
        scene: &Scene,
        album: &mut Album<'_>,
    ) -> Result<()> {
        let taken = if options.ride.is_some() {
            self.ride(options, scene, album)
        } else {
            self.watch(options, scene, album)
        };
        taken.map_err(|e| about(&self.recording.path, e))
    }

    fn ride(&self, options: &Picture, scene: &Scene, album: &mut Album<'_>) -> Result<()> {
        let ride = self.riding(scene)?;
        let (camera, light) = (album.camera, album.light);
        album.expect(self.times_s.len());
        for (number, time_s) in self.times_s.iter().enumerate() {
            let (picture, view) = ride.take(camera, light, *time_s, options.seed, number as u64)?;
            album.keep(&picture, &ride.room_at(*time_s), &view)?;
        }
        Ok(())
    }

    fn watch(&self, options: &Picture, scene: &Scene, album: &mut Album<'_>) -> Result<()> {
        let watch = self.watching(scene)?;
        let (camera, light) = (album.camera, album.light);
        album.expect(options.views(scene).count() * self.times_s.len());
        for (index, view) in options.views(scene) {
            for (number, time_s) in self.times_s.iter().enumerate() {
                // The camera has the same pose as in a picture without robots; its noise differs between pictures.
                let place = numbered(index) + 1;
                let number = (index as u64) * (MOST_PICTURES as u64 + 1) + number as u64;
                let (picture, view) =
                    watch.take(camera, view, light, *time_s, options.seed, [place, number])?;
                album.keep(&picture, &watch.room_at(*time_s), &view)?;
            }
        }
        Ok(())
    }
}

/// The error with the run as its file, unless the error names another file.
fn about(run: &Path, error: Error) -> Error {
    match error.file() {
        Some(_) => error,
        None => error.at_file(run),
    }
}

/// The times of the pictures.
fn times_s(duration_s: f64, every_s: f64) -> Result<Vec<f64>> {
    let count = (duration_s / every_s + 1e-9).floor();
    if count > MOST_PICTURES {
        return Err(Error::usage("too many pictures")
            .field("--every")
            .found(format!("{count} in {duration_s} s"))
            .allowed(format!("at most {MOST_PICTURES}")));
    }
    let times = (0..=count as u64).map(|number| (number as f64 * every_s).min(duration_s));
    Ok(times.collect())
}

/// The robot of a file, and the other bodies of its scene.
struct Cast {
    file: PathBuf,
    morphology: Morphology,
    others: Vec<SceneBody>,
    /// How the run is read.
    reading: Reading,
}

impl Cast {
    fn read(robot: &Path, run: &Path, reading: Reading) -> Result<Self> {
        let file = robot.to_owned();
        if !is_study(robot) {
            return Ok(Self {
                file,
                morphology: read_morphology(robot)?,
                others: Vec::new(),
                reading,
            });
        }
        let overrides = Overrides {
            recordings: vec![run.display().to_string()],
            reading,
            ..Overrides::default()
        };
        let study = read_definition(robot, &overrides)?;
        if study.vehicle.is_some() {
            return Err(Error::invalid("a vehicle has no parts to show")
                .at_file(robot)
                .hint("name a robot of modules"));
        }
        // What lies on the floor is seen, too.
        let experiment = study.experiment();
        let mut others = study.scene;
        others.extend(experiment.shown_scene().split_off(experiment.scene.len()));
        Ok(Self {
            file,
            morphology: study.morphology,
            others,
            reading: study.reading,
        })
    }

    /// The bodies in a recording, and the name of the part that is tracked.
    fn company(&self, recording: &Recording) -> Result<(Vec<Body>, String)> {
        let assembly = self.morphology.assemble();
        let parts: Vec<String> = (0..assembly.parts.len()).map(part_name).collect();
        let known = || {
            let others = self.others.iter().map(|other| other.name.as_str());
            parts.iter().map(String::as_str).chain(others)
        };
        let mut recorded = recording.bodies.iter();
        if let Some((stranger, _)) = recorded.find(|(body, _)| known().all(|name| name != body)) {
            let hint = format!(
                "{} has no such part: name the robot that made the run, or a study whose scene has this body",
                self.file.display()
            );
            return Err(unknown_name("body of the robot", stranger, known()).hint(hint));
        }
        let motions = part_motions(&assembly, recording)?;
        let mut bodies = Vec::new();
        for ((name, motion), boxes) in motions.into_iter().zip(shown_parts(&self.morphology)) {
            bodies.push(Body::moving(&name, taken(&boxes), motion)?);
        }
        for other in &self.others {
            bodies.push(beside(other, recording)?);
        }
        Ok((bodies, part_name(assembly.track_part)))
    }
}

/// Another body of the scene, at the place that the study or the recording gives.
fn beside(other: &SceneBody, recording: &Recording) -> Result<Body> {
    let boxes = taken(&shown_body(other));
    if let SceneMotion::Fixed { world_from_body } = &other.motion {
        return Ok(Body::still(&other.name, boxes, *world_from_body));
    }
    let mut recorded = recording.bodies.iter();
    let Some((_, motion)) = recorded.find(|(name, _)| *name == other.name) else {
        return Err(
            Error::invalid("the position of this body of the scene is not known")
                .field(&other.name)
                .found("no columns of this body")
                .allowed(format!("{0}_x_m to {0}_qz", other.name))
                .hint("name the robot's own file in place of the study to leave the scene out"),
        );
    };
    Body::moving(&other.name, boxes, motion.clone())
}

/// Where every part is over time.
fn part_motions(assembly: &Assembly, recording: &Recording) -> Result<Vec<(String, Trajectory)>> {
    let film = Film::of_recording(assembly, recording);
    let track = &recording.trajectory;
    let unknown = film.parts.iter().position(Option::is_none);
    let found = match unknown {
        None if track.is_planar() && recording.bodies.is_empty() => "a motion without heights",
        None => return film.bodies(),
        Some(_) if track.orientations_world_from_body().is_none() => {
            "a motion without orientations"
        }
        Some(_) => "neither its own columns nor the angles of all joints that lead to it",
    };
    Err(
        Error::invalid("the position of this part of the robot is not known")
            .field(part_name(unknown.unwrap_or_default()))
            .found(found)
            .allowed("x_m, y_m, z_m and qw to qz, of every part or with the angle of every joint")
            .hint("`realgap simulate --parts` writes them"),
    )
}

fn taken(solids: &[ShownSolid]) -> Vec<BodyBox> {
    let boxes = solids.iter().map(|one| BodyBox {
        half_m: one.shape.half_extents_m(),
        body_from_box: one.pose,
        colour: one.colour,
        planes: planes(&one.shape),
    });
    boxes.collect()
}

/// The planes that cut a shape out of its bounding box.
fn planes(shape: &Shape) -> Arc<[Plane]> {
    let surface = shape.surface().filter(|_| !shape.is_box());
    let planes = surface.iter().flat_map(|surface| {
        let faces = surface.faces.iter().zip(&surface.normals);
        faces.map(|(face, normal)| Plane {
            normal: (*normal).into(),
            level_m: normal.dot(&surface.corners_m[face.corners[0]]),
        })
    });
    planes.collect()
}
