//! JSON Schemas of files and answers, generated from the types that read and write them.
//!
//! A RON file as JSON: brackets with names are objects, brackets and lists without are arrays, a name alone is a text, a
//! name with brackets an object with that one key, and what may be left out may be `null`. Everything that reads a RON
//! file of ours reads that JSON, too. Only with the feature `schema`: the results are committed, in `schemas/`.

mod page;

pub use page::page;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};

use crate::calibration;
use crate::comparison;
use crate::plan;
use crate::robot::{genome, morphology};
use crate::search;
use crate::sensing::{arena, graph, radio, range};
use crate::simulation;
use crate::trajectory;
#[cfg(feature = "papers")]
use crate::vision;

/// A kind of file.
#[derive(Debug, Clone)]
pub struct FileKind {
    /// Name of its schema.
    pub name: &'static str,
    /// What it is, one sentence.
    pub doc: &'static str,
    /// Whether users write it, in RON; otherwise the program writes it, in JSON.
    pub is_ron: bool,
    /// What it may hold.
    pub schema: Schema,
}

fn ron<T: JsonSchema>(name: &'static str, doc: &'static str) -> FileKind {
    let settings = SchemaSettings::draft2020_12().for_deserialize();
    FileKind {
        name,
        doc,
        is_ron: true,
        schema: settings.into_generator().into_root_schema_for::<T>(),
    }
}

fn json<T: JsonSchema>(name: &'static str, doc: &'static str) -> FileKind {
    FileKind {
        is_ron: false,
        ..ron::<T>(name, doc)
    }
}

/// The schema of the JSON that a type is written as.
pub fn answer<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<T>()
}

/// Every kind of file; those that users begin with come first.
pub fn files() -> Vec<FileKind> {
    let mut kinds = vec![
        ron::<morphology::MorphologyFile>(
            "robot",
            "A robot: modules, servos, gait, what is glued where.",
        ),
        ron::<morphology::body::Structure>(
            "bodies",
            "A robot of any bodies and joints, as `realgap robot import` writes it.",
        ),
        ron::<calibration::StudyFile>(
            "study",
            "A study: recordings, a robot, and the parameters to vary.",
        ),
        ron::<simulation::Noise>(
            "noise",
            "Noise: how repeats differ; part of a study or a search, or a file of its own.",
        ),
        ron::<search::SearchFile>("search", "A search for the best robot."),
        ron::<trajectory::Meta>(
            "meta",
            "`meta.ron`: a description of the recordings in its folder.",
        ),
        ron::<trajectory::Reading>(
            "reading",
            "How files of other programs are read; part of a study or of `meta.ron`, or a file of its own.",
        ),
        ron::<genome::IndividualFile>(
            "genome",
            "A genome, from which `realgap robot develop` builds a robot.",
        ),
        ron::<calibration::BestFile>(
            "parameters",
            "Values of parameters: `best.ron` of a results folder, or your own.",
        ),
        ron::<arena::ArenaFile>(
            "arena",
            "An arena: walls, boxes, radio stations, seen from above.",
        ),
        ron::<simulation::VehicleFile>("vehicle", "A robot on two wheels."),
        ron::<simulation::ControllerFile>(
            "controller",
            "A controller: sensors and radio of a robot, and the rules by which it acts on them.",
        ),
        ron::<range::RangeModel>("sensor", "A range sensor, as `realgap sense fit` finds it."),
        ron::<graph::Sensorgraph>(
            "sensorgraph",
            "Polynomials that predict a scanner's readings, as `realgap sense graph fit` finds them.",
        ),
        ron::<radio::RadioModel>(
            "radio",
            "A radio model, as `realgap sense radio fit` finds it.",
        ),
    ];
    #[cfg(feature = "papers")]
    kinds.extend(pictures());
    kinds.extend([
        json::<comparison::SavedBasis>(
            "basis",
            "`basis.json` of a results folder: principal components, so that scores of two comparisons can be compared.",
        ),
        json::<plan::Saved>(
            "plan",
            "`plan.json` of a plan's folder; written by `realgap cluster plan`, not by hand.",
        ),
    ]);
    kinds
}

/// The files of pictures.
#[cfg(feature = "papers")]
fn pictures() -> [FileKind; 3] {
    [
        ron::<vision::SceneFile>("scene", "A room to take pictures of."),
        ron::<vision::CameraFile>(
            "camera",
            "A camera, as `realgap sense vision tune` finds it; in a scene, or a file of its own.",
        ),
        ron::<vision::ViewsFile>(
            "views",
            "`views.ron`: the features that each picture in its folder shows.",
        ),
    ]
}
