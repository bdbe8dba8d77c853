//! A ridge: a direction along which the recordings say little, followed by runs.
//!
//! A Gaussian approximation holds near its centre. Along a direction that is hardly determined the posterior reaches far, and bends: a
//! mass and a friction that act through their ratio alone. So the ridge is followed to both sides by runs, each with steps back to the
//! lowest deviance across the ridge (profile likelihood; Raue et al. 2009).

use nalgebra::{DMatrix, DVector};
use realgap_optimization::UnitPoint;

use super::laplace::Laplace;

/// Steps back to the ridge at each distance along it.
const STEPS_BACK: usize = 10;
/// Distances that are tried on each side.
const DISTANCES: usize = 8;
/// A step back that promises less is not made, in units of the deviance over its inflation.
const SMALL_GAIN: f64 = 0.3;
/// Deviance, relative to the centre, beyond which a distance is too far, and below which the ridge goes on.
const TOO_FAR: f64 = 6.0;
const TOO_NEAR: f64 = 1.5;
/// A ridge that comes this near to the end of the range, as a share of it, ends there.
const AT_THE_END: f64 = 0.01;
/// Deviance that the next distance aims at: that of the ends of a 90 % interval.
const AIM: f64 = 2.7;
/// Points nearer to each other than this share of the ridge are one.
const APART: f64 = 0.05;
/// Points of a ridge through which it is interpolated.
const NEAREST: usize = 4;
/// Deviance at which steps back have not found the ridge.
const LOST: f64 = 30.0;
/// Cells along a ridge, from which draws are made.
const CELLS: usize = 400;

/// A point of a ridge.
#[derive(Debug, Clone)]
struct RidgePoint {
    /// Distance from the centre along the direction.
    along: f64,
    /// What the point is off the straight line along the direction.
    off: DVector<f64>,
    /// Deviance relative to the centre.
    deviance: f64,
    /// Whether the ridge leaves the range here.
    leaves: bool,
}

/// A ridge through the centre of a Gaussian approximation.
#[derive(Debug, Clone)]
pub(super) struct Ridge {
    /// Number of the direction.
    pub direction: usize,
    /// Points along it, increasing.
    points: Vec<RidgePoint>,
    /// Posterior density, without its constant, in each of [`CELLS`] cells from end to end.
    densities: Vec<f64>,
}

/// Follows one side of a ridge; it proposes points one after the other.
pub(super) struct Follower {
    pub direction: usize,
    /// Distance that is tried.
    along: f64,
    /// Largest distance within the range.
    room: f64,
    steps_back: usize,
    distances: usize,
    /// The point that has to be run next; `None` when the side is finished.
    pub next: Option<UnitPoint>,
    /// The lowest point at this distance so far.
    lowest: Option<RidgePoint>,
    /// The last point that was run, with its whitened errors.
    last: (DVector<f64>, DVector<f64>),
    /// Derivatives of the whitened errors, corrected by every run (Broyden 1965).
    jacobian: DMatrix<f64>,
    found: Vec<RidgePoint>,
}

/// How far a line can be followed within the unit cube, to the positive side.
pub(super) fn room(from: &[f64], direction: &DVector<f64>) -> f64 {
    let ends = from.iter().zip(direction.iter()).map(|(at, slope)| {
        let to_end = if *slope > 0.0 { 1.0 - at } else { *at };
        if slope.abs() < 1e-12 {
            f64::INFINITY
        } else {
            to_end / slope.abs()
        }
    });
    ends.fold(f64::INFINITY, f64::min).max(0.0)
}

/// The point, moved to the ends of the range where it lies outside.
pub(super) fn clamped(point: &DVector<f64>) -> UnitPoint {
    point.iter().map(|c| c.clamp(0.0, 1.0)).collect()
}

impl Follower {
    /// Of one side (1 or −1) of a direction.
    pub fn new(laplace: &Laplace, direction: usize, side: f64) -> Self {
        let line = laplace.directions.column(direction) * side;
        let room = room(laplace.centre(), &line);
        let along = side * laplace.deviation(direction).min(room);
        let mut follower = Self {
            direction,
            along,
            room,
            steps_back: 0,
            distances: 0,
            next: None,
            lowest: None,
            last: (
                DVector::from_column_slice(laplace.centre()),
                laplace.whitened(laplace.errors()),
            ),
            jacobian: laplace.jacobian().clone(),
            found: Vec::new(),
        };
        if room > 1e-6 {
            follower.next = Some(clamped(&follower.line(laplace, along)));
        }
        follower
    }

    /// Whether the side was followed to its end.
    pub fn is_finished(&self) -> bool {
        self.next.is_none()
    }

    /// The point at a distance along the direction, off the straight line as the last point of the ridge.
    fn line(&self, laplace: &Laplace, along: f64) -> DVector<f64> {
        let centre = DVector::from_column_slice(laplace.centre());
        let straight = centre + laplace.directions.column(self.direction) * along;
        match self.found.as_slice() {
            [] => straight,
            [one] => straight + &one.off * (along / one.along),
            [.., one, two] => {
                // The parabola through the centre and the last two points.
                let first = along * (along - two.along) / (one.along * (one.along - two.along));
                let second = along * (along - one.along) / (two.along * (two.along - one.along));
                straight + &one.off * first + &two.off * second
            }
        }
    }

    /// Takes the errors of the point that was run; `None` where the run diverged.
    pub fn tell(&mut self, laplace: &Laplace, errors: Option<&[f64]>) {
        let Some(point) = self.next.take() else {
            return;
        };
        let direction = laplace.directions.column(self.direction);
        let inflation = laplace.inflation_along(self.direction);
        let Some(errors) = errors else {
            // The ridge ends where runs diverge; a shorter distance is tried.
            self.go_to(laplace, 0.5 * self.along);
            return;
        };
        let deviance = (laplace.deviance(&point, errors) - laplace.lowest()) / inflation;
        let at = DVector::from_column_slice(&point);
        let from_centre = &at - DVector::from_column_slice(laplace.centre());
        let along = from_centre.dot(&direction);
        let off = from_centre - direction * along;
        if self
            .lowest
            .as_ref()
            .is_none_or(|lowest| deviance < lowest.deviance)
        {
            self.lowest = Some(RidgePoint {
                along,
                off,
                deviance,
                leaves: false,
            });
        }
        self.correct(&at, laplace.whitened(errors));
        let (step, gain) = laplace.step_across(&self.jacobian, (&point, errors), self.direction);
        if self.steps_back < STEPS_BACK && gain / inflation > SMALL_GAIN {
            self.steps_back += 1;
            self.next = Some(clamped(&(at + step)));
            return;
        }
        let Some(lowest) = self.lowest.take() else {
            return;
        };
        let deviance = lowest.deviance;
        let reached = self.found.last().map_or(0.0, |last| last.along);
        if deviance > LOST {
            // The steps back did not find the ridge, so a distance nearer to where it was last found is tried.
            self.go_to(laplace, 0.5 * (reached + self.along));
            return;
        }
        let is_new = self
            .found
            .last()
            .is_none_or(|last| (last.along - lowest.along).abs() > 1e-6);
        let reached = is_new && lowest.along.abs() > 1e-6 && lowest.along * self.along > 0.0;
        if reached {
            self.found.push(lowest);
        }
        let factor = (AIM / deviance.max(0.05)).sqrt().clamp(0.1, 2.5);
        let line = direction * self.along.signum();
        // A bent ridge leaves the range elsewhere than a straight line does.
        self.room = along.abs() + room(&point, &line);
        let is_inside = self.along.abs() < self.room - AT_THE_END;
        if let Some(last) = self.found.last_mut() {
            last.leaves = !is_inside;
        }
        let goes_on = deviance < TOO_NEAR && is_inside;
        if deviance > TOO_FAR || goes_on {
            self.go_to(laplace, factor * self.along);
        }
    }

    /// Corrects the derivatives so that they explain the last step (Broyden 1965).
    fn correct(&mut self, at: &DVector<f64>, errors: DVector<f64>) {
        let moved = at - &self.last.0;
        let square = moved.norm_squared();
        if square > 0.0 {
            let unexplained = &errors - &self.last.1 - &self.jacobian * &moved;
            self.jacobian += unexplained * moved.transpose() / square;
        }
        self.last = (at.clone(), errors);
    }

    fn go_to(&mut self, laplace: &Laplace, along: f64) {
        self.distances += 1;
        self.steps_back = 0;
        if self.distances < DISTANCES {
            self.along = along.signum() * along.abs().min(self.room);
            self.next = Some(clamped(&self.line(laplace, self.along)));
        }
    }
}

impl Ridge {
    /// From both sides.
    pub fn new(sides: [Follower; 2], dimensions: usize) -> Self {
        let direction = sides[0].direction;
        let mut points: Vec<RidgePoint> = sides.into_iter().flat_map(|side| side.found).collect();
        points.push(RidgePoint {
            along: 0.0,
            off: DVector::zeros(dimensions),
            deviance: 0.0,
            leaves: false,
        });
        points.sort_by(|a, b| a.along.total_cmp(&b.along));
        let length = points[points.len() - 1].along - points[0].along;
        // Two points that are close together would amplify their errors between others.
        let mut apart: Vec<RidgePoint> = Vec::new();
        for point in points {
            match apart.last_mut() {
                Some(last) if point.along - last.along < APART * length => {
                    // The outer point is kept, so that the ridge reaches as far as it was followed.
                    if last.along != 0.0 && point.along > 0.0 {
                        *last = point;
                    }
                }
                _ => apart.push(point),
            }
        }
        let mut points = apart;
        // The point with the lowest deviance is the top of the ridge, wherever the descent ended.
        let lowest = points
            .iter()
            .map(|point| point.deviance)
            .fold(0.0, f64::min);
        for point in &mut points {
            point.deviance -= lowest;
        }
        let mut ridge = Self {
            direction,
            points,
            densities: Vec::new(),
        };
        let (from, to) = ridge.ends();
        let cell = |index: usize| from + (to - from) * (index as f64 + 0.5) / CELLS as f64;
        let density = |index: usize| libm::exp(-0.5 * ridge.deviance(cell(index)));
        ridge.densities = (0..CELLS).map(density).collect();
        ridge
    }

    /// Length of the ridge as far as it was followed.
    pub fn length(&self) -> f64 {
        let (from, to) = self.ends();
        to - from
    }

    /// The ends up to which the ridge was followed.
    pub fn ends(&self) -> (f64, f64) {
        let (first, last) = (self.points.first(), self.points.last());
        (
            first.map_or(0.0, |p| p.along),
            last.map_or(0.0, |p| p.along),
        )
    }

    /// The ends at which the ridge leaves the range and is not much less likely than at its top.
    pub fn open_ends(&self) -> (Option<f64>, Option<f64>) {
        let open = |point: Option<&RidgePoint>| {
            let point = point.filter(|point| point.leaves && point.deviance < AIM)?;
            Some(point.along)
        };
        (open(self.points.first()), open(self.points.last()))
    }

    /// The two points around a distance along the ridge, and the share of the second.
    fn between(&self, along: f64) -> (&RidgePoint, &RidgePoint, f64) {
        let after = self.points.partition_point(|point| point.along < along);
        let after = after.clamp(1.min(self.points.len() - 1), self.points.len() - 1);
        let (a, b) = (&self.points[after.saturating_sub(1)], &self.points[after]);
        let length = b.along - a.along;
        let share = if length > 0.0 {
            (along - a.along) / length
        } else {
            0.0
        };
        (a, b, share.clamp(0.0, 1.0))
    }

    /// What the ridge is off the straight line there: the polynomial through the nearest points, at most four (Neville's interpolation).
    pub fn off(&self, along: f64) -> DVector<f64> {
        let (from, to) = self.ends();
        let along = along.clamp(from, to);
        let mut near: Vec<&RidgePoint> = self.points.iter().collect();
        near.sort_by(|a, b| (a.along - along).abs().total_cmp(&(b.along - along).abs()));
        near.truncate(NEAREST);
        let mut values: Vec<DVector<f64>> = near.iter().map(|point| point.off.clone()).collect();
        for order in 1..near.len() {
            for index in 0..near.len() - order {
                let (a, b) = (near[index].along, near[index + order].along);
                values[index] =
                    (&values[index] * (along - b) + &values[index + 1] * (a - along)) / (a - b);
            }
        }
        values.swap_remove(0)
    }

    /// Deviance there relative to the top. Its square root is linear between two points, as that of a parabola is.
    pub fn deviance(&self, along: f64) -> f64 {
        let (a, b, share) = self.between(along);
        let root = a.deviance.sqrt() * (1.0 - share) + b.deviance.sqrt() * share;
        root * root
    }

    /// The distance along the ridge at a share, 0 to 1, of its cumulated density.
    pub fn at_share(&self, share: f64) -> f64 {
        let (from, to) = self.ends();
        let mut left = share * self.densities.iter().sum::<f64>();
        for (index, density) in self.densities.iter().enumerate() {
            if left <= *density {
                let within = left / density.max(f64::MIN_POSITIVE);
                return from + (to - from) * (index as f64 + within) / CELLS as f64;
            }
            left -= density;
        }
        to
    }
}
