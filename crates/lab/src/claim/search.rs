//! The verdict on a search: the best robot, and whether it depends on how the simulation is computed.

use super::headline::cannot;
use super::{About, Claim, Conclusion};
use realgap_core::unit::{Unit, quantity};

/// The best robot of a search, as its verdict needs it.
#[derive(Debug, Clone, Copy)]
pub struct BestOfSearch<'a> {
    /// Its name.
    pub robot: &'a str,
    /// Its fitness on fresh seeds; `None` where a repeat diverged.
    pub fitness: Option<f64>,
    /// Unit of the fitness.
    pub unit: Unit,
    /// What was made large.
    pub objective: &'a str,
    /// Whether it walks the same under other numerics.
    pub survives: bool,
    /// How many finalists do so, and of how many.
    pub survivors: (usize, usize),
    /// Fitness of the robot that the search started from on the same seeds, where there is one.
    pub baseline: Option<f64>,
}

/// The best robot, and whether to trust it; `None` where no robot was judged again.
pub fn search(best: Option<BestOfSearch<'_>>, complete: bool) -> Vec<Claim> {
    let Some(best) = best else {
        let why = match complete {
            true => "no robot could be judged again; see what failed",
            false => "the search is unfinished; finish it",
        };
        let (says, word, text) = cannot(why);
        return vec![Claim::new(About::Trust, says, word, text)];
    };
    let beaten = match (best.baseline, best.fitness) {
        (Some(base), Some(own)) => format!(
            "; the robot that the search started from scores {} and was {}",
            quantity(base, best.unit),
            if own > base { "beaten" } else { "not beaten" }
        ),
        _ => String::new(),
    };
    let scored = match best.fitness {
        Some(fitness) => format!("scores {} on fresh seeds", quantity(fitness, best.unit)),
        None => "has no score on fresh seeds, because a repeat diverged".to_owned(),
    };
    let text = format!(
        "The best robot, {}, {scored} ({}){beaten}.",
        best.robot, best.objective
    );
    let says = match best.baseline.zip(best.fitness) {
        Some((base, own)) if own <= base => Conclusion::Rejected,
        _ => Conclusion::Supported,
    };
    let (survivors, finalists) = best.survivors;
    let numbers = [
        ("fitness", best.fitness.unwrap_or(f64::NAN)),
        ("baseline", best.baseline.unwrap_or(f64::NAN)),
    ];
    let winner = Claim::new(About::Winner, says, best.robot, text)
        .of(best.robot)
        .resting_on(finalists, &numbers);
    let (says, word, text) = match best.survives {
        true => (
            Conclusion::Supported,
            "holds under other numerics, not yet tested on a real robot",
            format!(
                "It walks the same under other numerics ({survivors} of {finalists} finalists do); whether a real one does is not yet tested: build it and record it."
            ),
        ),
        false => (
            Conclusion::Rejected,
            "depends on numerics",
            format!(
                "It does NOT walk the same under other numerics ({survivors} of {finalists} finalists do), so do not build it."
            ),
        ),
    };
    let numbers = [("survivors", survivors as f64)];
    let trust = Claim::new(About::Trust, says, word, text).resting_on(finalists, &numbers);
    vec![winner, trust]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best() -> BestOfSearch<'static> {
        BestOfSearch {
            robot: "01_robot",
            fitness: Some(0.214),
            unit: Unit::Metre,
            objective: "net displacement",
            survives: true,
            survivors: (3, 5),
            baseline: Some(0.3),
        }
    }

    #[test]
    fn a_search_that_beats_nothing_says_so_beside_its_best() {
        let [winner, trust] = search(Some(best()), true).try_into().unwrap();
        assert!(winner.text.contains("21.4 cm on fresh seeds"), "{winner}");
        assert!(winner.text.contains("not beaten"), "{winner}");
        assert_eq!(winner.conclusion, Conclusion::Rejected);
        assert_eq!(trust.conclusion, Conclusion::Supported);
    }

    #[test]
    fn a_robot_that_other_numerics_stop_is_not_to_be_built() {
        let failing = BestOfSearch {
            survives: false,
            ..best()
        };
        let trust = search(Some(failing), true).pop().unwrap();
        assert_eq!(trust.word, "depends on numerics");
        assert_eq!(search(None, false)[0].word, "cannot be told");
    }
}
