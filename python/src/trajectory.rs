//! Motions from files and from arrays, and their distances.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use realgap::comparison::{
    Association, Comparison, Components, Context, MAX_DIFFERENCE_S, Metric, Synchronised, Timing,
    position_metrics, synchronise,
};
use realgap::plot::{Caption, Overlay, OverlayPath, draw_overlay};
use realgap::trajectory::{self, JointTrack, Meta, Reading, Recording, Signal, Source};
use realgap::unit::Unit;
use realgap::{Error, Result};
use serde_json::{Map, Value, json};

use crate::array;
use crate::callback;
use crate::error::Raise;
use crate::text::{of_text, to_text};

/// Name, angles and speeds of a joint.
type JointBytes = (String, Vec<u8>, Option<Vec<u8>>);

/// A motion with its name.
#[pyclass(frozen, module = "realgap._native")]
pub struct Trajectory {
    pub recording: Arc<Recording>,
}

impl Trajectory {
    /// A motion that is no recording.
    pub fn of(name: &str, trajectory: trajectory::Trajectory) -> Self {
        Self {
            recording: Arc::new(Recording {
                name: name.to_owned(),
                path: PathBuf::from(name),
                trajectory,
                log: None,
                bodies: Vec::new(),
                meta: None,
                reading: Reading::default(),
                warnings: Vec::new(),
            }),
        }
    }

    /// The same motion, marked as a stand-in.
    pub fn stand_in_of(&self, robot: &str) -> Self {
        let mut recording = (*self.recording).clone();
        recording.meta = Some(Meta {
            robot: robot.to_owned(),
            source: Source::StandIn,
            description: "made by a program".to_owned(),
            frame: "world, z up".to_owned(),
            licence: String::new(),
            reading: Reading::default(),
        });
        Self {
            recording: Arc::new(recording),
        }
    }

    /// A motion that is passed to a metric.
    pub fn unnamed(trajectory: trajectory::Trajectory) -> Self {
        Self::of("", trajectory)
    }
}

#[pymethods]
impl Trajectory {
    /// All motions of a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, reading: &str) -> PyResult<Vec<Self>> {
        let all = py
            .detach(|| trajectory::read_all(path, of_text::<Reading>("reading", reading)?))
            .or_raise(py)?;
        let all = all.into_iter().map(|recording| Self {
            recording: Arc::new(recording),
        });
        Ok(all.collect())
    }

    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "the arrays that a motion has")]
    fn new(
        py: Python<'_>,
        name: &str,
        times_s: &[u8],
        positions_m: &[u8],
        orientations: Option<&[u8]>,
        velocities: Option<(Vec<u8>, Vec<u8>)>,
        joints: Vec<JointBytes>,
        signals: Vec<(String, Vec<u8>)>,
        is_planar: bool,
        stand_in_of: Option<&str>,
    ) -> PyResult<Self> {
        let make = || -> Result<Self> {
            let mut motion =
                trajectory::Trajectory::new(array::numbers(times_s), array::vectors(positions_m))?;
            if let Some(bytes) = orientations {
                motion = motion.with_orientations(array::quaternions(bytes)?)?;
            }
            if let Some((linear, angular)) = &velocities {
                motion = motion.with_velocities(array::vectors(linear), array::vectors(angular))?;
            }
            let joint = |(name, angles, speeds): &JointBytes| JointTrack {
                name: name.clone(),
                angles_rad: array::numbers(angles),
                speeds_rad_s: speeds.as_deref().map(array::numbers),
            };
            motion = motion.with_joints(joints.iter().map(joint).collect())?;
            let signal = |(name, values): &(String, Vec<u8>)| Signal {
                name: name.clone(),
                values: array::numbers(values),
            };
            motion = motion.with_signals(signals.iter().map(signal).collect())?;
            if is_planar {
                motion = motion.planar();
            }
            Ok(Self::of(name, motion))
        };
        let made = make().or_raise(py)?;
        Ok(match stand_in_of {
            Some(robot) => made.stand_in_of(robot),
            None => made,
        })
    }

    fn info(&self, py: Python<'_>) -> PyResult<String> {
        let recording = &self.recording;
        let motion = &recording.trajectory;
        let net_m: [f64; 3] = motion.net_displacement_world_m().into();
        let info = json!({
            "name": recording.name,
            "path": recording.path,
            "samples": motion.len(),
            "duration_s": motion.duration_s(),
            "path_length_xy_m": motion.path_length_xy_m(),
            "net_displacement_world_m": net_m,
            "turned_rad": motion.turned_rad(),
            "is_planar": motion.is_planar(),
            "is_stand_in": Source::of([&**recording]) == Source::StandIn,
            "joints": motion.joints().iter().map(|joint| &joint.name).collect::<Vec<_>>(),
            "signals": motion.signals().iter().map(|signal| &signal.name).collect::<Vec<_>>(),
            "warnings": recording.warnings,
        });
        to_text(&info).or_raise(py)
    }

    fn times_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let times_s = self.recording.trajectory.times_s();
        PyBytes::new(py, &array::bytes(times_s.iter().copied()))
    }

    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let positions = self.recording.trajectory.positions_world_m();
        PyBytes::new(py, &array::vector_bytes(positions))
    }

    fn orientations<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        let all = self.recording.trajectory.orientations_world_from_body()?;
        Some(PyBytes::new(py, &array::quaternion_bytes(all)))
    }

    fn velocities<'py>(
        &self,
        py: Python<'py>,
    ) -> Option<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
        let motion = &self.recording.trajectory;
        let linear = motion.velocities_world_m_s()?;
        let angular = motion.angular_velocities_body_rad_s()?;
        let bytes = |all| PyBytes::new(py, &array::vector_bytes(all));
        Some((bytes(linear), bytes(angular)))
    }

    /// Angles and speeds of a joint.
    fn joint<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> Option<(Bound<'py, PyBytes>, Option<Bound<'py, PyBytes>>)> {
        let joint = self.recording.trajectory.joint(name)?;
        let bytes = |all: &Vec<f64>| PyBytes::new(py, &array::bytes(all.iter().copied()));
        Some((
            bytes(&joint.angles_rad),
            joint.speeds_rad_s.as_ref().map(bytes),
        ))
    }

    /// Values of a signal: a command, or what a sensor beside pose and joints measured.
    fn signal<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyBytes>> {
        let signal = self.recording.trajectory.signal(name)?;
        let values = signal.values.iter().copied();
        Some(PyBytes::new(py, &array::bytes(values)))
    }

    /// The names of the bodies beside the tracked one, with their motions.
    fn bodies(&self) -> Vec<(String, Self)> {
        let bodies = self.recording.bodies.iter();
        bodies
            .map(|(name, motion)| (name.clone(), Self::of(name, motion.clone())))
            .collect()
    }

    /// Writes the motion, and returns warnings about data that the format cannot hold.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<String> {
        let warnings = trajectory::write(path, &self.recording.trajectory).or_raise(py)?;
        to_text(&warnings).or_raise(py)
    }

    /// Draws its prepared path.
    fn draw(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let draw = || {
            let recording = &*self.recording;
            let source = Source::of([recording]);
            let subtitle = match source {
                Source::StandIn => source.recordings_label(),
                Source::Real => "",
            };
            let overlay = Overlay {
                caption: Caption::new(format!("{}: path", recording.name), subtitle),
                reference: OverlayPath {
                    name: recording.name.clone(),
                    discrepancy: None,
                    points_m: trajectory::prepare(&recording.trajectory)?.xy_m().to_vec(),
                },
                others: Vec::new(),
                unit: Unit::Metre,
            };
            draw_overlay(&overlay, path)
        };
        draw().or_raise(py)
    }

    /// The prepared path, heights and orientations, and further numbers as JSON.
    #[allow(clippy::type_complexity, reason = "an array or none, thrice")]
    fn prepare<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(
        Bound<'py, PyBytes>,
        Option<Bound<'py, PyBytes>>,
        Option<Bound<'py, PyBytes>>,
        String,
    )> {
        let prepared = trajectory::prepare(&self.recording.trajectory).or_raise(py)?;
        let xy_m = array::bytes(prepared.xy_m().iter().copied().flatten());
        let z_m = prepared.z_m().map(|z_m| array::bytes(z_m.iter().copied()));
        let turned = prepared.orientations().map(array::quaternion_bytes);
        let info = json!({
            "net_displacement_m": prepared.net_displacement_m(),
            "path_length_m": prepared.path_length_m(),
            "heading_rad": prepared.heading_rad(),
            "warnings": prepared.warnings(),
        });
        let bytes = |all: Vec<u8>| PyBytes::new(py, &all);
        let info = to_text(&info).or_raise(py)?;
        Ok((bytes(xy_m), z_m.map(bytes), turned.map(bytes), info))
    }
}

/// How recordings are compared.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct HowToCompare {
    components: Option<usize>,
    variance: Option<f64>,
    body_length_m: Option<f64>,
    /// Words of the command's options; the number of seconds of an offset is a text, too.
    time: String,
    associate: String,
    max_difference_s: Option<f64>,
    align: String,
    offset: Option<String>,
}

impl HowToCompare {
    fn timing(&self) -> Result<Timing> {
        let association = match (self.associate.as_str(), self.max_difference_s) {
            ("nearest", within_s) => Association::Nearest {
                max_difference_s: within_s.unwrap_or(MAX_DIFFERENCE_S),
            },
            ("interpolate", None) => Association::Interpolated,
            ("interpolate", Some(_)) => {
                return Err(Error::usage("a largest difference belongs to `nearest`")
                    .field("max_difference_s"));
            }
            (other, _) => {
                return Err(Error::usage("there is no such association")
                    .field("associate")
                    .found(other)
                    .allowed("nearest, interpolate"));
            }
        };
        let offset = self.offset.as_deref().map(str::parse).transpose()?;
        let timing = Timing {
            base: self.time.parse()?,
            association,
            alignment: self.align.parse()?,
            offset: offset.unwrap_or_default(),
        };
        timing.check()?;
        Ok(timing)
    }
}

/// One row per recording as JSON, one column per metric; the paths are drawn into `picture` where it is given.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    reference: &Trajectory,
    others: Vec<Bound<'_, Trajectory>>,
    metrics: Option<Vec<Bound<'_, PyAny>>>,
    how: &str,
    picture: Option<PathBuf>,
) -> PyResult<String> {
    let metrics = match metrics {
        None => position_metrics(),
        Some(asked) => asked
            .iter()
            .map(callback::metric)
            .collect::<PyResult<_>>()?,
    };
    let reference = (*reference.recording).clone();
    let others: Vec<Recording> = others
        .iter()
        .map(|other| (*other.get().recording).clone())
        .collect();
    py.detach(|| {
        let how: HowToCompare = of_text("compare", how)?;
        let in_time = synchronise(reference, others, &how.timing()?, &metrics)?;
        let rows = rows(&in_time, &metrics, &how, picture)?;
        to_text(&rows)
    })
    .or_raise(py)
}

fn rows(
    in_time: &Synchronised,
    metrics: &[&'static dyn Metric],
    how: &HowToCompare,
    picture: Option<PathBuf>,
) -> Result<Vec<Value>> {
    let (reference, others) = (&in_time.reference, &in_time.others);
    let components = match (how.components, how.variance) {
        (Some(_), Some(_)) => {
            return Err(
                Error::usage("components and variance exclude each other").hint("give one of them")
            );
        }
        (Some(count), None) => Components::Count(count),
        (None, Some(share)) => Components::Variance(share),
        (None, None) => Components::default(),
    };
    components.check().map_err(Error::into_usage)?;
    let comparison = Comparison::new(reference, others, components)?.with_matched(&in_time.matched);
    let context = Context {
        basis: Some(comparison.basis()),
        spread: None,
        body_length_m: how.body_length_m,
        channels: None,
    };
    let mut rows = Vec::new();
    let mut drawn = Vec::new();
    for (index, other) in others.iter().enumerate() {
        let Some(pair) = comparison.pair(index) else {
            break;
        };
        let mut row = Map::new();
        row.insert("trajectory".to_owned(), json!(other.name));
        row.insert("reference".to_owned(), json!(reference.name));
        let net_m = pair.simulated_prepared.net_displacement_m();
        row.insert("net_displacement_m".to_owned(), json!(net_m));
        if let Value::Object(fields) = json!(in_time.synchrony[index]) {
            row.extend(fields);
        }
        let mut warnings = in_time.warnings.clone();
        warnings.extend(comparison.warnings());
        let mut first = None;
        for metric in metrics {
            let score = metric
                .compare(&pair, &context)
                .map_err(|e| e.at_file(&other.path))?;
            first.get_or_insert(score.value);
            row.insert(metric.column().to_owned(), json!(score.value));
            for warning in score.warnings {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        row.insert("warnings".to_owned(), json!(warnings));
        rows.push(Value::Object(row));
        drawn.push(OverlayPath {
            name: other.name.clone(),
            discrepancy: first,
            points_m: pair.simulated_prepared.xy_m().to_vec(),
        });
    }
    if let Some(picture) = picture {
        let first = metrics.first();
        let stand_in = Source::of(std::iter::once(reference).chain(others)) == Source::StandIn;
        let mut subtitle = format!("metric {}", first.map_or("", |metric| metric.name()));
        if stand_in {
            subtitle += &format!("; {}", Source::StandIn.recordings_label());
        }
        let overlay = Overlay {
            caption: Caption::new(format!("trajectories against {}", reference.name), subtitle),
            reference: OverlayPath {
                name: reference.name.clone(),
                discrepancy: None,
                points_m: comparison.reference_prepared().xy_m().to_vec(),
            },
            others: drawn,
            unit: first.map_or(Unit::One, |metric| metric.unit()),
        };
        draw_overlay(&overlay, picture)?;
    }
    Ok(rows)
}
