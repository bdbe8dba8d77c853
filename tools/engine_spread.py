#!/usr/bin/env python3
"""Measures how the net displacement of robots differs between engines: random robots in both engines of realgap and in MuJoCo, on the
same floor with the same noise.

    python3 -m pip install -r tools/requirements.txt
    python3 tools/engine_spread.py results/engines --seeds 1001 1062

writes results/engines/engines.csv with one row for each robot. docs/validation/ensembles.md states which seeds are in
crates/lab/src/prediction/engines.csv, from which `predict` estimates the effect of another engine, and which seeds test that estimate. Robots
that the folder already contains are not run again.

Robots are drawn one seed after the other (`realgap robot genome random`, as drawn), on a floor whose friction is drawn with the same
seed from 0.3 to 0.7. A robot is kept if it develops, has a hinge, stays in the pose in which it is put down, and moves by at least
`--least` of a body length in Rapier's run without noise; the result of MuJoCo does not affect this choice. MuJoCo runs with the file that
`realgap robot export --format mjcf` writes:
steps of 1/8000 s, implicitfast, elliptic cone, solref 0.002 1, solimp 0.95 0.99 0.001; controls are set every fourth step.
"""

import argparse
import csv
import json
import pathlib
import subprocess

import numpy as np

import record_standin
from standin import Robot

NOISE = """(
    start_position_m: Normal(0.001), start_height_m: Normal(0.001),
    start_tilt_rad: Normal(0.0175), start_heading_rad: Normal(0.0175),
    servo_zero_rad: Normal(0.00436),
)
"""
FIELDS = ["seed", "modules", "friction", "body_length_m", "rapier_m", "rapier_sd_m", "tree_m", "relaxed_m", "sensitivity_m", "mujoco_m"]
BODY_LENGTH_M = 0.058
# Body lengths, the same value as in crates/lab/src/prediction/model.rs.
NOWHERE = 0.1
# Contacts like those of MuJoCo, the same values as `relaxed` in crates/simulation/src/experiment.rs.
RELAXED = ["contact.friction_model=2", "contact.natural_frequency_hz=79.57747154594767", "contact.damping_ratio=1", "timestep_s=0.0005",
           "solver.substeps=1"]


def parser(about, modules, least):
    """The options that all tools share that draw robots by seed."""
    p = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("output", type=pathlib.Path, help="folder: one below it for every robot")
    p.add_argument("--realgap", default="target/release/realgap", help="the program (default %(default)s)")
    p.add_argument("--seeds", type=int, nargs=2, required=True, help="first and last")
    p.add_argument("--modules", type=int, nargs=2, default=modules, help="fewest and most modules (default %(default)s)")
    p.add_argument("--duration", type=float, default=8.0, help="seconds (default %(default)s)")
    p.add_argument("--least", type=float, default=least, help="body lengths that a kept robot goes (default %(default)s)")
    return p


def arguments():
    p = parser(__doc__, [2, 5], 0.1)
    p.add_argument("--repeats", type=int, default=2, help="repeats in MuJoCo (default 2)")
    p.add_argument("--ours", type=int, default=6, help="repeats in each engine of realgap (default 6)")
    return p.parse_args()


def said(a, *words):
    """The answer of the program as JSON; None if it refuses."""
    made = subprocess.run([a.realgap, *map(str, words), "--format", "json"], capture_output=True, text=True)
    return json.loads(made.stdout) if made.returncode == 0 else None


def known(file, make):
    """The JSON of this file, which is made if it does not exist."""
    if not file.exists():
        file.write_text(json.dumps(make()))
    return json.loads(file.read_text())


def drawn(a, seed, folder):
    """The properties of the robot of a seed that decide whether it is kept; None if it cannot be built."""
    genome, robot = folder / "genome.ron", folder / "robot.ron"
    fewest, most = a.modules
    modules = fewest + seed % (most - fewest + 1)
    friction = round(float(np.random.default_rng(seed).uniform(0.3, 0.7)), 2)
    said(a, "robot", "genome", "random", "--modules", modules, "--seed", seed, "-o", genome, "--force")
    built = said(a, "robot", "develop", genome, "-o", robot, "--force")
    if not (built and built["at_rest"] and not built["toppled"] and built["hinges"]):
        return None
    run = said(a, "simulate", robot, "--set", f"floor.friction={friction}", "--duration", a.duration)
    return run and {"far_m": run["net_displacement_m"] or 0.0, "modules": modules, "friction": friction}


def predicted(a, folder, found, engine, *more):
    """Net displacements of repeats in an engine of realgap: their mean and spread."""
    return said(a, "predict", folder / "robot.ron", "--set", f"floor.friction={found['friction']}", "--duration", a.duration,
                "--jobs", 1, "--engine", engine, "--model-error", "off", *more)["prediction"]["displacement_m"]


def in_mujoco(a, folder, found):
    """Net displacement of each repeat, metres."""
    mjcf = folder / "robot.mjcf"
    export = [a.realgap, "robot", "export", folder / "robot.ron", "--format", "mjcf", "-o", mjcf, "--force"]
    subprocess.run(export, check=True, capture_output=True)
    robot = Robot(mjcf)
    robot.set_friction(found["friction"])
    robot.hold = 4
    how = record_standin.arguments([str(mjcf), "-o", str(folder), "--duration", str(a.duration), "--rate", "10",
                                    "--camera-noise", "0", "--camera-angle-noise", "0"])
    paths = [record_standin.record(robot, how, repeat)[1] for repeat in range(a.repeats)]
    return [float(np.linalg.norm(path[-1, :2] - path[0, :2])) for path in paths]


def row(a, seed):
    """The row of a robot in the table; None if it is not kept."""
    folder = a.output / f"{seed:05}"
    folder.mkdir(parents=True, exist_ok=True)
    found = known(folder / "drawn.json", lambda: drawn(a, seed, folder))
    if not found or found["far_m"] < a.least * BODY_LENGTH_M:
        return None
    noise = a.output / "noise.ron"
    noise.write_text(NOISE)
    stated = ["--noise", noise, "--repeats", a.ours]
    rapier = known(folder / "rapier.json", lambda: predicted(a, folder, found, "rapier", *stated))
    # The program makes no statement about a robot that does not move under noise.
    if rapier["mean"] < NOWHERE * BODY_LENGTH_M:
        return None
    tree = known(folder / "tree.json", lambda: predicted(a, folder, found, "tree", *stated))
    settings = [word for setting in RELAXED for word in ("--set", setting)]
    relaxed = known(folder / "relaxed.json", lambda: predicted(a, folder, found, "tree", *stated, *settings))
    # With the default noise preset, and as many repeats as in crates/lab/src/prediction/model.rs.
    felt = known(folder / "felt.json", lambda: predicted(a, folder, found, "tree", "--repeats", 32))
    theirs_m = known(folder / "mujoco.json", lambda: in_mujoco(a, folder, found))[: a.repeats]
    spread = (felt["q75"] - felt["q25"]) / 1.349
    numbers = [rapier["mean"], rapier["standard_deviation"], tree["mean"], relaxed["mean"], spread]
    runs = " ".join(f"{m:.4f}" for m in theirs_m)
    return [seed, found["modules"], found["friction"], BODY_LENGTH_M, *(f"{m:.4f}" for m in numbers), runs]


def main():
    a = arguments()
    a.output.mkdir(parents=True, exist_ok=True)
    table = []
    for seed in range(a.seeds[0], a.seeds[1] + 1):
        kept = row(a, seed)
        if kept:
            table.append(kept)
            print(*kept, sep=",", flush=True)
    with open(a.output / "engines.csv", "w", newline="") as opened:
        csv.writer(opened, lineterminator="\n").writerows([FIELDS, *table])


if __name__ == "__main__":
    main()
