"""Fits the parameters of the two-wheel robot of paper 000 that the paper does not state to half of the recorded runs of one condition.

python3 tools/fit_two_wheel.py CONDITION RUNS.csv [EVALUATIONS [OFFSET [FROM]]]     (needs numpy; REALGAP names the program)

Minimises the energy score (Gneiting & Raftery 2007) of 100 simulated repeats for every second run (from OFFSET, 0 or 1), which is small
if the repeats have the same distribution as the runs. CMA-ES without restarts; the other runs are not used. The search begins at the
study's values, or at those of the condition FROM, which do not depend on these runs. Prints the values for the study.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

PROGRAM = os.environ.get("REALGAP", "target/release/realgap")
# name, lowest, highest
PARAMETERS = [
    ("speed_m_s", 0.18, 0.24),
    ("drift_rad_s", -0.3, 0.05),
    ("drift_offset_rad", -0.1, 0.1),
    ("drift_sd_rad", 0.0, 0.1),
    ("turn_rate_rad_s", 3.0, 6.0),
    ("turn_coast_rad", 0.0, 0.8),
    ("turn_sd_rad", 0.0, 0.3),
    ("threshold_m", 0.02, 0.2),
    ("reaction_s", 0.0, 0.3),
    ("sampling_s", 0.01, 0.3),
    ("false_alarm_hz", 0.0, 0.5),
    ("start_s", -0.3, 0.2),
    ("start_sd_s", 0.0, 0.3),
    ("late_share", 0.0, 0.7),
    ("late_s", 0.15, 0.45),
    ("frame_sd_s", 0.0, 0.06),
    ("stale_s", 0.25, 0.34),
    ("tag_ahead_m", -0.06, 0.02),
    ("tag_left_m", -0.03, 0.03),
]


def said(condition):
    with open(f"sweeps/two_wheel_{condition}.ron") as study:
        return {name: float(value) for name, value in re.findall(r'"vehicle\.(\w+)": ([-+\d.eE]+)', study.read())}


SAID = said(sys.argv[1])
FROM = said(sys.argv[5]) if len(sys.argv) > 5 else SAID
PARAMETERS = [p for p in PARAMETERS if p[0] in SAID]
LOW, HIGH = (np.array([p[i] for p in PARAMETERS]) for i in (1, 2))
# Parameters that another condition does not state begin in the middle of their ranges.
START = np.clip([FROM.get(p[0], 0.5 * (p[1] + p[2])) for p in PARAMETERS], LOW, HIGH)


def score(values, condition, runs, folder, repeats=100, offset=0):
    command = [PROGRAM, "ensemble", f"sweeps/two_wheel_{condition}.ron", "--recordings", runs, "--every", "2"]
    command += ["--offset", str(offset), "--repeats", str(repeats), "--jobs", "1", "--format", "json", "-o", folder]
    for (name, *_), value in zip(PARAMETERS, values):
        command += ["--set", f"vehicle.{name}={value:.6g}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["reality"]


def main():
    condition, runs = sys.argv[1:3]
    evaluations = int(sys.argv[3]) if len(sys.argv) > 3 else 300
    half = int(sys.argv[4]) if len(sys.argv) > 4 else 0
    rng = np.random.default_rng(1)
    n, size = len(PARAMETERS), 12
    scale = HIGH - LOW
    mean, sigma, shape = (START - LOW) / scale, 0.06, np.ones(n)
    best = (np.inf, START)
    with tempfile.TemporaryDirectory() as folder:
        for generation in range(evaluations // size):
            steps = rng.normal(size=(size, n)) * shape
            places = np.clip(mean + sigma * steps, 0, 1)
            scores = [score(LOW + scale * p, condition, runs, folder, offset=half)["energy_score_m"] for p in places]
            order = np.argsort(scores)
            if scores[order[0]] < best[0]:
                best = (scores[order[0]], LOW + scale * places[order[0]])
            chosen = places[order[: size // 2]]
            weights = np.log(size / 2 + 0.5) - np.log(np.arange(1, size // 2 + 1))
            weights /= weights.sum()
            # A diagonal CMA: variances are adapted to the successful steps.
            spread = weights @ ((chosen - mean) / sigma) ** 2
            mean, shape = weights @ chosen, np.sqrt(0.7 * shape**2 + 0.3 * spread)
            sigma *= 0.97
            print(generation, f"{1e3 * best[0]:.2f} mm", file=sys.stderr)
        final = LOW + scale * mean
        if score(final, condition, runs, folder, offset=half)["energy_score_m"] < best[0]:
            best = (0, final)
        for (name, *_), value in zip(PARAMETERS, best[1]):
            print(f'        "vehicle.{name}": {value:.4g},')
        for offset, which in [(half, "fitted"), (1 - half, "held out")]:
            found = score(best[1], condition, runs, folder, 200, offset)
            share = {round(c["level"], 2): round(c["over_time"], 3) for c in found["coverage"]}
            print(f"# {which}: coverage over time {share}, energy score {1e3 * found['energy_score_m']:.2f} mm "
                  f"(of one more repeat {1e3 * found['expected_energy_score_m']:.2f} mm)")


main()
