"""Imports the robots of public collections and simulates them for 2 s: the table of docs/robots.md.

    pip install example-robot-data pybullet mujoco gymnasium dm_control pin
    python tools/import_robots.py --realgap target/release/realgap [--csv robots.csv] [FILE ...]

Without files, it imports every URDF of example-robot-data and pybullet_data that has a movable joint, and the MJCF models of gymnasium
and dm_control's suite. It writes only the table and a temporary folder.
"""

import argparse
import csv
import json
import re
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

MOVING = re.compile(rb"""type\s*=\s*["'](revolute|continuous|prismatic|floating|planar|spherical)["']""")


def collections():
    site = Path(sysconfig.get_paths()["purelib"])
    shared = site / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
    for name, folder, pattern in [
        ("example-robot-data", shared, "**/*.urdf"),
        ("pybullet_data", site / "pybullet_data", "**/*.urdf"),
        ("gymnasium", site / "gymnasium" / "envs" / "mujoco" / "assets", "*.xml"),
        ("dm_control", site / "dm_control" / "suite", "*.xml"),
    ]:
        for path in sorted(folder.glob(pattern)):
            if path.suffix == ".xml" or MOVING.search(path.read_bytes()):
                yield name, folder, path


def call(arguments, timeout_s):
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=timeout_s)
    except subprocess.TimeoutExpired:
        return 1, "", f"not done after {timeout_s} s"
    return done.returncode, done.stdout, done.stderr


def reason(text):
    lines = [line for line in text.splitlines() if line.startswith("error") or ": " in line]
    lines = [line for line in lines if not line.startswith("note")]
    first = (lines or text.splitlines() or ["?"])[0]
    return re.sub(r"/\S*/", "", first)[:150]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--realgap", default="realgap")
    parser.add_argument("--csv", type=Path, help="write the rows here, too")
    parser.add_argument("--match", default="", help="only files whose path contains this")
    parser.add_argument("--no-simulation", action="store_true")
    options = parser.parse_args()
    robots = [("given", path.parent, path) for path in options.files] or list(collections())
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for collection, root, path in robots:
            if options.match not in str(path):
                continue
            ron = Path(folder) / "robot.ron"
            ron.unlink(missing_ok=True)
            arguments = [options.realgap, "robot", "import", str(path), "-o", str(ron), "--force", "--format", "json"]
            code, out, err = call(arguments, 120)
            row = {"collection": collection, "name": str(path.relative_to(root)), "imports": code == 0}
            row |= {"simulates": None, "bodies": "", "joints": "", "notes": "", "why": ""}
            if code == 0:
                report = json.loads(out)
                row |= {key: report[key] for key in ("bodies", "joints")}
                row["notes"] = len(report["notes"])
            else:
                row["why"] = reason(err)
            if code == 0 and not options.no_simulation:
                run = Path(folder) / "run.csv"
                arguments = [options.realgap, "simulate", str(ron), "--duration", "2", "-o", str(run), "--force"]
                code, out, err = call(arguments, 300)
                diverged = "diverged" in out + err
                row["simulates"] = code == 0 and not diverged
                if not row["simulates"]:
                    row["why"] = reason(next((l for l in (out + err).splitlines() if "diverged" in l), err))
            rows.append(row)
            shown = {True: "yes", False: "NO", None: "-"}
            print(f"{collection:20} {row['name'][:60]:60} {shown[row['imports']]:4} {shown[row['simulates']]:4} "
                  f"{row['bodies']!s:>4} {row['joints']!s:>4} {row['why']}", flush=True)
    for collection in sorted({row["collection"] for row in rows}):
        own = [row for row in rows if row["collection"] == collection]
        imported = [row for row in own if row["imports"]]
        simulated = [row for row in imported if row["simulates"]]
        print(f"{collection}: {len(imported)} of {len(own)} import, {len(simulated)} of those simulate 2 s")
    if options.csv:
        with options.csv.open("w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
