//! The EuRoC format of ground truth: CSV whose first line is `#timestamp [ns], p_RS_R_x [m], …`.

use super::Trajectory;
use super::column::{Columns, Role};
use super::csv::Csv;
use super::format::{Format, Parsed, Rendered, beyond_poses, not_written};
use super::reading::Reading;
use super::text::{first_line, push_number};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::TimeUnit;

/// The CSV files of the EuRoC micro aerial vehicle data, of ASL's other data sets and of programs that are evaluated on them.
///
/// Each line has the time in whole nanoseconds, the position of the sensor S in the reference frame R, and a quaternion with the real part
/// first (R from S). Velocities are read if the file has both linear and angular velocities, which EuRoC's own files do not have; biases are
/// ignored with a warning. A file with the extension `.csv` is a EuRoC file if its header says so. The format cannot hold joints, the fact
/// that z is unknown (z is written as 0), the absence of orientation (written as the identity rotation), or times finer than a nanosecond.
#[derive(Debug, Clone, Copy)]
pub struct Euroc;

/// The beginning of a header.
const TIME: &str = "#timestamp";
/// The names of columns, without the units that follow them.
const NAMES: [(Role, &str); 13] = [
    (Role::X, "p_RS_R_x"),
    (Role::Y, "p_RS_R_y"),
    (Role::Z, "p_RS_R_z"),
    (Role::Qw, "q_RS_w"),
    (Role::Qx, "q_RS_x"),
    (Role::Qy, "q_RS_y"),
    (Role::Qz, "q_RS_z"),
    (Role::Vx, "v_RS_R_x"),
    (Role::Vy, "v_RS_R_y"),
    (Role::Vz, "v_RS_R_z"),
    (Role::Wx, "w_RS_S_x"),
    (Role::Wy, "w_RS_S_y"),
    (Role::Wz, "w_RS_S_z"),
];
/// The header of EuRoC's own files.
const HEADER: &str = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []";

impl Euroc {
    /// The reading, completed by the mapping of this format's columns.
    fn mapped(self, text: &str, reading: &Reading) -> Result<Reading> {
        let mut own = Columns::default();
        for column in Csv.columns(text, reading) {
            let name = column.split_whitespace().next().unwrap_or_default();
            if name == TIME {
                // The format's own name states nanoseconds even in files of other programs that write another unit.
                let unit = reading.time.unwrap_or(TimeUnit::Nanosecond);
                own = own.with(Role::Time, &format!("{column} in {}", unit.symbol()))?;
            } else if let Some((role, _)) = NAMES.iter().find(|(_, known)| *known == name) {
                own = own.with(*role, column)?;
            }
        }
        Ok(Reading {
            columns: reading.columns.clone().or(&own),
            ..reading.clone()
        })
    }
}

impl Format for Euroc {
    constant_methods! {
        name: &'static str = "euroc";
        doc: &'static str = "EuRoC ground truth: CSV with #timestamp [ns], p_RS_R_x [m], ..., quaternions real part first";
        extensions: &'static [&'static str] = &["euroc", "csv"];
    }

    fn recognises(&self, bytes: &[u8]) -> bool {
        let line = first_line(bytes);
        line.starts_with(TIME) && line.contains(NAMES[0].1)
    }

    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        Csv.applied(text, reading)
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, &self.mapped(text, reading)?)
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, &self.mapped(text, reading)?)
    }

    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        let mut warnings = beyond_poses("EuRoC files", trajectory);
        let mut text = format!("{HEADER}\n");
        let mut is_rounded = false;
        for (time_s, p, q) in trajectory.poses() {
            let time_ns = (time_s * 1e9).round();
            is_rounded |= time_ns * 1e-9 != time_s;
            text.push_str(&format!("{time_ns:.0}"));
            for value in [p.x, p.y, p.z, q.w, q.i, q.j, q.k] {
                text.push(',');
                push_number(&mut text, value);
            }
            text.push('\n');
        }
        if is_rounded {
            let what = "times finer than a nanosecond; they are rounded";
            warnings.push(not_written("EuRoC files", what));
        }
        Ok(Rendered {
            bytes: text.into_bytes(),
            warnings,
        })
    }
}
