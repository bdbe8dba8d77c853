#!/usr/bin/env python3
"""Fits the same recordings with as many runs by `realgap` and by others: scipy's least squares, CMA-ES (pycma) and Optuna's TPE.

    cargo build --release && pip install maturin && maturin build --release -m python/Cargo.toml
    python3 -m pip install target/wheels/realgap-*.whl -r tools/requirements-peers.txt
    python3 tools/peers.py target/release/realgap results/peers --seeds 1 6
    python3 tools/peers.py target/release/realgap results/peers --summary

Worlds and recordings are those of tools/hidden_worlds.py. All peers call the simulator of the Python package `realgap`, one run with the
study's own settings for each point, and minimise the squares of the errors (of the path in the plane, or of the joints), which least
squares sees one by one. A method that is done before its runs are spent starts again elsewhere (least squares) or goes on. Least squares
has forward differences of 1e-3 of the range and states intervals of 90 % from its Jacobian (Gaussian, errors taken as independent);
the other peers state none. `realgap` is asked as tools/interval_worlds.py asks it; `sweep` spends the runs of its grid.

The error of the best is the root mean square of (best - truth) / range over the parameters that change the recordings. OUT/studies.csv
gets one row per fit, so that a run that was interrupted goes on. A peer that is not installed is named as SKIPPED. `sbi` is not
supported: a peer of neural networks was not available where this was written.
"""

import argparse
import importlib
import json
import math
import pathlib
import queue
import statistics
import threading
import time

import numpy as np

import hidden_worlds
import interval_worlds

OURS = ("sweep", "cma-es", "nelder-mead", "bayesian", "gauss-newton")
PEERS = {"scipy least_squares": "scipy", "pycma": "cma", "optuna TPE": "optuna", "sbi": "sbi"}
DIFFERENCE = 1e-3
NORMAL_95 = 1.6448536269514722
FAR_ERROR = 1e3


class Spent(Exception):
    """All runs are used."""


class Simulator:
    """Errors of single samples at points whose coordinates run from 0 to 1; it counts its runs.

    `realgap` is the one that asks an optimizer. So a peer works in a thread of its own: its points wait in `asked` until they are asked
    for, and it waits for the errors in `told`.
    """

    def __init__(self, world, folder, budget, seed, settings=None):
        import realgap

        self.realgap, self.budget, self.dimensions, self.runs = realgap, budget, len(world.parameters), 0
        self.asked, self.told, self.seen = queue.SimpleQueue(), queue.SimpleQueue(), []
        self.best, self.best_point = math.inf, None
        text = world.study_ron(seed % 2 == 0, "" if "score:" in world.study else ", score: Single").replace('metric: "joints"', 'metric: "rms"')
        if 'metric: "joints"' in world.study:
            pose_joints(folder)
            text = text.replace("rec/*.csv", "rec_posed/*.csv")
        metric = realgap.Metric("errors", self.errors, whole=True)
        self.study = realgap.Study.from_text(text, folder=folder, metric=metric, seed=seed, set=settings)
        self.recordings = len(self.study.recordings)

    def errors(self, real, simulated):
        """Remembers the errors; the recordings are compared in their order."""
        joints = [name for name in real.joints or {} if not name.endswith("_command")]
        if joints:
            found = [simulated.joints[name].angles_rad - real.joints[name].angles_rad for name in joints]
        else:
            found = [(simulated.positions_m - real.positions_m)[:, :2].ravel()]
        found = np.concatenate(found)
        self.seen.append(found)
        return float(np.sqrt(np.mean(found**2)))

    def __call__(self, point):
        if self.runs >= self.budget:
            raise Spent
        self.runs += 1
        point = np.clip(np.asarray(point, float), 0.0, 1.0)
        self.asked.put([float(x) for x in point])
        found = self.told.get()
        if not np.isfinite(found).all():
            found = np.full(len(found), FAR_ERROR)
        cost = float(found @ found)
        if cost < self.best:
            self.best, self.best_point = cost, point.copy()
        return found

    def fit(self, peer, seed):
        """What the peer returns."""
        answers = []

        def work():
            try:
                answers.append(peer(self, seed))
            finally:
                self.asked.put(None)

        thread = threading.Thread(target=work)
        thread.start()
        # One point more than the peer has, because the last one is told when another is asked for.
        self.study.tune(optimizer=self.realgap.Optimizer("peer", lambda *_: Relay(self), design=0), budget=self.budget + 1, jobs=1)
        thread.join()
        if not answers:
            raise RuntimeError("the peer failed; its error stands above")
        return answers[0]

    def values(self, point):
        """Values by name: a coordinate follows the logarithm of a parameter that spans orders of magnitude."""
        return self.study.values([float(x) for x in point])


class Relay:
    """Passes points and errors between the peer's thread and the run."""

    def __init__(self, simulator):
        self.simulator = simulator

    def ask(self):
        self.simulator.seen.clear()
        point = self.simulator.asked.get()
        return [] if point is None else [point]

    def tell(self, points, scores):
        if len(points):
            self.simulator.told.put(np.concatenate(self.simulator.seen[: self.simulator.recordings]))


def pose_joints(folder):
    """Recordings of joints with a pose that stands still, because a metric in Python is given a motion."""
    for path in sorted((folder / "rec").glob("*.csv")):
        lines = path.read_text().splitlines()
        head, rows = lines[0].split(",", 1), [line.split(",", 1) for line in lines[1:]]
        there = folder / "rec_posed" / path.name
        there.parent.mkdir(exist_ok=True)
        there.write_text("\n".join([f"{head[0]},x_m,y_m,z_m,qw,qx,qy,qz,{head[1]}", *(f"{t},0,0,0,1,0,0,0,{rest}" for t, rest in rows)]) + "\n")


def least_squares(simulator, seed):
    """Trust region least squares from the middle, then from random points; intervals from the Jacobian nearest to the best point."""
    from scipy.optimize import least_squares as fit

    rng = np.random.default_rng(seed)
    jacobians = []

    def jacobian(point):
        middle = simulator(point)
        columns = []
        for k in range(simulator.dimensions):
            step = DIFFERENCE if point[k] < 0.5 else -DIFFERENCE
            moved = np.array(point, float)
            moved[k] += step
            columns.append((simulator(moved) - middle) / step)
        jacobians.append((np.array(point), middle, np.array(columns).T))
        return jacobians[-1][2]

    start = np.full(simulator.dimensions, 0.5)
    try:
        while True:
            fit(simulator, start, jac=jacobian, bounds=(0.0, 1.0))
            start = rng.random(simulator.dimensions)
    except Spent:
        pass
    best = simulator.best_point
    if not jacobians:
        return best, None
    _, errors, slopes = min(jacobians, key=lambda one: float(np.linalg.norm(one[0] - best)))
    variance = simulator.best / max(len(errors) - simulator.dimensions, 1)
    # A direction that changes nothing has no end: its standard deviation is cut at the range.
    sd = np.sqrt(np.diag(np.linalg.pinv(slopes.T @ slopes + 1e-12 * np.eye(simulator.dimensions)) * variance))
    return best, [[float(max(b - NORMAL_95 * s, 0.0)), float(min(b + NORMAL_95 * s, 1.0))] for b, s in zip(best, sd)]


def pycma(simulator, seed):
    import cma

    try:
        while True:
            walk = cma.CMAEvolutionStrategy([0.5] * simulator.dimensions, 0.3, {"bounds": [0, 1], "seed": seed, "verbose": -9})
            while not walk.stop():
                points = walk.ask()
                walk.tell(points, [float(np.sum(simulator(point) ** 2)) for point in points])
            seed += 1
    except Spent:
        return simulator.best_point, None


def tpe(simulator, seed):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    names = [str(k) for k in range(simulator.dimensions)]

    def objective(trial):
        return float(np.sum(simulator([trial.suggest_float(name, 0.0, 1.0) for name in names]) ** 2))

    study.optimize(objective, n_trials=simulator.budget)
    return simulator.best_point, None


FITS = {"scipy least_squares": least_squares, "pycma": pycma, "optuna TPE": tpe}


def missing(method):
    """Why a peer is skipped; None where it is there."""
    if method not in FITS:
        return "not supported by this script"
    try:
        importlib.import_module(PEERS[method])
        importlib.import_module("realgap")
    except ImportError as error:
        return str(error)
    return None


def ask_peer(world, seed, method, out, program, budget):
    """A fit of a peer, as a row of studies.csv."""
    row = {"world": world.name, "seed": seed, "method": method, "family": "peer"}
    began, cpu_s = time.monotonic(), time.process_time()
    try:
        here = out / f"{world.name}_{seed}"
        truth = hidden_worlds.make(world, seed, here, program)
        simulator = Simulator(world, here, budget, seed)
        best, intervals = simulator.fit(FITS[method], seed)
        values, verdicts = simulator.values(best), []
        ends = [simulator.values(side) for side in zip(*intervals)] if intervals else []
        for p in world.parameters:
            piece = [end[p.name] for end in ends] or [p.low, p.high]
            verdicts.append({"name": p.name, "kind": p.kind, "range": [p.low, p.high], "feasible": world.feasible(p, truth), "truth": truth[p.name],
                             "best": values[p.name], "pieces": [piece], "identified": bool(intervals), "rank": None, "text": ""})
        row.update(score=math.sqrt(simulator.best), cpu_s=round(time.process_time() - cpu_s, 3), verdicts=json.dumps(verdicts))
    except (RuntimeError, KeyError, ValueError, OSError) as error:
        row["error"] = f"{type(error).__name__}: {error}"
    row["wall_s"] = round(time.monotonic() - began, 3)
    return row


def best_error(row):
    """Root mean square of the error of the best, in shares of the range."""
    acting = [v for v in interval_worlds.verdicts_of([row]) if v.kind == "acts"]
    return math.sqrt(statistics.mean(((v.best - v.truth) / (v.range[1] - v.range[0])) ** 2 for v in acting))


def summary(rows, worlds):
    lines = []
    for world in worlds:
        of_world = [row for row in rows if row["world"] == world and row["verdicts"]]
        errors = {method: [best_error(row) for row in of_world if row["method"] == method] for method in (*OURS, *PEERS)}
        least = min((statistics.median(errors[method]) for method in PEERS if errors[method]), default=None)
        for method in (m for m in errors if errors[m]):
            acting = [v for v in interval_worlds.verdicts_of([row for row in of_world if row["method"] == method]) if v.kind == "acts"]
            states = any(v.identified for v in acting) or method in OURS
            middle = statistics.median(errors[method])
            lines.append([world, method, len(errors[method]), f"{100 * middle:.3f} %", f"{100 * statistics.mean(errors[method]):.3f} %",
                          f"{middle / least:.2f}" if least else "-", f"{sum(v.held for v in acting)}/{len(acting)}" if states else "-",
                          f"{statistics.median(v.share for v in acting):.4f}" if states else "-"])
    head = ["world", "method", "studies", "median error of the best", "mean", "of the best peer's median", "intervals held", "median width"]
    return interval_worlds.table(head, lines) + "".join(f"\nFAILED {row['world']} {row['seed']} {row['method']}: {row['error'].splitlines()[-1]}"
                                                        for row in rows if row["error"])


def main():
    named = ["puck", "ball", "pend", "arm"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the binary `realgap`")
    parser.add_argument("out", type=pathlib.Path, help="folder of the studies and of studies.csv")
    parser.add_argument("--worlds", nargs="+", choices=named, default=named, help=f"of {', '.join(named)} [default: all]")
    parser.add_argument("--seeds", nargs=2, type=int, default=[1, 6], metavar=("A", "B"), help="first and last seed [default: 1 6]")
    parser.add_argument("--budget", type=int, default=100, help="runs of every method [default: 100]")
    parser.add_argument("--jobs", type=int, default=1, help="studies at a time [default: 1]; CPU times of peers are true for 1 alone")
    parser.add_argument("--summary", action="store_true", help="print the tables of OUT/studies.csv, and fit nothing")
    options = parser.parse_args()
    path, program, out = options.out / "studies.csv", options.program.resolve(), options.out.resolve()
    skipped = {method: why for method in PEERS if (why := missing(method))}
    for method, why in skipped.items():
        print(f"SKIPPED {method}: {why}")
    if not options.summary:
        tasks = []
        for seed in range(options.seeds[0], options.seeds[1] + 1):
            for world in (hidden_worlds.WORLDS[name] for name in options.worlds):
                for method in OURS:
                    if interval_worlds.METHODS[method] in world.families:
                        tasks.append(((world.name, seed, method),
                                      lambda w=world, s=seed, m=method: interval_worlds.ask(program, w, s, m, out, options.budget, True)))
                for method in (m for m in PEERS if m not in skipped):
                    tasks.append(((world.name, seed, method), lambda w=world, s=seed, m=method: ask_peer(w, s, m, out, program, options.budget)))
        interval_worlds.run_all(tasks, path, options.jobs)
    print(summary(interval_worlds.read_rows(path), options.worlds))


if __name__ == "__main__":
    main()
