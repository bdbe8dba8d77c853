//! A robot in motion, its recorded runs over it: one page.

use nalgebra::{Isometry3, UnitQuaternion};
use serde_json::{Value, json};

use super::block::Block;
use super::chart::{Chart, Line};
use super::page::{Page, fill, html, script_json};
use super::track::{CURVE, distances, laid_onto, mean, spread};
use crate::error::Result;
use crate::robot::morphology::{DriveAxis, Morphology, Role};
use crate::simulation::{Film, Floor, SceneBody, SceneMotion, part_from_solid};
use crate::trajectory::{Recording, Source, Trajectory};
use crate::unit::{Unit, counted, decimals, quantity};
use crate::warning::Warning;

/// Steps that numbers in the page are rounded to; also said on the page.
const LENGTH_STEP_M: f64 = 2e-5;
const TURN_STEP: f64 = 1e-4;
const TIME_STEP_S: f64 = 1e-4;
/// Most numbers of one run in the page; a longer run shows every second, third, … sample.
const MOST_NUMBERS: usize = 240_000;

const STYLE: &str = include_str!("page/style.css");
const BLOCK: &str = include_str!("page/block.js");
const THREE: &str = include_str!("page/three.min.js");
const SCENE: &str = include_str!("page/scene.js");
const REPLAY: &str = include_str!("page/replay.js");

/// What a run that was simulated for its page is called.
pub const SIMULATION: &str = "simulation";

/// What a replay shows.
#[derive(Debug, Clone)]
pub struct Replay<'a> {
    /// The robot; without one a moving point is shown.
    pub robot: Option<&'a Morphology>,
    /// The run.
    pub run: &'a Film,
    /// What the run is called: [`SIMULATION`], or the name of its file.
    pub run_name: &'a str,
    /// Recorded runs to be shown over it.
    pub recordings: &'a [Recording],
    /// Whether recordings are moved and turned onto the run's start and direction, as they are for comparison. Otherwise
    /// both are in one frame.
    pub align: bool,
    /// The ground.
    pub floor: Floor,
    /// Other bodies; those that stand still are shown.
    pub scene: &'a [SceneBody],
    /// What the reader should know.
    pub warnings: &'a [Warning],
    /// Versions, settings, hashes, the command: name and value.
    pub provenance: &'a [(String, String)],
}

/// A recorded run as it is shown.
struct Ghost<'a> {
    name: &'a str,
    film: Film,
    /// Distance to the run, over time.
    apart: Vec<[f64; 2]>,
}

impl Replay<'_> {
    /// The page: one HTML file.
    ///
    /// # Errors
    /// Paths too long to be compared.
    pub fn page(&self) -> Result<String> {
        let ghosts = self.ghosts()?;
        let tracks: Vec<&Trajectory> = ghosts.iter().map(|ghost| &ghost.film.track).collect();
        let noise = spread(&tracks);
        let mut block = Block::default();
        let films = || std::iter::once(self.run).chain(ghosts.iter().map(|ghost| &ghost.film));
        let mut kept = Vec::new();
        for film in films() {
            kept.push(push_film(&mut block, film));
        }
        let scene = self.scene_json(&ghosts);
        let title = match self.robot {
            Some(robot) => format!("{}: replay", robot.name()),
            None => format!("{}: replay", self.run_name),
        };
        let body = self.body(&ghosts, &noise, &kept);
        let page = Page {
            title: &title,
            styles: &[STYLE],
            body: &body,
            data: &[("scene", script_json(&scene)), ("motion", block.text())],
            scripts: &[THREE, BLOCK, SCENE, REPLAY],
        };
        Ok(page.text())
    }

    fn ghosts(&self) -> Result<Vec<Ghost<'_>>> {
        let assembly = self.robot.map(Morphology::assemble);
        self.recordings
            .iter()
            .map(|recording| {
                let film = match &assembly {
                    Some(assembly) => Film::of_recording(assembly, recording),
                    None => Film {
                        track: recording.trajectory.clone(),
                        parts: Vec::new(),
                    },
                };
                let film = if self.align {
                    laid_onto(&film, &self.run.track)?
                } else {
                    film
                };
                Ok(Ghost {
                    name: &recording.name,
                    apart: distances(&self.run.track, &film.track),
                    film,
                })
            })
            .collect()
    }

    fn reality(&self) -> &'static str {
        Source::of(self.recordings).reality_label()
    }

    fn scene_json(&self, ghosts: &[Ghost<'_>]) -> Value {
        let track = |name: &str, film: &Film, is_recorded: bool| {
            let known = (0..film.parts.len()).filter(|part| film.parts[*part].is_some());
            json!({
                "name": name,
                "recorded": is_recorded,
                "parts": known.collect::<Vec<_>>(),
            })
        };
        let mut tracks = vec![track(self.run_name, self.run, false)];
        tracks.extend(
            ghosts
                .iter()
                .map(|ghost| track(ghost.name, &ghost.film, true)),
        );
        json!({
            "steps": [TIME_STEP_S, LENGTH_STEP_M, TURN_STEP],
            "tracks": tracks,
            "boxes": self.robot.map(boxes).unwrap_or_default(),
            "floor": { "height_m": self.floor.height_m, "slope_rad": self.floor.slope_rad },
            "scene": self.scene.iter().flat_map(fixed_boxes).collect::<Vec<_>>(),
        })
    }

    /// The run at the beginning of a sentence.
    fn subject(&self) -> String {
        match self.run_name {
            SIMULATION => "The simulation".to_owned(),
            name => name.to_owned(),
        }
    }

    /// The answer in at most two sentences.
    fn answer(&self, ghosts: &[Ghost<'_>], noise: &[[f64; 3]]) -> String {
        let net_m = self.run.track.net_displacement_world_m().xy().norm();
        let length = |m: f64| quantity(m, Unit::Metre);
        let went = format!(
            "{} goes {} in {} s, along a path of {}.",
            self.subject(),
            length(net_m),
            decimals(self.run.track.duration_s(), 1),
            length(self.run.track.path_length_xy_m()),
        );
        if ghosts.is_empty() {
            return html(&went);
        }
        let means = ghosts.iter().map(|ghost| mean(&ghost.apart));
        let apart_m = means.sum::<f64>() / ghosts.len() as f64;
        let mut text = format!(
            "{went} At equal times it is {} from {} ({}), on average over time",
            length(apart_m),
            match Source::of(self.recordings) {
                Source::Real => "reality",
                Source::StandIn => "the stand-in for reality",
            },
            counted(ghosts.len(), "run"),
        );
        if !noise.is_empty() {
            let low = noise
                .iter()
                .map(|[t, low, _]| [*t, *low])
                .collect::<Vec<_>>();
            let high = noise
                .iter()
                .map(|[t, _, high]| [*t, *high])
                .collect::<Vec<_>>();
            text += &format!(
                "; each of those runs is {} to {} from the mean of the others",
                length(mean(&low)),
                length(mean(&high)),
            );
        }
        html(&(text + "."))
    }

    fn body(&self, ghosts: &[Ghost<'_>], noise: &[[f64; 3]], kept: &[usize]) -> String {
        let name = self.robot.map_or(self.run_name, Morphology::name);
        let stand_in = match Source::of(self.recordings) {
            Source::StandIn => {
                "<p class=\"note\">The recorded runs are stand-ins made by a simulator, not hardware.</p>"
            }
            Source::Real => "",
        };
        let legend = if ghosts.is_empty() {
            String::new()
        } else {
            format!(
                "<span><i class=\"key real\"></i>{}</span>{}",
                html(self.reality()),
                if noise.is_empty() {
                    ""
                } else {
                    "<span><i class=\"key band\"></i>its own spread: each run from the mean of the others</span>"
                },
            )
        };
        let aligned = match (ghosts.is_empty(), self.align) {
            (true, _) => "",
            (false, true) => {
                "Recorded runs are moved to the same start and turned about the vertical so that all go the same way, as for comparison."
            }
            (false, false) => "Recorded and simulated runs are shown in the frame of their files.",
        };
        let thinned = if kept.iter().any(|every| *every > 1) {
            " Of long runs only every few samples are in this page."
        } else {
            ""
        };
        let description = self.robot.map_or("", Morphology::description);
        let values = [
            ("name", html(name)),
            ("answer", self.answer(ghosts, noise)),
            ("description", html(description)),
            ("run", html(self.run_name)),
            ("legend", legend),
            ("stand_in", stand_in.to_owned()),
            ("aligned", aligned.to_owned()),
            ("thinned", thinned.to_owned()),
            ("charts", self.charts(ghosts, noise)),
            ("table", self.table(ghosts)),
            ("warnings", warning_list(self.warnings)),
            ("provenance", definition_list(self.provenance)),
        ];
        fill(include_str!("page/replay.html"), &values)
    }

    fn charts(&self, ghosts: &[Ghost<'_>], noise: &[[f64; 3]]) -> String {
        let xy = |track: &Trajectory| {
            let positions = track.positions_world_m();
            let every = positions.len().div_ceil(4 * CURVE).max(1);
            let ends = positions.iter().step_by(every).chain(positions.last());
            ends.map(|p| [p.x, p.y]).collect::<Vec<_>>()
        };
        let real = |points| Line {
            class: "real",
            points,
        };
        let sim = |points| Line {
            class: "sim",
            points,
        };
        let mut paths: Vec<Line> = ghosts
            .iter()
            .map(|ghost| real(xy(&ghost.film.track)))
            .collect();
        paths.push(sim(xy(&self.run.track)));
        let map = Chart {
            alt: "The paths seen from above".to_owned(),
            x_label: "x [m]".to_owned(),
            y_label: "y [m]".to_owned(),
            is_map: true,
            lines: paths,
            ..Chart::default()
        };
        let over_time = if ghosts.is_empty() {
            let start = self.run.track.positions_world_m()[0];
            let first_s = self.run.track.times_s()[0];
            let samples = self
                .run
                .track
                .times_s()
                .iter()
                .zip(self.run.track.positions_world_m());
            let points = samples.map(|(t, p)| [t - first_s, (p - start).xy().norm()]);
            Chart {
                alt: "Distance from the start over time".to_owned(),
                y_label: "distance from the start [m]".to_owned(),
                lines: vec![sim(points.collect())],
                ..Chart::default()
            }
        } else {
            Chart {
                alt: "Distance between the run and each recorded run over time".to_owned(),
                y_label: "distance to recorded [m]".to_owned(),
                band: noise.to_vec(),
                lines: ghosts
                    .iter()
                    .map(|ghost| sim(ghost.apart.clone()))
                    .collect(),
                ..Chart::default()
            }
        };
        let over_time = Chart {
            x_label: "time [s]".to_owned(),
            ..over_time
        };
        let caption = if ghosts.is_empty() {
            "How far the tracked module is from where it started."
        } else {
            "How far the run is from each recorded run at the same time. Inside the band it is no farther than recorded runs are from each other."
        };
        format!(
            "<figure><h2>Distance over time</h2>{}<figcaption>{caption} Click or drag to move in time.</figcaption></figure>\
             <figure><h2>Paths from above</h2>{}<figcaption>The tracked module's path; one scale for both axes.</figcaption></figure>",
            over_time.svg(),
            map.svg(),
        )
    }

    fn table(&self, ghosts: &[Ghost<'_>]) -> String {
        let net = |track: &Trajectory| {
            quantity(track.net_displacement_world_m().xy().norm(), Unit::Metre)
        };
        let known = |film: &Film| match film.parts.iter().flatten().count() {
            0 => "path only".to_owned(),
            count if count == film.parts.len() => "all parts".to_owned(),
            count => format!("{count} of {}", counted(film.parts.len(), "part")),
        };
        let mut rows = format!(
            "<tr class=\"sim\"><th scope=\"row\">{}</th><td>{} s</td><td>{}</td><td>{}</td><td>–</td><td>–</td><td>–</td></tr>",
            html(self.run_name),
            decimals(self.run.track.duration_s(), 2),
            known(self.run),
            net(&self.run.track),
        );
        for ghost in ghosts {
            let length = |m: f64| quantity(m, Unit::Metre);
            let farthest = ghost
                .apart
                .iter()
                .copied()
                .reduce(|a, b| if b[1] > a[1] { b } else { a });
            let [at_s, most_m] = farthest.unwrap_or_default();
            let end_m = ghost.apart.last().map_or(0.0, |[_, m]| *m);
            rows += &format!(
                "<tr><th scope=\"row\">{}</th><td>{} s</td><td>{}</td><td>{}</td><td>{}</td><td>{} at {} s</td><td>{}</td></tr>",
                html(ghost.name),
                decimals(ghost.film.track.duration_s(), 2),
                known(&ghost.film),
                net(&ghost.film.track),
                length(mean(&ghost.apart)),
                length(most_m),
                decimals(at_s, 1),
                length(end_m),
            );
        }
        rows
    }
}

/// Warnings as a list.
fn warning_list(warnings: &[Warning]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let item = |warning: &Warning| {
        format!(
            "<li><code>{}</code> {}</li>",
            html(warning.code.name()),
            html(&warning.message)
        )
    };
    let items: String = warnings.iter().map(item).collect();
    format!("<section id=\"warnings\"><h2>Warnings</h2><ul>{items}</ul></section>")
}

/// Names and values.
fn definition_list(pairs: &[(String, String)]) -> String {
    let item = |(name, value): &(String, String)| {
        format!("<dt>{}</dt><dd>{}</dd>", html(name), html(value))
    };
    pairs.iter().map(item).collect()
}

/// A pose as seven numbers: place, then orientation with its real part first.
fn pose_json(pose: &Isometry3<f64>) -> Value {
    let (t, q) = (pose.translation.vector, pose.rotation);
    json!([t.x, t.y, t.z, q.w, q.i, q.j, q.k])
}

/// The boxes of a robot in the frames of their parts.
fn boxes(robot: &Morphology) -> Vec<Value> {
    let assembly = robot.assemble();
    let mut all = Vec::new();
    for (part, cluster) in assembly.parts.iter().enumerate() {
        // A plate with a module glued onto it is inside of that module.
        for solid in cluster.solids.iter().filter(|solid| solid.collides) {
            let module = &robot.modules()[solid.module];
            let drive = module
                .drive
                .filter(|_| solid.number == 0 && solid.role == Role::Cube);
            all.push(json!({
                "part": part,
                "half": solid.half_extents_m.as_slice(),
                "pose": pose_json(&part_from_solid(&assembly, part, solid)),
                "name": if solid.number == 0 && solid.role == Role::Cube { module.name.as_str() } else { "" },
                "kind": match (solid.role, drive.is_some()) {
                    (Role::Plate, _) => "plate",
                    (Role::Cube, true) => "active",
                    (Role::Cube, false) => "passive",
                },
                "tracked": solid.module == robot.track() && solid.role == Role::Cube,
                "normal": drive.map(|drive| drive.face.normal().as_slice().to_vec()),
                "spins": drive.map(|drive| matches!(drive.axis, DriveAxis::Normal { .. })),
            }));
        }
    }
    all
}

/// The boxes of a body that stands still, in the world.
fn fixed_boxes(body: &SceneBody) -> Vec<Value> {
    let SceneMotion::Fixed { world_from_body } = &body.motion else {
        return Vec::new();
    };
    let boxes = body.boxes.iter();
    boxes
        .map(|one| {
            let half = 0.5 * one.sides_m;
            json!({ "half": half.as_slice(), "pose": pose_json(&(world_from_body * one.body_from_box)) })
        })
        .collect()
}

/// Adds a film's columns: times, the tracked point, then of each known part its place and orientation. Returns every how
/// manyth sample is in there.
fn push_film(block: &mut Block, film: &Film) -> usize {
    let samples = film.track.len();
    let known: Vec<_> = film.parts.iter().flatten().collect();
    let columns = 4 + 7 * known.len();
    let every = (samples * columns).div_ceil(MOST_NUMBERS).max(1);
    let mut picks: Vec<usize> = (0..samples).step_by(every).collect();
    if picks.last() != Some(&(samples - 1)) {
        picks.push(samples - 1);
    }
    let (times_s, places) = (film.track.times_s(), film.track.positions_world_m());
    block.push(picks.iter().map(|k| times_s[*k] - times_s[0]), TIME_STEP_S);
    let place = |sample: usize, axis: usize| places[sample][axis];
    for axis in 0..3 {
        block.push(picks.iter().map(|k| place(*k, axis)), LENGTH_STEP_M);
    }
    for poses in known {
        for axis in 0..3 {
            block.push(
                picks.iter().map(|k| poses[*k].translation.vector[axis]),
                LENGTH_STEP_M,
            );
        }
        let turns = continuous(picks.iter().map(|k| poses[*k].rotation));
        for axis in 0..4 {
            block.push(turns.iter().map(|turn| turn[axis]), TURN_STEP);
        }
    }
    every
}

/// Orientations, real part first, each with the sign that is nearer to the one before: both signs are the same turn.
fn continuous(turns: impl Iterator<Item = UnitQuaternion<f64>>) -> Vec<[f64; 4]> {
    let mut all: Vec<[f64; 4]> = Vec::new();
    for turn in turns {
        let mut next = [turn.w, turn.i, turn.j, turn.k];
        if let Some(last) = all.last() {
            let dot: f64 = last.iter().zip(&next).map(|(a, b)| a * b).sum();
            if dot < 0.0 {
                next = next.map(|value| -value);
            }
        }
        all.push(next);
    }
    all
}
