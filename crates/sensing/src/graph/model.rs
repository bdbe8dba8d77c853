//! The sensorgraph, a model that predicts the ranges of a scanner at a pose by polynomials (paper 001), and its file.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::angle::wrapped;
use super::monomial::{Powers, monomial};
use realgap_core::error::{Error, Result};

/// How a scan is predicted: by polynomials, or by looking up the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Frame {
    /// One polynomial for each range of headings and each segment of the scan, as in paper 001.
    Robot,
    /// One polynomial for each direction in the world. A scanner that turns with its robot sees the same walls in other segments, so
    /// scans of all headings contribute to all polynomials. The range of a segment is interpolated between the two directions that
    /// are nearest to its middle.
    World,
    /// No polynomials: the scan at the nearest logged pose, a radian of heading counting as a metre.
    Nearest,
    /// No polynomials: the scan at the nearest logged position, turned to the heading.
    Turned,
}

impl Frame {
    /// Whether the log is looked up in place of polynomials.
    pub(crate) fn is_lookup(self) -> bool {
        matches!(self, Self::Nearest | Self::Turned)
    }
}

/// One term of a polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// Powers of u and v.
    pub powers: Powers,
    /// Coefficient, metres.
    pub value: f64,
    /// Standard error of the coefficient, computed as if the errors of a log were independent; 0 if it is unknown.
    #[serde(default)]
    pub error: f64,
    /// Error reduction ratio: the share of the sum of squares that the term explained when it was chosen.
    #[serde(default)]
    pub ratio: f64,
}

/// A polynomial in the position, limited to the ranges that occur in its log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Polynomial {
    /// Number of samples of the fit; 0 for a direction without samples, for which the mean of the segment is used.
    pub samples: usize,
    /// Smallest and largest range of these samples, metres; predictions are limited to this interval.
    pub limits_m: (f64, f64),
    /// Terms in the order in which they were chosen.
    pub terms: Vec<Term>,
}

impl Polynomial {
    /// The range at a scaled position, metres.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let sum: f64 = self
            .terms
            .iter()
            .map(|term| term.value * monomial(term.powers, place))
            .sum();
        sum.clamp(self.limits_m.0, self.limits_m.1)
    }
}

/// A pose of the log with the medians of its scan, for baselines and for drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LoggedPose {
    /// The pose is x and y in the world, metres, and the heading, radians.
    pub pose: (f64, f64, f64),
    /// Median of each segment, metres; −1 if no beam returned.
    pub segments_m: Vec<f64>,
    /// Median of each direction of the world, metres; −1 if no beam returned.
    pub directions_m: Vec<f64>,
}

/// A model that predicts the ranges of a scanner at a pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Sensorgraph")]
pub struct Sensorgraph {
    /// How a scan is predicted.
    pub frame: Frame,
    /// Middle of each segment, degrees counter-clockwise from straight ahead.
    pub segments_deg: Vec<f64>,
    /// Width of a segment, degrees.
    pub width_deg: f64,
    /// Number of ranges of headings, or of directions of the world.
    pub headings: usize,
    /// Centre of the scaled coordinates, which is subtracted from x and y, metres: u = (x − centre) / scale.
    pub centre_m: (f64, f64),
    /// Metres of x and y per unit of u and v.
    pub scale_m: f64,
    /// Mean of each segment over the log, metres; the simplest baseline.
    pub means_m: Vec<f64>,
    /// With Frame::Robot, one for each segment of each range of headings, ordered by heading. With Frame::World, one for each
    /// direction. Empty for lookups.
    pub polynomials: Vec<Polynomial>,
    /// The poses of the log with their medians; long logs are thinned.
    pub log: Vec<LoggedPose>,
}

/// The value in a [`LoggedPose`] that means that no beam returned.
pub(super) const NOTHING: f64 = -1.0;

realgap_core::ron_file!(Sensorgraph, "sensorgraph");

impl Sensorgraph {
    fn check(&self) -> Result<()> {
        let segments = self.segments_deg.len();
        let polynomials = match self.frame {
            Frame::Robot => self.headings * segments,
            Frame::World => self.headings,
            Frame::Nearest | Frame::Turned => 0,
        };
        let sizes = [
            ("polynomials", self.polynomials.len(), polynomials),
            ("means_m", self.means_m.len(), segments),
        ];
        for (field, found, allowed) in sizes {
            if found != allowed || segments == 0 || self.headings == 0 {
                return Err(Error::invalid("wrong number of values")
                    .field(field)
                    .found(found)
                    .allowed(allowed));
            }
        }
        let is_whole = self
            .log
            .iter()
            .all(|pose| pose.segments_m.len() == segments)
            && !(self.frame.is_lookup() && self.log.is_empty());
        let numbers = [
            self.centre_m.0,
            self.centre_m.1,
            self.scale_m,
            self.width_deg,
        ];
        if !is_whole || !numbers.iter().all(|v| v.is_finite()) || self.scale_m <= 0.0 {
            return Err(Error::invalid("the sensorgraph is incomplete").hint("fit it again"));
        }
        if self
            .polynomials
            .iter()
            .any(|p| p.limits_m.0 > p.limits_m.1 || p.limits_m.0.is_nan() || p.limits_m.1.is_nan())
        {
            return Err(Error::invalid("limits must increase").field("limits_m"));
        }
        Ok(())
    }

    /// A position in the scaled coordinates of the polynomials.
    pub(super) fn scaled(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            (x - self.centre_m.0) / self.scale_m,
            (y - self.centre_m.1) / self.scale_m,
        ]
    }

    /// Width of a range of headings, radians.
    fn step_rad(&self) -> f64 {
        std::f64::consts::TAU / self.headings as f64
    }

    /// Index of the range of headings that contains this heading.
    pub(super) fn heading_bin(&self, heading_rad: f64) -> usize {
        let turn = heading_rad.rem_euclid(std::f64::consts::TAU);
        ((turn / self.step_rad()) as usize).min(self.headings - 1)
    }

    /// The predicted median range of a segment at a pose, metres.
    pub fn range_m(&self, position_world_m: [f64; 2], heading_rad: f64, segment: usize) -> f64 {
        let place = self.scaled(position_world_m);
        match self.frame {
            Frame::Robot => {
                let heading = self.heading_bin(heading_rad);
                self.polynomials[heading * self.segments_deg.len() + segment].at(place)
            }
            Frame::World => {
                let (before, share) = self.between(heading_rad, segment);
                let after = (before + 1) % self.headings;
                let [low, high] = [before, after].map(|k| self.polynomials[k].at(place));
                low + share * (high - low)
            }
            Frame::Nearest => self
                .nearest_pose(position_world_m, heading_rad)
                .and_then(|pose| self.read_at(pose, segment))
                .unwrap_or(self.means_m[segment]),
            Frame::Turned => self
                .nearest_place(position_world_m)
                .and_then(|place| self.turned_at(place, heading_rad, segment))
                .unwrap_or(self.means_m[segment]),
        }
    }

    /// Index of the last direction before a segment's middle, and the position of the middle between it and the next direction (0
    /// to 1). Direction k is k steps counter-clockwise from +x.
    pub(super) fn between(&self, heading_rad: f64, segment: usize) -> (usize, f64) {
        let direction = wrapped(heading_rad + self.segments_deg[segment].to_radians());
        let steps = direction.rem_euclid(std::f64::consts::TAU) / self.step_rad();
        let before = steps.floor();
        (before as usize % self.headings, steps - before)
    }
}

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
    /// Every polynomial on a line of its own.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "u = (x - {:.4} m) / {:.4} m, v = (y - {:.4} m) / {:.4} m; ranges in metres",
            self.centre_m.0, self.scale_m, self.centre_m.1, self.scale_m
        )?;
        let segments = self.segments_deg.len();
        let step = 360.0 / self.headings as f64;
        if self.frame.is_lookup() {
            writeln!(f, "no polynomials: the nearest of {} scans", self.log.len())?;
        }
        for (index, polynomial) in self.polynomials.iter().enumerate() {
            match self.frame {
                Frame::Robot => write!(
                    f,
                    "heading {:.0} to {:.0} deg, segment {:.0} deg:",
                    step * (index / segments) as f64,
                    step * (index / segments + 1) as f64,
                    self.segments_deg[index % segments]
                )?,
                _ => write!(f, "direction {:.0} deg:", step * index as f64)?,
            }
            writeln!(f, " {polynomial}  ({} samples)", polynomial.samples)?;
        }
        Ok(())
    }
}
