#!/usr/bin/env python3
"""Makes stand-in recordings of many random robots on one hidden floor in MuJoCo, and the study of them.

    python3 -m pip install -r tools/requirements.txt
    python3 tools/record_fleet.py real_trajectories/fleet_mujoco --study sweeps/fleet_floor.ron
    realgap sweep sweeps/fleet_floor.ron
    python3 tools/record_fleet.py hundred/robots --robots 100 --study hundred/floor.ron

Robots are drawn one seed after the other (`realgap robot genome random`, 2 to 5 modules). A robot is kept if it develops, stays in the pose in
which it is put down, and walks at least a body length in MuJoCo. The same seed gives the same files. `--robots 100` makes as many as paper 003 had.
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

import record_standin
from standin import Robot


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("output", type=pathlib.Path, help="folder: one below it for every robot")
    p.add_argument("--study", type=pathlib.Path, required=True, help="write the study of them to this file")
    p.add_argument("--realgap", default="target/release/realgap", help="the program (default target/release/realgap)")
    p.add_argument("--robots", type=int, default=30)
    p.add_argument("--repeats", type=int, default=2, help="recordings of each robot (default 2)")
    p.add_argument("--friction", type=float, default=0.35, help="of the hidden floor (default 0.35)")
    p.add_argument("--duration", type=float, default=10.0, help="seconds (default 10)")
    p.add_argument("--rate", type=float, default=6.0, help="samples a second (default 6)")
    p.add_argument("--seed", type=int, default=1, help="of the first robot that is tried (default 1)")
    return p.parse_args()


def developed(a, seed, folder):
    """The file of the robot of this seed; None if it cannot be built or does not stand."""
    genome, robot = folder / "genome.ron", folder / "robot.ron"
    modules = 2 + seed % 4
    name = f"random_{seed:04}"
    run = lambda *words: subprocess.run([a.realgap, *map(str, words)], capture_output=True, text=True)
    made = run("robot", "genome", "random", "--modules", modules, "--seed", seed, "--name", name, "-o", genome, "--force")
    if made.returncode:
        raise SystemExit(made.stderr)
    # Plates that stick out beyond their cubes, as those of morphologies/tripod.ron do: which of the two slips is then no toss-up.
    genome.write_text(genome.read_text().rstrip().removesuffix(")") + "    development: (plate_side_m: 0.064),\n)\n")
    made = run("robot", "develop", genome, "-o", robot, "--force", "--format", "json")
    if made.returncode:
        return None
    said = json.loads(made.stdout)
    stands = said["at_rest"] and not said["toppled"] and said["hinges"]
    stands = stands and all(warning["code"] == "servo-too-slow" for warning in said["warnings"])
    return robot if stands else None


def write_study(a, kept):
    """The study of these robots, which names them from its own folder."""
    a.study.parent.mkdir(parents=True, exist_ok=True)
    beside = pathlib.Path(os.path.relpath(a.output, a.study.parent)).as_posix()
    robots = "\n".join(
        f'        (morphology: "{beside}/{name}/robot.ron", recordings: ["{beside}/{name}/*.csv"]),' for name in kept
    )
    a.study.write_text(
        f"""// Which floor makes {len(kept)} random robots walk as they were recorded, and does a floor that was tuned on some hold for another?
// The question of paper 003. STAND-INS: recorded in MuJoCo on a hidden floor by tools/record_fleet.py.
Study(
    description: "one floor under {len(kept)} random robots",
    robots: [
{robots}
    ],
    start: Settled,
    duration_s: {a.duration},
    // The engine that is cheap for robots of few modules; without this line Rapier takes nearly five times as long.
    set: {{"solver.engine": 1}},
    parameters: [
        (name: "floor.friction", from: 0.05, to: 1.0, points: 20),
        // With this the grid is paper 003's but for one column; it costs twenty times as much.
        // (name: "floor.restitution", from: 0.0, to: 0.9, points: 21),
    ],
    metric: "displacement",
)
"""
    )


def main():
    a = arguments()
    a.output.mkdir(parents=True, exist_ok=True)
    kept, seed = [], a.seed
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        while len(kept) < a.robots:
            file = developed(a, seed, scratch)
            seed += 1
            if file is None:
                continue
            mjcf = scratch / f"random_{seed - 1:04}.mjcf"
            subprocess.run([a.realgap, "robot", "export", str(file), "--format", "mjcf", "-o", str(mjcf), "--force"], check=True, capture_output=True)
            robot = Robot(mjcf)
            folder = a.output / robot.name
            how = record_standin.arguments(
                [str(mjcf), "-o", str(folder), "--friction", str(a.friction), "--repeats", str(a.repeats)]
                + ["--duration", str(a.duration), "--rate", str(a.rate), "--seed", str(a.seed)]
            )
            robot.set_friction(a.friction)
            # The timestep is four times that of the file, because a stand-in may have any accuracy.
            robot.model.opt.timestep = 1 / 2000
            runs = [record_standin.record(robot, how, repeat) for repeat in range(a.repeats)]
            far = [np.linalg.norm(positions[-1, :2] - positions[0, :2]) for _, positions, _ in runs]
            if min(far) < 0.058:
                continue
            record_standin.write_all(robot, how, runs)
            (folder / "robot.ron").write_text(file.read_text())
            kept.append(robot.name)
            print(f"{robot.name}: {', '.join(f'{m:.3f} m' for m in far)}", flush=True)
    write_study(a, kept)
    print(f"{len(kept)} robots of {seed - a.seed} seeds; {a.study}")


if __name__ == "__main__":
    main()
