//! The fingerprint of a study: everything that decides its results, so that two studies never share a results folder.

use std::collections::BTreeSet;

use crate::calibration::{Definition, Study};
use realgap_core::file::sha256;
use realgap_identification::StartState;
use realgap_path::trajectory::Alignment;
use realgap_store::Fingerprint;

impl Study {
    /// The fingerprint: everything that decides the results.
    pub fn fingerprint(&self) -> Fingerprint {
        let definition = self.definition();
        let experiment = &self.cases()[0].experiment;
        let mut print = Fingerprint::new()
            .with("realgap", env!("CARGO_PKG_VERSION"))
            .with("engine", experiment.engine_version())
            .with("study", &definition.name)
            .with("morphology sha256", &definition.morphology_sha256)
            .with("metric", definition.metric.name())
            .with("components", format!("{:?}", definition.components))
            .with("score", format!("{:?}", definition.score))
            .with("start", format!("{:?}", definition.start))
            .with(
                "duration_s",
                definition
                    .duration_s
                    .map_or("recording".to_owned(), |d| d.to_string()),
            )
            .with("solver", format!("{:?}", experiment.solver))
            .with("contact", format!("{:?}", experiment.contact))
            .with("set", &definition.set)
            .with("seed", definition.seed)
            .with(
                "unit of the recordings",
                format!("{:?}", definition.reading.length.unwrap_or_default()),
            );
        if let Some(second) = self.settings().second {
            print = print.with("second engine", second.get().version());
        }
        // The reading of the recordings contains the settings of a `meta.ron` beside them.
        let read_as = definition.recordings.iter().map(|r| r.reading.to_string());
        let read_as: BTreeSet<String> = read_as.filter(|how| !how.is_empty()).collect();
        for (index, how) in read_as.into_iter().enumerate() {
            print = print.with(format!("reading {index}"), how);
        }
        if let Some(condition) = &definition.condition {
            print = print.with("condition", condition);
        }
        if definition.align != Alignment::default() {
            print = print.with("align", format!("{:?}", definition.align));
        }
        if definition.basis.is_known() {
            print = print.with("basis", definition.basis.label());
        }
        if definition.start_state != StartState::FirstSample {
            print = print.with("start state", definition.start_state.label());
        }
        if let Some(commands) = &definition.commands {
            print = print.with("commands", format!("{commands:?}"));
        }
        if !definition.scored.is_empty() {
            print = print.with("channels", format!("{:?}", definition.scored));
        }
        if let Some(steering) = &definition.steering {
            print = print.with("controller sha256", steering.sha256());
        }
        if let Some(horizon) = definition.horizon {
            print = print.with("horizon", format!("{horizon:?}"));
        }
        if definition.priors.iter().any(Option::is_some) {
            print = print.with("priors", format!("{:?}", definition.priors));
        }
        if let Some(split) = definition.split {
            print = print.with("split", split);
        }
        for range in definition.grid.ranges() {
            print = print.with(
                format!("parameter {}", range.parameter.name),
                format!("{} to {}, {} points", range.from, range.to, range.points),
            );
        }
        definition.with_recordings(definition.with_robots(print))
    }
}

impl Definition {
    /// The fingerprint with the posterior draws that repeats take, where there are any.
    pub(crate) fn with_draws(&self, print: Fingerprint) -> Fingerprint {
        match self.draws.is_empty() {
            true => print,
            false => print.with(
                "draws sha256",
                sha256(format!("{:?}", self.draws).as_bytes()),
            ),
        }
    }

    /// The fingerprint with an entry for every recording.
    pub(crate) fn with_recordings(&self, print: Fingerprint) -> Fingerprint {
        let recordings = self.recordings.iter().zip(&self.recordings_sha256);
        recordings
            .enumerate()
            .fold(print, |print, (index, (recording, sha256))| {
                print.with(format!("recording {index} {}", recording.name), sha256)
            })
    }
}
