//! The output of `--format json`: each answer has a name, a schema in `schemas/answers/`, and a field with its version.

use realgap::calibration::{
    Determination, JointEvaluation, RecordReport, Report as Calibration, Sensitivity,
};
use realgap::identification::JointIdentification;
use realgap::plan::Status;
use realgap::prediction::gap::{Between, FloorReport, StudyGap};
use realgap::prediction::{Card, EnsembleReport};
use realgap::results::SearchSummary;

use super::apply::Applied;
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

/// Marks types as answers, and lists their forms and schemas. The path of the schemas' folder is relative to the file that calls this
/// macro.
macro_rules! forms {
    (in $folder:literal: $($name:literal $kind:ident $type:ty, $doc:literal;)*) => {
        $(impl $crate::cli::terminal::Answer for $type {})*

        /// The name of every answer with the text of its schema.
        pub const SCHEMAS: &[(&str, &str)] = &[
            $(($name, include_str!(concat!($folder, $name, ".json"))),)*
        ];

        /// Every form.
        #[cfg(all(test, feature = "schema"))]
        pub const FORMS: &[$crate::cli::form::Form] = &[$($crate::cli::form::Form {
            name: $name,
            doc: $doc,
            is_list: matches!(stringify!($kind).as_bytes(), b"rows"),
            schema: realgap::schema::answer::<$type>,
        }),*];
    };
}

// Each line adds an answer: its name, whether it is one value or rows, its type, its description.
forms! {
    in "../../schemas/answers/":
    "apply" one Applied, "fitted values in the user's own file: `realgap apply`";
    "between" one Between, "whether two sets of recorded runs move alike: `realgap gap --between --and`";
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
    "identify-logs" one Determination, "which parameters recordings of joints determine: `realgap study identify`";
    "import" one ImportReport, "an imported robot, with the notes of its import: `realgap robot import`";
    "parameters" rows ParameterRow, "every parameter: `realgap study parameters`";
    "predict" one Card, "a prediction card, prediction.json, and those of a search: `realgap predict`";
    "record" one RecordReport, "stand-in recordings that were written: `realgap study record`";
    "results" rows TrialRow, "the trials of a folder: `realgap study results`";
    "search" one SearchSummary, "the best robots, and summary.json: `realgap search`";
    "sensitivity" one Sensitivity, "which parameters matter: `realgap study sensitivity`";
    "simulate" one SimulateReport, "one simulated run: `realgap simulate`";
    "status" one Status, "the progress of a plan: `realgap cluster status` and `realgap cluster plan`";
    "sweep" one Calibration, "the best values and how sure that is, and summary.json: `realgap sweep` and `realgap tune`";
    "verify" one VerifyReport<'_>, "checks of the simulator against closed forms: `realgap verify`";
}
