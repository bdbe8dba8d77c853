//! The contract of every operator, selection and strategy: children are valid, and strategies are pure functions of the history.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use proptest::prelude::*;
use realgap_core::file::Source;
use realgap_lab::search::{
    Archive, Axis, Evaluated, Evolution, MapElites, OPERATORS, Overrides, SELECTIONS, STRATEGIES,
    Search, Strategy, Variation, VariationParams, generator, operator_named, selection_named,
};
use realgap_robot::genome::{Genome, Locus};

fn parent(modules: usize, seed: u64) -> Genome {
    Genome::random(modules, &mut generator(seed, 0)).unwrap()
}

fn params(rate: f64, standard_deviation: f64) -> VariationParams {
    VariationParams {
        rate,
        standard_deviation,
        max_modules: 6,
    }
}

proptest! {
    #[test]
    fn children_are_genomes_within_bounds_and_the_same_for_the_same_seed(
        seed in any::<u64>(), a in 1..=6_usize, b in 1..=6_usize, rate in 0.0..=1.0_f64, sd in 0.0..=1.0_f64,
    ) {
        let (first, second) = (parent(a, seed), parent(b, seed ^ 1));
        for operator in OPERATORS {
            let child = |seed| operator.vary(&first, &second, &params(rate, sd), &mut generator(seed, 1));
            let born = child(seed);
            prop_assert!((1..=6).contains(&born.len()), "{}: {} modules", operator.name(), born.len());
            for value in born.genes().iter().flat_map(|gene| gene.values()) {
                prop_assert!((0.0..=1.0).contains(value), "{}: {}", operator.name(), value);
            }
            prop_assert_eq!(&born, &child(seed), "{} is not repeatable", operator.name());
        }
    }

    #[test]
    fn at_rate_0_the_child_equals_the_first_parent(seed in any::<u64>(), a in 1..=6_usize, b in 1..=6_usize) {
        let (first, second) = (parent(a, seed), parent(b, seed ^ 1));
        for operator in OPERATORS {
            let child = operator.vary(&first, &second, &params(0.0, 0.5), &mut generator(seed, 1));
            prop_assert_eq!(&child, &first, "{}", operator.name());
        }
    }

    #[test]
    fn a_selection_picks_a_valid_index_and_the_same_for_the_same_seed(
        fitness in prop::collection::vec(prop_oneof![any::<f64>(), Just(f64::NAN), Just(f64::NEG_INFINITY)], 1..20),
        seed in any::<u64>(),
    ) {
        for selection in SELECTIONS {
            let pick = || selection.pick(&fitness, &mut generator(seed, 0));
            prop_assert!(pick() < fitness.len());
            prop_assert_eq!(pick(), pick());
        }
    }
}

#[test]
fn at_rate_1_every_operator_changes_something() {
    let (first, second) = (parent(3, 1), parent(4, 2));
    for operator in OPERATORS {
        let changed = (0..20)
            .filter(|&seed| {
                let mut rng = generator(seed, 0);
                operator.vary(&first, &second, &params(1.0, 0.3), &mut rng) != first
            })
            .count();
        assert!(changed >= 10, "{}: {changed} of 20", operator.name());
    }
}

#[test]
fn gaussian_mutation_has_the_stated_rate_and_standard_deviation() {
    let first = parent(5, 3);
    let operator = operator_named("gaussian").unwrap();
    let (mut changed, mut squares) = (0_u32, 0.0);
    for seed in 0..400 {
        let child = operator.vary(&first, &first, &params(0.2, 0.01), &mut generator(seed, 0));
        for (a, b) in first.genes().iter().zip(child.genes()) {
            // Only values away from the ends of the range are counted, because near an end a change is folded back.
            for locus in Locus::ALL {
                let (a, b) = (a.get(locus), b.get(locus));
                if (0.1..0.9).contains(&a) {
                    changed += u32::from(a != b);
                    squares += (a - b).powi(2);
                }
            }
        }
    }
    let numbers = first
        .genes()
        .iter()
        .flat_map(|g| g.values())
        .filter(|v| (0.1..0.9).contains(*v))
        .count() as f64
        * 400.0;
    let rate = f64::from(changed) / numbers;
    // Five standard errors of a share of about 16 000 draws.
    assert!((rate - 0.2).abs() < 0.016, "{rate}");
    let sd = (squares / f64::from(changed)).sqrt();
    assert!((sd - 0.01).abs() < 0.001, "{sd}");
}

#[test]
fn selections_pick_each_rank_with_its_stated_probability() {
    // The best robot, a middle one and a failure. Probabilities of a tournament of two of three: 5/9, 3/9, 1/9; of linear rank:
    // 3/6, 2/6, 1/6.
    let fitness = [2.0, 1.0, f64::NEG_INFINITY];
    for (name, expected) in [
        ("tournament", [5.0 / 9.0, 3.0 / 9.0, 1.0 / 9.0]),
        ("rank", [0.5, 1.0 / 3.0, 1.0 / 6.0]),
    ] {
        let selection = selection_named(name).unwrap();
        let mut rng = generator(7, 0);
        let mut counts = [0.0_f64; 3];
        for _ in 0..20_000 {
            counts[selection.pick(&fitness, &mut rng)] += 1.0 / 20_000.0;
        }
        for (count, expected) in counts.iter().zip(expected) {
            assert!((count - expected).abs() < 0.018, "{name}: {counts:?}");
        }
    }
}

#[test]
fn unknown_names_and_invalid_settings_are_refused() {
    let unknown = operator_named("sawing").err().unwrap().to_string();
    assert!(
        unknown.contains("sawing") && unknown.contains("one-point"),
        "{unknown}"
    );
    assert!(selection_named("lottery").is_err());
    let plain = Evolution::default;
    for evolution in [
        Evolution {
            population: 0,
            ..plain()
        },
        Evolution {
            generations: 0,
            ..plain()
        },
        Evolution {
            elites: 10,
            ..plain()
        },
        Evolution {
            selection: "lottery".to_owned(),
            ..plain()
        },
        Evolution {
            variation: Variation {
                crossover: "gaussian".to_owned(),
                ..Variation::default()
            },
            ..plain()
        },
        Evolution {
            variation: Variation {
                mutation_rate: f64::NAN,
                ..Variation::default()
            },
            ..plain()
        },
        Evolution {
            variation: Variation {
                max_modules: 0,
                ..Variation::default()
            },
            ..plain()
        },
    ] {
        assert!(evolution.propose(&[]).is_err(), "{evolution:?}");
    }
    let archive = MapElites {
        axes: Vec::new(),
        ..map_elites()
    };
    let error = archive.propose(&[]).unwrap_err().to_string();
    assert!(error.contains("archive without descriptors"), "{error}");
}

/// A fitness without physics: the best genome has 0.7 in every number, and a robot fails where its first number is below 0.1.
fn evaluate(genome: &Genome) -> Evaluated {
    let numbers = || genome.genes().iter().flat_map(|gene| gene.values());
    let distance: f64 =
        numbers().map(|v| (v - 0.7).powi(2)).sum::<f64>() / numbers().count() as f64;
    let fails = numbers().next().is_some_and(|v| *v < 0.1);
    Evaluated {
        genome: genome.clone(),
        fitness: (!fails).then_some(-distance),
        descriptors: vec![
            genome.len() as f64,
            numbers().fold(0.0, |a: f64, v| a.max(*v)),
        ],
    }
}

fn follow(strategy: &dyn Strategy) -> Vec<Evaluated> {
    let mut history = Vec::new();
    loop {
        let batch = strategy.propose(&history).unwrap();
        if batch.is_empty() {
            return history;
        }
        history.extend(batch.iter().map(evaluate));
    }
}

fn map_elites() -> MapElites {
    let axis = |name: &str, from, to, cells| Axis {
        name: name.to_owned(),
        from,
        to,
        cells,
    };
    MapElites {
        axes: vec![axis("modules", 0.5, 5.5, 5), axis("largest", 0.5, 1.0, 4)],
        initial: 20,
        batch: 8,
        evaluations: 300,
        selection: None,
        again: 0.0,
        variation: Variation::default(),
        seed: 5,
    }
}

/// A search by this strategy that is small enough to run to its end in a test.
fn small(name: &str) -> Search {
    let root = common::project().display();
    let gait = format!(
        "start: Morphology(\"{root}/morphologies/tripod.ron\"),
        development: (amplitude_rad: (0.0, 1.1), frequency_hz: (0.5, 1.5), offset_rad: (-1.0, 1.0)),"
    );
    let (settings, start) = match name {
        "Evolution" => ("population: 7, generations: 5, elites: 2", ""),
        "MapElites" => (
            "axes: [(name: \"modules\", from: 0.5, to: 5.5, cells: 5), (name: \"straightness\", from: 0, to: 1, cells: 4)],
             initial: 20, batch: 8, evaluations: 300, selection: \"rank\", again: 0.3",
            "",
        ),
        "Grid" => (
            "genes: [(module: 1, gene: \"amplitude\", values: [0.2, 0.8]), (gene: \"phase\", values: [0, 0.5, 1])]",
            gait.as_str(),
        ),
        "CmaEs" => ("evaluations: 45, genes: [\"amplitude\", \"phase\"]", gait.as_str()),
        other => panic!("this test has no settings of the strategy {other}: add some to `small`"),
    };
    let text = format!("Search(duration_s: 1.0, strategy: {name}({settings}), {start})");
    Search::parse(&Source::new("contract.ron", text), &Overrides::default()).unwrap()
}

#[test]
fn every_strategy_has_a_unique_name_and_uses_its_whole_budget() {
    let mut names = Vec::new();
    for kind in STRATEGIES {
        let search = small(kind);
        let strategy = search.strategy();
        assert!(
            !names.contains(&strategy.name()),
            "{} twice",
            strategy.name()
        );
        names.push(strategy.name());
        assert!(!strategy.batch_name().is_empty());
        let history = follow(strategy);
        assert_eq!(history.len(), strategy.budget(), "{kind}");
        for evaluated in &history {
            for value in evaluated.genome.genes().iter().flat_map(|g| g.values()) {
                assert!((0.0..=1.0).contains(value), "{kind}: {value}");
            }
        }
        // The axes of an archive are the descriptors that the strategy requests.
        if let Some(archive) = strategy.archive(&history).unwrap() {
            let axes: Vec<&str> = archive.axes().iter().map(|a| a.name.as_str()).collect();
            assert_eq!(axes, strategy.descriptors(), "{kind}");
        }
    }
}

#[test]
fn a_search_resumed_after_any_evaluation_proposes_the_same_robots() {
    for kind in STRATEGIES {
        let search = small(kind);
        let strategy = search.strategy();
        let whole = follow(strategy);
        for cut in 0..whole.len() {
            let rest = strategy.propose(&whole[..cut]).unwrap();
            assert_eq!(rest, strategy.propose(&whole[..cut]).unwrap(), "{kind}");
            let expected: Vec<_> = whole[cut..]
                .iter()
                .take(rest.len())
                .map(|e| e.genome.clone())
                .collect();
            assert!(!rest.is_empty(), "{kind} after {cut}");
            assert_eq!(rest, expected, "{kind} after {cut}");
            let parents = strategy.parents(&whole[..cut]).unwrap();
            assert_eq!(parents.len(), rest.len(), "{kind} after {cut}");
            assert!(
                parents.iter().flatten().all(|parent| *parent < cut),
                "{kind} after {cut}"
            );
        }
    }
}

#[test]
fn a_strategy_whose_robots_all_fail_still_uses_its_whole_budget() {
    for kind in STRATEGIES {
        let search = small(kind);
        let strategy = search.strategy();
        let mut history: Vec<Evaluated> = Vec::new();
        loop {
            let proposed = strategy.propose(&history).unwrap();
            if proposed.is_empty() {
                break;
            }
            history.extend(proposed.into_iter().map(|genome| Evaluated {
                genome,
                fitness: None,
                descriptors: Vec::new(),
            }));
        }
        assert_eq!(history.len(), strategy.budget(), "{kind}");
    }
}

#[test]
fn a_history_written_as_json_is_read_back_exactly_and_invalid_genomes_are_refused() {
    let evolution = Evolution::default();
    let whole = follow(&evolution);
    let text = serde_json::to_string(&whole).unwrap();
    assert_eq!(
        serde_json::from_str::<Vec<Evaluated>>(&text).unwrap(),
        whole
    );
    for bad in ["[]", "[[0,0,0,0,0,0,0,0,0,2]]", "[[0,0,0]]"] {
        assert!(serde_json::from_str::<Genome>(bad).is_err(), "{bad}");
    }
}

#[test]
fn the_published_size_is_ten_generations_of_ten() {
    let evolution = Evolution {
        elites: 0,
        ..Evolution::default()
    };
    assert_eq!(follow(&evolution).len(), 100);
}

#[test]
fn evolution_beats_random_search_on_a_smooth_fitness() {
    let best = |history: &[Evaluated]| {
        history
            .iter()
            .map(Evaluated::comparable)
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let mut wins = 0;
    for seed in 0..10 {
        let evolution = Evolution {
            seed,
            population: 20,
            generations: 15,
            ..Evolution::default()
        };
        let evolved = follow(&evolution);
        let mut rng = generator(seed, 99);
        let random: Vec<Evaluated> = (0..evolved.len())
            .map(|_| evaluate(&Variation::default().random(&mut rng).unwrap()))
            .collect();
        wins += u32::from(best(&evolved) > best(&random));
    }
    // By chance 9 or more of 10 happen once in 93.
    assert!(wins >= 9, "{wins} of 10");
}

#[test]
fn a_robot_that_is_evaluated_again_is_its_own_only_parent() {
    let strategy = MapElites {
        again: 1.0,
        selection: Some("rank".to_owned()),
        ..map_elites()
    };
    let history = follow(&strategy);
    for cut in [strategy.initial, 100] {
        let proposed = strategy.propose(&history[..cut]).unwrap();
        for (child, parents) in proposed
            .iter()
            .zip(strategy.parents(&history[..cut]).unwrap())
        {
            assert_eq!(parents.len(), 1);
            assert_eq!(*child, history[parents[0]].genome);
        }
    }
}

#[test]
fn the_archive_holds_the_best_of_every_cell_and_no_failure() {
    let strategy = map_elites();
    let history = follow(&strategy);
    let archive = Archive::new(&strategy.axes, &history);
    assert_eq!(strategy.archive(&history).unwrap().as_ref(), Some(&archive));
    assert_eq!(archive.cells().len(), 20);
    let elites = archive.elites();
    assert!(elites.len() >= 10, "{} cells filled", elites.len());
    for (cell, held) in archive.cells().iter().enumerate() {
        let Some(held) = *held else { continue };
        let of = |e: &Evaluated| {
            strategy.axes[0].cell(e.descriptors[0]).unwrap()
                + 5 * strategy.axes[1].cell(e.descriptors[1]).unwrap()
        };
        assert_eq!(of(&history[held]), cell);
        assert!(elites.contains(&(vec![cell % 5, cell / 5], held)));
        assert!(history[held].fitness.is_some());
        assert!(
            history
                .iter()
                .filter(|e| of(e) == cell)
                .all(|e| e.comparable() <= history[held].comparable())
        );
    }
    assert_eq!(strategy.axes[1].cell(f64::NAN), None);
    assert_eq!(
        (strategy.axes[1].cell(-9.0), strategy.axes[1].cell(9.0)),
        (Some(0), Some(3))
    );
}
