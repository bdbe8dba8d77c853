//! The output of `--format json`: each answer has a name, a schema in `schemas/answers/`, and a field with its version.

use realgap::calibration::{JointEvaluation, RecordReport, Report as Calibration, Sensitivity};
use realgap::identification::JointIdentification;
use realgap::plan::Status;
use realgap::prediction::gap::{FloorReport, StudyGap};
use realgap::prediction::{Card, EnsembleReport};
use realgap::results::SearchSummary;
use realgap::sensing::belief::BeliefReport;
use realgap::sensing::graph::{Evaluation as GraphEvaluation, FittedGraph};
use realgap::sensing::radio::{Evaluation as RadioEvaluation, FittedRadio, ServiceReport};
use realgap::sensing::range::Characterisation;
use realgap::sensing::task::TaskComparison;
use realgap::vision::VisionReport;
use realgap::vision::tuning::TunedCamera;

use super::check::report::FileReport;
use super::compare::{Compared, Scored};
use super::develop::DevelopReport;
use super::evaluate::Evaluated;
use super::genome::GenomeReport;
use super::identify::Identified;
use super::import::Report as ImportReport;
use super::parameters::ParameterRow;
use super::results::TrialRow;
use super::simulate::SimulateReport;
use super::terminal::Answer;
use super::verify::VerifyReport;

/// The form of an answer, from which its schema is generated.
#[cfg(all(test, feature = "schema"))]
pub struct Form {
    /// Name of its schema.
    pub name: &'static str,
    /// A description of the answer, and the command that prints it.
    pub doc: &'static str,
    /// Whether it is printed as a list, an element for each row.
    pub is_list: bool,
    /// The schema of one element.
    pub schema: fn() -> schemars::Schema,
}

/// Marks types as answers, and lists their forms and schemas.
macro_rules! forms {
    ($($name:literal $kind:ident $type:ty, $doc:literal;)*) => {
        $(impl Answer for $type {})*

        /// Every name with the text of its schema.
        pub const SCHEMAS: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../schemas/answers/", $name, ".json"))),)*
        ];

        /// Every form.
        #[cfg(all(test, feature = "schema"))]
        pub const FORMS: &[Form] = &[$(Form {
            name: $name,
            doc: $doc,
            is_list: matches!(stringify!($kind).as_bytes(), b"rows"),
            schema: realgap::schema::answer::<$type>,
        }),*];
    };
}

// One line adds an answer: its name, whether it is one or rows, its type, what it is.
forms! {
    "belief" one BeliefReport, "a Bayes filter's estimate of a distance: `realgap sense belief`";
    "characterise" one Characterisation, "a range sensor's model and what it rests on: `realgap sense characterise`";
    "check" rows FileReport, "the contents of files: `realgap check`";
    "compare" rows Compared, "distances of trajectories in every metric: `realgap compare`";
    "compare-metric" rows Scored, "distances of trajectories in one metric: `realgap compare --metric NAME`";
    "develop" one DevelopReport, "the robot of a genome: `realgap robot develop`";
    "ensemble" one EnsembleReport, "repeats under noise, and ensemble.json: `realgap ensemble`";
    "evaluate" one Evaluated, "pose errors of fixed values: `realgap evaluate`";
    "evaluate-joints" one JointEvaluation, "joint errors of fixed values, for recordings of joints alone: `realgap evaluate`";
    "floor" one FloorReport, "noise floors of recordings alone, and their gap.json: `realgap gap --recordings`";
    "gap" one StudyGap, "the gap between simulation and reality in noise floors, and gap.json: `realgap gap`";
    "genome" one GenomeReport, "a drawn genome: `realgap robot genome random`";
    "identify" one Identified<'_>, "parameters read from motion without a fit: `realgap study identify`";
    "identify-joints" one JointIdentification, "parameters of jointed bodies, read from motion without a fit: `realgap study identify`";
    "import" one ImportReport, "an imported robot, with the notes of its import: `realgap robot import`";
    "parameters" rows ParameterRow, "every parameter: `realgap study parameters`";
    "predict" one Card, "a prediction card, prediction.json, and those of a search: `realgap predict`";
    "radio-evaluate" one RadioEvaluation, "a radio model against a log: `realgap sense radio evaluate`";
    "radio-fit" one FittedRadio, "a radio model from a log: `realgap sense radio fit`";
    "radio-send" one ServiceReport, "messages between two places: `realgap sense radio send`";
    "record" one RecordReport, "stand-in recordings that were written: `realgap study record`";
    "results" rows TrialRow, "the trials of a folder: `realgap study results`";
    "search" one SearchSummary, "the best robots, and summary.json: `realgap search`";
    "sensitivity" one Sensitivity, "which parameters matter: `realgap study sensitivity`";
    "sensorgraph-evaluate" one GraphEvaluation, "a sensorgraph against a log: `realgap sense graph evaluate`";
    "sensorgraph-fit" one FittedGraph, "a sensorgraph from a log: `realgap sense graph fit`";
    "simulate" one SimulateReport, "one simulated run: `realgap simulate`";
    "status" one Status, "the progress of a plan: `realgap cluster status` and `realgap cluster plan`";
    "sweep" one Calibration, "the best values and how sure that is, and summary.json: `realgap sweep` and `realgap tune`";
    "tasks" one TaskComparison, "durations, real against simulated: `realgap sense tasks compare`";
    "verify" one VerifyReport<'_>, "checks of the simulator against closed forms: `realgap verify`";
    "vision-compare" one VisionReport, "pictures, real against simulated: `realgap sense vision compare`";
    "vision-tune" one TunedCamera, "a camera's settings from pictures: `realgap sense vision tune`";
}
