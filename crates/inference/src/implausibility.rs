//! How implausible places are: how much better another one scores, in standard deviations of what is unknown about the two.

use crate::emulator::Field;
use realgap_core::statistics::mean;

/// Recordings that the pooled variance of all recordings is worth beside what each pair of points shows itself.
const POOLED: f64 = 4.0;
/// Variance of a single recording in those of a run: a kernel that is smooth everywhere understates what a deviation moves at the
/// bottom of a valley, and with 4 the intervals of the worlds of `world.rs` hold what they promise.
const ALONE: f64 = 4.0;
/// The same in those of what might have been recorded in its place: nothing says that reality repeats as well as a simulation.
const AS_MUCH_AGAIN: f64 = 2.0;

/// What keeps scores apart beside the emulator and numerics.
#[derive(Debug, Clone, Copy)]
pub struct Doubt {
    /// Recordings that are fitted.
    pub recordings: usize,
    /// Variance of the model's discrepancy, in those of a recording; 0 where the model fits.
    pub discrepancy: f64,
}

/// Variances between places.
pub struct Variance {
    /// Of everything.
    pub all: nalgebra::DMatrix<f64>,
    /// Of the recordings with the discrepancy.
    pub recordings: nalgebra::DMatrix<f64>,
    /// Degrees of freedom of the second.
    freedom: f64,
}

impl Variance {
    /// The covariance of recordings is what they show at each pair of places, drawn towards one that is alike everywhere, as far
    /// as few recordings cannot tell (as a prior of `POOLED` recordings would; Ledoit & Wolf 2004). A single recording shows
    /// none: it is taken to vary `ALONE` times as a single run does.
    pub fn new(field: &Field, doubt: Doubt) -> Self {
        let n = field.means.len() as f64;
        let pairs = |matrix: &nalgebra::DMatrix<f64>| n * matrix.trace() - matrix.sum();
        let recordings = field.parts.ncols();
        let more = recordings.saturating_sub(1) as f64;
        let own = &field.parts * field.parts.transpose();
        let pooled = if more > 0.0 {
            pairs(&own) / more / pairs(&field.alike).max(1e-9)
        } else {
            ALONE * (field.noise + field.setting)
        };
        let one = (&field.alike * (POOLED * pooled) + own) / (POOLED + more);
        // Distances do not tell whether a recording or a simulation deviates, so that reality's own setting, which nobody knows,
        // moves the score as one recording more would, only as much as settings part runs where recordings part them. What might
        // have been recorded in place of a single recording has settings of its own.
        let setting = match doubt.recordings > 1 {
            true => field.setting / field.recording.max(1e-12),
            false => 0.0,
        };
        let one_over = match (doubt.recordings, recordings) {
            (..=1, 2..) => AS_MUCH_AGAIN,
            (fitted, _) => 1.0 / fitted.max(1) as f64,
        };
        let recordings = one * (one_over + setting + doubt.discrepancy);
        Self {
            all: &field.emulator + &field.numerics + &recordings,
            recordings,
            // Along a single valley the pooled variance is made of the same few recordings.
            freedom: if doubt.recordings > 1 { more } else { POOLED },
        }
    }

    /// Variance of the difference of two places.
    pub fn between(matrix: &nalgebra::DMatrix<f64>, a: usize, b: usize) -> f64 {
        matrix[(a, a)] + matrix[(b, b)] - 2.0 * matrix[(a, b)]
    }
}

/// Rounding: smaller variances between two places are none.
const ROUNDING: f64 = 1e-8;

/// How much better, for each place, the place scores that is better than it by most standard deviations of what is unknown about
/// the two: 0 for the best.
pub fn implausibility(field: &Field, variance: &Variance) -> Vec<f64> {
    let n = field.means.len();
    let worse_by = |place: usize, other: usize| {
        let difference = field.means[place] - field.means[other];
        if difference <= 0.0 {
            return 0.0;
        }
        let all = Variance::between(&variance.all, place, other).max(ROUNDING);
        let recordings = Variance::between(&variance.recordings, place, other);
        // What is known of the sum when one part of it is estimated (Welch 1947; Satterthwaite 1946).
        let share = (recordings / all).clamp(1e-3, 1.0);
        as_normal(difference / all.sqrt(), variance.freedom / (share * share))
    };
    (0..n)
        .map(|place| (0..n).fold(0.0, |most: f64, other| most.max(worse_by(place, other))))
        .collect()
}

/// The normal number as improbable as `t` of Student's distribution (Wallace 1959, section 3).
fn as_normal(t: f64, freedom: f64) -> f64 {
    let correction = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    correction * (freedom * libm::log1p(t * t / freedom)).sqrt()
}

/// Share that the emulator has in what is unknown of the best place and another, mean over the places within a limit.
pub fn emulator_share(
    field: &Field,
    variance: &Variance,
    implausibility: &[f64],
    limit: f64,
) -> f64 {
    let best = field.means.imin();
    let inside = (0..implausibility.len()).filter(|i| *i != best && implausibility[*i] <= limit);
    let shares = inside.map(|place| {
        let all = Variance::between(&variance.all, place, best).max(ROUNDING);
        Variance::between(&field.emulator, place, best) / all
    });
    let shares: Vec<f64> = shares.collect();
    if shares.is_empty() {
        0.0
    } else {
        mean(&shares)
    }
}
