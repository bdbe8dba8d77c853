#!/usr/bin/env python3
"""Compares walking robots on the floor and over steps in Rapier, in the tree solver and in MuJoCo.

    python3 -m pip install -r tools/requirements.txt
    python3 tools/step_engines.py --realgap target/release/realgap

Every robot walks from rest for 10 s over the step of arenas/step.ron, made as high as `--heights` says; 0 is a floor without the step. The same file goes to
MuJoCo (`robot export --format mjcf --arena`). Printed are where the tracked module ends without noise, relative to its start, and how high it then is; and the
net displacement over repeats with the noise of `predict`: the 90 % range that `predict` states for a run in another engine, from its table, and the runs of
MuJoCo with the same draws that `predict --other-engine mujoco` asks for.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from standin import Robot

ROOT = pathlib.Path(__file__).resolve().parent.parent


def said(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"error: {' '.join(map(str, command))} failed:\n{done.stderr}")
    return done.stdout


def arena(folder, height_m, width_m):
    """The file of an arena with one step ahead of the robot: a plate, or a ridge as wide as stated; without a step where its height is 0."""
    path = folder / f"step_{height_m * 1000:g}_{width_m * 1000:g}.ron"
    near_m = 1.15
    half_m = 0.5 * width_m
    step = (
        f'(name: "plate", centre_m: ({near_m + half_m}, 1.0), half_m: ({half_m}, 0.95), height_m: {height_m}, friction: 0.5)'
        if height_m > 0
        # Far away, because an arena without anything around a robot is refused.
        else '(name: "plate", centre_m: (90.0, 90.0), half_m: (0.1, 0.1), height_m: 0.001, friction: 0.5)'
    )
    path.write_text(
        '(name: "step", size_m: (3.0, 2.0), boundary: Open, '
        f"start: (x_m: 1.0, y_m: 1.0, heading_deg: 180.0), steps: [{step}])\n"
    )
    return path


def in_mujoco(folder, a, robot, plan):
    """Where the tracked module ends without noise, metres from its start."""
    file = folder / "robot.mjcf"
    said([a.realgap, "robot", "export", robot, "--format", "mjcf", "--arena", plan, "-o", file])
    walker = Robot(file)
    walker.hold = 4
    data = walker.place()
    walker.settle(data)
    _, positions, _ = walker.walk(data, a.duration, 30.0)
    return positions[-1] - positions[0]


def in_realgap(a, robot, plan, engine):
    text = said([a.realgap, "simulate", robot, "--arena", plan, "--duration", a.duration, "--set", f"solver.engine={engine}", "--format", "json"])
    return np.array(json.loads(text)["net_displacement_world_m"])


def predicted(a, robot, plan, who):
    command = [a.realgap, "predict", robot, "--arena", plan, "--duration", a.duration, "--repeats", a.repeats, "--seed", a.seed]
    return json.loads(said([*command, "--other-engine", who, "--python", sys.executable, "--format", "json"]))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--realgap", type=pathlib.Path, required=True)
    p.add_argument("--robots", type=pathlib.Path, nargs="+", default=[ROOT / "morphologies/tripod.ron", ROOT / "morphologies/chain3.ron"])
    p.add_argument("--heights", type=float, nargs="+", default=[0.0, 0.005, 0.01], help="m")
    p.add_argument("--width", type=float, default=1.7, help="of the step along the way, m")
    p.add_argument("--duration", type=float, default=10.0, help="s")
    p.add_argument("--repeats", type=int, default=100)
    p.add_argument("--seed", type=int, default=1)
    a = p.parse_args()
    print("| robot, step | Rapier | tree | MuJoCo | range for another engine | MuJoCo's runs | within |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for robot in a.robots:
            for height_m in a.heights:
                plan = arena(folder, height_m, a.width)
                ends = [in_realgap(a, robot, plan, engine) for engine in (0, 1)] + [in_mujoco(folder, a, robot, plan)]
                table = predicted(a, robot, plan, "table")["model"]["further_run_m"]
                runs = np.array(predicted(a, robot, plan, "mujoco")["model"]["third_opinion"]["runs_m"])
                held = np.count_nonzero((runs >= table["low"]) & (runs <= table["high"]))
                cells = [" ".join(f"{1000 * v:.0f}" for v in end) for end in ends]
                cells.append(f"{1000 * table['low']:.0f} to {1000 * table['high']:.0f}")
                cells.append(f"{1000 * runs.min():.0f} to {1000 * runs.max():.0f}, mean {1000 * runs.mean():.0f}")
                cells.append(f"{held} of {len(runs)}")
                print(f"| {robot.stem}, {1000 * height_m:g} mm | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
