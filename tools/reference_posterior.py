#!/usr/bin/env python3
"""Computes what the recordings of closed-form worlds leave open by brute force, and prints it beside the intervals of `realgap`.

    python3 -m pip install numpy==2.4.6
    python3 tools/interval_worlds.py target/release/realgap results/worlds --worlds ball puck pend --seeds 1 20
    python3 tools/reference_posterior.py results/worlds

For every study of `ball`, `puck` and `pend` in the folder, the likelihood of the recordings is evaluated on a grid of the closed-form
physics of tools/hidden_worlds.py, with the noise that was added (Gaussian: 1 mm of a camera along the slope's x axis, which is what the
metric `rms` sees; 0.4 steps of an encoder and its rounding). The grid zooms in until it resolves what is left. The prior is uniform over
the ranges; an interval of 90 % leaves 5 % on either side. The ratio of a table is the median over studies of (width of realgap's interval
/ width of the exact one). The exact interval knows the physics without a timestep: where the program's timestep moves the recordings by
more than their noise, as at 1/480 s in `pend`, an interval that holds the truth has to be wider.
"""

import argparse
import collections
import csv
import json
import math
import pathlib
import statistics

import numpy as np

import hidden_worlds
import interval_worlds

POINTS = {1: 401, 2: 61}
# Points whose log likelihood is further below the best one than this have no weight in what follows.
KEPT = 14.0
ROUNDS = 12
# Slopes and frictions of the ball's grid: the slope of a ball that rolls is known to 1e-4.
BALL_POINTS = (40001, 301)


def columns(path):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def recordings(folder):
    return [columns(path) for path in sorted((folder / "rec").glob("*.csv"))]


def puck(runs):
    def log_likelihood(friction):
        total = 0.0
        for run in runs:
            path_m = hidden_worlds.puck_path_m(run["t_s"][1:], run["vx_m_s"][0], friction[..., None])
            total = total - 0.5 * (((run["x_m"][1:] - run["x_m"][0] - path_m) / hidden_worlds.CAMERA_M) ** 2).sum(axis=-1)
        return total

    return ["floor.friction"], log_likelihood, sum(len(run["t_s"]) - 1 for run in runs)


def pend(runs):
    [run] = runs
    sd_rad = hidden_worlds.ENCODER_RAD * math.sqrt(hidden_worlds.ENCODER_NOISE_STEPS**2 + 1 / 12)

    def log_likelihood(viscous, dry):
        angles = hidden_worlds.pendulum_angles_rad(run["t_s"], run["swing_rad"][0], viscous, dry, 1.0, 2e-4)
        return -0.5 * (((np.moveaxis(angles, 0, -1) - run["swing_rad"]) / sd_rad)[..., 1:] ** 2).sum(axis=-1)

    return ["hinge.viscous_nm_s_rad", "hinge.dry_nm"], log_likelihood, len(run["t_s"]) - 1


def quantile(at, weights, share):
    """Of a density that is given at evenly spaced points, with straight lines between the sums."""
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (weights[1:] + weights[:-1]))])
    return float(np.interp(share * sums[-1], sums, at))


def zoomed(world, runs):
    """Density of each parameter on a grid that zooms in until it resolves what the likelihood leaves."""
    names, log_likelihood, samples = {"puck": puck, "pend": pend}[world.name](runs)
    box = [next((p.low, p.high) for p in world.parameters if p.name == name) for name in names]
    for _ in range(ROUNDS):
        axes = [np.linspace(low, high, POINTS[len(names)]) for low, high in box]
        found = log_likelihood(*np.meshgrid(*axes, indexing="ij"))
        # A grid that is too coarse misses the peak, whose log likelihood is about -samples / 2: then more points are kept.
        missed = max(-found.max() - samples / 2, 0.0)
        near = np.argwhere(found > found.max() - KEPT - 3 * missed)
        smaller = []
        for k, axis in enumerate(axes):
            first, last = max(near[:, k].min() - 2, 0), min(near[:, k].max() + 2, len(axis) - 1)
            smaller.append((axis[first], axis[last]))
        shrunk = min((high - low) / (b - a) for (low, high), (a, b) in zip(smaller, box))
        box = smaller
        if shrunk > 0.6:
            break
    if missed > 3 * math.sqrt(samples / 2):
        raise RuntimeError(f"the grid of {world.name} does not reach the peak of the likelihood: it is {missed:.0f} below what noise alone makes")
    weights = np.exp(found - found.max())
    return {name: (axes[k], weights.sum(axis=tuple(j for j in range(len(names)) if j != k))) for k, name in enumerate(names)}


def ball(world, runs):
    """Density of both parameters. The path is c t^2 whatever slope and friction, so that the recordings are an estimate of c."""
    t2 = runs[0]["t_s"][1:] ** 2
    estimate = np.mean([(run["x_m"][1:] - run["x_m"][0]) @ t2 / (t2 @ t2) for run in runs])
    sd = hidden_worlds.CAMERA_M / math.sqrt(len(runs) * (t2 @ t2))
    slope, friction = (np.linspace(p.low, p.high, points) for p, points in zip(world.parameters, BALL_POINTS))
    found = np.empty(BALL_POINTS[::-1])
    for row, one in zip(found, friction):
        c = hidden_worlds.ball_path_m(1.0, slope, one) * np.cos(slope)
        row[:] = -0.5 * ((c - estimate) / sd) ** 2
    weights = np.exp(found - found.max())
    return {"floor.slope_rad": (slope, weights.sum(axis=0)), "floor.friction": (friction, weights.sum(axis=1))}


EXACT = {"puck": zoomed, "ball": ball, "pend": zoomed}


def exact_intervals(world, folder):
    """The interval of 90 % of each parameter that the likelihood knows."""
    densities = EXACT[world.name](world, recordings(folder))
    return {name: [quantile(at, weights, 0.05), quantile(at, weights, 0.95)] for name, (at, weights) in densities.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path, help="folder of tools/interval_worlds.py, with studies.csv")
    parser.add_argument("--seeds", nargs=2, type=int, default=[0, 10**9], metavar=("A", "B"), help="first and last seed [default: all]")
    options = parser.parse_args()
    rows = [row for row in interval_worlds.read_rows(options.out / "studies.csv")
            if row["world"] in EXACT and row["verdicts"] and row["family"] != "peer" and options.seeds[0] <= int(row["seed"]) <= options.seeds[1]]
    kept = options.out / "exact.json"
    known = json.loads(kept.read_text()) if kept.exists() else {}
    ratios, held, widths = collections.defaultdict(list), collections.defaultdict(dict), collections.defaultdict(dict)
    for row in rows:
        study = f"{row['world']}_{row['seed']}"
        if study not in known:
            known[study] = exact_intervals(hidden_worlds.WORLDS[row["world"]], options.out / study)
            kept.write_text(json.dumps(known, indent=1) + "\n")
        for v in interval_worlds.verdicts_of([row]):
            if v.name in known[study]:
                low, high = known[study][v.name]
                held[row["world"], v.name][study] = low <= v.truth <= high
                widths[row["world"], v.name][study] = high - low
                ratios[row["world"], v.name, row["family"]].append((v.width / max(high - low, 1e-300), v.held))
    lines = []
    for (world, name, family), found in sorted(ratios.items()):
        exact = held[world, name].values()
        lines.append([world, name, f"{sum(exact)}/{len(exact)}", f"{statistics.median(widths[world, name].values()):.3g}", family,
                      f"{sum(is_held for _, is_held in found)}/{len(found)}", f"{statistics.median(ratio for ratio, _ in found):.2f}"])
    head = ["world", "parameter", "exact: held", "exact: median width", "methods", "realgap: held", "median ratio of widths"]
    print(interval_worlds.table(head, lines))


if __name__ == "__main__":
    main()
