//! Prepares trajectories for comparison: 182 points, which start at the origin and lead along +x.

use std::ops::Range;

use nalgebra::{UnitQuaternion, Vector3};

use super::Trajectory;
use super::align::{Alignment, Direction, direction, heading};
use super::resample::{Interpolator, uniform};
use realgap_core::error::{Error, Result};
use realgap_core::warning::Warning;

/// Number of points of a prepared trajectory (paper 003, section 2.2, step 1).
pub const POINTS: usize = 182;

/// The longest path that can be compared, metres; squares of larger distances lose their precision.
const MAX_PATH_M: f64 = 1e12;

/// A trajectory in the form in which trajectories are compared: made by [`prepare`].
///
/// [`POINTS`] points uniform in time; the first is the origin; the net displacement lies on +x. Nothing is
/// mirrored or scaled.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    xy_m: Vec<[f64; 2]>,
    z_m: Option<Vec<f64>>,
    orientations: Option<Vec<UnitQuaternion<f64>>>,
    net_displacement_m: f64,
    path_length_m: f64,
    heading_rad: f64,
    alignment: Alignment,
    warnings: Vec<Warning>,
}

/// Prepares a trajectory for comparison (paper 003, section 2.2).
///
/// 1. Resample to [`POINTS`] points, uniform in time, both ends kept, linear (orientation: slerp).
/// 2. Subtract the first point.
/// 3. Turn the whole (also the orientations) about z so that the net displacement lies on +x. If that
///    is below 1 % of the path length or below 1 mm, the major principal axis is turned onto +x instead, and
///    the warning `undefined-heading` is attached.
///
/// Path length and net displacement are those of the resampled path in the x-y plane.
///
/// ```
/// use nalgebra::Vector3;
/// use realgap_path::trajectory::{Trajectory, prepare};
///
/// let north = Trajectory::new(
///     vec![0.0, 1.0],
///     vec![Vector3::new(1.0, 1.0, 0.0), Vector3::new(1.0, 3.0, 0.0)],
/// )?;
/// let prepared = prepare(&north)?;
/// assert_eq!(prepared.xy_m().len(), 182);
/// assert!((prepared.xy_m()[181][0] - 2.0).abs() < 1e-12);
/// assert!((prepared.heading_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// Positions or times so large that distances are no longer finite numbers (paths over 10¹² m).
pub fn prepare(trajectory: &Trajectory) -> Result<Prepared> {
    prepare_as(trajectory, Alignment::NetDisplacement)
}

/// As [`prepare`], with another direction of the path turned onto +x.
///
/// # Errors
/// As [`prepare`]; [`Alignment::StartHeading`] of a trajectory without orientations.
pub fn prepare_as(trajectory: &Trajectory, alignment: Alignment) -> Result<Prepared> {
    let positions = trajectory.positions_world_m();
    let orientations = trajectory.orientations_world_from_body();
    let start = positions[0];
    let mut interpolator = Interpolator::new(trajectory);
    let mut xy_m = Vec::with_capacity(POINTS);
    let mut z_m = (!trajectory.is_planar()).then(|| Vec::with_capacity(POINTS));
    let mut turned = orientations.map(|_| Vec::with_capacity(POINTS));
    for index in 0..POINTS {
        let place = interpolator.place(uniform(trajectory.duration_s(), index, POINTS));
        let point = place.lerp(positions) - start;
        xy_m.push([point.x, point.y]);
        if let Some(z_m) = &mut z_m {
            z_m.push(point.z);
        }
        if let (Some(turned), Some(all)) = (&mut turned, orientations) {
            turned.push(place.slerp(all));
        }
    }
    let path_length_m = path_length(&xy_m);
    let highest = z_m.iter().flatten().fold(0.0, |a: f64, z| a.max(z.abs()));
    if !comparable(path_length_m + highest) {
        return Err(Error::invalid("the path is too long to be compared")
            .found(format!("{path_length_m:e} m"))
            .allowed(format!("at most {MAX_PATH_M:e} m"))
            .hint("check the unit of the file, and the tracker for lost samples"));
    }
    let (forward, warning) = match (alignment, orientations) {
        (Alignment::NetDisplacement, _) => direction(&xy_m, path_length_m),
        (Alignment::World, _) => (Direction::X, None),
        (Alignment::StartHeading, Some(all)) => heading(&all[0]),
        (Alignment::StartHeading, None) => {
            return Err(
                Error::invalid("a trajectory without orientations has no start heading")
                    .hint("align: World compares directions in the world as they are"),
            );
        }
    };
    for point in &mut xy_m {
        *point = forward.turn(*point);
    }
    let heading_rad = forward.angle_rad();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -heading_rad);
    for q in turned.iter_mut().flatten() {
        *q = turn * *q;
    }
    let [x, y] = xy_m[POINTS - 1];
    Ok(Prepared {
        net_displacement_m: x.hypot(y),
        xy_m,
        z_m,
        orientations: turned,
        path_length_m,
        heading_rad,
        alignment,
        warnings: warning.into_iter().collect(),
    })
}

/// True if a path of this length can be compared; NaN cannot be compared.
fn comparable(length_m: f64) -> bool {
    (0.0..=MAX_PATH_M).contains(&length_m)
}

fn path_length(xy_m: &[[f64; 2]]) -> f64 {
    xy_m.windows(2)
        .map(|w| {
            let (dx, dy) = (w[1][0] - w[0][0], w[1][1] - w[0][1]);
            (dx * dx + dy * dy).sqrt()
        })
        .sum()
}

/// A path in the plane, moved and turned so that it starts at the origin and its net displacement (or principal axis, see [`prepare`]) lies
/// on +x.
///
/// # Panics
/// A path without points.
pub fn turned(path_m: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [x0, y0] = path_m[0];
    let from_start: Vec<[f64; 2]> = path_m.iter().map(|[x, y]| [x - x0, y - y0]).collect();
    let (forward, _) = direction(&from_start, path_length(&from_start));
    from_start.into_iter().map(|p| forward.turn(p)).collect()
}

impl Prepared {
    /// Restores a prepared trajectory from its points, e.g. from a store: [`POINTS`] points exactly as
    /// [`Prepared::xy_m`] returned them.
    ///
    /// Heights, orientations and warnings are not restored, and the heading is 0.
    ///
    /// # Errors
    /// Another number of points, a first point that is not the origin, or numbers that are not finite.
    pub fn from_xy_m(xy_m: Vec<[f64; 2]>) -> Result<Self> {
        if xy_m.len() != POINTS {
            return Err(Error::invalid("wrong number of prepared points")
                .found(xy_m.len())
                .allowed(POINTS));
        }
        let path_length_m = path_length(&xy_m);
        if xy_m[0] != [0.0, 0.0] || !comparable(path_length_m) {
            return Err(Error::invalid("these points are not a prepared trajectory")
                .allowed("finite metres, the first point at the origin"));
        }
        let [x, y] = xy_m[POINTS - 1];
        Ok(Self {
            net_displacement_m: x.hypot(y),
            xy_m,
            z_m: None,
            orientations: None,
            path_length_m,
            heading_rad: 0.0,
            alignment: Alignment::default(),
            warnings: Vec::new(),
        })
    }

    /// The points in the plane, metres: start at the origin, net displacement on +x.
    pub fn xy_m(&self) -> &[[f64; 2]] {
        &self.xy_m
    }

    /// A part of these points, prepared as a path of its own: it starts at the origin, with its own net displacement on +x.
    ///
    /// # Panics
    /// A range that is not within the points, or empty.
    pub fn part_xy_m(&self, points: Range<usize>) -> Vec<[f64; 2]> {
        turned(&self.xy_m[points])
    }

    /// Heights above the start, metres; `None` if z was not recorded.
    pub fn z_m(&self) -> Option<&[f64]> {
        self.z_m.as_deref()
    }

    /// Orientations (from the body frame into the turned world frame), if recorded.
    pub fn orientations(&self) -> Option<&[UnitQuaternion<f64>]> {
        self.orientations.as_deref()
    }

    /// Distance from first to last point in the plane, metres.
    pub fn net_displacement_m(&self) -> f64 {
        self.net_displacement_m
    }

    /// Length of the resampled path in the plane, metres.
    pub fn path_length_m(&self) -> f64 {
        self.path_length_m
    }

    /// Direction in the world that was turned onto +x, radians from world +x, in (−π, π].
    pub fn heading_rad(&self) -> f64 {
        self.heading_rad
    }

    /// Which direction was turned onto +x.
    pub fn alignment(&self) -> Alignment {
        self.alignment
    }

    /// The warning `undefined-heading`, if the principal axis was aligned.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
