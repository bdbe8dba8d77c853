//! Radio models: the strength of received signals through walls, and whether messages are received (paper 002, section IV).
//!
//! Paper 002's equation 2, P(d) = P(d₀) − 10 n log(d/d₀) − min(nW, C) WAF, is one of several [`propagation`] models. Walls are counted
//! by casting rays in an [`Arena`](super::arena::Arena). A [`Service`] simulates the delivery of messages between robots. With the
//! feature `papers`, [`fit`](fit()) estimates a [`RadioModel`] from a [`RadioLog`] of strengths at known positions, with confidence
//! intervals, and an [`Evaluation`] tests it on a log that was not used for the fit.
//!
//! Strengths are in dBm, losses in dB, lengths in metres. **The base of the logarithm is a parameter**: the paper's tables fit the
//! natural logarithm, most other publications use base 10; an exponent of 1 in base e is one of 2.303 in base 10.
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_sensing::arena::Arena;
//! use realgap_sensing::radio::{Link, LogBase, RadioModel};
//!
//! let arena = Arena::parse(&Source::new("arena", r#"Arena(
//!     name: "two rooms", size_m: (10, 10), boundary: Open,
//!     walls: [(from_m: (5, 0), to_m: (5, 10), thickness_m: 0.2, material: "brick")],
//! )"#))?;
//! // Table I of paper 002.
//! let model = RadioModel::paper002();
//! assert_eq!(model.log_base, LogBase::E);
//! let link = Link::new(&arena, [1.0, 5.0, 0.0], [9.5, 5.0, 0.0]);
//! assert_eq!(link.walls(), 1);
//! // One wall and 8.5 m: the -71.4 dBm that its table II has for `rtest1`.
//! assert!((model.strength_dbm(&link) + 71.47).abs() < 0.01);
//! # Ok::<(), realgap_core::Error>(())
//! ```

#[cfg(feature = "papers")]
mod calibration;
mod link;
mod model;
mod pair;
pub mod propagation;
mod service;
#[cfg(feature = "papers")]
mod service_report;
mod shadow;

#[cfg(feature = "papers")]
pub use calibration::{
    AnchorReport, CELL_M, Candidate, Evaluation, Fingerprints, FittedParameter, FittedRadio,
    PlaceReading, RadioBaseline, RadioLog, RadioLogOptions, RadioOptions, fit, read_anchors,
};
pub use link::Link;
pub use model::{LogBase, OtherFit, RadioModel};
pub use pair::MOST_PAIRS;
pub use service::{Delivery, Message, Service, ServiceOptions};
#[cfg(feature = "papers")]
pub use service_report::ServiceReport;
pub use shadow::ShadowField;
