//! Converts the lines of a file into samples, and checks every sample.

mod order;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::format::Parsed;
use super::header::excerpt_list;
use super::joint_column::{self, JointColumns};
use super::reading::Reading;
use super::stamp::{self, Calendar};
use super::text::{Cell, check_rows};
use super::time_order::Disorder;
use super::{JointTrack, Signal, Trajectory};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{counted, number};
use realgap_core::warning::{Code, Warning};

/// The hint about a file with too few samples.
pub(super) const COPY_AGAIN: &str =
    "was the file recorded and copied completely? Leave it out, or copy it again";

/// The largest | |q| − 1 | at which a quaternion is kept unchanged, so that writing and reading back changes no bit.
const UNIT_EXACT: f64 = 1e-9;
/// The largest | |q| − 1 | at which a quaternion is renormalised without a warning, because it may be due to rounding to few digits.
const UNIT_ROUNDED: f64 = 1e-3;
/// The largest | |q| − 1 | at which a quaternion is accepted.
const UNIT_ACCEPTED: f64 = 1e-2;
/// The |q| below which there is no orientation; trackers write such a quaternion if they have lost the body.
const NO_QUATERNION: f64 = 1e-6;

/// The message of an error about the order of samples.
pub(super) const TIME_GOES_BACK: &str = "time does not increase";

/// Where the times of samples come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// One column: a number, a date, or a time of day.
    Column(usize),
    /// Seconds in one column, and the part below one second in another.
    TwoColumns(usize, usize),
    /// A column that counts samples at this rate, 1/s.
    Counter(usize, f64),
    /// No column: samples are taken at this rate, 1/s.
    Rate(f64),
}

impl Clock {
    /// The columns of the time.
    pub(super) fn columns(self) -> impl Iterator<Item = usize> {
        let (first, second) = match self {
            Self::Column(column) | Self::Counter(column, _) => (Some(column), None),
            Self::TwoColumns(whole, rest) => (Some(whole), Some(rest)),
            Self::Rate(_) => (None, None),
        };
        first.into_iter().chain(second)
    }
}

/// The index of every column in a line; `names` are used in messages, `factors` convert from the file's units to SI.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) names: Vec<String>,
    pub(super) factors: Vec<f64>,
    pub(super) clock: Clock,
    /// x and y; `None` in a recording with joints only.
    pub(super) place: Option<[usize; 2]>,
    pub(super) z: Option<usize>,
    /// In the order w, x, y, z.
    pub(super) quaternion: Option<[usize; 4]>,
    /// Angle about z, if the orientation is only a heading.
    pub(super) heading: Option<usize>,
    /// Linear x, y, z, angular x, y, z.
    pub(super) velocity: Option<[usize; 6]>,
    /// Joints with their angle, and their speed if recorded.
    pub(super) joints: Vec<JointColumns>,
    /// Columns of signals.
    pub(super) signals: Vec<usize>,
    /// The hint of the error about times that do not increase.
    pub(super) time_hint: Option<String>,
}

/// The samples read so far.
#[derive(Debug)]
pub(super) struct Samples {
    sorts: bool,
    skips_lost: bool,
    is_unpadded: bool,
    calendar: Calendar,
    /// The number of rows, including those that are left out.
    rows: usize,
    /// The line of each sample.
    lines: Vec<u32>,
    /// Line and column of the first time that is not later than the one before.
    first_late: Option<(usize, usize)>,
    /// The text of the last time, and the number of steps back that end if the digits behind the dot are whole nanoseconds.
    last_stamp: String,
    unpadded_steps: usize,
    times_s: Vec<f64>,
    positions_m: Vec<Vector3<f64>>,
    orientations: Vec<UnitQuaternion<f64>>,
    linear_m_s: Vec<Vector3<f64>>,
    angular_rad_s: Vec<Vector3<f64>>,
    joints: Vec<JointTrack>,
    signals: Vec<Signal>,
    /// The number of samples that repeat the previous sample.
    repeated: usize,
    /// The number of samples without numbers.
    lost: usize,
    /// The number of samples whose times are not later than the previous time.
    late: usize,
    renormalised: usize,
    largest_deviation: f64,
    last_line: usize,
}

impl Samples {
    pub(super) fn new(reading: &Reading) -> Self {
        Self {
            sorts: reading.sort == Some(true),
            skips_lost: reading.skip_lost == Some(true),
            is_unpadded: reading.unpadded_stamps == Some(true),
            calendar: Calendar::default(),
            rows: 0,
            lines: Vec::new(),
            first_late: None,
            last_stamp: String::new(),
            unpadded_steps: 0,
            times_s: Vec::new(),
            positions_m: Vec::new(),
            orientations: Vec::new(),
            linear_m_s: Vec::new(),
            angular_rad_s: Vec::new(),
            joints: Vec::new(),
            signals: Vec::new(),
            repeated: 0,
            lost: 0,
            late: 0,
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
        self.rows += 1;
        let needed = (layout.clock.columns())
            .chain(layout.place.into_iter().flatten())
            .chain(layout.z)
            .chain(layout.quaternion.into_iter().flatten())
            .chain(layout.heading)
            .chain(layout.velocity.into_iter().flatten());
        if self.skips_lost && needed.into_iter().any(|index| cells[index].is_lost()) {
            self.lost += 1;
            return Ok(());
        }
        let number = |index: usize| {
            let number = cells[index].number(&layout.names[index])?;
            Ok::<f64, Error>(number * layout.factors[index])
        };

        let time_s = self.time_s(layout, cells)?;
        let z = layout.z.map_or(Ok(0.0), number)?;
        let [x, y] = layout.place.map_or([Ok(0.0), Ok(0.0)], |xy| xy.map(number));
        let position = Vector3::new(x?, y?, z);
        let orientation = match (layout.quaternion, layout.heading) {
            (Some(wxyz), _) => {
                let [w, x, y, z] = wxyz.map(number);
                let q = Quaternion::new(w?, x?, y?, z?);
                if self.skips_lost && q.norm() < NO_QUATERNION {
                    self.lost += 1;
                    return Ok(());
                }
                Some(self.unit(q, &cells[wxyz[0]])?)
            }
            (None, Some(heading)) => Some(UnitQuaternion::from_axis_angle(
                &Vector3::z_axis(),
                number(heading)?,
            )),
            (None, None) => None,
        };
        let velocity = match layout.velocity {
            Some(indices) => {
                let [vx, vy, vz, wx, wy, wz] = indices.map(number);
                Some((Vector3::new(vx?, vy?, vz?), Vector3::new(wx?, wy?, wz?)))
            }
            None => None,
        };
        if let Some(&last) = self.times_s.last()
            && time_s <= last
        {
            let is_same = time_s == last
                && self.positions_m.last() == Some(&position)
                && self.orientations.last() == orientation.as_ref();
            if is_same {
                self.repeated += 1;
                return Ok(());
            }
            let cell = layout.clock.columns().next().map(|column| &cells[column]);
            if let Some(cell) = cell {
                let found = cell.locate(Error::invalid(TIME_GOES_BACK));
                self.first_late = self.first_late.or(found.line_column());
                let [before, now] =
                    [&*self.last_stamp, cell.text].map(stamp::seconds_dot_nanoseconds);
                self.unpadded_steps += usize::from(before.is_some() && before < now);
            }
            self.late += 1;
        }
        joint_column::push(
            (&mut self.joints, &mut self.signals),
            (&layout.joints, &layout.signals),
            &layout.names,
            number,
        )?;
        self.orientations.extend(orientation);
        if let Some((linear, angular)) = velocity {
            self.linear_m_s.push(linear);
            self.angular_rad_s.push(angular);
        }
        if let Clock::Column(column) = layout.clock {
            self.last_stamp.clear();
            self.last_stamp.push_str(cells[column].text);
        }
        self.times_s.push(time_s);
        self.lines.push(u32::try_from(line).unwrap_or(u32::MAX));
        self.positions_m.push(position);
        Ok(())
    }

    /// The time of the sample in `cells`, seconds.
    fn time_s(&mut self, layout: &Layout, cells: &[Cell<'_>]) -> Result<f64> {
        let number = |index: usize| cells[index].number(&layout.names[index]);
        match layout.clock {
            Clock::Rate(rate_hz) => Ok((self.rows - 1) as f64 / rate_hz),
            Clock::Counter(column, rate_hz) => Ok(number(column)? / rate_hz),
            Clock::TwoColumns(whole, rest) => {
                Ok(number(whole)? * layout.factors[whole] + number(rest)? * layout.factors[rest])
            }
            Clock::Column(column) => {
                let (text, factor) = (cells[column].text, layout.factors[column]);
                if self.is_unpadded
                    && let Some((seconds, nanoseconds)) = stamp::seconds_dot_nanoseconds(text)
                {
                    return Ok(seconds as f64 + f64::from(nanoseconds) * 1e-9);
                }
                if factor != 1.0
                    && let Some(seconds) = stamp::whole_units(text, factor)
                {
                    return Ok(seconds);
                }
                match number(column) {
                    Ok(number) => Ok(number * factor),
                    Err(error) => match stamp::stamp(text) {
                        Some(stamp) => Ok(self.calendar.seconds(stamp)),
                        None if stamp::is_time_code(text) => Err(error.hint(
                            "does the last part count frames, or hundredths of a second? Write times in seconds, or with a point: 10:15:20.96",
                        )),
                        None if text.contains(':') => Err(error.or_hint(
                            "times are numbers, times of day (10:15:20.5, 10:15:20:500000) or dates with times (2024-05-01T10:15:20.5Z)",
                        )),
                        None => Err(error),
                    },
                }
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    fn unit(&mut self, q: Quaternion<f64>, first: &Cell<'_>) -> Result<UnitQuaternion<f64>> {
        let norm = q.norm();
        let deviation = (norm - 1.0).abs();
        if deviation <= UNIT_EXACT {
            return Ok(UnitQuaternion::new_unchecked(q));
        }
        if deviation > UNIT_ACCEPTED {
            return Err(first.locate(
                Error::invalid("the quaternion does not have length 1")
                    .field("qw, qx, qy, qz")
                    .found(format!("length {norm}"))
                    .allowed(format!("1 within {UNIT_ACCEPTED}"))
                    .hint(if norm < NO_QUATERNION {
                        "the tracker has lost the body here"
                    } else {
                        "these four columns are not one quaternion"
                    })
                    .advise(if norm < NO_QUATERNION {
                        Advice::SkipLost
                    } else {
                        Advice::MapColumns
                    }),
            ));
        }
        if deviation > UNIT_ROUNDED {
            self.renormalised += 1;
            self.largest_deviation = self.largest_deviation.max(deviation);
        }
        Ok(UnitQuaternion::new_unchecked(q / norm))
    }

    /// The trajectory, with its warnings added to the given `warnings`.
    pub(super) fn finish(mut self, layout: &Layout, mut warnings: Vec<Warning>) -> Result<Parsed> {
        let given = self.times_s.len();
        let mut farthest_m = 0.0;
        if self.late > 0 {
            let places = self.places(layout);
            match self.in_file(&places).disorder() {
                Some(Disorder::Late) if self.sorts => {
                    let (sorted, far_m) = self.sorted();
                    (self, farthest_m) = (sorted, far_m);
                }
                Some(disorder) => return Err(self.goes_back(layout, disorder)),
                None => {}
            }
        }
        let at_one_time = given - self.times_s.len();
        if self.times_s.len() < 2 {
            return Err(Error::invalid("too few points for a trajectory")
                .at_line(self.last_line, 1)
                .found(match self.times_s.len() {
                    0 => "no sample",
                    _ => "1 sample",
                })
                .allowed("at least 2 samples")
                .hint(COPY_AGAIN));
        }
        let mut left_out = |code: Code, count: usize, why: &str| {
            if count > 0 {
                let all = counted(count, "sample");
                warnings.push(code.warning(format!("{all} {why}")));
            }
        };
        left_out(Code::LostSamples, self.lost, "without numbers left out");
        left_out(
            Code::DuplicateSamples,
            self.repeated,
            "that repeat the previous sample left out",
        );
        let first = self.first_late.map_or(0, |(line, _)| line);
        left_out(
            Code::SamplesSorted,
            self.late,
            &format!(
                "no later than the previous sample, the first in line {first}; all samples are sorted by time"
            ),
        );
        let mut why = "at the same time as an earlier sample left out".to_owned();
        if farthest_m > 0.0 {
            let far = number(farthest_m);
            why += &format!(", at up to {far} m from it");
        }
        left_out(Code::SamplesSorted, at_one_time, &why);
        if self.renormalised > 0 {
            warnings.push(Code::QuaternionsRenormalised.warning(format!(
                "{} quaternions deviated by up to {:.4} from length 1 and were renormalised",
                self.renormalised, self.largest_deviation
            )));
        }
        let mut trajectory = Trajectory::new(self.times_s, self.positions_m)?;
        if layout.quaternion.is_some() || layout.heading.is_some() {
            trajectory = trajectory.with_orientations(self.orientations)?;
        }
        if layout.velocity.is_some() {
            trajectory = trajectory.with_velocities(self.linear_m_s, self.angular_rad_s)?;
        }
        trajectory = trajectory.with_joints(self.joints)?;
        let (whole, gappy): (Vec<Signal>, Vec<Signal>) = self
            .signals
            .into_iter()
            .partition(|signal| signal.values.iter().all(|value| value.is_finite()));
        if !gappy.is_empty() {
            let names: Vec<&str> = gappy.iter().map(|signal| signal.name.as_str()).collect();
            warnings.push(Code::ColumnsIgnored.warning(format!(
                "columns not used, because some of their rows hold no number: {}",
                excerpt_list(&names)
            )));
        }
        trajectory = trajectory.with_signals(whole)?;
        if layout.z.is_none() {
            trajectory = trajectory.planar();
        }
        Ok(Parsed {
            trajectory,
            warnings,
        })
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
    let error = match found < allowed {
        true => error.hint(
            "if this is the last line, the file is incomplete: copy it again, or delete the line",
        ),
        false => error,
    };
    // The error is located at the first superfluous cell, or at the last cell of a short line.
    Err(match (cells.get(allowed), cells.last()) {
        (Some(cell), _) | (None, Some(cell)) => cell.locate(error),
        (None, None) => error.at_line(line, 1),
    })
}
