//! A study: experiment + recordings + parameters + metric, read from RON and made ready to evaluate.
//!
//! [`Study::read`] parses the file, [`Problem::new`] turns it into cases (one simulation each),
//! [`Problem::evaluate`] simulates one point, [`Scores::new`] compares all points with reality.

mod case;
mod clip;
mod evaluation;
mod file;
mod noise;
mod problem;
mod recording;
mod repeat;
mod score;
mod sweep;
mod values;

pub use case::{Case, Target};
pub use evaluation::{Evaluation, FaceOdds, RecordingErrors, Spread, evaluate};
pub use file::{Overrides, Part, StartRule, Study};
pub use noise::read_noise;
pub use problem::Problem;
pub use repeat::RepeatCase;
pub use score::{PointScore, Scores};
pub use sweep::{LEVEL, Mode, Sweep, sweep};
pub use values::{BestFile, read_parameters};
