//! Title and subtitle of a picture.

use plotters::backend::DrawingBackend;

use super::canvas::{Align, Canvas, Letter};
use super::colour::{FAINT_INK, INK};
use super::font::{Weight, wrap};

/// Title sizes to try, largest first: a long title becomes smaller before it is broken into more lines.
const TITLE_SIZES: [f64; 3] = [30.0, 26.0, 22.0];
const TITLE_LINES: usize = 2;
const SUBTITLE_SIZE: f64 = 21.0;
const SUBTITLE_LINES: usize = 2;
const LEADING: f64 = 1.3;

/// What stands above a picture.
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

pub(super) struct Heading {
    lines: Vec<(String, Letter)>,
}

impl Heading {
    pub(super) fn new(caption: &Caption, width: f64) -> Self {
        let Caption { title, subtitle } = caption;
        let set = |size: f64, lines: usize| {
            let letter = Letter::new(size, Weight::Bold, INK);
            let set: Vec<_> = wrap(title, Weight::Bold, size, width, lines)
                .into_iter()
                .map(|line| (line, letter))
                .collect();
            set
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
        lines.extend(
            wrap(
                subtitle,
                Weight::Regular,
                SUBTITLE_SIZE,
                width,
                SUBTITLE_LINES,
            )
            .into_iter()
            .map(|line| (line, letter)),
        );
        Self { lines }
    }

    pub(super) fn height(&self) -> f64 {
        self.lines.iter().map(|(_, l)| LEADING * l.size).sum()
    }

    pub(super) fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<B>, left: f64, top: f64) {
        let mut bottom = top;
        for (line, letter) in &self.lines {
            bottom += LEADING * letter.size;
            canvas.text(
                line,
                (left, bottom - 0.35 * letter.size),
                Align::Left,
                *letter,
            );
        }
    }
}
