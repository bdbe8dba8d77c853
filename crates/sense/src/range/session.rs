//! How sessions of one sensor differ: a random effect on every session's mean readings.
//!
//! The mean of session s at distance d is µ(d) + a_s w(d) + c_sd u(d), with normal a and c of mean 0: what a session adds everywhere
//! (how the sensor was mounted, how warm it was) and what it adds at each distance by itself (how the target was put there). Their
//! variances are those of restricted maximum likelihood, the curve is that of generalised least squares (Searle, Casella & McCulloch
//! 1992, chapter 6), and intervals are Student's with Satterthwaite's degrees of freedom from the expected information (Giesbrecht &
//! Burns 1985).

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::cell::Summary;
use super::fit::{Fitted, Plan, fit};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{mean, median, student_quantile};

/// A standard deviation over sessions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spread {
    /// The standard deviation, in the reading's unit.
    pub sd: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it grows with the mean reading, as an error of scale does; it is then the one at the mean of all mean readings.
    pub grows_with_reading: bool,
    /// Share of the mean reading that it is, where it grows with it; 0 elsewhere.
    pub share: f64,
}

/// What the next session reads at one distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextSession {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Angle of offset, degrees.
    pub offset_deg: f64,
    /// Mean reading of all sessions, by the model.
    pub mean: f64,
    /// Lower end of the interval of the session's mean, of as many readings as the log's sessions have there.
    pub mean_low: f64,
    /// Upper end.
    pub mean_high: f64,
    /// Lower end of the interval of one of its readings.
    pub reading_low: f64,
    /// Upper end.
    pub reading_high: f64,
}

/// How the sessions of a log differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionSpread {
    /// Number of sessions.
    pub sessions: usize,
    /// What a session adds at all distances alike.
    pub everywhere: Spread,
    /// What a session adds at each distance by itself.
    pub by_distance: Spread,
    /// What the next session reads, by distance.
    pub next: Vec<NextSession>,
}

/// A curve whose intervals know of sessions.
pub(super) struct WithSessions {
    pub fitted: Fitted,
    /// Degrees of freedom of the mean's parameters.
    pub degrees: Vec<f64>,
    pub spread: SessionSpread,
}

/// Fewest sessions that a spread between them is told of.
pub(super) const LEAST_SESSIONS: usize = 3;
/// −2 times the logarithm of the likelihood ratio that one more assumption needs: 1 % by chance (Wilks 1938).
const CLEAR: f64 = 6.63;
/// Rounds of curve, spread and variances.
const ROUNDS: usize = 3;
/// Cells above which degrees of freedom are those of the sessions alone, because the exact ones cost the cube of the cells.
const MOST_CELLS: usize = 600;

/// How readings of a log that are spread by sessions weigh.
struct Mixed {
    /// Residuals of the cells' means from the curve.
    residual: DVector<f64>,
    /// Gradients of the curve.
    gradient: DMatrix<f64>,
    /// Variance of the cells' means within their session.
    within: Vec<f64>,
    session: Vec<usize>,
    sessions: usize,
    /// Weights w and u.
    everywhere: Vec<f64>,
    by_distance: Vec<f64>,
    /// Whether w and u grow with the mean reading, and the mean of all mean readings.
    grow: [bool; 2],
    usual: f64,
}

/// The solution at given variances.
struct Solved {
    /// −2 times the restricted log-likelihood, up to a constant.
    deviance: f64,
    step: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Mixed {
    /// V⁻¹ times the columns of a matrix, and ln |V|, session by session: a diagonal and one column more (Sherman & Morrison 1950).
    fn weigh(&self, [a, c]: [f64; 2], of: &DMatrix<f64>) -> (DMatrix<f64>, f64) {
        let diagonal: Vec<f64> = (0..self.within.len())
            .map(|k| self.within[k] + c * self.by_distance[k].powi(2))
            .collect();
        let mut weighed = of.clone();
        for (k, d) in diagonal.iter().enumerate() {
            weighed.row_mut(k).scale_mut(1.0 / d);
        }
        let mut log_determinant: f64 = diagonal.iter().map(|d| libm::log(*d)).sum();
        let mut size = vec![0.0; self.sessions];
        let mut sums = DMatrix::<f64>::zeros(self.sessions, of.ncols());
        for k in 0..diagonal.len() {
            let s = self.session[k];
            size[s] += self.everywhere[k].powi(2) / diagonal[k];
            for column in 0..of.ncols() {
                sums[(s, column)] += self.everywhere[k] * weighed[(k, column)];
            }
        }
        for k in 0..diagonal.len() {
            let s = self.session[k];
            let factor = a * self.everywhere[k] / (diagonal[k] * (1.0 + a * size[s]));
            for column in 0..of.ncols() {
                weighed[(k, column)] -= factor * sums[(s, column)];
            }
        }
        log_determinant += size.iter().map(|q| libm::log(1.0 + a * q)).sum::<f64>();
        (weighed, log_determinant)
    }

    fn solve(&self, variances: [f64; 2]) -> Option<Solved> {
        let columns = self.gradient.ncols();
        let mut all = self.gradient.clone().insert_column(columns, 0.0);
        all.set_column(columns, &self.residual);
        let (weighed, log_determinant) = self.weigh(variances, &all);
        // Parameters may have sizes far apart.
        let products = self.gradient.transpose() * &weighed;
        let scale: Vec<f64> = (0..columns).map(|i| products[(i, i)].sqrt()).collect();
        if !scale.iter().all(|s| s.is_finite() && *s > 0.0) {
            return None;
        }
        let scaled = DMatrix::from_fn(columns, columns, |i, j| {
            products[(i, j)] / (scale[i] * scale[j])
        });
        let factor = scaled.cholesky()?;
        let information = 2.0
            * factor
                .l()
                .diagonal()
                .iter()
                .map(|v| libm::log(*v))
                .sum::<f64>();
        let inverse = factor.inverse();
        let covariance = DMatrix::from_fn(columns, columns, |i, j| {
            inverse[(i, j)] / (scale[i] * scale[j])
        });
        let right = products.column(columns).into_owned();
        let step = &covariance * &right;
        let squares = self.residual.dot(&weighed.column(columns)) - right.dot(&step);
        let scales: f64 = scale.iter().map(|s| 2.0 * libm::log(*s)).sum();
        Some(Solved {
            deviance: log_determinant + information + scales + squares,
            step,
            covariance,
        })
    }

    /// The variances of least deviance: golden sections of their roots in turn.
    fn variances(&self, most: f64) -> [f64; 2] {
        let deviance = |sds: [f64; 2]| {
            let solved = self.solve([sds[0] * sds[0], sds[1] * sds[1]]);
            solved.map_or(f64::INFINITY, |s| s.deviance)
        };
        let inner = |a: f64| golden(most, &|c| deviance([a, c]));
        let a = golden(most, &|a| deviance([a, inner(a)]));
        let c = inner(a);
        [a * a, c * c]
    }

    /// Expected covariance of the two variances: the inverse of ½ tr(P Vᵢ P Vⱼ).
    fn variance_covariance(&self, variances: [f64; 2], solved: &Solved) -> Option<DMatrix<f64>> {
        let cells = self.within.len();
        if cells > MOST_CELLS {
            return None;
        }
        let (inverse, _) = self.weigh(variances, &DMatrix::identity(cells, cells));
        let weighed = &inverse * &self.gradient;
        let p = &inverse - &weighed * &solved.covariance * weighed.transpose();
        // P times the two derivatives of V: blocks of a session, a diagonal.
        let mut sums = DMatrix::<f64>::zeros(cells, self.sessions);
        for k in 0..cells {
            for row in 0..cells {
                sums[(row, self.session[k])] += p[(row, k)] * self.everywhere[k];
            }
        }
        let by_session = DMatrix::from_fn(cells, cells, |i, k| {
            sums[(i, self.session[k])] * self.everywhere[k]
        });
        let by_cell =
            DMatrix::from_fn(cells, cells, |i, k| p[(i, k)] * self.by_distance[k].powi(2));
        let parts = [&by_session, &by_cell];
        let information = DMatrix::from_fn(2, 2, |i, j| {
            0.5 * parts[i].component_mul(&parts[j].transpose()).sum()
        });
        information.try_inverse()
    }

    /// Satterthwaite's degrees of freedom of a variance that is a function of the two.
    fn degrees(
        &self,
        variances: [f64; 2],
        covariance: Option<&DMatrix<f64>>,
        of: impl Fn([f64; 2]) -> Option<f64>,
    ) -> f64 {
        let few = (self.sessions - 1) as f64;
        let most = (self.within.len() - self.gradient.ncols()).max(1) as f64;
        let found = || -> Option<f64> {
            let value = of(variances)?;
            let scale = variances[0] + variances[1] + mean(&self.within);
            let slope: Option<Vec<f64>> = (0..2)
                .map(|i| {
                    let mut moved = variances;
                    moved[i] += 1e-4 * scale;
                    Some((of(moved)? - value) / (1e-4 * scale))
                })
                .collect();
            let slope = DVector::from_vec(slope?);
            let variance = (slope.transpose() * covariance? * &slope)[(0, 0)];
            let degrees = 2.0 * value * value / variance;
            degrees.is_finite().then_some(degrees)
        };
        found().map_or(few, |degrees| degrees.clamp(few.min(most), most))
    }
}

/// Where a function of one peak or valley is least between 0 and `most`, to a ten thousandth of it.
fn golden(most: f64, of: &dyn Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (0.0, most);
    let (mut left, mut right) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_left, mut at_right) = (of(left), of(right));
    for _ in 0..20 {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = of(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = of(right);
        }
    }
    let found = 0.5 * (low + high);
    if of(0.0) <= of(found) { 0.0 } else { found }
}

/// Fits curve and sessions; `start` is the fit of independent readings.
///
/// # Errors
/// Fewer than three sessions, sessions that hardly ever read twice at a distance.
pub(super) fn with_sessions(
    plan: Plan,
    start: &Fitted,
    data: &[Summary],
    sessions: usize,
    level: f64,
) -> Result<WithSessions> {
    if sessions < LEAST_SESSIONS {
        return Err(
            Error::invalid("too few sessions for the spread between them")
                .field("session")
                .found(sessions)
                .allowed(format!(
                    "{LEAST_SESSIONS} or more, or a log without that column"
                )),
        );
    }
    let twice: Vec<&Summary> = data.iter().filter(|s| s.count > 1.0).collect();
    if twice.len() < 2 * plan.parameters(start) {
        return Err(
            Error::invalid("sessions hardly ever read twice at one distance, so their spread and that of readings are one")
                .field("session")
                .found(format!("{} distances of sessions with two readings", twice.len()))
                .hint("keep several readings of each session at each distance, or leave the column out"),
        );
    }
    let mut fitted = start.clone();
    let mut last: Option<(usize, Mixed, [f64; 2], Solved)> = None;
    for _ in 0..ROUNDS {
        fitted.spread = spread_within(plan, &fitted, &twice).ok_or_else(cannot)?;
        let kind = last.as_ref().map(|(kind, ..)| *kind);
        let found = candidates(plan, &fitted, data, sessions)
            .into_iter()
            .enumerate()
            .filter(|(index, _)| kind.is_none_or(|kind| kind == *index))
            .filter_map(|(index, mixed)| {
                let size = mixed.residual.norm_squared() / data.len() as f64;
                let variances = mixed.variances(4.0 * size.sqrt().max(f64::MIN_POSITIVE));
                let solved = mixed.solve(variances)?;
                Some((index, mixed, variances, solved))
            })
            .min_by(|a, b| (a.1.doubt(&a.3)).total_cmp(&b.1.doubt(&b.3)))
            .ok_or_else(cannot)?;
        fitted.move_mean(plan, found.3.step.as_slice());
        last = Some(found);
    }
    let (_, mixed, variances, solved) = last.ok_or_else(cannot)?;
    Ok(told(plan, fitted, data, &mixed, variances, &solved, level))
}

fn cannot() -> Error {
    Error::invalid("the spread between sessions cannot be told from this log")
        .hint("leave the column of sessions out, or give each session more distances")
}

/// The spread of readings within their session: deviations from the session's own mean.
fn spread_within(plan: Plan, fitted: &Fitted, twice: &[&Summary]) -> Option<super::form::Curve> {
    let data: Vec<Summary> = twice
        .iter()
        .map(|s| Summary {
            mean: fitted.mean_at(s),
            count: s.count - 1.0,
            ..**s
        })
        .collect();
    fit(plan, &data).map(|within| within.spread)
}

/// The four ways in which sessions may differ: by an amount or by a factor, everywhere and at each distance.
fn candidates(plan: Plan, fitted: &Fitted, data: &[Summary], sessions: usize) -> Vec<Mixed> {
    let gradients: Vec<Vec<f64>> = data.iter().map(|s| fitted.mean_gradient(plan, s)).collect();
    let columns = gradients.first().map_or(0, Vec::len);
    let means: Vec<f64> = data.iter().map(|s| fitted.mean_at(s)).collect();
    let usual = mean(&means.iter().map(|m| m.abs()).collect::<Vec<f64>>());
    let weights = |grows: bool| -> Vec<f64> {
        means
            .iter()
            .map(|m| if grows { m.abs() / usual } else { 1.0 })
            .collect()
    };
    [(false, false), (true, false), (false, true), (true, true)]
        .into_iter()
        .map(|(everywhere, by_distance)| Mixed {
            residual: DVector::from_iterator(
                data.len(),
                data.iter().zip(&means).map(|(s, m)| s.mean - m),
            ),
            gradient: DMatrix::from_fn(data.len(), columns, |k, i| gradients[k][i]),
            within: data
                .iter()
                .map(|s| {
                    let sd = fitted.spread.at(s.distance).max(plan.least_spread);
                    sd * sd / s.count
                })
                .collect(),
            session: data.iter().map(|s| s.session).collect(),
            sessions,
            everywhere: weights(everywhere),
            by_distance: weights(by_distance),
            grow: [everywhere, by_distance],
            usual,
        })
        .collect()
}

fn told(
    plan: Plan,
    mut fitted: Fitted,
    data: &[Summary],
    mixed: &Mixed,
    variances: [f64; 2],
    solved: &Solved,
    level: f64,
) -> WithSessions {
    let of_variances = mixed.variance_covariance(variances, solved);
    let parameters = solved.step.len();
    fitted.mean_errors = (0..parameters)
        .map(|i| solved.covariance[(i, i)].sqrt())
        .collect();
    let degrees = (0..parameters)
        .map(|i| {
            mixed.degrees(variances, of_variances.as_ref(), |v| {
                Some(mixed.solve(v)?.covariance[(i, i)])
            })
        })
        .collect();
    let next = data
        .chunk_by(same_place)
        .map(|place| {
            let first = &place[0];
            let k = data.iter().position(|s| same_place(s, first)).unwrap_or(0);
            let counts: Vec<f64> = place.iter().map(|s| s.count).collect();
            let gradient = DVector::from_vec(fitted.mean_gradient(plan, first));
            let reading = fitted.spread.at(first.distance).powi(2);
            let variance = |v: [f64; 2], own: f64| -> Option<f64> {
                let covariance = mixed.solve(v)?.covariance;
                let curve = (gradient.transpose() * covariance * &gradient)[(0, 0)];
                let between =
                    v[0] * mixed.everywhere[k].powi(2) + v[1] * mixed.by_distance[k].powi(2);
                Some(curve + between + own)
            };
            let mean = fitted.mean_at(first);
            let half = |own: f64| {
                let degrees = mixed.degrees(variances, of_variances.as_ref(), |v| variance(v, own));
                student_quantile(0.5 + 0.5 * level, degrees)
                    * variance(variances, own).unwrap_or(f64::INFINITY).sqrt()
            };
            let (of_mean, of_reading) = (half(reading / median(&counts)), half(reading));
            NextSession {
                distance: first.distance,
                incidence_deg: first.incidence_deg,
                offset_deg: first.offset_deg,
                mean,
                mean_low: mean - of_mean,
                mean_high: mean + of_mean,
                reading_low: mean - of_reading,
                reading_high: mean + of_reading,
            }
        })
        .collect();
    let spread = SessionSpread {
        sessions: mixed.sessions,
        everywhere: everywhere(mixed, variances, level),
        by_distance: by_distance(mixed, variances, level),
        next,
    };
    WithSessions {
        fitted,
        degrees,
        spread,
    }
}

fn same_place(a: &Summary, b: &Summary) -> bool {
    [a.distance, a.incidence_deg, a.offset_deg] == [b.distance, b.incidence_deg, b.offset_deg]
}

/// The interval of a variance that is told with an error's: their sum has these degrees of freedom (χ²).
fn interval(variance: f64, error: f64, degrees: f64, level: f64) -> (f64, f64) {
    let Ok(chi) = ChiSquared::new(degrees.max(1.0)) else {
        return (0.0, f64::INFINITY);
    };
    let end = |share: f64| {
        let sum = (variance + error) * degrees / chi.inverse_cdf(share);
        (sum - error).max(0.0).sqrt()
    };
    (end(0.5 + 0.5 * level), end(0.5 - 0.5 * level))
}

/// A session's mean over its distances tells what it adds everywhere, but for what it adds by distance and its readings.
fn everywhere(mixed: &Mixed, [a, c]: [f64; 2], level: f64) -> Spread {
    let mut told = vec![0.0; mixed.sessions];
    for k in 0..mixed.within.len() {
        let own = mixed.within[k] + c * mixed.by_distance[k].powi(2);
        told[mixed.session[k]] += mixed.everywhere[k].powi(2) / own;
    }
    let errors: Vec<f64> = told.iter().filter(|t| **t > 0.0).map(|t| 1.0 / t).collect();
    let ends = interval(a, mean(&errors), (mixed.sessions - 1) as f64, level);
    mixed.spread(0, a, ends)
}

fn by_distance(mixed: &Mixed, [_, c]: [f64; 2], level: f64) -> Spread {
    let used = mixed.sessions + mixed.gradient.ncols();
    let left = (mixed.within.len() + 1).saturating_sub(used).max(1);
    let errors: Vec<f64> = mixed
        .within
        .iter()
        .zip(&mixed.by_distance)
        .map(|(v, u)| v / (u * u))
        .collect();
    mixed.spread(1, c, interval(c, mean(&errors), left as f64, level))
}

impl Mixed {
    /// The deviance, with what an error of scale has to gain to be believed rather than a plain amount.
    fn doubt(&self, solved: &Solved) -> f64 {
        let grow = self.grow.iter().filter(|grows| **grows).count();
        solved.deviance + CLEAR * grow as f64
    }

    fn spread(&self, which: usize, variance: f64, (low, high): (f64, f64)) -> Spread {
        let sd = variance.sqrt();
        Spread {
            sd,
            low,
            high,
            grows_with_reading: self.grow[which],
            share: if self.grow[which] {
                sd / self.usual
            } else {
                0.0
            },
        }
    }
}
