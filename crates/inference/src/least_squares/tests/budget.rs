//! Fits whose budget is small: what they do not know they say.

use rand::RngExt;

use super::*;

/// Step of the simulations, seconds; that of the recordings is the same, so that nothing but the budget is short.
const STEP_S: f64 = 2e-3;
const SAMPLES: usize = 150;
const SAMPLE_S: f64 = 0.02;

/// The first speed, the acceleration for each unit of place and of speed, and the deceleration by dry friction.
type Motion = (f64, [f64; 2], f64);

/// A world of one coordinate, of which two runs are recorded.
struct World {
    ranges: [(&'static str, f64, f64); 3],
    own: [f64; 3],
    truths: [(f64, f64); 3],
    first_m: (f64, f64),
    noise_m: f64,
    motion: fn(&[f64]) -> Motion,
}

/// A mass on a spring, with viscous and dry friction: at the wrong minimum one does the work of the other.
const SPRING: World = World {
    ranges: [
        ("stiffness", 10.0, 80.0),
        ("damping", 0.0, 2.0),
        ("dry", 0.0, 1.0),
    ],
    own: [30.0, 0.3, 0.2],
    truths: [(20.0, 60.0), (0.1, 1.0), (0.05, 0.5)],
    first_m: (0.1, 0.3),
    noise_m: 0.0005,
    motion: |values| (0.0, [-values[0], -values[1]], values[2]),
};

/// A block that is launched and slides until friction and drag have stopped it.
const BLOCK: World = World {
    ranges: [
        ("launch", 0.5, 4.0),
        ("friction", 0.0, 0.6),
        ("drag", 0.0, 2.0),
    ],
    own: [2.0, 0.2, 0.2],
    truths: [(1.0, 3.0), (0.05, 0.4), (0.1, 1.0)],
    first_m: (0.0, 0.0),
    noise_m: 0.001,
    motion: |values| (values[0], [0.0, -values[2]], 9.81 * values[1]),
};

impl World {
    fn run(&self, values: &[f64], first_m: f64) -> Vec<f64> {
        let (mut speed, [stiff, damp], dry) = (self.motion)(values);
        let mut place = first_m;
        let each = (SAMPLE_S / STEP_S).round() as usize;
        let mut seen = vec![place];
        for step in 1..=(SAMPLES - 1) * each {
            speed += STEP_S * (stiff * place + damp * speed);
            speed = speed.signum() * (speed.abs() - STEP_S * dry).max(0.0);
            place += STEP_S * speed;
            if step % each == 0 {
                seen.push(place);
            }
        }
        seen
    }
}

/// A fit of a world with hidden values, from two noisy recordings whose first samples are the starts of its runs.
fn fit(
    world: &World,
    seed: u64,
    budget: usize,
) -> (Vec<f64>, Vec<LeastSquaresEstimate>, Agreement) {
    let grid = grid(&world.ranges);
    let mut random = Generator::seed_from_u64(seed);
    let mut between = |(from, to): (f64, f64)| from + (to - from) * random.random::<f64>();
    let truth: Vec<f64> = world.truths.iter().map(|ends| between(*ends)).collect();
    let firsts = [between(world.first_m), between(world.first_m)];
    let mut noise = || -> f64 {
        let normal: f64 = StandardNormal.sample(&mut random);
        world.noise_m * normal
    };
    let logs = firsts.map(|first| {
        let run = world.run(&truth, first).into_iter();
        run.map(|place| place + noise()).collect::<Vec<f64>>()
    });
    let recorded = logs.concat();
    let from = |starts: [f64; 2], values: &[f64]| -> Vec<f64> {
        starts
            .iter()
            .flat_map(|start| world.run(values, *start))
            .collect()
    };
    let starts = logs.each_ref().map(|log| log[0]);
    let other_starts: Vec<[f64; 2]> = (0..6)
        .map(|_| starts.map(|start| start + noise()))
        .collect();
    let with_starts = |posterior: LeastSquaresPosterior| {
        let best = grid.values_at(posterior.best());
        let others = other_starts.iter().map(|starts| {
            let runs = from(*starts, &best).into_iter().zip(&recorded);
            runs.map(|(run, real)| run - real).collect::<Vec<f64>>()
        });
        posterior.with_variants(&others.collect::<Vec<_>>())
    };
    let blocks = (0..2).map(|log| ErrorBlock {
        channel: 0,
        log,
        count: SAMPLES,
        resolution: 0.0,
    });
    let own = world.own.iter().zip(grid.ranges());
    let own: UnitPoint = own.map(|(value, range)| range.coordinate(*value)).collect();
    let (estimates, agreement) = fitted_from(
        &grid,
        &|values| from(starts, values),
        &recorded,
        (blocks.collect(), Some(own)),
        (budget, &with_starts),
    );
    (truth, estimates, agreement)
}

#[test]
fn whatever_the_budget_no_narrow_interval_is_wrong_without_a_word() {
    let mut doubted = 0;
    for budget in [20, 40, 100, 300] {
        let (mut told, mut all) = (0, 0);
        for (world, seed) in [&SPRING, &BLOCK]
            .into_iter()
            .flat_map(|w| (5015..5027).map(move |s| (w, s)))
        {
            let (truth, estimates, agreement) = fit(world, seed, budget);
            let says_more =
                !agreement.has_converged() || !agreement.holds() || agreement.is_systematic();
            let far = estimates.iter().zip(&truth).filter(|(known, truth)| {
                let outside = (known.low - *truth).max(*truth - known.high);
                outside > 2.0 * (known.high - known.low)
            });
            let is_far = far.count() > 0;
            assert!(
                says_more || !is_far,
                "{budget}, {seed}: {truth:?} {estimates:#?} {agreement:?}"
            );
            doubted += usize::from(is_far && !agreement.has_converged());
            told += estimates.iter().filter(|known| known.is_told).count();
            all += estimates.len();
        }
        // A program that always doubts would pass, too.
        println!("{budget}: {told} of {all} determined, {doubted} wrong minima seen so far");
        assert!(2 * told > all, "{budget}: {told} of {all}");
    }
    assert!(
        doubted > 0,
        "no wrong minimum was seen, so that nothing was tested"
    );
}
