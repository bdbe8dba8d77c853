#!/usr/bin/env python3
"""Compares the draws of `realgap` with a reference that knows how the recordings were made: by the log score of the hidden truth.

    cargo build --release && pip install maturin && maturin build --release -m python/Cargo.toml
    python3 -m pip install target/wheels/realgap-*.whl -r tools/requirements-peers.txt
    python3 tools/reference_chain.py target/release/realgap results/chains --studies arm:1 arm:2 chain3:1 chain3:2

`arm`: a Markov chain (adaptive Metropolis, Haario et al. 2001) of runs with the hidden timestep, whose likelihood is that of encoders with
the hidden noise that round (independent from sample to sample; the first 0.3 s, in which the start's own rounding lasts, are left out).
No program that does not know the timestep can be as sure; `--timestep study` has the chain run with the study's, and trust it.

Other worlds, whose repeats differ by their starts so that no likelihood can be written down: recordings of as many truths as
`--worlds-drawn` says are made exactly as the study's were, with hidden engine, timestep and substeps; those that come nearest are kept
and regressed on their distance (approximate Bayesian computation with regression adjustment, Beaumont et al. 2002).

The log score is the mean, over parameters that change the recordings, of the log density at the truth in units of the range: 0 is a
flat density over the range, larger is better. Densities are kernel estimates of 200 draws, with the same rule for all.
"""

import argparse
import csv
import json
import math
import pathlib

import numpy as np

import hidden_worlds
import interval_worlds

CHUNK = 200
SKIPPED_S = 0.3
DRAWS = 200
KEPT_SHARE = 0.05
FEATURES = 8
PATH_POINTS = 40
# Least probability of a reading: one sample that the model cannot make does not end a chain.
LEAST = 1e-9


def cumulative(values):
    """Of the standard normal distribution."""
    return 0.5 * (1 + np.vectorize(math.erf)(values / math.sqrt(2)))


def chain(world, folder, seed, steps, burn_in, is_hidden_timestep):
    """Draws of the parameters, one row each."""
    import peers

    settings = json.loads((folder / "settings.json").read_text())
    simulator = peers.Simulator(world, folder, CHUNK, seed, {"timestep_s": settings["timestep_s"] if is_hidden_timestep else world.timestep_s})
    names = [p.name for p in world.parameters]
    with open(next((folder / "rec").glob("*.csv"))) as file:
        is_used = np.array([float(row["t_s"]) >= SKIPPED_S for row in csv.DictReader(file)])
    noise_steps = settings["encoder_noise_steps"]

    def values(point):
        found = simulator.values(point)
        return np.array([found[name] for name in names])

    def log_posterior(point):
        if np.any(point <= 1e-6) or np.any(point >= 1 - 1e-6):
            return -math.inf
        off = simulator(point).reshape(-1, len(is_used))[:, is_used] / hidden_worlds.ENCODER_RAD
        read = cumulative((0.5 - off) / noise_steps) - cumulative((-0.5 - off) / noise_steps)
        # The prior is uniform in values; a coordinate may follow their logarithm.
        stretch = np.log(values(point + 1e-6) - values(point - 1e-6)).sum()
        return float(np.log(np.maximum(read, LEAST)).sum() + stretch)

    # It starts from the truth, which a reference may know: what it takes to get there is not the question.
    truth = json.loads((folder / "truth.json").read_text())
    low, high = np.zeros(len(names)), np.ones(len(names))
    for _ in range(50):
        middle = (low + high) / 2
        is_below = values(middle) < [truth[name] for name in names]
        low, high = np.where(is_below, middle, low), np.where(is_below, high, middle)
    rng = np.random.default_rng(seed)
    points, logs, accepted = [np.clip((low + high) / 2, 1e-3, 1 - 1e-3)], [], 0

    def walk(_simulator, _seed):
        nonlocal accepted
        try:
            if not logs:
                logs.append(log_posterior(points[0]))
            while len(points) < steps:
                size = len(points)
                if size < 100:
                    step = 0.002 * rng.standard_normal(len(names))
                else:
                    covariance = np.cov(np.array(points[size // 2 :]).T) + 1e-10 * np.eye(len(names))
                    step = rng.multivariate_normal(np.zeros(len(names)), 2.38**2 / len(names) * covariance)
                goal = points[-1] + step
                found = log_posterior(goal)
                is_better = math.log(rng.random()) < found - logs[-1]
                accepted += is_better
                points.append(goal if is_better else points[-1])
                logs.append(found if is_better else logs[-1])
        except peers.Spent:
            pass

    while len(points) < steps:
        simulator.runs = 0
        simulator.fit(walk, seed)
    print(f"chain of {steps} steps: {100 * accepted / steps:.0f} % accepted", flush=True)
    kept = np.array([values(point) for point in points[burn_in:]])
    return kept[rng.choice(len(kept), DRAWS, replace=False)]


def features(folder):
    """The mean path of the repeats of a folder, each turned so that it ends on the x axis."""
    runs = []
    for path in sorted((folder / "rec").glob("*.csv")):
        with open(path) as file:
            rows = list(csv.DictReader(file))
        at = np.linspace(0, len(rows) - 1, PATH_POINTS).round().astype(int)
        xy = np.array([[float(rows[k]["x_m"]), float(rows[k]["y_m"])] for k in at])
        xy -= xy[0]
        turn = math.atan2(xy[-1, 1], xy[-1, 0])
        runs.append((xy @ np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])).ravel())
    return np.mean(runs, axis=0)


def quadratic(z):
    """One, the columns, and their products."""
    return np.concatenate([np.ones((len(z), 1)), z, *[z[:, [k]] * z[:, k:] for k in range(z.shape[1])]], axis=1)


def nearest(world, folder, out, program, count, seed):
    """Draws by approximate Bayesian computation; the recordings are shared by the studies of a world."""
    kept = out / f"{world.name}_drawn.npz"
    if kept.exists() and len(np.load(kept)["truths"]) >= count:
        truths, seen = (np.load(kept)[name][:count] for name in ("truths", "seen"))
    else:
        rng, truths, seen = np.random.default_rng(987654), [], []
        here = out / f"{world.name}_drawn"
        here.mkdir(parents=True, exist_ok=True)
        (here / "robot.ron").write_text(world.robot_ron())
        for k in range(count):
            truth = {p.name: float(rng.uniform(p.low, p.high)) for p in world.parameters}
            for path in (here / "rec").glob("*"):
                path.unlink()
            world.record(world, truth, rng, here, program)
            truths.append(list(truth.values()))
            seen.append(features(here))
            if (k + 1) % 100 == 0:
                print(f"{world.name}: {k + 1} of {count} drawn", flush=True)
        truths, seen = np.array(truths), np.array(seen)
        np.savez(kept, truths=truths, seen=seen)
    real = features(folder)
    middle = seen.mean(axis=0)
    _, sizes, axes = np.linalg.svd(seen - middle, full_matrices=False)
    scores, goal = (seen - middle) @ axes[:FEATURES].T, (real - middle) @ axes[:FEATURES].T
    # Parameters as functions of the path are the summary (Fearnhead and Prangle 2012): quadratic regression.
    low, span = np.array([p.low for p in world.parameters]), np.array([p.high - p.low for p in world.parameters])
    unit = (truths - low) / span
    scale = scores.std(axis=0)
    fitted, *_ = np.linalg.lstsq(quadratic(scores / scale), unit, rcond=None)
    summaries, wanted = quadratic(scores / scale) @ fitted, quadratic((goal / scale)[None]) @ fitted
    distance = np.linalg.norm((summaries - wanted) / summaries.std(axis=0), axis=1)
    chosen = np.argsort(distance)[: max(int(KEPT_SHARE * count), 30)]
    weights = np.sqrt(1 - (distance[chosen] / distance[chosen].max()) ** 2 + 1e-9)
    design = np.concatenate([np.ones((len(chosen), 1)), summaries[chosen] - wanted], axis=1)
    # Regression of the logit keeps draws within the ranges.
    logit = np.log(unit[chosen] / (1 - unit[chosen]))
    slopes, *_ = np.linalg.lstsq(design * weights[:, None], logit * weights[:, None], rcond=None)
    adjusted = 1 / (1 + np.exp(-(logit - design[:, 1:] @ slopes[1:])))
    rng = np.random.default_rng(seed)
    return low + span * adjusted[rng.choice(len(chosen), DRAWS, p=weights**2 / (weights**2).sum())]


def log_density(values, low, high, truth):
    """Log of a kernel density at the truth in units of the range, reflected at its ends; never below that of one draw in a thousand."""
    unit, at = (np.asarray(values) - low) / (high - low), (truth - low) / (high - low)
    spread = min(unit.std(), (np.quantile(unit, 0.75) - np.quantile(unit, 0.25)) / 1.349) or unit.std()
    width = max(0.9 * spread * len(unit) ** -0.2, 1e-6)
    mirrored = np.concatenate([unit, -unit, 2 - unit])
    density = np.exp(-0.5 * ((at - mirrored) / width) ** 2).sum() / (len(unit) * width * math.sqrt(2 * math.pi))
    return math.log(max(density, 1e-3))


def ours(program, world, folder, method):
    """The draws of an answer, by name."""
    how = ["sweep"] if method == "sweep" else ["tune", "--optimizer", method]
    hidden_worlds.run_program([program, how[0], folder / "study.ron", *how[1:], "--jobs", 1, "--no-report", "--restart", "-o", folder / method])
    found, weights = interval_worlds.draws(folder / method)
    chosen = np.random.default_rng(1).choice(len(weights), DRAWS, p=np.array(weights) / sum(weights))
    return {name: np.array(values)[chosen] for name, values in found.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the binary `realgap`")
    parser.add_argument("out", type=pathlib.Path, help="folder of the studies and of what is drawn once for a world")
    parser.add_argument("--studies", nargs="+", default=["arm:1", "arm:2", "chain3:1", "chain3:2"], metavar="WORLD:SEED",
                        help="[default: arm:1 arm:2 chain3:1 chain3:2]")
    parser.add_argument("--steps", type=int, default=20000, help="of a chain, a fifth of which is left out [default: 20000]")
    parser.add_argument("--timestep", choices=["hidden", "study"], default="hidden",
                        help="of the chain's runs: the one of the recordings, or the study's own [default: hidden]")
    parser.add_argument("--worlds-drawn", type=int, default=4000, help="recordings for worlds without a likelihood [default: 4000]")
    options = parser.parse_args()
    program, out = options.program.resolve(), options.out.resolve()
    lines = []
    for word in options.studies:
        name, seed = word.split(":")
        world, seed, folder = hidden_worlds.WORLDS[name], int(seed), out / f"{name}_{seed}"
        truth = hidden_worlds.make(world, seed, folder, program)
        kept = folder / f"reference_{options.timestep}.json"
        if kept.exists():
            reference = np.array(json.loads(kept.read_text()))
        else:
            reference = (chain(world, folder, seed, options.steps, options.steps // 5, options.timestep == "hidden") if name == "arm" else
                         nearest(world, folder, out, program, options.worlds_drawn, seed))
            kept.write_text(json.dumps(reference.tolist()) + "\n")
        found = {"reference": {p.name: reference[:, k] for k, p in enumerate(world.parameters)}}
        for method, family in interval_worlds.METHODS.items():
            if family in world.families:
                found[method] = ours(program, world, folder, method)
        acting = [p for p in world.parameters if p.kind == "acts"]
        for method, by_name in found.items():
            scores = [log_density(by_name[p.name], p.low, p.high, truth[p.name]) for p in acting]
            widths = [(np.quantile(by_name[p.name], 0.95) - np.quantile(by_name[p.name], 0.05)) / (p.high - p.low) for p in acting]
            held = sum(np.quantile(by_name[p.name], 0.05) <= truth[p.name] <= np.quantile(by_name[p.name], 0.95) for p in acting)
            lines.append([word, method, f"{np.mean(scores):+.2f}", f"{held}/{len(acting)}", f"{np.median(widths):.4f}"])
    print(interval_worlds.table(["study", "draws of", "mean log score", "truths within 5 to 95 %", "median width"], lines))


if __name__ == "__main__":
    main()
