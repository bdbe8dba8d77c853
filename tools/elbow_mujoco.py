"""MuJoCo on the tosses of two hinged boxes: the same body, the same starts and as many contact parameters as realgap.

    realgap identify sweeps/elbow_toss_fit.ron --every 2 --recordings DATA/*.csv -o body.ron
    realgap export morphologies/elbow.ron --format mjcf --parameters body.ron -o elbow.xml
    realgap identify sweeps/elbow_toss_fit.ron --parameters body.ron --recordings DATA/*.csv --format json > starts.json
    python tools/elbow_mujoco.py elbow.xml starts.json 'DATA/*.csv' --scale LENGTH_SCALE [--first]

Fitted on the even-numbered recordings (in order of their paths, those that end while moving left out after counting),
judged on the odd-numbered ones. Four parameters: friction, time constant and damping ratio of contact, dry friction of the
hinge. Errors as `realgap evaluate` has them: mean distance in % of 0.1 m, mean rotation and joint angle in degrees.
Needs mujoco, numpy, scipy.
"""

import argparse
import csv
import glob
import json
import time
from pathlib import Path

import mujoco
import numpy as np
from scipy.optimize import minimize

STEPS_A_SAMPLE = 10
BODY_LENGTH_M = 0.1


def read(path, scale):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    column = lambda name: np.array([float(row[name]) for row in rows])
    return {
        "name": Path(path).stem,
        "t": column("t_s"),
        "p": np.stack([column(f"{a}_m") for a in "xyz"], axis=1) / scale,
        "q": np.stack([column(f"q{a}") for a in "wxyz"], axis=1),
        "h": column("hinge_rad"),
        "v": np.stack([column(f"v{a}_m_s") for a in "xyz"], axis=1) / scale,
        "w": np.stack([column(f"w{a}_rad_s") for a in "xyz"], axis=1),
        "u": column("hinge_rad_s"),
    }


def simulate(model, data, toss, start):
    mujoco.mj_resetData(model, data)
    data.qpos[:] = np.concatenate([start["p"], start["q"], [start["h"]]])
    data.qvel[:] = np.concatenate([start["v"], start["w"], [start["u"]]])
    model.opt.timestep = (toss["t"][-1] - toss["t"][0]) / (len(toss["t"]) - 1) / STEPS_A_SAMPLE
    poses = np.empty((len(toss["t"]), 8))
    poses[0] = data.qpos
    for k in range(1, len(poses)):
        for _ in range(STEPS_A_SAMPLE):
            mujoco.mj_step(model, data)
        poses[k] = data.qpos
    return poses


def errors(poses, toss):
    distance = np.linalg.norm(poses[:, :3] - toss["p"], axis=1).mean() / BODY_LENGTH_M
    dot = np.abs((poses[:, 3:7] * toss["q"]).sum(axis=1)).clip(0, 1)
    turn = (2 * np.arccos(dot)).mean()
    hinge = poses[:, 7] - toss["h"]
    hinge = np.abs(hinge - 2 * np.pi * np.round(hinge / (2 * np.pi))).mean()
    return 100 * distance, np.degrees(turn), np.degrees(hinge)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("model")
    parser.add_argument("starts")
    parser.add_argument("recordings")
    parser.add_argument("--scale", type=float, default=1.0, help="recorded lengths over true ones")
    parser.add_argument("--first", action="store_true", help="start from the first sample as recorded")
    parser.add_argument("--budget", type=int, default=80)
    parser.add_argument("--fit", type=int, default=10**6, help="fit at most so many tosses")
    args = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(args.model)
    data = mujoco.MjData(model)
    floor = model.geom("floor").id
    with open(args.starts) as file:
        starts = {s["recording"]: s for s in json.load(file)["starts"]}
    fitted, judged = [], []
    for index, path in enumerate(sorted(glob.glob(args.recordings))):
        toss = read(path, args.scale)
        if toss["name"] not in starts:
            continue
        found = starts[toss["name"]]
        start = {
            "p": np.array(found["position_world_m"]) / args.scale,
            "q": np.array(found["orientation_world_from_body_wxyz"]),
            "h": found["joint_angles_rad"][0],
            "v": np.array(found["velocity_world_m_s"]) / args.scale,
            "w": np.array(found["angular_velocity_body_rad_s"]),
            "u": found["joint_speeds_rad_s"][0],
        }
        if args.first:
            start = {key: toss[key][0] for key in "pqhvwu"}
        (judged if index % 2 else fitted).append((toss, start))
    fitted = fitted[: args.fit]

    def set_up(x):
        friction, time_constant, damping, dry = np.exp(x)
        model.geom_friction[floor, 0] = friction
        model.geom_solref[floor] = [time_constant, damping]
        model.dof_frictionloss[6] = dry

    def score(x, tosses):
        set_up(x)
        all_errors = np.array([errors(simulate(model, data, *toss), toss[0]) for toss in tosses])
        return all_errors

    def loss(x):
        e = score(x, fitted).mean(axis=0)
        return e[0] / 100 + np.radians(e[1]) + np.radians(e[2])

    began = time.process_time()
    first = np.log([0.2, 0.01, 0.7, 1e-3])
    simplex = np.array([first] + [first + 0.5 * row for row in np.eye(4)])
    best = minimize(loss, first, method="Nelder-Mead",
                    options={"maxfev": args.budget, "initial_simplex": simplex, "xatol": 1e-3, "fatol": 1e-4})
    print("fitted on", len(fitted), "tosses:", dict(zip(["friction", "time_constant_s", "damping_ratio", "dry_nm"], np.exp(best.x).round(5))),
          f"loss {best.fun:.4f}, {best.nfev} evaluations, {time.process_time() - began:.0f} CPU s")
    for name, tosses in [("fitted", fitted), ("judged", judged)]:
        e = score(best.x, tosses)
        spread = e.std(axis=0, ddof=1) / np.sqrt(len(e))
        print(f"{name:7} {len(e):4} tosses: position {e[:, 0].mean():.2f} +- {spread[0]:.2f} %, "
              f"rotation {e[:, 1].mean():.2f} +- {spread[1]:.2f} deg, hinge {e[:, 2].mean():.2f} +- {spread[2]:.2f} deg")


if __name__ == "__main__":
    main()
