//! Ensemble: many repeats of one experiment, coloured by behaviour, with their envelope over time and the real runs.

use crate::plot::kit::*;
use crate::plot::{LinePlot, Series, SeriesKind};
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1260.0;
const MARGIN: f64 = 32.0;
const GAP: f64 = 26.0;
/// Height of the frame of paths as a share of its width.
const SHAPE: std::ops::RangeInclusive<f64> = 0.25..=0.62;
/// Height of the frames over time.
const OVER_TIME: f64 = 260.0;
const CM_PER_M: f64 = 100.0;

/// The prediction without noise.
fn noise_free() -> Stroke {
    Stroke::new(3.5, INK).dashed(Some((13.0, 8.0)))
}

/// The ends of the band that whole paths stay in.
fn whole_path() -> Stroke {
    Stroke::new(2.2, BLUE).dashed(Some((5.0, 4.0)))
}

/// Repeats with the same behaviour.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleGroup {
    /// Its name and how likely it is, for the legend.
    pub label: String,
    /// Paths of its repeats (or of some of them), metres.
    pub paths_m: Vec<Vec<PathPoint>>,
    /// The typical path of the group, metres; may be empty.
    pub representative_m: Vec<PathPoint>,
}

/// A region over time, as its extent along x and along y.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleBand {
    /// The share of repeats that the region should contain, from 0 to 1.
    pub level: f64,
    /// Lower ends at each time, metres.
    pub low_m: Vec<PathPoint>,
    /// Upper ends at each time, metres.
    pub high_m: Vec<PathPoint>,
}

/// An ensemble as a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsemblePlot {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The behaviours, in the order of the legend.
    pub groups: Vec<EnsembleGroup>,
    /// Path of the run without noise, metres; may be empty.
    pub noise_free_m: Vec<PathPoint>,
    /// Real paths, metres.
    pub real_m: Vec<Vec<PathPoint>>,
    /// What the legend calls them, e.g. `stand-in for reality`.
    pub real_label: String,
    /// Times of the points of all paths and bands, seconds.
    pub times_s: Vec<f64>,
    /// Regions for each time, the widest first.
    pub bands: Vec<EnsembleBand>,
    /// The band that whole paths stay in.
    pub whole_paths: Option<EnsembleBand>,
}

/// The colour of a band: the more repeats it should contain, the paler. From 45 % of blue for half of them to 10 % for 90 %.
fn shade(level: f64) -> RGBColor {
    tint(BLUE, (0.45 - 0.875 * (level - 0.5)).clamp(0.08, 0.6))
}

impl EnsemblePlot {
    /// The typical paths from above, and the regions along x and along y over time, as charts of their own.
    pub(crate) fn charts(&self) -> [LinePlot; 3] {
        let groups = self.groups.iter().enumerate().rev();
        let mut typical: Vec<Series> = groups
            .map(|(index, group)| {
                let points = group.representative_m.iter().map(|[x, y]| (*x, *y));
                let kind = SeriesKind::Line;
                Series::new(group.label.clone(), kind, points.collect()).colour(index)
            })
            .collect();
        let x = AxisSpec::new("x", Unit::Metre);
        let mut paths = LinePlot::new(self.caption.clone(), x, ("y", Unit::Metre), Vec::new());
        paths.scale = ScoreScale::LikeX;
        paths.series.append(&mut typical);
        let over_time = |axis: usize| {
            let along = |edge: &[PathPoint]| -> Vec<f64> { edge.iter().map(|p| p[axis]).collect() };
            let mut series = Vec::new();
            // The widest band and the narrowest one: a page has no room for all.
            let bands = [self.bands.first(), self.bands.last()];
            for band in bands.into_iter().flatten() {
                let low = self.times_s.iter().copied().zip(along(&band.low_m));
                let kind = SeriesKind::Band(along(&band.high_m));
                series.push(Series::new("", kind, low.collect()));
            }
            if let Some(band) = self.bands.last() {
                let middle = band.low_m.iter().zip(&band.high_m);
                let middle = middle.map(|(low, high)| 0.5 * (low[axis] + high[axis]));
                let points = self.times_s.iter().copied().zip(middle).collect();
                series.push(Series::new("", SeriesKind::Line, points));
            }
            let time = AxisSpec::new("time", Unit::Second);
            let y = (["x", "y"][axis], Unit::Metre);
            LinePlot::new(self.caption.clone(), time, y, series)
        };
        [paths, over_time(0), over_time(1)]
    }

    fn heading_and_legend(&self) -> HeadingAndLegend {
        let mut entries = Vec::new();
        for (index, group) in self.groups.iter().enumerate() {
            entries.push((Symbol::Line(stroke_of(index, 4.5)), group.label.clone()));
        }
        if !self.noise_free_m.is_empty() {
            entries.push((Symbol::Line(noise_free()), "without noise".to_owned()));
        }
        if !self.real_m.is_empty() {
            let text = format!("{} ({})", self.real_label, self.real_m.len());
            entries.push((Symbol::Line(Stroke::new(1.8, INK)), text));
        }
        for band in self.bands.iter().rev() {
            let text = format!("{:.0} % of the repeats, at each time", 100.0 * band.level);
            entries.push((Symbol::Shade(shade(band.level)), text));
        }
        if let Some(band) = &self.whole_paths {
            let text = format!("{:.0} % of whole paths stay inside", 100.0 * band.level);
            entries.push((Symbol::Line(whole_path()), text));
        }
        HeadingAndLegend::new(&self.caption, entries, WIDTH, MARGIN)
    }

    fn above(&self) -> Above {
        let repeats = self.groups.iter().flat_map(|group| &group.paths_m);
        let single = self.groups.iter().map(|group| &group.representative_m);
        let all = repeats.chain(single).chain(&self.real_m);
        let all = all.chain([&self.noise_free_m]);
        Above::new(all, SHAPE, WIDTH, MARGIN)
    }

    fn draw_paths(&self, canvas: &mut Canvas, frame: &Frame) {
        for (index, group) in self.groups.iter().enumerate() {
            let pale = Stroke::new(1.3, tint(stroke_of(index, 1.0).colour, 0.4));
            for path in &group.paths_m {
                draw_path(canvas, frame, path, pale);
            }
        }
        for path in &self.real_m {
            draw_path(canvas, frame, path, Stroke::new(1.8, INK));
        }
        for (index, group) in self.groups.iter().enumerate().rev() {
            let stroke = stroke_of(index, 4.5);
            draw_path(canvas, frame, &group.representative_m, stroke);
        }
        draw_path(canvas, frame, &self.noise_free_m, noise_free());
    }

    /// One coordinate over time: bands, and the real runs over them.
    fn draw_over_time(&self, canvas: &mut Canvas, axis: usize, (from, to): (f64, f64), top: f64) {
        let bands = self.bands.iter().chain(&self.whole_paths);
        let bands = bands.flat_map(|b| b.low_m.iter().chain(&b.high_m));
        let runs = self.real_m.iter().flatten().chain(&self.noise_free_m);
        let values = bands.chain(runs).map(|p| p[axis] * CM_PER_M);
        let (low, high) = ends_of(values.filter(|v| v.abs() < 1e8).chain([0.0]));
        let room = 0.05 * (high - low).max(0.2);
        let y = Scale::linear(low - room, high + room);
        let y_ticks = y.ticks(6);
        let x = Scale::linear(self.times_s[0], self.times_s[self.times_s.len() - 1]);
        let x_ticks = x.ticks(6);
        let left = (from + left_of_label(&y_ticks)).round();
        let frame = Frame::new((left, top), (to, top + OVER_TIME), [x, y]);
        let line = |points: &[PathPoint]| -> Vec<Point> {
            let points = self.times_s.iter().zip(points);
            let points = points.map(|(t, p)| (*t, p[axis] * CM_PER_M));
            points.filter(|p| p.1.abs() < 1e8).collect()
        };
        for band in &self.bands {
            // Strip by strip: a polygon that crosses itself at the start would be filled wrongly.
            let (low, high) = (line(&band.low_m), line(&band.high_m));
            for (low, high) in low.windows(2).zip(high.windows(2)) {
                // Half a pixel of overlap, so that no seam shows.
                let [a, b, c, d] = [low[0], low[1], high[1], high[0]].map(|p| frame.at(p));
                let wide = |p: Point| (p.0 + 0.6, p.1);
                canvas.polygon(&[a, wide(b), wide(c), d], shade(band.level));
            }
        }
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        let mut draw = |points: &[PathPoint], stroke: Stroke| {
            let line = line(points).into_iter().map(|point| frame.at(point));
            canvas.path(&line.collect::<Vec<_>>(), stroke);
        };
        for edge in (self.whole_paths.iter()).flat_map(|band| [&band.low_m, &band.high_m]) {
            draw(edge, whole_path());
        }
        for path in &self.real_m {
            draw(path, Stroke::new(1.6, INK));
        }
        draw(&self.noise_free_m, noise_free());
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, "time (s)");
        frame.draw_y_axis(canvas, &y_ticks, ["x (cm)", "y (cm)"][axis]);
    }
}

impl Picture for EnsemblePlot {
    fn check(&self) -> Result<()> {
        if self.times_s.len() < 2 || self.groups.is_empty() {
            return Err(Error::invalid("there is no ensemble to draw"));
        }
        for band in self.bands.iter().chain(&self.whole_paths) {
            if [band.low_m.len(), band.high_m.len()] != [self.times_s.len(); 2] {
                return Err(Error::invalid("bands and times differ in number")
                    .found(band.low_m.len())
                    .allowed(self.times_s.len()));
            }
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let room = self.above().height + BELOW_LABEL + GAP + OVER_TIME + BELOW_LABEL;
        self.heading_and_legend().around(WIDTH, room)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (surround, above) = (self.heading_and_legend(), self.above());
        let top = surround.top().round();
        let lower = (top + above.height + BELOW_LABEL + GAP).round();
        surround.draw_around(canvas, lower + OVER_TIME + BELOW_LABEL);
        let label = "x along the net displacement (cm)";
        above.draw(canvas, top, label, |canvas, frame| {
            self.draw_paths(canvas, frame);
        });
        let middle = (WIDTH / 2.0).round();
        self.draw_over_time(canvas, 0, (MARGIN, middle - GAP / 2.0), lower);
        self.draw_over_time(canvas, 1, (middle + GAP / 2.0, WIDTH - MARGIN), lower);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{check, curved_path};

    /// Groups of paths that bend differently; bands that widen with time.
    fn plot(groups: usize) -> EnsemblePlot {
        let path = |group: usize, i: usize| {
            curved_path(0.5 + 0.01 * i as f64, 0.3 * group as f64 - 0.2, 0.01)
        };
        let groups = (0..groups)
            .map(|group| EnsembleGroup {
                label: format!("other path {}: {} %", group + 1, 100 / groups),
                paths_m: (0..12).map(|i| path(group, i)).collect(),
                representative_m: path(group, 6),
            })
            .collect();
        let times_s: Vec<f64> = (0..path(0, 0).len()).map(|i| 0.1 * i as f64).collect();
        let at = |share: f64, t: f64| [0.02 * t + share * 0.01 * t, share * 0.01 * t];
        let bands = [0.9, 0.8, 0.5]
            .map(|level| EnsembleBand {
                level,
                low_m: times_s.iter().map(|t| at(-level, *t)).collect(),
                high_m: times_s.iter().map(|t| at(level, *t)).collect(),
            })
            .to_vec();
        EnsemblePlot {
            caption: Caption::new(
                "tripod: repeats under noise",
                "36 of 36 repeats of 20 s, seed 1",
            ),
            groups,
            noise_free_m: path(0, 3),
            real_m: vec![path(0, 4), path(1, 2)],
            real_label: "stand-in for reality".to_owned(),
            times_s,
            whole_paths: bands.first().cloned(),
            bands,
        }
    }

    #[test]
    fn ensembles_of_one_and_of_five_behaviours() {
        for groups in [1, 5] {
            let plot = plot(groups);
            let name = format!("ensemble_{groups}");
            let svg = check(&name, |file| picture::write(&plot, file));
            for words in [
                "time (s)",
                "x (cm)",
                "without noise",
                "stand-in for reality (2)",
            ] {
                assert!(svg.contains(words), "{words}");
            }
        }
    }

    #[test]
    fn a_robot_that_stays_and_paths_that_are_no_numbers_are_drawn() {
        let mut still = plot(1);
        let nowhere = vec![[0.0; 2]; still.times_s.len()];
        still.groups[0].paths_m = vec![nowhere.clone(), vec![[f64::NAN; 2]; 3]];
        still.groups[0].representative_m = nowhere.clone();
        still.noise_free_m = Vec::new();
        still.real_m = vec![vec![[f64::INFINITY; 2]; still.times_s.len()]];
        for band in still.bands.iter_mut().chain(&mut still.whole_paths) {
            (band.low_m, band.high_m) = (nowhere.clone(), nowhere.clone());
        }
        check("ensemble_still", |file| picture::write(&still, file));
    }

    #[test]
    fn data_that_do_not_fit_together_are_refused() {
        let file = std::env::temp_dir().join("never.png");
        let mut short = plot(1);
        short.bands[0].low_m.pop();
        assert!(picture::write(&short, &file).is_err());
        let mut nobody = plot(1);
        nobody.groups.clear();
        assert!(picture::write(&nobody, &file).is_err());
        assert!(!file.exists());
    }
}
