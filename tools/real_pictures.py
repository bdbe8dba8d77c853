"""Writes scikit-image's bundled photographs into a folder and prints the share of edge pixels that its Canny detector finds.

pip install scikit-image && python3 tools/real_pictures.py FOLDER
for each: realgap sense vision extract FOLDER/NAME.png --extractor edges -o FOLDER/NAME_edges.png
"""

import sys
from pathlib import Path

import numpy as np
from skimage import data, feature, io

folder = Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
for name in ("camera", "coins", "text", "astronaut"):
    picture = getattr(data, name)()
    io.imsave(folder / f"{name}.png", picture, check_contrast=False)
    grey = picture.astype(float) / 255
    if grey.ndim == 3:
        grey = grey @ np.array([0.2125, 0.7154, 0.0721])
    edges = feature.canny(grey, sigma=1.4, low_threshold=0.1, high_threshold=0.2, mode="nearest")
    print(f"{name}: {100 * edges.mean():.2f} % of the pixels are on edges")
