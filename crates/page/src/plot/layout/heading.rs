//! Title and subtitle of a picture.

use crate::plot::kit::*;

/// Title sizes to try, largest first: a long title becomes smaller before it is broken into more lines.
const TITLE_SIZES: [f64; 3] = [30.0, 26.0, 22.0];
const TITLE_LINES: usize = 2;
const SUBTITLE_SIZE: f64 = 21.0;
const SUBTITLE_LINES: usize = 2;
const LEADING: f64 = 1.3;

/// The title and the subtitle above a picture.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Caption {
    /// What is shown.
    pub title: String,
    /// Where it comes from, e.g. `stand-in recordings, not hardware`; may be empty.
    pub subtitle: String,
}

impl Caption {
    /// A caption.
    pub fn new(title: impl Into<String>, subtitle: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            subtitle: subtitle.into(),
        }
    }
}

/// A heading and a legend, with the room for a plot between them.
pub(in crate::plot) struct HeadingAndLegend {
    heading: Heading,
    legend: Legend,
    margin: f64,
}

impl HeadingAndLegend {
    pub(in crate::plot) fn new(
        caption: &Caption,
        legend: Vec<(Symbol, String)>,
        width: f64,
        margin: f64,
    ) -> Self {
        Self {
            heading: Heading::new(caption, width - 2.0 * margin),
            legend: Legend::new(legend, width - 2.0 * margin),
            margin,
        }
    }

    /// Upper edge of the room.
    pub(in crate::plot) fn top(&self) -> f64 {
        14.0 + self.heading.height() + 22.0
    }

    /// Size of the picture around a room of this height.
    pub(in crate::plot) fn around(&self, width: f64, room: f64) -> (u32, u32) {
        let height = self.top() + room + 14.0 + self.legend.height() + 16.0;
        (width as u32, height.ceil() as u32)
    }

    /// Draws both into a picture of this height; returns the lower edge of the room.
    pub(in crate::plot) fn draw(&self, canvas: &mut Canvas, height: f64) -> f64 {
        let legend_top = height - 16.0 - self.legend.height();
        self.draw_around(canvas, legend_top - 14.0);
        legend_top - 14.0
    }

    /// Draws both around a room that ends here.
    pub(in crate::plot) fn draw_around(&self, canvas: &mut Canvas, bottom: f64) {
        self.heading.draw(canvas, self.margin, 14.0);
        self.legend.draw(canvas, self.margin, bottom + 14.0);
    }
}

pub(in crate::plot) struct Heading {
    lines: Vec<(String, Letter)>,
}

impl Heading {
    pub(in crate::plot) fn new(caption: &Caption, width: f64) -> Self {
        let Caption { title, subtitle } = caption;
        let set = |size: f64, lines: usize| {
            let letter = Letter::new(size, Weight::Bold, INK);
            let set = wrap(title, Weight::Bold, size, width, lines).into_iter();
            set.map(|line| (line, letter)).collect::<Vec<_>>()
        };
        let is_whole = |lines: &[(String, Letter)]| !lines.iter().any(|(l, _)| l.ends_with('…'));
        let mut lines = set(TITLE_SIZES[2], TITLE_LINES);
        'found: for count in 1..=TITLE_LINES {
            for size in TITLE_SIZES {
                let candidate = set(size, count);
                if is_whole(&candidate) {
                    lines = candidate;
                    break 'found;
                }
            }
        }
        let letter = Letter::new(SUBTITLE_SIZE, Weight::Regular, FAINT_INK);
        let below = wrap(subtitle, letter.weight, letter.size, width, SUBTITLE_LINES);
        lines.extend(below.into_iter().map(|line| (line, letter)));
        Self { lines }
    }

    pub(in crate::plot) fn height(&self) -> f64 {
        self.lines.iter().map(|(_, l)| LEADING * l.size).sum()
    }

    pub(in crate::plot) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        let mut bottom = top;
        for (line, letter) in &self.lines {
            bottom += LEADING * letter.size;
            let baseline = bottom - 0.35 * letter.size;
            canvas.text(line, (left, baseline), Align::Left, *letter);
        }
    }
}
