//! Which runs an emulator is made from: the work grows with the cube of their number.

use crate::scored_run::ScoredRun;
use realgap_optimization::thin;

/// At most `most` of the runs, with each variant's share: the better half of them, and others spread evenly over the rest.
pub(crate) fn better_half(runs: &[ScoredRun], most: usize) -> Vec<&ScoredRun> {
    by_variant(runs, most, |own, share| {
        let scored = own.into_iter().map(|run| (run, run.score()));
        let kept = thin(scored.collect(), share).into_iter();
        kept.map(|(run, _)| run).collect()
    })
}

/// At most `most` of the runs, with each variant's share, spread over the search space: every next run is the one that is farthest
/// from those chosen before it (Gonzalez 1985). A crowd of runs in one place adds few of them.
pub(crate) fn spread(runs: &[ScoredRun], most: usize) -> Vec<&ScoredRun> {
    by_variant(runs, most, |own, share| {
        let square = |a: &ScoredRun, b: &ScoredRun| -> f64 {
            let axes = a.point.iter().zip(&b.point);
            axes.map(|(a, b)| (a - b) * (a - b)).sum()
        };
        let mut chosen: Vec<&ScoredRun> = own.first().copied().into_iter().collect();
        let mut distances: Vec<f64> = vec![f64::INFINITY; own.len()];
        while let Some(last) = chosen.last().filter(|_| chosen.len() < share) {
            let mut farthest = 0;
            for (index, run) in own.iter().enumerate() {
                distances[index] = distances[index].min(square(run, last));
                if distances[index] > distances[farthest] {
                    farthest = index;
                }
            }
            if distances[farthest] <= 0.0 {
                break;
            }
            chosen.push(own[farthest]);
        }
        chosen
    })
}

/// The runs that `choose` takes from each variant's runs; it is given how many these may be.
fn by_variant<'a>(
    runs: &'a [ScoredRun],
    most: usize,
    choose: impl Fn(Vec<&'a ScoredRun>, usize) -> Vec<&'a ScoredRun>,
) -> Vec<&'a ScoredRun> {
    let of = |is_second: bool| {
        let own = runs.iter().filter(|run| (run.variant < 0.0) == is_second);
        let own: Vec<&ScoredRun> = own.collect();
        let share = (most * own.len()).div_ceil(runs.len());
        choose(own, share)
    };
    of(false).into_iter().chain(of(true)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crowd_of_runs_in_one_place_adds_few_to_those_that_are_spread() {
        let run = |at: f64| ScoredRun {
            point: vec![at],
            setting: 0,
            variant: 0.0,
            scores: vec![at],
            surrogate_scores: Vec::new(),
        };
        let even = (0..11).map(|step| run(f64::from(step) / 10.0));
        let crowd = (0..100).map(|step| run(0.43 + 1e-4 * f64::from(step)));
        let runs: Vec<ScoredRun> = even.chain(crowd).collect();
        let chosen = spread(&runs, 12);
        assert_eq!(chosen.len(), 12);
        let near = chosen
            .iter()
            .filter(|run| (0.41..0.46).contains(&run.point[0]));
        assert_eq!(near.count(), 1);
        // Repeats at one point are not chosen twice.
        let same: Vec<ScoredRun> = (0..5).map(|_| run(0.5)).collect();
        assert_eq!(spread(&same, 3).len(), 1);
    }
}
