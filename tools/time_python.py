#!/usr/bin/env python3
"""Runs a sweep by the command and from Python in turns, compares CPU seconds and result bytes, and measures the cost of callbacks.

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


CALLBACKS = """
import math, time
import numpy as np, realgap

def least(work):
    times = []
    for _ in range(5):
        begun = time.process_time()
        work()
        times.append(time.process_time() - begun)
    return min(times)

robot = realgap.Robot.read("morphologies/tripod.ron")
gait = lambda t_s: {hinge: 0.6 * math.sin(6.3 * t_s) for hinge in robot.hinges}
run = lambda **how: least(lambda: realgap.simulate(robot, duration_s=10.0, **how))
asked = least(lambda: realgap._simulation._commands(gait, 10.0, 240.0))
print(f"a gait of 3 hinges, asked 2401 times: {1e3 * asked:.1f} ms of a run of {1e3 * run():.0f} ms")

names = [f"real_trajectories/tripod_standin/run_0{k}.csv" for k in range(2)]
real, simulated = (realgap.Trajectory.read(name) for name in names)
rms = lambda a, b: float(np.sqrt(((a - b) ** 2).sum(axis=1).mean()))
many = [simulated] * 300
pair = lambda metric: least(lambda: realgap.compare(real, many, metric=metric)) / len(many)
more = pair(realgap.Metric("own", rms)) - pair("rms")
print(f"a metric of one line of numpy: {1e6 * more:.0f} microseconds a call more than one in Rust")
"""


def main():
    command = sys.argv[1]
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    points = sys.argv[3] if len(sys.argv) > 3 else "6"
    subprocess.run([sys.executable, "-c", CALLBACKS], check=True)
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
    if not ratios:
        return
    print(f"median ratio {statistics.median(ratios):.3f}; of it, starting Python: {idle:.2f} s")


if __name__ == "__main__":
    main()
