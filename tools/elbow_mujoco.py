"""Fits MuJoCo to the tosses of two hinged boxes, with the same body, the same starts and as many contact parameters as realgap.

    realgap study identify sweeps/elbow_toss_fit.ron --every 2 --recordings DATA/*.csv -o body.ron
    realgap robot export morphologies/elbow.ron --format mjcf --parameters body.ron -o elbow.xml
    realgap study identify sweeps/elbow_toss_fit.ron --parameters body.ron --recordings DATA/*.csv --format json > starts.json
    python tools/elbow_mujoco.py elbow.xml starts.json 'DATA/*.csv' --scale LENGTH_SCALE [--first]
    … --compliant --duration 0.25 --budget 150

Fitted on the even-numbered recordings (in order of their paths, those that end while moving left out after counting),
judged on the odd-numbered ones. Four parameters: friction, time constant and damping ratio of contact, dry friction of the
hinge; with --compliant also frequency and damping ratio of springs in the hinge: five more joints that swing half a box
each, 50 to 400 Hz. With --duration only so many seconds of a toss are fitted; all is judged. Errors as `realgap
evaluate` has them: mean distance in % of 0.1 m, mean rotation and joint angle in degrees.
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
from scipy.spatial.transform import Rotation

STEPS_A_SAMPLE = 10
BODY_LENGTH_M = 0.1


def levelled(toss, lean):
    """The toss rotated about its end until the floor's normal is z, as by `floor_leans` of a study's `reading`."""
    normal = np.array([*lean, 1.0]) / np.linalg.norm([*lean, 1.0])
    turn, _ = Rotation.align_vectors([[0, 0, 1]], [normal])
    q = (turn * Rotation.from_quat(np.roll(toss["q"], -1, axis=1))).as_quat()
    end = toss["p"][-1]
    return {**toss, "p": turn.apply(toss["p"] - end) + end, "q": np.roll(q, 1, axis=1), "v": turn.apply(toss["v"])}


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


def compliant(path):
    """The model with a hinge that gives way along three axes and about two."""
    spec = mujoco.MjSpec.from_file(path)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    hinge = next(j for j in spec.joints if j.type == mujoco.mjtJoint.mjJNT_HINGE)
    slide, turn = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for kind, axis in [(slide, (1, 0, 0)), (slide, (0, 1, 0)), (slide, (0, 0, 1)), (turn, (1, 0, 0)), (turn, (0, 0, 1))]:
        hinge.parent.add_joint(type=kind, axis=axis, pos=hinge.pos)
    return spec.compile()


def give_way(model, frequency_hz, ratio):
    """Sets the stiffness of the springs such that half a box swings with this frequency."""
    mass_kg = model.body_mass[1:].max() / 2
    inertia_kg_m2 = model.body_inertia[1:].max() / 2
    for joint, of in zip(range(2, 7), [mass_kg] * 3 + [inertia_kg_m2] * 2):
        model.jnt_stiffness[joint] = of * (2 * np.pi * frequency_hz) ** 2
        model.dof_damping[joint + 5] = 2 * ratio * of * 2 * np.pi * frequency_hz


def simulate(model, data, toss, start, seconds=np.inf):
    mujoco.mj_resetData(model, data)
    data.qpos[:8] = np.concatenate([start["p"], start["q"], [start["h"]]])
    data.qvel[:7] = np.concatenate([start["v"], start["w"], [start["u"]]])
    model.opt.timestep = (toss["t"][-1] - toss["t"][0]) / (len(toss["t"]) - 1) / STEPS_A_SAMPLE
    poses = np.empty((int((toss["t"] - toss["t"][0] <= seconds).sum()), 8))
    poses[0] = data.qpos[:8]
    for k in range(1, len(poses)):
        for _ in range(STEPS_A_SAMPLE):
            mujoco.mj_step(model, data)
        poses[k] = data.qpos[:8]
    return poses


def errors(poses, toss):
    toss = {key: toss[key][: len(poses)] for key in "pqh"}
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
    parser.add_argument("--lean", type=float, nargs=2, default=(-0.0163, 0.0179), help="floor_leans of the study")
    parser.add_argument("--first", action="store_true", help="start from the first sample as recorded")
    parser.add_argument("--budget", type=int, default=80)
    parser.add_argument("--fit", type=int, default=10**6, help="fit at most so many tosses")
    parser.add_argument("--compliant", action="store_true", help="let the hinge give way")
    parser.add_argument("--duration", type=float, default=np.inf, help="fit the first so many seconds")
    args = parser.parse_args()
    model = compliant(args.model) if args.compliant else mujoco.MjModel.from_xml_path(args.model)
    data = mujoco.MjData(model)
    floor = model.geom("floor").id
    with open(args.starts) as file:
        starts = {s["recording"]: s for s in json.load(file)["starts"]}
    fitted, judged = [], []
    for index, path in enumerate(sorted(glob.glob(args.recordings))):
        toss = levelled(read(path, args.scale), args.lean)
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
        friction, time_constant, damping, dry = np.exp(x[:4])
        model.geom_friction[floor, 0] = friction
        model.geom_solref[floor] = [time_constant, damping]
        model.dof_frictionloss[6] = dry
        if args.compliant:
            give_way(model, *np.exp(x[4:]))

    def score(x, tosses, seconds=np.inf):
        set_up(x)
        return np.array([errors(simulate(model, data, *toss, seconds), toss[0]) for toss in tosses])

    def loss(x):
        e = score(x, fitted, args.duration).mean(axis=0)
        return e[0] / 100 + np.radians(e[1]) + np.radians(e[2])

    began = time.process_time()
    ranges = {"friction": (0.05, 0.5), "time_constant_s": (5e-4, 0.1), "damping_ratio": (0.1, 30), "dry_nm": (1e-5, 0.01)}
    first = [0.2, 0.01, 0.7, 1e-3]
    if args.compliant:
        ranges |= {"bearing_hz": (50, 400), "bearing_ratio": (0.1, 2)}
        first += [200.0, 0.7]
    first = np.log(first)
    simplex = np.array([first] + [first + 0.5 * row for row in np.eye(len(first))])
    best = minimize(loss, first, method="Nelder-Mead", bounds=np.log(list(ranges.values())),
                    options={"maxfev": args.budget, "initial_simplex": simplex, "xatol": 1e-3, "fatol": 1e-4})
    print("fitted on", len(fitted), "tosses:", dict(zip(ranges, np.exp(best.x).round(5).tolist())),
          f"loss {best.fun:.4f}, {best.nfev} evaluations, {time.process_time() - began:.0f} CPU s")
    for name, tosses in [("fitted", fitted), ("judged", judged)]:
        e = score(best.x, tosses)
        spread = e.std(axis=0, ddof=1) / np.sqrt(len(e))
        print(f"{name:7} {len(e):4} tosses: position {e[:, 0].mean():.2f} +- {spread[0]:.2f} %, "
              f"rotation {e[:, 1].mean():.2f} +- {spread[1]:.2f} deg, hinge {e[:, 2].mean():.2f} +- {spread[2]:.2f} deg")


if __name__ == "__main__":
    main()
