//! Fits a radio model to a log of strengths: fits every propagation model and chooses by cross-validation over places.

use super::check::check_places;
use super::covariance::{Spread, covariance};
use super::fitted::{Candidate, FittedParameter, FittedRadio};
use super::interval::grouped_quantile;
use super::log::RadioLog;
use super::option::RadioOptions;
use super::place::{ByPlace, PLACE_M, places};
use super::shadowing;
use crate::arena::{Anchor, Arena};
use crate::radio::link::Link;
use crate::radio::model::{OtherFit, RadioModel, SENSITIVITY_DBM};
use crate::radio::propagation::{PROPAGATIONS, Propagation};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{mean, standard_deviation, student_quantile};
use realgap_core::unit::counted;
use realgap_core::warning::Code;

/// Smallest number of places of a log.
const FEWEST_PLACES: usize = 3;
/// Level of all intervals.
const LEVEL: f64 = 0.9;

/// A propagation model fitted with one cap.
struct Fitted {
    propagation: &'static dyn Propagation,
    cap: usize,
    materials: Vec<String>,
    values: Vec<f64>,
    rows: Vec<Vec<f64>>,
    /// Errors at each reading of a fit without its place, in the order of the log.
    left_out_db: Vec<f64>,
    residuals_db: Vec<f64>,
}

impl Fitted {
    fn rmse_db(&self) -> f64 {
        root_mean_square(&self.left_out_db)
    }
}

pub(super) fn root_mean_square(errors: &[f64]) -> f64 {
    mean(&errors.iter().map(|e| e * e).collect::<Vec<_>>()).sqrt()
}

/// The data of a fit, which all candidates share.
struct FitData<'a> {
    log: &'a RadioLog,
    links: Vec<Link>,
    place: Vec<usize>,
    places: usize,
}

/// Fits a radio model to a log.
///
/// # Errors
/// An anchor of the log whose position is unknown, a log outside of the arena, too few places, a model that the log does not
/// determine.
pub fn fit(
    log: &RadioLog,
    arena: &Arena,
    anchors: &[Anchor],
    options: &RadioOptions,
) -> Result<FittedRadio> {
    options.check()?;
    let anchors = log.placed(anchors)?;
    let mut warnings = log.warnings.clone();
    warnings.extend(check_places(log, arena, &anchors)?);
    let links: Vec<Link> = log
        .readings
        .iter()
        .map(|reading| {
            let [x, y] = reading.position_m;
            let robot_m = [x, y, options.robot_height_m];
            Link::new(arena, robot_m, anchors[reading.anchor].position_m)
        })
        .collect();
    let (place, count) = places(log);
    if count < FEWEST_PLACES {
        return Err(Error::invalid("too few places to fit a radio model")
            .found(format!("{} of {PLACE_M} m", counted(count, "square")))
            .allowed(format!("{FEWEST_PLACES} or more"))
            .hint("log strengths along a path through the rooms"));
    }
    let data = FitData {
        log,
        links,
        place,
        places: count,
    };
    let most = data.links.iter().map(Link::walls).max().unwrap_or(0);
    let mut fitted = candidates(&data, most, options);
    fitted.sort_by(|a, b| a.rmse_db().total_cmp(&b.rmse_db()));
    let Some(best) = fitted.first() else {
        return Err(undetermined(most, options));
    };
    if most == 0 && options.propagation.is_none() {
        warnings.push(Code::NoWalls.warning(
            "no link of the log crosses a wall of the arena, so the losses of walls are unknown",
        ));
    }
    let mut found = describe(&data, best, &fitted, options);
    found.warnings.splice(0..0, warnings);
    Ok(found)
}

/// Fits of every propagation model that the log determines, with every cap.
fn candidates(data: &FitData<'_>, most: usize, options: &RadioOptions) -> Vec<Fitted> {
    let mut classes: Vec<String> = Vec::new();
    for (name, _) in data.links.iter().flat_map(|link| &link.crossed) {
        if !classes.contains(name) {
            classes.push(name.clone());
        }
    }
    classes.sort();
    let chosen = |p: &&&'static dyn Propagation| {
        options
            .propagation
            .is_none_or(|wanted| wanted.name() == p.name())
    };
    let mut fitted = Vec::new();
    for propagation in PROPAGATIONS.iter().filter(chosen) {
        let caps = if propagation.has_walls() {
            1..=most
        } else {
            0..=0
        };
        for cap in caps {
            let bare = RadioModel {
                propagation: *propagation,
                values: Vec::new(),
                cap,
                materials: classes.clone(),
                reference_distance_m: options.reference_distance_m,
                log_base: options.log_base,
                ..RadioModel::paper002()
            };
            // With one material, the model `materials` is the same as the model `walls`.
            let is_same = bare.parameters().len() == 3 && propagation.name() == "materials";
            if is_same && options.propagation.is_none() {
                continue;
            }
            fitted.extend(fit_one(data, &bare));
        }
    }
    fitted
}

fn fit_one(data: &FitData<'_>, bare: &RadioModel) -> Option<Fitted> {
    let (rows, targets): (Vec<Vec<f64>>, Vec<f64>) = data
        .links
        .iter()
        .zip(&data.log.readings)
        .map(|(link, reading)| {
            let (factors, fixed_db) = bare.row(link);
            (factors, reading.strength_dbm - fixed_db)
        })
        .unzip();
    let by_place = ByPlace::new(&rows, &targets, &data.place, data.places);
    let values = by_place.solve(|_| 1.0)?;
    let without: Vec<Vec<f64>> = (0..data.places)
        .map(|left_out| by_place.solve(|place| f64::from(u8::from(place != left_out))))
        .collect::<Option<_>>()?;
    let error = |index: usize, values: &[f64]| {
        let fitted_db: f64 = rows[index].iter().zip(values).map(|(f, v)| f * v).sum();
        targets[index] - fitted_db
    };
    let readings = 0..rows.len();
    Some(Fitted {
        propagation: bare.propagation,
        cap: bare.cap,
        materials: bare.materials.clone(),
        left_out_db: readings
            .clone()
            .map(|i| error(i, &without[data.place[i]]))
            .collect(),
        residuals_db: readings.map(|i| error(i, &values)).collect(),
        values,
        rows,
    })
}

fn undetermined(most: usize, options: &RadioOptions) -> Error {
    let error = Error::invalid("the log does not determine the model");
    let error = match options.propagation {
        Some(model) => error.found(model.name()),
        None => error,
    };
    if most == 0 {
        error.hint("no link crosses a wall of the arena; a model without walls can be fitted")
    } else {
        error.hint("the log has too few distances, or all walls are crossed by the same links; a simpler model can be fitted")
    }
}

/// Mean squares of the errors at each place.
fn squares_by_place(data: &FitData<'_>, fitted: &Fitted) -> Vec<f64> {
    let mut own = vec![Vec::new(); data.places];
    for (place, error) in data.place.iter().zip(&fitted.left_out_db) {
        own[*place].push(error * error);
    }
    own.iter().map(|squares| mean(squares)).collect()
}

fn describe(
    data: &FitData<'_>,
    best: &Fitted,
    all: &[Fitted],
    options: &RadioOptions,
) -> FittedRadio {
    let best_squares = squares_by_place(data, best);
    let candidate = |fitted: &Fitted| {
        let differences: Vec<f64> = squares_by_place(data, fitted)
            .iter()
            .zip(&best_squares)
            .map(|(other, best)| other - best)
            .collect();
        let error = standard_deviation(&differences) / (differences.len() as f64).sqrt();
        Candidate {
            propagation: fitted.propagation.name(),
            cap: fitted.propagation.has_walls().then_some(fitted.cap),
            left_out_rmse_db: fitted.rmse_db(),
            as_good: mean(&differences) <= 2.0 * error,
        }
    };
    let mut warnings = Vec::new();
    let mut left_out = vec![Vec::new(); data.places];
    for (place, error) in data.place.iter().zip(&best.left_out_db) {
        left_out[*place].push(*error);
    }
    let largest = best
        .left_out_db
        .iter()
        .fold(0.0, |a: f64, e| a.max(e.abs()));
    let interval_90_db = grouped_quantile(&left_out, LEVEL).unwrap_or_else(|| {
        warnings.push(Code::FewPlaces.warning(format!(
            "{} are too few for a 90 % interval of the strengths at other places; the largest error of this log is used as the interval",
            counted(data.places, "place")
        )));
        largest
    });
    let spread = shadowing::estimate(data.log, &best.residuals_db, &best.rows);
    let strengths: Vec<f64> = data.log.readings.iter().map(|r| r.strength_dbm).collect();
    let fit_of = |fitted: &Fitted| OtherFit {
        propagation: fitted.propagation,
        values: fitted.values.clone(),
        cap: fitted.cap,
        materials: match fitted.propagation.name() {
            "materials" => fitted.materials.clone(),
            _ => Vec::new(),
        },
    };
    // The fit with the best cap of every other propagation model.
    let mut others: Vec<OtherFit> = Vec::new();
    for other in all {
        let is_known = |fit: &OtherFit| fit.propagation == other.propagation;
        if other.propagation != best.propagation && !others.iter().any(is_known) {
            others.push(fit_of(other));
        }
    }
    let model = RadioModel {
        description: String::new(),
        reference_distance_m: options.reference_distance_m,
        log_base: options.log_base,
        robot_height_m: options.robot_height_m,
        shadowing_sd_db: spread.shadowing_sd_db,
        shadowing_distance_m: spread.shadowing_distance_m,
        fading_sd_db: spread.fading_sd_db,
        interval_90_db,
        mean_dbm: mean(&strengths),
        sensitivity_dbm: SENSITIVITY_DBM,
        others,
        ..RadioModel::paper002().with(&fit_of(best))
    };
    FittedRadio {
        propagation: best.propagation.name(),
        formula: best.propagation.formula(),
        log_base: options.log_base.name(),
        reference_distance_m: options.reference_distance_m,
        parameters: parameters(data, best, &model, &spread),
        cap: best.propagation.has_walls().then_some(best.cap),
        candidates: all.iter().map(candidate).collect(),
        left_out_rmse_db: best.rmse_db(),
        rmse_db: root_mean_square(&best.residuals_db),
        shadowing_sd_db: spread.shadowing_sd_db,
        shadowing_distance_m: spread.shadowing_distance_m,
        fading_sd_db: spread.fading_sd_db,
        interval_90_db,
        readings: data.log.readings.len(),
        missing: data.log.missing,
        places: data.places,
        warnings,
        model,
    }
}

/// A strength is determined if its interval is narrower than this, dB.
const KNOWN_DB: f64 = 10.0;

/// The parameters with intervals that take the correlation of neighbouring readings into account.
fn parameters(
    data: &FitData<'_>,
    best: &Fitted,
    model: &RadioModel,
    spread: &Spread,
) -> Vec<FittedParameter> {
    let covariance = covariance(data.log, &best.rows, spread);
    let crossing = data.links.iter().filter(|link| link.walls() > 0).count();
    let share = crossing as f64 / data.links.len() as f64;
    // The degrees of freedom are limited by the number of places, because readings at one place have correlated errors.
    let degrees = data.places.saturating_sub(best.values.len()).max(1);
    let quantile = student_quantile(0.5 * (1.0 + LEVEL), degrees as f64);
    model
        .parameters()
        .into_iter()
        .enumerate()
        .map(|(index, parameter)| {
            let value = best.values[index];
            let sd = covariance
                .as_ref()
                .map_or(f64::INFINITY, |c| c[(index, index)].max(0.0).sqrt());
            let half = quantile * sd;
            let (low, high) = (value - half, value + half);
            let is_strength = index == 0;
            let why = if is_strength {
                (high - low > KNOWN_DB)
                    .then(|| format!("its interval is {:.0} dB wide", high - low))
            } else if low <= 0.0 {
                let walls = format!("; {:.0} % of the links cross a wall", 100.0 * share);
                let walls = if parameter.name.contains("loss_db") {
                    walls
                } else {
                    String::new()
                };
                Some(format!("the interval contains 0{walls}"))
            } else {
                (high - low > value).then(|| "the interval is wider than the value".to_owned())
            };
            FittedParameter {
                name: parameter.name,
                unit: parameter.unit,
                value,
                low,
                high,
                determined: why.is_none(),
                why,
            }
        })
        .collect()
}
