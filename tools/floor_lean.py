"""Measures the inclination of the floor's normal in recordings of a box that comes to rest: the `floor_leans` of a study's `reading`.

python tools/floor_lean.py '../shared/data/elbow_tosses/*.csv'

Every second recording (the even-numbered ones) is used. If it ends at rest with the box flat on a face of its z axis, the normal
of that face is the normal of the floor, whatever the heading of the box.
"""

import csv
import glob
import math
import statistics
import sys

# A box that is inclined by more than 8 degrees does not lie flat.
FLAT_COSINE = 0.99


def at_rest(rows):
    """Whether the box is slower than 3 cm/s and the hinge slower than 0.5 rad/s over the last five samples."""
    step_s = rows[1]["t_s"] - rows[0]["t_s"]
    last = rows[-6:]
    moved = max(abs(b[a] - c[a]) for b, c in zip(last[1:], last) for a in ("x_m", "y_m", "z_m"))
    return moved / step_s < 0.03 and max(abs(row["hinge_rad_s"]) for row in rows[-5:]) < 0.5


normals = []
for path in sorted(glob.glob(sys.argv[1]))[::2]:
    with open(path) as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    w, x, y, z = (rows[-1][name] for name in ("qw", "qx", "qy", "qz"))
    face = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    if at_rest(rows) and abs(face[2]) > FLAT_COSINE:
        normals.append((face[0] / face[2], face[1] / face[2]))
for axis, leans in zip("xy", zip(*normals)):
    error = statistics.stdev(leans) / math.sqrt(len(leans))
    print(f"along {axis}: {statistics.mean(leans):+.4f} ± {error:.4f} ({len(leans)} recordings)")
