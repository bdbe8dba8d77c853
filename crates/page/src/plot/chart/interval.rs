//! Parameters within their searched ranges: which values the recordings allow, and how sure that is.

use crate::plot::kit::*;

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 34.0;
const ROW: f64 = 56.0;
const NAMES: f64 = 440.0;
const VALUES: f64 = 330.0;
const NAME_SIZE: f64 = 21.0;
const VALUE_SIZE: f64 = 19.0;
const END_SIZE: f64 = 16.0;

/// One parameter: its searched range and what is left of it. Places are shares of the searched range, from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParameterInterval {
    /// Name of the parameter.
    pub name: String,
    /// The ends of the searched range, in words with their unit.
    pub ends: [String; 2],
    /// Places of the parts of the 90 % interval, increasing.
    pub intervals: Vec<(f64, f64)>,
    /// Place of the best value.
    pub best: f64,
    /// Place of the known value, where the recordings are stand-ins.
    pub truth: Option<f64>,
    /// Whether the recordings determine it.
    pub is_determined: bool,
    /// What is said of it: `0.17 to 0.20`, `not determined`.
    pub word: String,
}

/// One row for each parameter; every row has the scale of its own searched range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct IntervalChart {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The rows, from top to bottom.
    pub parameters: Vec<ParameterInterval>,
    /// The legend's text for known values.
    pub truth_label: String,
}

impl IntervalChart {
    fn surround(&self) -> HeadingAndLegend {
        let any = |of: fn(&ParameterInterval) -> bool| self.parameters.iter().any(of);
        let has_interval = |determined: bool| {
            let mut all = self.parameters.iter();
            all.any(|p| p.is_determined == determined && !p.intervals.is_empty())
        };
        let entries = [
            (has_interval(true), Symbol::Shade(BLUE), "90 % interval"),
            (
                has_interval(false),
                Symbol::Shade(DIVERGED_LINE),
                "90 % interval, not determined",
            ),
            (any(|p| p.best.is_finite()), Symbol::Star, "best point"),
            (
                any(|p| p.truth.is_some()),
                Symbol::Ring,
                self.truth_label.as_str(),
            ),
            (true, Symbol::Shade(GRID), "searched range"),
        ];
        let shown = entries.into_iter().filter(|(is_shown, ..)| *is_shown);
        let shown = shown.map(|(_, symbol, text)| (symbol, text.to_owned()));
        HeadingAndLegend::new(&self.caption, shown.collect(), WIDTH, MARGIN)
    }
}

impl Picture for IntervalChart {
    fn check(&self) -> Result<()> {
        if self.parameters.is_empty() {
            return Err(Error::invalid("there is nothing to draw").field(&self.caption.title));
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let rows = ROW * self.parameters.len() as f64;
        self.surround().around(WIDTH, rows)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let surround = self.surround();
        surround.draw(canvas, f64::from(self.size().1));
        let (left, right) = (MARGIN + NAMES, WIDTH - MARGIN - VALUES);
        for (index, parameter) in self.parameters.iter().enumerate() {
            let top = surround.top() + ROW * index as f64;
            let middle = top + 19.0;
            let at = |value: f64| left + (right - left) * value.clamp(0.0, 1.0);
            let letter = Letter::new(NAME_SIZE, Weight::Regular, INK);
            let name = shorten(&parameter.name, Weight::Regular, NAME_SIZE, NAMES - 22.0);
            canvas.text_beside(&name, (MARGIN, middle), Align::Left, letter);
            canvas.cell((left, middle - 11.0), (right, middle + 11.0), GRID);
            let colour = match parameter.is_determined {
                true => BLUE,
                false => DIVERGED_LINE,
            };
            for (low, high) in &parameter.intervals {
                // An interval that is narrower than a line stays visible.
                let centre = 0.5 * (at(*low) + at(*high));
                let half = (0.5 * (at(*high) - at(*low))).max(1.5);
                canvas.cell(
                    (centre - half, middle - 11.0),
                    (centre + half, middle + 11.0),
                    colour,
                );
            }
            if let Some(truth) = parameter.truth {
                canvas.ring((at(truth), middle), 9.0, 3.0, VERMILLION);
            }
            if parameter.best.is_finite() {
                draw_star(canvas, (at(parameter.best), middle));
            }
            let letter = Letter::new(END_SIZE, Weight::Regular, FAINT_INK);
            let below = middle + 24.0;
            let [low, high] = &parameter.ends;
            canvas.text_beside(low, (left, below), Align::Left, letter);
            canvas.text_beside(high, (right, below), Align::Right, letter);
            let (weight, colour) = match parameter.is_determined {
                true => (Weight::Bold, INK),
                false => (Weight::Regular, FAINT_INK),
            };
            let letter = Letter::new(VALUE_SIZE, weight, colour);
            let word = shorten(&parameter.word, weight, VALUE_SIZE, VALUES - 22.0);
            canvas.text_beside(&word, (right + 22.0, middle), Align::Left, letter);
        }
    }
}
