//! The kind of a file, so that an error about a wrong file says what the file is and which command reads it.

use std::path::{Path, PathBuf};

use realgap::calibration::{Definition, Overrides, Repeatable, Study, read_best, study_of};
use realgap::file::Source;
use realgap::robot::genome::Individual;
use realgap::robot::morphology::Morphology;
use realgap::search::{self, Search};
use realgap::{Error, Result, trajectory};

use super::consent;

/// The kinds of files that people name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Morphology,
    Genome,
    Study,
    Search,
    Parameters,
    Meta,
    Trajectory,
    Arena,
    Sensor,
    Vehicle,
    Radio,
    Controller,
    #[cfg(feature = "papers")]
    Scene,
    Sensorgraph,
}

impl Kind {
    /// The kind of a RON text by its outermost fields; `None` for any other text.
    pub fn of_ron(source: &Source) -> Option<Self> {
        let has = |field: &str| source.locate(field).is_some();
        // A genome has modules, a study and a search have parameters too, so they come first.
        [
            ("strategy", Self::Search),
            ("genes", Self::Genome),
            ("modules", Self::Morphology),
            ("bodies", Self::Morphology),
            ("morphology", Self::Study),
            ("vehicle", Self::Study),
            ("robots", Self::Study),
            ("simulator", Self::Study),
            #[cfg(feature = "papers")]
            ("room_m", Self::Scene),
            ("segments_deg", Self::Sensorgraph),
            ("boundary", Self::Arena),
            ("propagation", Self::Radio),
            ("spread", Self::Sensor),
            ("radius_m", Self::Vehicle),
            ("rate_hz", Self::Controller),
            ("parameters", Self::Parameters),
            ("robot", Self::Meta),
        ]
        .into_iter()
        .find_map(|(field, kind)| has(field).then_some(kind))
    }

    /// The name of the kind in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Morphology => "morphology",
            Self::Genome => "genome",
            Self::Study => "study",
            Self::Search => "search",
            Self::Parameters => "parameter file",
            Self::Meta => "meta.ron of recordings",
            Self::Trajectory => "trajectory",
            Self::Arena => "arena",
            Self::Sensor => "sensor model",
            Self::Vehicle => "vehicle",
            Self::Radio => "radio model",
            Self::Controller => "controller",
            #[cfg(feature = "papers")]
            Self::Scene => "scene",
            Self::Sensorgraph => "sensorgraph",
        }
    }

    /// `a study`, `an arena`.
    fn with_article(self) -> String {
        let name = self.name();
        let article = if name.starts_with('a') { "an" } else { "a" };
        format!("{article} {name}")
    }

    /// A hint which commands read a file of this kind.
    fn hint(self, path: &Path) -> String {
        let path = path.display();
        match self {
            Self::Morphology => format!(
                "`realgap simulate {path}` runs a robot; a study names a robot, its recordings and what to vary (sweeps/tripod_floor.ron is one)"
            ),
            Self::Genome => {
                format!("`realgap robot develop {path} -o robot.ron` makes a robot of it")
            }
            Self::Study => format!(
                "`realgap sweep {path}` finds the values that match its recordings, `realgap ensemble {path}` repeats it under noise; the \
                 robot is the file that its field `morphology` names"
            ),
            Self::Search => format!("`realgap search {path}` searches for the best robot"),
            Self::Parameters => {
                format!("give it as `--parameters {path}`, beside a robot or a study")
            }
            Self::Meta => {
                format!("`realgap check {path}` shows what it says about the recordings beside it")
            }
            Self::Arena => format!(
                "`realgap check {path} --plot arena.png` draws an arena; a vehicle names it"
            ),
            Self::Controller => format!(
                "`realgap simulate ROBOT --controller {path}` runs a robot with a controller"
            ),
            #[cfg(feature = "papers")]
            Self::Sensor | Self::Radio | Self::Scene | Self::Sensorgraph => {
                super::sense::hint(self, &path)
            }
            #[cfg(not(feature = "papers"))]
            Self::Sensor | Self::Radio | Self::Sensorgraph => {
                format!("a controller names {path}; `realgap check {path}` shows what is in it")
            }
            Self::Vehicle => format!("a study names {path}: vehicle: (file: ...)"),
            Self::Trajectory => {
                format!(
                    "`realgap check {path}` describes a trajectory, `realgap compare` compares two"
                )
            }
        }
    }
}

/// Reads a robot.
pub fn read_morphology(path: &Path) -> Result<Morphology> {
    Morphology::read(path).map_err(|error| explain(path, Kind::Morphology, error))
}

/// Reads a genome.
pub fn read_individual(path: &Path) -> Result<Individual> {
    Individual::read(path).map_err(|error| explain(path, Kind::Genome, error))
}

/// Reads a study for its repeats.
pub fn read_repeatable(path: &Path, overrides: &Overrides) -> Result<Repeatable> {
    let (path, overrides) = &resolve_study(path, overrides)?;
    let read = |overrides: &Overrides| Repeatable::read(path, overrides);
    consent::reading(read, overrides).map_err(|error| explain(path, Kind::Study, error))
}

/// Whether a file looks like a search.
pub fn is_search(path: &Path) -> bool {
    let source = Source::read(path, "file").ok();
    source.and_then(|source| Kind::of_ron(&source)) == Some(Kind::Search)
}

/// Whether a file looks like a study, or the best values of one.
pub fn is_study(path: &Path) -> bool {
    if path.extension().is_none_or(|ending| ending != "ron") {
        return false;
    }
    let source = Source::read(path, "file").ok();
    let kind = source.and_then(|source| Kind::of_ron(&source));
    kind == Some(Kind::Study) || (kind == Some(Kind::Parameters) && study_of(path).is_some())
}

/// Whether a file is a study of the user's own simulator.
pub fn is_of_own_simulator(path: &Path) -> bool {
    let named = |path: &Path| {
        let source = Source::read(path, "file").ok();
        source.is_some_and(|source| source.has("simulator"))
    };
    is_study(path) && (named(path) || study_of(path).is_some_and(|study| named(&study)))
}

/// Reads a search.
pub fn read_search(path: &Path, overrides: &search::Overrides) -> Result<Search> {
    Search::read(path, overrides).map_err(|error| explain(path, Kind::Search, error))
}

/// Reads a study.
pub fn read_study(path: &Path, overrides: &Overrides) -> Result<Study> {
    Study::new(read_definition(path, overrides)?)
}

/// Reads a study and its recordings without making them ready to run.
pub fn read_definition(path: &Path, overrides: &Overrides) -> Result<Definition> {
    let (path, overrides) = &resolve_study(path, overrides)?;
    let read = |overrides: &Overrides| Definition::read(path, overrides);
    consent::reading(read, overrides).map_err(|error| explain(path, Kind::Study, error))
}

/// The study and its overrides: a parameter file that names its study stands for that study with the file's values.
fn resolve_study(path: &Path, overrides: &Overrides) -> Result<(PathBuf, Overrides)> {
    let Some(study) = study_of(path) else {
        return Ok((path.to_path_buf(), overrides.clone()));
    };
    // Values from options replace the file's values and its draws.
    let own = read_best(path)?.with_values(&overrides.set);
    let mut overrides = overrides.clone();
    overrides.set = own.values;
    overrides.draws = [own.draws, overrides.draws].concat();
    overrides.fitted_on.extend(own.fitted_on);
    Ok((study, overrides))
}

/// The error of reading `path` as `wanted`; where the file is clearly of another kind, an error that says so.
pub fn explain(path: &Path, wanted: Kind, error: Error) -> Error {
    let found = if trajectory::format_of(path).is_ok() {
        path.is_file().then_some(Kind::Trajectory)
    } else {
        Source::read(path, "file")
            .ok()
            .and_then(|source| Kind::of_ron(&source))
    };
    match found {
        Some(found) if found != wanted => {
            let what = format!("{}, not {}", found.with_article(), wanted.with_article());
            Error::invalid(what)
                .at_file(path)
                .found(found.with_article())
                .allowed(wanted.with_article())
                .hint(found.hint(path))
                .into_usage()
        }
        _ => error,
    }
}
