//! The output of the commands of `realgap sense` with `--format json`.

use realgap::sensing::belief::BeliefReport;
use realgap::sensing::graph::{Evaluation as GraphEvaluation, FittedGraph};
use realgap::sensing::radio::{Evaluation as RadioEvaluation, FittedRadio, ServiceReport};
use realgap::sensing::range::Characterisation;
use realgap::sensing::task::TaskComparison;
use realgap::vision::VisionReport;
use realgap::vision::tuning::TunedCamera;

// Each line adds an answer: its name, whether it is one value or rows, its type, its description.
forms! {
    in "../../../schemas/answers/":
    "belief" one BeliefReport, "a Bayes filter's estimate of a distance: `realgap sense belief`";
    "radio-evaluate" one RadioEvaluation, "the errors of a radio model on a log: `realgap sense radio evaluate`";
    "radio-fit" one FittedRadio, "a radio model fitted to a log: `realgap sense radio fit`";
    "radio-send" one ServiceReport, "the delivery of messages between two places: `realgap sense radio send`";
    "sensor-fit" one Characterisation, "a fitted model of a range sensor, with intervals and tests: `realgap sense fit`";
    "sensorgraph-evaluate" one GraphEvaluation, "the errors of a sensorgraph on a log: `realgap sense graph evaluate`";
    "sensorgraph-fit" one FittedGraph, "a sensorgraph fitted to a log: `realgap sense graph fit`";
    "tasks" one TaskComparison, "task times, real compared with simulated: `realgap sense tasks compare`";
    "vision-compare" one VisionReport, "pictures, real compared with simulated: `realgap sense vision compare`";
    "vision-tune" one TunedCamera, "a camera's settings fitted to pictures: `realgap sense vision tune`";
}
