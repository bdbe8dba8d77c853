//! Studies without simulations: tables of scores and outcomes drawn at random, likely or not.

use std::collections::BTreeMap;
use std::time::Duration;

use nalgebra::Vector3;

use crate::results::study::data::{Point, Points, StudyData};
use realgap_core::unit::Unit;
use realgap_lab::calibration::{
    Audit, AuditRow, Best, BestPointUncertainty, EnginePreference, Fit, PointScore, PosteriorDraws,
    Report, Scores, Tables, Uncertainty, UncertaintySource, Unvisited, Validation, Verdict,
};
use realgap_lab::prediction::ensemble::{Ensemble, Forecast, Motion, Reality, Repeat};
use realgap_lab::prediction::gap::{
    CaseRuns, Confidence, Fitness, OverTime, Sample, Scoring, StudyGap, distances,
};
use realgap_lab::prediction::{
    Card, EnsembleCase, EnsembleReport, SuccessRule, UncertainParameters,
};
use realgap_optimization::Range;
use realgap_path::comparison;
use realgap_path::trajectory::{Source, Trajectory};
use realgap_simulation::parameter::by_name;
use realgap_simulation::{Noise, Outcome, Perturbation};

/// Random numbers (SplitMix64).
pub(in crate::report) struct Draw(u64);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.share() * count as f64) as usize
    }

    pub fn is(&mut self, probability: f64) -> bool {
        self.share() < probability
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.share()).sum::<f64>() - 6.0
    }
}

/// A sweep.
pub(in crate::report) struct Swept {
    pub report: Report,
    scores: Scores,
    uncertainty: Uncertainty,
    ranges: Vec<Range>,
    pub draws: PosteriorDraws,
}

/// A value of a searched range.
fn anywhere(draw: &mut Draw, range: &Range) -> f64 {
    draw.within(range.from, range.to)
}

impl Swept {
    pub fn new(draw: &mut Draw) -> Self {
        let range = |name: &str, from, to| Range::new(by_name(name).unwrap(), from, to, 5).unwrap();
        let ranges = vec![
            range("floor.friction", 0.05, 1.05),
            range("floor.restitution", 0.0, 0.8),
        ];
        let valley: Vec<f64> = ranges.iter().map(|range| anywhere(draw, range)).collect();
        let steep: Vec<f64> = ranges
            .iter()
            .map(|_| draw.within(0.0, 2.0).powi(2))
            .collect();
        let floor = draw.within(0.01, 0.3);
        let expected = |values: &[f64]| {
            let axes = values.iter().zip(&valley).zip(&steep);
            floor + axes.map(|((v, c), s)| s * (v - c).powi(2)).sum::<f64>()
        };
        let place = |draw: &mut Draw| -> Vec<f64> {
            ranges.iter().map(|range| anywhere(draw, range)).collect()
        };
        let points: Vec<PointScore> = (0..20)
            .map(|index| {
                let values = place(draw);
                let score = Some(expected(&values) + 0.02 * draw.share());
                point(index, values, score)
            })
            .collect();
        let score = |at: &usize| points[*at].score.unwrap();
        let best = (0..points.len())
            .min_by(|a, b| score(a).total_cmp(&score(b)))
            .unwrap();
        let limit = score(&best) + draw.within(0.0, 0.5).powi(3);
        let uncertainty = Uncertainty {
            source: UncertaintySource::Recordings,
            level: 0.95,
            best_score_sd: 0.01,
            simulation_sd: 0.01,
            emulator_share: 0.1,
            indistinguishable: (0..points.len())
                .map(|at| at == best || score(&at) < limit)
                .collect(),
            holds_best: draw.is(0.8),
            cells: Vec::new(),
            unvisited: (0..40)
                .map(|_| {
                    let values = place(draw);
                    let indistinguishable = expected(&values) < limit;
                    Unvisited {
                        values,
                        indistinguishable,
                    }
                })
                .collect(),
        };
        let (near, recordings) = (points[best].values.clone(), 1 + draw.below(10));
        let scores = Scores {
            runs: points.clone(),
            points,
            best: Some(best),
            unit: Unit::Metre,
            basis: None,
            engine: 0.0,
        };
        let (draws, audit) = (draws(draw, &ranges, &near), audit(draw));
        let verdicts = Verdict::all(&Tables {
            ranges: &ranges,
            scores: &scores,
            uncertainty: Some(&uncertainty),
            draws: Some(&draws),
            audit: Some(&audit),
            recordings,
        });
        let fit = (recordings > 1).then(|| Fit {
            judged: true,
            noise_floors: Some(draw.within(0.5, 9.0)),
            p_value: (recordings > 2).then(|| draw.share()),
            neighbours_p_value: draw.is(0.3).then(|| draw.share()),
            explains: draw.is(0.7),
            discrepancy: draw.share(),
            engine: draw.is(0.5).then_some("rapier"),
            misfit: None,
            residuals: None,
        });
        let mut report = empty(&scores, recordings);
        report.uncertainty = Some(BestPointUncertainty {
            source: uncertainty.source,
            level: uncertainty.level,
            best_score_sd: 0.01,
            simulation_sd: 0.01,
            emulator_share: 0.1,
            indistinguishable: uncertainty
                .indistinguishable
                .iter()
                .filter(|is| **is)
                .count(),
            points: scores.points.len(),
        });
        (report.fit, report.verdicts, report.audit) = (fit, verdicts, Some(audit));
        report.engines = engines(draw);
        report.complete = draw.is(0.9);
        report.validation = draw.is(0.4).then(|| Validation {
            split: "drawn".to_owned(),
            fit_score: 0.1,
            held_out_score: 0.1 * draw.within(0.8, 1.6),
            difference_standard_error: 0.01,
            held_out_recordings: 1 + draw.below(5),
            folds: Vec::new(),
            bands: None,
        });
        let names = ranges.iter().map(|range| range.parameter.name.to_owned());
        report.best = Some(Best {
            parameters: names.zip(near).collect(),
            score: scores.points[best].score.unwrap(),
            settings: 1 + 15 * draw.below(2),
            own_score: None,
            displacement_error_m: None,
        });
        let source = if draw.is(0.5) {
            Source::Real
        } else {
            Source::StandIn
        };
        Self {
            report: report.with_claims(source, recordings),
            scores,
            uncertainty,
            ranges,
            draws,
        }
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.ranges.iter().map(|range| range.parameter.name)
    }

    fn in_set(&self) -> impl Iterator<Item = &PointScore> {
        let points = self
            .scores
            .points
            .iter()
            .zip(&self.uncertainty.indistinguishable);
        points.filter(|(_, is_in)| **is_in).map(|(point, _)| point)
    }

    /// Points that cannot be told from the best, of so many.
    pub fn counted(&self) -> (usize, usize) {
        (self.in_set().count(), self.scores.points.len())
    }

    /// The points as a page shows them.
    pub fn data(&self) -> StudyData {
        let points = self.scores.points.iter();
        let points = points.zip(&self.uncertainty.indistinguishable);
        let points = points.map(|(point, is_in)| Point {
            values: point.values.clone(),
            score: point.score,
            is_indistinguishable: *is_in,
            ..Point::default()
        });
        StudyData {
            points: Points {
                names: self.names().map(str::to_owned).collect(),
                points: points.collect(),
            },
            ..StudyData::default()
        }
    }
}

fn point(index: usize, values: Vec<f64>, score: Option<f64>) -> PointScore {
    PointScore {
        index,
        runs: 1,
        values,
        diverged: None,
        recordings: Vec::new(),
        score,
        held_out: None,
        displacement_error_m: None,
        path_xy_m: Vec::new(),
    }
}

/// Draws in one cluster or two, near the best point or not.
fn draws(draw: &mut Draw, ranges: &[Range], best: &[f64]) -> PosteriorDraws {
    let (is_parted, is_near) = (draw.is(0.3), draw.is(0.8));
    let spread = draw.within(0.01, 0.4);
    let (mut rows, mut gaps) = (vec![Vec::new(); 200], vec![Vec::new(); ranges.len()]);
    for (axis, range) in ranges.iter().enumerate() {
        let size = range.to - range.from;
        let centre = if is_near {
            best[axis]
        } else {
            anywhere(draw, range)
        };
        let is_parted = is_parted && axis == 0;
        let (low, high) = (range.from + 0.2 * size, range.from + 0.8 * size);
        if is_parted {
            gaps[axis].push(0.5 * (low + high));
        }
        for (index, row) in rows.iter_mut().enumerate() {
            let middle = match (is_parted, index % 2) {
                (false, _) => centre,
                (true, 0) => low,
                (true, _) => high,
            };
            let spread = if is_parted { 0.03 } else { spread };
            row.push((middle + spread * size * draw.normal()).clamp(range.from, range.to));
        }
    }
    PosteriorDraws::new(rows, gaps)
}

fn engines(draw: &mut Draw) -> Vec<EnginePreference> {
    let both = draw.is(0.7).then_some(["rapier", "tree"]);
    let first = draw.share();
    let mut preference = |engine| EnginePreference {
        engine,
        weight: match engine {
            "rapier" => first,
            _ => 1.0 - first,
        },
        explains: (0.05..=0.95).contains(&first) || (first > 0.5) == (engine == "rapier"),
        score: draw.within(0.01, 0.2),
        settings: 8,
        parameters: [("floor.friction".to_owned(), draw.share())].into(),
        expected: draw.within(0.01, 0.2),
        implausibility: draw.within(0.0, 4.0),
        limit: 2.45,
    };
    both.into_iter().flatten().map(&mut preference).collect()
}

fn audit(draw: &mut Draw) -> Audit {
    let mut some = |probability: f64| -> Vec<String> {
        let all = ["floor.friction", "floor.restitution"].into_iter();
        all.filter(|_| draw.is(probability))
            .map(str::to_owned)
            .collect()
    };
    Audit {
        rows: vec![AuditRow {
            setting: "timestep 0.5 times".to_owned(),
            coarser: false,
            score: Some(0.2),
            change: Some(-0.01),
        }],
        largest_change: 0.01,
        largest_coarser_change: 0.02,
        unresolved: some(0.1),
        shaken: some(0.2),
    }
}

/// A report that says nothing yet.
fn empty(scores: &Scores, recordings: usize) -> Report {
    Report {
        study: "drawn".to_owned(),
        description: String::new(),
        complete: true,
        points: scores.points.len(),
        runs: scores.runs.len(),
        points_total: scores.points.len(),
        tuning: None,
        diverged: 0,
        recordings,
        metric: "rms",
        unit: scores.unit,
        is_of_joints: false,
        best: None,
        fit: None,
        uncertainty: None,
        verdicts: Vec::new(),
        claims: Vec::new(),
        correlations: Vec::new(),
        differences: Vec::new(),
        engines: Vec::new(),
        audit: None,
        validation: None,
        transfer: None,
        reproduction: None,
        components: None,
        pose: None,
        provenance: BTreeMap::new(),
        warnings: Vec::new(),
    }
}

/// Recordings, and repeats under noise that are like them or not.
pub(in crate::report) struct Repeated {
    pub gap: StudyGap,
    pub ensemble: EnsembleReport,
    pub card: Card,
}

const DURATION_S: f64 = 4.0;
const BODY_M: f64 = 0.1;

/// A path that goes `far` metres and bends.
fn path(name: String, far: f64, bend: f64) -> Sample {
    let times: Vec<f64> = (0..=20).map(|k| DURATION_S * f64::from(k) / 20.0).collect();
    let at = |t: &f64| Vector3::new(far * t / DURATION_S, bend * (t / DURATION_S).powi(2), 0.0);
    let places = times.iter().map(at).collect();
    Sample::new(name, Trajectory::new(times, places).unwrap()).unwrap()
}

impl Repeated {
    pub fn new(draw: &mut Draw) -> Self {
        let spread = draw.within(0.005, 0.05);
        let of_recordings = spread * [1.0, 1.0, 0.1, 4.0][draw.below(4)];
        let off = [0.0, 0.0, 0.03, 0.3][draw.below(4)];
        let mut several = |what: &str, count: usize, size: f64, off: f64| -> Vec<Sample> {
            (0..count)
                .map(|k| {
                    path(
                        format!("{what} {k}"),
                        0.5 + off + size * draw.normal(),
                        size * draw.normal(),
                    )
                })
                .collect()
        };
        let repeats = several("repeat", 30, spread, 0.0);
        let real = several("run", 14, of_recordings, off);
        let real: Vec<Sample> = real.into_iter().take(2 + draw.below(13)).collect();
        let source = if draw.is(0.5) {
            Source::Real
        } else {
            Source::StandIn
        };
        let ideal = path("without noise".to_owned(), 0.5, 0.0);
        let ensemble = repeated(&repeats, &ideal);
        let seen_by_fit = [None, Some(0), Some(1)][draw.below(3)];
        let card = Card::new(
            "robot",
            &ensemble,
            SuccessRule::AtLeast(draw.within(0.4, 0.6)),
        )
        .unwrap();
        Self {
            gap: StudyGap {
                seen_by_fit,
                ..gap(real.clone(), repeats, ideal, source)
            }
            .with_claims(),
            ensemble: EnsembleReport {
                seen_by_fit,
                ..report(ensemble, &real, source)
            }
            .with_claims(),
            card,
        }
    }
}

fn repeated(repeats: &[Sample], ideal: &Sample) -> Ensemble {
    let motion = |sample: &Sample| Motion {
        path: sample.prepared.clone(),
        turned_rad: 0.0,
        servo_rms_rad: 0.0,
        energy: None,
    };
    let one = |(number, sample): (usize, &Sample)| Repeat {
        number: number as u64,
        perturbation: Perturbation::default(),
        outcome: Outcome::Completed(motion(sample)),
    };
    Ensemble {
        noise: Noise::unmeasured_robot(),
        uncertain: UncertainParameters::default(),
        seed: 1,
        asked: repeats.len(),
        repeats: repeats.iter().enumerate().map(one).collect(),
        noise_free: Outcome::Completed(motion(ideal)),
        duration_s: DURATION_S,
        body_length_m: BODY_M,
        cpu: Duration::ZERO,
        engine: "none",
        warnings: Vec::new(),
    }
}

fn report(ensemble: Ensemble, real: &[Sample], source: Source) -> EnsembleReport {
    let forecast = Forecast::new(&ensemble).unwrap();
    let named: Vec<_> = real
        .iter()
        .map(|s| (s.name.as_str(), &s.prepared))
        .collect();
    let reality = Reality::new(&ensemble, &forecast, &named).unwrap();
    let case = EnsembleCase {
        case: "drawn".to_owned(),
        ensemble,
        real_paths_m: Vec::new(),
        forecast,
        reality: reality.clone(),
        model: None,
        in_further_runs: None,
    };
    EnsembleReport {
        study: "drawn".to_owned(),
        morphology: "robot".to_owned(),
        complete: true,
        parameters: BTreeMap::new(),
        noise_from: "drawn".to_owned(),
        engine: "none",
        version: "0",
        source,
        reality,
        cases: vec![case],
        claims: Vec::new(),
        warnings: Vec::new(),
        seen_by_fit: None,
    }
}

fn gap(real: Vec<Sample>, repeats: Vec<Sample>, ideal: Sample, source: Source) -> StudyGap {
    let cases = [CaseRuns {
        recordings: (0..real.len()).collect(),
        ideal: Some(ideal),
        repeats,
    }];
    let metrics = ["displacement", "rms"].map(|name| comparison::by_name(name).unwrap());
    let scoring = Scoring {
        metrics: metrics.to_vec(),
        components: comparison::Components::default(),
        body_length_m: Some(BODY_M),
        channels: None,
        seed: 1,
    };
    let found = distances(&real, &cases, &scoring).unwrap();
    StudyGap {
        study: "drawn".to_owned(),
        morphology: "robot".to_owned(),
        parameters: BTreeMap::new(),
        complete: true,
        recordings: real.len(),
        source,
        starts: 1,
        repeats: cases[0].repeats.len(),
        seed: 1,
        metrics: found.metrics,
        displacement: Fitness::new(&real, &cases).unwrap(),
        over_time: OverTime::new(&real, &cases),
        confidence: Confidence::new(&real, &cases, BODY_M).unwrap(),
        claims: Vec::new(),
        noise: None,
        engine: "none",
        version: "0",
        warnings: found.warnings,
        seen_by_fit: None,
    }
}
