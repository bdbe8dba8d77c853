//! Identifiers of recordings, and the warning that values are compared with recordings on which they were fitted.

use realgap_core::file::sha256;
use realgap_core::{Code, Warning};
use realgap_path::trajectory::Recording;

/// Hexadecimal digits of an identifier: 64 bits.
const DIGITS: usize = 16;

/// Identifier of a recording, independent of the name of its file: the start of the SHA-256 of its samples.
pub fn recording_id(recording: &Recording) -> String {
    let mut id = samples_sha256(recording);
    id.truncate(DIGITS);
    id
}

/// SHA-256 of the samples.
pub(in crate::calibration) fn samples_sha256(recording: &Recording) -> String {
    let samples = format!("{:?}", recording.trajectory);
    // Recordings without signals keep the identifier that they had before recordings could have signals.
    sha256(samples.replacen(", signals: []", "", 1).as_bytes())
}

/// How many of these recordings are among those on which the values were fitted; `None` where no fit is known.
pub(in crate::calibration) fn seen_by_fit(
    recordings: &[Recording],
    fitted_on: &[String],
) -> Option<usize> {
    if fitted_on.is_empty() {
        return None;
    }
    let known = |recording: &&Recording| fitted_on.contains(&recording_id(recording));
    Some(recordings.iter().filter(known).count())
}

/// A warning where some recordings are among those on which the values were fitted.
pub(in crate::calibration) fn in_sample(
    recordings: &[Recording],
    seen_by_fit: Option<usize>,
) -> Option<Warning> {
    let count = seen_by_fit.filter(|count| *count > 0)?;
    Some(Code::InSample.warning(format!(
        "in-sample: the values were fitted on {count} of these {} recordings, so that agreement with them flatters; hold some out of the fit, \
             or compare with others",
        recordings.len()
    )))
}
