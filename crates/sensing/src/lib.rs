//! Sensors: models of real ones, simulated, calibrated from logs, and compared with these logs.
//!
//! [`range`] models sensors that measure one distance (ultrasonic, infrared): mean and standard deviation of their readings as
//! functions of the distance (paper 000).
//!
//! [`graph`] models scanners: their ranges at a position, as polynomials (paper 001).
//!
//! [`radio`] models radio: the strength of a received signal, and whether a message is received (paper 002).
//!
//! [`arena`] computes where a beam hits an obstacle, and [`belief`] estimates a distance from readings (a discrete Bayes filter).
//!
//! The models, the arena and the filter are what a simulation of a robot uses, and are always compiled. The feature `papers`, which is
//! on by default, adds calibration from logs and evaluation on logs to each of them, and the module `task`: task times (paper 002).
//!
//! The following example fits a model with confidence intervals to a log of readings at known distances:
//!
//! ```
//! use realgap_core::random::Numbered;
//! use realgap_sensing::range::{Beam, Characterisation, Options, RangeSensor, ReadingLog, sensor_by_name};
//!
//! let sensor = sensor_by_name("ultrasonic")?;
//! let mut rng = Numbered::SensorReading.generator(1, 0);
//! let mut log = String::from("distance_cm,reading_cm\n");
//! for distance_cm in 1..=21 {
//!     let beam = Beam::straight(0.01 * f64::from(distance_cm));
//!     for _ in 0..200 {
//!         let reading_cm = sensor.draw(&beam, &mut rng).expect("this sensor always answers");
//!         log += &format!("{distance_cm},{reading_cm}\n");
//!     }
//! }
//! let found = Characterisation::new(&ReadingLog::parse("log.csv", &log)?, &Options::default())?;
//! assert_eq!(found.model.mean.form.name(), "linear");
//! let slope = &found.mean[1];
//! assert!(slope.low < 0.9582 && 0.9582 < slope.high);
//! # Ok::<(), realgap_core::Error>(())
//! ```

pub mod arena;
pub mod belief;
pub mod graph;
pub mod radio;
pub mod range;
#[cfg(feature = "papers")]
pub mod task;
