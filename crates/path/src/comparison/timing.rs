//! Brings trajectories onto one time: the common part for metrics of paths, matched samples for metrics of samples.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use super::association::{Association, Matched, Stamped};
use super::clock_doubt::visible_offset;
use super::clock_offset::{ClockOffset, clock_offset};
use super::time_base::TimeBase;
use super::umeyama::Umeyama;
use crate::trajectory::{Span, Trajectory};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{decimals, number};
use realgap_core::warning::{Code, Warning};

/// Trajectories have too little in common if it is less than this share of one of them.
const LARGE_PART: f64 = 0.5;

/// The offset between the clocks of two recordings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Offset {
    /// Nothing is known: the stamps count as they are, and an offset that is visible is doubted.
    #[default]
    Unstated,
    /// The other recording's stamps are this much later than the reference's for the same moment, seconds.
    Stated(f64),
    /// The offset is estimated from the speeds.
    Estimated,
}

impl FromStr for Offset {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "auto" {
            return Ok(Self::Estimated);
        }
        match text.parse::<f64>() {
            Ok(offset_s) if offset_s.is_finite() => Ok(Self::Stated(offset_s)),
            _ => Err(Error::usage("this is no offset between two clocks")
                .field("offset")
                .found(format!("`{text}`"))
                .allowed("`auto`, or a number of seconds")),
        }
    }
}

/// How two trajectories are compared in time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timing {
    /// Which moments belong together.
    pub base: TimeBase,
    /// Which samples belong together, for metrics of samples.
    pub association: Association,
    /// What is done to the matched samples of the other trajectory.
    pub alignment: Umeyama,
    /// The offset between the clocks.
    pub offset: Offset,
}

impl Timing {
    /// The usual timing with this base.
    pub fn of(base: TimeBase) -> Self {
        Self {
            base,
            ..Self::default()
        }
    }

    /// Checks that the parts belong together.
    ///
    /// # Errors
    /// An association, an alignment or an offset beside equal fractions, where no samples are matched; an impossible association.
    pub fn check(&self) -> Result<()> {
        self.association.check()?;
        if self.base != TimeBase::Fraction {
            return Ok(());
        }
        let refuse = |field: &str, why: &str| {
            Err(Error::usage("at equal fractions no samples are matched")
                .field(field)
                .hint(why)
                .advise(Advice::OtherTime))
        };
        if self.offset != Offset::Unstated {
            return refuse("offset", "equal fractions need no clock");
        }
        if self.association != Association::default() {
            return refuse("associate", "paths are resampled to points");
        }
        if self.alignment != Umeyama::None {
            return refuse("align", "the metric umeyama-ape aligns resampled points");
        }
        Ok(())
    }

    /// Checks that nothing is stated that only metrics of samples use.
    ///
    /// # Errors
    /// An association or an alignment.
    pub(super) fn check_unused(&self) -> Result<()> {
        let field = match (self.association == Association::default(), self.alignment) {
            (true, Umeyama::None) => return Ok(()),
            (true, _) => "align",
            (false, _) => "associate",
        };
        Err(
            Error::usage("this metric compares paths, and no matched samples")
                .field(field)
                .allowed("for the metrics ape, umeyama-ape, rpe and rotation"),
        )
    }

    /// Brings two trajectories onto one time.
    ///
    /// # Errors
    /// No common time, an offset that cannot be estimated, or parts that do not belong together ([`Timing::check`]).
    pub fn synchronise(&self, reference: &Trajectory, other: &Trajectory) -> Result<InTime> {
        self.check()?;
        if self.base == TimeBase::Fraction {
            return Ok(InTime {
                common: None,
                reference_start_s: 0.0,
                other_late_s: 0.0,
                matched: None,
                summary: Synchrony {
                    time: self.base,
                    ..Synchrony::default()
                },
                warnings: Vec::new(),
            });
        }
        let [a, b] = [reference, other].map(|trajectory| Stamped {
            trajectory,
            start_s: match self.base {
                TimeBase::Start => trajectory.times_s()[0],
                _ => 0.0,
            },
        });
        let found = match self.offset {
            Offset::Estimated => Some(self.estimated(reference, other)?),
            _ => None,
        };
        let offset_s = match (self.offset, found) {
            (Offset::Stated(offset_s), _) => offset_s,
            (_, Some(found)) => found.offset_s,
            _ => 0.0,
        };
        let spans = [Span::of(reference).later(-a.start_s), {
            Span::of(other).later(-b.start_s - offset_s)
        }];
        let Some(common) = spans[0].common(spans[1]) else {
            return Err(no_common_time(spans, self.offset));
        };
        let matched = Matched::new(a, b, offset_s, self.association);
        let mut warnings = Vec::new();
        if self.base == TimeBase::Clock && self.offset == Offset::Unstated {
            warnings.extend(visible_offset(a, b));
        }
        let counted = matched.as_ref().ok();
        Ok(InTime {
            common: Some(common),
            reference_start_s: a.start_s,
            other_late_s: b.start_s + offset_s,
            summary: Synchrony {
                time: self.base,
                common_s: Some(common.duration_s()),
                matched: counted.map(Matched::len),
                unmatched_reference: counted.map(|m| m.unmatched()[0]),
                unmatched: counted.map(|m| m.unmatched()[1]),
                offset_s: (self.offset != Offset::Unstated).then_some(offset_s),
                offset_deviation_s: found.map(|found| found.deviation_s),
            },
            matched: Some(matched.map(|matched| matched.aligned(self.alignment))),
            warnings,
        })
    }

    /// The offset of the other's clock from the speeds, counted as [`Timing::base`] counts times.
    fn estimated(&self, reference: &Trajectory, other: &Trajectory) -> Result<ClockOffset> {
        let starts_s = other.times_s()[0] - reference.times_s()[0];
        let shorter_s = reference.duration_s().min(other.duration_s());
        let common = Span::of(reference).common(Span::of(other));
        // Clocks of different epochs have nothing in common: then the starts are laid together, and the offset is sought there.
        let shared = common.is_some_and(|common| common.duration_s() >= LARGE_PART * shorter_s);
        let about_s = match (self.base, shared) {
            (TimeBase::Clock, true) => 0.0,
            _ => starts_s,
        };
        let mut found = clock_offset(reference, other, about_s).ok_or_else(|| {
            Error::invalid("the speeds of the two trajectories do not show the offset of a clock")
                .hint("this needs motion that changes its speed, in at least half of the shorter recording; else state the offset in seconds")
        })?;
        if self.base == TimeBase::Start {
            found.offset_s -= starts_s;
        }
        Ok(found)
    }
}

fn no_common_time([reference, other]: [Span; 2], offset: Offset) -> Error {
    let error = Error::invalid("the two recordings have no common time")
        .found(format!("{reference} and {other}"))
        .allowed("stamps of one clock that overlap")
        .advise(Advice::OtherTime);
    match offset {
        Offset::Unstated => error.advise(Advice::EstimateOffset),
        _ => error,
    }
}

/// What two trajectories have in common in time. It is a part of every row of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Synchrony {
    /// Which moments belong together.
    pub time: TimeBase,
    /// Length of the common time, seconds; none at equal fractions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub common_s: Option<f64>,
    /// Number of matched pairs of samples; none at equal fractions, or where samples do not match.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matched: Option<usize>,
    /// Samples of the reference without a partner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unmatched_reference: Option<usize>,
    /// Samples of the other trajectory without a partner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unmatched: Option<usize>,
    /// How much later the other's stamps are than the reference's for the same moment, seconds; none if no offset was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_s: Option<f64>,
    /// Standard deviation of the offset, seconds; none if it was stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_deviation_s: Option<f64>,
}

impl fmt::Display for Synchrony {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.time {
            TimeBase::Clock => f.write_str("stamps of one clock")?,
            TimeBase::Start => f.write_str("times since each start")?,
            TimeBase::Fraction => f.write_str("equal fractions of the durations")?,
        }
        if let Some(common_s) = self.common_s {
            write!(f, ", {} s in common", decimals(common_s, 3))?;
        }
        if let (Some(matched), Some(reference), Some(other)) =
            (self.matched, self.unmatched_reference, self.unmatched)
        {
            write!(
                f,
                "; {matched} samples matched, unmatched: {reference} of the reference and {other}"
            )?;
        }
        if let Some(offset_s) = self.offset_s {
            write!(f, "; offset {} s", decimals(offset_s, 3))?;
        }
        if let Some(deviation_s) = self.offset_deviation_s {
            write!(f, " (± {} s)", number(deviation_s))?;
        }
        Ok(())
    }
}

/// Two trajectories on one time.
#[derive(Debug, Clone)]
pub struct InTime {
    /// The common time, counted as the time base counts; none at equal fractions.
    common: Option<Span>,
    /// The reference's stamp at the time 0.
    reference_start_s: f64,
    /// The other's stamp at the time 0.
    other_late_s: f64,
    matched: Option<Result<Matched>>,
    /// What they have in common.
    pub summary: Synchrony,
    warnings: Vec<Warning>,
}

impl InTime {
    /// The common time, counted as the time base counts; `None` at equal fractions.
    pub fn common(&self) -> Option<Span> {
        self.common
    }

    /// The parts of the reference and of the other trajectory in `span`, which is counted as the time base counts.
    ///
    /// # Errors
    /// A span in which one of them has no time.
    pub fn cut(&self, span: Span, [reference, other]: [&Trajectory; 2]) -> Result<[Trajectory; 2]> {
        Ok([
            span.later(self.reference_start_s).cut(reference)?,
            span.later(self.other_late_s).cut(other)?,
        ])
    }

    /// The matched samples; `None` at equal fractions.
    ///
    /// # Errors
    /// Fewer than two samples belong together.
    pub fn matched(&self) -> Result<Option<&Matched>> {
        match &self.matched {
            None => Ok(None),
            Some(Ok(matched)) => Ok(Some(matched)),
            Some(Err(error)) => Err(error.clone()),
        }
    }

    /// What the reader should know: an offset that is visible, and much that is unmatched; the latter counts only where samples are
    /// compared.
    pub fn warnings(&self, of: [&Trajectory; 2], samples: bool) -> Vec<Warning> {
        let mut warnings = self.warnings.clone();
        let Some(common) = self.common else {
            return warnings;
        };
        let longest_s = of
            .map(Trajectory::duration_s)
            .into_iter()
            .fold(0.0, f64::max);
        let common_s = common.duration_s();
        let fewest = of.map(Trajectory::len).into_iter().min().unwrap_or(0);
        if common_s < LARGE_PART * longest_s {
            warnings.push(Code::UnmatchedSamples.warning(format!(
                "only {} s are common to recordings of {} and {} s",
                decimals(common_s, 3),
                decimals(of[0].duration_s(), 3),
                decimals(of[1].duration_s(), 3),
            )));
        } else if let Some(Ok(matched)) = &self.matched
            && samples
            && (matched.len() as f64) < LARGE_PART * fewest as f64
        {
            warnings.push(Code::UnmatchedSamples.warning(format!(
                "only {} samples belong together, of {} and {}",
                matched.len(),
                of[0].len(),
                of[1].len(),
            )));
        }
        warnings
    }
}
