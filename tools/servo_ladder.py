"""Fits each friction model of a servo to recordings with two gains and evaluates it on the third gain (docs/validation/servo.md).

python tools/servo_ladder.py ../shared/data/servo_pendulum [--budget 600] [--realgap target/release/realgap]

Every model is sweeps/servo_xl330_fit.ron with fewer or more parameters; parameters that are left out are 0.
"""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

STRIBECK = ["servo.stribeck_nm", "servo.stribeck_speed_rad_s"]
LOAD = ["servo.motor_load", "servo.output_load"]
QUADRATIC = ["servo.quadratic_1_nm"]
RUNGS = [
    ("Coulomb and viscous", []),
    ("and Stribeck", STRIBECK),
    ("and load, no Stribeck", LOAD),
    ("and load, Stribeck", LOAD + STRIBECK),
    ("and load, quadratic (shipped)", LOAD + QUADRATIC),
]
RANGES = {"servo.stribeck_nm": (0, 0.05), "servo.stribeck_speed_rad_s": (0.05, 3)}

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("recordings", type=pathlib.Path)
arguments.add_argument("--budget", type=int, default=600)
arguments.add_argument("--realgap", default="target/release/realgap")
given = arguments.parse_args()

project = pathlib.Path(__file__).parent.parent
text = (project / "sweeps/servo_xl330_fit.ron").read_text()
text = text.replace('"../morphologies', f'"{(project / "morphologies").resolve()}')


def study(terms):
    """The study with these friction terms beyond Coulomb and viscous friction."""
    kept = [
        line for line in text.splitlines()
        if not any(f'"{name}"' in line for name in LOAD + QUADRATIC) or any(f'"{name}"' in line for name in terms)
    ]
    more = [f'        (name: "{n}", from: {RANGES[n][0]}, to: {RANGES[n][1]}),' for n in terms if n in RANGES]
    at = next(i for i, line in enumerate(kept) if "servo.viscous_nm_s_rad" in line)
    return "\n".join(kept[: at + 1] + more + kept[at + 1 :])


def run(*words):
    done = subprocess.run([given.realgap, *words], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return done.stdout


print("| friction | judged on | the fit's own, mrad | held out, mrad |\n|---|---|---|---|")
with tempfile.TemporaryDirectory() as folder:
    for name, terms in RUNGS:
        path = pathlib.Path(folder) / "study.ron"
        path.write_text(study(terms))
        for held_out in ["100", "800"]:
            files = lambda gains: [w for g in gains for w in ("--recordings", str(given.recordings / f"kp{g}_*.csv"))]
            fitted = files([g for g in ["100", "200", "800"] if g != held_out])
            out = pathlib.Path(folder) / f"{re.sub('[^a-z]', '', name.lower())}_{held_out}"
            run("tune", str(path), "--optimizer", "cma-es", "--budget", str(given.budget), "--jobs", "1", "-o", str(out), *fitted)
            error = lambda which: json.loads(
                run("evaluate", str(path), "--parameters", str(out / "best.ron"), "--format", "json", *which)
            )["angle_mrad"]
            own, other = error(fitted), error(files([held_out]))
            value = lambda e: e["mean"] if isinstance(e, dict) else e
            print(f"| {name} | {held_out} | {value(own):.1f} | {value(other):.1f} |", flush=True)
