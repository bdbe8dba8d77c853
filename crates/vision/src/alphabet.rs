//! Learns the shapes of characters from a picture, and recognises glyphs by them.

use super::glyph::{Glyph, LEAST_SPOT, inked, rows, without_spots};
use super::picture::Grey;
use realgap_core::error::{Error, Result};

/// A learned character.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    character: char,
    glyph: Glyph,
    /// Distance of its lowest ink below the baseline, pixels.
    below_px: f64,
}

/// The characters that can be recognised, learned from one picture of all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Alphabet {
    known: Vec<Known>,
}

/// Weights of the differences in width, height and position on the baseline between a glyph and a learned character, relative to the
/// difference of shapes. Differences are divided by the size of letters, so that a pixel has the same weight for narrow and wide
/// glyphs.
const WIDTH: f64 = 0.4;
const HEIGHT: f64 = 0.5;
const PLACE: f64 = 0.5;
/// Largest number of glyphs from which the size of the text is estimated.
const TRIED: usize = 40;
/// A gap counts as a space if it exceeds the usual gap by this share of the size of letters; and upper limit of the usual gap, as a
/// share of the size of letters.
const BLANK: f64 = 0.29;
const USUAL_GAP: f64 = 0.25;

/// Root mean square difference of two shapes, which are scaled to the same size.
fn difference(a: &Glyph, b: &Glyph) -> f64 {
    let squares: f64 = a
        .shape
        .iter()
        .zip(&b.shape)
        .map(|(x, y)| f64::from(x - y).powi(2))
        .sum();
    (squares / a.shape.len() as f64).sqrt()
}

/// The upper median of some values; 0 if there are none.
fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl Alphabet {
    /// Learns the characters of a picture whose text is known. Spaces are ignored; if a character occurs several times, the first is
    /// learned.
    ///
    /// # Errors
    /// The number of rows in the picture differs from the number of lines of the text, or the number of glyphs in a row differs from
    /// the number of characters in its line.
    pub fn learn(picture: &Grey, text: &str) -> Result<Self> {
        let ink = without_spots(&inked(picture), LEAST_SPOT);
        let rows = rows(&ink);
        let lines: Vec<Vec<char>> = text
            .lines()
            .map(|line| line.chars().filter(|c| !c.is_whitespace()).collect())
            .filter(|line: &Vec<char>| !line.is_empty())
            .collect();
        let wrong = |what: &str, found: usize, allowed: usize| {
            Error::invalid(format!(
                "the learning picture does not fit its text: {what}"
            ))
            .field("alphabet")
            .found(found)
            .allowed(allowed)
            .hint("print the characters dark on bright, in the order of the text, with gaps between them")
        };
        if rows.len() != lines.len() || lines.is_empty() {
            return Err(wrong("number of rows", rows.len(), lines.len()));
        }
        let mut known: Vec<Known> = Vec::new();
        for (index, (row, line)) in rows.iter().zip(&lines).enumerate() {
            if row.len() != line.len() {
                let what = format!("glyphs of row {}", index + 1);
                return Err(wrong(&what, row.len(), line.len()));
            }
            let stands_on = middle(row.iter().map(|g| g.bottom_px).collect());
            for (glyph, character) in row.iter().zip(line) {
                if known.iter().all(|k| k.character != *character) {
                    known.push(Known {
                        character: *character,
                        glyph: glyph.clone(),
                        below_px: glyph.bottom_px - stands_on,
                    });
                }
            }
        }
        Ok(Self { known })
    }

    /// The characters.
    pub fn characters(&self) -> impl Iterator<Item = char> + '_ {
        self.known.iter().map(|k| k.character)
    }

    /// The text of rows of glyphs. `o` and `O` differ by size only, and `,` and `'` by position only. Size and position are therefore
    /// compared relative to the whole text, whose size is estimated such that all glyphs fit best.
    pub(super) fn read(&self, rows: &[Vec<Glyph>]) -> String {
        let rows: Vec<(&Vec<Glyph>, Vec<Vec<f64>>)> = rows
            .iter()
            .filter(|row| !row.is_empty())
            .map(|row| {
                let costs = row
                    .iter()
                    .map(|g| self.known.iter().map(|k| difference(g, &k.glyph)).collect())
                    .collect();
                (row, costs)
            })
            .collect();
        let scale = self.scale(&rows);
        let lines: Vec<String> = rows
            .iter()
            .map(|(row, costs)| self.line(row, costs, scale))
            .collect();
        lines.join("\n")
    }

    /// Size of the letters in the picture, pixels.
    fn letter_px(&self, scale: f64) -> f64 {
        scale * middle(self.known.iter().map(|k| k.glyph.high_px).collect()).max(1.0)
    }

    fn size_cost(&self, glyph: &Glyph, known: &Known, scale: f64, letter_px: f64) -> f64 {
        let off = |is: f64, was: f64| (is - scale * was).abs() / letter_px;
        WIDTH * off(glyph.wide_px, known.glyph.wide_px)
            + HEIGHT * off(glyph.high_px, known.glyph.high_px)
    }

    /// The size of the text relative to the size of the learned characters.
    fn scale(&self, rows: &[(&Vec<Glyph>, Vec<Vec<f64>>)]) -> f64 {
        let glyphs: Vec<(&Glyph, &Vec<f64>)> = rows
            .iter()
            .flat_map(|(row, costs)| row.iter().zip(costs))
            .collect();
        let total = |scale: f64| {
            let letter_px = self.letter_px(scale);
            glyphs
                .iter()
                .map(|(glyph, costs)| {
                    self.known
                        .iter()
                        .zip(*costs)
                        .map(|(k, cost)| cost + self.size_cost(glyph, k, scale, letter_px))
                        .fold(f64::INFINITY, f64::min)
                })
                .sum::<f64>()
        };
        let every = glyphs.len().div_ceil(TRIED).max(1);
        let mut best = (1.0, f64::INFINITY);
        for (glyph, costs) in glyphs.iter().step_by(every) {
            let mut order: Vec<usize> = (0..costs.len()).collect();
            order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
            for index in order.into_iter().take(3) {
                let scale = glyph.high_px / self.known[index].glyph.high_px.max(0.1);
                let cost = total(scale);
                if cost < best.1 {
                    best = (scale, cost);
                }
            }
        }
        best.0
    }

    fn line(&self, row: &[Glyph], costs: &[Vec<f64>], scale: f64) -> String {
        let letter_px = self.letter_px(scale);
        let pick = |stands_on: Option<f64>| {
            let mut total = 0.0;
            let mut picked = Vec::with_capacity(row.len());
            for (glyph, costs) in row.iter().zip(costs) {
                let mut best = (0, f64::INFINITY);
                for (index, k) in self.known.iter().enumerate() {
                    let place = stands_on.map_or(0.0, |line| {
                        let off = glyph.bottom_px - line - scale * k.below_px;
                        PLACE * off.abs() / letter_px
                    });
                    let size = self.size_cost(glyph, k, scale, letter_px);
                    let cost = costs[index] + size + place;
                    if cost < best.1 {
                        best = (index, cost);
                    }
                }
                total += best.1;
                picked.push(best.0);
            }
            (total, picked)
        };
        let (_, first) = pick(None);
        let mut best = (f64::INFINITY, first.clone());
        for (glyph, index) in row.iter().zip(&first) {
            let stands_on = glyph.bottom_px - scale * self.known[*index].below_px;
            let candidate = pick(Some(stands_on));
            if candidate.0 < best.0 {
                best = candidate;
            }
        }
        let gap =
            |place: usize| row[place].left_px - row[place - 1].left_px - row[place - 1].wide_px;
        let usual = middle((1..row.len()).map(gap).collect()).min(USUAL_GAP * letter_px);
        let mut text = String::new();
        for (place, index) in best.1.iter().enumerate() {
            if place > 0 && gap(place) > usual + BLANK * letter_px {
                text.push(' ');
            }
            text.push(self.known[*index].character);
        }
        text
    }
}
