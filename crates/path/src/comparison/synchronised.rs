//! Recordings on one time: a reference and others, ready to be compared.

use super::association::Matched;
use super::metric::Metric;
use super::time_base::TimeBase;
use super::timing::{Offset, Synchrony, Timing};
use crate::trajectory::{Recording, Span, cut_to_shortest};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::decimals;
use realgap_core::warning::{Code, Warning};

/// Recordings whose parts and samples belong together in time: made by [`synchronise`].
#[derive(Debug, Clone)]
pub struct Synchronised {
    /// The reference, cut to the time that all recordings have in common.
    pub reference: Recording,
    /// The other recordings, cut likewise, in the order given.
    pub others: Vec<Recording>,
    /// The matched samples of the reference and of each other recording, from the whole recordings; none at equal fractions, or where no
    /// metric compares samples.
    pub matched: Vec<Option<Matched>>,
    /// What the reference and each other recording have in common.
    pub synchrony: Vec<Synchrony>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Synchronised {
    /// One line about the time of the comparison; one line per recording where they differ.
    pub fn text(&self) -> String {
        let lines = self
            .synchrony
            .iter()
            .map(|synchrony| format!("time: {synchrony}"));
        let mut lines: Vec<String> = lines.collect();
        lines.dedup();
        if lines.len() > 1 {
            let named = self.others.iter().zip(&self.synchrony);
            lines = named
                .map(|(other, synchrony)| format!("time of {}: {synchrony}", other.name))
                .collect();
        }
        lines.join("\n")
    }
}

/// Brings recordings onto one time, so that these metrics can compare them.
///
/// Metrics of paths compare the time that all recordings have in common; metrics of samples ([`Metric::is_of_samples`]) compare the reference
/// with each other recording by itself.
///
/// # Errors
/// Recordings without a common time; an association or an alignment that no metric uses; for metrics of samples, recordings of which fewer than two samples belong together.
pub fn synchronise(
    mut reference: Recording,
    mut others: Vec<Recording>,
    timing: &Timing,
    metrics: &[&dyn Metric],
) -> Result<Synchronised> {
    let of_samples = metrics.iter().any(|metric| metric.is_of_samples());
    let of_paths = metrics.iter().any(|metric| !metric.is_of_samples());
    if !of_samples {
        timing.check_unused()?;
    }
    let mut in_time = Vec::with_capacity(others.len());
    let mut matched = Vec::with_capacity(others.len());
    let mut warnings = Vec::new();
    for other in &others {
        let both = [&reference.trajectory, &other.trajectory];
        let at_file = |error: Error| error.at_file(&other.path);
        let pair = timing.synchronise(both[0], both[1]).map_err(at_file)?;
        matched.push(match of_samples {
            true => pair.matched().map_err(at_file)?.cloned(),
            false => None,
        });
        let named = |warning: Warning| {
            let message = format!("{}: {}", other.name, warning.message);
            warning.code.warning(message)
        };
        warnings.extend(pair.warnings(both, of_samples).into_iter().map(named));
        in_time.push(pair);
    }
    let synchrony = in_time.iter().map(|pair| pair.summary).collect();
    let spans: Vec<Span> = in_time.iter().filter_map(|pair| pair.common()).collect();
    let common = spans.split_first().map(|(first, rest)| {
        rest.iter()
            .try_fold(*first, |common, span| common.common(*span))
    });
    match common {
        // Equal fractions need no common time.
        None => {}
        Some(_) if timing.base == TimeBase::Start && timing.offset == Offset::Unstated => {
            let mut all: Vec<&mut Recording> =
                std::iter::once(&mut reference).chain(&mut others).collect();
            let cut = cut_to_shortest(&mut all)?;
            warnings.extend(cut.filter(|_| of_paths));
        }
        Some(Some(common)) => {
            let durations = std::iter::once(&reference).chain(&others);
            let durations = durations.map(|recording| recording.trajectory.duration_s());
            let longest_s = durations.fold(0.0, f64::max);
            let whole = reference.trajectory.clone();
            for (pair, other) in in_time.iter().zip(&mut others) {
                [reference.trajectory, other.trajectory] =
                    pair.cut(common, [&whole, &other.trajectory])?;
            }
            if of_paths && longest_s > common.duration_s() + 1e-6 {
                warnings.push(Code::ReadAs.warning(format!(
                    "paths are compared over the {} s that all recordings have in common; the longest lasts {} s",
                    decimals(common.duration_s(), 3),
                    decimals(longest_s, 3)
                )));
            }
        }
        Some(None) if of_paths => {
            return Err(Error::invalid("there is no time common to all recordings")
                .found(format!("{} recordings", 1 + others.len()))
                .hint("compare them with the reference one by one")
                .advise(Advice::OtherTime));
        }
        Some(None) => {}
    }
    Ok(Synchronised {
        reference,
        others,
        matched,
        synchrony,
        warnings,
    })
}
