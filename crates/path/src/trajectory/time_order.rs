//! Judges times that go back: a few samples out of order, runs that follow each other in one file, or bodies whose rows alternate.

use nalgebra::Vector3;

/// The least usual number of samples between two steps back, if runs follow each other.
const STRETCH: usize = 8;
/// The largest number of bodies whose rows may alternate.
const BODIES: usize = 6;
/// Rows belong to several bodies if every row is nearer to a later one than to the next by this factor, …
const NEARER: f64 = 2.0;
/// … and by this factor if times increase throughout, so that nothing else suggests several bodies.
const CLEARLY_NEARER: f64 = 10.0;
/// A sample is late, not of another run, if it is at most this many usual intervals late, …
const LATE: f64 = 10.0;
/// … if at most this share of all samples is late, …
const LATE_SHARE: f64 = 0.1;
/// … if the path in the order of times is at most this much longer than in the order of rows, …
const LONGER: f64 = 1.02;
/// … and if samples at one time are at most this many usual steps apart.
const APART: f64 = 3.0;
/// The number of samples from which the length of the path is judged.
const ENOUGH: usize = 8;

/// Why times go back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Disorder {
    /// A few samples are a little late: sorting is harmless.
    Late,
    /// Times start again: runs follow each other, or a clock was set back.
    Appended,
    /// The rows of this many bodies alternate.
    Alternating(usize),
    /// None of these.
    Unclear,
}

/// Times in the order of the file with the places of their samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct InFile<'a> {
    pub(super) times_s: &'a [f64],
    pub(super) places: &'a [Vector3<f64>],
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}

impl InFile<'_> {
    /// The samples that are not later than the sample before.
    pub(super) fn steps_back(&self) -> Vec<usize> {
        let t = self.times_s;
        (1..t.len()).filter(|k| t[*k] <= t[k - 1]).collect()
    }

    fn step(&self, from: usize, to: usize) -> f64 {
        (self.places[to] - self.places[from]).norm()
    }

    /// The length of the path through these samples.
    fn length(&self, order: &[usize]) -> f64 {
        order.windows(2).map(|w| self.step(w[0], w[1])).sum()
    }

    fn usual_step(&self, lag: usize) -> f64 {
        median(
            (lag..self.times_s.len())
                .map(|k| self.step(k - lag, k))
                .collect(),
        )
    }

    /// The number of bodies whose rows alternate; `None` if all rows are of one body.
    fn bodies(&self, nearer: f64) -> Option<usize> {
        if self.times_s.len() < 4 * BODIES {
            return None;
        }
        let next = self.usual_step(1);
        (2..=BODIES).find(|lag| nearer * self.usual_step(*lag) < next)
    }

    /// The order of times; samples at one time stay in the order of the file.
    fn sorted(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.times_s.len()).collect();
        order.sort_by(|a, b| self.times_s[*a].total_cmp(&self.times_s[*b]));
        order
    }

    /// Why times go back; `None` if they do not.
    pub(super) fn disorder(&self) -> Option<Disorder> {
        let steps = self.steps_back().len();
        if steps == 0 {
            return None;
        }
        if self.is_late() {
            return Some(Disorder::Late);
        }
        if self.times_s.len() >= STRETCH * (steps + 1) {
            return Some(Disorder::Appended);
        }
        let all: Vec<usize> = (0..self.times_s.len()).collect();
        let is_separable = || self.increases(&self.of_bodies(all, NEARER));
        Some(match self.bodies(NEARER) {
            Some(bodies) if is_separable() => Disorder::Alternating(bodies),
            _ => Disorder::Unclear,
        })
    }

    /// True if every part has several samples, and times that increase.
    fn increases(&self, parts: &[Vec<usize>]) -> bool {
        let t = self.times_s;
        let mut parts = parts.iter();
        parts.all(|part| part.len() > 1 && part.windows(2).all(|w| t[w[0]] < t[w[1]]))
    }

    /// The number of bodies whose rows alternate although times increase throughout.
    pub(super) fn hidden_bodies(&self) -> Option<usize> {
        self.bodies(CLEARLY_NEARER)
    }

    /// True if a few samples are a little late.
    fn is_late(&self) -> bool {
        let t = self.times_s;
        let intervals = t.windows(2).map(|w| w[1] - w[0]).filter(|dt| *dt > 0.0);
        let usual_s = median(intervals.collect());
        let (mut latest, mut late) = (f64::NEG_INFINITY, 0_usize);
        for time_s in t {
            if *time_s <= latest {
                late += 1;
                if latest - time_s > LATE * usual_s {
                    return false;
                }
            }
            latest = latest.max(*time_s);
        }
        if late > 1 && late as f64 > LATE_SHARE * t.len() as f64 {
            return false;
        }
        let order = self.sorted();
        let same = |w: &&[usize]| t[w[0]] == t[w[1]];
        let far = order.windows(2).filter(same).map(|w| self.step(w[0], w[1]));
        let is_apart = far.fold(0.0, f64::max) > APART * self.usual_step(1);
        let in_file: Vec<usize> = (0..t.len()).collect();
        let is_longer = self.length(&order) > LONGER * self.length(&in_file);
        !is_apart && (t.len() < ENOUGH || !is_longer)
    }

    /// The samples of every run and body; `None` if they cannot be told apart. Late samples are put in the order of times.
    pub(super) fn parts(&self) -> Option<Vec<Vec<usize>>> {
        let all = || (0..self.times_s.len()).collect::<Vec<_>>();
        let parts = match self.disorder() {
            None => self.of_bodies(all(), CLEARLY_NEARER),
            Some(Disorder::Late) => vec![self.sorted()],
            Some(Disorder::Appended) => {
                let mut ends = self.steps_back();
                ends.push(self.times_s.len());
                let starts = std::iter::once(0).chain(ends.clone());
                let stretches = starts.zip(ends).map(|(from, to)| (from..to).collect());
                stretches
                    .flat_map(|stretch| self.of_bodies(stretch, CLEARLY_NEARER))
                    .collect()
            }
            Some(Disorder::Alternating(_)) => self.of_bodies(all(), NEARER),
            Some(Disorder::Unclear) => return None,
        };
        self.increases(&parts).then_some(parts)
    }

    /// These samples, separated into bodies by continuity: each sample belongs to the body that is nearest to it, going on as it went.
    fn of_bodies(&self, samples: Vec<usize>, nearer: f64) -> Vec<Vec<usize>> {
        let times_s: Vec<f64> = samples.iter().map(|k| self.times_s[*k]).collect();
        let places: Vec<_> = samples.iter().map(|k| self.places[*k]).collect();
        let own = InFile {
            times_s: &times_s,
            places: &places,
        };
        let Some(bodies) = own.bodies(nearer) else {
            return vec![samples];
        };
        let mut tracks: Vec<Vec<usize>> = samples[..bodies].iter().map(|k| vec![*k]).collect();
        for sample in &samples[bodies..] {
            let distance = |track: &Vec<usize>| match track.as_slice() {
                [.., before, last] => {
                    let going_on = 2.0 * self.places[*last] - self.places[*before];
                    (self.places[*sample] - going_on).norm()
                }
                [last] => self.step(*last, *sample),
                [] => f64::INFINITY,
            };
            let is_free = |track: &Vec<usize>| {
                let last = track.last().map(|k| self.times_s[*k]);
                last.is_some_and(|last| last < self.times_s[*sample])
            };
            let key = |track: &Vec<usize>| (!is_free(track), distance(track));
            let nearest = tracks.iter_mut().min_by(|a, b| {
                let (a, b) = (key(a), key(b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            });
            if let Some(track) = nearest {
                track.push(*sample);
            }
        }
        tracks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(rows: &[(f64, f64, f64)]) -> (Option<Disorder>, Option<usize>) {
        let times_s: Vec<f64> = rows.iter().map(|row| row.0).collect();
        let places: Vec<_> = rows
            .iter()
            .map(|row| Vector3::new(row.1, row.2, 0.0))
            .collect();
        let file = InFile {
            times_s: &times_s,
            places: &places,
        };
        (file.disorder(), file.parts().map(|parts| parts.len()))
    }

    /// A robot that drives along x from `from`, sampled every 0.1 s.
    fn run(from: f64, start_s: f64) -> Vec<(f64, f64, f64)> {
        let times = (0..60).map(f64::from);
        times
            .map(|k| (start_s + 0.1 * k, from + 0.02 * k, 0.01 * k))
            .collect()
    }

    #[test]
    fn late_samples_runs_and_bodies_are_told_apart() {
        let plain = run(0.0, 5.0);
        assert_eq!(judged(&plain), (None, Some(1)));
        let mut swapped = plain.clone();
        swapped.swap(20, 21);
        assert_eq!(judged(&swapped), (Some(Disorder::Late), Some(1)));
        let twice = [plain.clone(), run(0.0, 5.05)].concat();
        assert_eq!(judged(&twice), (Some(Disorder::Appended), Some(2)));
        // A clock that is set back by less than the duration of late samples, while the path goes on.
        let back = [plain.clone(), run(1.2, 5.0 + 5.6)].concat();
        assert_eq!(judged(&back), (Some(Disorder::Appended), Some(2)));
        let alternate = |other: &[(f64, f64, f64)]| -> Vec<_> {
            plain
                .iter()
                .zip(other)
                .flat_map(|(a, b)| [*a, *b])
                .collect()
        };
        let same_times = alternate(&run(3.0, 5.0));
        assert_eq!(
            judged(&same_times),
            (Some(Disorder::Alternating(2)), Some(2))
        );
        let between = alternate(&run(3.0, 5.02));
        assert_eq!(judged(&between), (None, Some(2)));
        let shuffled: Vec<_> = (0..60).map(|k| plain[(k * 37) % 60]).collect();
        assert_eq!(judged(&shuffled), (Some(Disorder::Unclear), None));
    }
}
