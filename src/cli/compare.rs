//! `realgap compare`: how far trajectories are from a reference.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use realgap::comparison::{self, Comparison, Components, Context, Metric, Row, position_metrics};
use realgap::plot::{Caption, Overlay, OverlayPath, Side, TextTable, draw_overlay, quantity};
use realgap::trajectory::{self, Recording, Source};
use realgap::unit::{LengthUnit, Unit};
use realgap::{Error, Result, Warning};
use serde_json::{Value, json};

use super::option::{Format, UnitOption};
use super::terminal;

/// Compare trajectories with a reference, real with simulated or real with real
///
/// Every trajectory is resampled to 182 points uniform in time, moved to start at the origin and turned so that
/// its net displacement lies on +x (paper 003, section 2.2); then each metric measures the distance.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Compare {
    /// The reference, usually the real run (.csv or .tum)
    reference: PathBuf,
    /// The trajectories to compare with it
    #[arg(required = true, value_name = "TRAJECTORY")]
    trajectories: Vec<PathBuf>,
    /// Metric, or `all` that need positions only (rotation and pose are asked for by name)
    #[arg(long, default_value = "all", value_name = "NAME")]
    metric: String,
    /// Keep this many principal components
    #[arg(long, value_name = "K", conflicts_with = "variance")]
    components: Option<usize>,
    /// Keep the fewest principal components that explain this share of the variance [default: 0.99]
    #[arg(long, value_name = "F")]
    variance: Option<f64>,
    /// Body length of the robot in metres, for the metric `pose`
    #[arg(long, value_name = "M")]
    body_length: Option<f64>,
    /// Unit of length of the files
    #[arg(long, value_enum, default_value_t)]
    unit: UnitOption,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Draw the aligned trajectories into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl Compare {
    pub fn run(self) -> Result<ExitCode> {
        let chosen = match self.metric.as_str() {
            "all" => None,
            name => Some(comparison::by_name(name).map_err(Error::into_usage)?),
        };
        if let Some(plot) = &self.plot {
            realgap::plot::check_picture_path(plot)?;
        }
        let components = match (self.components, self.variance) {
            (Some(count), _) => Components::Count(count),
            (None, Some(share)) => Components::Variance(share),
            (None, None) => Components::default(),
        };
        components.check().map_err(Error::into_usage)?;
        if chosen.is_none() && self.body_length.is_some() {
            return Err(Error::usage("--body-length belongs to --metric pose").hint(
                "`all` are the metrics of positions; pose and rotation are asked for by name",
            ));
        }
        let unit = LengthUnit::from(self.unit);
        let reference = trajectory::read(&self.reference, unit)?;
        let others: Vec<Recording> = self
            .trajectories
            .iter()
            .map(|path| trajectory::read(path, unit))
            .collect::<Result<_>>()?;
        terminal::print_warnings(
            std::iter::once(&reference)
                .chain(&others)
                .flat_map(|r| &r.warnings),
        );
        let comparison = Comparison::new(&reference, &others, components)?;
        match chosen {
            None => self.print_all(&comparison)?,
            Some(metric) => self.print_one(&comparison, metric, &others)?,
        }
        if let Some(plot) = &self.plot {
            let metric = chosen.unwrap_or(comparison::METRICS[0]);
            self.draw(plot, &comparison, metric, &reference, &others)?;
            terminal::note(format!("drawn: {}", plot.display()));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn print_all(&self, comparison: &Comparison<'_>) -> Result<()> {
        let metrics = position_metrics();
        let rows = comparison.rows(&metrics)?;
        terminal::print_warnings(rows.iter().flat_map(|row| &row.warnings));
        if self.format == Format::Json {
            terminal::print(terminal::json(&rows)?);
            return Ok(());
        }
        // Metrics down, trajectories across: a dozen columns of figures would not fit a terminal.
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
            "distance from {} ({} principal components kept)\n{}",
            self.reference.display(),
            comparison.basis().kept(),
            table.render(terminal::stdout_wants_colour()).trim_end()
        ));
        Ok(())
    }

    fn print_one(
        &self,
        comparison: &Comparison<'_>,
        metric: &dyn Metric,
        others: &[Recording],
    ) -> Result<()> {
        let scores = self.scores(comparison, metric, others)?;
        let mut warnings: Vec<&Warning> = scores.iter().flat_map(|score| &score.warnings).collect();
        warnings.dedup();
        terminal::print_warnings(warnings);
        if self.format == Format::Json {
            let rows: Vec<Value> = others
                .iter()
                .zip(&scores)
                .map(|(other, score)| {
                    json!({"trajectory": other.name, "reference": self.reference.file_stem().unwrap_or_default().to_string_lossy(), metric.column(): score.value,
                           "metric": metric.name(), "unit": score.unit.label(), "samples": score.samples})
                })
                .collect();
            terminal::print(terminal::json(&rows)?);
            return Ok(());
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
            "{} from {}: {}\n{}",
            metric.name(),
            self.reference.display(),
            metric.doc(),
            table.render(terminal::stdout_wants_colour()).trim_end()
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
            body_length_m: self.body_length,
        };
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

    fn draw(
        &self,
        plot: &std::path::Path,
        comparison: &Comparison<'_>,
        metric: &dyn Metric,
        reference: &Recording,
        others: &[Recording],
    ) -> Result<()> {
        let scores = self.scores(comparison, metric, others)?;
        let source = Source::of(std::iter::once(reference).chain(others));
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
                format!(
                    "metric {}{}",
                    metric.name(),
                    match source {
                        Source::StandIn => format!("; {}", source.recordings_label()),
                        Source::Real => String::new(),
                    }
                ),
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
