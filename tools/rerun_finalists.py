#!/usr/bin/env python3
"""The finalists of `realgap search` once more, in MuJoCo: does what was found walk in another engine, too?

    realgap search sweeps/best_robot.ron -o results/best_robot
    python3 -m pip install -r tools/requirements.txt
    python3 tools/rerun_finalists.py results/best_robot

Every robot of RESULTS/best is run from its .xml, without noise, and compared with the run without noise of its prediction card. `--tolerance` says how
much the displacement may change; RESULTS/best/mujoco.json holds the same as the table. The engines differ in friction and contact softness, and a
chaotic gait amplifies this: not to survive here is a warning, not a proof.
"""

import argparse
import json
import math
import pathlib

import mujoco
import numpy as np

from standin import Robot

TIMESTEP_S = 1 / 1000


def rerun(mjcf, duration_s):
    """Net displacement in the plane, metres."""
    robot = Robot(mjcf)
    robot.model.opt.timestep = TIMESTEP_S
    data = robot.place()
    robot.settle(data)
    _, positions, _ = robot.walk(data, duration_s, 60)
    moved = positions[-1] - positions[0]
    return math.hypot(moved[0], moved[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path, help="folder of a search")
    parser.add_argument("--tolerance", type=float, default=0.25, help="largest change, as a share [default: 0.25]")
    options = parser.parse_args()
    summary = json.loads((options.results / "summary.json").read_text())
    best = options.results / "best"
    rows = []
    for robot in summary["best"]:
        card = json.loads((best / f"{robot['file']}.json").read_text())
        here_m = card["prediction"]["noise_free_displacement_m"]
        there_m = rerun(best / f"{robot['file']}.xml", summary["duration_s"])
        survives = here_m is not None and abs(there_m - here_m) <= options.tolerance * here_m
        quantiles = card["prediction"]["displacement_m"]
        within = quantiles is not None and quantiles["q05"] <= there_m <= quantiles["q95"]
        rows.append({"robot": robot["file"], "realgap_m": here_m, "mujoco_m": there_m, "survives": bool(survives), "within_90_percent": bool(within)})
    print(f"MuJoCo {mujoco.__version__}, {1 / TIMESTEP_S:.0f} Hz, without noise, {summary['duration_s']} s")
    print(f"{'robot':<24} {'realgap':>9} {'MuJoCo':>9}  survives  within the predicted 90 %")
    for row in rows:
        here = "-" if row["realgap_m"] is None else f"{row['realgap_m']:.3f} m"
        print(f"{row['robot']:<24} {here:>9} {row['mujoco_m']:>7.3f} m  {'yes' if row['survives'] else 'NO':<8}  {'yes' if row['within_90_percent'] else 'no'}")
    text = json.dumps({"mujoco": mujoco.__version__, "numpy": np.__version__, "timestep_s": TIMESTEP_S, "tolerance": options.tolerance, "robots": rows}, indent=2)
    (best / "mujoco.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
