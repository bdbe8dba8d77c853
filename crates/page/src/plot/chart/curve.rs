//! Curve: the score over one parameter.

use crate::plot::kit::*;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 800.0;
const MARGIN: f64 = 34.0;
/// Height of the strip at the top of the frame in which diverged points are marked.
const STRIP: f64 = 34.0;

/// A score over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The parameter.
    pub x: AxisSpec,
    /// Values of the parameter, strictly increasing.
    pub x_values: Vec<f64>,
    /// The score at each value; `None` (and anything not finite) is a diverged simulation.
    pub scores: Vec<Option<f64>>,
    /// What the score is, e.g. `PCA discrepancy`.
    pub score_label: String,
    /// Unit in which the scores are given; they are shown in one of handy size.
    pub score_unit: Unit,
    /// How scores become heights; the label of the axis says so.
    pub scale: ScoreScale,
    /// Index of the best point.
    pub best: Option<usize>,
    /// Points that cannot be told from the best; empty for none.
    pub indistinguishable: Vec<bool>,
    /// The true value, where it is known.
    pub truth: Option<Truth>,
}

/// Draws a curve into a PNG or SVG file.
pub fn draw_curve(curve: &Curve, path: impl AsRef<Path>) -> Result<()> {
    curve.check()?;
    picture::write(curve, path.as_ref())
}

impl Curve {
    fn check(&self) -> Result<()> {
        check_values("x_values", &self.x_values)?;
        check_length("scores", self.scores.len(), self.x_values.len())?;
        if !self.indistinguishable.is_empty() {
            let found = self.indistinguishable.len();
            check_length("indistinguishable", found, self.x_values.len())?;
        }
        match self.best {
            Some(best) if best >= self.x_values.len() => {
                Err(Error::invalid("the best point lies outside the values")
                    .field("best")
                    .found(best)
                    .allowed(format!("up to {}", self.x_values.len() - 1)))
            }
            _ => Ok(()),
        }
    }

    fn score(&self, index: usize) -> Option<f64> {
        self.scores[index].filter(|score| score.is_finite())
    }

    fn legend(&self, diverged: usize, unit: DisplayUnit) -> Vec<(Symbol, String)> {
        let best = self.best.map(|best| {
            let place = self.x.at(self.x_values[best]);
            (Symbol::Star, best_text(unit, self.score(best), &place))
        });
        let alike = alike_text(&self.indistinguishable).map(|text| (Symbol::Shade(SHADE), text));
        let lost = (diverged > 0).then(|| (Symbol::Cross, format!("diverged ({diverged})")));
        let truth = self.truth.as_ref().map(|truth| {
            let text = format!("{}: {}", truth.label, self.x.at(truth.x));
            (Symbol::Line(truth_line()), text)
        });
        let all = [best, alike, lost, truth];
        all.into_iter().flatten().collect()
    }

    fn draw_shade(&self, canvas: &mut Canvas, frame: &Frame) {
        let edges = edges(&self.x_values);
        let at = |edge: f64| frame.at_x(edge).clamp(frame.left, frame.right);
        let marked = self.indistinguishable.iter().zip(edges.windows(2));
        for (_, ends) in marked.filter(|(inside, _)| **inside) {
            let (from, to) = (at(ends[0]), at(ends[1]));
            canvas.cell((from, frame.top), (to, frame.bottom), SHADE);
        }
    }

    /// A row of crosses at the top where a simulation diverged.
    fn draw_crosses(&self, canvas: &mut Canvas, whole: &Frame) {
        let mut free_from = f64::NEG_INFINITY;
        for index in (0..self.scores.len()).filter(|&i| self.score(i).is_none()) {
            let x = whole.at_x(self.x_values[index]);
            // A dense row of crosses is as clear as a complete one, and can be read.
            if x >= free_from {
                draw_cross(canvas, (x, whole.top + STRIP / 2.0));
                free_from = x + 20.0;
            }
        }
    }

    fn draw_scores(&self, canvas: &mut Canvas, frame: &Frame, factor: f64) {
        let place = |index: usize| {
            let height = frame.within_y(self.score(index)? * factor);
            Some((frame.at_x(self.x_values[index]), height))
        };
        let points: Vec<_> = (0..self.scores.len()).map(place).collect();
        // A diverged point interrupts the line: nothing is known there.
        for run in points.split(Option::is_none) {
            let run: Vec<_> = run.iter().flatten().copied().collect();
            canvas.path(&run, Stroke::new(3.5, BLUE));
        }
        if points.len() <= 80 {
            for &point in points.iter().flatten() {
                canvas.disc(point, 6.5, WHITE);
                canvas.disc(point, 5.0, BLUE);
            }
        }
        if let Some(point) = self.best.and_then(|best| points[best]) {
            draw_star(canvas, point);
        }
    }
}

fn truth_line() -> Stroke {
    Stroke::new(3.0, VERMILLION).dashed(Some((10.0, 7.0)))
}

impl Picture for Curve {
    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let all = 0..self.scores.len();
        let finite: Vec<f64> = all.filter_map(|i| self.score(i)).collect();
        let diverged = self.scores.len() - finite.len();
        let unit = DisplayUnit::for_values(self.score_unit, finite.iter().copied());
        let shown: Vec<f64> = finite.iter().map(|score| score * unit.factor).collect();
        let y = with_room(Scale::for_scores(&shown, self.scale, AXIS_DECADES));

        let sheet = Sheet::new(&self.caption, self.legend(diverged, unit), WIDTH, MARGIN);
        let bottom = sheet.draw(canvas, HEIGHT);

        let x_edges = edges(&self.x_values);
        let x = Scale::linear(x_edges[0], x_edges[x_edges.len() - 1]);
        let x_ticks = axis::ticks(&self.x, &self.x_values, &x, 9);
        let y_ticks = y.ticks(if finite.is_empty() { 0 } else { 7 });
        let strip = if diverged > 0 { STRIP } else { 0.0 };
        let corner = (WIDTH - MARGIN, bottom - BELOW_LABEL);
        let left = MARGIN + left_of_label(&y_ticks);
        let frame = Frame::new((left, sheet.top() + strip), corner, [x, y]);
        let mut whole = frame;
        whole.top -= strip;
        self.draw_shade(canvas, &whole);
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        let truth = self.truth.iter().map(|truth| truth.x);
        for x in truth.filter(|x| (0.0..=1.0).contains(&frame.x.share(*x))) {
            let x = frame.at_x(x);
            canvas.path(&[(x, whole.top), (x, whole.bottom)], truth_line());
        }
        self.draw_crosses(canvas, &whole);
        self.draw_scores(canvas, &frame, unit.factor);
        whole.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &self.x.title());
        let label = format!("{}{}", unit.label(&self.score_label), y.remark());
        frame.draw_y_axis(canvas, &y_ticks, &label);
        if finite.is_empty() {
            frame.draw_nothing(canvas);
        }
    }
}
