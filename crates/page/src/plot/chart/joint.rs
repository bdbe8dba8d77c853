//! Joints: recorded and simulated angles over time, a panel for each joint, with the residuals below.

use crate::plot::kit::*;
use crate::plot::{LinePlot, Series, SeriesKind};
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1260.0;
const MARGIN: f64 = 34.0;
const COLUMNS: usize = 2;
const COLUMN_GAP: f64 = 40.0;
const TITLE: f64 = 36.0;
const ANGLES: f64 = 190.0;
const GAP: f64 = 30.0;
const RESIDUALS: f64 = 165.0;
const ROW_GAP: f64 = 14.0;
const MRAD: f64 = 1e3;
const ROOM: f64 = 0.07;
/// A joint that moves less than this counts as still: it is the resolution of an encoder.
const STILL_RAD: f64 = 1e-3;

/// One joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPanel {
    /// Its name.
    pub name: String,
    /// Since the start of the run, seconds.
    pub times_s: Vec<f64>,
    /// Recorded angles, radians.
    pub recorded_rad: Vec<f64>,
    /// Simulated angles, radians.
    pub simulated_rad: Vec<f64>,
    /// Between these lie 90 % of the residuals of all recordings, radians.
    pub spread_rad: [f64; 2],
}

impl JointPanel {
    /// Simulated angles minus recorded ones, radians.
    pub(crate) fn residuals_rad(&self) -> impl Iterator<Item = f64> + '_ {
        let both = self.simulated_rad.iter().zip(&self.recorded_rad);
        both.map(|(simulated, recorded)| simulated - recorded)
    }

    /// Angles over time, and residuals over time with the spread of all recordings.
    pub(crate) fn charts(&self) -> [LinePlot; 2] {
        let over = |values: &[f64]| -> Vec<Point> {
            let times = self.times_s.iter().copied();
            times.zip(values.iter().copied()).collect()
        };
        let time = || AxisSpec::new("time", Unit::Second);
        let line = |label: &str, values: &[f64]| Series::new(label, SeriesKind::Line, over(values));
        let angles = vec![
            line("recorded", &self.recorded_rad).recorded(),
            line("simulated, best point", &self.simulated_rad),
        ];
        let residuals: Vec<f64> = self.residuals_rad().map(|rad| MRAD * rad).collect();
        let [low, high] = self.spread_rad.map(|rad| MRAD * rad);
        let ends = [self.times_s.first(), self.times_s.last()];
        let ends: Vec<Point> = ends.into_iter().flatten().map(|t| (*t, low)).collect();
        let spread = SeriesKind::Band(vec![high; ends.len()]);
        let residuals = vec![
            Series::new("90 % of the residuals of all recordings", spread, ends),
            line("residual", &residuals).colour(1),
        ];
        let caption = || Caption::new(self.name.clone(), "");
        [
            LinePlot::new(caption(), time(), ("angle", Unit::Radian), angles),
            LinePlot::new(caption(), time(), ("residual (mrad)", Unit::One), residuals),
        ]
    }
}

/// Joints of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPlot {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The joints, at most 60.
    pub joints: Vec<JointPanel>,
    /// What the recorded line is called, e.g. `reality`.
    pub reality_label: String,
}

/// From the least to the greatest of these, at least so much, with some room.
fn around(values: impl Iterator<Item = f64>, least: f64) -> Scale {
    let (low, high) = ends_of(values);
    let room = (ROOM * (high - low)).max(0.5 * (least - (high - low)));
    Scale::linear(low - room, high + room)
}

/// Both scales of a panel.
fn scales(joint: &JointPanel) -> [Scale; 2] {
    let angles = joint.recorded_rad.iter().chain(&joint.simulated_rad);
    let residuals = joint.residuals_rad().chain(joint.spread_rad).chain([0.0]);
    [
        around(angles.copied(), STILL_RAD),
        around(residuals.map(|rad| MRAD * rad), MRAD * STILL_RAD),
    ]
}

impl JointPlot {
    fn heading_and_legend(&self) -> HeadingAndLegend {
        let line = |colour, width| Symbol::Line(Stroke::new(width, colour));
        let (left, spread) = (line(VERMILLION, 2.0), Symbol::Shade(SHADE));
        let entries = [
            (line(INK, 3.5), self.reality_label.as_str()),
            (line(BLUE, 2.5), "simulation"),
            (left, "residual: simulation minus recording"),
            (spread, "90 % of the residuals of all recordings"),
        ];
        let entries = entries.map(|(symbol, text)| (symbol, text.to_owned()));
        HeadingAndLegend::new(&self.caption, entries.into(), WIDTH, MARGIN)
    }

    fn columns(&self) -> usize {
        COLUMNS.min(self.joints.len())
    }

    fn row_height(&self) -> f64 {
        TITLE + ANGLES + GAP + RESIDUALS + BELOW_LABEL + ROW_GAP
    }

    fn draw_joint(
        &self,
        canvas: &mut Canvas,
        joint: &JointPanel,
        [left, right]: [f64; 2],
        top: f64,
    ) {
        let letter = Letter::new(23.0, Weight::Bold, INK);
        let name = shorten(&joint.name, letter.weight, letter.size, right - left);
        canvas.text(&name, (left, top + 25.0), Align::Left, letter);
        let time = Scale::linear(joint.times_s[0], joint.times_s[joint.times_s.len() - 1]);
        let [angles, residuals] = scales(joint);
        let top = top + TITLE;
        let upper = Frame::new((left, top), (right, top + ANGLES), [time, angles]);
        let top = top + ANGLES + GAP;
        let lower = Frame::new((left, top), (right, top + RESIDUALS), [time, residuals]);
        let [low, high] = joint.spread_rad.map(|rad| lower.within_y(MRAD * rad));
        canvas.fill((left, high), (right, low), SHADE);
        let x_ticks = time.ticks(7);
        for frame in [&upper, &lower] {
            frame.draw_grid(canvas, &x_ticks, &frame.y.ticks(4));
        }
        let line = |canvas: &mut Canvas, frame: &Frame, values: &[f64], stroke| {
            let points = joint.times_s.iter().zip(values);
            let points = points.map(|(t, v)| frame.at((*t, *v)));
            canvas.path(&points.collect::<Vec<_>>(), stroke);
        };
        line(canvas, &upper, &joint.recorded_rad, Stroke::new(3.5, INK));
        line(canvas, &upper, &joint.simulated_rad, Stroke::new(2.5, BLUE));
        let off: Vec<f64> = joint.residuals_rad().map(|rad| MRAD * rad).collect();
        line(canvas, &lower, &off, Stroke::new(2.0, VERMILLION));
        for (frame, label) in [(&upper, "angle (rad)"), (&lower, "residual (mrad)")] {
            frame.draw_outline(canvas);
            frame.draw_y_axis(canvas, &frame.y.ticks(4), label);
        }
        lower.draw_x_axis(canvas, &x_ticks, "time (s)");
    }
}

impl Picture for JointPlot {
    fn check(&self) -> Result<()> {
        picture::check_rows("joints", self.joints.len(), COLUMNS)?;
        for joint in &self.joints {
            let samples = joint.times_s.len();
            for column in [&joint.recorded_rad, &joint.simulated_rad] {
                check_length(&joint.name, column.len(), samples)?;
            }
            let all = joint.times_s.iter().chain(&joint.recorded_rad);
            let is_finite = all.chain(&joint.simulated_rad).all(|v| v.is_finite());
            if samples < 2 || !is_finite {
                return Err(nothing(&joint.name, "two finite samples or more"));
            }
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let rows = self.joints.len().div_ceil(self.columns()) as f64;
        self.heading_and_legend()
            .around(WIDTH, rows * self.row_height() - ROW_GAP)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let surround = self.heading_and_legend();
        surround.draw(canvas, f64::from(self.size().1));
        let columns = self.columns();
        let column = (WIDTH - 2.0 * MARGIN - COLUMN_GAP * (columns as f64 - 1.0)) / columns as f64;
        // One room for the numbers of all panels, so that their frames stand below each other.
        let axes = self.joints.iter().flat_map(scales);
        let beside = axes.map(|scale| left_of_label(&scale.ticks(4)));
        let beside = beside.fold(0.0, f64::max);
        for (index, joint) in self.joints.iter().enumerate() {
            let (row, place) = ((index / columns) as f64, (index % columns) as f64);
            let left = MARGIN + place * (column + COLUMN_GAP);
            let sides = [(left + beside).round(), (left + column).round()];
            let top = (surround.top() + row * self.row_height()).round();
            self.draw_joint(canvas, joint, sides, top);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::check;

    fn joint(name: &str, off_rad: f64) -> JointPanel {
        let times_s: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
        let recorded: Vec<f64> = times_s.iter().map(|t| (0.7 * t).sin()).collect();
        JointPanel {
            name: name.to_owned(),
            simulated_rad: recorded
                .iter()
                .zip(&times_s)
                .map(|(a, t)| a + off_rad * (3.0 * t).cos())
                .collect(),
            recorded_rad: recorded,
            times_s,
            spread_rad: [-off_rad, off_rad],
        }
    }

    #[test]
    fn every_joint_has_a_panel_with_its_residual_below() {
        let names = ["shoulder_pan", "elbow_flex", "gripper"];
        let plot = JointPlot {
            caption: Caption::new("arm: joints over time", "first of four recordings"),
            joints: names.map(|name| joint(name, 0.02)).to_vec(),
            reality_label: "reality".to_owned(),
        };
        let svg = check("joints", |path| picture::write(&plot, path));
        for text in names.iter().copied().chain(["90 % of the residuals"]) {
            assert!(svg.contains(text), "{text}");
        }
        assert_eq!(svg.matches("residual (mrad)").count(), 3);
        assert_eq!(svg.matches("angle (rad)").count(), 3);
        let one = JointPlot {
            joints: vec![joint("still", 0.0)],
            ..plot.clone()
        };
        check("joints_one", |path| picture::write(&one, path));
        let mut broken = plot;
        broken.joints[1].simulated_rad[3] = f64::NAN;
        assert!(picture::write(&broken, Path::new("x.png")).is_err());
    }
}
