//! `realgap compare`: how far trajectories are from a reference.

use std::collections::BTreeMap;

use realgap::comparison::{
    self, Basis, Comparison, Components, Context, Metric, Row, Synchronised, Synchrony,
    position_metrics, synchronise,
};
use realgap::file::{Source as SourceText, versioned_json};
use realgap::plot::{Caption, Cloud, Overlay, OverlayPath, draw_lines, draw_overlay, plane};
use realgap::results::{Timed, draw_over_time};
use realgap::trajectory::{Prepared, Recording, Source};

use super::kind::{Kind, explain};
use super::kit::*;
use super::question;
use super::timing::TimingOptions;

/// Compare trajectories with a reference: real with simulated, or real with real
///
/// Use it to measure how far single runs are from a recording, without a study. By default stamps are those of one
/// clock: what the files have in common in time is compared. Runs of different clocks, e.g. a simulation and a
/// recording, are compared with --time start. The metrics ape, umeyama-ape, rpe and rotation compare matched samples as
/// they are, as evo does; for the others every trajectory is resampled to 182 points uniform in time, moved to start at
/// the origin and turned so that its net displacement lies on +x (paper 003, section 2.2). `displacement` is the part of a path's distance that
/// comes from its net displacement, `shape` is the remaining part. Values of `pca` depend on which trajectories are
/// compared together, unless --save-basis and --basis let comparisons share a basis.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap compare real.csv simulated.csv --plot gap.png
  realgap compare real.csv runs/*.csv --metric rms --over-time time.png
  realgap compare real.csv simulated.csv --metric pose --body-length 0.06
  realgap compare truth.tum estimate.tum --metric ape --align se3 --offset auto")]
pub struct Compare {
    /// The reference, usually the real run (.csv or .tum)
    reference: PathBuf,
    /// The trajectories to compare with it
    #[arg(required = true, value_name = "TRAJECTORY")]
    trajectories: Vec<PathBuf>,
    /// Name of a metric, or `all` for the metrics that need positions only (rotation and pose must be named)
    #[arg(long, default_value = "all", value_name = "NAME")]
    metric: String,
    /// Keep this many principal components
    #[arg(long, value_name = "K", conflicts_with = "variance")]
    components: Option<usize>,
    /// Keep the fewest principal components that explain this share of the variance [default: 0.99]
    #[arg(long, value_name = "F")]
    variance: Option<f64>,
    /// Use this basis, e.g. the basis.json of a results folder, so that numbers of different comparisons can be compared
    #[arg(long, value_name = "FILE", conflicts_with_all = ["components", "variance"])]
    basis: Option<PathBuf>,
    /// Write the basis that was used into this .json file
    #[arg(long, value_name = "FILE")]
    save_basis: Option<PathBuf>,
    /// Body length of the robot in metres, for the metric `pose`
    #[arg(long, value_name = "M")]
    body_length: Option<f64>,
    #[command(flatten)]
    timing: TimingOptions,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    print: Print,
    /// Draw the aligned trajectories into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Draw the aligned trajectories over time, with their heights and their distances from the reference, into this .png or .svg;
    /// useful for straight paths and for tosses
    #[arg(long, value_name = "FILE")]
    over_time: Option<PathBuf>,
    /// Draw every trajectory as a dot in the plane of the first two principal components into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plane: Option<PathBuf>,
}

/// Up to this many trajectories have a colour and a name of their own in the plane.
const NAMED_DOTS: usize = 5;

/// A trajectory in every metric.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compared {
    #[serde(flatten)]
    row: Row,
    /// What it has in common in time with the reference.
    #[serde(flatten)]
    synchrony: Synchrony,
    /// What the reader should know.
    warnings: Vec<Warning>,
}

/// A trajectory in one metric.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scored {
    /// Its name.
    trajectory: String,
    /// Name of the reference.
    reference: String,
    /// The distance, in the metric's column.
    #[serde(flatten)]
    value: BTreeMap<&'static str, f64>,
    /// The metric.
    metric: &'static str,
    /// Unit of the distance.
    unit: Unit,
    /// Samples that were compared.
    samples: usize,
    /// What it has in common in time with the reference.
    #[serde(flatten)]
    synchrony: Synchrony,
    /// What the reader should know.
    warnings: Vec<Warning>,
}

/// The note of pictures whose recordings are stand-ins and not hardware; it begins with a semicolon.
fn stand_in(reference: &Recording, others: &[Recording]) -> String {
    let source = Source::of(std::iter::once(reference).chain(others));
    match source {
        Source::StandIn => format!("; {}", source.recordings_label()),
        Source::Real => String::new(),
    }
}

fn timed<'a>(recording: &'a Recording, path: &'a Prepared) -> Timed<'a> {
    Timed {
        name: &recording.name,
        path,
        duration_s: recording.trajectory.duration_s(),
    }
}

impl Compare {
    pub fn run(self) -> Result<()> {
        let chosen = match self.metric.as_str() {
            "all" => None,
            name => Some(comparison::by_name(name).map_err(Error::into_usage)?),
        };
        let pictures = [&self.plot, &self.plane, &self.over_time];
        output::check_pictures(pictures.into_iter().flatten())?;
        let components = match (self.components, self.variance) {
            (Some(count), _) => Components::Count(count),
            (None, Some(share)) => Components::Variance(share),
            (None, None) => Components::default(),
        };
        components.check().map_err(Error::into_usage)?;
        let timing = self.timing.timing()?;
        if chosen.is_none() && self.body_length.is_some() {
            return Err(Error::usage("--body-length belongs to --metric pose").hint(
                "`all` covers the metrics of positions only; name pose or rotation instead",
            ));
        }
        let files = 1 + self.trajectories.len();
        let read = |index: usize, path: &PathBuf| {
            question::read(path, &self.reading.of_path(path, index, files)?)
                .map_err(|error| explain(path, Kind::Trajectory, error))
        };
        let reference = read(0, &self.reference)?;
        let others: Vec<Recording> = self
            .trajectories
            .iter()
            .enumerate()
            .map(|(index, path)| read(1 + index, path))
            .collect::<Result<_>>()?;
        let mut said = Vec::new();
        for recording in std::iter::once(&reference).chain(&others) {
            for warning in &recording.warnings {
                // This warning is about one file, so it names the file.
                said.push(match warning.code {
                    Code::ReadAs => warning
                        .code
                        .warning(format!("{}: {}", recording.name, warning.message)),
                    _ => warning.clone(),
                });
            }
        }
        let metrics = chosen.map_or_else(position_metrics, |metric| vec![metric]);
        let in_time = synchronise(reference, others, &timing, &metrics)?;
        said.extend(in_time.warnings.iter().cloned());
        let (reference, others) = (&in_time.reference, &in_time.others);
        let comparison = match &self.basis {
            Some(file) => {
                let basis = Basis::parse(&SourceText::read(file, "basis")?)?;
                Comparison::new(reference, others, components)?.with_basis(basis)
            }
            None => Comparison::new(reference, others, components)?,
        };
        let comparison = comparison.with_matched(&in_time.matched);
        said.extend(comparison.warnings());
        terminal::print_warnings(&said);
        match chosen {
            None => self.print_all(&comparison, &in_time, &said)?,
            Some(metric) => self.print_one(&comparison, metric, &in_time, &said)?,
        }
        if let Some(plot) = &self.plot {
            let metric = chosen.unwrap_or(comparison::METRICS[0]);
            self.draw(plot, &comparison, metric, reference, others)?;
            terminal::note(format!("drawn: {}", plot.display()));
        }
        if let Some(file) = &self.over_time {
            let paths = comparison.others_prepared().iter();
            let rest = others.iter().zip(paths).map(|(r, path)| timed(r, path));
            let first = timed(reference, comparison.reference_prepared());
            let all: Vec<Timed<'_>> = std::iter::once(first).chain(rest).collect();
            let what = stand_in(reference, others);
            draw_over_time(&all, &format!("same start, same heading{what}"), file)?;
            terminal::note(format!("drawn: {}", file.display()));
        }
        if let Some(plane) = &self.plane {
            self.draw_plane(plane, &comparison, others)?;
            terminal::note(format!("drawn: {}", plane.display()));
        }
        if let Some(file) = &self.save_basis {
            let json = versioned_json(comparison.basis())?;
            output::write(file, format!("{json}\n").as_bytes())?;
            terminal::note(format!("written: {}", file.display()));
        }
        Ok(())
    }

    fn print_all(
        &self,
        comparison: &Comparison<'_>,
        in_time: &Synchronised,
        said: &[Warning],
    ) -> Result<()> {
        let metrics = position_metrics();
        let rows = comparison.rows(&metrics)?;
        terminal::print_warnings(rows.iter().flat_map(|row| &row.warnings));
        if self.print.is_json() {
            let rows = rows.into_iter().zip(&in_time.synchrony);
            let rows = rows.map(|(row, synchrony)| Compared {
                warnings: said.iter().chain(&row.warnings).cloned().collect(),
                row,
                synchrony: *synchrony,
            });
            return terminal::print_answers(&rows.collect::<Vec<_>>());
        }
        // Metrics are rows and trajectories are columns, because a dozen columns of numbers would not fit a terminal.
        let names = rows.iter().map(|row| (row.trajectory.clone(), Side::Right));
        let mut table =
            TextTable::new([("metric".to_owned(), Side::Left)].into_iter().chain(names));
        let mut push = |label: &str, cell: &dyn Fn(&Row) -> String| {
            let cells = rows.iter().map(cell);
            table.push(
                std::iter::once(label.to_owned())
                    .chain(cells)
                    .collect::<Vec<_>>(),
            );
        };
        push("net_displacement", &|row| {
            quantity(row.net_displacement_m, Unit::Metre)
        });
        push("pca_components", &|row| row.pca_components.to_string());
        push("pca_4_coefficients", &|row| {
            quantity(row.pca_4_coefficients_m, Unit::Metre)
        });
        for (index, metric) in metrics.iter().enumerate() {
            let column = metric.column();
            push(column.strip_suffix("_m").unwrap_or(column), &|row| {
                let distance = row.distances[index];
                quantity(distance.value, distance.unit)
            });
        }
        terminal::print(format!(
            "distance from {} ({} principal components kept)\n{}\n{}",
            self.reference.display(),
            comparison.basis().kept(),
            in_time.text(),
            terminal::table(&table)
        ));
        Ok(())
    }

    fn print_one(
        &self,
        comparison: &Comparison<'_>,
        metric: &dyn Metric,
        in_time: &Synchronised,
        said: &[Warning],
    ) -> Result<()> {
        let others = &in_time.others;
        let scores = self.scores(comparison, metric, others)?;
        let mut warnings: Vec<&Warning> = scores.iter().flat_map(|score| &score.warnings).collect();
        warnings.dedup();
        terminal::print_warnings(warnings);
        if self.print.is_json() {
            let reference = self.reference.file_stem().unwrap_or_default();
            let rows = others.iter().zip(&in_time.synchrony).zip(&scores);
            let rows = rows.map(|((other, synchrony), score)| Scored {
                trajectory: other.name.clone(),
                reference: reference.to_string_lossy().into_owned(),
                value: [(metric.column(), score.value)].into(),
                metric: metric.name(),
                unit: score.unit,
                samples: score.samples,
                synchrony: *synchrony,
                warnings: said.iter().chain(&score.warnings).cloned().collect(),
            });
            return terminal::print_answers(&rows.collect::<Vec<_>>());
        }
        let mut table = TextTable::new([
            ("trajectory", Side::Left),
            (metric.name(), Side::Right),
            ("samples", Side::Right),
        ]);
        for (other, score) in others.iter().zip(&scores) {
            table.push([
                other.name.clone(),
                quantity(score.value, score.unit),
                score.samples.to_string(),
            ]);
        }
        terminal::print(format!(
            "{} from {}: {}\n{}\n{}",
            metric.name(),
            self.reference.display(),
            metric.doc(),
            in_time.text(),
            terminal::table(&table)
        ));
        Ok(())
    }

    fn scores(
        &self,
        comparison: &Comparison<'_>,
        metric: &dyn Metric,
        others: &[Recording],
    ) -> Result<Vec<comparison::Score>> {
        let context = Context {
            basis: Some(comparison.basis()),
            spread: None,
            body_length_m: self.body_length,
            channels: None,
        };
        if metric.needs().spread {
            return Err(Error::usage(format!(
                "the metric `{}` needs repeats of the real run, but this is a single reference",
                metric.name()
            ))
            .hint("use it in a study: realgap sweep STUDY --metric pca-whitened"));
        }
        if metric.needs().body_length && self.body_length.is_none() {
            return Err(Error::usage(format!(
                "the metric `{}` needs --body-length",
                metric.name()
            ))
            .hint(
                "give the edge length of the robot's module in metres, e.g. --body-length 0.1048",
            ));
        }
        let pairs = (0..others.len()).filter_map(|index| comparison.pair(index));
        pairs
            .zip(others)
            .map(|(pair, other)| {
                metric
                    .compare(&pair, &context)
                    .map_err(|e| e.at_file(&other.path))
            })
            .collect()
    }

    fn draw_plane(
        &self,
        file: &Path,
        comparison: &Comparison<'_>,
        others: &[Recording],
    ) -> Result<()> {
        let reference = comparison.reference_prepared();
        let all = std::iter::once(reference).chain(comparison.others_prepared());
        let Some(basis) = Basis::plane(Some(comparison.basis()), all)? else {
            return Err(
                Error::usage("these trajectories differ in fewer than two components")
                    .hint("compare at least three different trajectories"),
            );
        };
        let stem = self.reference.file_stem().unwrap_or_default();
        let places = comparison.others_prepared().iter();
        let places: Vec<(f64, f64)> = places.map(|path| basis.in_plane_m(path)).collect();
        let mut clouds = if others.len() > NAMED_DOTS {
            let label = format!("{} others", others.len());
            vec![Cloud {
                label,
                colour: 0,
                points_m: places,
            }]
        } else {
            let named = others.iter().zip(places).enumerate();
            named
                .map(|(colour, (other, place))| Cloud {
                    label: other.name.clone(),
                    colour,
                    points_m: vec![place],
                })
                .collect()
        };
        clouds.push(Cloud {
            label: format!("{} (reference)", stem.to_string_lossy()),
            colour: NAMED_DOTS,
            points_m: vec![basis.in_plane_m(reference)],
        });
        let caption = Caption::new(
            "trajectories in the first two principal components",
            format!("basis of {} trajectories", basis.trajectories()),
        );
        draw_lines(&plane(caption, basis.plane_shares(), clouds), file)
    }

    fn draw(
        &self,
        plot: &Path,
        comparison: &Comparison<'_>,
        metric: &dyn Metric,
        reference: &Recording,
        others: &[Recording],
    ) -> Result<()> {
        let scores = self.scores(comparison, metric, others)?;
        let overlay = Overlay {
            caption: Caption::new(
                format!(
                    "{} against {}",
                    if others.len() == 1 {
                        &others[0].name
                    } else {
                        "trajectories"
                    },
                    reference.name
                ),
                format!("metric {}{}", metric.name(), stand_in(reference, others)),
            ),
            reference: OverlayPath {
                name: reference.name.clone(),
                discrepancy: None,
                points_m: comparison.reference_prepared().xy_m().to_vec(),
            },
            others: others
                .iter()
                .zip(comparison.others_prepared())
                .zip(&scores)
                .map(|((other, prepared), score)| OverlayPath {
                    name: other.name.clone(),
                    discrepancy: Some(score.value),
                    points_m: prepared.xy_m().to_vec(),
                })
                .collect(),
            unit: metric.unit(),
        };
        draw_overlay(&overlay, plot)
    }
}
