#!/usr/bin/env python3
"""Counts how much `realgap` finds out about hidden floors under two modules that walk: the power of its answers, beside their coverage.

    cargo build --release
    python3 -m pip install numpy==2.4.6
    python3 tools/floor_power.py target/release/realgap results/floors --floors 8
    python3 tools/floor_power.py target/release/realgap results/floors --floors 40 --jobs 2

Friction (0.1 to 1) and restitution (0 to 0.8) are hidden. Five recordings of 10 s are made by Rapier with another timestep and other
substeps than the study's, with noise of start, servos and camera (world `floor` of tools/hidden_worlds.py). The study is a grid of
9 x 9, asked by `sweep` and by `tune` (cma-es, budget 100). OUT/studies.csv gets one row per answer, so that a run that was interrupted
goes on; --summary prints the tables and asks nothing. Studies of odd seeds state no noise, those of even seeds state theirs.
"""

import argparse
import pathlib

import hidden_worlds
import interval_worlds

METHODS = ("sweep", "cma-es")


def cells(verdicts):
    told = [v for v in verdicts if v.identified]
    return [f"{len(told)}/{len(verdicts)}", f"{sum(v.held for v in told)}/{len(told)}", f"{sum(v.held for v in verdicts)}/{len(verdicts)}"]


def said(verdict):
    """The interval in words."""
    text = " or ".join(f"{low:.3f} to {high:.3f}" for low, high in verdict.pieces)
    return text if verdict.identified else f"{text} (not determined)"


def floors(rows):
    """One line per answer."""
    lines = []
    for row in sorted(rows, key=lambda row: (int(row["seed"]), row["method"])):
        friction, restitution = interval_worlds.verdicts_of([row])
        lines.append([row["seed"], row["method"], f"{friction.truth:.3f}", said(friction), f"{restitution.truth:.3f}", said(restitution),
                      row["explains"]])
    return interval_worlds.table(["seed", "method", "friction", "said", "restitution", "said", "explains"], lines)


def summary(rows):
    lines = []
    for method in (*METHODS, "both"):
        chosen = [row for row in rows if row["verdicts"] and method in (row["method"], "both")]
        all_of = interval_worlds.verdicts_of(chosen)
        frictions = [v for v in all_of if v.name == "floor.friction"]
        cpu_s = [float(row["cpu_s"]) for row in chosen]
        lines.append([method, len(chosen), *cells(frictions), *cells(all_of), f"{sum(cpu_s) / max(len(cpu_s), 1):.1f}"])
    head = ["method", "floors", "frictions determined", "of them held", "all frictions held", "parameters determined", "of them held",
            "all parameters held", "CPU s"]
    failed = "".join(f"\nFAILED {row['seed']} {row['method']}: {row['error'].splitlines()[-1]}" for row in rows if row["error"])
    return interval_worlds.table(head, lines) + failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the binary `realgap`")
    parser.add_argument("out", type=pathlib.Path, help="folder of the studies and of studies.csv")
    parser.add_argument("--floors", type=int, default=8, help="how many, with seeds from --first on [default: 8]")
    parser.add_argument("--first", type=int, default=1, help="first seed [default: 1]")
    parser.add_argument("--budget", type=int, default=100, help="of cma-es [default: 100]")
    parser.add_argument("--jobs", type=int, default=1, help="floors at a time [default: 1]")
    parser.add_argument("--each", action="store_true", help="also print one line per floor")
    parser.add_argument("--summary", action="store_true", help="print the tables of OUT/studies.csv, and ask nothing")
    options = parser.parse_args()
    path = options.out / "studies.csv"
    seeds = range(options.first, options.first + options.floors)
    if not options.summary:
        program, out, world = options.program.resolve(), options.out.resolve(), hidden_worlds.WORLDS["floor"]
        tasks = [(("floor", seed, method), lambda s=seed, m=method: interval_worlds.ask(program, world, s, m, out, options.budget, True))
                 for seed in seeds for method in METHODS]
        interval_worlds.run_all(tasks, path, options.jobs)
    rows = [row for row in interval_worlds.read_rows(path) if int(row["seed"]) in seeds]
    print(summary(rows))
    if options.each:
        print("\n" + floors([row for row in rows if row["verdicts"]]))


if __name__ == "__main__":
    main()
