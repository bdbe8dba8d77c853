//! Solves the linear least-squares problem for the centre of mass and gravity over many flights.

use nalgebra::{SMatrix, SVector, Vector3};

use realgap_path::trajectory::Trajectory;

/// Normal equations of one flight.
///
/// In flight p(t) + R(t) c = a + b t + g t²/2, with c the centre of mass in the body and g the gravity. The start a
/// and the velocity b differ between flights: they are eliminated for each axis by subtracting the straight line over time that
/// fits best. The remaining equations are linear in (c, g), and the normal equations of several flights can be added.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Equations {
    matrix: SMatrix<f64, 6, 6>,
    right: SVector<f64, 6>,
    squares: f64,
    freedom: f64,
}

impl Equations {
    /// The equations of the samples from `first` up to but not including `end`; `None` for fewer than three samples or without
    /// orientations.
    pub fn new(motion: &Trajectory, first: usize, end: usize) -> Option<Self> {
        let orientations = motion.orientations_world_from_body()?.get(first..end)?;
        let positions = motion.positions_world_m().get(first..end)?;
        let times_s: Vec<f64> = motion.times_s()[first..end]
            .iter()
            .map(|t| t - motion.times_s()[first])
            .collect();
        if times_s.len() < 3 {
            return None;
        }
        let fall = without_line(&times_s, times_s.iter().map(|t| 0.5 * t * t));
        let mut sum = Self {
            matrix: SMatrix::zeros(),
            right: SVector::zeros(),
            squares: 0.0,
            freedom: 3.0 * (times_s.len() as f64 - 2.0),
        };
        for axis in 0..3 {
            let seen = without_line(&times_s, positions.iter().map(|p| p[axis]));
            let arms: Vec<Vec<f64>> = (0..3)
                .map(|column| {
                    let arm = Vector3::ith(column, 1.0);
                    without_line(&times_s, orientations.iter().map(|q| -(q * arm)[axis]))
                })
                .collect();
            for k in 0..times_s.len() {
                let mut row = SVector::<f64, 6>::zeros();
                for (column, arm) in arms.iter().enumerate() {
                    row[column] = arm[k];
                }
                row[3 + axis] = fall[k];
                sum.matrix += row * row.transpose();
                sum.right += row * seen[k];
                sum.squares += seen[k] * seen[k];
            }
        }
        Some(sum)
    }

    /// Sum of the equations, each multiplied by its weight.
    pub fn sum(equations: &[Self], weights: &[f64]) -> Self {
        let mut sum = Self {
            matrix: SMatrix::zeros(),
            right: SVector::zeros(),
            squares: 0.0,
            freedom: 0.0,
        };
        for (one, weight) in equations.iter().zip(weights) {
            sum.matrix += one.matrix * *weight;
            sum.right += one.right * *weight;
            sum.squares += one.squares * weight;
            sum.freedom += one.freedom * weight;
        }
        sum
    }

    /// Centre of mass (m) and gravity (m/s²); `None` if the robot did not turn, so that c cannot be determined.
    pub fn solve(&self) -> Option<[f64; 6]> {
        let solution = self.matrix.lu().solve(&self.right)?;
        solution
            .iter()
            .all(|v| v.is_finite())
            .then(|| std::array::from_fn(|index| solution[index]))
    }

    /// Root mean square residual of a solution per axis, metres.
    pub fn residual_m(&self, solution: &[f64; 6]) -> f64 {
        let x = SVector::<f64, 6>::from_column_slice(solution);
        let squares = self.squares - 2.0 * self.right.dot(&x) + x.dot(&(self.matrix * x));
        (squares.max(0.0) / (self.freedom - 6.0).max(1.0)).sqrt()
    }
}

/// Position at time 0 and velocity of the straight line over time that fits the positions best.
pub(super) fn line(times_s: &[f64], places_m: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let n = times_s.len() as f64;
    let mean_s = times_s.iter().sum::<f64>() / n;
    let spread: f64 = times_s.iter().map(|t| (t - mean_s).powi(2)).sum();
    let places = times_s.iter().zip(places_m);
    let velocity = places
        .map(|(t, place)| place * (t - mean_s))
        .sum::<Vector3<f64>>()
        / spread;
    let start = places_m.iter().sum::<Vector3<f64>>() / n - velocity * mean_s;
    (start, velocity)
}

/// The values minus the straight line over time that fits them best.
fn without_line(times_s: &[f64], values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean_s = times_s.iter().sum::<f64>() / n;
    let mean = values.iter().sum::<f64>() / n;
    let (mut along, mut spread) = (0.0, 0.0);
    for (t, v) in times_s.iter().zip(&values) {
        along += v * (t - mean_s);
        spread += (t - mean_s).powi(2);
    }
    let slope = along / spread;
    times_s
        .iter()
        .zip(&values)
        .map(|(t, v)| v - mean - slope * (t - mean_s))
        .collect()
}
