//! Several quantities over the same axis, one above the other.

use super::series::{Series, check_bands, check_points, draw_series, finite_points, legend};
use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1200.0;
const ROW_HEIGHT: f64 = 250.0;
const GAP: f64 = 26.0;
const MARGIN: f64 = 34.0;

/// One quantity of a [`Stack`].
#[derive(Debug, Clone, PartialEq)]
pub struct StackRow {
    /// Its own horizontal quantity; `None` where it shares that of the stack.
    pub x: Option<AxisSpec>,
    /// What the quantity is.
    pub y_label: String,
    /// Unit of the y values given; they are shown in one of handy size.
    pub y_unit: Unit,
    /// What is drawn, later ones above earlier ones.
    pub series: Vec<Series>,
}

/// Rows over one horizontal axis. The legend is that of the first row: the others show the same things.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The horizontal quantity.
    pub x: AxisSpec,
    /// The rows, from the top.
    pub rows: Vec<StackRow>,
}

/// Draws the rows into a PNG or SVG file.
///
/// # Errors
/// No row or more than 60, a row without any finite point, a band of the wrong length, a path that is no picture's, a full disk.
pub fn draw_stack(stack: &Stack, path: impl AsRef<Path>) -> Result<()> {
    picture::write(stack, path.as_ref())
}

/// A row with its axis.
struct Axis<'a> {
    row: &'a StackRow,
    unit: DisplayUnit,
    y: Scale,
}

impl<'a> Axis<'a> {
    fn new(row: &'a StackRow) -> Self {
        let ys: Vec<f64> = finite_points(&row.series).map(|(_, y)| y).collect();
        let unit = DisplayUnit::for_values(row.y_unit, ys.iter().copied());
        let shown: Vec<f64> = ys.iter().map(|y| y * unit.factor).collect();
        let y = with_room(Scale::for_scores(&shown, ScoreScale::Linear, AXIS_DECADES));
        Self { row, unit, y }
    }
}

fn x_scale(points: impl Iterator<Item = Point>) -> Scale {
    let (low, high) = ends_of(points.map(|(x, _)| x));
    match low <= high {
        true => Scale::linear(low, high),
        false => Scale::linear(0.0, 1.0),
    }
}

impl Stack {
    /// Height of all rows with their axes.
    fn rows_height(&self) -> f64 {
        let own = self.rows.iter().filter(|row| row.x.is_some()).count() as f64;
        let gaps = self.rows.len().saturating_sub(1) as f64;
        self.rows.len() as f64 * ROW_HEIGHT + gaps * GAP + own * BELOW_LABEL
    }

    fn heading_and_legend(&self) -> HeadingAndLegend {
        let first = self.rows.first().map_or(&[][..], |row| &row.series);
        HeadingAndLegend::new(&self.caption, legend(first), WIDTH, MARGIN)
    }
}

impl Picture for Stack {
    fn check(&self) -> Result<()> {
        picture::check_rows("rows", self.rows.len(), 1)?;
        for row in &self.rows {
            check_bands(&row.series)?;
            check_points(&row.y_label, &row.series)?;
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let shared = self.rows.last().is_some_and(|row| row.x.is_none());
        let plots = self.rows_height() + if shared { BELOW_LABEL } else { 0.0 };
        self.heading_and_legend().around(WIDTH, plots)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let height = f64::from(self.size().1);
        let surround = self.heading_and_legend();
        surround.draw(canvas, height);

        let shared = self.rows.iter().filter(|row| row.x.is_none());
        let shared_x = x_scale(shared.flat_map(|row| finite_points(&row.series)));
        let axes: Vec<Axis<'_>> = self.rows.iter().map(Axis::new).collect();
        let lefts = axes.iter().map(|axis| left_of_label(&axis.y.ticks(5)));
        let left = MARGIN + lefts.fold(0.0, f64::max);
        let mut top = surround.top();
        for (index, axis) in axes.iter().enumerate() {
            let y_ticks = axis.y.ticks(5);
            let (spec, x) = match &axis.row.x {
                Some(own) => (own, x_scale(finite_points(&axis.row.series))),
                None => (&self.x, shared_x),
            };
            let x_ticks = axis::round_ticks(spec, &x, 9);
            let corner = (WIDTH - MARGIN, top + ROW_HEIGHT);
            let frame = Frame::new((left, top), corner, [x, axis.y]);
            frame.draw_grid(canvas, &x_ticks, &y_ticks);
            for series in &axis.row.series {
                draw_series(canvas, &frame, series, axis.unit.factor);
            }
            frame.draw_outline(canvas);
            frame.draw_y_axis(canvas, &y_ticks, &axis.unit.label(&axis.row.y_label));
            let has_own = axis.row.x.is_some();
            if has_own || index + 1 == self.rows.len() {
                frame.draw_x_axis(canvas, &x_ticks, &spec.title());
            }
            top += ROW_HEIGHT + GAP + if has_own { BELOW_LABEL } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::SeriesKind;

    fn stack(points: Vec<Point>) -> Stack {
        let series = Series::new("run", SeriesKind::Line, points);
        let row = |label: &str| StackRow {
            x: None,
            y_label: label.to_owned(),
            y_unit: Unit::Metre,
            series: vec![series.clone()],
        };
        Stack {
            caption: Caption::new("over time", "a test"),
            x: AxisSpec::new("time", Unit::Second),
            rows: vec![row("ahead"), row("height")],
        }
    }

    #[test]
    fn every_row_has_its_own_axis_and_the_last_the_common_one() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("stack.svg");
        draw_stack(&stack(vec![(0.0, 0.0), (1.0, 0.2)]), &file).unwrap();
        let drawn = std::fs::read_to_string(&file).unwrap();
        assert!(drawn.contains("ahead (cm)") && drawn.contains("height (cm)"));
        assert_eq!(drawn.matches("time (s)").count(), 1);
    }

    #[test]
    fn a_row_with_nothing_in_it_is_refused_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let error = draw_stack(
            &stack(vec![(0.0, f64::NAN)]),
            folder.path().join("stack.svg"),
        );
        assert_eq!(error.unwrap_err().field_name(), Some("ahead"));
    }
}
