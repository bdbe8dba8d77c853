//! Tests of logs with sessions that differ, with rounded readings, and with readings that have two peaks.

use rand::RngExt as _;
use rand_distr::StandardNormal;
use realgap_core::random::Numbered;
use realgap_core::statistics::Proportion;
use realgap_sensing::range::form::form_by_name;
use realgap_sensing::range::{Characterisation, Options, ReadingLog};

/// Parameters of a synthetic log of sessions: standard deviations between sessions at all distances together, at each distance
/// separately, and of readings.
struct Stand {
    sessions: usize,
    distances: usize,
    readings: usize,
    everywhere: f64,
    by_distance: f64,
    sd: f64,
}

impl Stand {
    fn mean(distance: f64) -> f64 {
        0.76 + 0.96 * distance
    }

    fn distances(&self) -> impl Iterator<Item = f64> + use<> {
        let last = self.distances - 1;
        (0..self.distances).map(move |k| 5.0 + 30.0 * k as f64 / last as f64)
    }

    /// The log of all sessions but the last, and the readings of the last session.
    fn log(&self, seed: u64) -> (ReadingLog, Vec<(f64, Vec<f64>)>) {
        let mut rng = Numbered::SensorSession.generator(seed, 7);
        let mut normal = move || rng.sample::<f64, _>(StandardNormal);
        let mut text = String::from("distance_cm,reading_cm,session\n");
        let mut kept = Vec::new();
        for session in 0..=self.sessions {
            let everywhere = self.everywhere * normal();
            for distance in self.distances() {
                let centre = Self::mean(distance) + everywhere + self.by_distance * normal();
                let values: Vec<f64> = (0..self.readings)
                    .map(|_| centre + self.sd * normal())
                    .collect();
                if session == self.sessions {
                    kept.push((distance, values));
                } else {
                    for value in values {
                        text += &format!("{distance},{value},day {session}\n");
                    }
                }
            }
        }
        (ReadingLog::parse("log.csv", &text).unwrap(), kept)
    }
}

/// Number of logs of each kind.
const LOGS: usize = 500;

fn options() -> Options {
    let linear = Some(form_by_name("linear").unwrap());
    Options {
        mean: linear,
        spread: linear,
        level: Some(0.9),
        ..Options::default()
    }
}

/// How often 90 % intervals contain the truth: for parameters of the mean, the variation between sessions, a session that is not in the
/// log, and its readings (docs/validation/sensing.md).
fn shares(stand: &Stand, logs: u64) -> Vec<(&'static str, f64)> {
    let mut held = [(0_usize, 0_usize); 5];
    for seed in 0..logs {
        let (log, kept) = stand.log(seed);
        let found = Characterisation::new(&log, &options()).unwrap();
        let sessions = found.sessions.unwrap();
        let mut count = |which: usize, is_held: bool| {
            held[which].0 += usize::from(is_held);
            held[which].1 += 1;
        };
        for (value, truth) in found.mean.iter().zip([0.76, 0.96]) {
            count(0, value.low <= truth && truth <= value.high);
        }
        for (which, spread, truth) in [
            (1, sessions.everywhere, stand.everywhere),
            (2, sessions.by_distance, stand.by_distance),
        ] {
            count(which, spread.low <= truth && truth <= spread.high);
        }
        for (next, (distance, values)) in sessions.next.iter().zip(&kept) {
            assert_eq!(next.distance, *distance);
            let mean = realgap_core::statistics::mean(values);
            count(3, next.mean_low <= mean && mean <= next.mean_high);
            for value in values {
                count(4, next.reading_low <= *value && *value <= next.reading_high);
            }
        }
    }
    let names = [
        "parameters of the mean",
        "spread between sessions, everywhere",
        "at each distance by itself",
        "mean of a session that was left out",
        "readings of that session",
    ];
    names
        .into_iter()
        .zip(held.map(|(held, of)| held as f64 / of as f64))
        .collect()
}

#[test]
fn intervals_hold_for_sessions_that_are_not_in_the_log() {
    if !crate::common::is_long_run("coverage of sessions") {
        return;
    }
    let stands = [
        ("mounting and target", 6, 0.5, 0.2),
        ("target alone", 12, 0.0, 0.4),
        ("many sessions", 20, 0.3, 0.1),
    ];
    for (name, sessions, everywhere, by_distance) in stands {
        let stand = Stand {
            sessions,
            distances: 6,
            readings: 12,
            everywhere,
            by_distance,
            sd: 0.3,
        };
        for (what, share) in shares(&stand, LOGS as u64) {
            println!("| {name} | {sessions} | {what} | {:.1} % |", 100.0 * share);
            // The interval of a standard deviation of 0 begins at 0, so it can miss the truth on one side only.
            let is_none = (what.contains("everywhere") && everywhere == 0.0)
                || (what.contains("itself") && by_distance == 0.0);
            // The intervals at all distances of one log depend on the same sessions, so a log counts once.
            let held = Proportion::new((share * LOGS as f64).round() as usize, LOGS, 0.99);
            assert!(
                held.high >= 0.9 && (held.low <= 0.9 || is_none),
                "{name}, {what}: {share}"
            );
        }
    }
}

#[test]
fn intervals_that_ignore_sessions_are_too_narrow_for_the_next_session() {
    let stand = Stand {
        sessions: 8,
        distances: 6,
        readings: 30,
        everywhere: 0.5,
        by_distance: 0.1,
        sd: 0.3,
    };
    let (log, _) = stand.log(1);
    let mut without = log.clone();
    without.sessions.clear();
    for reading in &mut without.readings {
        reading.session = 0;
    }
    let [with, without] =
        [log, without].map(|log| Characterisation::new(&log, &options()).unwrap());
    let width = |found: &Characterisation| found.mean[0].high - found.mean[0].low;
    assert!(width(&with) > 3.0 * width(&without));
    // The standard deviation of readings is the one within a session.
    assert!((with.spread[0].value + 20.0 * with.spread[1].value - 0.3).abs() < 0.03);
    assert!(without.spread[0].value + 20.0 * without.spread[1].value > 0.4);
    assert!(
        (with.model.session_sd - 0.5).abs() < 0.35,
        "{}",
        with.model.session_sd
    );
}

/// 70 % of the readings have one value and 30 % another one, as with many cheap sensors between two echoes.
#[test]
fn rounded_readings_with_two_peaks_are_described_and_not_treated_as_outliers() {
    let mut text = String::from("distance_cm,reading_cm\n");
    let mut rng = Numbered::SensorReading.generator(3, 0);
    for distance in [5.0_f64, 10.0, 15.0, 20.0] {
        for k in 0..200 {
            let echo = if k % 10 < 3 && distance > 12.0 {
                0.9
            } else {
                0.0
            };
            let noise: f64 = 0.02 * rng.sample::<f64, _>(StandardNormal);
            let value = ((distance + echo + noise) / 0.1).round() * 0.1;
            text += &format!("{distance},{value:.1}\n");
        }
        text += &format!("{distance},117.3\n");
    }
    let log = ReadingLog::parse("log.csv", &text).unwrap();
    let found = Characterisation::new(&log, &Options::default()).unwrap();
    assert_eq!(found.outliers.count, 4, "{:?}", found.outliers);
    assert!((found.step - 0.1).abs() < 1e-9);
    let peaks: Vec<usize> = found.distances.iter().map(|d| d.peaks.len()).collect();
    assert_eq!(peaks, [0, 0, 2, 2]);
    let peak = found.distances[3].peaks[1];
    assert!((peak.centre - 20.9).abs() < 1e-9 && (peak.share - 0.3).abs() < 1e-9);
    let codes: Vec<&str> = found.warnings.iter().map(|w| w.code.name()).collect();
    assert!(
        codes.contains(&"quantised-readings") && codes.contains(&"several-peaks"),
        "{codes:?}"
    );
    let text = found.to_string();
    assert!(text.contains("15.900 (30 %)"), "{text}");
}

#[test]
fn two_sessions_give_a_warning_and_sessions_without_repeated_readings_an_error() {
    let rows = |sessions: usize, readings: usize| {
        let mut text = String::from("distance_cm,reading_cm,session\n");
        let mut rng = Numbered::SensorReading.generator(5, 0);
        for session in 0..sessions {
            for distance in [5.0, 10.0, 15.0, 20.0] {
                for _ in 0..readings {
                    let noise: f64 = 0.1 * rng.sample::<f64, _>(StandardNormal);
                    text += &format!("{distance},{},{session}\n", distance + noise);
                }
            }
        }
        Characterisation::new(&ReadingLog::parse("log.csv", &text).unwrap(), &options())
    };
    let two = rows(2, 20).unwrap();
    assert!(two.sessions.is_none());
    assert!(two.warnings.iter().any(|w| w.code.name() == "few-sessions"));
    let error = rows(5, 1).unwrap_err().to_string();
    assert!(error.contains("hardly any repeated readings"), "{error}");
}
