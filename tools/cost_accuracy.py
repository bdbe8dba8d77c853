#!/usr/bin/env python3
"""Measures cost and accuracy for timestep x substeps x joint formulation x precision, against closed forms and real tosses.

Runs `realgap verify`, `realgap evaluate` and `realgap simulate` at each setting and prints Markdown tables. No packages needed.

    cargo build --release && python3 tools/cost_accuracy.py target/release/realgap
    cargo build --release --no-default-features --features f32 --target-dir target/f32
    python3 tools/cost_accuracy.py target/release/realgap target/f32/release/realgap --tables summary

Several programs are compared row by row; the engine that each reports names it.
"""

import argparse
import glob
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = ["chain3", "spider8", "chain30", "tripod"]
TIMESTEPS = [120, 240, 480, 960]
SUBSTEPS = [4, 8, 16]
# Where sweeps/cube_toss_best.ron was fitted; other settings are judged with a fit that was not made for them.
FITTED_AT = (296, 4)
# The worst error, in units of its tolerance, of every group of checks.
GROUPS = {
    "stop": "friction.stop",
    "straight": "friction.straight",
    "stick": "friction.stick",
    "bounce flat": "restitution.flat.first",
    "bounce corner": "restitution.corner.first",
    "tumble": "energy.tumble",
    "swing": "energy.pendulum.energy",
    "hold": "servo.droop",
    "sine": "servo.sine",
    "hinge tilt": "structure.walk.tilt",
}


def call(program, *arguments):
    result = subprocess.run([program, *arguments, "--format", "json"], capture_output=True, text=True)
    if not result.stdout:
        sys.exit(f"{program} {' '.join(arguments)}: {result.stderr}")
    return json.loads(result.stdout)


def settings(hertz, substeps, joint):
    return ["--timestep", repr(1 / hertz), "--substeps", str(substeps), "--joint", joint]


def severity(check):
    """Error in units of the tolerance; infinite where the run diverged."""
    limit = next(iter(check["tolerance"].values()))
    return float("inf") if check["error"] is None else check["error"] / limit


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def head(*cells):
    row(*cells)
    print("|---" * len(cells) + "|")


def verification(programs):
    print("\nWorst error of each group of checks in units of its tolerance (up to 1 passes):\n")
    head("engine", "joint", "1/s", "substeps", "failed", *GROUPS)
    for joint in ["impulse", "multibody"]:
        for hertz in TIMESTEPS:
            for substeps in SUBSTEPS:
                for engine, program in programs:
                    report = call(program, "verify", *settings(hertz, substeps, joint))
                    cells = []
                    for prefix in GROUPS.values():
                        worst = max(severity(c) for c in report["checks"] if c["name"].startswith(prefix))
                        cells.append(f"{worst:.2f}")
                    total = report["passed"] + report["failed"]
                    row(engine, joint, hertz, substeps, f"{report['failed']} of {total}", *cells)


def simulation_cost(program, folder, robot, options, repeats):
    """CPU, microseconds per simulated millisecond: median of `repeats` runs of 4 s, settling included."""
    costs = []
    for _ in range(repeats):
        report = call(program, "simulate", f"{folder}/{robot}.ron", "--duration", "4", *options)
        steps = report["steps"] + report["settle_steps"]
        costs.append(report["cpu_s"] * 1e6 / (steps * report["timestep_s"] * 1e3))
    return f"{sorted(costs)[len(costs) // 2]:.1f}"


def cost(programs, folder, repeats):
    print(f"\nCPU, microseconds per simulated millisecond (median of {repeats} runs of 4 s, settling included):\n")
    head("engine", "joint", "1/s", "substeps", *ROBOTS)
    for joint in ["impulse", "multibody"]:
        for hertz in TIMESTEPS:
            for substeps in SUBSTEPS:
                for engine, program in programs:
                    options = settings(hertz, substeps, joint)
                    row(engine, joint, hertz, substeps,
                        *(simulation_cost(program, folder, robot, options, repeats) for robot in ROBOTS))


def toss(program, recordings, hertz, substeps):
    """Errors of the committed fit on the held-out half of the tosses at these settings; empty without data."""
    if not glob.glob(recordings):
        return ["", "", "", ""]
    report = call(program, "evaluate", str(ROOT / "sweeps/cube_toss_fit.ron"),
                  "--parameters", str(ROOT / "sweeps/cube_toss_best.ron"), "--recordings", recordings,
                  "--every", "2", "--offset", "1", "--jobs", "1",
                  "--set", f"timestep_s={1 / hertz!r}", "--set", f"solver.substeps={substeps}")
    position, rotation = report["position_percent"], report["rotation_deg"]
    return [
        f"{position['mean']:.2f} ± {position['standard_error']:.2f}",
        f"{rotation['mean']:.2f} ± {rotation['standard_error']:.2f}",
        f"{report['over_45_deg']} of {report['recordings']}",
        # Milliseconds per second are microseconds per millisecond.
        f"{report['cpu_ms_per_s']:.2f}",
    ]


def summary(programs, folder, recordings, repeats):
    print("\nFailed checks (both joint kinds), real tosses, and CPU in microseconds per simulated millisecond (robots with impulse",
          f"joints, median of {repeats} runs of 4 s, settling included):\n")
    head("engine", "1/s", "substeps", "failed", "toss position %", "toss rotation °", "over 45°", "CPU toss",
         *(f"CPU {robot}" for robot in ROBOTS))
    grid = sorted({(hertz, substeps) for hertz in TIMESTEPS for substeps in SUBSTEPS} | {FITTED_AT})
    for hertz, substeps in grid:
        for engine, program in programs:
            options = ["--timestep", repr(1 / hertz), "--substeps", str(substeps)]
            report = call(program, "verify", *options)
            total = report["passed"] + report["failed"]
            costs = [simulation_cost(program, folder, robot, [*options, "--joint", "impulse"], repeats) for robot in ROBOTS]
            row(engine, hertz, substeps, f"{report['failed']} of {total}",
                *toss(program, recordings, hertz, substeps), *costs)
    if glob.glob(recordings):
        print(f"\nTosses: the held-out half (`--every 2 --offset 1`), mean ± standard error. The fit was made at 1/{FITTED_AT[0]} s × "
              f"{FITTED_AT[1]} and is the same in every row.")
    else:
        print(f"\nThe toss columns are empty: no recordings at {recordings} (--recordings GLOB).")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="PROGRAM", help="realgap, e.g. target/release/realgap")
    parser.add_argument("--robots", default=str(ROOT / "morphologies"), metavar="DIR", help="where the robots' files are")
    parser.add_argument("--recordings", default=str(ROOT.parent / "shared/data/cube_tosses/*.csv"), metavar="GLOB",
                        help="real tosses (default: %(default)s)")
    parser.add_argument("--tables", default="summary,verification,cost", metavar="LIST", help="which tables (default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="runs per cost (default: %(default)s)")
    given = parser.parse_args()
    named = []
    for path in given.programs:
        engine = call(path, "verify", "--joint", "impulse")["engine"]
        named.append((engine, path))
    tables = {
        "summary": lambda: summary(named, given.robots, given.recordings, given.repeats),
        "verification": lambda: verification(named),
        "cost": lambda: cost(named, given.robots, given.repeats),
    }
    chosen = given.tables.split(",")
    unknown = [name for name in chosen if name not in tables]
    if unknown:
        parser.error(f"no such table: {', '.join(unknown)}; there are {', '.join(tables)}")
    for name in chosen:
        tables[name]()
