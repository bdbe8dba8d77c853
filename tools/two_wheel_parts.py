"""Measures which part of the model of the two-wheel robot causes the gap: each part in turn is replaced by its ideal, on the held-out runs.

python3 tools/two_wheel_parts.py RUNS.csv     (REALGAP names the program)

Prints a table for docs/validation/sensing.md: the share of the time in which held-out runs are in the 90 % region of 200 repeats over 3 s,
and the energy score.
"""

import json
import os
import subprocess
import sys
import tempfile

PROGRAM = os.environ.get("REALGAP", "target/release/realgap")
PARTS = [
    ("as fitted", []),
    ("ideal actuators", ["ideal_actuator"]),
    ("ideal sensor", ["ideal_sensor"]),
    ("ideal control", ["ideal_control"]),
    ("all three ideal", ["ideal_actuator", "ideal_sensor", "ideal_control"]),
]

# The half of the runs to which the studies were not fitted.
HELD_OUT = "1"

print("| condition | " + " | ".join(name for name, _ in PARTS) + " |")
print("|---" * (len(PARTS) + 1) + "|")
for condition in ["us1", "us_bayesian", "ir", "ir_bayesian"]:
    cells = []
    for _, switched in PARTS:
        with tempfile.TemporaryDirectory() as folder:
            command = [PROGRAM, "ensemble", f"sweeps/two_wheel_{condition}.ron", "--recordings", sys.argv[1]]
            command += ["--every", "2", "--offset", HELD_OUT, "--format", "json", "--jobs", "1", "-o", folder]
            for name in switched:
                command += ["--set", f"vehicle.{name}=1"]
            done = subprocess.run(command, capture_output=True, text=True, check=True)
        reality = json.loads(done.stdout)["reality"]
        inside = next(c["over_time"] for c in reality["coverage"] if c["level"] == 0.9)
        cells.append(f"{100 * inside:.0f} %, {1e3 * reality['energy_score_m']:.1f} mm")
    print(f"| `{condition}` | " + " | ".join(cells) + " |")
