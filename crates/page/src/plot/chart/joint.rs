//! Joints: recorded and simulated angles over time, a panel for each joint (or torques and other channels), with the residuals below.

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
/// The same for other quantities, in their units.
const STILL: f64 = 1e-6;

/// One joint, or one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPanel {
    /// Its name.
    pub name: String,
    /// What is shown, and its unit, e.g. angle and rad.
    pub quantity: (String, String),
    /// Since the start of the run, seconds.
    pub times_s: Vec<f64>,
    /// Recorded values.
    pub recorded: Vec<f64>,
    /// Simulated values.
    pub simulated: Vec<f64>,
    /// Between these lie 90 % of the residuals of all recordings.
    pub spread: [f64; 2],
}

impl JointPanel {
    /// Simulated values minus recorded ones.
    pub(crate) fn residuals(&self) -> impl Iterator<Item = f64> + '_ {
        let both = self.simulated.iter().zip(&self.recorded);
        both.map(|(simulated, recorded)| simulated - recorded)
    }

    /// Whether it shows angles, whose residuals are shown in milliradians.
    fn is_of_angles(&self) -> bool {
        self.quantity.1 == "rad"
    }

    /// By what residuals are multiplied.
    fn residual_factor(&self) -> f64 {
        if self.is_of_angles() { MRAD } else { 1.0 }
    }

    /// Labels of both axes, with units.
    fn labels(&self) -> [String; 2] {
        let (word, unit) = &self.quantity;
        let residual_unit = if self.is_of_angles() { "mrad" } else { unit };
        [
            format!("{word} ({unit})"),
            format!("residual ({residual_unit})"),
        ]
    }

    /// Values over time, and residuals over time with the spread of all recordings.
    pub(crate) fn charts(&self) -> [LinePlot; 2] {
        let over = |values: &[f64]| -> Vec<Point> {
            let times = self.times_s.iter().copied();
            times.zip(values.iter().copied()).collect()
        };
        let time = || AxisSpec::new("time", Unit::Second);
        let line = |label: &str, values: &[f64]| Series::new(label, SeriesKind::Line, over(values));
        let values = vec![
            line("recorded", &self.recorded).recorded(),
            line("simulated, best point", &self.simulated),
        ];
        let factor = self.residual_factor();
        let residuals: Vec<f64> = self.residuals().map(|off| factor * off).collect();
        let [low, high] = self.spread.map(|off| factor * off);
        let ends = [self.times_s.first(), self.times_s.last()];
        let ends: Vec<Point> = ends.into_iter().flatten().map(|t| (*t, low)).collect();
        let spread = SeriesKind::Band(vec![high; ends.len()]);
        let residuals = vec![
            Series::new("90 % of the residuals of all recordings", spread, ends),
            line("residual", &residuals).colour(1),
        ];
        let caption = || Caption::new(self.name.clone(), "");
        let [above, below] = self.labels();
        let above = match self.is_of_angles() {
            true => ("angle", Unit::Radian),
            false => (above.as_str(), Unit::One),
        };
        [
            LinePlot::new(caption(), time(), above, values),
            LinePlot::new(caption(), time(), (&below, Unit::One), residuals),
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
    let values = joint.recorded.iter().chain(&joint.simulated);
    let residuals = joint.residuals().chain(joint.spread).chain([0.0]);
    let least = match joint.is_of_angles() {
        true => STILL_RAD,
        false => STILL,
    };
    let factor = joint.residual_factor();
    [
        around(values.copied(), least),
        around(residuals.map(|off| factor * off), factor * least),
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
        let factor = joint.residual_factor();
        let [low, high] = joint.spread.map(|off| lower.within_y(factor * off));
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
        line(canvas, &upper, &joint.recorded, Stroke::new(3.5, INK));
        line(canvas, &upper, &joint.simulated, Stroke::new(2.5, BLUE));
        let off: Vec<f64> = joint.residuals().map(|off| factor * off).collect();
        line(canvas, &lower, &off, Stroke::new(2.0, VERMILLION));
        for (frame, label) in [&upper, &lower].into_iter().zip(joint.labels()) {
            frame.draw_outline(canvas);
            frame.draw_y_axis(canvas, &frame.y.ticks(4), &label);
        }
        lower.draw_x_axis(canvas, &x_ticks, "time (s)");
    }
}

impl Picture for JointPlot {
    fn check(&self) -> Result<()> {
        picture::check_rows("joints", self.joints.len(), COLUMNS)?;
        for joint in &self.joints {
            let samples = joint.times_s.len();
            for column in [&joint.recorded, &joint.simulated] {
                check_length(&joint.name, column.len(), samples)?;
            }
            let all = joint.times_s.iter().chain(&joint.recorded);
            let is_finite = all.chain(&joint.simulated).all(|v| v.is_finite());
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
            quantity: ("angle".to_owned(), "rad".to_owned()),
            simulated: recorded
                .iter()
                .zip(&times_s)
                .map(|(a, t)| a + off_rad * (3.0 * t).cos())
                .collect(),
            recorded,
            times_s,
            spread: [-off_rad, off_rad],
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
        let mut torque = joint("elbow_torque_nm", 0.02);
        torque.quantity = ("torque".to_owned(), "N m".to_owned());
        let mixed = JointPlot {
            joints: vec![joint("elbow_rad", 0.02), torque],
            ..plot.clone()
        };
        let svg = check("joints_mixed", |path| picture::write(&mixed, path));
        for text in ["torque (N m)", "residual (N m)", "residual (mrad)"] {
            assert!(svg.contains(text), "{text}");
        }
        let one = JointPlot {
            joints: vec![joint("still", 0.0)],
            ..plot.clone()
        };
        check("joints_one", |path| picture::write(&one, path));
        let mut broken = plot;
        broken.joints[1].simulated[3] = f64::NAN;
        assert!(picture::write(&broken, Path::new("x.png")).is_err());
    }
}
