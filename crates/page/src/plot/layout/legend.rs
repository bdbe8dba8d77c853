//! The legend: symbols with a text, in as many rows as they need.

use crate::plot::kit::*;

const SIZE: f64 = 21.0;
const ROW_HEIGHT: f64 = 33.0;
const SYMBOL_WIDTH: f64 = 40.0;
const SYMBOL_GAP: f64 = 10.0;
const ENTRY_GAP: f64 = 34.0;

/// A symbol of the legend.
#[derive(Debug, Clone, Copy)]
pub(in crate::plot) enum Symbol {
    Line(Stroke),
    Star,
    Outline,
    Diverged,
    Cross,
    Ring,
    Start,
    Shade(RGBColor),
    Dot(RGBColor),
    Evaluated,
}

pub(in crate::plot) struct Legend {
    /// Left edge of the symbol, row, symbol, text.
    entries: Vec<(f64, usize, Symbol, String)>,
    rows: usize,
}

impl Legend {
    /// Sets the entries in rows no wider than `width`.
    pub(in crate::plot) fn new(entries: Vec<(Symbol, String)>, width: f64) -> Self {
        let wide = |text: &str| SYMBOL_WIDTH + SYMBOL_GAP + letter().width(text);
        let mut x = 0.0;
        let mut row = 0;
        let mut set: Vec<(f64, usize, Symbol, String)> = Vec::new();
        // Several entries that need several rows stand in columns, which are easier to read.
        let widths = || entries.iter().map(|(_, text)| wide(text));
        let widest = widths().fold(0.0, f64::max);
        let total: f64 = widths().map(|width| width + ENTRY_GAP).sum();
        let fitting = (width + ENTRY_GAP) / (widest + ENTRY_GAP);
        let columns = fitting.floor().max(1.0);
        let is_long = total - ENTRY_GAP > width && entries.len() > 4;
        let column = is_long.then(|| (width + ENTRY_GAP) / columns);
        for (symbol, text) in entries {
            let room = width - SYMBOL_WIDTH - SYMBOL_GAP;
            let text = shorten(&text, Weight::Regular, SIZE, room);
            let entry_width = column.map_or(wide(&text), |c| c - ENTRY_GAP);
            if x > 0.0 && x + entry_width > width + 0.5 {
                x = 0.0;
                row += 1;
            }
            set.push((x, row, symbol, text));
            x += entry_width + ENTRY_GAP;
        }
        let rows = if set.is_empty() { 0 } else { row + 1 };
        Self { entries: set, rows }
    }

    pub(in crate::plot) fn height(&self) -> f64 {
        self.rows as f64 * ROW_HEIGHT
    }

    pub(in crate::plot) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for (x, row, symbol, text) in &self.entries {
            let middle = top + (*row as f64 + 0.5) * ROW_HEIGHT;
            draw_symbol(canvas, *symbol, (left + x, middle));
            let text_x = left + x + SYMBOL_WIDTH + SYMBOL_GAP;
            canvas.text_beside(text, (text_x, middle), Align::Left, letter());
        }
    }
}

/// The text of the legend for the star: the best point.
pub(in crate::plot) fn best_text(unit: DisplayUnit, score: Option<f64>, place: &str) -> String {
    let score = score.map_or("diverged".to_string(), |score| unit.format(score));
    format!("best: {score} at {place}")
}

/// The text of the legend for the confidence set; `None` where the set is empty.
pub(in crate::plot) fn alike_text(indistinguishable: &[bool]) -> Option<String> {
    let any = indistinguishable.contains(&true);
    any.then(|| "95 % confidence set".to_owned())
}

fn letter() -> Letter {
    Letter::new(SIZE, Weight::Regular, INK)
}

fn draw_symbol(canvas: &mut Canvas, symbol: Symbol, (left, middle): Point) {
    let right = left + SYMBOL_WIDTH;
    let centre = (left + SYMBOL_WIDTH / 2.0, middle);
    let (from, to) = ((left + 4.0, middle - 11.0), (right - 4.0, middle + 11.0));
    match symbol {
        Symbol::Line(stroke) => canvas.path(&[(left, middle), (right, middle)], stroke),
        Symbol::Star => draw_star(canvas, centre),
        Symbol::Outline => {
            canvas.cell(from, to, score_colour(0.25));
            canvas.outline(from, to, 6.0, WHITE);
            canvas.outline(from, to, 3.0, INK);
        }
        Symbol::Diverged => {
            draw_diverged(canvas, from, to);
            canvas.outline(from, to, 1.0, DIVERGED_LINE);
        }
        Symbol::Cross => draw_cross(canvas, centre),
        Symbol::Ring => canvas.ring(centre, 12.0, 3.5, VERMILLION),
        Symbol::Start => draw_start(canvas, centre),
        Symbol::Shade(colour) => canvas.cell(from, to, colour),
        Symbol::Evaluated => draw_evaluated(canvas, centre),
        Symbol::Dot(colour) => canvas.disc(centre, 6.0, colour),
    }
}

/// The mark of the best point: visible on every colour.
pub(in crate::plot) fn draw_star(canvas: &mut Canvas, centre: Point) {
    canvas.star(centre, 18.0, INK);
    canvas.star(centre, 11.5, WHITE);
}

/// The mark of a point that was simulated: visible on every colour.
pub(in crate::plot) fn draw_evaluated(canvas: &mut Canvas, centre: Point) {
    canvas.disc(centre, 4.0, WHITE);
    canvas.disc(centre, 2.5, INK);
}

/// The mark of the true values, where they are known: wide enough for a star within it.
pub(in crate::plot) fn draw_ring(canvas: &mut Canvas, centre: Point) {
    canvas.ring(centre, 21.0, 7.0, WHITE);
    canvas.ring(centre, 21.0, 3.5, VERMILLION);
}

/// The mark of the start of a path.
pub(in crate::plot) fn draw_start(canvas: &mut Canvas, centre: Point) {
    canvas.disc(centre, 7.0, INK);
    canvas.disc(centre, 4.0, WHITE);
}

/// The mark of a diverged point of a curve.
pub(in crate::plot) fn draw_cross(canvas: &mut Canvas, (x, y): Point) {
    let r = 7.0;
    for sign in [-1.0, 1.0] {
        let line = [(x - r, y - sign * r), (x + r, y + sign * r)];
        canvas.path(&line, Stroke::new(3.0, DIVERGED_LINE));
    }
}

/// Hatching from corner to corner; neighbouring areas hatch through, as the lines are those of x + y = constant.
pub(in crate::plot) fn draw_diverged(canvas: &mut Canvas, from: Point, to: Point) {
    canvas.cell(from, to, DIVERGED);
    const SPACING: f64 = 9.0;
    let [(x0, y0), (x1, y1)] = [from, to].map(|(x, y)| (x.round(), y.round()));
    let mut sum = ((x0 + y0) / SPACING).ceil() * SPACING;
    while sum < x1 + y1 {
        let start = (sum - y0).min(x1);
        let end = (sum - y1).max(x0);
        if start - end > 0.5 {
            let line = [(start, sum - start), (end, sum - end)];
            canvas.path(&line, Stroke::new(1.2, DIVERGED_LINE));
        }
        sum += SPACING;
    }
}
