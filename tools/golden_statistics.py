"""Writes crates/core/tests/golden/statistics.csv: reference values for crates/core/src/statistics, from scipy, numpy and statsmodels.

pip install numpy==2.4.6 scipy==1.17.1 statsmodels && python3 tools/golden_statistics.py > crates/core/tests/golden/statistics.csv
"""

from itertools import combinations

import numpy as np
from scipy import stats
from statsmodels.stats.diagnostic import normal_ad
from statsmodels.stats.proportion import proportion_confint

rng = np.random.default_rng(1)


def row(what, method, x, y, first, second):
    text = lambda values: " ".join(repr(float(v)) for v in values)
    print(f"{what},{method},{text(x)},{text(y)},{float(first)!r},{float(second)!r}")


def ks_statistic(x, y):
    every = np.union1d(x, y)
    share = lambda s: np.searchsorted(np.sort(s), every, side="right") / len(s)
    return np.abs(share(x) - share(y)).max()


print("what,method,x,y,first,second")
normal = lambda mean, n: np.round(rng.normal(mean, 1.0, n), 6)
tied = lambda low, n: rng.integers(low, low + 5, n).astype(float)
pairs = [
    (normal(0, 1), normal(0, 1)),
    (normal(0, 3), normal(0, 5)),
    (normal(0, 5), normal(2, 4)),
    (normal(0, 8), normal(1, 8)),
    (normal(0, 8), normal(1, 60)),
    (normal(0, 60), normal(1, 7)),
    (normal(0, 20), normal(0.3, 25)),
    (normal(0, 100), normal(4, 90)),
    (np.arange(5.0), np.arange(5.0) + 100),
    (tied(0, 6), tied(1, 7)),
    (tied(0, 30), tied(1, 20)),
    (np.ones(4), np.ones(3)),
]
for x, y in pairs:
    ties = len(np.unique(np.concatenate([x, y]))) < len(x) + len(y)
    # "auto" of scipy: exact where the smaller sample has 8 values or fewer and there are no ties.
    exact = min(len(x), len(y)) <= 8 and not ties
    u = stats.mannwhitneyu(x, y, method="auto")
    row("mann-whitney", "exact" if exact else "asymptotic", x, y, u.statistic, u.pvalue)
    if not ties:
        d = stats.ks_2samp(x, y, method="exact")
        row("kolmogorov-smirnov", "exact", x, y, d.statistic, d.pvalue)
large = (normal(0, 120), normal(0.25, 110))
d = stats.ks_2samp(*large, method="exact").statistic
n = len(large[0]) * len(large[1]) / (len(large[0]) + len(large[1]))
# The limit distribution; "asymp" of scipy is another approximation (kstwo of a rounded n).
row("kolmogorov-smirnov", "asymptotic", *large, d, stats.kstwobign.sf(np.sqrt(n) * d))
# Ties: share of all orders without ties that reach the statistic, which is what scipy calls exact.
x, y = tied(0, 5), tied(1, 6)
d = ks_statistic(x, y)
reached = [ks_statistic(np.array(c), np.setdiff1d(np.arange(11), c)) >= d - 1e-12 for c in combinations(range(11), 5)]
assert np.isclose(np.mean(reached), stats.ks_2samp(x, y, method="exact").pvalue)
row("kolmogorov-smirnov", "exact", x, y, d, np.mean(reached))

for x, y in [
    (normal(0, 3), normal(0, 3)),
    (normal(0, 12), normal(0, 12)),
    (tied(0, 15), tied(0, 15)),
    (np.arange(7.0), np.array([1.0, 2, 3, 5, 4, 7, 6])),
    (np.arange(6.0), -np.arange(6.0)),
]:
    rho = stats.spearmanr(x, y)
    row("spearman", "asymptotic", x, y, rho.statistic, rho.pvalue)

for count, trials, level in [(0, 10, 0.95), (10, 10, 0.95), (3, 20, 0.95), (1, 1, 0.9), (441, 1000, 0.99), (0, 1, 0.5)]:
    low, high = proportion_confint(count, trials, alpha=1 - level, method="wilson")
    other = stats.binomtest(count, trials).proportion_ci(level, method="wilson")
    assert np.allclose([low, high], [other.low, other.high], atol=1e-12)
    row("wilson", "closed form", [count, trials, level], [], other.low, other.high)

for values in [normal(0, 1), normal(0, 2), normal(0, 9), tied(0, 10)]:
    for level in [0.0, 0.05, 0.3, 0.5, 0.9, 1.0]:
        row("quantile", "linear", values, [level], np.quantile(values, level), np.median(values))

# One sample for each branch of the p value, from nearly normal to far from normal.
for values in [
    stats.norm.ppf((np.arange(12) + 0.5) / 12),
    normal(0, 30),
    normal(3, 200),
    np.round(rng.exponential(1.0, 40), 6),
    np.round(rng.uniform(0, 1, 60), 6),
    tied(0, 50),
    np.round(rng.standard_cauchy(400), 6),
]:
    a, p = normal_ad(np.asarray(values))
    row("anderson-darling", "asymptotic", values, [], a, p)
