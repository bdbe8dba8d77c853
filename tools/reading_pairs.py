"""Reads the same recordings with realgap, evo and pandas, in turn, and prints the CPU seconds of each.

evo (`file_interface.read_tum_trajectory_file`) checks quaternions and times as realgap does; pandas (`read_csv`, its C parser)
only makes numbers of text. Needs `pip install evo pandas` and realgap's Python package. The files are made here.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np


def recording(rows):
    """Times, positions and unit quaternions of a winding path, one row per sample."""
    t = np.arange(rows) * 0.01
    random = np.random.default_rng(1)
    x, y = np.cumsum(random.normal(scale=1e-3, size=(2, rows)), axis=1)
    half = np.sin(t / 50) / 2
    columns = [t, x, y, 0.1 + 1e-4 * np.sin(t), 0 * t, 0 * t, np.sin(half), np.cos(half)]
    return np.stack(columns, axis=1)


def cheapest(read, path, times):
    """CPU seconds of the cheapest of several readings: noise of the machine only adds."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        read(path)
        seconds.append(time.process_time() - start)
    return min(seconds)


def main():
    """Writes the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rows", type=int, nargs="+", default=[10_000, 100_000, 400_000])
    arguments.add_argument("--times", type=int, default=7)
    arguments = arguments.parse_args()
    readers = {}
    try:
        import realgap

        readers["realgap"] = realgap.Trajectory.read
    except ImportError:
        sys.exit("realgap's Python package is not installed: build it as python/README.md says")
    try:
        from evo.tools import file_interface

        readers["evo"] = lambda path: file_interface.read_tum_trajectory_file(str(path)) if path.suffix == ".tum" else None
    except ImportError:
        print("SKIPPED evo: it is not installed")
    try:
        import pandas

        separator = {".tum": " ", ".csv": ","}
        readers["pandas"] = lambda path: pandas.read_csv(path, sep=separator[path.suffix], header=None if path.suffix == ".tum" else 0)
    except ImportError:
        print("SKIPPED pandas: it is not installed")
    print("| rows | file | " + " | ".join(readers) + " |")
    with tempfile.TemporaryDirectory() as folder:
        for rows in arguments.rows:
            table = recording(rows)
            tum, csv = Path(folder, "path.tum"), Path(folder, "path.csv")
            np.savetxt(tum, table, fmt="%.6f")
            np.savetxt(csv, table, fmt="%.6f", delimiter=",", header="t_s,x_m,y_m,z_m,qx,qy,qz,qw", comments="")
            for path in (tum, csv):
                cells = []
                for name, read in readers.items():
                    skipped = name == "evo" and path == csv
                    cells.append("" if skipped else f"{cheapest(read, path, arguments.times):.3f}")
                print(f"| {rows} | {path.suffix[1:]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
