//! A basis of principal components of a set of prepared trajectories (PCA).

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::trajectory::{POINTS, Prepared};
use realgap_core::error::{Error, Result};
use realgap_core::warning::{Code, Warning};

/// Length of the vector (x1..xN, y1..yN) of a prepared trajectory.
pub(super) const VECTOR: usize = 2 * POINTS;

/// How many principal components are kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Components {
    /// The smallest number of components whose share of the total variance reaches this fraction, more than 0 and at most 1.
    Variance(f64),
    /// This number of components, at least 1; all components if there are fewer.
    Count(usize),
}

impl Default for Components {
    fn default() -> Self {
        Self::Variance(0.99)
    }
}

impl Components {
    /// Checks that the number of components is at least 1, or that the share of the variance is between 0 and 1.
    ///
    /// # Errors
    /// 0 components, or a share that is not more than 0 and at most 1.
    pub fn check(self) -> Result<()> {
        self.kept(&[1.0]).map(|_| ())
    }

    /// The number of components that are kept, from their shares of the variance.
    fn kept(self, ratio: &[f64]) -> Result<usize> {
        match self {
            Self::Count(0) => Err(Error::invalid("at least one component must be kept")
                .field("components")
                .found(0)
                .allowed("1 or more")),
            Self::Count(count) => Ok(count.min(ratio.len())),
            Self::Variance(fraction) if fraction > 0.0 && fraction <= 1.0 => {
                let mut sum = 0.0;
                let below = ratio.iter().take_while(|share| {
                    sum += *share;
                    sum < fraction
                });
                Ok((below.count() + 1).min(ratio.len()))
            }
            Self::Variance(fraction) => Err(Error::invalid("not a fraction of the variance")
                .field("variance")
                .found(fraction)
                .allowed("more than 0, at most 1")),
        }
    }
}

/// Principal components of a set of prepared trajectories, each as the vector (x1..xN, y1..yN).
///
/// A basis can be saved (serde) and used again, so that scores of different comparisons can be compared;
/// only the kept components are saved.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    pub(super) mean_m: Vec<f64>,
    /// The orthonormal components, sorted by decreasing variance; at least `kept` of them.
    pub(super) components: Vec<Vec<f64>>,
    pub(super) explained_variance_ratio: Vec<f64>,
    pub(super) kept: usize,
    pub(super) trajectories: usize,
}

impl Basis {
    /// The principal components of `prepared`, centred.
    ///
    /// Every given trajectory is used, so the caller leaves out diverged trajectories and duplicate files. The same
    /// trajectories in the same order give a result with the same bits.
    ///
    /// # Errors
    /// No trajectory, or an invalid choice of components.
    pub fn fit(prepared: &[&Prepared], components: Components) -> Result<Self> {
        if prepared.is_empty() {
            return Err(Error::invalid("a basis needs at least one trajectory"));
        }
        let vectors: Vec<Vec<f64>> = prepared.iter().map(|p| vector(p)).collect();
        let n = vectors.len();
        let mut mean_m = vec![0.0; VECTOR];
        for v in &vectors {
            for (sum, value) in mean_m.iter_mut().zip(v) {
                *sum += value;
            }
        }
        for sum in &mut mean_m {
            *sum /= n as f64;
        }
        let centred = DMatrix::from_fn(VECTOR, n, |row, column| vectors[column][row] - mean_m[row]);
        let (directions, ratio) = principal(&centred);
        let kept = components.kept(&ratio)?;
        Ok(Self {
            mean_m,
            components: directions,
            explained_variance_ratio: ratio,
            kept,
            trajectories: n,
        })
    }

    /// The same basis with another number of kept components.
    ///
    /// # Errors
    /// An invalid choice, or more components than a saved basis holds.
    pub fn keeping(&self, components: Components) -> Result<Self> {
        let kept = components.kept(&self.explained_variance_ratio)?;
        if kept > self.components.len() {
            return Err(Error::invalid("the saved basis holds fewer components")
                .field("components")
                .found(kept)
                .allowed(format!("at most {}", self.components.len()))
                .hint("fit the basis again on the trajectories"));
        }
        Ok(Self {
            kept,
            ..self.clone()
        })
    }

    /// Number of kept components.
    pub fn kept(&self) -> usize {
        self.kept
    }

    /// Number of trajectories to which the basis was fitted.
    pub fn trajectories(&self) -> usize {
        self.trajectories
    }

    /// Share of every component (kept or not) in the total variance of all components; the shares sum to 1, or there are none
    /// if all trajectories were equal.
    pub fn explained_variance_ratio(&self) -> &[f64] {
        &self.explained_variance_ratio
    }

    /// Coefficients of one trajectory, metres: projections of the centred vector on the kept components.
    pub fn coefficients_m(&self, prepared: &Prepared) -> Vec<f64> {
        let centred: Vec<f64> = values(prepared)
            .zip(&self.mean_m)
            .map(|(value, mean)| value - mean)
            .collect();
        self.components[..self.kept]
            .iter()
            .map(|component| dot(component, &centred))
            .collect()
    }

    /// The discrepancy ‖c_a − c_b‖₂ / √N of two trajectories with the coefficients c and N points, metres. With all components it equals
    /// the root mean square distance of the points.
    pub fn discrepancy_m(&self, a: &Prepared, b: &Prepared) -> f64 {
        self.discrepancy_with_m(self.kept, a, b)
    }

    /// [`Basis::discrepancy_m`] with the first `count` components (all components if there are fewer).
    pub(crate) fn discrepancy_with_m(&self, count: usize, a: &Prepared, b: &Prepared) -> f64 {
        let difference = difference(a, b);
        let sum: f64 = self
            .components
            .iter()
            .take(count)
            .map(|component| dot(component, &difference).powi(2))
            .sum();
        (sum / POINTS as f64).sqrt()
    }

    /// A basis with the first two components: of `known` if it holds two, else fitted to `paths`; `None` if there are fewer than two.
    ///
    /// # Errors
    /// No path.
    pub fn plane<'a>(
        known: Option<&Self>,
        paths: impl Iterator<Item = &'a Prepared>,
    ) -> Result<Option<Self>> {
        let two = Components::Count(2);
        let known = known.and_then(|basis| basis.keeping(two).ok());
        let basis = match known {
            Some(basis) => basis,
            None => Self::fit(&paths.collect::<Vec<_>>(), two)?,
        };
        Ok((basis.kept == 2).then_some(basis))
    }

    /// The position of a path in the plane of the first two components, in metres of root mean square distance. The basis must have two
    /// components. The distance of two paths is at least the distance of their points in this plane.
    pub fn in_plane_m(&self, prepared: &Prepared) -> (f64, f64) {
        let coefficients_m = self.coefficients_m(prepared);
        let at = |k: usize| coefficients_m.get(k).copied().unwrap_or(0.0) / (POINTS as f64).sqrt();
        (at(0), at(1))
    }

    /// Shares of the first two components in the variance, 0 to 1.
    pub fn plane_shares(&self) -> [f64; 2] {
        [0, 1].map(|k| self.explained_variance_ratio.get(k).copied().unwrap_or(0.0))
    }

    /// Share of each kept component in the squared distance of all points of `a` and `b`, from 0 to 1.
    ///
    /// The first component is mostly the distance travelled, the others are the shape; the part missing to a sum of 1 lies outside of the
    /// kept components. All shares are 0 for equal trajectories.
    pub fn shares(&self, a: &Prepared, b: &Prepared) -> Vec<f64> {
        let difference = difference(a, b);
        let total = dot(&difference, &difference);
        self.components[..self.kept]
            .iter()
            .map(|component| {
                if total > 0.0 {
                    dot(component, &difference).powi(2) / total
                } else {
                    0.0
                }
            })
            .collect()
    }

    /// A warning if the kept components contain less than half of the squared distance of `a` and `b`.
    pub(super) fn out_of_basis_warning(&self, a: &Prepared, b: &Prepared) -> Option<Warning> {
        let difference = difference(a, b);
        let total_m2 = dot(&difference, &difference) / POINTS as f64;
        let seen_m2 = self.discrepancy_m(a, b).powi(2);
        // A distance below a nanometre gives no warning.
        (total_m2 > 1e-18 && seen_m2 < 0.5 * total_m2).then(|| {
            Code::ComponentsMissDifference.warning(format!(
                "the {} kept components contain {:.0} % of the squared distance, so the discrepancy is too small",
                self.kept,
                100.0 * seen_m2 / total_m2
            ))
        })
    }
}

fn values(prepared: &Prepared) -> impl Iterator<Item = f64> {
    let xy_m = prepared.xy_m().iter();
    xy_m.clone().map(|p| p[0]).chain(xy_m.map(|p| p[1]))
}

/// (x1..xN, y1..yN), metres.
fn vector(prepared: &Prepared) -> Vec<f64> {
    values(prepared).collect()
}

pub(super) fn difference(a: &Prepared, b: &Prepared) -> [f64; VECTOR] {
    let mut difference = [0.0; VECTOR];
    for (index, (p, q)) in a.xy_m().iter().zip(b.xy_m()).enumerate() {
        difference[index] = p[0] - q[0];
        difference[POINTS + index] = p[1] - q[1];
    }
    difference
}

/// Dot product with four running sums, so that the processor does not have to wait for each addition.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (x, y) in a4.iter().zip(b4) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Left singular vectors of a matrix whose columns are centred trajectories, most variance first, and their
/// shares of the total variance; directions without variance are left out.
///
/// The SVD of nalgebra is not used: on tables of three centred trajectories, version 0.35 was wrong by up to 4 % (docs/design.md).
/// The eigenvectors of the symmetric product are orthonormal to the last digit for any rank. Small singular values lose digits in
/// the product, but this does not matter, because the variances are computed again from the matrix.
fn principal(centred: &DMatrix<f64>) -> (Vec<Vec<f64>>, Vec<f64>) {
    let total = centred.norm_squared();
    if total <= 0.0 {
        return (Vec::new(), Vec::new());
    }
    let (rows, columns) = centred.shape();
    // With fewer trajectories than dimensions, an orthonormal basis of their span makes the product small.
    let (span, reduced) = if columns < rows {
        let (q, r) = centred.clone().qr().unpack();
        (Some(q), Cow::Owned(r))
    } else {
        (None, Cow::Borrowed(centred))
    };
    let product: DMatrix<f64> = &*reduced * reduced.transpose();
    let vectors = product.symmetric_eigen().eigenvectors;
    let mut found: Vec<(f64, usize)> = (reduced.transpose() * &vectors)
        .column_iter()
        .map(|column| column.norm_squared())
        .zip(0..)
        .collect();
    // The sort is stable, so that equal variances keep their order and the result is reproducible.
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let negligible = (rows.max(columns) as f64 * f64::EPSILON).powi(2) * found[0].0;
    // Centring removes one dimension.
    found.truncate(columns - 1);
    found.retain(|(variance, _)| *variance > negligible);
    found
        .into_iter()
        .map(|(variance, index)| {
            let vector = vectors.column(index);
            let direction: DVector<f64> = match &span {
                Some(span) => span * vector,
                None => vector.into_owned(),
            };
            // The sign of a component has no meaning; it is fixed by a rule, so that saved bases can be compared.
            let sign = if direction[direction.icamax()] < 0.0 {
                -1.0
            } else {
                1.0
            };
            let direction: Vec<f64> = direction.iter().map(|value| sign * value).collect();
            (direction, variance / total)
        })
        .unzip()
}
