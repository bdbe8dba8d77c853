//! The model of a range sensor: mean and standard deviation of its readings over the distance, dropouts and outliers.

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

use super::form::Curve;
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, look_up};
use realgap_core::range::Range;
use realgap_core::unit::LengthUnit;
use realgap_core::warning::{Code, Warning};

/// The geometry of a beam where it hits an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Distance to the object along the beam, metres.
    pub distance_m: f64,
    /// Angle of incidence θ: between the beam and the normal of the surface, radians.
    pub incidence_rad: f64,
    /// Angle of offset φ: between the sensor's axis and the beam, radians.
    pub offset_rad: f64,
}

impl Beam {
    /// A beam along the sensor's axis onto a surface that faces it.
    pub fn straight(distance_m: f64) -> Self {
        Self {
            distance_m,
            incidence_rad: 0.0,
            offset_rad: 0.0,
        }
    }
}

/// A sensor that gives a reading for a beam: p(z | d, θ, φ) of paper 000, equation 1, and the probability of a dropout.
///
/// Readings are numbers in the sensor's own unit. All random numbers come from the generator that is passed to a method.
pub trait RangeSensor: Sync {
    /// Shortest and longest distance for which the sensor was made or characterised, metres.
    fn range_m(&self) -> (f64, f64);

    /// Mean reading, without outliers.
    fn mean(&self, beam: &Beam) -> f64;

    /// Standard deviation of readings, without outliers; above 0.
    fn sd(&self, beam: &Beam) -> f64;

    /// Probability of a dropout, that is, of no reading.
    fn dropout(&self, _beam: &Beam) -> f64 {
        0.0
    }

    /// Logarithm of the density of a reading, given that it is not a dropout.
    fn log_density(&self, reading: f64, beam: &Beam) -> f64 {
        log_normal_density(reading, self.mean(beam), self.sd(beam))
    }

    /// A random reading; `None` for a dropout.
    fn draw(&self, beam: &Beam, rng: &mut dyn Rng) -> Option<f64> {
        let (missing, normal): (f64, f64) = (rng.random(), rng.sample(StandardNormal));
        (missing >= self.dropout(beam)).then(|| self.mean(beam) + self.sd(beam) * normal)
    }
}

/// Logarithm of the normal density.
pub(crate) fn log_normal_density(value: f64, mean: f64, sd: f64) -> f64 {
    let z = (value - mean) / sd;
    -0.5 * z * z - libm::log(sd) - 0.5 * libm::log(std::f64::consts::TAU)
}

/// The unit of a sensor's readings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ReadingUnit {
    /// Lengths.
    Length(LengthUnit),
    /// A unit of the sensor itself, e.g. steps of an analogue-to-digital converter; its name may be empty.
    Own(String),
}

impl ReadingUnit {
    /// Symbol for tables: `cm`, or the name of the sensor's own unit.
    pub fn symbol(&self) -> &str {
        match self {
            Self::Length(unit) => unit.symbol(),
            Self::Own(name) => name,
        }
    }
}

/// Readings that have nothing to do with the distance.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Outliers {
    /// Share of outliers among all readings, without dropouts.
    pub share: f64,
    /// Lower end of the interval over which outliers are uniformly distributed, in the reading's unit.
    pub low: f64,
    /// Upper end of the interval over which outliers are uniformly distributed, in the reading's unit.
    pub high: f64,
}

/// The model of a range sensor: mean and standard deviation over the distance, terms in the angles, dropouts and outliers. Its file
/// has the same fields.
///
/// Numbers are in the units of the log to which the model was fitted; the methods of [`RangeSensor`] take metres and radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "RangeSensor")]
pub struct RangeModel {
    /// Description of the sensor, and the source of the numbers.
    #[serde(default)]
    pub description: String,
    /// Unit of distances in both curves.
    pub distance_unit: LengthUnit,
    /// Unit of readings.
    pub reading_unit: ReadingUnit,
    /// Shortest and longest distance of the log, in its unit.
    pub range: (f64, f64),
    /// Time from one reading to the next, seconds; optional.
    #[serde(default)]
    pub sampling_time_s: Option<f64>,
    /// Mean reading as a function of the distance.
    pub mean: Curve,
    /// Standard deviation of readings as a function of the distance.
    pub spread: Curve,
    /// Change of the mean reading per degree of the angle of incidence.
    #[serde(default)]
    pub incidence_per_deg: f64,
    /// Change of the mean reading per degree of the angle of offset.
    #[serde(default)]
    pub offset_per_deg: f64,
    /// Probability of a dropout, that is, of no reading.
    #[serde(default)]
    pub dropout: f64,
    /// Readings that have nothing to do with the distance.
    #[serde(default)]
    pub outliers: Outliers,
    /// Standard deviation, over sessions, of an offset that a session adds to all its mean readings, in the reading's unit.
    #[serde(default)]
    pub session_sd: f64,
    /// Standard deviation, over sessions, of an error of scale of all mean readings of a session, as a share of the mean reading.
    #[serde(default)]
    pub session_share: f64,
}

/// Number of intervals of the range at whose ends it is checked that the standard deviation is positive.
const CHECKED: usize = 200;

realgap_core::ron_file!(RangeModel, "sensor model");

impl RangeModel {
    /// Checks that the numbers of the model are consistent.
    ///
    /// # Errors
    /// A range that is empty or not positive, probabilities outside 0 to 1, a mean that is not finite or a standard deviation that is not
    /// positive somewhere in the range.
    pub fn check(&self) -> Result<()> {
        for (field, curve) in [("mean", &self.mean), ("spread", &self.spread)] {
            curve.check().map_err(|e| e.within(field))?;
        }
        let (low, high) = self.range;
        if !(low > 0.0 && high > low && high.is_finite()) {
            return Err(Error::invalid("not a range of distances")
                .field("range")
                .found(format!("{low} to {high}"))
                .allowed("two increasing distances above 0"));
        }
        for (field, share) in [("dropout", self.dropout), ("outliers", self.outliers.share)] {
            if !(0.0..=1.0).contains(&share) {
                return Err(Error::invalid("not a probability")
                    .field(field)
                    .found(share)
                    .allowed("0 to 1"));
            }
        }
        for (field, sd) in [
            ("session_sd", self.session_sd),
            ("session_share", self.session_share),
        ] {
            Range::within(0.0, 1e9, "").check(sd, field)?;
        }
        let outliers = self.outliers;
        if outliers.share > 0.0
            && !(outliers.high > outliers.low && (outliers.high - outliers.low).is_finite())
        {
            return Err(
                Error::invalid("outliers must lie between two increasing readings")
                    .field("outliers")
                    .found(format!("{} to {}", outliers.low, outliers.high)),
            );
        }
        if let Some(time_s) = self.sampling_time_s {
            Range::above(0.0, 1e9, "s").check(time_s, "sampling_time_s")?;
        }
        for index in 0..=CHECKED {
            let d = low + (high - low) * index as f64 / CHECKED as f64;
            let (mean, spread) = (self.mean.at(d), self.spread.at(d));
            if !(mean.is_finite() && spread.is_finite() && spread > 0.0) {
                let field = if mean.is_finite() { "spread" } else { "mean" };
                return Err(
                    Error::invalid("the model has no density everywhere in its range")
                        .field(field)
                        .found(format!("mean {mean}, spread {spread} at {d}"))
                        .allowed("a finite mean and a spread above 0"),
                );
            }
        }
        Ok(())
    }

    /// A warning if a beam of this length is outside of the range of the model.
    pub fn warning_at(&self, distance_m: f64) -> Option<Warning> {
        let (low_m, high_m) = self.range_m();
        (distance_m < low_m - 1e-9 || distance_m > high_m + 1e-9).then(|| {
            Code::Extrapolated.warning(format!(
                "{:.4} m is outside of the {low_m:.4} to {high_m:.4} m for which the sensor was characterised; readings there are extrapolated",
                distance_m
            ))
        })
    }

    /// The sensor in one session, with a random offset and error of scale of its mean readings.
    pub fn in_session(&self, rng: &mut dyn Rng) -> InSession<'_> {
        let (add, share): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
        InSession {
            model: self,
            add: self.session_sd * add,
            share: self.session_share * share,
        }
    }

    fn d(&self, beam: &Beam) -> f64 {
        beam.distance_m / self.distance_unit.metres()
    }
}

impl RangeSensor for RangeModel {
    fn range_m(&self) -> (f64, f64) {
        let metres = self.distance_unit.metres();
        (self.range.0 * metres, self.range.1 * metres)
    }

    fn mean(&self, beam: &Beam) -> f64 {
        self.mean.at(self.d(beam))
            + self.incidence_per_deg * beam.incidence_rad.to_degrees()
            + self.offset_per_deg * beam.offset_rad.to_degrees()
    }

    /// Outside of the range, a linear curve of the standard deviation may become negative; then the value at the nearest end of the
    /// range is used.
    fn sd(&self, beam: &Beam) -> f64 {
        let d = self.d(beam);
        let spread = self.spread.at(d);
        if spread > 0.0 && spread.is_finite() {
            spread
        } else {
            self.spread.at(d.clamp(self.range.0, self.range.1))
        }
    }

    fn dropout(&self, _: &Beam) -> f64 {
        self.dropout
    }

    fn log_density(&self, reading: f64, beam: &Beam) -> f64 {
        let normal = log_normal_density(reading, self.mean(beam), self.sd(beam));
        let Outliers { share, low, high } = self.outliers;
        if share == 0.0 {
            return normal;
        }
        let inside = (low..=high).contains(&reading);
        let even = if inside { share / (high - low) } else { 0.0 };
        libm::log((1.0 - share) * libm::exp(normal) + even)
    }

    fn draw(&self, beam: &Beam, rng: &mut dyn Rng) -> Option<f64> {
        // The same number of random numbers is drawn in every case, so that a change of one parameter of the model does not change
        // the random numbers of later readings.
        let (missing, outlier, place): (f64, f64, f64) = (rng.random(), rng.random(), rng.random());
        let normal: f64 = rng.sample(StandardNormal);
        if missing < self.dropout {
            return None;
        }
        let Outliers { share, low, high } = self.outliers;
        Some(if outlier < share {
            low + (high - low) * place
        } else {
            self.mean(beam) + self.sd(beam) * normal
        })
    }
}

/// A sensor in one session; the mean readings of sessions differ from each other.
#[derive(Debug, Clone)]
pub struct InSession<'a> {
    model: &'a RangeModel,
    /// Offset that the session adds to every mean reading, in the reading's unit.
    add: f64,
    /// Error of scale of the session, as a share of the mean reading.
    share: f64,
}

impl InSession<'_> {
    /// The mean reading in this session.
    pub fn mean(&self, beam: &Beam) -> f64 {
        self.model.mean(beam) * (1.0 + self.share) + self.add
    }

    /// A random reading in this session; `None` for a dropout. It is the reading that the model draws plus the difference of the
    /// session's mean from the model's.
    pub fn draw(&self, beam: &Beam, rng: &mut dyn Rng) -> Option<f64> {
        let moved = self.mean(beam) - self.model.mean(beam);
        self.model.draw(beam, rng).map(|reading| reading + moved)
    }
}

/// The models that come with the program: name and file.
const SHIPPED: [(&str, &str); 3] = [
    ("ultrasonic", include_str!("../../sensors/ultrasonic.ron")),
    ("infrared", include_str!("../../sensors/infrared.ron")),
    ("laser", include_str!("../../sensors/laser.ron")),
];

/// Names of the models that come with the program.
pub fn shipped_sensors() -> [&'static str; SHIPPED.len()] {
    SHIPPED.map(|(name, _)| name)
}

/// The shipped model of this name (`sensors/NAME.ron`).
///
/// # Errors
/// No such model; the error lists them.
pub fn sensor_by_name(name: &str) -> Result<RangeModel> {
    let (name, text) = look_up("sensor", name, SHIPPED, |(name, _)| name)?;
    RangeModel::parse(&Source::new(format!("sensors/{name}.ron"), text))
}

/// A shipped model by its name, or one from a file that ends in `.ron`.
///
/// # Errors
/// The errors of [`sensor_by_name`] and [`RangeModel::read`].
pub fn find_sensor(name_or_path: &str) -> Result<RangeModel> {
    if name_or_path.ends_with(".ron") {
        RangeModel::read(name_or_path)
    } else {
        sensor_by_name(name_or_path)
            .map_err(|e| e.or_hint("or a model's file, e.g. sensors/ultrasonic.ron"))
    }
}
