#!/usr/bin/env python3
"""Judges a fit of the car's rubber on runs and halves of runs that no fit has seen.

    python3 tools/car_floors.py DATA FIT [--realgap target/release/realgap] [--output results/car] [--rubber]

DATA holds all runs of the car (github.com/Lorenzo-Lyons/DART as CSV files), FIT is a results folder of a fit to some of the runs on
rubber. The other runs on rubber are judged with FIT as it is. On the other floors a fit begins with FIT, and friction, dead zone
and trim are free (on the slippery ones torque and top speed, drag, steering gain and the delays, too, because the car was set up
differently); it sees other runs or the other half of the run. --rubber leaves the other floors out. Prints, for every run, the
number of windows (every 0.5 s, as the authors' tables have them) and the median position error after 0.5, 1.0 and 1.5 s.
"""

import argparse
import csv
import json
import pathlib
import re
import statistics
import subprocess

WHEELS = '(hinge: "drive_*", column: "throttle", on: "enabled"), (hinge: "steer_*", column: "steering")'
# What another floor changes: its friction, and what moves between any two runs. A number is the standard deviation of a prior
# whose median is the value of rubber's fit, where the fit begins; without one, only the range is known.
AGAIN = {
    "floor.friction": (0.1, 1.6, None, ""),
    "command.drive_*.dead_zone": (0.0, 0.33, 0.05, ", each: Run"),
    "command.steer_*.offset": (-0.1, 0.1, 0.02, ", each: Run"),
}
# The cars on the slippery floors were set up differently: they slow down more when they coast, and their commands come late.
SET_UP = {
    "servo.drive_*.max_torque_nm": (0.0275, 0.44, 0.05, ""),
    "servo.drive_*.max_speed_rad_s": (65.0, 1000.0, 100.0, ""),
    "hinge.drive_*.dry_nm": (0.0028, 0.0448, 0.01, ""),
    "command.drive_*.delay_s": (-0.1, 0.15, None, ""),
    "command.steer_*.factor": (0.125, 2.0, 0.15, ""),
    "command.steer_*.delay_s": (-0.1, 0.15, None, ""),
}


def study(folder, name, runs, every_s, values, varied, crop=""):
    """Writes a study of these runs; `values` are fixed unless they are varied, and a fit of those begins there."""
    fixed = values | {"floor.restitution": 0}

    def prior(key, sd):
        return "" if sd is None else f", prior: ({values[key]}, {sd})"

    ranges = [
        f'(name: "{key}", from: {low}, to: {high}{prior(key, sd)}{more})' for key, (low, high, sd, more) in varied.items()
    ] or ['(name: "floor.friction", from: 0.1, to: 1.6)']
    text = f"""Study(
    morphology: "{pathlib.Path('morphologies/dart_car.ron').resolve()}",
    recordings: [{', '.join(f'"{run}"' for run in runs)}],
    reading: (columns: (heading: "heading_rad in rad"){crop}),
    start: FromRecording, align: World, horizon: (1.5, {every_s}),
    windows: (from_m_s: 0.2, on: Some("enabled"), gap_s: Some(0.1)),
    commands: Commands(columns: [{WHEELS}]),
    set: {{{', '.join(f'"{key}": {value}' for key, value in fixed.items())}}},
    timestep_s: 0.004, metric: "pose", score: Single,
    parameters: [{', '.join(ranges)}],
)
"""
    path = folder / f"{name}.ron"
    path.write_text(text)
    return path


def values_of(path):
    """The fitted values of a results folder; values of single runs become their median, as in realgap, and those of rubber hold for all."""
    found = {}
    for name, value in re.findall(r'"([^"]+)": (-?[0-9.e-]+)', (path / "best.ron").read_text()):
        run = re.match(r"run\.([^.]+)\.(.+)", name)
        if run and run[1].startswith("tiles_*"):
            continue
        found.setdefault(run[2] if run else name, []).append(float(value))
    return {name: statistics.median(values) for name, values in found.items() if not name.startswith("solver")}


def fit(realgap, path, budget):
    out = path.with_suffix("")
    command = [realgap, "tune", path, "--optimizer", "gauss-newton", "--budget", str(budget), "--no-audit", "-o", out, "--restart"]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    return values_of(out)


def judged(realgap, path, parameters=None):
    """Errors of each recording."""
    more = ["--parameters", str(parameters)] if parameters else []
    command = [realgap, "evaluate", path, "--format", "json", *more]
    found = json.loads(subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout)
    return {one["recording"]: one for one in found["over_horizon"]}


def row(name, one, friction=None):
    thirds = [one["median_m"][len(one["times_s"]) * k // 3 - 1] for k in (1, 2, 3)]
    errors = " / ".join(f"{1e3 * error:.0f}" for error in thirds)
    said = "" if friction is None else f"   friction {friction:.3f}"
    print(f"{name:22} {one['windows']:4} windows  {errors}{said}", flush=True)


def middle_s(run):
    with open(run) as lines:
        times = [float(line["t_s"]) for line in csv.DictReader(lines)]
    return round(0.5 * (times[0] + times[-1]), 2)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("data", type=pathlib.Path)
    p.add_argument("fit", type=pathlib.Path)
    p.add_argument("--realgap", default="target/release/realgap")
    p.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/car"))
    p.add_argument("--rubber", action="store_true")
    options = p.parse_args()
    data, folder = options.data.resolve(), options.output
    folder.mkdir(parents=True, exist_ok=True)
    values = values_of(options.fit)
    runs = {path.stem: path for path in sorted(data.glob("*.csv"))}

    fitted = (options.fit / "best.ron").read_text()
    unseen = [name for name in runs if name.startswith("rubber") and f"run.{name}." not in fitted]
    path = study(folder, "rubber", [runs[name] for name in unseen], 0.5, {}, {})
    for name, one in judged(options.realgap, path, options.fit / "best.ron").items():
        if name != "all":
            row(name, one)
    if options.rubber:
        return
    laps = [name for name in runs if name.startswith("slippery_laps")]
    on_slippery = AGAIN | SET_UP
    begin = values | {"floor.friction": 0.4, "command.steer_*.delay_s": 0.05, "command.drive_*.delay_s": 0.05}
    for name in laps:
        others = [runs[other] for other in laps if other != name]
        found = fit(options.realgap, study(folder, f"without_{name}", others, 1.5, begin, on_slippery), 80)
        path = study(folder, name, [runs[name]], 0.5, begin | found, {})
        row(name, judged(options.realgap, path)[name], found["floor.friction"])
    for name in ["slippery_notape_01", "tiles_circles_01", "tiles_drift_01"]:
        start = begin if name.startswith("slippery") else values | {"floor.friction": 0.4}
        varied = on_slippery if name.startswith("slippery") else AGAIN
        at_s = middle_s(runs[name])
        halves = [f", crop: (to_s: {at_s})", f", crop: (from_s: {at_s})"]
        for half, other in ((0, 1), (1, 0)):
            path = study(folder, f"{name}_half_{half}", [runs[name]], 0.5, start, varied, halves[half])
            found = fit(options.realgap, path, 60)
            path = study(folder, f"{name}_judged_{other}", [runs[name]], 0.5, start | found, {}, halves[other])
            row(f"{name} half {other + 1}", judged(options.realgap, path)[name], found["floor.friction"])


if __name__ == "__main__":
    main()
