//! The KITTI format of poses: each line has the twelve numbers of the upper three rows of a matrix from the body frame to the world frame.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::Trajectory;
use super::column::Measure;
use super::format::{Format, Parsed, Rendered, beyond_poses, not_written};
use super::reading::Reading;
use super::text::{Cell, Separator, check_rows, cut, first_line, push_number};
use realgap_core::constant_methods;
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::Code;

/// The poses of the KITTI odometry benchmark, which evo and many SLAM programs read.
///
/// Each line has twelve numbers separated by white space: `r11 r12 r13 x r21 r22 r23 y r31 r32 r33 z`, world from body. There are no
/// times: the reading's `rate_hz` gives the sampling rate, and the first sample is at 0 s. A file does not state the directions of its axes:
/// KITTI's own files have those of a camera ([`Axes`](super::Axes)); a warning asks for them. A file with the extension `.txt` is a KITTI
/// file if its first line has twelve numbers.
#[derive(Debug, Clone, Copy)]
pub struct Kitti;

const NAMES: [&str; 12] = [
    "r11", "r12", "r13", "x", "r21", "r22", "r23", "y", "r31", "r32", "r33", "z",
];
/// The largest element of |RᵀR − 1| that can be due to rounding to a few digits.
const ROUNDED: f64 = 1e-3;
/// The largest element of |RᵀR − 1| of a matrix that is accepted.
const ACCEPTED: f64 = 1e-2;

/// The pose in one line: position in the file's unit, rotation, and the deviation of its matrix from a rotation.
struct Pose {
    place: Vector3<f64>,
    turn: UnitQuaternion<f64>,
    deviation: f64,
}

fn pose(cells: &[Cell<'_>], line: usize) -> Result<Pose> {
    if cells.len() != NAMES.len() {
        let error = Error::invalid("wrong number of columns")
            .found(format!("{} columns", cells.len()))
            .allowed(format!("12 columns: {}", NAMES.join(", ")));
        let odd = cells.get(NAMES.len()).or(cells.last());
        return Err(match odd {
            Some(cell) => cell.locate(error),
            None => error.at_line(line, 1),
        });
    }
    let mut m = [0.0; 12];
    for ((value, cell), name) in m.iter_mut().zip(cells).zip(NAMES) {
        *value = cell.number(name)?;
    }
    let matrix = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    let deviation = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    // The comparison is not written as `>`, so that NaN, which huge numbers give, is refused too.
    if !(deviation <= ACCEPTED && matrix.determinant() > 0.0) {
        return Err(cells[0].locate(
            Error::invalid("these nine numbers are not a rotation")
                .field("r11 to r33")
                .found(format!(
                    "rows with a deviation of up to {deviation:.3} from length 1 and right angles, determinant {:.3}",
                    matrix.determinant()
                ))
                .allowed("three rows of length 1, at right angles, right-handed"),
        ));
    }
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    Ok(Pose {
        place: Vector3::new(m[3], m[7], m[11]),
        turn: UnitQuaternion::new_normalize(
            UnitQuaternion::from_rotation_matrix(&rotation).into_inner(),
        ),
        deviation,
    })
}

impl Format for Kitti {
    constant_methods! {
        name: &'static str = "kitti";
        doc: &'static str = "KITTI poses: the 12 numbers of a 3x4 matrix per line, no times";
        extensions: &'static [&'static str] = &["kitti", "txt"];
    }

    fn recognises(&self, bytes: &[u8]) -> bool {
        let words: Vec<&str> = first_line(bytes).split_whitespace().collect();
        words.len() == NAMES.len() && words.iter().all(|word| word.parse::<f64>().is_ok())
    }

    fn applied(&self, _text: &str, reading: &Reading) -> Reading {
        Reading {
            rate_hz: reading.rate_hz,
            length: reading.length,
            crop: reading.crop,
            skip_lost: reading.skip_lost,
            axes: reading.axes,
            floor_leans: reading.floor_leans,
            ..Reading::default()
        }
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        let Some(rate_hz) = reading.rate_hz else {
            return Err(Error::invalid("KITTI files hold no times")
                .at_line(1, 1)
                .field("rate_hz")
                .allowed("a number of samples per second")
                .advise(Advice::Rate));
        };
        let metres = reading.factor(Measure::Length);
        let (mut times_s, mut places, mut turns) = (Vec::new(), Vec::new(), Vec::new());
        let (mut row, mut last_line, mut odd, mut largest) = (0_usize, 1, 0, 0.0_f64);
        let mut cells = Vec::new();
        for (index, line) in text.lines().enumerate() {
            cut(line, index + 1, Separator::Space, &mut cells)?;
            if cells.is_empty() {
                continue;
            }
            check_rows(row, index + 1)?;
            last_line = index + 1;
            let time_s = row as f64 / rate_hz;
            row += 1;
            if reading.skip_lost == Some(true) && cells.iter().any(Cell::is_lost) {
                continue;
            }
            let pose = pose(&cells, index + 1)?;
            if pose.deviation > ROUNDED {
                odd += 1;
                largest = largest.max(pose.deviation);
            }
            times_s.push(time_s);
            places.push(pose.place * metres);
            turns.push(pose.turn);
        }
        let lost = row - times_s.len();
        let mut warnings = Vec::new();
        if lost > 0 {
            let what = format!("{} without numbers left out", counted(lost, "sample"));
            warnings.push(Code::LostSamples.warning(what));
        }
        if odd > 0 {
            let what = format!(
                "{odd} matrices deviated by up to {largest:.4} from a rotation and were renormalised"
            );
            warnings.push(Code::QuaternionsRenormalised.warning(what));
        }
        if reading.axes.is_none() {
            warnings.push(Code::UnknownAxes.warning(
                "KITTI files do not state the directions of their axes: z up is assumed; the benchmark's own files have a camera's axes, z forward and y down",
            ));
        }
        let trajectory = Trajectory::new(times_s, places)
            .map_err(|error| error.at_line(last_line, 1))?
            .with_orientations(turns)?;
        Ok(Parsed {
            trajectory,
            warnings,
        })
    }

    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        let mut warnings = beyond_poses("KITTI files", trajectory);
        warnings.push(not_written("KITTI files", "times; they are left out"));
        let mut text = String::new();
        for (_, p, turn) in trajectory.poses() {
            let r = turn.to_rotation_matrix();
            for row in 0..3 {
                for value in [r[(row, 0)], r[(row, 1)], r[(row, 2)], p[row]] {
                    push_number(&mut text, value);
                    text.push(' ');
                }
            }
            text.pop();
            text.push('\n');
        }
        Ok(Rendered {
            bytes: text.into_bytes(),
            warnings,
        })
    }
}
