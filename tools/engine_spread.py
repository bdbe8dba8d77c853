#!/usr/bin/env python3
"""How far do two engines part? Random robots in realgap and in MuJoCo, the same floor and the same noise.

    python3 -m pip install -r tools/requirements.txt
    python3 tools/engine_spread.py --realgap target/release/realgap -o results/engine_spread

Robots are drawn (`realgap genome random`), and those that develop, stand and go somewhere in realgap are kept: at least
--least of a body length. One row a robot: mean net displacement of the repeats in MuJoCo and in both engines of realgap, the length
of realgap's path, and the difference of the displacements as a share of it, which is what `predict` adds as the error between
engines (crates/lab/src/prediction/model.rs). None of the shipped stand-ins takes part. `--first-seed` draws other robots.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys

import numpy as np

NOISE = """(
    start_position_m: Normal(0.001), start_height_m: Normal(0.001),
    start_tilt_rad: Normal(0.0175), start_heading_rad: Normal(0.0175),
    servo_zero_rad: Normal(0.00436),
)
"""


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--realgap", default="target/release/realgap")
    p.add_argument("-o", "--output", type=pathlib.Path, required=True)
    p.add_argument("--robots", type=int, default=19, help="robots to keep (default 19)")
    p.add_argument("--repeats", type=int, default=6, help="repeats in each engine (default 6)")
    p.add_argument("--first-seed", type=int, default=1)
    p.add_argument("--modules", type=int, nargs=2, default=[2, 5], help="fewest and most modules (default 2 5)")
    p.add_argument("--friction", type=float, default=0.5)
    p.add_argument("--duration", type=float, default=10.0)
    p.add_argument("--least", type=float, default=1.0, help="body lengths (default 1)")
    return p.parse_args()


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)


def net_displacement(file):
    with open(file, newline="") as opened:
        rows = list(csv.DictReader(opened))
    first, last = rows[0], rows[-1]
    return np.hypot(*(float(last[c]) - float(first[c]) for c in ("x_m", "y_m")))


def mean_and_path_in_realgap(a, robot, noise, *more):
    found = run(a.realgap, "predict", robot, "--set", f"floor.friction={a.friction}", "--noise", noise,
                "--repeats", a.repeats, "--duration", a.duration, "--jobs", 1, "--format", "json", *a.off, *more)
    if found.returncode != 0:
        return None
    prediction = json.loads(found.stdout)["prediction"]
    far = prediction["displacement_m"]["mean"]
    path = prediction["path_length_m"]["mean"]
    return (far, path) if far >= a.least * prediction["body_length_m"] else None


def mean_in_mujoco(a, robot, folder):
    mjcf = folder / "robot.mjcf"
    run(a.realgap, "export", robot, "--format", "mjcf", "-o", mjcf)
    runs = folder / "mujoco"
    tool = pathlib.Path(__file__).parent / "record_standin.py"
    made = run(sys.executable, tool, mjcf, "-o", runs, "--friction", a.friction, "--repeats", a.repeats,
               "--duration", a.duration, "--camera-noise", 0, "--camera-angle-noise", 0)
    if made.returncode != 0:
        sys.exit(made.stderr)
    return np.mean([net_displacement(file) for file in sorted(runs.glob("run_*.csv"))])


def main():
    a = arguments()
    # Only the displacement under the usual settings is wanted.
    a.off = ["--model-error", "off"] if "--model-error" in run(a.realgap, "predict", "--help").stdout else []
    a.output.mkdir(parents=True, exist_ok=True)
    noise = a.output / "noise.ron"
    noise.write_text(NOISE)
    print("| seed | realgap, m | tree solver, m | path, m | MuJoCo, m | difference, share of the path |\n|---|---|---|---|---|---|")
    shares, seed = [], a.first_seed - 1
    while len(shares) < a.robots:
        seed += 1
        folder = a.output / f"robot_{seed:03}"
        folder.mkdir(exist_ok=True)
        genome, robot = folder / "genome.ron", folder / "robot.ron"
        run(a.realgap, "genome", "random", "--modules", a.modules[0] + seed % (a.modules[1] - a.modules[0] + 1), "--seed", seed, "-o", genome)
        if run(a.realgap, "develop", genome, "-o", robot).returncode != 0 or not robot.exists():
            continue
        ours = mean_and_path_in_realgap(a, robot, noise)
        if ours is None:
            continue
        theirs = mean_in_mujoco(a, robot, folder)
        tree = mean_and_path_in_realgap(a, robot, noise, "--set", "solver.engine=1")
        tree = f"{tree[0]:.3f}" if tree else "-"
        far, path = ours
        shares.append((theirs - far) / path)
        print(f"| {seed} | {far:.3f} | {tree} | {path:.3f} | {theirs:.3f} | {shares[-1]:+.3f} |", flush=True)
    print("\nshares, sorted:", ", ".join(f"{s:+.3f}" for s in sorted(shares)))


if __name__ == "__main__":
    main()
