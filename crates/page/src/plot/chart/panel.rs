//! Panels: simulated paths at several parameter values, each over the real ones.

use crate::plot::kit::*;
use crate::plot::{LinePlot, Series, SeriesKind};
use realgap_core::statistics::ends_of;
use realgap_core::unit::counted;

const WIDTH: f64 = 1260.0;
const MARGIN: f64 = 30.0;
const GAP: f64 = 30.0;
const ROW_GAP: f64 = 10.0;
/// Room above a panel for the discrepancy, and for each line of the note.
const TITLE: f64 = 38.0;
const NOTE_LINE: f64 = 26.0;
const NOTE_LINES_AT_MOST: usize = 3;
const TITLE_SIZE: f64 = 23.0;
const NOTE_SIZE: f64 = 20.0;
/// Height of a panel as a share of its width.
const SHAPE: std::ops::RangeInclusive<f64> = 0.42..=1.1;

/// Paths that go less to the side than this share of how far they go ahead are flat lines from above: they are shown over time.
const STRAIGHT: f64 = 0.08;
/// Shape of a panel over time.
const OVER_TIME: f64 = 0.7;

/// One panel: simulated paths at one set of parameter values.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Discrepancy, in the unit of the figure; `None` (or not finite) means diverged.
    pub score: Option<f64>,
    /// The parameter values, e.g. `friction 0.29, restitution 0.45`.
    pub note: String,
    /// Simulated paths in metres, one for each recording that was simulated.
    pub simulated_m: Vec<Vec<PathPoint>>,
    /// Whether this is the best of the sweep; it gets a thick frame and a star.
    pub is_best: bool,
}

/// A grid of panels with common axes, filled row by row from the top left. Paths lead along +x, their points at equal steps of
/// time; where all of them are straight, the panels show how far along each is over its time.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelGrid {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// Panels side by side, 1 to 6; three for nine panels.
    pub columns: usize,
    /// The panels, at most 60.
    pub panels: Vec<Panel>,
    /// Real paths in metres, behind the simulated ones of every panel.
    pub reality_m: Vec<Vec<PathPoint>>,
    /// What the legend calls them, e.g. `reality` or `stand-in for reality`.
    pub reality_label: String,
    /// Unit of the scores.
    pub unit: Unit,
}

struct Layout {
    is_over_time: bool,
    heading: Heading,
    legend: Legend,
    x: Scale,
    y: Scale,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
    unit: DisplayUnit,
    /// Room above each panel.
    head: f64,
    left: f64,
    top: f64,
    panel_width: f64,
    panel_height: f64,
    legend_top: f64,
    height: f64,
}

/// How far along each point of a path is, in centimetres, over its time in percent.
fn over_time(path_m: &[PathPoint]) -> Vec<Point> {
    let last = path_m.len().saturating_sub(1).max(1) as f64;
    let places = finite_cm(path_m).into_iter().enumerate();
    let over = places.map(|(k, (x, _))| (100.0 * k as f64 / last, x));
    over.collect()
}

fn is_straight(paths_m: &[&Vec<PathPoint>]) -> bool {
    let points = || paths_m.iter().flat_map(|path| finite_cm(path));
    let ahead = points().map(|(x, _)| x.abs()).fold(0.0, f64::max);
    let aside = points().map(|(_, y)| y.abs()).fold(0.0, f64::max);
    // Who stays where it is goes nowhere, and not straight on.
    ahead > 1.0 && aside < 0.5 * STRAIGHT * ahead
}

/// All of the time, and the ways of all paths with some room.
fn over_time_bounds(paths_m: &[&Vec<PathPoint>]) -> (Point, Point) {
    let ways = paths_m.iter().flat_map(|path| finite_cm(path));
    let (low, high) = ends_of(ways.map(|(x, _)| x).chain([0.0]));
    let room = 0.06 * (high - low);
    ((-3.0, 103.0), (low - room, high + room))
}

impl Panel {
    fn finite_score(&self) -> Option<f64> {
        self.score.filter(|score| score.is_finite())
    }

    fn note_lines(&self, width: f64) -> Vec<String> {
        let weight = Weight::Regular;
        wrap(&self.note, weight, NOTE_SIZE, width, NOTE_LINES_AT_MOST)
    }
}

impl PanelGrid {
    /// One panel as a chart of its own: its simulated paths over the real ones, seen from above.
    pub(crate) fn chart(&self, panel: usize) -> LinePlot {
        let points = |path: &Vec<PathPoint>| path.iter().map(|[x, y]| (*x, *y)).collect();
        let label = |first: bool, text: String| if first { text } else { String::new() };
        let runs = counted(self.reality_m.len(), "run");
        let real = self.reality_m.iter().enumerate().map(|(index, path)| {
            let label = label(index == 0, format!("{} ({runs})", self.reality_label));
            Series::new(label, SeriesKind::Line, points(path)).recorded()
        });
        let simulated = self.panels.get(panel).into_iter();
        let simulated = simulated.flat_map(|panel| panel.simulated_m.iter().enumerate());
        let simulated = simulated.map(|(index, path)| {
            let label = label(index == 0, "simulation".to_owned());
            Series::new(label, SeriesKind::Line, points(path))
        });
        let x = AxisSpec::new("x", Unit::Metre);
        let series = real.chain(simulated).collect();
        LinePlot {
            scale: ScoreScale::LikeX,
            ..LinePlot::new(self.caption.clone(), x, ("y", Unit::Metre), series)
        }
    }

    fn layout(&self) -> Layout {
        let heading = Heading::new(&self.caption, WIDTH - 2.0 * MARGIN);
        let legend = self.legend();
        let columns = self.columns.min(self.panels.len()) as f64;
        let rows = self.panels.len().div_ceil(self.columns) as f64;

        // A diverged path leads anywhere and would shrink all others to a dot.
        let all = self.panels.iter();
        let good = all.filter(|panel| panel.finite_score().is_some());
        let simulated = good.flat_map(|panel| &panel.simulated_m);
        let paths: Vec<_> = self.reality_m.iter().chain(simulated).collect();
        let is_over_time = is_straight(&paths);
        let (x, y) = match is_over_time {
            true => over_time_bounds(&paths),
            false => bounds_cm(paths.iter().map(|path| path.as_slice())),
        };
        let shape = match is_over_time {
            true => OVER_TIME,
            false => ((y.1 - y.0) / (x.1 - x.0)).clamp(*SHAPE.start(), *SHAPE.end()),
        };
        let scales = |shape: f64| match is_over_time {
            true => (Scale::linear(x.0, x.1), Scale::linear(y.0, y.1)),
            false => equal_aspect(x, y, shape),
        };
        let tick_count = |length: f64| (length / 50.0).clamp(3.0, 9.0) as usize;
        // The width of the labels decides the width of the panels and the other way round: one
        // round is enough, as only the number of digits matters.
        let (_, rough) = scales(1.0 / shape);
        let left = (MARGIN + left_of_label(&rough.ticks(4))).round();
        let panel_width = ((WIDTH - MARGIN - left - GAP * (columns - 1.0)) / columns).floor();
        let panel_height = (panel_width.min(560.0) * shape).round();
        let (x, y) = scales(panel_width / panel_height);
        let panels = self.panels.iter();
        let note_lines = panels.map(|panel| panel.note_lines(panel_width).len());
        let head = TITLE + NOTE_LINE * note_lines.max().unwrap_or(0) as f64;
        let top = (14.0 + heading.height() + 10.0).round();
        let legend_top =
            top + rows * (head + panel_height) + (rows - 1.0) * ROW_GAP + BELOW_LABEL + 10.0;
        let scores = self.panels.iter().filter_map(Panel::finite_score);
        Layout {
            is_over_time,
            height: legend_top + legend.height() + 14.0,
            x_ticks: x.ticks(tick_count(panel_width)),
            y_ticks: y.ticks(tick_count(panel_height)),
            unit: DisplayUnit::for_values(self.unit, scores),
            head,
            heading,
            legend,
            x,
            y,
            left,
            top,
            panel_width,
            panel_height,
            legend_top,
        }
    }

    fn legend(&self) -> Legend {
        let line = |colour, width| Symbol::Line(Stroke::new(width, colour));
        let mut entries = Vec::new();
        if !self.reality_m.is_empty() {
            let (colour, width) = self.reality_style();
            let text = match self.reality_m.len() {
                1 => self.reality_label.clone(),
                count => format!("{} ({count} runs)", self.reality_label),
            };
            entries.push((line(colour, width), text));
        }
        entries.push((line(BLUE, 3.5), "simulation".to_string()));
        entries.push((Symbol::Start, "start".to_string()));
        if self.panels.iter().any(|panel| panel.is_best) {
            entries.push((Symbol::Star, "best of the sweep".to_string()));
        }
        Legend::new(entries, WIDTH - 2.0 * MARGIN)
    }

    /// One real path stands out; many are a background.
    fn reality_style(&self) -> (RGBColor, f64) {
        match self.reality_m.len() {
            1 => (INK, 4.0),
            _ => (tint(INK, 0.45), 2.0),
        }
    }

    fn draw_panel(&self, canvas: &mut Canvas, panel: &Panel, frame: &Frame, layout: &Layout) {
        let score = panel.finite_score();
        if score.is_none() {
            let from = (frame.left, frame.top);
            canvas.cell(from, (frame.right, frame.bottom), DIVERGED);
        } else {
            frame.draw_grid(canvas, &layout.x_ticks, &layout.y_ticks);
        }
        let (colour, width) = self.reality_style();
        let draw = |canvas: &mut Canvas, path: &[PathPoint], stroke| match layout.is_over_time {
            true => {
                let points = over_time(path).into_iter().map(|point| frame.at(point));
                canvas.path(&points.collect::<Vec<_>>(), stroke);
            }
            false => draw_path(canvas, frame, path, stroke),
        };
        for path in &self.reality_m {
            draw(canvas, path, Stroke::new(width, colour));
        }
        if score.is_some() {
            let is_crowd = panel.simulated_m.len() > 3;
            let width = if is_crowd { 2.0 } else { 3.5 };
            for path in &panel.simulated_m {
                draw(canvas, path, Stroke::new(width, BLUE));
            }
        }
        draw_start(canvas, frame.at((0.0, 0.0)));
        frame.draw_outline(canvas);
        if panel.is_best {
            let (from, to) = ((frame.left, frame.top), (frame.right, frame.bottom));
            canvas.outline(from, to, 5.0, VERMILLION);
        }

        let width = frame.right - frame.left;
        let (title, title_colour) = match score {
            Some(score) => (layout.unit.format(score), INK),
            None => ("diverged".to_string(), FAINT_INK),
        };
        let letter = Letter::new(TITLE_SIZE, Weight::Bold, title_colour);
        let mut title_left = frame.left;
        let head_top = frame.top - layout.head;
        if panel.is_best {
            draw_star(canvas, (title_left + 17.0, head_top + 18.0));
            title_left += 40.0;
        }
        let title = shorten(&title, Weight::Bold, TITLE_SIZE, width);
        canvas.text(&title, (title_left, head_top + 27.0), Align::Left, letter);
        let letter = Letter::new(NOTE_SIZE, Weight::Regular, FAINT_INK);
        for (index, line) in panel.note_lines(width).iter().enumerate() {
            let baseline = head_top + TITLE - 11.0 + NOTE_LINE * (index as f64 + 1.0);
            canvas.text(line, (frame.left, baseline), Align::Left, letter);
        }
    }
}

impl Picture for PanelGrid {
    fn check(&self) -> Result<()> {
        picture::check_rows("panels", self.panels.len(), self.columns)
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, self.layout().height.ceil() as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let layout = self.layout();
        let [x_label, y_label] = match layout.is_over_time {
            true => ["time (% of the run)", "x (cm)"],
            false => ["x (cm)", "y (cm)"],
        };
        layout.heading.draw(canvas, MARGIN, 14.0);
        layout.legend.draw(canvas, MARGIN, layout.legend_top);
        for (index, panel) in self.panels.iter().enumerate() {
            let (row, column) = (index / self.columns, index % self.columns);
            let left = layout.left + column as f64 * (layout.panel_width + GAP);
            let top = layout.top
                + layout.head
                + row as f64 * (layout.head + layout.panel_height + ROW_GAP);
            let corner = (left + layout.panel_width, top + layout.panel_height);
            let frame = Frame::new((left, top), corner, [layout.x, layout.y]);
            self.draw_panel(canvas, panel, &frame, &layout);
            // Axes are common: numbers at the left, and below the lowest panel of each column.
            if column == 0 {
                frame.draw_y_axis(canvas, &layout.y_ticks, y_label);
            }
            if index + self.columns >= self.panels.len() {
                frame.draw_x_axis(canvas, &layout.x_ticks, x_label);
            }
        }
    }
}
