//! Fits the contact of a tossed robot on part of its recordings and checks it on the others.
//!
//! ```sh
//! cargo run --release --example fit_toss -- sweeps/cube_toss_fit.ron 'real_trajectories/cube_tosses/*.csv' best.ron
//! ```
//!
//! There are two folds, the even and the odd recordings in order of their paths. For each fold, the program identifies the centre of
//! mass and the length scale from its flights, fits the study's parameters to its `pose` scores (CMA-ES, starts from the flight), and
//! reports the errors on the other fold. The values fitted to the even recordings are written to a file.

use std::path::Path;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use realgap::calibration::{BestFile, Evaluation, Overrides, Part, Study};
use realgap::file::{write_atomic, write_ron};
use realgap::identification::{LengthReading, StartState, identify};
use realgap::optimization::RunOptions;
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::{Error, Result};

const FOLDS: usize = 2;
const GENERATIONS: usize = 26;
const CHILDREN: usize = 12;

fn main() -> std::process::ExitCode {
    match run() {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            say(format!("error: {error}"));
            std::process::ExitCode::FAILURE
        }
    }
}

#[allow(clippy::print_stdout)]
fn say(text: impl AsRef<str>) {
    println!("{}", text.as_ref());
}

fn run() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [study, recordings, output] = arguments.as_slice() else {
        return Err(
            Error::usage("three arguments are needed").allowed("STUDY RECORDINGS-GLOB OUTPUT.ron")
        );
    };
    for fold in 0..FOLDS {
        let open = |part: usize, start: StartState| {
            let overrides = Overrides {
                recordings: vec![recordings.clone()],
                part: Some(Part::new(FOLDS, part)?),
                start_state: Some(start),
                metric: Some(realgap::comparison::by_name("pose")?),
                ..Overrides::default()
            };
            Study::read(study, &overrides)
        };
        let training = open(fold, StartState::Flight)?;
        let flight = identify(
            &training.definition().experiment(),
            &training.definition().recordings,
            LengthReading::LengthScale,
            training.definition().seed,
        )?;
        let body: ParameterSet = flight
            .parameters
            .iter()
            .map(|(name, value)| Assignment::new(name, *value))
            .collect::<Result<_>>()?;
        let best = fit(&training, &body)?;
        say(format!("fitted on part {fold} of {FOLDS}: {best}"));
        report(
            "  the same recordings, flight start",
            &training.evaluate(&best, &RunOptions::default())?,
        );
        let mut held_out = Vec::new();
        for (label, start) in [
            ("flight start", StartState::Flight),
            ("first-sample start", StartState::FirstSample),
        ] {
            for other in (0..FOLDS).filter(|other| *other != fold) {
                let result = open(other, start)?.evaluate(&best, &RunOptions::default())?;
                report(&format!("  held out: part {other}, {label}"), &result);
                held_out.push(format!(
                    "{:.2} +- {:.2} % and {:.2} +- {:.2} deg from the {label}",
                    result.position_percent.mean,
                    result.position_percent.standard_error,
                    result.rotation_deg.mean,
                    result.rotation_deg.standard_error
                ));
            }
        }
        if fold == 0 {
            let file = BestFile {
                study: None,
                fitted_on: Vec::new(),
                draws: std::collections::BTreeMap::new(),
                description: format!(
                    "Fitted on the even-numbered recordings (--every {FOLDS} --offset 0, in order of their paths, counted from 0; {} of them): length scale from \
                     their flights, the rest (centre of mass along z included) by CMA-ES on the pose metric from flight starts. Held-out errors on the odd-numbered (--every {FOLDS} --offset 1): {}.",
                    training.definition().recordings.len(),
                    held_out.join("; ")
                ),
                parameters: training
                    .definition()
                    .set
                    .clone()
                    .with_all(&best)
                    .iter()
                    .map(|a| (a.parameter.name.to_owned(), a.value))
                    .collect(),
            };
            write_atomic(Path::new(output), write_ron(&file)?.as_bytes())?;
        }
    }
    Ok(())
}

fn report(label: &str, e: &Evaluation) {
    say(format!(
        "{label}: position {:.2} +- {:.2} % (median {:.2}), rotation {:.2} +- {:.2} deg (median {:.2}), {} of {} over 45 deg",
        e.position_percent.mean,
        e.position_percent.standard_error,
        e.position_percent.median,
        e.rotation_deg.mean,
        e.rotation_deg.standard_error,
        e.rotation_deg.median,
        e.over_45_deg,
        e.recordings
    ));
}

/// Minimises the mean pose score of a problem over its study's ranges, from their middle, by CMA-ES
/// (Hansen 2016, "The CMA evolution strategy: a tutorial") without step-size path subtleties: the mean of the final
/// distribution is returned, which follows the noise of single flips less than the best child.
fn fit(study: &Study, body: &ParameterSet) -> Result<ParameterSet> {
    let ranges = study.definition().grid.ranges();
    let n = ranges.len();
    let set = |x: &DVector<f64>| -> ParameterSet {
        let values: Vec<f64> = ranges
            .iter()
            .zip(x.iter())
            .map(|(range, x)| range.from + x.clamp(0.0, 1.0) * (range.to - range.from))
            .collect();
        body.clone().with_all(&study.parameter_set(&values))
    };
    let score = |x: &DVector<f64>| -> Result<f64> {
        let e = study.evaluate(&set(x), &RunOptions::default())?;
        let outside: f64 = x.iter().map(|v| (v - v.clamp(0.0, 1.0)).abs()).sum();
        Ok(e.position_percent.mean / 100.0 + e.rotation_deg.mean.to_radians() + outside)
    };
    let parents = CHILDREN / 2;
    let raw: Vec<f64> = (0..parents)
        .map(|i| ((CHILDREN as f64 + 1.0) / 2.0).ln() - ((i + 1) as f64).ln())
        .collect();
    let total: f64 = raw.iter().sum();
    let weights: Vec<f64> = raw.iter().map(|w| w / total).collect();
    let nf = n as f64;
    let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    let path_rate = (4.0 + effective / nf) / (nf + 4.0 + 2.0 * effective / nf);
    let step_rate = (effective + 2.0) / (nf + effective + 5.0);
    let rank_one = 2.0 / ((nf + 1.3).powi(2) + effective);
    let rank_mu = (1.0 - rank_one)
        .min(2.0 * (effective - 2.0 + 1.0 / effective) / ((nf + 2.0).powi(2) + effective));
    let damping = 1.0 + step_rate;
    let expected = nf.sqrt() * (1.0 - 1.0 / (4.0 * nf) + 1.0 / (21.0 * nf * nf));

    let mut rng = ChaCha8Rng::seed_from_u64(study.definition().seed);
    let mut mean = DVector::from_element(n, 0.5);
    let mut sigma = 0.15;
    let mut covariance = DMatrix::<f64>::identity(n, n);
    let (mut path, mut step_path) = (DVector::<f64>::zeros(n), DVector::<f64>::zeros(n));
    for generation in 0..GENERATIONS {
        let eigen = SymmetricEigen::new(covariance.clone());
        let lengths = eigen.eigenvalues.map(|v| v.max(1e-12).sqrt());
        let mut children = Vec::with_capacity(CHILDREN);
        for _ in 0..CHILDREN {
            let z = DVector::<f64>::from_fn(n, |_, _| StandardNormal.sample(&mut rng));
            let y = &eigen.eigenvectors * lengths.component_mul(&z);
            children.push((score(&(&mean + &y * sigma))?, y));
        }
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        let step = children
            .iter()
            .zip(&weights)
            .fold(DVector::zeros(n), |sum, ((_, y), w)| sum + y * *w);
        mean += &step * sigma;
        let whitened =
            &eigen.eigenvectors * (eigen.eigenvectors.transpose() * &step).component_div(&lengths);
        step_path = step_path * (1.0 - step_rate)
            + whitened * (step_rate * (2.0 - step_rate) * effective).sqrt();
        path =
            path * (1.0 - path_rate) + &step * (path_rate * (2.0 - path_rate) * effective).sqrt();
        covariance = covariance * (1.0 - rank_one - rank_mu) + &path * path.transpose() * rank_one;
        for ((_, y), w) in children.iter().zip(&weights) {
            covariance += y * y.transpose() * (rank_mu * w);
        }
        sigma *= ((step_rate / damping) * (step_path.norm() / expected - 1.0)).exp();
        say(format!(
            "    generation {generation}: best {:.4}, step {sigma:.3}",
            children[0].0
        ));
    }
    Ok(set(&mean))
}
