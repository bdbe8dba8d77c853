"""Writes crates/sensing/tests/golden/survival.json: Kaplan-Meier curves and log-rank tests by scipy, for crates/core/src/statistics/survival.rs.

pip install numpy==2.4.6 scipy==1.17.1 && python3 tools/golden_survival.py > crates/sensing/tests/golden/survival.json
"""

import json

import numpy as np
from scipy import stats

rng = np.random.default_rng(3)


def sample(n, scale, limit):
    times = np.round(rng.exponential(scale, n) + 0.1, 1)  # rounded: ties
    return np.minimum(times, limit), times <= limit


def data(times, finished):
    return stats.CensoredData.right_censored(times, ~finished)


cases = []
for n, m, a, b, limit in [(8, 9, 20, 25, 60), (30, 25, 20, 40, 30), (60, 80, 10, 10, 12), (5, 5, 3, 30, 1000)]:
    x, y = sample(n, a, limit), sample(m, b, limit)
    curve = stats.ecdf(data(*x)).sf
    low, high = (end.probabilities.tolist() for end in curve.confidence_interval(0.9, method="log-log"))
    test = stats.logrank(data(*x), data(*y))
    cases.append({
        "x": [[t, bool(f)] for t, f in zip(*x)],
        "y": [[t, bool(f)] for t, f in zip(*y)],
        "times": curve.quantiles.tolist(),
        "shares": curve.probabilities.tolist(),
        "low": [None if np.isnan(v) else v for v in low],
        "high": [None if np.isnan(v) else v for v in high],
        "statistic": test.statistic,
        "p": test.pvalue,
    })
print(json.dumps(cases))
