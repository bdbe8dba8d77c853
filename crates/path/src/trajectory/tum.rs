//! The TUM text format: `timestamp tx ty tz qx qy qz qw` per line; `#` starts a comment.

use super::Trajectory;
use super::column::Measure;
use super::format::{Format, Parsed, Rendered, beyond_poses};
use super::reading::{QuaternionOrder, Reading};
use super::sample::{Clock, Layout, Samples};
use super::text::{Separator, cut, push_number};
use realgap_core::constant_methods;
use realgap_core::error::Result;

/// The text format of the TUM RGB-D benchmark, which evo and many SLAM programs read.
///
/// Each line has eight numbers separated by white space: seconds, position, quaternion with the real part last
/// (world from body). The format cannot hold velocities, the fact that z is unknown (z is written as 0), or the
/// absence of orientation (written as the identity rotation); writing gives warnings about lost data.
#[derive(Debug, Clone, Copy)]
pub struct Tum;

impl Format for Tum {
    constant_methods! {
        name: &'static str = "tum";
        doc: &'static str = "TUM text: timestamp tx ty tz qx qy qz qw, separated by spaces, # comments";
        extensions: &'static [&'static str] = &["tum", "txt"];
    }

    fn order(&self, _text: &str, reading: &Reading) -> QuaternionOrder {
        reading.quaternion.unwrap_or(QuaternionOrder::Xyzw)
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        let (layout, samples) = samples(text, reading, self.order(text, reading))?;
        samples.finish(&layout, Vec::new())
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        let (layout, samples) = samples(text, reading, self.order(text, reading))?;
        samples.finish_split(&layout, &[])
    }

    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        let mut text = String::from("# timestamp tx ty tz qx qy qz qw\n");
        for (time_s, p, q) in trajectory.poses() {
            push_number(&mut text, time_s);
            for value in [p.x, p.y, p.z, q.i, q.j, q.k, q.w] {
                text.push(' ');
                push_number(&mut text, value);
            }
            text.push('\n');
        }
        Ok(Rendered {
            bytes: text.into_bytes(),
            warnings: beyond_poses("TUM files", trajectory),
        })
    }
}

/// The layout of the lines, and the samples in them.
fn samples(text: &str, reading: &Reading, order: QuaternionOrder) -> Result<(Layout, Samples)> {
    let (time, length) = (
        reading.factor(Measure::Time),
        reading.factor(Measure::Length),
    );
    let layout = Layout {
        names: ["timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"]
            .map(str::to_owned)
            .to_vec(),
        factors: vec![time, length, length, length, 1.0, 1.0, 1.0, 1.0],
        clock: Clock::Column(0),
        place: Some([1, 2]),
        z: Some(3),
        quaternion: Some(order.wxyz([4, 5, 6, 7])),
        heading: None,
        velocity: None,
        joints: Vec::new(),
        signals: Vec::new(),
        time_hint: None,
    };
    let mut samples = Samples::new(reading);
    let mut cells = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split(['#', '%']).next().unwrap_or_default();
        cut(line, index + 1, Separator::Space, &mut cells)?;
        if !cells.is_empty() {
            samples.push(&layout, &cells, index + 1)?;
        }
    }
    Ok((layout, samples))
}
