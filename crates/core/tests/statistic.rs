//! Statistics agree with scipy, numpy and statsmodels (the golden values come from tools/golden_statistics.py).
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use realgap_core::statistics::{
    PValueMethod, Proportion, SampleTest, anderson_darling, kolmogorov_smirnov, mann_whitney,
    median, quantile, spearman,
};

/// One line of the golden file.
struct Line {
    what: String,
    method: String,
    x: Vec<f64>,
    y: Vec<f64>,
    first: f64,
    second: f64,
}

fn golden(what: &str) -> Vec<Line> {
    let text = common::read(&common::golden(), "statistics.csv");
    let numbers = |cell: &str| -> Vec<f64> {
        cell.split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect()
    };
    let lines: Vec<Line> = text
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            Line {
                what: cells[0].to_owned(),
                method: cells[1].to_owned(),
                x: numbers(cells[2]),
                y: numbers(cells[3]),
                first: cells[4].parse().unwrap(),
                second: cells[5].parse().unwrap(),
            }
        })
        .filter(|line| line.what == what)
        .collect();
    assert!(lines.len() >= 5, "{what}: {} lines", lines.len());
    lines
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * expected.abs() + 1e-12
}

fn check(what: &str, test: impl Fn(&[f64], &[f64]) -> realgap_core::Result<SampleTest>) {
    for line in golden(what) {
        let found = test(&line.x, &line.y).unwrap();
        assert!(
            close(found.statistic, line.first) && close(found.p_value, line.second),
            "{what} of {} and {}: {found:?}, expected {} and {}",
            line.x.len(),
            line.y.len(),
            line.first,
            line.second
        );
        let method = match found.method {
            PValueMethod::Exact => "exact",
            PValueMethod::Asymptotic => "asymptotic",
        };
        assert_eq!(method, line.method);
    }
}

#[test]
fn mann_whitney_agrees_with_scipy_with_and_without_ties() {
    check("mann-whitney", mann_whitney);
}

#[test]
fn kolmogorov_smirnov_agrees_with_scipy_with_and_without_ties() {
    check("kolmogorov-smirnov", kolmogorov_smirnov);
}

#[test]
fn spearman_agrees_with_scipy_with_and_without_ties() {
    check("spearman", spearman);
}

#[test]
fn wilson_intervals_agree_with_scipy_and_statsmodels() {
    for line in golden("wilson") {
        let found = Proportion::new(line.x[0] as usize, line.x[1] as usize, line.x[2]);
        assert!(
            close(found.low, line.first) && close(found.high, line.second),
            "{found:?}, expected {} to {}",
            line.first,
            line.second
        );
    }
    let none = Proportion::new(0, 0, 0.95);
    assert_eq!((none.low, none.high), (0.0, 1.0));
}

#[test]
fn quantiles_and_medians_agree_with_numpy() {
    for line in golden("quantile") {
        assert!(close(quantile(&line.x, line.y[0]), line.first));
        assert!(close(median(&line.x), line.second));
    }
    assert!(quantile(&[], 0.5).is_nan());
}

#[test]
fn samples_without_usable_values_are_refused() {
    let errors = [
        mann_whitney(&[], &[1.0]).unwrap_err(),
        mann_whitney(&[1.0], &[f64::NAN]).unwrap_err(),
        kolmogorov_smirnov(&[1.0], &[]).unwrap_err(),
        kolmogorov_smirnov(&[f64::INFINITY], &[1.0]).unwrap_err(),
        spearman(&[1.0, 2.0], &[1.0, 2.0]).unwrap_err(),
        spearman(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0, 4.0]).unwrap_err(),
        spearman(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0]).unwrap_err(),
    ]
    .map(|e| e.to_string());
    for (error, word) in errors.iter().zip([
        "too small",
        "no finite number",
        "too small",
        "no finite number",
        "too small",
        "pairs",
        "equal values",
    ]) {
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn the_test_of_normality_agrees_with_statsmodels() {
    for line in golden("anderson-darling") {
        let found = anderson_darling(&line.x).unwrap();
        assert!(
            (found.statistic - line.first).abs() <= 1e-9 * line.first.abs().max(1.0)
                && (found.p_value - line.second).abs() <= 1e-9,
            "{} values: {found:?}, expected {} and {}",
            line.x.len(),
            line.first,
            line.second
        );
    }
    assert!(anderson_darling(&[1.0; 7]).is_err());
    assert_eq!(anderson_darling(&[1.0; 8]).unwrap().p_value, 0.0);
}

#[test]
fn the_signed_rank_test_agrees_with_scipy_with_and_without_ties() {
    let text = common::read(&common::golden(), "wilcoxon.csv");
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let differences: Vec<f64> = cells[1].split(' ').map(|v| v.parse().unwrap()).collect();
        let test = realgap_core::statistics::wilcoxon_signed_rank(&differences).unwrap();
        let (statistic, p): (f64, f64) = (cells[2].parse().unwrap(), cells[3].parse().unwrap());
        let method = if cells[0] == "exact" {
            PValueMethod::Exact
        } else {
            PValueMethod::Asymptotic
        };
        assert_eq!((test.statistic, test.method), (statistic, method), "{line}");
        assert!(
            (test.p_value - p).abs() < 1e-9,
            "{} {p}: {line}",
            test.p_value
        );
    }
    let still = realgap_core::statistics::wilcoxon_signed_rank(&[0.0, 0.0]).unwrap();
    assert_eq!((still.p_value, still.effect, still.pairs), (1.0, 0.0, 0));
    assert!(realgap_core::statistics::wilcoxon_signed_rank(&[]).is_err());
    assert!(realgap_core::statistics::wilcoxon_signed_rank(&[f64::NAN]).is_err());
}
