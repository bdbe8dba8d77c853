"""Simulates two seconds of every MJCF of the installed collections as it is imported, and prints those that do not end well.

    python tools/mjcf_runs.py REALGAP [--only TEXT] [--workers 1]

A model without bodies is not counted. Needs mujoco (for the list of models); not a part of the tests.
"""

import argparse
import collections
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import time

try:
    import mujoco
except ImportError as missing:
    sys.exit(f"SKIPPED: {missing}; pip install mujoco")

from compiled_mjcf import wheels

LIMIT_S = 60


def has_bodies(path):
    try:
        return mujoco.MjSpec.from_file(path).compile().nbody > 1
    except Exception:  # MuJoCo refuses the file.
        return False


def run(realgap, path):
    began = time.monotonic()
    command = [realgap, "simulate", path, "--duration", "2", "--format", "json"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5 * LIMIT_S)
    except subprocess.TimeoutExpired:
        return "slow", 5.0 * LIMIT_S, ""
    took_s = time.monotonic() - began
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        return "refused", took_s, " ".join(done.stderr.split())[-300:]
    about = f"{answer['engine'].split()[0]}, timestep {1e3 * answer['timestep_s']:.3g} ms, {answer['cpu_s']:.1f} s CPU"
    if answer["status"]["status"] != "completed":
        return "diverged", took_s, f"{about}: {answer['status']}"
    # CPU time does not depend on what else the machine does.
    return ("slow" if answer["cpu_s"] > LIMIT_S else "ended"), took_s, about


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("realgap")
    words.add_argument("--only", default="")
    words.add_argument("--workers", type=int, default=1)
    given = words.parse_args()
    realgap = str(pathlib.Path(given.realgap).resolve())
    todo = [(package, path) for package, path in wheels() if path and given.only in path and has_bodies(path)]
    counts = collections.defaultdict(collections.Counter)
    with concurrent.futures.ThreadPoolExecutor(given.workers) as pool:
        ends = pool.map(lambda one: run(realgap, one[1]), todo)
        for (package, path), (how, took_s, about) in zip(todo, ends):
            counts[package][how] += 1
            if how != "ended" or took_s > LIMIT_S / 4:
                print(f"{how} {took_s:.0f} s {path.split('site-packages/')[-1]}: {about}", flush=True)
    for package, count in counts.items():
        print(f"{package}: {', '.join(f'{n} {how}' for how, n in count.items())}")


if __name__ == "__main__":
    main()
