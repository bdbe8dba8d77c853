//! The page of a replay: a robot in motion, with its recorded runs over it.

use crate::plot::{
    AxisSpec, Caption, Inline, InlineChart, LinePlot, ScoreScale, Series, SeriesKind,
};
use crate::report::document::packed::PackedColumns;
use crate::report::document::page::{
    BAR, BLOCK, CHART, CLOCK, Page, REPLAY, SCENE, STYLE, THREE, fill, html, script_json,
};
use crate::report::document::section::{body, warning_section};
use crate::report::document::value::{entries, pairs_of};
use crate::report::folder::page_data::ReplayData;
use crate::report::replay::motion::{ShownScene, push_film};
use crate::report::replay::stage::Stage;
use crate::report::replay::track::{CURVE, distances, laid_onto, mean, spread};
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted, decimals, quantity};
use realgap_core::warning::Warning;
use realgap_path::trajectory::{Recording, Source, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Film, Floor, SceneBody};

/// Most numbers of one run in the page; a longer run shows every second, third, … sample.
const MOST_NUMBERS: usize = 240_000;
/// The same where the replay is a part of a larger page.
const FEWER_NUMBERS: usize = 40_000;

const ALONE: &str = include_str!("../document/asset/alone.js");

/// The name of a run that was simulated for its page.
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
    /// Other bodies; a moving body is shown where the run has its poses.
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
    /// Distance to the run over time: seconds, metres.
    distances: Vec<[f64; 2]>,
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
        let (motion, kept) = self.motion(&ghosts, MOST_NUMBERS);
        let scene = self.scene_shown(&ghosts);
        let title = match self.robot {
            Some(robot) => format!("{}: replay", robot.name()),
            None => format!("{}: replay", self.run_name),
        };
        let body = self.body(&ghosts, &noise, &kept);
        let page = Page {
            title: &title,
            styles: &[STYLE],
            body: &body,
            data: &[("scene-data", script_json(&scene)), ("motion-data", motion)],
            scripts: &[THREE, BLOCK, CLOCK, CHART, SCENE, REPLAY, ALONE],
            renewed_every_s: None,
        };
        Ok(page.text())
    }

    /// The replay as the page of a results folder shows it, with fewer samples than a page of its own.
    ///
    /// # Errors
    /// Paths too long to be compared.
    pub fn data(&self) -> Result<ReplayData> {
        let ghosts = self.ghosts()?;
        Ok(ReplayData {
            scene: self.scene_shown(&ghosts),
            motion: self.motion(&ghosts, FEWER_NUMBERS).0,
        })
    }

    /// All motions, and for each the interval of the samples that are kept: 3 means every third.
    fn motion(&self, ghosts: &[Ghost<'_>], most: usize) -> (String, Vec<usize>) {
        let mut packed = PackedColumns::default();
        let kept = self
            .runs(ghosts)
            .map(|(_, film)| push_film(&mut packed, film, self.scene, most))
            .collect();
        (packed.text(), kept)
    }

    /// The moving bodies of the replay, with at most `most` samples of each run.
    pub(in crate::report) fn stage(&self, most: usize) -> Result<Stage> {
        let ghosts = self.ghosts()?;
        let all = self.runs(&ghosts);
        Ok(Stage::new(self.robot, all, self.floor, self.scene, most))
    }

    /// The run and the recorded ones, with their names.
    fn runs<'a>(&'a self, ghosts: &'a [Ghost<'_>]) -> impl Iterator<Item = (&'a str, &'a Film)> {
        let recorded = ghosts.iter().map(|ghost| (ghost.name, &ghost.film));
        std::iter::once((self.run_name, self.run)).chain(recorded)
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
                        scene: Vec::new(),
                    },
                };
                // A robot that is held stays where it is.
                let film = if self.align && !recording.trajectory.is_of_joints() {
                    laid_onto(&film, &self.run.track)?
                } else {
                    film
                };
                Ok(Ghost {
                    name: &recording.name,
                    distances: distances(&self.run.track, &film.track),
                    film,
                })
            })
            .collect()
    }

    pub(in crate::report) fn reality(&self) -> &'static str {
        Source::of(self.recordings).reality_label()
    }

    fn scene_shown(&self, ghosts: &[Ghost<'_>]) -> ShownScene {
        let runs = self.runs(ghosts);
        ShownScene::new(self.robot, runs, self.run, self.floor, self.scene)
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
        let means = ghosts.iter().map(|ghost| mean(&ghost.distances));
        let mean_m = means.sum::<f64>() / ghosts.len() as f64;
        let mut text = format!(
            "{went} At equal times it is {} from {} ({}), on average over time",
            length(mean_m),
            match Source::of(self.recordings) {
                Source::Real => "reality",
                Source::StandIn => "the stand-in for reality",
            },
            counted(ghosts.len(), "run"),
        );
        if !noise.is_empty() {
            let (low, high): (Vec<_>, Vec<_>) = (noise.iter())
                .map(|[t, low, high]| ([*t, *low], [*t, *high]))
                .unzip();
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
            let spread = match noise.is_empty() {
                true => String::new(),
                false => key(
                    "band",
                    "its own spread: each run from the mean of the others",
                ),
            };
            key("real", self.reality()) + &spread
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
            ("stage", stage_of(self.run_name, &legend)),
            ("bar", BAR.to_owned()),
            ("stand_in", stand_in.to_owned()),
            ("aligned", aligned.to_owned()),
            ("thinned", thinned.to_owned()),
            ("charts", self.charts(ghosts, noise)),
            ("table", self.table(ghosts)),
            ("warnings", warning_list(self.warnings)),
            ("provenance", entries(pairs_of(self.provenance))),
        ];
        fill(include_str!("../document/asset/replay.html"), &values)
    }

    fn charts(&self, ghosts: &[Ghost<'_>], noise: &[[f64; 3]]) -> String {
        let xy = |track: &Trajectory| {
            let positions = track.positions_world_m();
            let every = positions.len().div_ceil(4 * CURVE).max(1);
            let ends = positions.iter().step_by(every).chain(positions.last());
            ends.map(|p| (p.x, p.y)).collect::<Vec<_>>()
        };
        let line = |points: Vec<(f64, f64)>| Series::new("", SeriesKind::Line, points);
        let recorded = ghosts.iter();
        let recorded = recorded.map(|ghost| line(xy(&ghost.film.track)).recorded());
        let paths = recorded.chain([line(xy(&self.run.track))]).collect();
        let x = AxisSpec::new("x", Unit::Metre);
        let map = LinePlot {
            scale: ScoreScale::LikeX,
            ..LinePlot::new(Caption::default(), x, ("y", Unit::Metre), paths)
        };
        let (alt, label, series, caption) = if ghosts.is_empty() {
            let (times_s, places) = (self.run.track.times_s(), self.run.track.positions_world_m());
            let samples = times_s.iter().zip(places);
            let points = samples.map(|(t, p)| (t - times_s[0], (p - places[0]).xy().norm()));
            (
                "Distance from the start over time",
                "distance from the start",
                vec![line(points.collect())],
                "How far the tracked module is from where it started.",
            )
        } else {
            let edge = noise.iter().map(|[t, low, _]| (*t, *low)).collect();
            let high = noise.iter().map(|[_, _, high]| *high).collect();
            let band = Series::new("", SeriesKind::Band(high), edge);
            let pairs = |ghost: &Ghost<'_>| ghost.distances.iter().map(|[t, m]| (*t, *m)).collect();
            let lines = ghosts.iter().map(|ghost| line(pairs(ghost)));
            (
                "Distance between the run and each recorded run over time",
                "distance",
                std::iter::once(band).chain(lines).collect(),
                "How far the run is from each recorded run at the same time. Inside the band it is no farther than recorded runs are from each other.",
            )
        };
        let time = AxisSpec::new("time", Unit::Second);
        let over_time = LinePlot::new(Caption::default(), time, (label, Unit::Metre), series);
        format!(
            "<figure><h2>Distance over time</h2>{}<figcaption>{caption} Click or drag to move in time.</figcaption></figure>\
             <figure><h2>Paths from above</h2>{}<figcaption>The tracked module's path; one scale for both axes.</figcaption></figure>",
            over_time.inline(&Inline::new(alt)),
            map.inline(&Inline::new("The paths seen from above")),
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
                .distances
                .iter()
                .copied()
                .reduce(|a, b| if b[1] > a[1] { b } else { a });
            let [at_s, most_m] = farthest.unwrap_or_default();
            let end_m = ghost.distances.last().map_or(0.0, |[_, m]| *m);
            rows += &format!(
                "<tr><th scope=\"row\">{}</th><td>{} s</td><td>{}</td><td>{}</td><td>{}</td><td>{} at {} s</td><td>{}</td></tr>",
                html(ghost.name),
                decimals(ghost.film.track.duration_s(), 2),
                known(&ghost.film),
                net(&ghost.film.track),
                length(mean(&ghost.distances)),
                length(most_m),
                decimals(at_s, 1),
                length(end_m),
            );
        }
        rows
    }
}

/// Warnings as a section; nothing where there are none.
fn warning_list(warnings: &[Warning]) -> String {
    let warnings = warnings.iter();
    let pairs = warnings.map(|warning| (warning.code.name(), warning.message.as_str()));
    body(&[warning_section(pairs)])
}

/// The element that shows a robot in space; `legend` is markup.
fn stage_of(run: &str, legend: &str) -> String {
    let values = [("run", html(run)), ("legend", legend.to_owned())];
    fill(include_str!("../document/asset/stage.html"), &values)
}

/// The element that shows a replay of a results folder in space.
pub(in crate::report) fn stage(scene: &ShownScene) -> String {
    let mut names = scene.tracks.iter().map(|track| track.name.as_str());
    let run = names.next().unwrap_or_default();
    let recorded: Vec<&str> = names.collect();
    let legend = if recorded.is_empty() {
        String::new()
    } else {
        key("real", &format!("recorded: {}", recorded.join(", ")))
    };
    stage_of(run, &legend)
}

/// A name in a legend beside the line or area that it stands for.
fn key(class: &str, name: &str) -> String {
    format!("<span><i class=\"key {class}\"></i>{}</span>", html(name))
}
