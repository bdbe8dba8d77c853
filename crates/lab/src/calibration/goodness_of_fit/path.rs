//! Path goodness of fit: whether any run comes as near to the recordings as one more recording would. It is history matching of
//! the path itself.
//!
//! The outputs are the whole path and its quarters. Each is rotated to a common heading: an earlier turn moves everything after
//! it, and would hide later deviations. The implausibility of a run is that of its worst output (Vernon, Goldstein & Bower 2010),
//! in units of the differences between recordings and between neighbouring runs. One run that comes near is enough: reality has
//! parameters and a setting of its own, and is as near to a run as runs are to each other.

use std::ops::Range;

use realgap_core::statistics::{fisher_tail, least_by, mean_of};
use realgap_path::trajectory::{POINTS, Prepared, mean_square_m2};

/// A path in the plane, metres.
type Path = Vec<[f64; 2]>;

/// Parts of the path beside the whole.
pub(in crate::calibration) const QUARTERS: usize = 4;
/// Number of runs nearest to the recordings that are examined.
const NEAR: usize = 16;

/// The run that comes nearest to the recordings.
#[derive(Debug, Clone, Copy)]
pub(in crate::calibration) struct Nearest {
    /// Its position in the list of runs.
    pub run: usize,
    /// Probability that one more recording deviates as much in one of the outputs.
    pub p_value: f64,
    /// The quarter with the largest deviation, from 0.
    pub quarter: usize,
    /// Its deviation there, in standard deviations of the differences between recordings and between neighbouring runs.
    pub deviations: f64,
}

/// Spread of paths: total variance, effective number of directions, and degrees of freedom.
#[derive(Debug, Clone, Copy)]
struct Spread {
    variance: f64,
    /// Effective number of directions: the number of directions with equal variances that have the same sum of variances and the
    /// same sum of squared variances.
    directions: f64,
    freedom: f64,
}

impl Spread {
    /// The effective number of directions is the square of the covariance's trace over the trace of its square, both corrected
    /// for the bias of few deviations (Srivastava 2005).
    fn of(deviations: &[Path], freedom: f64) -> Self {
        let pairs = deviations
            .iter()
            .flat_map(|a| deviations.iter().map(move |b| (a, b)));
        let squares: f64 = pairs.map(|(a, b)| (product(a, b) / freedom).powi(2)).sum();
        let variance = deviations.iter().map(|a| product(a, a)).sum::<f64>() / freedom.max(1.0);
        let most = 2.0 * deviations.first().map_or(1, Vec::len) as f64;
        let factor = freedom * freedom / ((freedom - 1.0) * (freedom + 2.0));
        let of_square = factor * (squares - variance * variance / freedom);
        let of_trace = variance * variance - 2.0 * of_square / freedom;
        let directions = match freedom > 1.0 && variance > 0.0 {
            true if of_square > 0.0 => (of_trace / of_square).clamp(1.0, most),
            true => most,
            false => 1.0,
        };
        Self {
            variance,
            directions,
            freedom,
        }
    }

    /// Spread of a sum of two deviations, under the assumption that both have the same directions, which gives the sum the fewest
    /// directions. Degrees of freedom: Welch 1947; Satterthwaite 1946.
    fn with(self, other: Self) -> Self {
        let both = [self, other].into_iter().filter(|s| s.variance > 0.0);
        let over = |of: &dyn Fn(&Self) -> f64| both.clone().map(|spread| of(&spread)).sum::<f64>();
        let variance = over(&|s| s.variance);
        if variance <= 0.0 {
            return self;
        }
        let directions = (variance / over(&|s| s.variance / s.directions.sqrt())).powi(2);
        let denominator = over(&|s| s.variance.powi(2) / (s.directions * s.freedom));
        Self {
            variance,
            directions,
            freedom: variance * variance / denominator / directions,
        }
    }

    fn times(self, factor: f64) -> Self {
        let variance = factor * self.variance;
        Self { variance, ..self }
    }

    fn in_variances(&self, square: f64) -> f64 {
        if square > 0.0 {
            square / self.variance
        } else {
            0.0
        }
    }

    /// Probability of a square of at least this size (Box 1954: as if the variances were equal in the effective number of
    /// directions).
    fn tail(&self, square: f64) -> f64 {
        let second = self.directions * self.freedom;
        fisher_tail(self.in_variances(square), self.directions, second)
    }
}

/// One output, of all recordings and runs.
struct Output {
    recordings: Spread,
    /// Squared distance of each run to the mean recording.
    squares: Vec<f64>,
    runs: Vec<Path>,
}

impl Output {
    fn new(real: &[&Prepared], runs: &[Prepared], points: Range<usize>) -> Self {
        let cut = |path: &Prepared| path.part_xy_m(points.clone());
        let real: Vec<Path> = real.iter().map(|path| cut(path)).collect();
        let runs: Vec<Path> = runs.iter().map(cut).collect();
        let middle = middle(&real.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let off: Vec<Path> = real.iter().map(|path| between(path, &middle)).collect();
        Self {
            recordings: Spread::of(&off, real.len() as f64 - 1.0),
            squares: runs
                .iter()
                .map(|run| mean_square_m2(run, &middle))
                .collect(),
            runs,
        }
    }

    /// Spread of the difference between one more recording and the mean of `count` recordings, with that of neighbouring runs.
    fn uncertainty(&self, count: usize, neighbours: &[(usize, usize)]) -> Spread {
        let difference = |(a, b): &(usize, usize)| between(&self.runs[*a], &self.runs[*b]);
        let differences: Vec<Path> = neighbours.iter().map(difference).collect();
        let more = self.recordings.times(1.0 + 1.0 / count as f64);
        more.with(Spread::of(&differences, differences.len() as f64))
    }
}

/// The mean of some paths, point by point.
pub(in crate::calibration) fn middle(paths: &[&[[f64; 2]]]) -> Path {
    let mean_at = |at: usize, axis: usize| mean_of(paths.iter().map(|path| path[at][axis]));
    let points = 0..paths.first().map_or(0, |path| path.len());
    points
        .map(|at| [0, 1].map(|axis| mean_at(at, axis)))
        .collect()
}

fn between(a: &[[f64; 2]], b: &[[f64; 2]]) -> Path {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect()
}

fn product(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let products = a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]);
    products.sum::<f64>() / a.len() as f64
}

impl Nearest {
    /// The nearest of all runs of a study, at any of its points, to at least three recordings; `None` without a run.
    pub fn new(real: &[&Prepared], runs: &[Prepared]) -> Option<Self> {
        let quarter = |at: usize| at * POINTS / QUARTERS..(at + 1) * POINTS / QUARTERS;
        let ranges = std::iter::once(0..POINTS).chain((0..QUARTERS).map(quarter));
        let outputs: Vec<Output> = ranges
            .map(|points| Output::new(real, runs, points))
            .collect();
        let worst = |of: &dyn Fn(&Output) -> f64| {
            let all = outputs.iter().map(|o| o.recordings.in_variances(of(o)));
            all.fold(0.0, f64::max)
        };
        let mut order: Vec<(usize, f64)> = (0..runs.len())
            .map(|run| (run, worst(&|o| o.squares[run])))
            .collect();
        order.sort_by(|a, b| a.1.total_cmp(&b.1));
        order.truncate(NEAR);
        let neighbours = order.iter().filter_map(|&(run, _)| {
            let others = (0..runs.len()).filter(|other| *other != run);
            let distance =
                |other: &usize| worst(&|o| mean_square_m2(&o.runs[run], &o.runs[*other]));
            Some((run, least_by(others, distance)?))
        });
        let neighbours: Vec<(usize, usize)> = neighbours.collect();
        let unknown = outputs
            .iter()
            .map(|o| o.uncertainty(real.len(), &neighbours));
        let unknown: Vec<Spread> = unknown.collect();
        let seen = order.iter().map(|&(run, _)| {
            let both = || unknown.iter().zip(&outputs);
            let tails = both().map(|(unknown, o)| unknown.tail(o.squares[run]));
            let least = tails.fold(1.0, f64::min);
            let off = both().map(|(unknown, o)| unknown.in_variances(o.squares[run]));
            let off: Vec<f64> = off.collect();
            let quarter = (0..QUARTERS).max_by(|a, b| off[a + 1].total_cmp(&off[b + 1]));
            let quarter = quarter.unwrap_or(0);
            Self {
                run,
                // The worst output is the largest of several, so the probability is corrected (Bonferroni).
                p_value: (least * outputs.len() as f64).min(1.0),
                quarter,
                deviations: off[quarter + 1].sqrt(),
            }
        });
        seen.max_by(|a, b| {
            let order = a.p_value.total_cmp(&b.p_value);
            order.then(b.deviations.total_cmp(&a.deviations))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    /// A path of 1 m that bends in a few directions, each by a normal random number; a camera records it with the noise
    /// `camera_m`.
    fn path(bends: &[f64], camera_m: f64, rng: &mut Generator) -> Prepared {
        let point = |at: usize| {
            let share = at as f64 / (POINTS - 1) as f64;
            let waver = bends.iter().enumerate();
            let waver: f64 = waver
                .map(|(k, bend)| bend * libm::sin(std::f64::consts::PI * (k + 1) as f64 * share))
                .sum();
            [share, waver]
        };
        let mut see = |m: f64| -> f64 {
            let normal: f64 = StandardNormal.sample(rng);
            m + camera_m * normal
        };
        let seen: Path = (0..POINTS).map(|at| point(at).map(&mut see)).collect();
        Prepared::from_xy_m(realgap_path::trajectory::turned(&seen)).unwrap()
    }

    /// Number of 200 realities that no run comes near to: settings bend the path by 1 cm in so many directions, repeats by
    /// `repeat` cm, and reality lies `off` cm beyond them.
    fn unexplained(directions: usize, recordings: usize, repeat: f64, off: f64) -> usize {
        let mut rng = Generator::seed_from_u64(7);
        let normals = |rng: &mut Generator, centre: &[f64], size: f64| -> Vec<f64> {
            let normal = |rng: &mut _| -> f64 { StandardNormal.sample(rng) };
            centre.iter().map(|c| c + size * normal(rng)).collect()
        };
        let alarm = |_: &usize| {
            let mut centre = vec![0.0; directions];
            let setting = |rng: &mut Generator, centre: &[f64]| normals(rng, centre, 0.01);
            let runs: Vec<Prepared> = (0..60)
                .map(|_| {
                    let own = setting(&mut rng, &centre);
                    let own = normals(&mut rng, &own, 0.01 * repeat);
                    path(&own, 0.0, &mut rng)
                })
                .collect();
            centre[directions - 1] = 0.01 * off;
            let own = setting(&mut rng, &centre);
            let real: Vec<Prepared> = (0..recordings)
                .map(|_| {
                    let own = normals(&mut rng, &own, 0.01 * repeat);
                    path(&own, 0.001, &mut rng)
                })
                .collect();
            let real: Vec<&Prepared> = real.iter().collect();
            Nearest::new(&real, &runs).unwrap().p_value < 0.05
        };
        (0..200).filter(alarm).count()
    }

    /// At one false alarm in twenty, more than 17 of 200 occur with a probability of 2 %.
    #[test]
    fn a_reality_that_is_one_of_the_settings_has_a_run_near_it_however_much_its_recordings_differ()
    {
        for (directions, recordings) in [(1, 3), (4, 3), (4, 10)] {
            for repeat in [0.1, 0.3, 1.0] {
                let alarms = unexplained(directions, recordings, repeat, 0.0);
                assert!(alarms <= 17, "{directions} {recordings} {repeat}: {alarms}");
            }
        }
    }

    #[test]
    fn a_reality_that_no_setting_comes_near_has_no_run_near_it() {
        for (directions, recordings, repeat) in
            [(1, 3, 0.1), (2, 5, 0.3), (4, 5, 0.3), (4, 10, 0.3)]
        {
            let found = unexplained(directions, recordings, repeat, 8.0);
            assert!(found >= 190, "{directions} {recordings} {repeat}: {found}");
        }
    }

    #[test]
    fn no_run_and_recordings_that_are_all_the_same_are_no_accident() {
        let mut rng = Generator::seed_from_u64(1);
        let (same, other) = (path(&[0.0], 0.0, &mut rng), path(&[0.1], 0.0, &mut rng));
        let real = [&same, &same, &same];
        assert!(Nearest::new(&real, &[]).is_none());
        let nearest = |runs: &[Prepared]| Nearest::new(&real, runs).unwrap();
        assert_eq!(nearest(std::slice::from_ref(&other)).p_value, 0.0);
        let found = nearest(&[other, same.clone()]);
        assert_eq!((found.run, found.p_value), (1, 1.0));
    }
}
