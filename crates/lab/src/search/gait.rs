//! Gait tuning: the gait of every body is tuned by short runs before the body is judged.
//!
//! A random body has a random gait, and a good body with a bad gait is lost. So bodies and gaits are searched on two levels.
//! (Sims 1994 searched them on one level; Cheney et al. 2018, "Scalable co-optimization of morphology and control in embodied
//! machines", J. R. Soc. Interface 15, explain why that fails.) The tuned gait is part of the genome, so that children inherit
//! it.

use serde::{Deserialize, Serialize};

use super::{Failure, Measure, Objective, Reason, Search};
use realgap_core::Result;
use realgap_core::range::Range;
use realgap_optimization::{
    EvaluatedPoint, History, OptimizationProblem, Proposal, RunOptions, UnitPoint,
    default_optimizer, space_filling,
};
use realgap_robot::genome::{Gene, Genome, Locus};
use realgap_simulation::LONGEST_S;

/// How the gait of every body is tuned before the body is judged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct GaitTuning {
    /// Short runs of every body, in the engine that explores.
    pub runs: usize,
    /// Length of each, seconds.
    pub duration_s: f64,
    /// Seconds of each that do not count.
    pub from_s: f64,
    /// A body whose best gait has an expected fitness below this, in the unit of the objective's measure, is not judged.
    pub least: f64,
}

impl Default for GaitTuning {
    /// A few dozen runs, long enough for a few steps of a slow gait.
    fn default() -> Self {
        Self {
            runs: 40,
            duration_s: 6.0,
            from_s: 1.0,
            least: 0.05,
        }
    }
}

impl GaitTuning {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self) -> Result<()> {
        Range::within(1.0, 100_000.0, "").check(self.runs as f64, "runs")?;
        Range::within(0.01, LONGEST_S, "s").check(self.duration_s, "duration_s")?;
        Range::within(0.0, 0.9 * self.duration_s, "s").check(self.from_s, "from_s")?;
        Range::within(0.0, 1e6, "").check(self.least, "least")
    }

    /// Gaits that are drawn before the optimizer starts at the best of them.
    fn draws(&self) -> usize {
        self.runs / 5
    }
}

/// Numbers that each module with a servo has of its own. All modules share one frequency, so that a gait is periodic.
const OWN: [Locus; 3] = [Locus::Amplitude, Locus::Phase, Locus::Offset];

impl Search {
    /// The genome with the best gait that short runs find for its body, or the reason why the body is not worth judging.
    pub(super) fn tuned(
        &self,
        tuning: &GaitTuning,
        index: usize,
        genome: &Genome,
        run: &RunOptions<'_>,
    ) -> Result<std::result::Result<Genome, Failure>> {
        let driven = match self.body().build(&self.robot_name(index), genome) {
            Ok(robot) => super::body::driven(&robot),
            Err(misfit) => return Ok(Err(Failure::new(Reason::DoesNotDevelop, misfit))),
        };
        if driven.is_empty() {
            return Ok(Err(Failure::new(Reason::GoesNowhere, "no servo")));
        }
        let seed = self.seed().wrapping_add(index as u64);
        let mut first_failure = None;
        let mut best_score = f64::INFINITY;
        let mut promise = |point: &UnitPoint| -> Result<EvaluatedPoint> {
            run.go_on()?;
            let genome = with_gait(genome, &driven, point)?;
            let mut promised = self.promise(tuning, index, &genome)?;
            // Stability is checked only for gaits that may be the best, because the check costs as much as half of a short run.
            if promised.as_ref().is_ok_and(|p| -p < best_score)
                && let Err(failure) = self.build(index, &genome)?
            {
                promised = Err(failure);
            }
            let score = match promised {
                Ok(promised) => {
                    best_score = best_score.min(-promised);
                    Some(-promised)
                }
                Err(failure) => {
                    first_failure.get_or_insert(failure);
                    None
                }
            };
            Ok(EvaluatedPoint {
                point: point.clone(),
                score,
                errors: Vec::new(),
            })
        };
        let mut design = vec![promise(&gait_of(genome, &driven))?];
        for point in space_filling(design[0].point.len(), 0, tuning.draws(), seed) {
            design.push(promise(&point)?);
        }
        let brief = OptimizationProblem {
            points: vec![1; design[0].point.len()],
            budget: tuning.runs,
            seed,
            priors: Vec::new(),
            error_blocks: Vec::new(),
            own: None,
        };
        let mut told: Vec<EvaluatedPoint> = Vec::new();
        let can_walk = design.iter().any(|told| told.score.is_some());
        while can_walk && design.len() + told.len() < tuning.runs {
            let history = History {
                design: &design,
                evaluated: &told,
            };
            let Proposal::Evaluate(points) = default_optimizer().propose(&brief, &history)? else {
                break;
            };
            let left = tuning.runs - design.len() - told.len();
            for point in points.iter().take(left) {
                told.push(promise(point)?);
            }
        }
        let scored = design.iter().chain(&told);
        let scored = scored.filter_map(|told| Some((told.score?, &told.point)));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(match (best, first_failure) {
            (Some((score, _)), _) if -score < tuning.least => {
                let unit = self.objective.measure.unit().label();
                let seen = format!("its best gait promises {:.3} {unit}", -score);
                Err(Failure::new(Reason::GoesNowhere, seen))
            }
            (Some((_, point)), _) => Ok(with_gait(genome, &driven, point)?),
            (None, Some(failure)) => Err(failure),
            (None, None) => Err(Failure::new(Reason::GoesNowhere, "no gait was tried")),
        })
    }

    /// The expected fitness of a whole run from one short run, in the unit of the objective's measure.
    fn promise(
        &self,
        tuning: &GaitTuning,
        index: usize,
        genome: &Genome,
    ) -> Result<std::result::Result<f64, Failure>> {
        let robot = match self.unblocked(index, genome) {
            Ok(robot) => robot,
            Err(failure) => return Ok(Err(failure)),
        };
        let short = Objective {
            from_s: tuning.from_s,
            last_quarters: None,
            ..self.objective
        };
        let mut base = self.exploring(&robot);
        base.duration_s = tuning.duration_s;
        // Coarse steps rank gaits as well as fine ones; a robot that depends on them is found out when it is judged.
        base.solver.timestep_s *= 2.0;
        // The draws are used neither for judging nor in the finals. Every robot has others, so that a robot that is tuned again
        // is not fitted to one draw.
        let seed = self.seed().wrapping_add(1 << 33);
        let travel = match self.observe(&self.repeat(&base, seed, index as u64)?, &short)? {
            Ok(travel) => travel,
            Err(failure) => return Ok(Err(failure)),
        };
        let counted_s = tuning.duration_s - tuning.from_s;
        Ok(Ok(match self.objective.measure {
            Measure::Displacement => {
                let turned_rad = travel.turned_rad * counted_s / tuning.duration_s;
                let times = (self.duration_s - self.objective.from_s) / counted_s;
                chord_m(travel.displacement_m, turned_rad, times)
            }
            other => other.of(&travel, self.body().length_m(), counted_s),
        }))
    }
}

/// Displacement after so many times an arc with this chord and this turn: a robot that turns comes back.
fn chord_m(chord_m: f64, turned_rad: f64, times: f64) -> f64 {
    use std::f64::consts::FRAC_PI_2;
    let half_rad = 0.5 * turned_rad.abs();
    if half_rad < 1e-6 {
        return chord_m * times;
    }
    if half_rad >= FRAC_PI_2 {
        return chord_m;
    }
    chord_m * (half_rad * times).min(FRAC_PI_2).sin() / half_rad.sin()
}

/// The frequency of the first module with a servo, and the numbers that every module has of its own.
fn gait_of(genome: &Genome, driven: &[usize]) -> UnitPoint {
    let genes = genome.genes();
    let first = genes[driven[0]].get(Locus::Frequency);
    let own = driven
        .iter()
        .flat_map(|&module| OWN.map(|locus| genes[module].get(locus)));
    std::iter::once(first).chain(own).collect()
}

fn with_gait(genome: &Genome, driven: &[usize], point: &[f64]) -> Result<Genome> {
    let mut genes: Vec<[f64; Gene::LEN]> = genome.genes().iter().map(|g| *g.values()).collect();
    for (&module, own) in driven.iter().zip(point[1..].chunks(OWN.len())) {
        genes[module][Locus::Frequency.index()] = point[0];
        for (locus, value) in OWN.into_iter().zip(own) {
            genes[module][locus.index()] = *value;
        }
    }
    Genome::new(genes.into_iter().map(Gene::clamped).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_walks_an_arc_is_promised_the_chord_of_the_longer_arc() {
        let (radius_m, turned_rad) = (0.7, 0.4_f64);
        let chord = |turned_rad: f64| 2.0 * radius_m * (0.5 * turned_rad).sin();
        for times in [1.0, 3.0, 5.0] {
            let promised = chord_m(chord(turned_rad), -turned_rad, times);
            assert!(
                (promised - chord(turned_rad * times)).abs() < 1e-12,
                "{times}"
            );
        }
        // Straight on, and in a circle: never farther than the diameter of the circle.
        assert!((chord_m(0.3, 0.0, 5.0) - 1.5).abs() < 1e-12);
        assert!((chord_m(chord(turned_rad), turned_rad, 50.0) - 2.0 * radius_m).abs() < 1e-12);
    }

    #[test]
    fn a_gait_goes_into_a_genome_and_comes_back_and_leaves_the_body() {
        let genome = Genome::new(vec![Gene::clamped([0.3; Gene::LEN]); 3]).unwrap();
        let point = vec![0.9, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7];
        let changed = with_gait(&genome, &[0, 2], &point).unwrap();
        assert_eq!(gait_of(&changed, &[0, 2]), point);
        assert_eq!(changed.genes()[1], genome.genes()[1]);
        for (gene, before) in changed.genes().iter().zip(genome.genes()) {
            for locus in Locus::ALL.into_iter().filter(|locus| locus.is_body()) {
                assert_eq!(gene.get(locus), before.get(locus));
            }
        }
    }
}
