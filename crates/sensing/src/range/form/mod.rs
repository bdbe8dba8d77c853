//! Families of curves for the mean and the standard deviation of readings as functions of the distance. Each family is one file
//! and one line of [`FORMS`].

mod exponential;
mod linear;
mod power;
mod table;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

pub use exponential::Exponential;
pub use linear::Linear;
pub use power::Power;
pub use table::Table;

use realgap_core::error::{Error, Result};
use realgap_core::file::look_up;

/// Every form that a log is fitted with, simplest first.
pub const FORMS: [&dyn Form; 4] = [&Linear, &Power, &Exponential, &Table];

/// The form of this name.
///
/// # Errors
/// No such form; the error lists them.
pub fn form_by_name(name: &str) -> Result<&'static dyn Form> {
    look_up("form of a sensor model", name, FORMS, |form| form.name())
}

/// A value at a distance, with its weight in a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Distance, in the model's unit of length.
    pub d: f64,
    /// The value at the distance.
    pub y: f64,
    /// Weight of the value, above 0: one divided by its variance, up to a common factor.
    pub weight: f64,
}

/// A family of curves over the distance d > 0, differentiable in its parameters.
pub trait Form: Sync {
    /// Name in files and options.
    fn name(&self) -> &'static str;

    /// The formula, as shown to users.
    fn formula(&self) -> &'static str;

    /// Knots of a curve that is made of pieces, chosen from the sorted different distances of a log; empty for a formula.
    fn knots(&self, _distances: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Names of the parameters.
    fn parameters(&self, knots: &[f64]) -> Vec<String>;

    /// The value at distance `d`.
    fn value(&self, knots: &[f64], parameters: &[f64], d: f64) -> f64;

    /// The derivatives of the value with respect to the parameters.
    fn gradient(&self, knots: &[f64], parameters: &[f64], d: f64) -> Vec<f64>;

    /// Whether a parameter is a factor of the values. If the values must be above 0, the interval of such a parameter is computed from
    /// its logarithm.
    fn is_factor(&self, _parameter: usize) -> bool {
        false
    }

    /// Parameters of a curve near the points, from which a fit can start; `None` if the form has no curve near them.
    fn start(&self, knots: &[f64], points: &[Point]) -> Option<Vec<f64>>;
}

realgap_core::serde_by_name!(dyn Form, form_by_name);

/// A form with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Form of the curve, by name; `realgap sense fit --help` lists them.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub form: &'static dyn Form,
    /// Knots (distances) of a curve that is made of pieces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub knots: Vec<f64>,
    /// Parameters of the form.
    pub values: Vec<f64>,
}

impl Curve {
    /// A form with these knots and parameters.
    ///
    /// # Errors
    /// Another number of parameters than the form has, values that are not finite, knots that do not increase.
    pub fn new(form: &'static dyn Form, knots: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        let curve = Self {
            form,
            knots,
            values,
        };
        curve.check().map(|()| curve)
    }

    /// Checks that the parameters are those of the form, as [`Curve::new`] does.
    pub(super) fn check(&self) -> Result<()> {
        let Self {
            form,
            knots,
            values,
        } = self;
        let names = form.parameters(knots);
        if names.len() != values.len() || names.is_empty() {
            return Err(Error::invalid(format!(
                "wrong number of values for the form {}",
                form.name()
            ))
            .field("values")
            .found(format!("{} values", values.len()))
            .allowed(match names.len() {
                0 => "knots, and one value at each knot".to_owned(),
                count => format!("{count}: {}", names.join(", ")),
            }));
        }
        if let Some(value) = values.iter().chain(knots).find(|v| !v.is_finite()) {
            return Err(Error::invalid("not a finite number")
                .field("values")
                .found(value));
        }
        if knots.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(Error::invalid("the knots of a table must increase").field("knots"));
        }
        Ok(())
    }

    /// The value at distance `d`, in the model's unit of length.
    pub fn at(&self, d: f64) -> f64 {
        self.form.value(&self.knots, &self.values, d)
    }

    /// The derivatives of the value at distance `d` with respect to the parameters.
    pub fn gradient(&self, d: f64) -> Vec<f64> {
        self.form.gradient(&self.knots, &self.values, d)
    }
}

/// Intercept and slope of the weighted least squares line; `None` for fewer than two different distances.
fn weighted_line(points: &[Point]) -> Option<[f64; 2]> {
    let sum: f64 = points.iter().map(|p| p.weight).sum();
    let mean =
        |of: &dyn Fn(&Point) -> f64| points.iter().map(|p| p.weight * of(p)).sum::<f64>() / sum;
    let (d, y) = (mean(&|p| p.d), mean(&|p| p.y));
    let (dd, dy) = (
        mean(&|p| (p.d - d).powi(2)),
        mean(&|p| (p.d - d) * (p.y - y)),
    );
    let slope = dy / dd;
    (sum > 0.0 && slope.is_finite()).then_some([y - slope * d, slope])
}

/// Sign of the values and points with their logarithms, over the function `along` of the distance; `None` for values of both signs.
fn log_points(points: &[Point], along: impl Fn(f64) -> f64) -> Option<(f64, Vec<Point>)> {
    let sign = points.first()?.y.signum();
    let logs = points.iter().map(|p| {
        let size = sign * p.y;
        (size > 0.0 && p.d > 0.0).then(|| Point {
            d: along(p.d),
            y: libm::log(size),
            // The standard deviation of log y is that of y divided by y.
            weight: p.weight * size * size,
        })
    });
    Some((sign, logs.collect::<Option<_>>()?))
}

/// Weighted least squares for a form that is linear in its parameters.
fn least_squares(points: &[Point], gradient: impl Fn(f64) -> Vec<f64>) -> Option<Vec<f64>> {
    let rows: Vec<Vec<f64>> = points.iter().map(|p| gradient(p.d)).collect();
    let columns = rows.first()?.len();
    let mut normal = DMatrix::zeros(columns, columns);
    let mut right = DVector::zeros(columns);
    for (row, point) in rows.iter().zip(points) {
        for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            right[i] += point.weight * a * point.y;
            for (j, b) in row.iter().enumerate() {
                normal[(i, j)] += point.weight * a * b;
            }
        }
    }
    let solved: Vec<f64> = normal.cholesky()?.solve(&right).iter().copied().collect();
    solved.iter().all(|v| v.is_finite()).then_some(solved)
}
