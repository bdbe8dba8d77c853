//! Settings that a study states and that nothing would use: each is an error that says what lacks, because who states something expects an
//! effect.

use super::StudyFile;
use crate::calibration::{StartRule, WindowRule};
use realgap_core::file::Source;
use realgap_core::{Error, Result};
use realgap_path::comparison::Metric;
use realgap_path::trajectory::Alignment;

impl StudyFile {
    /// Refuses the first setting without an effect. `metrics` are the study's own one and the one in its place.
    pub(super) fn check_used(&self, source: &Source, metrics: [&dyn Metric; 2]) -> Result<()> {
        let is_settled = self.start == StartRule::Settled;
        let needs = metrics.map(|metric| metric.needs());
        let has_basis = needs.iter().any(|needs| needs.basis);
        let has_paths = needs.iter().any(|needs| !needs.joints);
        let metric = metrics[1].name();
        let all: [(&'static str, bool, String); 5] = [
            (
                "windows",
                self.windows != WindowRule::default() && self.horizon.is_none(),
                "add `horizon: (LENGTH_S, EVERY_S)`, which cuts recordings into windows, or leave `windows` out".to_owned(),
            ),
            (
                "horizon",
                self.horizon.is_some() && is_settled,
                "windows start from what was recorded: use `start: FromRecording`, or leave `horizon` out".to_owned(),
            ),
            (
                "left_out",
                !self.left_out.is_empty() && is_settled,
                "columns and joints are matched where runs start from a recording: use `start: FromRecording`, or leave `left_out` out".to_owned(),
            ),
            (
                "align",
                self.align != Alignment::default() && !has_paths,
                format!("the metric `{metric}` compares joints, which have no direction: leave `align` out, or use a metric of paths, e.g. `metric: \"pose\"`"),
            ),
            (
                "basis",
                self.basis.is_some() && !has_basis,
                format!("the metric `{metric}` needs no principal components: leave `basis` out, or use `metric: \"pca\"`"),
            ),
        ];
        let mut all = all.into_iter();
        let Some((field, _, hint)) = all.find(|(_, is_unused, _)| *is_unused) else {
            return Ok(());
        };
        let error = Error::invalid("nothing in this study uses this setting");
        Err(source.at(field, error.hint(hint)))
    }
}
