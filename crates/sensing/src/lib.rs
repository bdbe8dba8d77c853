//! Sensor models: fitted to logs of real sensors, simulated, and compared with logs of the real sensors.
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
//! A simulation of a robot uses the models, the arena and the filter, so these are always compiled. The feature `papers`, which is on
//! by default, adds to each of them the calibration from logs and the evaluation on logs. It also adds the module `task`, which
//! compares task times (paper 002). Models of cameras and pictures are in the crate `realgap-vision`.
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
