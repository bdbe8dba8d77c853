"""Reference values of the metric `pca-whitened`: scikit-learn's OAS covariance and a dense inverse.

    python tools/golden_whitened.py > crates/path/tests/golden/whitened.json

Needs numpy and scikit-learn. crates/path/tests/whitened.rs makes the same paths from the same formula.
"""

import json

import numpy as np
from sklearn.covariance import OAS

POINTS = 182
TRACKER_NOISE_M = 1e-3


def path(number):
    """A path from the origin that differs for every number."""
    t = np.arange(POINTS) / (POINTS - 1)
    x = (0.5 + 0.03 * np.sin(1.7 * number)) * t + 0.01 * np.sin(2 * np.pi * t * (1 + number % 3))
    y = 0.02 * np.cos(2.3 * number) * np.sin(np.pi * t) + 0.004 * number * t * (1 - t)
    return np.concatenate([x, y])


def main():
    found = []
    for recordings in (2, 3, 8, 40):
        real = np.stack([path(k) for k in range(recordings)])
        fitted = OAS().fit(real)
        ruler = fitted.covariance_ + TRACKER_NOISE_M**2 * np.eye(2 * POINTS)
        inverse = np.linalg.inv(ruler)
        squared = lambda a, b: (a - b) @ inverse @ (a - b)
        pairs = [squared(a, b) for i, a in enumerate(real) for b in real[:i]]
        unit = np.sqrt(np.mean(pairs))
        other = 1.2 * path(100)
        found.append(
            {
                "recordings": recordings,
                "shrinkage": fitted.shrinkage_,
                "distance": np.sqrt(squared(real[0], other)) / unit,
                "between_recordings": np.sqrt(squared(real[0], real[1])) / unit,
            }
        )
    print(json.dumps(found, indent=2))


main()
