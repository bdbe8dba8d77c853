#!/usr/bin/env python3
"""A sweep by the command and from Python, in turns: CPU seconds of each process, and the same bytes.

    python tools/time_python.py target/release/realgap [PAIRS [POINTS]]

Needs the package `realgap` (docs/python.md), built like the command.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

STUDY = "sweeps/tripod_floor.ron"
SWEEP = """
import sys, realgap
realgap.Study.read(sys.argv[1], points=int(sys.argv[2])).sweep(jobs=1, folder=sys.argv[3])
"""


def cpu_s(words):
    """CPU seconds of a process, from its start to its end."""
    before = os.times()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = os.times()
    return (after.children_user - before.children_user) + (
        after.children_system - before.children_system
    )


def main():
    command = sys.argv[1]
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    points = sys.argv[3] if len(sys.argv) > 3 else "6"
    idle = min(cpu_s([sys.executable, "-c", "import realgap"]) for _ in range(3))
    ratios = []
    for pair in range(pairs):
        with tempfile.TemporaryDirectory() as folder:
            one, other = Path(folder) / "command", Path(folder) / "python"
            words = [command, "sweep", STUDY, "--points", points, "--jobs", "1", "-o", str(one)]
            theirs = cpu_s(words)
            ours = cpu_s([sys.executable, "-c", SWEEP, STUDY, points, str(other)])
            same = (one / "points.csv").read_bytes() == (other / "points.csv").read_bytes()
        ratios.append(ours / theirs)
        print(f"command {theirs:.2f} s, Python {ours:.2f} s, ratio {ours / theirs:.3f}, same bytes: {same}")
    print(f"median ratio {statistics.median(ratios):.3f}; of it, starting Python: {idle:.2f} s")


if __name__ == "__main__":
    main()
