//! The order of samples: sorting late samples, splitting runs and bodies, and the error about times that go back.

use nalgebra::Vector3;

use super::{Layout, Samples, TIME_GOES_BACK};
use crate::trajectory::format::Parsed;
use crate::trajectory::time_order::{Disorder, InFile};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{counted, number};
use realgap_core::warning::Warning;

impl Samples {
    /// The places by which runs and bodies are told apart: positions, or the angles of the first three joints.
    pub(super) fn places(&self, layout: &Layout) -> Vec<Vector3<f64>> {
        if layout.place.is_some() {
            return self.positions_m.clone();
        }
        let angle = |joint: usize, sample: usize| {
            let joint = self.joints.get(joint);
            joint.map_or(0.0, |joint| joint.angles_rad[sample])
        };
        let samples = 0..self.times_s.len();
        samples
            .map(|k| Vector3::new(angle(0, k), angle(1, k), angle(2, k)))
            .collect()
    }

    /// The samples with these indices, in this order.
    fn part(&self, order: &[usize]) -> Self {
        fn of<T: Copy>(all: &[T], order: &[usize]) -> Vec<T> {
            match all.is_empty() {
                true => Vec::new(),
                false => order.iter().map(|index| all[*index]).collect(),
            }
        }
        let joints = self.joints.iter();
        let signals = self.signals.iter();
        Self {
            lines: of(&self.lines, order),
            times_s: of(&self.times_s, order),
            positions_m: of(&self.positions_m, order),
            orientations: of(&self.orientations, order),
            linear_m_s: of(&self.linear_m_s, order),
            angular_rad_s: of(&self.angular_rad_s, order),
            joints: joints
                .map(|joint| joint.map(|all| of(all, order)))
                .collect(),
            signals: signals
                .map(|signal| signal.map(|all| of(all, order)))
                .collect(),
            last_stamp: String::new(),
            ..*self
        }
    }

    /// The samples in the order of times; of several samples at one time, the first is kept. The second value is the largest distance of the
    /// others from it, metres.
    pub(super) fn sorted(&self) -> (Self, f64) {
        let times_s = &self.times_s;
        let mut order: Vec<usize> = (0..times_s.len()).collect();
        order.sort_by(|a, b| times_s[*a].total_cmp(&times_s[*b]));
        let mut farthest_m = 0.0_f64;
        order.dedup_by(|a, b| {
            let is_same = times_s[*a] == times_s[*b];
            if is_same {
                let difference_m = self.positions_m[*a] - self.positions_m[*b];
                farthest_m = farthest_m.max(difference_m.norm());
            }
            is_same
        });
        (self.part(&order), farthest_m)
    }

    /// The error about times that go back: it names the first row, counts the rows, and says what may have happened.
    pub(super) fn goes_back(&self, layout: &Layout, disorder: Disorder) -> Error {
        let steps = self.in_file(&self.positions_m).steps_back();
        let first = steps.first().copied().unwrap_or(0);
        let mut error = Error::invalid(TIME_GOES_BACK);
        if let Some((line, column)) = self.first_late {
            error = error.at_line(line, column);
        }
        if let Some(column) = layout.clock.columns().next() {
            error = error.field(&layout.names[column]);
        }
        let mut found = format!(
            "{} after {} in line {}",
            self.times_s[first],
            self.times_s[first.saturating_sub(1)],
            self.lines[first]
        );
        if let [_, second, ..] = steps.as_slice() {
            found += &format!(
                ", again in line {}; {} in {} samples",
                self.lines[*second],
                counted(steps.len(), "step"),
                self.times_s.len()
            );
        }
        let error = error.found(found).allowed("strictly increasing times");
        if let Some(hint) = &layout.time_hint {
            return error.hint(hint).advise(Advice::ChooseRobot);
        }
        if self.unpadded_steps == steps.len() && !self.is_unpadded {
            return error
                .hint("as whole nanoseconds behind the dot, without leading zeros, times increase")
                .advise(Advice::UnpaddedStamps);
        }
        let runs = counted(steps.len() + 1, "run");
        match disorder {
            Disorder::Late => error.advise(Advice::SortSamples),
            Disorder::Appended => {
                let places = self.places(layout);
                let jump = (places[first] - places[first - 1]).norm();
                let unit = if layout.place.is_some() { "m" } else { "rad" };
                error
                    .hint(format!(
                        "{runs} in one file, or a clock that was set back: there, the position changes by {} {unit}; sorting would mix them",
                        number(jump)
                    ))
                    .advise(Advice::Split)
            }
            Disorder::Alternating(bodies) => error
                .hint(format!("the rows of {bodies} bodies or runs seem to alternate; sorting would mix them"))
                .advise(Advice::Split)
                .advise(Advice::ChooseRobot),
            Disorder::Unclear => error
                .hint("the rows of several runs or bodies seem to be mixed: a column that names them would tell them apart")
                .advise(Advice::ChooseRobot),
        }
    }

    pub(super) fn in_file<'a>(&'a self, places: &'a [Vector3<f64>]) -> InFile<'a> {
        InFile {
            times_s: &self.times_s,
            places,
        }
    }

    /// The trajectories of all runs and bodies in the file, in the order of their first samples.
    ///
    /// # Errors
    /// Samples that cannot be told apart; the errors of [`Samples::finish`].
    pub(in crate::trajectory) fn finish_split(
        self,
        layout: &Layout,
        warnings: &[Warning],
    ) -> Result<Vec<Parsed>> {
        let places = self.places(layout);
        let file = self.in_file(&places);
        let disorder = file.disorder();
        let is_explained = layout.time_hint.is_some() || self.is_mistaken_for_disorder();
        let parts = match (file.parts(), disorder) {
            (_, Some(disorder)) if is_explained => return Err(self.goes_back(layout, disorder)),
            (Some(parts), _) => parts,
            (None, Some(disorder)) => return Err(self.goes_back(layout, disorder)),
            // Times increase, and the bodies cannot be told apart, or there are too few samples.
            (None, None) => Vec::new(),
        };
        if parts.len() < 2 {
            let sorted = Self {
                sorts: true,
                ..self
            };
            return Ok(vec![sorted.finish(layout, warnings.to_vec())?]);
        }
        let finished = parts.iter().enumerate().map(|(index, part)| {
            let mut part = Self {
                late: 0,
                ..self.part(part)
            };
            if index > 0 {
                // What was left out is said once.
                (part.lost, part.repeated, part.renormalised) = (0, 0, 0);
            }
            part.finish(layout, warnings.to_vec())
        });
        finished.collect()
    }

    /// True if another notation of times explains every step back.
    fn is_mistaken_for_disorder(&self) -> bool {
        self.late > 0 && self.unpadded_steps == self.late && !self.is_unpadded
    }
}
