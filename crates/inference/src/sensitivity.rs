//! What a small change of each input does to the output of a black box: one input at a time around a point.

use serde::Serialize;

/// One parameter, made a little smaller and a little larger.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Effect {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value at the point.
    pub value: f64,
    /// The smaller value; `None` at its lower bound.
    pub lower: Option<f64>,
    /// Score there minus the point's; `None` where it diverged or cannot be simulated.
    pub lower_change: Option<f64>,
    /// The larger value; `None` at its upper bound.
    pub higher: Option<f64>,
    /// Score there minus the point's.
    pub higher_change: Option<f64>,
}

impl Effect {
    /// Larger of the two changes without their signs; 0 where neither is known.
    pub fn size(&self) -> f64 {
        let changes = [self.lower_change, self.higher_change];
        changes
            .iter()
            .flatten()
            .fold(0.0, |size: f64, change| size.max(change.abs()))
    }
}

/// A parameter at its value, with the values next to it that a one-at-a-time analysis tries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perturbation {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value at the point.
    pub value: f64,
    /// A smaller and a larger value; `None` at a bound.
    pub tried: [Option<f64>; 2],
}

/// The evaluations of a one-at-a-time analysis, in order: number of the changed parameter and its value. The point itself, which
/// comes before all of them, is not listed.
pub fn evaluations(perturbations: &[Perturbation]) -> Vec<(usize, f64)> {
    let all = perturbations.iter().enumerate();
    all.flat_map(|(number, one)| one.tried.into_iter().flatten().map(move |v| (number, v)))
        .collect()
}

/// The effects of all perturbations, largest first. `at_point` is the score of the point itself, `scores` are those of
/// [`evaluations`] in their order; `None` where an evaluation failed.
pub fn effects(
    perturbations: &[Perturbation],
    at_point: f64,
    scores: &[Option<f64>],
) -> Vec<Effect> {
    let mut next = scores.iter();
    let mut effects: Vec<Effect> = perturbations
        .iter()
        .map(|one| {
            let mut change = |tried: &Option<f64>| {
                tried
                    .and_then(|_| next.next().copied().flatten())
                    .map(|score| score - at_point)
            };
            let [lower, higher] = one.tried;
            Effect {
                parameter: one.parameter,
                unit: one.unit,
                value: one.value,
                lower,
                lower_change: change(&lower),
                higher,
                higher_change: change(&higher),
            }
        })
        .collect();
    effects.sort_by(|a, b| b.size().total_cmp(&a.size()));
    effects
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_effects_of_a_black_box_come_largest_first_and_a_failed_evaluation_has_none() {
        let at = |parameter, value, tried| Perturbation {
            parameter,
            unit: "1",
            value,
            tried,
        };
        let all = [
            at("slow", 1.0, [Some(0.9), Some(1.1)]),
            at("steep", 2.0, [None, Some(2.5)]),
        ];
        let score = |point: [f64; 2]| (point[0] < 1.05).then(|| point[0] + 10.0 * point[1]);
        let scores: Vec<Option<f64>> = evaluations(&all)
            .into_iter()
            .map(|(number, value)| {
                let mut point = [1.0, 2.0];
                point[number] = value;
                score(point)
            })
            .collect();
        let effects = effects(&all, 21.0, &scores);
        let names: Vec<&str> = effects.iter().map(|effect| effect.parameter).collect();
        assert_eq!(names, ["steep", "slow"]);
        assert_eq!(
            (effects[0].lower_change, effects[0].higher_change),
            (None, Some(5.0))
        );
        assert!(effects[1].higher_change.is_none());
        assert!((effects[1].size() - 0.1).abs() < 1e-12);
    }
}
