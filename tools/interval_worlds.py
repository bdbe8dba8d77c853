#!/usr/bin/env python3
"""Counts how often the intervals of `realgap` hold truths that were hidden from it, world by world and method by method.

    cargo build --release
    python3 -m pip install numpy==2.4.6
    python3 tools/interval_worlds.py target/release/realgap results/worlds --seeds 1 6
    python3 tools/interval_worlds.py target/release/realgap results/worlds --summary

tools/hidden_worlds.py says what the worlds are. Every study is asked by every method, at default settings (optimizers with a budget of
100). OUT/studies.csv gets one row per answer, so that a run that was interrupted goes on; OUT/WORLD_SEED keeps the study with its
recordings and answers (--lean deletes the answers). --summary prints the tables from OUT/studies.csv and asks nothing. A row belongs to
the program that made it: use another OUT for another program.

What is counted, for parameters that change the recordings, alone or by a ratio:
- held: the truth is in the interval of the verdict, or in one of its pieces;
- far: the truth is more than three widths outside;
- best outside: the best point lies outside of its own interval;
- wide: called determined, with an interval over half of the range;
- width: median width of the interval as a share of the range;
- ranks: chi-square of the truth's rank among the draws in ten bins (uniform where draws are right: 9 on average, 21.7 once in 100).
Of parameters that change nothing, and of those of which only ratios do, `false` counts how many were called determined. A parameter
of a ratio counts only where its interval is narrower than half of what the ranges of the others leave open.
"""

import argparse
import collections
import concurrent.futures
import csv
import json
import math
import pathlib
import shutil
import statistics
import threading
import time

import hidden_worlds

LEVEL = 0.9
METHODS = {"sweep": "sweep", "cma-es": "walkers", "nelder-mead": "walkers", "bayesian": "walkers", "gauss-newton": "least squares"}
FAMILIES = ("sweep", "walkers", "least squares")
COLUMNS = ["world", "seed", "method", "family", "states_noise", "explains", "score", "cpu_s", "wall_s", "error", "verdicts"]
BINS = 10


def pieces(verdict):
    """The interval of a verdict as a list of [low, high]: it may be one interval, several, or absent."""
    interval = verdict.get("intervals") or verdict.get("pieces") or verdict.get("interval")
    if not interval:
        return [[verdict["low"], verdict["high"]]]
    return [list(piece) for piece in interval] if isinstance(interval[0], (list, tuple)) else [list(interval)]


def draws(folder):
    """Draws of the posterior: (values by parameter, weights), from the table beside the answer."""
    path = folder / "indistinguishable.csv"
    if not path.exists():
        return {}, []
    with open(path) as file:
        rows = list(csv.DictReader(file))
    weights = [float(row.get("weight") or 1.0) for row in rows]
    return {name: [float(row[name]) for row in rows] for name in (rows[0] if rows else []) if name != "weight"}, weights


def rank(values, weights, truth):
    """Share of the draws below the truth; draws that equal it count half. None where there are no draws."""
    if not values:
        return None
    below = sum(w for v, w in zip(values, weights) if v < truth) + 0.5 * sum(w for v, w in zip(values, weights) if v == truth)
    return below / sum(weights)


def read_answer(world, truth, answer, folder):
    """One dict per parameter of the study."""
    drawn, weights = draws(folder)
    rows = []
    for verdict in answer["verdicts"]:
        parameter = next(p for p in world.parameters if p.name == verdict["parameter"])
        feasible = world.feasible(parameter, truth)
        rows.append({"name": parameter.name, "kind": parameter.kind, "range": [parameter.low, parameter.high], "feasible": feasible,
                     "truth": truth[parameter.name], "best": answer["best"]["parameters"][parameter.name], "pieces": pieces(verdict),
                     "identified": verdict["identified"], "rank": rank(drawn.get(parameter.name), weights, truth[parameter.name]),
                     "text": verdict["text"]})
    return rows


def ask(program, world, seed, method, out, budget, lean):
    """One answer of the program to one study; a row of studies.csv."""
    row = {"world": world.name, "seed": seed, "method": method, "family": METHODS[method], "states_noise": int(seed % 2 == 0 and bool(world.noise))}
    here = out / f"{world.name}_{seed}"
    began = time.monotonic()
    try:
        truth = hidden_worlds.make(world, seed, here, program)
        how = ["sweep"] if method == "sweep" else ["tune", "--optimizer", method, "--budget", budget]
        answer_folder = here / method
        text = hidden_worlds.run_program([program, how[0], here / "study.ron", *how[1:], "--jobs", 1, "--no-report", "--restart",
                                          "-o", answer_folder, "--format", "json"])
        answer = json.loads(text)
        fit = answer.get("fit") or {}
        row.update(explains=fit.get("explains"), score=answer["best"]["score"], cpu_s=json.loads((answer_folder / "timing.json").read_text())["cpu_s"],
                   verdicts=json.dumps(read_answer(world, truth, answer, answer_folder)))
        if lean:
            shutil.rmtree(answer_folder)
    except (RuntimeError, KeyError, ValueError, OSError) as error:
        row["error"] = f"{type(error).__name__}: {error}"
    row["wall_s"] = round(time.monotonic() - began, 3)
    return row


def read_rows(path):
    if not path.exists():
        return []
    csv.field_size_limit(10**8)
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    # A study that failed is asked again by the next run: its last row counts.
    return list({(row["world"], int(row["seed"]), row["method"]): row for row in rows}.values())


def run_all(tasks, path, jobs):
    """Asks what studies.csv does not hold yet. `tasks` are (key, function without arguments)."""
    known = {(row["world"], int(row["seed"]), row["method"]) for row in read_rows(path) if not row["error"]}
    open_tasks = [(key, task) for key, task in tasks if key not in known]
    path.parent.mkdir(parents=True, exist_ok=True)
    is_new, lock = not path.exists(), threading.Lock()
    with open(path, "a", newline="") as file, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        writer = csv.DictWriter(file, COLUMNS, restval="")
        if is_new:
            writer.writeheader()

        def one(number, task):
            row = task()
            with lock:
                writer.writerow(row)
                file.flush()
                said = row.get("error") or f"{row['cpu_s']:.1f} CPU s"
                print(f"{number} of {len(open_tasks)}: {row['world']} {row['seed']} {row['method']}: {said}", flush=True)

        # The studies of one world and seed share a folder: they are made one after the other.
        groups = collections.defaultdict(list)
        for number, (key, task) in enumerate(open_tasks, 1):
            groups[key[:2]].append((number, task))
        for done in [pool.submit(lambda group: [one(*task) for task in group], group) for group in groups.values()]:
            done.result()


def binomial_tail(successes, trials, share, upper):
    """Probability of at least (upper) or at most so many successes."""
    counts = range(successes, trials + 1) if upper else range(successes + 1)
    return sum(math.comb(trials, k) * share**k * (1 - share) ** (trials - k) for k in counts)


def agrees(held, trials, share=LEVEL, tail=0.001):
    """Whether the exact binomial 99.8 % interval of held / trials contains the share."""
    return binomial_tail(held, trials, share, True) > tail and binomial_tail(held, trials, share, False) > tail


class Verdict:
    """One parameter of one answer, as it is counted."""

    def __init__(self, fields):
        self.__dict__.update(fields)
        self.width = sum(high - low for low, high in self.pieces)
        self.share = self.width / (self.range[1] - self.range[0])
        self.held = any(low <= self.truth <= high for low, high in self.pieces)
        self.outside = min(max(low - self.truth, self.truth - high, 0.0) for low, high in self.pieces)
        self.far = not self.held and self.outside > 3 * self.width
        self.best_outside = not any(low <= self.best <= high for low, high in self.pieces)
        room = self.feasible[1] - self.feasible[0] if self.kind == "ratio" else math.inf
        self.false = self.identified and self.width < 0.5 * room


def verdicts_of(rows):
    return [Verdict(fields) for row in rows if row["verdicts"] for fields in json.loads(row["verdicts"])]


def chi_square(ranks):
    """Of ranks in ten bins against uniform ones; None for fewer than five a bin."""
    if len(ranks) < 5 * BINS:
        return None
    counts = collections.Counter(min(int(r * BINS), BINS - 1) for r in ranks)
    expected = len(ranks) / BINS
    return sum((counts[k] - expected) ** 2 for k in range(BINS)) / expected


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "|".join(["---"] * 2 + ["---:"] * (len(head) - 2)) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def line(world, family, rows):
    """The numbers of one row of the first table."""
    all_of = verdicts_of(rows)
    acting = [v for v in all_of if v.kind != "inert"]
    still = [v for v in all_of if v.kind != "acts"]
    held = sum(v.held for v in acting)
    told = [v for v in acting if v.identified]
    cpu_s = [float(row["cpu_s"]) for row in rows if row["cpu_s"]]
    chi = chi_square([v.rank for v in acting if v.rank is not None])
    return [world, family, f"{held}/{len(acting)}", f"{100 * held / len(acting):.0f} %" if acting else "-",
            ("yes" if agrees(held, len(acting)) else "NO") if acting else "-", f"{sum(v.held for v in told)}/{len(told)}",
            sum(v.far for v in acting), f"{sum(v.false for v in still)}/{len(still)}", sum(v.best_outside for v in acting),
            sum(v.share > 0.5 for v in told), f"{statistics.median(v.share for v in acting):.3f}" if acting else "-",
            "-" if chi is None else f"{chi:.0f}", f"{statistics.mean(cpu_s):.1f}" if cpu_s else "-"]


HEAD = ["world", "methods", "held", "share", "90 % possible", "determined: held", "far", "false", "best outside", "wide", "width", "ranks",
        "CPU s"]


def summary(rows):
    """The tables of OUT/studies.csv, in Markdown."""
    failed = [row for row in rows if row["error"]]
    rows = [row for row in rows if not row["error"]]
    worlds = [name for name in hidden_worlds.WORLDS if any(row["world"] == name for row in rows)]
    lines = []
    for family in FAMILIES:
        for world in [*worlds, "all"]:
            chosen = [row for row in rows if row["family"] == family and world in (row["world"], "all")]
            if chosen:
                lines.append(line(world, family, chosen))
    text = table(HEAD, lines)
    alarms = []
    for family in FAMILIES:
        for states in ("1", "0"):
            judged = [row["explains"] for row in rows if row["family"] == family and row["states_noise"] == states and row["explains"]]
            if judged:
                alarms.append([family, "stated" if states == "1" else "not stated", f"{judged.count('False')}/{len(judged)}"])
    text += "\n\nRight models of which it was said that they do not explain the recordings:\n\n" + table(["methods", "noise", "flagged"], alarms)
    seeds = sorted({int(row["seed"]) for row in rows})
    text += f"\n\nSeeds {seeds[0]} to {seeds[-1]}, {len(rows)} answers." if seeds else "\n\nNo answers yet."
    for row in failed:
        text += f"\nFAILED {row['world']} {row['seed']} {row['method']}: {row['error'].splitlines()[-1]}"
    return text


def main():
    named = [name for name in hidden_worlds.WORLDS if name not in (*hidden_worlds.LAST, "floor")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the binary `realgap`")
    parser.add_argument("out", type=pathlib.Path, help="folder of the studies and of studies.csv")
    parser.add_argument("--worlds", nargs="+", choices=list(hidden_worlds.WORLDS), default=named, metavar="WORLD",
                        help=f"of {', '.join(hidden_worlds.WORLDS)} [default: all but floor and {', '.join(hidden_worlds.LAST)}, which are kept "
                        "for a last look]")
    parser.add_argument("--methods", nargs="+", choices=list(METHODS), default=list(METHODS), metavar="METHOD",
                        help=f"of {', '.join(METHODS)} [default: all]")
    parser.add_argument("--seeds", nargs=2, type=int, default=[1, 6], metavar=("A", "B"), help="first and last seed [default: 1 6]")
    parser.add_argument("--budget", type=int, default=100, help="of optimizers [default: 100]")
    parser.add_argument("--jobs", type=int, default=1, help="studies at a time [default: 1]")
    parser.add_argument("--lean", action="store_true", help="delete the folder of an answer when its row is written")
    parser.add_argument("--summary", action="store_true", help="print the tables of OUT/studies.csv, and ask nothing")
    options = parser.parse_args()
    path = options.out / "studies.csv"
    if not options.summary:
        program, out = options.program.resolve(), options.out.resolve()
        tasks = []
        for seed in range(options.seeds[0], options.seeds[1] + 1):
            for world in (hidden_worlds.WORLDS[name] for name in options.worlds):
                for method in options.methods:
                    if METHODS[method] in world.families:
                        tasks.append(((world.name, seed, method),
                                      lambda w=world, s=seed, m=method: ask(program, w, s, m, out, options.budget, options.lean)))
        run_all(tasks, path, options.jobs)
    chosen = [row for row in read_rows(path) if row["world"] in options.worlds and row["method"] in options.methods]
    print(summary(chosen))


if __name__ == "__main__":
    main()
