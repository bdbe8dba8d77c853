//! Draws a synthetic log from a sensor's model, with which a fit can be tested against known parameters.

use realgap_core::random::Numbered;
use realgap_core::{Error, Result, Warning};

use crate::range::{Beam, RangeModel, RangeSensor, ReadingUnit};

/// Largest number of rows of a log.
const MOST: usize = 5_000_000;
/// Default number of distances.
const DISTANCES: u32 = 21;

/// Options of a synthetic log.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawOptions {
    /// Distances, in the model's unit; if empty, they are evenly spaced over the range of the model.
    pub distances: Vec<f64>,
    /// Number of readings at each distance.
    pub readings: u32,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Number of sessions, each with readings at all distances; a column names them if there are several.
    pub sessions: u32,
    /// Seed of the readings.
    pub seed: u64,
}

/// A synthetic log, which [`ReadingLog`](super::ReadingLog) can read.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnLog {
    /// The text of the log, in CSV.
    pub csv: String,
    /// Number of distances.
    pub distances: usize,
    /// Number of readings.
    pub readings: usize,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

impl DrawnLog {
    /// Draws readings of a model.
    ///
    /// # Errors
    /// A distance that is not above 0, or more readings than a log may have.
    pub fn new(sensor: &RangeModel, options: &DrawOptions) -> Result<Self> {
        let (low, high) = sensor.range;
        let spaced = |k: u32| low + (high - low) * f64::from(k) / f64::from(DISTANCES - 1);
        let distances = match options.distances.as_slice() {
            [] => (0..DISTANCES).map(spaced).collect(),
            named => named.to_vec(),
        };
        if let Some(wrong) = distances.iter().find(|d| !(**d > 0.0 && d.is_finite())) {
            return Err(Error::invalid("a distance must be above 0")
                .field("distances")
                .found(wrong));
        }
        let sessions = options.sessions.max(1);
        let readings = distances.len() * options.readings as usize * sessions as usize;
        if readings > MOST {
            return Err(
                Error::invalid("too many readings for one log").allowed(format!("at most {MOST}"))
            );
        }
        let length = sensor.distance_unit.symbol();
        let reading = match (&sensor.reading_unit, sensor.reading_unit.symbol()) {
            (ReadingUnit::Own(_), "") => "reading".to_owned(),
            (_, symbol) => format!("reading_{symbol}"),
        };
        let column = if sessions > 1 { ",session" } else { "" };
        let mut csv = format!("distance_{length},{reading},incidence_deg{column}\n");
        let beam = |distance: f64| Beam {
            incidence_rad: options.incidence_deg.to_radians(),
            ..Beam::straight(distance * sensor.distance_unit.metres())
        };
        let mut warnings = Vec::new();
        for distance in &distances {
            warnings.extend(sensor.warning_at(beam(*distance).distance_m));
        }
        for session in 0..sessions {
            let mut own = Numbered::SensorSession.generator(options.seed, u64::from(session));
            let in_session = sensor.in_session(&mut own);
            for (index, distance) in distances.iter().enumerate() {
                let number = u64::from(session) * distances.len() as u64 + index as u64;
                let mut rng = Numbered::SensorReading.generator(options.seed, number);
                for _ in 0..options.readings {
                    let value = match sessions {
                        1 => sensor.draw(&beam(*distance), &mut rng),
                        _ => in_session.draw(&beam(*distance), &mut rng),
                    };
                    let value = value.map_or(String::new(), |v| v.to_string());
                    csv += &format!("{distance},{value},{}", options.incidence_deg);
                    if sessions > 1 {
                        csv += &format!(",{}", session + 1);
                    }
                    csv.push('\n');
                }
            }
        }
        Ok(Self {
            csv,
            distances: distances.len(),
            readings,
            warnings,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::range::find_sensor;

    #[test]
    fn the_same_seed_draws_the_same_log_with_one_row_for_each_reading() {
        let sensor = find_sensor("ultrasonic").unwrap();
        let options = DrawOptions {
            distances: vec![0.5 * (sensor.range.0 + sensor.range.1)],
            readings: 3,
            incidence_deg: 0.0,
            sessions: 1,
            seed: 7,
        };
        let log = DrawnLog::new(&sensor, &options).unwrap();
        assert_eq!(log.csv.lines().count(), 4, "{}", log.csv);
        assert_eq!(DrawnLog::new(&sensor, &options).unwrap(), log);
        let wrong = DrawOptions {
            distances: vec![0.0],
            ..options
        };
        assert!(DrawnLog::new(&sensor, &wrong).is_err());
    }
}
