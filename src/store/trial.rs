//! What is kept of one evaluated point of a study.

/// How the simulation of one case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum OutcomeStatus {
    /// The whole duration was simulated.
    Completed,
    /// The state became absurd; the reason.
    Diverged(String),
}

/// Result of simulating one case: one start, compared with one or more recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub status: OutcomeStatus,
    /// Steps taken.
    pub steps: u64,
    /// Length of the net displacement in the plane, metres; NaN when diverged.
    pub net_displacement_m: f64,
    /// Scores against the case's recordings, in order; empty where the metric needs a basis or the case diverged.
    pub scores: Vec<f64>,
    /// The prepared path, metres, where it is needed later; empty otherwise.
    pub path_xy_m: Vec<[f64; 2]>,
}

/// One evaluated point: parameter values and one outcome per case.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Index of the point in the study's order.
    pub index: usize,
    /// Values of the study's parameters, in the study's order.
    pub values: Vec<f64>,
    /// One outcome per case.
    pub outcomes: Vec<Outcome>,
}

impl Trial {
    /// Why a case diverged, the first that did; `None` where every case was simulated to its end.
    pub fn diverged(&self) -> Option<&str> {
        self.outcomes
            .iter()
            .find_map(|outcome| match &outcome.status {
                OutcomeStatus::Completed => None,
                OutcomeStatus::Diverged(why) => Some(why.as_str()),
            })
    }

    /// True where every case was simulated to its end.
    pub fn completed(&self) -> bool {
        self.outcomes
            .iter()
            .all(|outcome| outcome.status == OutcomeStatus::Completed)
    }
}

/// Scores of one trial, once they can be told.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialScore {
    /// Index of the trial.
    pub index: usize,
    /// Mean score over the recordings that were fitted; `None` where a case diverged.
    pub score: Option<f64>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
    /// Score against each recording, in order; empty where a case diverged.
    pub recordings: Vec<f64>,
}
