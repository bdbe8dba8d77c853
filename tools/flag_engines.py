#!/usr/bin/env python3
"""Tests whether a sweep reports that its model does not fit if, and only if, another engine made the recordings: random robots on a hidden floor.

    python3 -m pip install -r tools/requirements.txt
    python3 tools/flag_engines.py results/flags --recorder mujoco --seeds 1 40
    python3 tools/flag_engines.py results/flags --recorder own --seeds 1 40

writes results/flags/mujoco.csv or own.csv with one row for each robot, and a folder for each robot. Existing results are not made again.

Robots are drawn and kept as tools/engine_spread.py does it, friction from 0.3 to 0.7 included. MuJoCo runs what `realgap robot export`
writes, with steps of 1/2000 s. The program itself records with an engine, a timestep and substeps that are drawn, too, none coarser
than its defaults or finer than half of them. A sweep of friction and restitution gets `--recordings`; `--further` repeats judge the
program's ensemble at the sweep's best point by `realgap gap` (energy test, metric rms).
"""

import csv
import json
import shutil
import subprocess

import numpy as np

import record_standin
from engine_spread import BODY_LENGTH_M, drawn, known, parser
from standin import Robot

FIELDS = ["seed", "modules", "friction", "hidden", "noise_floors", "p", "flagged", "explained_by", "low", "high", "determined", "holds", "further_p"]
STUDY = """Study(
    description: "a floor that is known to whoever recorded",
    morphology: "robot.ron",
    recordings: ["{recordings}/*.csv"],
    start: Settled,
    duration_s: {duration},
    parameters: [
        (name: "floor.friction", from: 0.1, to: 1.0, points: 7),
        (name: "floor.restitution", from: 0.0, to: 0.5, points: 6),
    ],
    noise: Noise(
        start_position_m: Normal(0.001), start_height_m: Normal(0.001), start_tilt_rad: Normal(0.0175), start_heading_rad: Normal(0.0175),
        servo_zero_rad: Normal(0.00436), camera: (position_m: Normal(0.001), angle_rad: Normal(0.005)),
    ),
)
"""


def arguments():
    p = parser(__doc__, [2, 4], 1.0)
    p.add_argument("--recorder", choices=["mujoco", "own"], required=True)
    p.add_argument("--recordings", type=int, default=10, help="recordings that the sweep gets (default 10)")
    p.add_argument("--further", type=int, default=100, help="further repeats, 0 for none (default 100)")
    return p.parse_args()


def asked(a, *words):
    """The answer of the program as JSON; a refusal is an error."""
    made = subprocess.run([a.realgap, *map(str, words), "--format", "json"], capture_output=True, text=True)
    if made.returncode:
        raise SystemExit(made.stderr)
    return json.loads(made.stdout)


def record_in_mujoco(a, seed, folder, found):
    """Writes the recordings of all repeats; returns the hidden settings other than the friction."""
    mjcf = folder / "robot.mjcf"
    export = [a.realgap, "robot", "export", folder / "robot.ron", "--format", "mjcf", "-o", mjcf, "--force"]
    subprocess.run(export, check=True, capture_output=True)
    robot = Robot(mjcf)
    robot.set_friction(found["friction"])
    # The timestep is as coarse as in tools/record_fleet.py, because a stand-in may have any accuracy.
    robot.model.opt.timestep, robot.hold = 1 / 2000, 2
    repeats = a.recordings + a.further
    how = record_standin.arguments([str(mjcf), "-o", str(folder / "all"), "--duration", str(a.duration), "--repeats", str(repeats),
                                    "--seed", str(seed)])
    record_standin.write_all(robot, how, [record_standin.record(robot, how, repeat) for repeat in range(repeats)])
    return "MuJoCo"


def record_ourselves(a, seed, folder, found):
    """Writes the recordings of all repeats by the program itself, with other numerical settings that are equally valid."""
    rng = np.random.default_rng([seed, 1])
    engine = ["rapier", "tree"][rng.integers(2)]
    hidden = [f"timestep_s={1 / rng.uniform(480, 960):.8f}", f"solver.substeps={rng.integers(3, 7)}"]
    options = [word for value in hidden for word in ("--set", value)]
    asked(a, "study", "record", folder / "robot.ron", "-o", folder / "all", "--force", "--repeats", a.recordings + a.further,
         "--duration", a.duration, "--seed", seed, "--engine", engine, "--set", f"floor.friction={found['friction']}", *options)
    return " ".join([engine, *hidden])


def recorded(a, seed, folder, found):
    """Makes all recordings and splits them into those of the sweep and further ones."""
    shutil.rmtree(folder / "all", ignore_errors=True)
    record = {"mujoco": record_in_mujoco, "own": record_ourselves}[a.recorder]
    hidden = record(a, seed, folder, found)
    for repeat, file in enumerate(sorted((folder / "all").glob("run_*.csv"), key=lambda file: int(file.stem[4:]))):
        part = folder / ("fitted" if repeat < a.recordings else "further")
        part.mkdir(exist_ok=True)
        shutil.copy(folder / "all" / "meta.ron", part)
        file.rename(part / file.name)
    return {"hidden": hidden}


def studied(a, folder, part, *words):
    study = folder / f"{part}.ron"
    study.write_text(STUDY.format(recordings=part, duration=a.duration))
    return asked(a, words[0], study, "-o", folder / f"{part}_{words[0]}", "--force", "--no-report", "--jobs", 1, *words[1:])


def row(a, seed):
    """The row of a robot in the table; None if it is not kept."""
    folder = a.output / a.recorder / f"{seed:05}"
    folder.mkdir(parents=True, exist_ok=True)
    found = known(folder / "drawn.json", lambda: drawn(a, seed, folder))
    if not found or found["far_m"] < a.least * BODY_LENGTH_M:
        return None
    hidden = known(folder / "recorded.json", lambda: recorded(a, seed, folder, found))["hidden"]
    swept = known(folder / "swept.json", lambda: studied(a, folder, "fitted", "sweep"))
    further_p = ""
    if a.further:
        best = folder / "fitted_sweep" / "best.ron"
        gap = known(folder / "gap.json", lambda: studied(a, folder, "further", "gap", "--metric", "rms", "--repeats", 100, "--parameters", best))
        further_p = gap["metrics"][0]["alike"]["p_value"]
    fit, verdict = swept["fit"], swept["verdicts"][0]
    spans = verdict.get("intervals") or [verdict["interval"]]
    holds = any(low <= found["friction"] <= high for low, high in spans)
    return [seed, found["modules"], found["friction"], hidden, f"{fit['noise_floors']:.2f}", f"{fit['p_value']:.4f}", not fit["explains"],
            fit.get("engine", ""), f"{spans[0][0]:.3f}", f"{spans[-1][1]:.3f}", verdict["identified"], holds, further_p]


def main():
    a = arguments()
    a.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for seed in range(a.seeds[0], a.seeds[1] + 1):
        kept = row(a, seed)
        if kept:
            rows.append(kept)
            print(*kept, sep=",", flush=True)
    with open(a.output / f"{a.recorder}.csv", "w", newline="") as opened:
        csv.writer(opened, lineterminator="\n").writerows([FIELDS, *rows])
    judged = [row for row in rows if a.recorder == "own" or not a.further or row[-1] < 0.05]
    count = lambda column: sum(row[FIELDS.index(column)] is True for row in judged)
    print(f"{a.recorder}: {len(rows)} robots, {len(judged)} judged: {count('flagged')} flagged, {count('holds')} intervals hold the friction")


if __name__ == "__main__":
    main()
