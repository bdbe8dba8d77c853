#!/usr/bin/env python3
"""Counts how often `realgap` finds hidden floors of a worm of four cubes whose recordings another engine made (STAND-INS from MuJoCo).

    cargo build --release
    python3 -m pip install -r tools/requirements.txt
    python3 tools/worm_floors.py target/release/realgap results/worm_floors --floors 10
    python3 tools/worm_floors.py target/release/realgap results/worm_floors --floors 10 --engines default tree rapier

The study is sweeps/worm_slope.ron with other recordings and without its `truth`, asked by `sweep` at default settings. Friction is hidden,
uniform from 0.2 to 0.7; the slope is 0.17 rad, which the study knows to 0.02 rad. tools/record_standin.py makes five recordings for each floor,
with its own noise and the timestep of the exported MJCF (1/8000 s). OUT/floors.csv gets one row per answer, so that a run that was
interrupted goes on; --summary prints the tables and asks nothing. A row belongs to the program that made it: use another OUT for another
program. With --engines `tree` or `rapier` the study is held to one engine, which leaves the difference between the two out of its answer.

What is counted:
- near: the best point is at most two noise floors away from the recordings;
- held: the truth is in the 90 % interval;
- determined: the friction is told as determined;
- all three: near, held and determined together.
"""

import argparse
import csv
import json
import pathlib
import re
import sys

import numpy as np

import hidden_worlds
import interval_worlds

TOOLS = pathlib.Path(__file__).resolve().parent
ROOT = TOOLS.parent
STUDY = ROOT / "sweeps" / "worm_slope.ron"
FRICTION = (0.2, 0.7)
SLOPE_RAD = 0.17
DURATION_S = 5
NOISE_FLOORS_AT_MOST = 2.0
# The study as it is, which draws on both engines.
DEFAULT = "default"
COLUMNS = ["floor", "engine", "friction", "noise_floors", "explains", "best", "low", "high", "identified", "slope_low", "slope_high",
           "slope_identified", "cpu_s", "text", "slope_text", "error"]


def hidden_friction(seed):
    return float(f"{np.random.default_rng([seed, 4]).uniform(*FRICTION):.4f}")


def study_ron():
    """The shipped study, with the files in the folder of the floor and without the truth of its own recordings."""
    text = STUDY.read_text()
    for pattern, replacement in [(r'morphology: ".*?"', 'morphology: "robot.ron"'), (r"recordings: \[.*?\]", 'recordings: ["rec/*.csv"]'),
                                 (r"\n *truth: \{.*?\},", "")]:
        text, changed = re.subn(pattern, replacement, text)
        if changed != 1:
            raise SystemExit(f"error: {STUDY} has {changed} places like {pattern}")
    return text


def make(seed, repeats, folder, program):
    """Writes robot, recordings and study of one floor, unless they are there; returns its friction."""
    friction = hidden_friction(seed)
    done = folder / "truth.json"
    if not done.exists():
        folder.mkdir(parents=True, exist_ok=True)
        robot = folder / "robot.ron"
        robot.write_text((ROOT / "morphologies" / "worm4.ron").read_text())
        hidden_worlds.run_program([program, "--force", "robot", "export", robot, "--set", f"floor.slope_rad={SLOPE_RAD}", "--format", "mjcf",
                                   "-o", folder / "robot.mjcf"])
        hidden_worlds.run_program([sys.executable, TOOLS / "record_standin.py", folder / "robot.mjcf", "-o", folder / "rec", "--friction",
                                   friction, "--duration", DURATION_S, "--repeats", repeats, "--seed", seed])
        (folder / "study.ron").write_text(study_ron())
        done.write_text(json.dumps({"floor.friction": friction, "floor.slope_rad": SLOPE_RAD}) + "\n")
    return friction


def ask(program, seed, engine, repeats, out):
    """One answer to one floor: a row of floors.csv."""
    row = {"floor": seed, "engine": engine}
    folder = out / f"floor_{seed}"
    try:
        row["friction"] = make(seed, repeats, folder, program)
        answer_folder = folder / engine
        held = [] if engine == DEFAULT else ["--engine", engine]
        text = hidden_worlds.run_program([program, "sweep", folder / "study.ron", *held, "--jobs", 1, "--no-report", "--restart",
                                          "-o", answer_folder, "--format", "json"])
        answer = json.loads(text)
        verdicts = {verdict["parameter"]: verdict for verdict in answer["verdicts"]}
        friction, slope = verdicts["floor.friction"], verdicts["floor.slope_rad"]
        row.update(noise_floors=answer["fit"]["noise_floors"], explains=answer["fit"]["explains"],
                   best=answer["best"]["parameters"]["floor.friction"], identified=friction["identified"], text=friction["text"],
                   slope_identified=slope["identified"], slope_text=slope["text"],
                   cpu_s=json.loads((answer_folder / "timing.json").read_text())["cpu_s"])
        row["low"], row["high"] = span(friction)
        row["slope_low"], row["slope_high"] = span(slope)
    except (RuntimeError, KeyError, ValueError, OSError) as error:
        row["error"] = f"{type(error).__name__}: {error}"
    return row


def span(verdict):
    """The ends of the 90 % interval; of several pieces the outermost ends."""
    parts = interval_worlds.pieces(verdict)
    return min(low for low, _ in parts), max(high for _, high in parts)


def read_rows(path):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    # A floor that failed is asked again by the next run: its last row counts.
    return list({(int(row["floor"]), row["engine"]): row for row in rows}.values())


def is_near(row):
    return float(row["noise_floors"]) <= NOISE_FLOORS_AT_MOST


def is_held(row):
    return float(row["low"]) <= float(row["friction"]) <= float(row["high"])


def is_determined(row):
    return row["identified"] == "True"


def is_slope_held(row):
    return float(row["slope_low"]) <= SLOPE_RAD <= float(row["slope_high"])


def yes(truth):
    return "yes" if truth else "no"


def floors(rows):
    """One line per answer."""
    lines = []
    for row in sorted(rows, key=lambda row: (row["engine"], int(row["floor"]))):
        friction, best = float(row["friction"]), float(row["best"])
        lines.append([row["floor"], row["engine"], f"{friction:.4f}", f"{float(row['noise_floors']):.2f}", f"{best:.3f}",
                      f"{100 * (best / friction - 1):+.1f} %", f"{float(row['low']):.3f} to {float(row['high']):.3f}", yes(is_held(row)),
                      yes(is_determined(row)), f"{float(row['slope_low']):.3f} to {float(row['slope_high']):.3f}", f"{float(row['cpu_s']):.0f}"])
    return interval_worlds.table(["floor", "engine", "friction", "noise floors", "best", "off", "90 % interval", "held", "determined",
                                  "slope (90 %)", "CPU s"], lines)


def summary(rows):
    lines = []
    for engine in sorted({row["engine"] for row in rows}):
        asked = [row for row in rows if row["engine"] == engine and not row["error"]]
        count = lambda is_so: f"{sum(map(is_so, asked))}/{len(asked)}"
        lines.append([engine, len(asked), count(is_near), count(is_held), count(is_determined),
                      count(lambda row: is_near(row) and is_held(row) and is_determined(row)), count(lambda row: row["explains"] == "True"),
                      count(is_slope_held), f"{sum(float(row['cpu_s']) for row in asked) / max(len(asked), 1):.1f}"])
    head = ["engine", "floors", "near", "friction held", "friction determined", "all three", "explained", "slope held", "CPU s"]
    failed = "".join(f"\nFAILED {row['floor']} {row['engine']}: {row['error'].splitlines()[-1]}" for row in rows if row["error"])
    return interval_worlds.table(head, lines) + failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the binary `realgap`")
    parser.add_argument("out", type=pathlib.Path, help="folder of the floors and of floors.csv")
    parser.add_argument("--floors", type=int, default=10, help="how many, with seeds from --first on [default: 10]")
    parser.add_argument("--first", type=int, default=501, help="first seed [default: 501]")
    parser.add_argument("--repeats", type=int, default=5, help="recordings of each floor [default: 5]")
    parser.add_argument("--engines", nargs="+", choices=(DEFAULT, "tree", "rapier"), default=[DEFAULT],
                        help="engines to which the study is held; default: both [default: default]")
    parser.add_argument("--summary", action="store_true", help="print the tables of OUT/floors.csv, and ask nothing")
    options = parser.parse_args()
    program, out = options.program.resolve(), options.out.resolve()
    path, seeds = out / "floors.csv", range(options.first, options.first + options.floors)
    if not options.summary:
        out.mkdir(parents=True, exist_ok=True)
        known = {(int(row["floor"]), row["engine"]) for row in read_rows(path) if not row["error"]}
        is_new = not path.exists()
        with open(path, "a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, restval="")
            if is_new:
                writer.writeheader()
            for engine in options.engines:
                for seed in seeds:
                    if (seed, engine) in known:
                        continue
                    row = ask(program, seed, engine, options.repeats, out)
                    writer.writerow(row)
                    file.flush()
                    print(f"floor {seed}, {engine}: {row.get('error') or row['text']}", flush=True)
    rows = [row for row in read_rows(path) if int(row["floor"]) in seeds]
    print("\n" + floors([row for row in rows if not row["error"]]) + "\n\n" + summary(rows))


if __name__ == "__main__":
    main()
