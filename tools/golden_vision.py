"""Writes crates/vision/tests/golden/vision.json: results of scikit-image and scipy for pictures that both sides make by the same formulas.

pip install numpy==2.4.6 scipy==1.17.1 scikit-image && python3 tools/golden_vision.py > crates/vision/tests/golden/vision.json
"""

import json
import sys

import numpy as np
import scipy
import skimage
from scipy import signal
from skimage.feature import canny, match_template
from skimage.filters import gaussian, threshold_otsu
from skimage.segmentation import active_contour


def texture(width, height):
    """A pattern of whole numbers, so that both sides have the same bits."""
    y, x = np.mgrid[:height, :width].astype(np.int64)
    return ((x * x * 7 + y * y * 13 + x * y * 5 + 31 * x + 17 * y) % 256).astype(np.float32) / np.float32(255.0)


def ellipse(width, height, cx, cy, a, b, inside, outside):
    """An ellipse; each pixel at the border is the mean of 8 x 8 samples."""
    y, x = np.mgrid[:height, :width].astype(float)
    covered = np.zeros((height, width))
    for i in range(8):
        for j in range(8):
            dx, dy = (i + 0.5) / 8 - 0.5, (j + 0.5) / 8 - 0.5
            covered += ((x + dx - cx) / a) ** 2 + ((y + dy - cy) / b) ** 2 <= 1.0
    covered /= 64
    return (outside + (inside - outside) * covered).astype(np.float32)


def direct(picture, template):
    """Normalised correlation by its definition, with scipy.signal's direct correlation."""
    p, t = picture.astype(float), template.astype(float)
    t = t - t.mean()
    ones = np.ones_like(t)
    inner = signal.correlate(p, t, mode="valid", method="direct")
    mean = signal.correlate(p, ones, mode="valid", method="direct") / t.size
    squares = signal.correlate(p * p, ones, mode="valid", method="direct")
    return inner / np.sqrt((squares - t.size * mean**2) * (t**2).sum())


def matching(width, height, x, y, w, h):
    picture = texture(width, height)
    template = picture[y : y + h, x : x + w] * np.float32(0.5)
    template[0, 0] = 1.0
    library = match_template(picture.astype(float), template.astype(float))
    plain = direct(picture, template)
    assert np.abs(library - plain).max() < 1e-9, np.abs(library - plain).max()
    rng = np.random.default_rng(1)
    places = [(int(rng.integers(plain.shape[1])), int(rng.integers(plain.shape[0]))) for _ in range(60)]
    return {
        "picture": [width, height],
        "template": [x, y, w, h],
        "places": [[px, py, float(library[py, px]), float(plain[py, px])] for px, py in places],
        "sum": float(plain.sum()),
    }


def snakes(name, cx, cy, a, b):
    picture = ellipse(200, 160, cx, cy, a, b, 0.2, 0.9)
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    start = np.array([cy + 1.4 * b * np.sin(turn), cx + 1.4 * a * np.cos(turn)]).T
    found = active_contour(gaussian(picture, 1.5), start, alpha=0.01, beta=0.01, gamma=0.01, max_num_iter=5000)
    fine = np.linspace(0, 2 * np.pi, 20000)
    outline = np.array([cy + b * np.sin(fine), cx + a * np.cos(fine)]).T
    distances = [np.hypot(*(outline - p).T).min() for p in found]
    return {"name": name, "ellipse": [cx, cy, a, b], "mean_distance_px": float(np.mean(distances))}


shapes = ellipse(120, 100, 60.3, 48.7, 33.2, 21.9, 0.3, 0.7)
edges = canny(shapes.astype(float), sigma=1.4, low_threshold=0.1, high_threshold=0.2, mode="nearest")
json.dump(
    {
        "made_with": {"scikit-image": skimage.__version__, "scipy": scipy.__version__, "numpy": np.__version__},
        "matching": [matching(90, 70, 30, 22, 13, 9), matching(700, 600, 501, 488, 40, 64)],
        "gauss": [float(v) for v in gaussian(texture(90, 70).astype(float), 1.4, mode="nearest", truncate=4.0)[::10, ::9].ravel()],
        "otsu": float(threshold_otsu(shapes.astype(float), nbins=256)),
        "canny": [[int(x), int(y)] for y, x in np.argwhere(edges)],
        "snakes": [snakes("disc", 101.3, 78.6, 40.0, 40.0), snakes("ellipse", 99.6, 80.2, 52.0, 31.0)],
    },
    sys.stdout,
    indent=1,
)
