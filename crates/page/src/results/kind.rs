//! Which files of a results folder are results: those may be replaced and removed, nothing else.

use super::search;
use realgap_core::file::SEAL_FILE;
use realgap_simulation::parameter;

/// What a results folder is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A sweep or a tuning.
    Study,
    /// A search.
    Search,
    /// Repeats of a study.
    Ensemble,
    /// The gap of a study, or the noise floor of recordings.
    Gap,
    /// The prediction card of a robot.
    Prediction,
}

/// Names of the files of results folders, for all code that writes or reads one.
pub(crate) mod file {
    pub(crate) const SUMMARY: &str = "summary.json";
    pub(crate) const POINTS: &str = "points.csv";
    pub(crate) const INDISTINGUISHABLE: &str = "indistinguishable.csv";
    pub(crate) const SCORES: &str = "scores.csv";
    pub(crate) const PROFILES: &str = "profiles.csv";
    pub(crate) const TRIALS: &str = "trials.csv";
    pub(crate) const BASIS: &str = "basis.json";
    pub(crate) const JOINTS: &str = "joints.csv";
    pub(crate) const BEST: &str = "best.ron";
    pub(crate) const HISTORY: &str = "history.csv";
    pub(crate) const ARCHIVE: &str = "archive.csv";
    pub(crate) const ENSEMBLE: &str = "ensemble.json";
    pub(crate) const REPEATS: &str = "repeats.csv";
    pub(crate) const GAP: &str = "gap.json";
    pub(crate) const PREDICTION: &str = "prediction.json";
    pub(crate) const TIMING: &str = "timing.json";
    /// The page, and the data that only the page needs.
    pub(crate) const PAGE: [&str; 2] = ["report.html", "page.json"];
}

impl Kind {
    /// Every kind.
    pub(super) const ALL: [Self; 5] = [
        Self::Study,
        Self::Search,
        Self::Ensemble,
        Self::Gap,
        Self::Prediction,
    ];

    /// Tables and reports of this kind, and its pictures without their endings, a blank between two.
    fn names(self) -> (&'static [&'static str], &'static str) {
        use file::*;
        match self {
            Self::Study => (
                &[
                    SUMMARY,
                    POINTS,
                    INDISTINGUISHABLE,
                    SCORES,
                    PROFILES,
                    TRIALS,
                    BASIS,
                    JOINTS,
                    BEST,
                ],
                "verdict heatmap heatmap_fitness heatmap_uncertainty heatmap_runs curve trajectories convergence components corner joints",
            ),
            Self::Search => (
                &[SUMMARY, HISTORY, ARCHIVE],
                "fitness archive gallery paths",
            ),
            Self::Ensemble => (&[ENSEMBLE, REPEATS], "ensemble"),
            Self::Gap => (&[GAP], "confidence rmse"),
            Self::Prediction => (&[PREDICTION, REPEATS], "prediction"),
        }
    }

    /// Whether results of this kind are in a file of this name (its path inside of the folder).
    pub(crate) fn has(self, name: &str) -> bool {
        let (files, pictures) = self.names();
        let is_one = |stem: &str| pictures.split(' ').any(|known| known == stem);
        let is_drawn = |stem: &str| is_one(stem) || self.draws_many(stem);
        name == file::TIMING
            || name == SEAL_FILE
            || file::PAGE.contains(&name)
            || files.contains(&name)
            || picture_stem(name).is_some_and(is_drawn)
            || (self == Self::Search && search::is_ours(name))
    }

    /// Whether this picture is one of several of this kind that differ by a number or a parameter.
    fn draws_many(self, stem: &str) -> bool {
        let rest = |start: &str| stem.strip_prefix(start);
        match self {
            Self::Study => {
                let is_number = |text: &str| text.parse::<usize>().is_ok();
                let is_pair = |rest: &str| {
                    let pair = rest.split_once('_');
                    pair.is_some_and(|(a, b)| is_number(a) && is_number(b))
                };
                let is_parameter = |rest: &str| {
                    // A study's own simulator calls its parameters as it likes.
                    let of_guest = rest.strip_prefix(parameter::FOREIGN);
                    of_guest.is_some_and(|own| own.starts_with('_'))
                        || parameter::all().any(|p| file_stem(p.name) == rest)
                };
                rest("heatmap_").is_some_and(is_pair) || rest("profile_").is_some_and(is_parameter)
            }
            Self::Ensemble => rest("ensemble_").is_some_and(|number| {
                number.len() >= 3 && number.bytes().all(|b| b.is_ascii_digit())
            }),
            _ => false,
        }
    }
}

/// The name of a parameter in the names of files: letters that no file may have on some system are left out.
pub(crate) fn file_stem(parameter: &str) -> String {
    let named = parameter.replace('*', "all");
    let is_plain = |c: char| c.is_alphanumeric() || c == '-';
    let plain = named.chars().map(|c| if is_plain(c) { c } else { '_' });
    plain.collect::<String>().trim_end_matches('_').to_owned()
}

/// The name of a picture without its ending.
pub(crate) fn picture_stem(name: &str) -> Option<&str> {
    name.strip_suffix(".png").or(name.strip_suffix(".svg"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_exact_names_are_results() {
        for (kind, name) in [
            (Kind::Study, "points.csv"),
            (Kind::Study, "heatmap_1_2.png"),
            (Kind::Study, "profile_floor_friction.svg"),
            (Kind::Study, "profile_sim_joint_all_hip_damping.svg"),
            (Kind::Study, "timing.json"),
            (Kind::Gap, "report.html"),
            (Kind::Search, "page.json"),
            (Kind::Search, "best/01_robot_00042.ron"),
            (Kind::Ensemble, "ensemble_001.png"),
            (Kind::Gap, "rmse.svg"),
            (Kind::Prediction, "prediction.png"),
        ] {
            assert!(kind.has(name), "{kind:?} {name}");
        }
        for (kind, name) in [
            (Kind::Study, "my_points.csv"),
            (Kind::Study, "heatmap_mine.png"),
            (Kind::Study, "profile_of_me.png"),
            (Kind::Study, "notes.txt"),
            (Kind::Ensemble, "ensemble_mine.png"),
            (Kind::Ensemble, "ensemble_1.png"),
            (Kind::Gap, "confidence_2.png"),
            (Kind::Prediction, "ensemble.json"),
        ] {
            assert!(!kind.has(name), "{kind:?} {name}");
        }
    }
}
