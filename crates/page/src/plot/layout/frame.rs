//! The frame of a plot: axes with ticks, and where a value lies in the picture.

use crate::plot::kit::*;

pub(in crate::plot) const TICK_SIZE: f64 = 20.0;
pub(in crate::plot) const LABEL_SIZE: f64 = 23.0;
const TICK_LENGTH: f64 = 7.0;
const TICK_GAP: f64 = 6.0;
/// How far a tick label may reach beyond the frame.
const STICK_OUT: f64 = 14.5;

/// Room below a frame for tick labels, and for tick labels with an axis label.
pub(in crate::plot) const BELOW_TICKS: f64 = TICK_LENGTH + TICK_GAP + TICK_SIZE;
pub(in crate::plot) const BELOW_LABEL: f64 = BELOW_TICKS + LABEL_SIZE + 16.0;

/// Room left of a frame for these ticks, and for an axis label as well.
pub(in crate::plot) fn left_of_ticks(ticks: &[Tick]) -> f64 {
    TICK_LENGTH + TICK_GAP + widest(ticks, tick_letter())
}

/// The width of the widest of these ticks' labels.
pub(in crate::plot) fn widest(ticks: &[Tick], letter: Letter) -> f64 {
    let widths = ticks.iter().map(|tick| letter.width(&tick.label));
    widths.fold(0.0, f64::max)
}

pub(in crate::plot) fn left_of_label(ticks: &[Tick]) -> f64 {
    left_of_ticks(ticks) + 14.0 + LABEL_SIZE
}

pub(in crate::plot) fn tick_letter() -> Letter {
    Letter::new(TICK_SIZE, Weight::Regular, INK)
}

pub(in crate::plot) fn label_letter() -> Letter {
    Letter::new(LABEL_SIZE, Weight::Regular, INK)
}

/// A rectangle of the picture with a scale along each side.
#[derive(Debug, Clone, Copy)]
pub(in crate::plot) struct Frame {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
    pub x: Scale,
    pub y: Scale,
}

impl Frame {
    pub(in crate::plot) fn new(
        (left, top): Point,
        (right, bottom): Point,
        [x, y]: [Scale; 2],
    ) -> Self {
        Self {
            left,
            top,
            right,
            bottom,
            x,
            y,
        }
    }

    /// A value's height, at an end of the frame where it lies beyond.
    pub(in crate::plot) fn within_y(&self, value: f64) -> f64 {
        self.bottom - self.y.share(value).clamp(0.0, 1.0) * (self.bottom - self.top)
    }

    /// Writes into the middle of the frame that every simulation diverged.
    pub(in crate::plot) fn draw_nothing(&self, canvas: &mut Canvas) {
        let x = (self.left + self.right) / 2.0;
        let y = (self.top + self.bottom) / 2.0;
        canvas.cell((x - 210.0, y - 30.0), (x + 210.0, y + 30.0), WHITE);
        let letter = Letter::new(28.0, Weight::Bold, FAINT_INK);
        canvas.text_beside("every simulation diverged", (x, y), Align::Centre, letter);
    }

    pub(in crate::plot) fn at_x(&self, value: f64) -> f64 {
        self.left + self.x.share(value) * (self.right - self.left)
    }

    pub(in crate::plot) fn at_y(&self, value: f64) -> f64 {
        self.bottom - self.y.share(value) * (self.bottom - self.top)
    }

    pub(in crate::plot) fn at(&self, (x, y): Point) -> Point {
        (self.at_x(x), self.at_y(y))
    }

    pub(in crate::plot) fn draw_grid(
        &self,
        canvas: &mut Canvas,
        x_ticks: &[Tick],
        y_ticks: &[Tick],
    ) {
        for tick in x_ticks {
            let x = self.at_x(tick.value).round();
            canvas.cell((x, self.top), (x + 1.0, self.bottom), GRID);
        }
        for tick in y_ticks {
            let y = self.at_y(tick.value).round();
            canvas.cell((self.left, y), (self.right, y + 1.0), GRID);
        }
    }

    pub(in crate::plot) fn draw_outline(&self, canvas: &mut Canvas) {
        let from = (self.left.round(), self.top.round());
        canvas.outline(from, (self.right.round(), self.bottom.round()), 2.0, INK);
    }

    pub(in crate::plot) fn draw_x_axis(&self, canvas: &mut Canvas, ticks: &[Tick], label: &str) {
        let letter = tick_letter();
        let mut free_from = f64::NEG_INFINITY;
        for tick in ticks {
            let x = self.at_x(tick.value).round();
            let bottom = self.bottom.round();
            canvas.fill((x - 1.0, bottom), (x + 1.0, bottom + TICK_LENGTH), INK);
            // Labels must not touch each other or those of the next panel: the mark stays, the text
            // gives way.
            let half = letter.width(&tick.label) / 2.0;
            let sticks_out = (x + half - self.right).max(self.left - (x - half));
            if x - half > free_from && sticks_out <= STICK_OUT {
                let anchor = (x, bottom + TICK_LENGTH + TICK_GAP + 0.75 * TICK_SIZE);
                canvas.text(&tick.label, anchor, Align::Centre, letter);
                free_from = x + half + 10.0;
            }
        }
        let middle = (self.left + self.right) / 2.0;
        let label = shorten(label, Weight::Regular, LABEL_SIZE, self.right - self.left);
        let baseline = self.bottom + BELOW_TICKS + 10.0 + 0.75 * LABEL_SIZE;
        canvas.text(&label, (middle, baseline), Align::Centre, label_letter());
    }

    pub(in crate::plot) fn draw_y_axis(&self, canvas: &mut Canvas, ticks: &[Tick], label: &str) {
        let mut free_below = f64::INFINITY;
        for tick in ticks {
            let y = self.at_y(tick.value).round();
            let left = self.left.round();
            canvas.fill((left - TICK_LENGTH, y - 1.0), (left, y + 1.0), INK);
            if y + TICK_SIZE / 2.0 < free_below {
                let anchor = (left - TICK_LENGTH - TICK_GAP, y);
                canvas.text_beside(&tick.label, anchor, Align::Right, tick_letter());
                free_below = y - TICK_SIZE / 2.0 - 2.0;
            }
        }
        let baseline = self.left - left_of_ticks(ticks) - 14.0;
        let middle = (self.top + self.bottom) / 2.0;
        let label = shorten(label, Weight::Regular, LABEL_SIZE, self.bottom - self.top);
        canvas.text_upwards(&label, (baseline, middle), label_letter());
    }
}
