//! Which recordings values were fitted on, so that nobody takes agreement with these for a prediction.

use realgap_core::file::sha256;
use realgap_core::{Code, Warning};
use realgap_path::trajectory::Recording;

/// Hexadecimal digits that tell recordings apart: 64 bits.
const DIGITS: usize = 16;

/// What a recording is known by whatever its file is called: the start of the SHA-256 of its samples.
pub fn recording_id(recording: &Recording) -> String {
    let mut id = samples_sha256(recording);
    id.truncate(DIGITS);
    id
}

/// Hash of what was recorded.
pub(in crate::calibration) fn samples_sha256(recording: &Recording) -> String {
    let samples = format!("{:?}", recording.trajectory);
    // A recording without signals is known by what it was known by before there were any.
    sha256(samples.replacen(", signals: []", "", 1).as_bytes())
}

/// Conclusion so where recordings are among those that the values were fitted on.
pub(in crate::calibration) fn in_sample(
    recordings: &[Recording],
    fitted_on: &[String],
) -> Option<Warning> {
    if fitted_on.is_empty() {
        return None;
    }
    let known = |recording: &&Recording| fitted_on.contains(&recording_id(recording));
    let count = recordings.iter().filter(known).count();
    (count > 0).then(|| {
        Code::InSample.warning(format!(
            "in-sample: the values were fitted on {count} of these {} recordings, so that agreement with them flatters; hold some out of the fit, \
                 or compare with others",
            recordings.len()
        ))
    })
}
