"""Intervals by least squares with a simulator of one's own: do they hold the truth?

Hidden pendulums with viscous and dry friction are recorded with a short timestep and fitted with a longer one, once with the longer
one alone and once with its half and its quarter among the simulator's settings (docs/simulator.md):

    python3 tools/guest_worlds.py target/release/realgap --worlds 30
    python3 tools/guest_worlds.py target/release/realgap --worlds 30 --settings
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

RANGES = {"length": (0.1, 2.0, 0.5, "m"), "damping": (0.0, 2.0, 0.2, "1/s"), "dry": (0.0, 2.0, 0.2, "1/s2")}
STUDY = """(
    simulator: Command([%s]),
    recordings: ["run_*.csv"], start: FromRecording, metric: "joints",
    parameters: [(name: "length", from: 0.2, to: 1.0), (name: "damping", from: 0, to: 1), (name: "dry", from: 0, to: 1)],
)"""


def swing(values, angle_rad, end_s, dt_s):
    """Times and angles of a pendulum that is let go."""
    speed, times, angles = 0.0, [0.0], [angle_rad]
    for step in range(math.ceil(end_s / dt_s - 1e-9)):
        speed += dt_s * (-9.81 / values["length"] * math.sin(angle_rad) - values["damping"] * speed)
        dry = dt_s * values["dry"]
        speed = math.copysign(max(abs(speed) - dry, 0.0), speed)
        angle_rad += dt_s * speed
        times.append((step + 1) * dt_s)
        angles.append(angle_rad)
    return times, angles


def serve(dt_s, with_settings):
    """Answers questions of the protocol; no package is needed."""
    names = ("from", "to", "default", "unit")
    parameters = [{"name": name, **dict(zip(names, RANGES[name]))} for name in RANGES]
    shares = (1.0, 0.5, 0.25) if with_settings else (1.0,)
    settings = [{"dt": dt_s * share} for share in shares]
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["ask"] == "hello":
            answer = {"realgap": 1, "name": "pendulum", "parameters": parameters, "settings": settings}
        else:
            start_rad, end_s = asked["start"]["pivot_rad"], asked["times_s"][-1]
            times, angles = swing(asked["parameters"], start_rad, end_s, asked["setting"]["dt"])
            answer = {"id": asked["id"], "times_s": times, "channels": {"pivot_rad": angles}}
        print(json.dumps(answer), flush=True)


def world(program, seed, true_dt_s, dt_s, with_settings, noise_rad=0.002):
    """Of each parameter whether its interval holds the truth."""
    draw = random.Random(seed)
    truth = {"length": draw.uniform(0.3, 0.8), "damping": draw.uniform(0.05, 0.5), "dry": draw.uniform(0.05, 0.5)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for index in range(2):
            _, angles = swing(truth, draw.uniform(0.4, 1.0), 149 * 0.02, true_dt_s)
            rows = [f"{0.02 * k:.3f},{angles[round(0.02 * k / true_dt_s)] + draw.gauss(0, noise_rad):.9g}" for k in range(150)]
            (folder / f"run_{index}.csv").write_text("t_s,pivot_rad\n" + "\n".join(rows) + "\n")
        words = [sys.executable, __file__, "--serve", str(dt_s)] + ["--settings"] * with_settings
        (folder / "study.ron").write_text(STUDY % ", ".join(json.dumps(word) for word in words))
        command = [program, "tune", "study.ron", "--optimizer", "gauss-newton", "--budget", "40", "--allow-command"]
        command += ["--no-report", "--format", "json", "-o", "out"]
        answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    held = {}
    for verdict in json.loads(answer)["verdicts"]:
        own = verdict["parameter"].removeprefix("sim.")
        parts = [verdict["interval"]] if verdict["interval"] else verdict.get("intervals", [])
        held[own] = any(low <= truth[own] <= high for low, high in parts)
        if not held[own]:
            print(f"  world {seed}: {own} is {truth[own]:.5f}, interval {parts}", flush=True)
    return held


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", help="the program realgap")
    parser.add_argument("--worlds", type=int, default=30)
    parser.add_argument("--true-dt", type=float, default=1e-4, help="timestep of the recordings, seconds")
    parser.add_argument("--dt", type=float, default=1e-3, help="timestep of the simulator, seconds")
    parser.add_argument("--settings", action="store_true", help="the simulator declares half and quarter of its timestep")
    parser.add_argument("--serve", type=float, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        return serve(given.serve, given.settings)
    program = str(Path(given.program).resolve())
    all_held = [world(program, seed, given.true_dt, given.dt, given.settings) for seed in range(given.worlds)]
    for name in RANGES:
        print(f"{name}: {sum(held[name] for held in all_held)} of {given.worlds}")


if __name__ == "__main__":
    main()
