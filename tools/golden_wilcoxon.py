"""Writes crates/core/tests/golden/wilcoxon.csv: scipy's signed-rank test, for crates/core/src/statistics/paired.rs.

pip install numpy==2.4.6 scipy==1.17.1 && python3 tools/golden_wilcoxon.py > crates/core/tests/golden/wilcoxon.csv
"""

from itertools import product

import numpy as np
from scipy import stats

rng = np.random.default_rng(1)


def row(method, d, statistic, p):
    print(f"{method},{' '.join(repr(float(v)) for v in d)},{float(statistic)!r},{float(p)!r}")


def every_sign(d):
    """The exact test with ties, by its definition: all combinations of signs are equally likely."""
    d = d[d != 0]
    ranks = stats.rankdata(np.abs(d))
    above = ranks[d > 0].sum()
    far = abs(above - ranks.sum() / 2)
    sums = np.array([ranks[np.array(s, bool)].sum() for s in product([0, 1], repeat=len(d))])
    return above, np.mean(np.abs(sums - ranks.sum() / 2) >= far - 1e-9)


print("method,differences,statistic,p_value")
for n, shift in [(1, 0), (5, 1), (8, 0), (8, 1.5), (20, 0.4), (50, 0.3)]:
    d = np.round(rng.normal(shift, 1.0, n), 6)
    both = stats.wilcoxon(d, method="exact")
    above = stats.wilcoxon(d, method="exact", alternative="greater").statistic
    row("exact", d, above, both.pvalue)
for n in (6, 9, 12):
    d = rng.integers(-2, 5, n).astype(float)
    row("exact", d, *every_sign(d))
for d in (np.round(rng.normal(0.2, 1.0, 80), 6), rng.integers(-3, 5, 90).astype(float)):
    both = stats.wilcoxon(d, method="asymptotic", correction=False)
    above = stats.wilcoxon(d, method="asymptotic", alternative="greater", correction=False).statistic
    row("asymptotic", d, above, both.pvalue)
