//! Estimates the variation between sessions of one sensor by random effects on the mean readings of each session.
//!
//! The mean of session s at distance d is µ(d) + a_s w(d) + c_sd u(d), with normal a and c of mean 0. The effect a is the same at all
//! distances (how the sensor was mounted, how warm it was); the effect c differs between distances (how the target was placed). Their
//! variances are estimated by restricted maximum likelihood, the curve by generalised least squares (Searle, Casella & McCulloch
//! 1992, chapter 6). Intervals are those of Student's distribution with Satterthwaite's degrees of freedom from the expected
//! information (Giesbrecht & Burns 1985).

mod mixed;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use mixed::{Mixed, Solved};

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
    /// Lower end of the interval of the standard deviation.
    pub low: f64,
    /// Upper end of the interval of the standard deviation.
    pub high: f64,
    /// Whether the standard deviation grows with the mean reading, as for an error of scale; it is then stated for the mean of all
    /// mean readings.
    pub grows_with_reading: bool,
    /// The standard deviation as a share of the mean reading, if it grows with the mean reading; otherwise 0.
    pub share: f64,
}

/// Prediction of the readings of the next session at one distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextSession {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Angle of offset, degrees.
    pub offset_deg: f64,
    /// Mean reading over all sessions according to the model.
    pub mean: f64,
    /// Lower end of the interval of the session's mean, for as many readings as the sessions of the log have at this distance.
    pub mean_low: f64,
    /// Upper end of the interval of the session's mean.
    pub mean_high: f64,
    /// Lower end of the interval of a single reading of the session.
    pub reading_low: f64,
    /// Upper end of the interval of a single reading of the session.
    pub reading_high: f64,
}

/// Variation between the sessions of a log.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionSpread {
    /// Number of sessions.
    pub sessions: usize,
    /// Variation between sessions that is common to all distances.
    pub everywhere: Spread,
    /// Variation between sessions that differs between distances.
    pub by_distance: Spread,
    /// Prediction of the next session, for each distance.
    pub next: Vec<NextSession>,
}

/// A fitted curve whose intervals include the variation between sessions.
pub(super) struct WithSessions {
    pub fitted: Fitted,
    /// Degrees of freedom of the mean's parameters.
    pub degrees: Vec<f64>,
    pub spread: SessionSpread,
}

/// Smallest number of sessions for an estimate of the variation between sessions.
pub(super) const LEAST_SESSIONS: usize = 3;
/// Number of rounds in which curve, spread and variances are estimated in turn.
const ROUNDS: usize = 3;

/// Fits the curve and the variation between sessions; `start` is the fit that treats all readings as independent.
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
            Error::invalid("too few sessions to estimate the variation between them")
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
            Error::invalid("sessions have hardly any repeated readings at one distance, so the variation between sessions cannot be separated from that of readings")
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
            .min_by(|a, b| {
                let (a, b) = (a.1.penalised_deviance(&a.3), b.1.penalised_deviance(&b.3));
                a.total_cmp(&b)
            })
            .ok_or_else(cannot)?;
        fitted.move_mean(plan, found.3.step.as_slice());
        last = Some(found);
    }
    let (_, mixed, variances, solved) = last.ok_or_else(cannot)?;
    Ok(summarised(
        plan, fitted, data, &mixed, variances, &solved, level,
    ))
}

fn cannot() -> Error {
    Error::invalid("the variation between sessions cannot be estimated from this log")
        .hint("leave the column of sessions out, or give each session more distances")
}

/// The standard deviation of readings within their session, from deviations from the session's own mean.
fn spread_within(
    plan: Plan,
    fitted: &Fitted,
    twice: &[&Summary],
) -> Option<crate::range::form::Curve> {
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

/// The four models of the differences between sessions: a constant offset or an error of scale, for the common effect and for the
/// effect at each distance.
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

/// The standard errors, degrees of freedom, variation between sessions and predictions of a solution.
fn summarised(
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

/// The interval of a standard deviation whose variance is known only as a sum with the variance of an error; the sum has these
/// degrees of freedom (χ²).
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

/// The variation that is common to all distances. It is estimated from the mean of each session over its distances, whose errors are
/// the effect at each distance and the noise of readings.
fn everywhere(mixed: &Mixed, [a, c]: [f64; 2], level: f64) -> Spread {
    let mut precisions = vec![0.0; mixed.sessions];
    for k in 0..mixed.within.len() {
        let own = mixed.within[k] + c * mixed.by_distance[k].powi(2);
        precisions[mixed.session[k]] += mixed.everywhere[k].powi(2) / own;
    }
    let known = precisions.iter().filter(|p| **p > 0.0);
    let errors: Vec<f64> = known.map(|p| 1.0 / p).collect();
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
