#!/usr/bin/env python3
"""Cost against accuracy: timestep x substeps x joint kind.

Runs `realgap verify` and `realgap simulate` at each setting and prints Markdown tables. No packages needed.

    cargo build --release && python3 tools/cost_accuracy.py target/release/realgap
"""

import json
import subprocess
import sys

ROBOTS = ["chain3", "spider8", "chain30", "tripod"]
TIMESTEPS = [120, 240, 480, 960]
SUBSTEPS = [4, 8, 16]
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


def verification(program):
    print("Worst error of each group of checks in units of its tolerance (up to 1 passes):\n")
    print("| joint | 1/s | substeps | failed | " + " | ".join(GROUPS) + " |")
    print("|---" * (4 + len(GROUPS)) + "|")
    for joint in ["impulse", "multibody"]:
        for hertz in TIMESTEPS:
            for substeps in SUBSTEPS:
                report = call(program, "verify", *settings(hertz, substeps, joint))
                cells = []
                for prefix in GROUPS.values():
                    worst = max(severity(c) for c in report["checks"] if c["name"].startswith(prefix))
                    cells.append(f"{worst:.2f}")
                total = report["passed"] + report["failed"]
                print(f"| {joint} | {hertz} | {substeps} | {report['failed']} of {total} | " + " | ".join(cells) + " |")


def cost(program, folder, repeats=3):
    print("\nCPU, microseconds per simulated millisecond (median of", repeats, "runs of 4 s, settling included):\n")
    print("| joint | 1/s | substeps | " + " | ".join(ROBOTS) + " |")
    print("|---" * (3 + len(ROBOTS)) + "|")
    for joint in ["impulse", "multibody"]:
        for hertz in TIMESTEPS:
            for substeps in SUBSTEPS:
                cells = []
                for robot in ROBOTS:
                    costs = []
                    for _ in range(repeats):
                        report = call(program, "simulate", f"{folder}/{robot}.ron", "--duration", "4",
                                      *settings(hertz, substeps, joint))
                        steps = report["steps"] + report["settle_steps"]
                        costs.append(report["cpu_s"] * 1e6 / (steps * report["timestep_s"] * 1e3))
                    cells.append(f"{sorted(costs)[len(costs) // 2]:.1f}")
                print(f"| {joint} | {hertz} | {substeps} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    verification(sys.argv[1])
    cost(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "morphologies")
