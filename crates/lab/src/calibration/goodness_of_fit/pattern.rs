//! The pattern of a misfit: which simple cause the residuals of a channel look like.
//!
//! Each cause moves a run by one number times a series that is known from the run: a delay by its velocity, a load by its
//! acceleration, and so on. Parameters have taken away a part of what a cause did, so each series is compared without that part,
//! as the residuals are (partial regression: Frisch & Waugh 1933). The cause that alone takes away most of the sum of squares is
//! named, if it takes away half.

use serde::Serialize;

/// What the difference between run and recordings follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    /// The velocity: the recordings are late, or early. The size is how late they are, seconds.
    Lag,
    /// Nothing: the difference is always the same. The size is simulated minus recorded value.
    Offset,
    /// The position: a bulge under load, or another scale. The size is the share of the motion by which the run goes too far.
    Position,
    /// The acceleration: inertia or a load. The size is the difference per acceleration, s².
    Load,
    /// The time since the start. The size is the difference at the end of a recording.
    Growth,
    /// The number of the recording: something drifts from one recording to the next. The size is the difference per recording.
    Drift,
    /// The recordings differ from each other without an order, more than the noise allows: they contradict each other, or
    /// repeats differ in a way that the study does not state. The size is 0.
    Scatter,
    /// None of these. The size is 0.
    Other,
}

/// The motion of one recording, and the difference from it.
#[derive(Debug, Clone, Copy)]
pub(in crate::calibration) struct Difference<'a> {
    /// Times since the start, seconds.
    pub times_s: &'a [f64],
    /// Simulated minus recorded values.
    pub residual: &'a [f64],
    /// Simulated values.
    pub motion: &'a [f64],
}

/// A pattern that takes away a smaller share of the mean square is not named.
const HALF: f64 = 0.5;
/// Below this share of the mean square, the mean over recordings says nothing about one of them.
const COMMON: f64 = 0.25;
/// A cause of which less than this share of the mean square is left beside parameters is nothing that a model lacks.
const EXPLAINED: f64 = 1e-3;
/// From this number of recordings on, a drift differs from scatter.
const DRIFTS: usize = 4;

impl Pattern {
    /// The pattern of these differences, in the order in which they were recorded, its size, and the share of the mean square
    /// that it takes away. `rest` takes away what parameters could explain of a list of numbers like all residuals.
    pub(in crate::calibration) fn of(
        all: &[Difference<'_>],
        rest: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> (Self, f64, f64) {
        let residual = rest(
            &all.iter()
                .flat_map(|own| own.residual)
                .copied()
                .collect::<Vec<_>>(),
        );
        let square = dot(&residual, &residual);
        let found = Self::causes(all).into_iter().map(|(pattern, cause)| {
            let left = rest(&cause);
            // Parameters can do the same as this cause.
            if dot(&left, &left) < EXPLAINED * dot(&cause, &cause) {
                return (pattern, 0.0, 0.0);
            }
            let size = dot(&residual, &left) / dot(&left, &left).max(f64::MIN_POSITIVE);
            let share = size * dot(&residual, &left) / square.max(f64::MIN_POSITIVE);
            (pattern, size, share)
        });
        let best = found.max_by(|a, b| a.2.total_cmp(&b.2));
        match best {
            Some(best) if best.2 >= HALF => best,
            _ if all.len() > 1 && common_share(all, &residual) < COMMON => {
                (Self::Scatter, 0.0, 0.0)
            }
            best => (Self::Other, 0.0, best.map_or(0.0, |(_, _, share)| share)),
        }
    }

    /// What each cause of size 1 would add to the differences.
    fn causes(all: &[Difference<'_>]) -> Vec<(Self, Vec<f64>)> {
        let middle = (all.len() as f64 - 1.0) / 2.0;
        let count: usize = all.iter().map(|own| own.motion.len()).sum();
        let motions = all.iter().flat_map(|own| own.motion);
        let level = motions.sum::<f64>() / count.max(1) as f64;
        let over = |of: &dyn Fn(usize, &Difference<'_>) -> Vec<f64>| -> Vec<f64> {
            let all = all.iter().enumerate();
            all.flat_map(|(number, own)| of(number, own)).collect()
        };
        let velocity = |own: &Difference<'_>| slope(own.times_s, own.motion);
        let since_start = |own: &Difference<'_>, power: i32| -> Vec<f64> {
            let last_s = own.times_s.last().copied().unwrap_or(1.0);
            own.times_s
                .iter()
                .map(|t| (t / last_s).powi(power))
                .collect()
        };
        let mut causes = vec![
            (Self::Offset, over(&|_, own| vec![1.0; own.motion.len()])),
            (Self::Lag, over(&|_, own| velocity(own))),
            (
                Self::Load,
                over(&|_, own| slope(own.times_s, &velocity(own))),
            ),
            (
                Self::Position,
                over(&|_, own| own.motion.iter().map(|m| m - level).collect()),
            ),
            (Self::Growth, over(&|_, own| since_start(own, 1))),
            (Self::Growth, over(&|_, own| since_start(own, 2))),
        ];
        if all.len() >= DRIFTS {
            let number = |number: usize, own: &Difference<'_>| {
                vec![number as f64 - middle; own.motion.len()]
            };
            causes.push((Self::Drift, over(&number)));
        }
        causes
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Slopes by central differences.
fn slope(times_s: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
        let span_s = times_s[b] - times_s[a];
        if span_s > 0.0 {
            (values[b] - values[a]) / span_s
        } else {
            0.0
        }
    };
    (0..values.len()).map(at).collect()
}

/// The share of the mean square that the mean difference over recordings has, at equal fractions of their durations.
fn common_share(all: &[Difference<'_>], residual: &[f64]) -> f64 {
    const PLACES: usize = 32;
    let mut from = 0;
    let parts = all.iter().map(|own| {
        from += own.residual.len();
        &residual[from - own.residual.len()..from]
    });
    let parts: Vec<&[f64]> = parts.filter(|part| !part.is_empty()).collect();
    let (mut common, mut whole) = (0.0, 0.0);
    for place in 0..PLACES {
        let at = |part: &&[f64]| part[place * (part.len() - 1) / (PLACES - 1)];
        let values: Vec<f64> = parts.iter().map(at).collect();
        let count = values.len() as f64;
        common += (values.iter().sum::<f64>() / count).powi(2);
        whole += dot(&values, &values) / count;
    }
    if whole > 0.0 { common / whole } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pattern of five recordings of a swing whose differences are `of(recording, time, angle, velocity, acceleration)`.
    fn pattern(of: impl Fn(usize, f64, [f64; 3]) -> f64) -> (Pattern, f64) {
        let times_s: Vec<f64> = (0..150).map(|k| f64::from(k) * 0.02).collect();
        let swings: Vec<(Vec<f64>, Vec<f64>)> = (0..5)
            .map(|number| {
                let at = |t: &f64| {
                    let (phase, rate) = (2.0 * t + number as f64, 2.0);
                    [
                        libm::sin(phase),
                        rate * libm::cos(phase),
                        -rate * rate * libm::sin(phase),
                    ]
                };
                let motion = times_s.iter().map(|t| at(t)[0]).collect();
                let residual = times_s.iter().map(|t| of(number, *t, at(t))).collect();
                (motion, residual)
            })
            .collect();
        let all: Vec<Difference<'_>> = swings
            .iter()
            .map(|(motion, residual)| Difference {
                times_s: &times_s,
                residual,
                motion,
            })
            .collect();
        let (pattern, size, _) = Pattern::of(&all, &|errors| errors.to_vec());
        (pattern, size)
    }

    #[test]
    fn each_cause_is_named_with_its_size() {
        type Case = (fn(usize, f64, [f64; 3]) -> f64, Pattern, f64);
        let cases: [Case; 5] = [
            (|_, _, [_, v, _]| 0.03 * v, Pattern::Lag, 0.03),
            (|_, _, _| -0.02, Pattern::Offset, -0.02),
            (|_, _, [p, _, _]| 0.1 * p, Pattern::Position, 0.1),
            (|_, t, _| 0.01 * t * t, Pattern::Growth, 0.01 * 2.98 * 2.98),
            (|n, _, _| 0.01 * (n as f64 - 2.0), Pattern::Drift, 0.01),
        ];
        for (of, expected, size) in cases {
            let (found, seen) = pattern(of);
            // The acceleration of a swing is proportional to its position.
            let is_same =
                found == expected || (expected == Pattern::Position && found == Pattern::Load);
            assert!(is_same, "{expected:?}: {found:?}");
            if found == expected {
                assert!((seen / size - 1.0).abs() < 0.05, "{expected:?}: {seen}");
            }
        }
    }

    #[test]
    fn recordings_that_contradict_each_other_and_unknown_causes_have_no_other_name() {
        let sign = [1.0, -1.0, -1.0, 1.0, 0.2];
        let (found, _) = pattern(|n, t, _| sign[n] * libm::sin(11.0 * t));
        assert_eq!(found, Pattern::Scatter);
        let (found, _) = pattern(|_, t, _| libm::sin(11.0 * t));
        assert_eq!(found, Pattern::Other);
    }
}
