//! Corner plot: the distribution of random draws of several quantities, and which of the quantities are correlated.

use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

const MARGIN: f64 = 34.0;
/// All panels together are about this wide, and none of them narrower or wider than this.
const WIDTH: f64 = 1000.0;
const PANEL: std::ops::RangeInclusive<f64> = 34.0..=300.0;
/// A picture of few panels is as wide as its title needs.
const LEAST_WIDTH: f64 = 1200.0;
/// Panels from this width on have numbers, and names in as many lines as they have parts.
const ROOMY: f64 = 140.0;
const GAP: f64 = 6.0;
const NAME_SIZE: f64 = 17.0;
const NUMBER_SIZE: f64 = 15.0;
const LINE: f64 = 21.0;
const TICK: f64 = 6.0;
/// Room around what was drawn, as a share of it.
const ROOM: f64 = 0.05;

/// Draws of several quantities together.
#[derive(Debug, Clone, PartialEq)]
pub struct Corner {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The quantities, at least two.
    pub axes: Vec<AxisSpec>,
    /// One row a draw, one value a quantity.
    pub draws: Vec<Vec<f64>>,
    /// The best values, if any.
    pub best: Option<Vec<f64>>,
    /// True values where they are known, and what the legend calls them.
    pub truth: Option<(Vec<Option<f64>>, String)>,
}

struct Layout {
    surround: HeadingAndLegend,
    scales: Vec<Scale>,
    panel: f64,
    /// Corner of the first panel.
    left: f64,
    top: f64,
    below: f64,
    width: f64,
}

impl Corner {
    fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        self.draws.iter().map(move |draw| draw[axis])
    }

    /// From the least to the greatest draw, the best among them.
    fn scale(&self, axis: usize) -> Scale {
        let best = self.best.iter().map(|best| best[axis]);
        let (low, high) = ends_of(self.values(axis).chain(best));
        let room = ROOM * (high - low);
        Scale::linear(low - room, high + room)
    }

    /// Pearson's correlation; 0 where one of the two does not vary.
    fn correlation(&self, a: usize, b: usize) -> f64 {
        let count = self.draws.len() as f64;
        let mean = |axis| self.values(axis).sum::<f64>() / count;
        let (mean_a, mean_b) = (mean(a), mean(b));
        let pairs = self.values(a).zip(self.values(b));
        let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
        for (a, b) in pairs.map(|(a, b)| (a - mean_a, b - mean_b)) {
            (aa, bb, ab) = (aa + a * a, bb + b * b, ab + a * b);
        }
        match aa * bb > 0.0 {
            true => ab / (aa * bb).sqrt(),
            false => 0.0,
        }
    }

    /// The lines of a name: its parts where there is room for them below each other.
    fn name(&self, axis: usize, panel: f64) -> Vec<String> {
        let title = self.axes[axis].title();
        if panel < ROOMY {
            return vec![title];
        }
        let parts = title.split_inclusive('.');
        let letter = name_letter(panel);
        let lines = parts.map(|part| shorten(part, letter.weight, letter.size, panel));
        lines.collect()
    }

    fn layout(&self) -> Layout {
        let count = self.axes.len() as f64;
        let panel = (WIDTH / count - GAP).clamp(*PANEL.start(), *PANEL.end());
        let panel = panel.floor();
        let scales: Vec<Scale> = (0..self.axes.len()).map(|axis| self.scale(axis)).collect();
        let names = (0..self.axes.len()).map(|axis| self.name(axis, panel));
        let letter = name_letter(panel);
        let (mut beside, mut below) = (0.0_f64, 0.0_f64);
        for (axis, lines) in names.enumerate() {
            if panel < ROOMY {
                let length = letter.width(&lines[0]) + 10.0;
                (beside, below) = (beside.max(length), below.max(length));
                continue;
            }
            let number = widest(&ticks(&scales[axis]), number_letter());
            let tall = LINE * lines.len() as f64 + 12.0;
            beside = beside.max(TICK + 6.0 + number + tall);
            below = below.max(TICK + 8.0 + NUMBER_SIZE + tall);
        }
        let all = count * (panel + GAP) - GAP;
        let width = (2.0 * MARGIN + beside + all).max(LEAST_WIDTH).ceil();
        let surround = HeadingAndLegend::new(&self.caption, self.legend(), width, MARGIN);
        Layout {
            left: (0.5 * (width - beside - all) + beside).round(),
            top: surround.top().round(),
            surround,
            scales,
            panel,
            below,
            width,
        }
    }

    fn legend(&self) -> Vec<(Symbol, String)> {
        let shade = Symbol::Shade(tint(BLUE, 0.6));
        let mut entries = vec![(shade, "the darker, the likelier".to_owned())];
        if self.best.is_some() {
            entries.push((Symbol::Star, "best".to_owned()));
        }
        if let Some((_, label)) = &self.truth {
            entries.push((Symbol::Ring, label.clone()));
        }
        let above = "number: correlation, from -1 to 1";
        entries.push((Symbol::Shade(WHITE), above.replace('-', "−")));
        entries
    }

    /// The share of the fullest cell that each cell of a square holds, row by row from below.
    fn density(&self, [x, y]: [usize; 2], scales: &[Scale], bins: usize) -> Vec<f64> {
        let mut counts = vec![0_u32; bins * bins];
        for draw in &self.draws {
            let [column, row] = [x, y].map(|axis| bin(&scales[axis], draw[axis], bins));
            counts[row * bins + column] += 1;
        }
        shares(&counts)
    }

    fn draw_panel(&self, canvas: &mut Canvas, layout: &Layout, [row, column]: [usize; 2]) {
        let panel = layout.panel;
        let step = panel + GAP;
        let left = layout.left + step * column as f64;
        let top = layout.top + step * row as f64;
        let flat = Scale::linear(0.0, 1.15);
        let (x, y) = (layout.scales[column], layout.scales[row]);
        let upright = if row == column { flat } else { y };
        let frame = Frame::new((left, top), (left + panel, top + panel), [x, upright]);
        let bins = ((panel / 9.0) as usize).clamp(6, 24);
        let wide = panel / bins as f64;
        match row.cmp(&column) {
            std::cmp::Ordering::Less => {
                let r = self.correlation(row, column);
                let colour = tint(correlated(r), 0.5 * r.abs());
                canvas.fill((left, top), (left + panel, top + panel), colour);
                let size = (0.36 * panel).min(26.0);
                let letter = Letter::new(size, Weight::Regular, INK);
                let text = format!("{r:.2}").replace("-0.00", "0.00").replace('-', "−");
                let centre = (left + 0.5 * panel, top + 0.5 * panel);
                canvas.text_beside(&text, centre, Align::Centre, letter);
                return;
            }
            std::cmp::Ordering::Equal => {
                let mut counts = vec![0_u32; bins];
                for value in self.values(row) {
                    counts[bin(&x, value, bins)] += 1;
                }
                for (k, share) in shares(&counts).into_iter().enumerate() {
                    let from = (left + wide * k as f64, frame.at_y(share));
                    canvas.cell(from, (from.0 + wide, frame.bottom), tint(BLUE, 0.6));
                }
            }
            std::cmp::Ordering::Greater => {
                let density = self.density([column, row], &layout.scales, bins);
                for (k, share) in density.into_iter().enumerate() {
                    if share > 0.0 {
                        let (x, y) = ((k % bins) as f64, (k / bins) as f64);
                        let from = (left + wide * x, frame.bottom - wide * (y + 1.0));
                        let colour = tint(BLUE, 0.15 + 0.85 * share);
                        canvas.cell(from, (from.0 + wide, from.1 + wide), colour);
                    }
                }
            }
        }
        self.draw_marks(canvas, &frame, [row, column]);
        let corner = (frame.right, frame.bottom);
        canvas.outline((left, top), corner, 1.5, FAINT_INK);
    }

    /// The best and the true values: a line on the diagonal, a mark below it.
    fn draw_marks(&self, canvas: &mut Canvas, frame: &Frame, [row, column]: [usize; 2]) {
        let is_in = |scale: &Scale, value: f64| (0.0..=1.0).contains(&scale.share(value));
        let upright = |canvas: &mut Canvas, value: f64, colour| {
            let x = frame.at_x(value);
            let ends = [(x, frame.top), (x, frame.bottom)];
            canvas.path(&ends, Stroke::new(2.0, colour));
        };
        let truth = self.truth.as_ref().map(|(values, _)| values);
        let truth = truth.and_then(|values| Some([(*values.get(column)?)?, (*values.get(row)?)?]));
        if let Some([x, y]) = truth.filter(|[x, _]| is_in(&frame.x, *x)) {
            if row == column {
                upright(canvas, x, VERMILLION);
            } else if is_in(&frame.y, y) {
                let size = (0.06 * (frame.right - frame.left)).clamp(3.0, 12.0);
                canvas.ring(frame.at((x, y)), size, (0.3 * size).max(1.5), VERMILLION);
            }
        }
        if let Some(best) = &self.best {
            if row == column {
                upright(canvas, best[column], INK);
            } else {
                let at = frame.at((best[column], best[row]));
                let size = (0.09 * (frame.right - frame.left)).clamp(4.0, 18.0);
                canvas.star(at, size, INK);
                canvas.star(at, 0.64 * size, WHITE);
            }
        }
    }

    /// Numbers and names left of the first column and below the last row.
    fn draw_axes(&self, canvas: &mut Canvas, layout: &Layout) {
        let (panel, step) = (layout.panel, layout.panel + GAP);
        let last = layout.top + step * self.axes.len() as f64 - GAP;
        let letter = name_letter(panel);
        for (axis, scale) in layout.scales.iter().enumerate() {
            let left = layout.left + step * axis as f64;
            let top = layout.top + step * axis as f64;
            let (mid_x, mid_y) = (left + 0.5 * panel, top + 0.5 * panel);
            let lines = self.name(axis, panel);
            if panel < ROOMY {
                let beside = (layout.left - 8.0, mid_y);
                canvas.text_beside(&lines[0], beside, Align::Right, letter);
                let half = 0.5 * letter.width(&lines[0]);
                let baseline = mid_x + 0.35 * letter.size;
                canvas.text_upwards(&lines[0], (baseline, last + 8.0 + half), letter);
                continue;
            }
            let numbers = ticks(scale);
            let letter_of_number = number_letter();
            let mut widest = 0.0_f64;
            for tick in &numbers {
                let share = scale.share(tick.value);
                let half = 0.5 * letter_of_number.width(&tick.label);
                let x = left + share * panel;
                canvas.fill((x - 1.0, last), (x + 1.0, last + TICK), INK);
                // Names of neighbours must not touch.
                if x - half >= left && x + half <= left + panel {
                    let at = (x, last + TICK + 4.0 + NUMBER_SIZE);
                    canvas.text(&tick.label, at, Align::Centre, letter_of_number);
                }
                // The first quantity's own axis has no panel left of it: its diagonal counts draws.
                if axis > 0 {
                    let y = top + (1.0 - share) * panel;
                    let edge = layout.left;
                    canvas.fill((edge - TICK, y - 1.0), (edge, y + 1.0), INK);
                    let at = (edge - TICK - 4.0, y);
                    canvas.text_beside(&tick.label, at, Align::Right, letter_of_number);
                    widest = widest.max(2.0 * half);
                }
            }
            for (line, text) in lines.iter().enumerate() {
                let down = TICK + 8.0 + NUMBER_SIZE + LINE * (line as f64 + 1.0);
                canvas.text(text, (mid_x, last + down), Align::Centre, letter);
                let back = LINE * (lines.len() - 1 - line) as f64;
                let baseline = layout.left - TICK - 6.0 - widest - 8.0 - back;
                canvas.text_upwards(text, (baseline, mid_y), letter);
            }
        }
    }
}

impl Picture for Corner {
    fn check(&self) -> Result<()> {
        for (field, found) in [("axes", self.axes.len()), ("draws", self.draws.len())] {
            if found < 2 {
                let error = Error::invalid("a corner needs at least two of each");
                return Err(error.field(field).found(found));
            }
        }
        let best = self.best.iter();
        for row in self.draws.iter().chain(best) {
            check_length("draws", row.len(), self.axes.len())?;
            if let Some(value) = row.iter().find(|value| !value.is_finite()) {
                let error = Error::invalid("draws must be finite");
                return Err(error.field("draws").found(value));
            }
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let layout = self.layout();
        let all = self.axes.len() as f64 * (layout.panel + GAP) - GAP;
        layout.surround.around(layout.width, all + layout.below)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let layout = self.layout();
        layout.surround.draw(canvas, f64::from(self.size().1));
        for row in 0..self.axes.len() {
            for column in 0..self.axes.len() {
                self.draw_panel(canvas, &layout, [row, column]);
            }
        }
        self.draw_axes(canvas, &layout);
    }
}

fn name_letter(panel: f64) -> Letter {
    let size = match panel < ROOMY {
        true => (0.5 * panel).min(NAME_SIZE),
        false => NAME_SIZE,
    };
    Letter::new(size, Weight::Regular, INK)
}

fn number_letter() -> Letter {
    Letter::new(NUMBER_SIZE, Weight::Regular, INK)
}

fn ticks(scale: &Scale) -> Vec<Tick> {
    // One number alone does not show the scale.
    let mut tries = (3..=6).map(|count| scale.ticks(count));
    let enough = tries.find(|ticks| ticks.len() > 1);
    enough.unwrap_or_else(|| scale.ticks(3))
}

/// The colour of a correlation of this sign.
fn correlated(r: f64) -> RGBColor {
    if r < 0.0 { VERMILLION } else { BLUE }
}

/// Which of so many equal parts of a scale holds a value.
fn bin(scale: &Scale, value: f64, bins: usize) -> usize {
    ((scale.share(value) * bins as f64) as usize).min(bins - 1)
}

/// Counts as shares of the greatest.
fn shares(counts: &[u32]) -> Vec<f64> {
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let counts = counts.iter();
    counts.map(|n| f64::from(*n) / f64::from(most)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::check;

    /// Draws in which the second goes against the first, and all others are on their own.
    fn corner(names: &[&str]) -> Corner {
        // Sums of two evenly spread numbers: triangles, each axis on its own.
        let spread = |k: usize, axis: usize| {
            let step = |n: usize| (k as f64 * (n as f64).sqrt()).fract();
            step(4 * axis * axis + 2) + step(4 * axis * axis + 3)
        };
        let value = |k: usize, axis: usize| match axis {
            1 => 3.0 - spread(k, 0) + 0.1 * spread(k, 1),
            axis => spread(k, axis),
        };
        let draws = (0..400).map(|k| (0..names.len()).map(|axis| value(k, axis)).collect());
        Corner {
            caption: Caption::new("which values go together", "400 draws"),
            axes: names
                .iter()
                .map(|name| AxisSpec::new(*name, Unit::One))
                .collect(),
            draws: draws.collect(),
            best: Some(vec![1.0; names.len()]),
            truth: None,
        }
    }

    #[test]
    fn every_pair_has_a_panel_and_its_correlation() {
        let three = corner(&["floor.friction", "floor.restitution", "servo.gain_1_s"]);
        let svg = check("corner", |path| picture::write(&three, path));
        assert!(three.correlation(0, 1) < -0.95 && three.correlation(0, 2).abs() < 0.3);
        let r = format!(">\n{:.2}\n<", three.correlation(0, 1)).replace('-', "−");
        assert!(svg.contains(&r), "{r}");
        // Each name stands below its column and beside its row, in parts.
        for part in ["friction", "restitution", "gain_1_s"] {
            assert_eq!(svg.matches(&format!("\n{part}\n")).count(), 2, "{part}");
        }
        let two = corner(&["floor.friction", "module.leg.mass_kg"]);
        let truth = (vec![Some(1.2), None], "hidden value".to_owned());
        let known = Corner {
            truth: Some(truth),
            ..two
        };
        assert!(check("corner_two", |path| picture::write(&known, path)).contains("hidden value"));
    }

    #[test]
    fn thirty_quantities_are_all_named() {
        let names: Vec<String> = (0..30)
            .map(|k| format!("servo.joint_{k:02}.stiffness_nm_rad"))
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let svg = check("corner_thirty", |path| {
            picture::write(&corner(&names), path)
        });
        for name in names {
            assert_eq!(svg.matches(name).count(), 2, "{name}");
        }
    }

    #[test]
    fn what_does_not_vary_is_drawn_and_what_is_missing_refused() {
        let mut still = corner(&["a", "b"]);
        still.draws.iter_mut().for_each(|draw| draw[1] = 2.0);
        assert_eq!(still.correlation(0, 1), 0.0);
        check("corner_still", |path| picture::write(&still, path));
        still.draws[3][0] = f64::NAN;
        assert!(picture::write(&still, Path::new("x.png")).is_err());
        assert!(picture::write(&corner(&["a"]), Path::new("x.png")).is_err());
    }
}
