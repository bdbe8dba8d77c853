//! One line of a file becomes one sample: which column holds what, and what a sample must satisfy.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::Trajectory;
use super::text::{Cell, check_rows};
use crate::error::{Error, Result};
use crate::unit::LengthUnit;
use crate::warning::{Code, Warning};

/// Largest | |q| − 1 | that is kept bit for bit, so that writing and reading back changes nothing.
const UNIT_EXACT: f64 = 1e-9;
/// Largest | |q| − 1 | that is renormalised silently: rounding of files with few digits.
const UNIT_ROUNDED: f64 = 1e-3;
/// Largest | |q| − 1 | that is accepted at all.
const UNIT_ACCEPTED: f64 = 1e-2;

/// Index of every column in a line; `names` are for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) names: Vec<String>,
    pub(super) time: usize,
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) z: Option<usize>,
    /// In the order w, x, y, z.
    pub(super) quaternion: Option<[usize; 4]>,
    /// Linear x, y, z, angular x, y, z.
    pub(super) velocity: Option<[usize; 6]>,
    /// What to do when time goes back.
    pub(super) time_hint: Option<String>,
}

/// The samples read so far.
#[derive(Debug)]
pub(super) struct Samples {
    metres: f64,
    times_s: Vec<f64>,
    positions_m: Vec<Vector3<f64>>,
    orientations: Vec<UnitQuaternion<f64>>,
    linear_m_s: Vec<Vector3<f64>>,
    angular_rad_s: Vec<Vector3<f64>>,
    renormalised: usize,
    largest_deviation: f64,
    last_line: usize,
}

impl Samples {
    pub(super) fn new(unit: LengthUnit) -> Self {
        Self {
            metres: unit.metres(),
            times_s: Vec::new(),
            positions_m: Vec::new(),
            orientations: Vec::new(),
            linear_m_s: Vec::new(),
            angular_rad_s: Vec::new(),
            renormalised: 0,
            largest_deviation: 0.0,
            last_line: 1,
        }
    }

    /// Adds the sample in `cells` (line number `line`).
    pub(super) fn push(&mut self, layout: &Layout, cells: &[Cell<'_>], line: usize) -> Result<()> {
        check_columns(layout, cells, line)?;
        check_rows(self.times_s.len(), line)?;
        self.last_line = line;
        let number = |index: usize| cells[index].number(&layout.names[index]);

        let time_s = number(layout.time)?;
        if let Some(&last) = self.times_s.last()
            && time_s <= last
        {
            let error = Error::invalid("time does not increase")
                .field(&layout.names[layout.time])
                .found(format!("{time_s} after {last}"))
                .allowed("strictly increasing seconds");
            let error = match &layout.time_hint {
                Some(hint) => error.hint(hint),
                None => error.hint("sort the samples and remove repeated ones"),
            };
            return Err(cells[layout.time].locate(error));
        }
        let z = layout.z.map_or(Ok(0.0), number)?;
        let position = Vector3::new(number(layout.x)?, number(layout.y)?, z) * self.metres;
        if let Some(wxyz) = layout.quaternion {
            let [w, x, y, z] = wxyz.map(number);
            let q = Quaternion::new(w?, x?, y?, z?);
            let orientation = self.unit(q, &cells[wxyz[0]])?;
            self.orientations.push(orientation);
        }
        if let Some(indices) = layout.velocity {
            let [vx, vy, vz, wx, wy, wz] = indices.map(number);
            self.linear_m_s
                .push(Vector3::new(vx?, vy?, vz?) * self.metres);
            self.angular_rad_s.push(Vector3::new(wx?, wy?, wz?));
        }
        self.times_s.push(time_s);
        self.positions_m.push(position);
        Ok(())
    }

    fn unit(&mut self, q: Quaternion<f64>, first: &Cell<'_>) -> Result<UnitQuaternion<f64>> {
        let norm = q.norm();
        let deviation = (norm - 1.0).abs();
        if deviation <= UNIT_EXACT {
            return Ok(UnitQuaternion::new_unchecked(q));
        }
        if deviation > UNIT_ACCEPTED {
            return Err(first.locate(
                Error::invalid("the quaternion is not of length 1")
                    .field("qw, qx, qy, qz")
                    .found(format!("length {norm}"))
                    .allowed(format!("1 within {UNIT_ACCEPTED}"))
                    .hint("order: real part first, world from body"),
            ));
        }
        if deviation > UNIT_ROUNDED {
            self.renormalised += 1;
            self.largest_deviation = self.largest_deviation.max(deviation);
        }
        Ok(UnitQuaternion::new_unchecked(q / norm))
    }

    /// The trajectory, and what the reader should know about it.
    pub(super) fn finish(self, layout: &Layout) -> Result<(Trajectory, Vec<Warning>)> {
        if self.times_s.len() < 2 {
            return Err(Error::invalid("too few points for a trajectory")
                .at_line(self.last_line, 1)
                .found(match self.times_s.len() {
                    0 => "no sample",
                    _ => "1 sample",
                })
                .allowed("at least 2 samples"));
        }
        let mut warnings = Vec::new();
        if self.renormalised > 0 {
            warnings.push(Warning::new(
                Code::QuaternionsRenormalised,
                format!(
                    "{} quaternions were up to {:.4} off length 1 and have been renormalised",
                    self.renormalised, self.largest_deviation
                ),
            ));
        }
        let mut trajectory = Trajectory::new(self.times_s, self.positions_m)?;
        if layout.quaternion.is_some() {
            trajectory = trajectory.with_orientations(self.orientations)?;
        }
        if layout.velocity.is_some() {
            trajectory = trajectory.with_velocities(self.linear_m_s, self.angular_rad_s)?;
        }
        if layout.z.is_none() {
            trajectory = trajectory.planar();
        }
        Ok((trajectory, warnings))
    }
}

fn check_columns(layout: &Layout, cells: &[Cell<'_>], line: usize) -> Result<()> {
    let (found, allowed) = (cells.len(), layout.names.len());
    if found == allowed {
        return Ok(());
    }
    let error = Error::invalid("wrong number of columns")
        .found(format!("{found} columns"))
        .allowed(format!("{allowed} columns: {}", layout.names.join(", ")));
    // Where the line goes wrong: at the first cell too many, or at the end of a short line.
    Err(match (cells.get(allowed), cells.last()) {
        (Some(cell), _) | (None, Some(cell)) => cell.locate(error),
        (None, None) => error.at_line(line, 1),
    })
}
