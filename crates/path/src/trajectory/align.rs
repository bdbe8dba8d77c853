//! The direction of a path that is turned onto +x: its net displacement, its heading at the start, or that of the world.

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::warning::{Code, Warning};

/// Below this fraction of the path length the net displacement has no meaningful direction.
const MIN_NET_FRACTION: f64 = 0.01;
/// The smallest net displacement, metres, whose direction is not only tracking noise.
const MIN_NET_M: f64 = 0.001;
/// Relative size below which a quantity that could decide a direction counts as zero.
const UNDECIDED: f64 = 1e-9;

/// Which direction of a path is turned onto +x before it is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Alignment {
    /// Its net displacement: on level ground a robot may start in any direction (paper 003, section 2.2).
    #[default]
    NetDisplacement,
    /// The direction of the tracked body's x axis at the start. Recordings need orientations.
    StartHeading,
    /// None: directions in the world matter, as on a slope, between walls, or beside other bodies. Recordings and simulation need
    /// one world frame.
    World,
}

/// A unit vector in the x-y plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Direction {
    pub(super) cos: f64,
    pub(super) sin: f64,
}

impl Direction {
    pub(super) const X: Self = Self { cos: 1.0, sin: 0.0 };

    fn of([x, y]: [f64; 2]) -> Self {
        let norm = x.hypot(y);
        Self {
            cos: x / norm,
            sin: y / norm,
        }
    }

    fn along(self, [x, y]: [f64; 2]) -> f64 {
        self.cos * x + self.sin * y
    }

    fn reversed(self) -> Self {
        Self {
            cos: -self.cos,
            sin: -self.sin,
        }
    }

    /// The coordinates of `point` in a frame whose +x axis is this direction.
    pub(super) fn turn(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x + self.sin * y, self.cos * y - self.sin * x]
    }

    /// Angle from +x, radians, in (−π, π].
    pub(super) fn angle_rad(self) -> f64 {
        self.sin.atan2(self.cos)
    }
}

/// An axis steeper than this, as the length of its projection, has no heading.
const LEAST_PROJECTION: f64 = 0.1;

/// Heading of a body's x axis in the plane, with a warning where it is vertical.
pub(super) fn heading(start: &UnitQuaternion<f64>) -> (Direction, Option<Warning>) {
    let axis = start * Vector3::x();
    match axis.x.hypot(axis.y) > LEAST_PROJECTION {
        true => (Direction::of([axis.x, axis.y]), None),
        false => {
            let what = "the x axis of the tracked body is vertical at the start, so it has no heading: the path was not turned";
            (Direction::X, Some(Code::UndefinedHeading.warning(what)))
        }
    }
}

/// Direction of a path that starts at the origin (paper 003, section 2.2, step 3).
///
/// This is the direction of the net displacement; if the net displacement is below 1 % of the path length or below 1 mm, it is the
/// major principal axis of the points, with a warning.
pub(super) fn direction(points_m: &[[f64; 2]], path_length_m: f64) -> (Direction, Option<Warning>) {
    let net = points_m.last().copied().unwrap_or_default();
    let net_m = net[0].hypot(net[1]);
    if net_m >= MIN_NET_M && net_m >= MIN_NET_FRACTION * path_length_m {
        return (Direction::of(net), None);
    }
    let warning = Code::UndefinedHeading.warning(format!(
        "net displacement {net_m:.3e} m is below 1 mm or 1 % of the path length {path_length_m:.3e} m: \
             the major principal axis was aligned instead"
    ));
    (principal_direction(points_m), Some(warning))
}

/// The major principal axis, with a sign that does not depend on the orientation of the path.
///
/// An axis has two directions. The chosen direction points from the start towards the centroid. If the
/// centroid does not decide (a path symmetric about its start), the centroid of the first half in time decides; then
/// the side of the longer tail (third moment). A path without a principal axis (a circle) points from its start to
/// its centroid; a motionless path points along +x.
fn principal_direction(points_m: &[[f64; 2]]) -> Direction {
    let centroid = mean(points_m);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in points_m {
        let (dx, dy) = (x - centroid[0], y - centroid[1]);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    let total = xx + yy;
    if total <= 0.0 {
        return Direction::X;
    }
    let spread_m = (total / points_m.len() as f64).sqrt();
    // If the two eigenvalues are equal, every direction is a principal axis.
    if (xx - yy).hypot(2.0 * xy) <= UNDECIDED * total {
        let distance = centroid[0].hypot(centroid[1]);
        return if distance > UNDECIDED * spread_m {
            Direction::of(centroid)
        } else {
            Direction::X
        };
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let axis = Direction {
        cos: angle.cos(),
        sin: angle.sin(),
    };
    let skew = || {
        let centre = axis.along(centroid);
        let third = points_m.iter().map(|&p| (axis.along(p) - centre).powi(3));
        (third.sum::<f64>() / points_m.len() as f64).cbrt()
    };
    let half = || axis.along(mean(&points_m[..points_m.len() / 2]));
    for sign in [axis.along(centroid), half(), skew()] {
        if sign.abs() > UNDECIDED * spread_m {
            return if sign < 0.0 { axis.reversed() } else { axis };
        }
    }
    axis
}

fn mean(points_m: &[[f64; 2]]) -> [f64; 2] {
    let n = points_m.len().max(1) as f64;
    let (x, y) = points_m
        .iter()
        .fold((0.0, 0.0), |(sx, sy), [x, y]| (sx + x, sy + y));
    [x / n, y / n]
}
