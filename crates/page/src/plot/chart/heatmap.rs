//! Heat map: the score over two parameters, with the best point and the confidence set: the values that cannot be told from
//! the best.

use crate::plot::kit::*;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 950.0;
const MARGIN: f64 = 34.0;
const BAR_GAP: f64 = 30.0;
const BAR_WIDTH: f64 = 34.0;

/// A heat map; the point (ix, iy) has index `iy * x_values.len() + ix` in `scores` and
/// `indistinguishable`.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The horizontal parameter.
    pub x: AxisSpec,
    /// The vertical parameter.
    pub y: AxisSpec,
    /// Values of the horizontal parameter, strictly increasing.
    pub x_values: Vec<f64>,
    /// Values of the vertical parameter, strictly increasing.
    pub y_values: Vec<f64>,
    /// Row by row, `x` fastest; `None` (and anything not finite) is no score, e.g. a diverged simulation.
    pub scores: Vec<Option<f64>>,
    /// What points without a score are called, e.g. `diverged`.
    pub missing: String,
    /// What the score is, e.g. `PCA discrepancy`.
    pub score_label: String,
    /// Unit in which the scores are given; they are shown in one of handy size.
    pub score_unit: Unit,
    /// How scores become colours; the label of the colour bar says so.
    pub scale: ScoreScale,
    /// The score from which on all cells have the last colour; `None` for none. The label of the colour bar says so.
    pub colours_to: Option<f64>,
    /// (ix, iy) of the best point.
    pub best: Option<(usize, usize)>,
    /// Where the best point lies, if not in the middle of its cell.
    pub best_at: Option<(f64, f64)>,
    /// Its score, if not that of its cell.
    pub best_score: Option<f64>,
    /// Points that cannot be told from the best, in the order of `scores`; empty for none.
    pub indistinguishable: Vec<bool>,
    /// The true values, where they are known.
    pub truth: Option<Truth>,
    /// Where the scores come from, if that is not every cell: each point gets a dot.
    pub evaluated: Vec<(f64, f64)>,
    /// Whether bright cells have large scores, as a fitness has; otherwise bright cells have small scores, as a distance has.
    pub larger_is_better: bool,
    /// The row of a table of points that each cell shows, in the order of `scores`, so that a page can choose the point;
    /// empty for none.
    pub table_rows: Vec<Option<usize>>,
    /// Lines above the cells, in the units of the axes: walls of a map.
    pub lines: Vec<Vec<(f64, f64)>>,
}

impl HeatMap {
    /// A map of scores over two axes with their values, and what they are with their unit; without any mark.
    pub fn new(
        caption: Caption,
        [(x, x_values), (y, y_values)]: [(AxisSpec, Vec<f64>); 2],
        scores: Vec<Option<f64>>,
        (score_label, score_unit): (&str, Unit),
    ) -> Self {
        Self {
            caption,
            x,
            y,
            x_values,
            y_values,
            scores,
            missing: "diverged".to_owned(),
            score_label: score_label.to_owned(),
            score_unit,
            scale: ScoreScale::Auto,
            colours_to: None,
            best: None,
            best_at: None,
            best_score: None,
            indistinguishable: Vec::new(),
            truth: None,
            evaluated: Vec::new(),
            larger_is_better: false,
            table_rows: Vec::new(),
            lines: Vec::new(),
        }
    }
}

/// Draws a heat map into a PNG or SVG file.
#[cfg(feature = "papers")]
pub fn draw_heat_map(map: &HeatMap, path: impl AsRef<Path>) -> Result<()> {
    picture::write(map, path.as_ref())
}

impl HeatMap {
    pub(in crate::plot) fn score(&self, ix: usize, iy: usize) -> Option<f64> {
        self.scores[iy * self.x_values.len() + ix].filter(|score| score.is_finite())
    }

    /// Where the best point lies, which is in the cell (ix, iy).
    pub(in crate::plot) fn place(&self, ix: usize, iy: usize) -> (f64, f64) {
        let middle = (self.x_values[ix], self.y_values[iy]);
        self.best_at.unwrap_or(middle)
    }

    pub(in crate::plot) fn is_indistinguishable(&self, ix: usize, iy: usize) -> bool {
        let (columns, rows) = (self.x_values.len(), self.y_values.len());
        let is_cell = ix < columns && iy < rows;
        is_cell && self.indistinguishable.get(iy * columns + ix) == Some(&true)
    }

    pub(in crate::plot) fn finite_scores(&self) -> Vec<f64> {
        let finite = self.scores.iter().copied().flatten();
        finite.filter(|score| score.is_finite()).collect()
    }

    /// The unit in which these scores read well, and the scale of their colours in it.
    pub(in crate::plot) fn score_scale(&self, finite: &[f64]) -> (DisplayUnit, Scale) {
        let unit = DisplayUnit::for_values(self.score_unit, finite.iter().copied());
        let end = self.colours_to.unwrap_or(f64::INFINITY);
        let within = finite.iter().map(|score| score.min(end));
        let shown: Vec<f64> = within.map(|score| score * unit.factor).collect();
        let mut scale = Scale::for_scores(&shown, self.scale, COLOUR_DECADES);
        scale.is_cut = finite.iter().any(|score| *score > end);
        (unit, scale)
    }

    /// The scales of both axes, from the outer edge of the first cell to that of the last.
    pub(in crate::plot) fn scales(&self) -> [Scale; 2] {
        [&self.x_values, &self.y_values].map(|values| {
            let edges = edges(values);
            Scale::linear(edges[0], edges[edges.len() - 1])
        })
    }

    /// About so many ticks of both axes.
    pub(in crate::plot) fn ticks(&self, [x, y]: [&Scale; 2], counts: [usize; 2]) -> [Vec<Tick>; 2] {
        [
            axis::ticks(&self.x, &self.x_values, x, counts[0]),
            axis::ticks(&self.y, &self.y_values, y, counts[1]),
        ]
    }

    fn legend(&self, finite: &[f64], unit: DisplayUnit) -> Vec<(Symbol, String)> {
        let best = self.best.map(|(ix, iy)| {
            let (x, y) = self.place(ix, iy);
            let place = format!("{}, {}", self.x.at(x), self.y.at(y));
            best_text(unit, self.best_score.or(self.score(ix, iy)), &place)
        });
        let best = best.map(|text| (Symbol::Star, text));
        let alike = alike_text(&self.indistinguishable).map(|text| {
            let count = self.indistinguishable.iter().filter(|is| **is).count();
            let all = self.scores.len();
            // Where most cells belong to the set, what is outlined are its holes.
            let part = match 2 * count > all && count < all {
                true => ", all but the outlined patches",
                false => "",
            };
            (
                Symbol::Outline,
                format!("{text} ({count} of {all} cells{part})"),
            )
        });
        let mut entries: Vec<_> = best.into_iter().chain(alike).collect();
        if !self.evaluated.is_empty() {
            let text = format!("evaluated ({})", self.evaluated.len());
            entries.push((Symbol::Evaluated, text));
        }
        let diverged = self.scores.len() - finite.len();
        if diverged > 0 {
            entries.push((Symbol::Diverged, format!("{} ({diverged})", self.missing)));
        }
        if let Some(truth) = &self.truth {
            let place = format!("{}, {}", self.x.at(truth.x), self.y.at(truth.y));
            entries.push((Symbol::Ring, format!("{}: {place}", truth.label)));
        }
        entries
    }

    pub(in crate::plot) fn colour(&self, share: f64) -> RGBColor {
        let is_turned = self.larger_is_better;
        score_colour(if is_turned { 1.0 - share } else { share })
    }

    fn draw_cells(&self, canvas: &mut Canvas, frame: &Frame, scores: &Scale, factor: f64) {
        let (xs, ys) = (edges(&self.x_values), edges(&self.y_values));
        let xs: Vec<f64> = xs.iter().map(|&x| frame.at_x(x)).collect();
        let ys: Vec<f64> = ys.iter().map(|&y| frame.at_y(y)).collect();
        for iy in 0..self.y_values.len() {
            let colour = |ix| Some(self.colour(scores.share(self.score(ix, iy)? * factor)));
            let mut start = 0;
            while start < self.x_values.len() {
                // Neighbours of one look become one area: smaller files, no seams.
                let look = colour(start);
                let mut end = start + 1;
                while end < self.x_values.len() && colour(end) == look {
                    end += 1;
                }
                let (from, to) = ((xs[start], ys[iy + 1]), (xs[end], ys[iy]));
                match look {
                    Some(colour) => canvas.cell(from, to, colour),
                    None => draw_diverged(canvas, from, to),
                }
                start = end;
            }
        }
        self.draw_boundary(canvas, frame);
    }

    /// The outline of the confidence set: edges between cells inside it and cells outside it, in the units of the axes.
    pub(in crate::plot) fn boundary(&self) -> Vec<(Point, Point)> {
        let (xs, ys) = (edges(&self.x_values), edges(&self.y_values));
        let mut outline = Vec::new();
        for iy in 0..self.y_values.len() {
            for ix in 0..self.x_values.len() {
                if !self.is_indistinguishable(ix, iy) {
                    continue;
                }
                let ([left, right], [low, high]) = ([xs[ix], xs[ix + 1]], [ys[iy], ys[iy + 1]]);
                // Before the first column and row is nothing: their number wraps to one that no cell has.
                for (x, y, from, to) in [
                    (ix.wrapping_sub(1), iy, (left, low), (left, high)),
                    (ix + 1, iy, (right, low), (right, high)),
                    (ix, iy.wrapping_sub(1), (left, low), (right, low)),
                    (ix, iy + 1, (left, high), (right, high)),
                ] {
                    if !self.is_indistinguishable(x, y) {
                        outline.push((from, to));
                    }
                }
            }
        }
        outline
    }

    /// Draws the outline of the confidence set.
    fn draw_boundary(&self, canvas: &mut Canvas, frame: &Frame) {
        let outline = self.boundary();
        for (width, colour) in [(6.0, WHITE), (3.0, INK)] {
            let half = width / 2.0;
            for &(from, to) in &outline {
                let [(x0, y0), (x1, y1)] = [from, to].map(|place| {
                    let (x, y) = frame.at(place);
                    (x.round(), y.round())
                });
                let low = (x0.min(x1) - half, y0.min(y1) - half);
                canvas.fill(low, (x0.max(x1) + half, y0.max(y1) + half), colour);
            }
        }
    }

    fn draw_marks(&self, canvas: &mut Canvas, frame: &Frame) {
        for line in &self.lines {
            let inside = line.iter().map(|&(x, y)| {
                let [left, right] = [frame.x.low, frame.x.high];
                let [low, high] = [frame.y.low, frame.y.high];
                frame.at((x.clamp(left, right), y.clamp(low, high)))
            });
            let points: Vec<_> = inside.collect();
            for (width, colour) in [(6.0, WHITE), (3.0, INK)] {
                canvas.path(&points, Stroke::new(width, colour));
            }
        }
        let is_inside = |(x, y): Point| {
            let shares = [frame.x.share(x), frame.y.share(y)];
            shares.iter().all(|share| (0.0..=1.0).contains(share))
        };
        for &place in self.evaluated.iter().filter(|place| is_inside(**place)) {
            draw_evaluated(canvas, frame.at(place));
        }
        let truth = self.truth.as_ref().map(|truth| (truth.x, truth.y));
        if let Some(truth) = truth.filter(|truth| is_inside(*truth)) {
            draw_ring(canvas, frame.at(truth));
        }
        if let Some((ix, iy)) = self.best {
            draw_star(canvas, frame.at(self.place(ix, iy)));
        }
    }
}

impl Picture for HeatMap {
    fn check(&self) -> Result<()> {
        check_values("x_values", &self.x_values)?;
        check_values("y_values", &self.y_values)?;
        let points = self.x_values.len() * self.y_values.len();
        check_length("scores", self.scores.len(), points)?;
        let marks = [
            ("indistinguishable", self.indistinguishable.len()),
            ("table_rows", self.table_rows.len()),
        ];
        for (field, length) in marks.into_iter().filter(|(_, length)| *length > 0) {
            check_length(field, length, points)?;
        }
        let (last_x, last_y) = (self.x_values.len() - 1, self.y_values.len() - 1);
        if let Some((ix, iy)) = self.best.filter(|b| b.0 > last_x || b.1 > last_y) {
            return Err(Error::invalid("the best point lies outside the grid")
                .field("best")
                .found(format!("({ix}, {iy})"))
                .allowed(format!("up to ({last_x}, {last_y})")));
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let finite = self.finite_scores();
        let (unit, scores) = self.score_scale(&finite);
        let bar_ticks = scores.ticks(7);

        let surround =
            HeadingAndLegend::new(&self.caption, self.legend(&finite, unit), WIDTH, MARGIN);
        let bottom = surround.draw(canvas, HEIGHT);

        let [x, y] = self.scales();
        let [x_ticks, y_ticks] = self.ticks([&x, &y], [7, 8]);
        let right_of_frame = match finite.is_empty() {
            true => 30.0,
            false => BAR_GAP + BAR_WIDTH + left_of_ticks(&bar_ticks) + 12.0 + LABEL_SIZE,
        };
        let left = MARGIN + left_of_label(&y_ticks);
        let right = WIDTH - MARGIN + 8.0 - right_of_frame;
        let frame = Frame::new(
            (left, surround.top()),
            (right, bottom - BELOW_LABEL),
            [x, y],
        );
        self.draw_cells(canvas, &frame, &scores, unit.factor);
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &self.x.title());
        frame.draw_y_axis(canvas, &y_ticks, &self.y.title());
        self.draw_marks(canvas, &frame);
        if finite.is_empty() {
            frame.draw_nothing(canvas);
        } else {
            let label = format!("{}{}", unit.label(&self.score_label), scores.remark());
            self.draw_colour_bar(canvas, &frame, &scores, &bar_ticks, &label);
        }
    }
}

impl HeatMap {
    fn draw_colour_bar(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        scores: &Scale,
        ticks: &[Tick],
        label: &str,
    ) {
        let bar = Frame {
            left: (frame.right + BAR_GAP).round(),
            right: (frame.right + BAR_GAP).round() + BAR_WIDTH,
            y: *scores,
            ..*frame
        };
        let (top, bottom) = (bar.top.round(), bar.bottom.round());
        let steps = (bottom - top).max(1.0) as usize;
        for step in 0..steps {
            let y = top + step as f64;
            let share = 1.0 - (step as f64 + 0.5) / steps as f64;
            canvas.cell((bar.left, y), (bar.right, y + 1.0), self.colour(share));
        }
        bar.draw_outline(canvas);
        for tick in ticks {
            let y = bar.at_y(tick.value).round();
            canvas.fill((bar.right, y - 1.0), (bar.right + 7.0, y + 1.0), INK);
            let anchor = (bar.right + 13.0, y);
            canvas.text_beside(&tick.label, anchor, Align::Left, tick_letter());
        }
        let baseline = bar.right + left_of_ticks(ticks) + 12.0 + 0.8 * LABEL_SIZE;
        let middle = (bar.top + bar.bottom) / 2.0;
        let label = shorten(label, Weight::Regular, LABEL_SIZE, bottom - top);
        canvas.text_upwards(&label, (baseline, middle), label_letter());
    }
}
