//! The RON form of a study, and how it is read.

mod unused;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use crate::calibration::answer::values::assignments;
use crate::calibration::recording::identity::{in_sample, seen_by_fit};
use crate::calibration::study::robot_file::{RobotFile, members, morphology_source};
use crate::calibration::study::scene_file::BodyFile;
use crate::calibration::study::scored_columns;
use crate::calibration::study::simulator_file::SimulatorFile;
use crate::calibration::{
    BaseRule, BasisRule, Commands, Definition, Each, Horizon, Overrides, OwnSimulator, ScoreRule,
    ScoredColumns, StartRule, WindowRule, recording,
};
use realgap_core::file::{Source, name_of_file, parse_ron, sha256, unique_keys};
use realgap_core::{Error, Result};
use realgap_identification::StartState;
use realgap_optimization::{Grid, MAX_POINTS, Range};
use realgap_path::comparison::{self, Channels, Components};
use realgap_path::trajectory::{Alignment, Reading};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, Parameter, ParameterSet, by_name};
use realgap_simulation::{Noise, Vehicle, read_arena};

/// A study file as written.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Study")]
pub struct StudyFile {
    /// The question that the study answers, for readers.
    #[serde(default)]
    description: String,
    /// The robot's file, relative to this one; either this or `vehicle`.
    morphology: Option<PathBuf>,
    /// A two-wheel robot in place of a morphology.
    vehicle: Option<VehicleFile>,
    /// Somebody else's simulator in place of a robot.
    simulator: Option<SimulatorFile>,
    /// Many robots in place of one: they share what is varied.
    #[serde(default)]
    robots: Vec<RobotFile>,
    /// Only recordings of this condition, where a file holds several.
    condition: Option<String>,
    /// Paths and patterns (`*`, `?`) of the recordings, relative to this file.
    #[serde(default)]
    recordings: Vec<String>,
    /// How the recordings are to be read: units, columns, crop.
    #[serde(default)]
    reading: Reading,
    /// Where simulated robots start.
    start: StartRule,
    /// How the first velocities are found, where runs start from a recording.
    start_state: Option<StartState>,
    /// What holds the root of the robot; `Recorded` leads it along the recorded pose (`x_m` to `qz` beside the joints), with
    /// `start: FromRecording` and the metric `joints`.
    #[serde(default)]
    base: BaseRule,
    /// Leave out recordings in which something still moves at the end.
    #[serde(default)]
    only_at_rest: bool,
    /// Bodies beside the robot.
    #[serde(default)]
    scene: Vec<BodyFile>,
    /// Walls around the robot: of a settled start, where the arena says that robots start; else in the recording's coordinates.
    arena: Option<PathBuf>,
    /// A controller's file, relative to this one: what is simulated reads its sensors and follows its rules, in its arena.
    controller: Option<PathBuf>,
    /// Recorded commands that the servos follow in place of their gaits.
    commands: Option<Commands>,
    /// Joints of the robot that no column gives, and columns that no joint takes, which else are an error; `*` for any letters.
    #[serde(default)]
    left_out: Vec<String>,
    /// `(length_s, every_s)`: runs start again and again from what was recorded, every so often, and last so long.
    horizon: Option<Horizon>,
    /// Which windows of a horizon are simulated; all of them where nothing is stated.
    #[serde(default)]
    windows: WindowRule,
    /// Time of each run, seconds; else as long as the recordings.
    duration_s: Option<f64>,
    /// Timestep, seconds; the same as `set: { "timestep_s": ... }`.
    timestep_s: Option<f64>,
    /// Solver substeps of each timestep; the same as `set: { "solver.substeps": ... }`.
    substeps: Option<usize>,
    /// Kind of joint; the same as `set: { "solver.joint": ... }`.
    joint: Option<Joint>,
    /// Whether anything touches the robot; `false` is faster and for robots that are held, e.g. an arm or a leg on a stand. The same
    /// as `set: { "contact.on": ... }`.
    contacts: Option<bool>,
    /// Parameters with a fixed value, by name; `realgap study parameters` lists all.
    #[serde(default, deserialize_with = "unique_keys")]
    set: BTreeMap<String, f64>,
    /// What is varied.
    parameters: Vec<RangeFile>,
    /// How two trajectories are compared; `realgap compare --help` lists the metrics.
    #[serde(default = "default_metric")]
    metric: String,
    /// Recorded columns that are scored, each in standard deviations of its noise, in place of the joints' angles alone; with the
    /// metric `joints`. Columns that no entry names are not compared.
    #[serde(default)]
    channels: Vec<ScoredColumns>,
    /// Which direction of a path is turned onto +x before paths are compared. On a slope, between walls or beside other bodies
    /// directions matter: `World`.
    #[serde(default)]
    align: Alignment,
    /// What the principal components of the metric `pca` are fitted on.
    basis: Option<BasisFile>,
    /// How many principal components are kept.
    #[serde(default)]
    components: Components,
    /// Over what the score of a point is the mean.
    #[serde(default)]
    score: ScoreRule,
    /// Seed of everything random.
    #[serde(default = "default_seed")]
    seed: u64,
    /// Known truth of a stand-in, by parameter, for marking it in pictures; never used by the fit.
    #[serde(default, deserialize_with = "unique_keys")]
    truth: BTreeMap<String, f64>,
    /// How repeats of the real experiment differ.
    noise: Option<Noise>,
}

/// A two-wheel robot in place of a morphology.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Vehicle")]
struct VehicleFile {
    /// The vehicle's file, relative to this one.
    file: PathBuf,
    /// Its range sensor in place of the one in the vehicle's file: a file or the name of one that comes with the program.
    sensor: Option<String>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Joint {
    /// Reduced coordinates: hinges cannot come apart.
    Multibody,
    /// A constraint between two bodies.
    Impulse,
}

#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum BasisFile {
    /// Recordings and simulations together.
    Everything,
    /// The recordings alone.
    Recordings,
    /// The `basis.json` of another results folder, so that scores can be compared.
    File(PathBuf),
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Range")]
struct RangeFile {
    /// Name of the parameter; `realgap study parameters` lists all.
    name: String,
    /// Lowest value, in the parameter's unit; may be left out for a parameter of the study's own simulator, which declares a range.
    from: Option<f64>,
    /// Highest value; as `from`.
    to: Option<f64>,
    /// Points of the grid from the lowest to the highest.
    #[serde(default = "default_points")]
    points: usize,
    /// What is known beforehand, e.g. from a data sheet: median and standard deviation, in the parameter's unit. For least squares
    /// (`--optimizer gauss-newton`).
    prior: Option<(f64, f64)>,
    /// Whether every run has a value of its own.
    #[serde(default)]
    each: Each,
}

impl RangeFile {
    /// The ends of the range: those that the study states, or those that its own simulator declares.
    fn ends(&self, own: Option<&OwnSimulator>) -> Result<(f64, f64)> {
        let declared = own.and_then(|own| own.declaration(&self.name));
        let from = self.from.or(declared.map(|declared| declared.from));
        let to = self.to.or(declared.map(|declared| declared.to));
        // The range of a simulator that was not asked is not known; nothing is simulated in it.
        let unknown = own.filter(|own| own.guest().is_none()).map(|_| (0.0, 1.0));
        from.zip(to).or(unknown).ok_or_else(|| {
            Error::invalid("a parameter without a range")
                .field("from")
                .allowed("from: ..., to: ...")
                .hint("state both ends of the range")
        })
    }
}

/// Prior knowledge, a median and a standard deviation, in coordinates from 0 to 1 along the range: median and variance.
pub(super) fn prior_of(prior: Option<(f64, f64)>, range: &Range) -> Result<Option<(f64, f64)>> {
    let Some((median, sd)) = prior else {
        return Ok(None);
    };
    let is_within = (range.from..=range.to).contains(&median);
    let is_spread = sd > 0.0 && sd.is_finite();
    if !is_within || !is_spread {
        return Err(Error::invalid("no prior knowledge of this parameter")
            .field("prior")
            .found(format!("({median}, {sd})"))
            .allowed("(median, spread): a median within the range, a spread above 0"));
    }
    let at = range.coordinate(median);
    // Along a logarithmic range a standard deviation is a share of the median.
    let near = 1e-3 * (range.to - range.from);
    let there = if median + near <= range.to {
        median + near
    } else {
        median - near
    };
    let slope = (range.coordinate(there) - at).abs() / near;
    Ok(Some((at, (slope * sd).powi(2))))
}

fn default_metric() -> String {
    comparison::DEFAULT_METRIC.to_owned()
}

fn default_seed() -> u64 {
    1
}

/// 21 × 21 = 441, as in paper 003, section 2.3.
fn default_points() -> usize {
    21
}

impl Definition {
    /// Reads a study, its morphology and its recordings.
    ///
    /// # Errors
    /// Any of the files missing or malformed, unknown parameters or metrics, empty ranges, no recordings.
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        Self::parse(&Source::read(path, "study")?, overrides)
    }

    /// As [`Definition::read`], from a text. Paths in the text are relative to the folder of the source's path.
    ///
    /// # Errors
    /// As [`Definition::read`].
    pub fn parse(source: &Source, overrides: &Overrides) -> Result<Self> {
        let definition = Self::parse_without_recordings(source, overrides)?;
        definition.find_recordings(source.path(), overrides)
    }

    /// A definition that was read without recordings from a file, with them; a simulator that was asked is not asked again.
    ///
    /// # Errors
    /// As [`Definition::read`], of the recordings.
    pub fn find_recordings(self, path: &Path, overrides: &Overrides) -> Result<Self> {
        let definition = self;
        if definition.robots.is_empty() {
            return definition.with_found(path, overrides);
        }
        if !overrides.recordings.is_empty() {
            return Err(
                Error::usage("every robot of this study has its own recordings")
                    .field("recordings")
                    .hint("change them in the study, or name a study of one robot")
                    .at_file(path),
            );
        }
        let mut whole = definition.clone();
        for (index, member) in definition.robots.iter().enumerate() {
            let own = definition.of_member(member).with_found(path, overrides)?;
            let from = whole.recordings.len();
            whole.recordings.extend(own.recordings);
            whole.recordings_sha256.extend(own.recordings_sha256);
            whole.warnings.extend(own.warnings);
            if let Some(seen) = own.seen_by_fit {
                *whole.seen_by_fit.get_or_insert(0) += seen;
            }
            whole.robots[index].recordings = from..whole.recordings.len();
        }
        Ok(whole)
    }

    /// The definition with the recordings that its globs name.
    fn with_found(self, path: &Path, overrides: &Overrides) -> Result<Self> {
        let definition = self;
        let mut found = recording::find(&definition, path, overrides)?;
        let moving = if definition.only_at_rest {
            found.keep_those_at_rest().map_err(|e| e.at_file(path))?
        } else {
            None
        };
        // Windows of a recording are too short to show the noise of a sensor.
        let has_own = definition.own_simulator.is_some();
        let channels = scored_columns::channels(&definition.scored, &found.recordings, has_own)
            .map_err(|e| e.at_file(path))?;
        let mut left_out = None;
        if let Some(horizon) = definition.horizon {
            left_out = found
                .cut_into(horizon, &definition.windows)
                .map_err(|e| e.at_file(path))?;
        }
        let robot = match definition.own_simulator {
            Some(_) => None,
            None => Some(&definition.morphology),
        };
        let mut warnings = recording::warnings_for(robot, &found.recordings, definition.base);
        warnings.extend(moving.into_iter().chain(left_out));
        warnings.extend(robot.and_then(|robot| {
            let commands = definition.commands.as_ref();
            let names = &definition.left_out;
            recording::joints::left_out_in_vain(robot, &found.recordings, commands, names)
        }));
        let seen_by_fit = seen_by_fit(&found.recordings, &overrides.fitted_on);
        warnings.extend(in_sample(&found.recordings, seen_by_fit));
        let whole = Self {
            warnings,
            seen_by_fit,
            channels,
            recordings: found.recordings,
            recordings_sha256: found.sha256,
            ..definition
        };
        whole.with_runs().map_err(|e| e.at_file(path))
    }

    /// Reads a study and its morphology but not its recordings, to check the file itself.
    ///
    /// # Errors
    /// As [`Definition::read`], except for those about recordings.
    pub fn read_without_recordings(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        Self::parse_without_recordings(&Source::read(path, "study")?, overrides)
    }

    /// As [`Definition::read_without_recordings`], from a text.
    ///
    /// # Errors
    /// As [`Definition::read_without_recordings`].
    pub(crate) fn parse_without_recordings(source: &Source, overrides: &Overrides) -> Result<Self> {
        let path = source.path();
        let file: StudyFile = parse_ron(source)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let own_simulator = file.own_simulator(source, folder, overrides)?;
        let own = own_simulator.as_ref();
        let members = members(&file.robots, source, folder, file.start)?;
        let robot = match members.first() {
            Some(first) if file.is_of_many() => Robot {
                morphology: first.morphology.clone(),
                sha256: first.sha256.clone(),
                vehicle: None,
            },
            _ => file.robot(source, folder, own)?,
        };
        let stated = match own {
            Some(own) => own.adopt(&overrides.set)?,
            None => overrides.set.clone(),
        };
        let set = file.fixed(source, own)?.with_all(&stated);
        let (grid, parameters) = file.varied(source, overrides, own)?;
        let each: Vec<Each> = file.parameters.iter().map(|range| range.each).collect();
        if !file.robots.is_empty() && each.contains(&Each::Run) {
            let error = Error::invalid("parameters of single runs are for studies of one robot")
                .hint("leave `each` out, or make a study of each robot");
            return Err(source.at("parameters", error));
        }
        let priors = file.parameters.iter().zip(grid.ranges()).enumerate();
        let priors = priors
            .map(|(index, (range, on_grid))| {
                let prior = prior_of(range.prior, on_grid);
                prior.map_err(|e| source.at(&format!("parameters[{index}]"), e))
            })
            .collect::<Result<Vec<_>>>()?;
        let of_study = comparison::by_name(&file.metric).map_err(|e| source.at("metric", e))?;
        let metric = overrides.metric.unwrap_or(of_study);
        file.check_used(source, [of_study, metric])?;
        if !file.channels.is_empty() && !metric.needs().joints {
            let error = Error::invalid("channels are compared by the metric `joints` only")
                .found(metric.name())
                .allowed("joints")
                .hint("add `metric: \"joints\"` to the study");
            return Err(source.at("metric", error));
        }
        if !file.channels.is_empty() && !file.robots.is_empty() {
            let error = Error::invalid("a study of many robots scores no channels")
                .hint("make a study of each robot, or leave `channels` out");
            return Err(source.at("channels", error));
        }
        let metric = match file.channels.is_empty() || overrides.metric.is_some() {
            true => metric,
            false => &Channels,
        };
        let basis = match (&overrides.basis, &file.basis) {
            (Some(basis), _) => basis.clone(),
            (None, None | Some(BasisFile::Everything)) => BasisRule::Everything,
            (None, Some(BasisFile::Recordings)) => BasisRule::Recordings,
            (None, Some(BasisFile::File(saved))) => BasisRule::read(folder.join(saved))?,
        };
        let start_state = overrides.start_state.or(file.start_state);
        let start_state = start_state.unwrap_or_default();
        if file.start == StartRule::Settled && start_state != StartState::FirstSample {
            let error = Error::invalid("a settled start has no start state to refine")
                .field("start_state")
                .hint("use `start: FromRecording`");
            return Err(source.at("start", error));
        }
        let mut reading = file.reading.clone();
        let unitless = file.commands.iter().flat_map(Commands::unitless);
        reading.read_without_unit(unitless.chain(file.windows.on.clone()));
        if own_simulator.is_some() {
            reading
                .unitless
                .extend(scored_columns::names_of_their_own(&file.channels));
        }
        let truth = values(&file.truth, own).map_err(|e| source.at("truth", e))?;
        let mut definition = Self {
            path: Some(path.to_path_buf()),
            text: source.text().to_owned(),
            description: file.description,
            morphology_sha256: robot.sha256,
            vehicle: robot.vehicle,
            own_simulator,
            robots: members,
            condition: file.condition,
            start: file.start,
            start_state,
            base: file.base,
            only_at_rest: file.only_at_rest,
            commands: file.commands,
            left_out: file.left_out,
            horizon: file.horizon.filter(|_| !overrides.whole_runs),
            windows: file.windows,
            duration_s: overrides.duration_s.or(file.duration_s),
            reading: overrides.reading.clone().or(&reading),
            set,
            seen_by_fit: None,
            draws: overrides.draws.clone(),
            grid,
            parameters,
            each,
            priors,
            metric,
            scored: file.channels,
            align: file.align,
            score: overrides.score.unwrap_or(file.score),
            basis,
            components: file.components,
            seed: overrides.seed.unwrap_or(file.seed),
            split: overrides.split,
            truth,
            noise: file.noise,
            recording_globs: file.recordings,
            ..Self::of(name_of_file(path, "a study")?, robot.morphology)
        };
        if let Some((field, error)) = definition.fault().or_else(|| {
            file.reading
                .fault()
                .map(|(field, error)| (format!("reading.{field}"), error))
        }) {
            return Err(source.at(&field, error));
        }
        for (index, body) in file.scene.into_iter().enumerate() {
            let body = body.into_body();
            definition
                .scene
                .push(body.map_err(|e| source.at(&format!("scene[{index}]"), e))?);
        }
        if let Some(named) = &file.arena {
            let plan = Source::read(folder.join(named), "arena")?;
            let settled = file.start == StartRule::Settled;
            let (walls, ground) = read_arena(&plan, settled)?;
            definition.scene.extend(walls);
            let mut all = format!("{}\n{}", definition.morphology_sha256, plan.text());
            if let Some(field) = &ground.heights {
                all = format!("{all}\n{}", field.sha256);
            }
            definition.morphology_sha256 = sha256(all.as_bytes());
            definition.ground = ground;
        }
        let own = file.robots.iter().map(|robot| robot.controller.as_deref());
        definition
            .steer(source, file.controller.as_deref(), &own.collect::<Vec<_>>())
            .map(|()| definition)
    }
}

/// The robot that a study names.
struct Robot {
    morphology: Morphology,
    sha256: String,
    vehicle: Option<Arc<Vehicle>>,
}

impl StudyFile {
    /// Whether the file names several robots and nothing that belongs to a study of one robot.
    fn is_of_many(&self) -> bool {
        let one = self.morphology.is_some() || self.vehicle.is_some();
        !one && self.recordings.is_empty() && !self.robots.is_empty()
    }

    /// The study's own simulator, asked who it is where that is allowed.
    fn own_simulator(
        &self,
        source: &Source,
        folder: &Path,
        overrides: &Overrides,
    ) -> Result<Option<OwnSimulator>> {
        let Some(named) = &self.simulator else {
            return Ok(None);
        };
        let of_robots = [
            ("morphology", self.morphology.is_some()),
            ("vehicle", self.vehicle.is_some()),
            ("robots", !self.robots.is_empty()),
            ("start_state", self.start_state.is_some()),
            ("base", self.base != BaseRule::default()),
            ("scene", !self.scene.is_empty()),
            ("arena", self.arena.is_some()),
            ("controller", self.controller.is_some()),
            ("commands", self.commands.is_some()),
            ("left_out", !self.left_out.is_empty()),
            ("timestep_s", self.timestep_s.is_some()),
            ("substeps", self.substeps.is_some()),
            ("joint", self.joint.is_some()),
            ("contacts", self.contacts.is_some()),
            (
                "noise",
                self.noise
                    .is_some_and(|noise| !noise.without_camera().is_zero()),
            ),
        ];
        if let Some((field, _)) = of_robots.iter().find(|(_, is_stated)| *is_stated) {
            let error = Error::invalid(
                "this is for robots of realgap, and the study names its own simulator",
            )
            .field(*field)
            .hint("leave it out; the simulator declares what may be set (docs/simulator.md)");
            return Err(source.at(field, error));
        }
        let ranges = self.parameters.iter().map(|range| range.name.as_str());
        let stated = self.set.keys().map(String::as_str);
        let over = overrides.set.iter().map(|value| value.parameter.name);
        let varied: Vec<&str> = ranges.chain(stated).chain(over).collect();
        let own = named
            .command(folder, &varied)
            .and_then(|command| OwnSimulator::of_command(command, overrides.command));
        own.map(Some).map_err(|e| match e.kind() {
            realgap_core::ErrorKind::Usage => e.at_file(source.path()),
            _ => source.at("simulator", e),
        })
    }

    fn robot(&self, source: &Source, folder: &Path, own: Option<&OwnSimulator>) -> Result<Robot> {
        if let Some(own) = own {
            return Ok(Robot {
                morphology: own.outside()?,
                sha256: own
                    .command()
                    .map_or_else(String::new, |c| sha256(c.identity())),
                vehicle: None,
            });
        }
        match (&self.morphology, &self.vehicle) {
            (Some(named), None) if self.robots.is_empty() => {
                let robot = morphology_source(source, &folder.join(named))?;
                Ok(Robot {
                    morphology: Morphology::parse(&robot)?,
                    sha256: robot.sha256(),
                    vehicle: None,
                })
            }
            (None, Some(named)) if self.robots.is_empty() => {
                let vehicle = Vehicle::read(folder.join(&named.file), named.sensor.as_deref())?;
                Ok(Robot {
                    morphology: outside_of(&vehicle)?,
                    sha256: sha256(vehicle.text.as_bytes()),
                    vehicle: Some(Arc::new(vehicle)),
                })
            }
            _ => Err(Error::invalid("a study is of one robot, or of many with their own recordings each")
                .at_file(source.path())
                .allowed("`morphology: \"...\"`, `vehicle: (file: \"...\")`, `simulator: Command([...])`, or `robots: [(morphology: ..., recordings: [...])]` alone")
                .hint("add `morphology: ...`")),
        }
    }

    /// The values that the file fixes.
    fn fixed(&self, source: &Source, own: Option<&OwnSimulator>) -> Result<ParameterSet> {
        let multibody = self.joint.map(|joint| matches!(joint, Joint::Multibody));
        let named = [
            ("timestep_s", self.timestep_s),
            ("solver.substeps", self.substeps.map(|n| n as f64)),
            ("solver.joint", multibody.map(|is| f64::from(u8::from(is)))),
            (
                "contact.on",
                self.contacts.map(|is| f64::from(u8::from(is))),
            ),
        ];
        let mut set = ParameterSet::new();
        for (name, value) in named {
            if let Some(value) = value {
                let field = name.trim_start_matches("solver.");
                set = set.with(Assignment::new(name, value).map_err(|e| source.at(field, e))?);
            }
        }
        let more = values(&self.set, own).map_err(|e| source.at("set", e))?;
        Ok(set.with_all(&more))
    }

    /// The varied parameters, as a grid and as a list.
    fn varied(
        &self,
        source: &Source,
        overrides: &Overrides,
        own: Option<&OwnSimulator>,
    ) -> Result<(Grid, Vec<&'static Parameter>)> {
        let (mut ranges, mut parameters) = (Vec::new(), Vec::new());
        for (index, range) in self.parameters.iter().enumerate() {
            let points = overrides.points.unwrap_or(range.points);
            let parameter = match own {
                Some(own) => own.parameter(&range.name),
                None => by_name(&range.name),
            };
            let checked = parameter
                .and_then(|p| {
                    let (from, to) = range.ends(own)?;
                    Ok((p, Range::new(p, from, to, points)?))
                })
                .map_err(|e| match overrides.points {
                    Some(points) if !(2..=MAX_POINTS).contains(&points) => {
                        e.field("points").into_usage()
                    }
                    _ => source.at(&format!("parameters[{index}]"), e),
                })?;
            parameters.push(checked.0);
            ranges.push(checked.1);
        }
        let grid = Grid::new(ranges).map_err(|e| source.at("parameters", e))?;
        Ok((grid, parameters))
    }
}

/// A cube with the size and the name of a vehicle: the morphology from which body lengths are computed.
fn outside_of(vehicle: &Vehicle) -> Result<Morphology> {
    outside(&vehicle.name, 2.0 * vehicle.radius_m)
}

/// A cube with this name and size.
pub(super) fn outside(name: &str, side_m: f64) -> Result<Morphology> {
    let text = format!(
        "(name: {name:?}, defaults: (side_m: {side_m}, mass_kg: 0.3), modules: [(name: \"body\", kind: Passive())], glue: [])"
    );
    Morphology::parse(&Source::new("vehicle", text))
}

/// Values by the names of parameters, which are those of the study's own simulator where it has one.
fn values(named: &BTreeMap<String, f64>, own: Option<&OwnSimulator>) -> Result<ParameterSet> {
    let Some(own) = own else {
        return assignments(named);
    };
    named
        .iter()
        .map(|(name, value)| own.assignment(name, *value))
        .collect()
}
