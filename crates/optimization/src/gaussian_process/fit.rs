//! Length scales, variance and noise that make some values most likely.

use nalgebra::{DMatrix, DVector};

use super::{GaussianProcess, Hyperparameters, Matern};

/// Bounds of length scales, variance and noise; points lie in 0 to 1, values have variance 1.
const LENGTH: (f64, f64) = (0.02, 20.0);
const VARIANCE: (f64, f64) = (1e-2, 1e2);
const NOISE: (f64, f64) = (1e-8, 1.0);
/// Starts of the ascent: length, variance, noise.
const STARTS: [(f64, f64, f64); 3] = [(0.3, 1.0, 1e-3), (1.0, 1.0, 0.1), (0.1, 1.0, 1e-2)];
/// Most quasi-Newton steps from each start, and the slope below which the ascent ends.
const STEPS: usize = 40;
const LEVEL: f64 = 1e-2;

impl<'a> GaussianProcess<'a> {
    /// With the hyperparameters of maximum likelihood, found by ascent from three starts.
    pub fn fit(points: &'a [Vec<f64>], values: &[f64]) -> Option<Self> {
        let dimensions = points.first()?.len();
        let mut best: Option<Self> = None;
        for (length, variance, noise) in STARTS {
            let start = Hyperparameters {
                kernel: Matern {
                    lengths: vec![length; dimensions],
                    variance,
                },
                noise,
            };
            let Some(fitted) = Self::new(points, values, start).map(|s| s.ascend(values)) else {
                continue;
            };
            if (best.as_ref()).is_none_or(|best| fitted.log_likelihood > best.log_likelihood) {
                best = Some(fitted);
            }
        }
        best
    }

    /// Follows the likelihood uphill within the bounds: BFGS on the axes that no bound holds (Bertsekas 1982).
    fn ascend(self, values: &[f64]) -> Self {
        let dimensions = self.hyperparameters().kernel.lengths.len();
        let bound = |index: usize| {
            let (low, high) = match index.checked_sub(dimensions) {
                None => LENGTH,
                Some(0) => VARIANCE,
                Some(_) => NOISE,
            };
            (libm::log(low), libm::log(high))
        };
        let size = dimensions + 2;
        let mut here = self;
        let mut at = here.hyperparameters().logarithms();
        let mut slope = here.slope();
        let mut curvature = DMatrix::<f64>::identity(size, size);
        for _ in 0..STEPS {
            let held: Vec<bool> = (0..size)
                .map(|index| {
                    let (low, high) = bound(index);
                    (at[index] <= low && slope[index] < 0.0)
                        || (at[index] >= high && slope[index] > 0.0)
                })
                .collect();
            let free =
                |v: &DVector<f64>| DVector::from_fn(size, |i, _| if held[i] { 0.0 } else { v[i] });
            let uphill = free(&slope);
            if uphill.amax() < LEVEL {
                break;
            }
            let mut direction = free(&(&curvature * &uphill));
            if direction.dot(&uphill) <= 0.0 {
                curvature.fill_with_identity();
                direction = uphill.clone();
            }
            // No step multiplies a number by more than e².
            direction *= (2.0 / direction.amax()).min(1.0);
            let mut share = 1.0;
            let step = loop {
                let to = DVector::from_fn(size, |index, _| {
                    let (low, high) = bound(index);
                    (at[index] + share * direction[index]).clamp(low, high)
                });
                let hyperparameters = Hyperparameters::from_logarithms(to.as_slice());
                let gain = 1e-4 * uphill.dot(&(&to - &at));
                match Self::new(here.points, values, hyperparameters) {
                    Some(next) if next.log_likelihood >= here.log_likelihood + gain => {
                        break Some((to, next));
                    }
                    _ if share < 1e-3 => break None,
                    _ => share *= 0.4,
                }
            };
            let Some((to, next)) = step else { break };
            let next_slope = next.slope();
            let (moved, bent) = (&to - &at, &slope - &next_slope);
            let product = moved.dot(&bent);
            if product > 1e-10 * moved.norm() * bent.norm() {
                let left = DMatrix::identity(size, size) - &moved * bent.transpose() / product;
                curvature =
                    &left * &curvature * left.transpose() + &moved * moved.transpose() / product;
            }
            (here, at, slope) = (next, to, next_slope);
        }
        here
    }
}
