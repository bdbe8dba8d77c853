//! What the commands of `realgap sense` print with `--format json`.

use realgap::sensing::belief::BeliefReport;
use realgap::sensing::graph::{Evaluation as GraphEvaluation, FittedGraph};
use realgap::sensing::radio::{Evaluation as RadioEvaluation, FittedRadio, ServiceReport};
use realgap::sensing::range::Characterisation;
use realgap::sensing::task::TaskComparison;
use realgap::vision::VisionReport;
use realgap::vision::tuning::TunedCamera;

// One line adds an answer: its name, whether it is one or rows, its type, what it is.
forms! {
    in "../../../schemas/answers/":
    "belief" one BeliefReport, "what a Bayes filter believes after readings: `realgap sense belief`";
    "radio-evaluate" one RadioEvaluation, "a radio model against a log: `realgap sense radio evaluate`";
    "radio-fit" one FittedRadio, "a radio model from a log: `realgap sense radio fit`";
    "radio-send" one ServiceReport, "messages between two places: `realgap sense radio send`";
    "sensor-fit" one Characterisation, "a range sensor's model and what it rests on: `realgap sense fit`";
    "sensorgraph-evaluate" one GraphEvaluation, "a sensorgraph against a log: `realgap sense graph evaluate`";
    "sensorgraph-fit" one FittedGraph, "a sensorgraph from a log: `realgap sense graph fit`";
    "tasks" one TaskComparison, "durations, real against simulated: `realgap sense tasks compare`";
    "vision-compare" one VisionReport, "pictures, real against simulated: `realgap sense vision compare`";
    "vision-tune" one TunedCamera, "a camera's settings from pictures: `realgap sense vision tune`";
}
