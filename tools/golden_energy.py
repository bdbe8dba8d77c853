"""Writes crates/lab/tests/golden/energy.csv: reference values for the energy test of crates/core/src/statistics/energy.rs, from scipy and numpy.

pip install numpy==2.4.6 scipy==1.17.1 && python3 tools/golden_energy.py > crates/lab/tests/golden/energy.csv

Points in `dimensions` dimensions, row by row. In one dimension the energy distance is also that of
scipy.stats.energy_distance (which gives its root). p is exact: the share of all ways to choose the first sample.
"""

from itertools import combinations

import numpy as np
from scipy import stats
from scipy.spatial.distance import cdist

rng = np.random.default_rng(5)


def energy(x, y):
    return 2 * cdist(x, y).mean() - cdist(x, x).mean() - cdist(y, y).mean()


def row(x, y):
    n, m, every = len(x), len(y), np.concatenate([x, y])
    distance = energy(x, y)
    if x.shape[1] == 1:
        assert np.isclose(distance, stats.energy_distance(x[:, 0], y[:, 0]) ** 2, atol=1e-12)
    within = lambda s: cdist(s, s).sum() / (len(s) * (len(s) - 1))
    ratio = cdist(x, y).mean() / (0.5 * (within(x) + within(y)))
    found = [energy(every[list(c)], np.delete(every, list(c), axis=0)) for c in combinations(range(n + m), n)]
    p = np.mean(np.array(found) >= distance - 1e-12)
    text = lambda s: " ".join(repr(float(v)) for v in s.ravel())
    print(f"{x.shape[1]},{text(x)},{text(y)},{float(distance)!r},{float(ratio)!r},{float(p)!r}")


print("dimensions,x,y,distance,ratio,p_value")
draw = lambda mean, spread, n, d: np.round(rng.normal(mean, spread, (n, d)), 4)
row(draw(0, 1, 4, 1), draw(0, 1, 5, 1))
row(draw(0, 1, 5, 1), draw(1.5, 1, 6, 1))
row(draw(0, 1, 6, 2), draw(0, 0.3, 7, 2))
row(draw(0, 1, 3, 3), draw(1, 1, 10, 3))
row(draw(0, 1, 7, 2), draw(0, 1, 6, 2))
row(np.array([[0.0], [1.0], [1.0], [2.0]]), np.array([[1.0], [1.0], [3.0]]))
