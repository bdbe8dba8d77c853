//! Sensorgraphs and their evaluations in words.

use std::fmt;

use super::evaluation::Evaluation;
use super::fit::FittedGraph;
use super::model::{Frame, Polynomial, Sensorgraph};
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::number;

impl fmt::Display for Polynomial {
    /// `+2.237 +1.47 u -0.68 u v^2`, metres.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, term) in self.terms.iter().enumerate() {
            let gap = if index == 0 { "" } else { " " };
            write!(f, "{gap}{:+.4}", term.value)?;
            for (name, power) in ["u", "v"].iter().zip(term.powers) {
                match power {
                    0 => {}
                    1 => write!(f, " {name}")?,
                    power => write!(f, " {name}^{power}")?,
                }
            }
        }
        Ok(())
    }
}

impl fmt::Display for Sensorgraph {
    /// Every polynomial in a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "u = (x - {:.4} m) / {:.4} m, v = (y - {:.4} m) / {:.4} m; ranges in metres",
            self.centre_m.0, self.scale_m, self.centre_m.1, self.scale_m
        )?;
        let segments = self.segments_deg.len();
        let step = 360.0 / self.headings as f64;
        for (index, polynomial) in self.polynomials.iter().enumerate() {
            match self.frame {
                Frame::Robot => write!(
                    f,
                    "heading {:.0} to {:.0} deg, segment {:.0} deg:",
                    step * (index / segments) as f64,
                    step * (index / segments + 1) as f64,
                    self.segments_deg[index % segments]
                )?,
                Frame::World => write!(f, "direction {:.0} deg:", step * index as f64)?,
            }
            writeln!(f, " {polynomial}  ({} samples)", polynomial.samples)?;
        }
        Ok(())
    }
}

impl fmt::Display for FittedGraph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} scans, {} polynomials with {} terms",
            self.scans, self.polynomials, self.terms
        )?;
        if let (Some(robot), Some(world)) = (self.robot_frame_error_m, self.world_frame_error_m) {
            writeln!(
                f,
                "parts of the way left out: {robot:.3} m off with a polynomial for every heading and segment, {world:.3} m with one for every direction of the world"
            )?;
        }
        let taken = match self.frame {
            Frame::Robot => "one polynomial for every heading and segment",
            Frame::World => "one polynomial for every direction of the world",
        };
        write!(f, "taken: {taken}")
    }
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let metres = |v: Option<f64>| v.map_or("–".to_owned(), |v| format!("{v:.3} m"));
        writeln!(f, "{} scans, {} segments\n", self.scans, self.samples)?;
        let mut table = TextTable::new([
            ("  guess", Side::Left),
            ("mean absolute error", Side::Right),
        ]);
        let cast = self
            .baseline_ray_casting_m
            .map(|m| ("  ideal beams in the arena", Some(m)));
        for (name, value) in [
            ("  the model", Some(self.mean_absolute_error_m)),
            ("  each segment's mean", Some(self.baseline_constant_m)),
            ("  the nearest logged pose", self.baseline_nearest_m),
            (
                "  the nearest logged place, turned to the heading",
                self.baseline_nearest_turned_m,
            ),
            ("  at random", Some(self.baseline_random_m)),
        ]
        .into_iter()
        .chain(cast)
        {
            table.push([name.to_owned(), metres(value)]);
        }
        f.write_str(&table.render(false))?;
        writeln!(
            f,
            "standard error of the model's, by parts of the way: {:.3} m",
            self.standard_error_m
        )?;
        if let (Some(rank), Some(p)) = (self.spearman, self.p) {
            writeln!(
                f,
                "rank correlation of predicted and actual ranges: {rank:.3} (p = {})",
                number(p)
            )?;
        }
        writeln!(
            f,
            "other errors than at random, by one of {} scans: p = {}\n",
            self.every,
            number(self.mann_whitney_p)
        )?;
        let mut table = TextTable::new([
            ("  segment", Side::Right),
            ("scans", Side::Right),
            ("model", Side::Right),
            ("± standard error", Side::Left),
            ("mean", Side::Right),
            ("nearest", Side::Right),
            ("rank correlation", Side::Right),
            ("p", Side::Right),
            ("against random p", Side::Right),
        ]);
        for s in &self.segments {
            table.push([
                format!("{:.0}°", s.segment_deg),
                s.samples.to_string(),
                metres(Some(s.mean_absolute_error_m)),
                format!("{:.3} m", s.standard_error_m),
                metres(Some(s.baseline_constant_m)),
                metres(s.baseline_nearest_m),
                s.spearman.map_or("–".to_owned(), |r| format!("{r:.3}")),
                s.p.map_or("–".to_owned(), number),
                number(s.mann_whitney_p),
            ]);
        }
        f.write_str(table.render(false).trim_end())
    }
}
