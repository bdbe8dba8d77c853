//! Fits a range sensor's model to a log, with confidence intervals and tests of the model.

mod distance;
mod text;

use serde::{Serialize, Serializer};
use statrs::function::gamma::gamma_ur;

pub use distance::{DistanceReport, Normality};
use distance::{normality, reading_warnings, report};

use super::cell::{Cell, Summary, cells, outlier_model, summaries};
use super::choice::{Candidate, choose};
use super::fit::{Fitted, Plan, fit};
use super::log::ReadingLog;
use super::sample_size::{SampleSize, study};
use super::session::{LEAST_SESSIONS, SessionSpread, with_sessions};
use crate::range::form::{FORMS, Form, Linear};
use crate::range::model::{RangeModel, ReadingUnit};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{
    LEAST_FOR_NORMALITY, Proportion, normal_quantile, student_quantile,
};
use realgap_core::unit::LengthUnit;
use realgap_core::warning::{Code, Warning};

/// Default level of intervals.
pub const LEVEL: f64 = 0.95;

/// Options of a characterisation.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Form of the mean; with `None` it is chosen by cross-validation.
    pub mean: Option<&'static dyn Form>,
    /// Form of the standard deviation; with `None` it is chosen by cross-validation.
    pub spread: Option<&'static dyn Form>,
    /// Width of a bin of histograms, in the reading's unit; with `None`, a fifth of the standard deviation.
    pub bin: Option<f64>,
    /// Largest change at which a histogram counts as stable; with `None`, an eighth.
    pub tolerance: Option<f64>,
    /// Level of all intervals, above 0 and below 1; with `None`, [`LEVEL`].
    pub level: Option<f64>,
    /// Seed of the sample-size study.
    pub seed: u64,
}

/// Default tolerance of the change of a histogram: an eighth, which is the change at the 200 readings of paper 000
/// (docs/validation/sensing.md).
const TOLERANCE: f64 = 0.125;

/// A fitted number.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Value {
    /// Name of the parameter, e.g. `slope`.
    pub name: String,
    /// The maximum-likelihood estimate.
    pub value: f64,
    /// Lower end of the confidence interval.
    pub low: f64,
    /// Upper end of the confidence interval.
    pub high: f64,
    /// Standard error of the estimate.
    pub standard_error: f64,
}

impl Value {
    /// A value with its interval; `reach` is the half width of the interval in standard errors.
    fn new(name: String, value: f64, standard_error: f64, reach: f64) -> Self {
        let half = reach * standard_error;
        Self {
            name,
            value,
            low: value - half,
            high: value + half,
            standard_error,
        }
    }
}

/// The model that was fitted to a log, and the statistics of the fit.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Characterisation {
    /// The model.
    #[serde(serialize_with = "as_file")]
    #[cfg_attr(feature = "schema", schemars(with = "Numbers<'static>"))]
    pub model: RangeModel,
    /// Form of the mean.
    pub mean_form: &'static str,
    /// Form of the standard deviation.
    pub spread_form: &'static str,
    /// Parameters of the mean, terms in the angles last.
    pub mean: Vec<Value>,
    /// Parameters of the standard deviation; within a session, if the log names sessions.
    pub spread: Vec<Value>,
    /// Level of the intervals.
    pub level: f64,
    /// Variation between sessions, if the log names sessions; all intervals of the mean then hold for any session.
    pub sessions: Option<SessionSpread>,
    /// Smallest step between two readings, in the reading's unit.
    pub step: f64,
    /// Number and share of dropouts among all rows of the log.
    pub dropouts: Proportion,
    /// Number and share of readings that have nothing to do with the distance, without dropouts.
    pub outliers: Proportion,
    /// The pairs of forms that were tried; empty if the options leave no choice.
    pub candidates: Vec<Candidate>,
    /// p value of the test of lack of fit: probability of mean readings at least this far from the model if its form were true
    /// (χ²); `None` without degrees of freedom.
    pub lack_of_fit_p: Option<f64>,
    /// Tests whether readings are distributed normally.
    pub normality: Normality,
    /// Number of readings that is needed, at the distance with most readings.
    pub sample_size: Option<SampleSize>,
    /// Statistics of the readings at each distance.
    pub distances: Vec<DistanceReport>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// The numbers of the model, without its curves, as they are written to JSON.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Numbers<'a> {
    distance_unit: LengthUnit,
    reading_unit: &'a ReadingUnit,
    range: (f64, f64),
    sampling_time_s: Option<f64>,
    incidence_per_deg: f64,
    offset_per_deg: f64,
    dropout: f64,
    outliers: crate::range::model::Outliers,
    session_sd: f64,
    session_share: f64,
}
fn as_file<S: Serializer>(
    model: &RangeModel,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    Numbers {
        distance_unit: model.distance_unit,
        reading_unit: &model.reading_unit,
        range: model.range,
        sampling_time_s: model.sampling_time_s,
        incidence_per_deg: model.incidence_per_deg,
        offset_per_deg: model.offset_per_deg,
        dropout: model.dropout,
        outliers: model.outliers,
        session_sd: model.session_sd,
        session_share: model.session_share,
    }
    .serialize(serializer)
}

/// Lack of fit and deviations from normality give a warning if the p value is below this.
const DOUBTFUL: f64 = 0.01;

impl Characterisation {
    /// Fits a model to a log.
    ///
    /// # Errors
    /// One distance only, dropouts only, a form that cannot be fitted to the data, readings that never vary.
    pub fn new(log: &ReadingLog, options: &Options) -> Result<Self> {
        let (cells, resolution) = cells(log);
        let data = summaries(&cells);
        let (first, last) = ends(&data, log.readings.len())?;
        let least_spread = resolution / 12f64.sqrt();
        if resolution == 0.0 {
            return Err(Error::invalid("all readings are the same").hint(
                "check that this is the column of the readings, and that the sensor worked",
            ));
        }
        let differs = |of: fn(&Summary) -> f64| data.iter().any(|s| of(s) != of(&data[0]));
        let mut warnings = log.warnings.clone();
        let plans = plans(
            options,
            differs(|s| s.incidence_deg),
            differs(|s| s.offset_deg),
            least_spread,
        );
        let level = options.level.unwrap_or(LEVEL);
        let (plan, candidates) = pick(&plans, &data, &mut warnings);
        let mut fitted = fit(plan, &data).ok_or_else(|| cannot_fit(plan))?;
        let mut reach = vec![normal_quantile(0.5 + 0.5 * level); plan.parameters(&fitted)];
        let mut sessions = None;
        if (1..LEAST_SESSIONS).contains(&log.sessions.len()) {
            warnings.push(Code::FewSessions.warning(format!(
                "{} sessions are too few to estimate how sessions differ: the intervals treat readings as independent and are too narrow for another session",
                log.sessions.len()
            )));
        } else if !log.sessions.is_empty() {
            let found = with_sessions(plan, &fitted, &data, log.sessions.len(), level)?;
            fitted = found.fitted;
            let degrees = found.degrees.iter();
            reach = degrees
                .map(|d| student_quantile(0.5 + 0.5 * level, *d))
                .collect();
            sessions = Some(found.spread);
        }
        let (came, asked) = cells.iter().fold((0, 0), |(came, asked), cell| {
            let here = cell.values.len() + cell.outliers.len();
            (came + here, asked + here + cell.dropouts)
        });
        let outliers: usize = cells.iter().map(|cell| cell.outliers.len()).sum();
        let dropouts = Proportion::new(asked - came, asked, level);
        let everywhere = sessions.as_ref().map(|s| s.everywhere);
        let model = RangeModel {
            description: String::new(),
            distance_unit: log.distance_unit,
            reading_unit: log.reading_unit.clone(),
            range: (first, last),
            sampling_time_s: log.sampling_time_s,
            mean: fitted.mean.clone(),
            spread: fitted.spread.clone(),
            incidence_per_deg: fitted.incidence_per_deg,
            offset_per_deg: fitted.offset_per_deg,
            dropout: dropouts.share,
            outliers: outlier_model(&cells),
            session_sd: everywhere.map_or(0.0, |e| if e.grows_with_reading { 0.0 } else { e.sd }),
            session_share: everywhere.map_or(0.0, |e| e.share),
        };
        model.check()?;
        let distances: Vec<DistanceReport> = cells
            .iter()
            .map(|cell| report(cell, &fitted, log.sessions.get(cell.session), resolution))
            .collect();
        let normality = normality(&distances);
        // Differences between sessions would be taken for lack of fit, so the test is omitted for a log with sessions.
        let lack_of_fit_p = match sessions {
            Some(_) => None,
            None => lack_of_fit(&fitted, &data),
        };
        warnings.extend(doubts(plan, lack_of_fit_p, normality));
        warnings.extend(reading_warnings(
            &distances,
            resolution,
            log.reading_unit.symbol(),
        ));
        Ok(Self {
            mean_form: plan.mean.name(),
            spread_form: plan.spread.name(),
            mean: mean_values(plan, &fitted, &reach),
            spread: spread_values(plan, &fitted, normal_quantile(0.5 + 0.5 * level)),
            level,
            sessions,
            step: resolution,
            dropouts,
            outliers: Proportion::new(outliers, came, level),
            candidates,
            lack_of_fit_p,
            normality,
            sample_size: sample_size(&cells, &fitted, options),
            distances,
            warnings,
            model,
        })
    }
}

/// The first and the last distance of a log; `rows` is the number of its rows.
fn ends(data: &[Summary], rows: usize) -> Result<(f64, f64)> {
    let (first, last) = match (data.first(), data.last()) {
        (Some(first), Some(last)) => (first.distance, last.distance),
        _ => {
            return Err(Error::invalid("the log contains no reading, only dropouts")
                .found(format!("{} rows", rows)));
        }
    };
    if first == last {
        return Err(
            Error::invalid("a model cannot be fitted to readings at one distance")
                .field("distance")
                .found(format!("{first} only"))
                .allowed("two or more different distances"),
        );
    }
    Ok((first, last))
}

/// Warnings if the form does not fit the mean readings or if readings are not distributed normally.
fn doubts(plan: Plan, lack_of_fit_p: Option<f64>, normality: Normality) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if lack_of_fit_p.is_some_and(|p| p < DOUBTFUL) {
        warnings.push(Code::LackOfFit.warning(format!(
            "mean readings deviate from the {} form by more than chance explains: its intervals are too narrow, and it may be wrong between the distances of the log",
            plan.mean.name()
        )));
    }
    if normality.adjusted_p < DOUBTFUL {
        warnings.push(Code::NotNormal.warning(format!(
            "readings are not distributed normally at {} of {} distances (rounding of readings alone can be the reason)",
            normality.rejected,
            normality.tested
        )));
    }
    warnings
}

/// Every pair of forms that the options allow.
fn plans(options: &Options, incidence: bool, offset: bool, least_spread: f64) -> Vec<Plan> {
    let forms = |asked: Option<&'static dyn Form>| asked.map_or(FORMS.to_vec(), |form| vec![form]);
    let mut plans = Vec::new();
    for mean in forms(options.mean) {
        for spread in forms(options.spread) {
            plans.push(Plan {
                mean,
                spread,
                incidence,
                offset,
                least_spread,
            });
        }
    }
    plans
}

fn pick(plans: &[Plan], data: &[Summary], warnings: &mut Vec<Warning>) -> (Plan, Vec<Candidate>) {
    if let [only] = plans {
        return (*only, Vec::new());
    }
    let mut distances: Vec<f64> = data.iter().map(|s| s.distance).collect();
    distances.dedup();
    if distances.len() > 2 {
        let (candidates, chosen) = choose(plans, data);
        // If no pair of forms can be fitted, the first one is returned, so that its fit gives the error.
        return (plans[chosen.unwrap_or(0)], candidates);
    }
    warnings.push(
        Code::FewDistances
            .warning("the form cannot be chosen from two distances; a straight line is assumed"),
    );
    let is_line = |form: &dyn Form| form.name() == Linear.name();
    let line = plans
        .iter()
        .find(|plan| is_line(plan.mean) && is_line(plan.spread));
    let line = line.or(plans.iter().find(|plan| is_line(plan.spread)));
    (*line.unwrap_or(&plans[0]), Vec::new())
}

fn cannot_fit(plan: Plan) -> Error {
    Error::invalid("the log cannot be fitted with these forms")
        .found(format!("mean {}, spread {}", plan.mean.name(), plan.spread.name()))
        .hint("power and exponential need values of one sign; a linear spread must stay above 0; try the table")
}

fn values(
    form: &dyn Form,
    knots: &[f64],
    values: &[f64],
    errors: &[f64],
    reach: impl Fn(usize) -> f64,
) -> Vec<Value> {
    let names = form.parameters(knots).into_iter();
    names
        .zip(values.iter().zip(errors))
        .enumerate()
        .map(|(index, (name, (value, error)))| Value::new(name, *value, *error, reach(index)))
        .collect()
}

/// The parameters of the standard deviation. It is above 0, so the intervals of its factors are computed from their logarithms.
fn spread_values(plan: Plan, fitted: &Fitted, reach: f64) -> Vec<Value> {
    let spread = &fitted.spread;
    let mut all = values(
        plan.spread,
        &spread.knots,
        &spread.values,
        &fitted.spread_errors,
        |_| reach,
    );
    for (index, value) in all.iter_mut().enumerate() {
        if plan.spread.is_factor(index) && value.value > 0.0 {
            let half = (value.high - value.value) / value.value;
            (value.low, value.high) = (
                value.value * libm::exp(-half),
                value.value * libm::exp(half),
            );
        }
    }
    all
}

fn mean_values(plan: Plan, fitted: &Fitted, reach: &[f64]) -> Vec<Value> {
    let own = fitted.mean.values.len();
    let mut all = values(
        plan.mean,
        &fitted.mean.knots,
        &fitted.mean.values,
        &fitted.mean_errors[..own],
        |index| reach[index],
    );
    let mut rest = fitted.mean_errors[own..].iter().zip(&reach[own..]);
    for (is_fitted, name, value) in [
        (
            plan.incidence,
            "incidence per degree",
            fitted.incidence_per_deg,
        ),
        (plan.offset, "offset per degree", fitted.offset_per_deg),
    ] {
        if let (true, Some((error, reach))) = (is_fitted, rest.next().filter(|_| is_fitted)) {
            all.push(Value::new(name.to_owned(), value, *error, *reach));
        }
    }
    all
}

/// p value of χ² of the cells' means about the curve, with the standard deviations of the cells themselves.
fn lack_of_fit(fitted: &Fitted, data: &[Summary]) -> Option<f64> {
    let freedom = data
        .len()
        .checked_sub(fitted.mean_errors.len())
        .filter(|f| *f > 0)?;
    // The fitted standard deviation would hide a lack of fit, because it includes the deviations of the means from the form.
    let own_sd = |s: &Summary| {
        (s.count >= LEAST_FOR_NORMALITY as f64).then(|| (s.squares / (s.count - 1.0)).sqrt())
    };
    let sum: Option<f64> = data
        .iter()
        .map(|s| {
            Some(
                s.count
                    * ((s.mean - fitted.mean_at(s)) / own_sd(s).filter(|sd| *sd > 0.0)?).powi(2),
            )
        })
        .sum();
    Some(gamma_ur(
        0.5 * freedom as f64,
        0.5 * sum?.max(f64::MIN_POSITIVE),
    ))
}

fn sample_size(cells: &[Cell], fitted: &Fitted, options: &Options) -> Option<SampleSize> {
    // The cell with the most readings; of several, the one nearest to the middle of the log.
    let middle = 0.5 * (cells.first()?.distance + cells.last()?.distance);
    let cell = cells.iter().max_by(|a, b| {
        let off = |cell: &Cell| (cell.distance - middle).abs();
        let readings = |cell: &Cell| cell.values.len() + cell.outliers.len() + cell.dropouts;
        readings(a)
            .cmp(&readings(b))
            .then(off(b).total_cmp(&off(a)))
    })?;
    let bin = options.bin.unwrap_or(0.2 * fitted.spread.at(cell.distance));
    study(
        cell.distance,
        &cell.values,
        bin,
        options.tolerance.unwrap_or(TOLERANCE),
        options.seed,
    )
}
