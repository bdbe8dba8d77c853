#!/usr/bin/env python3
"""Makes stand-in recordings of a robot in MuJoCo, which takes the place of reality.

    realgap robot export morphologies/tripod.ron --format mjcf -o tripod.mjcf
    python3 -m pip install -r tools/requirements.txt
    python3 tools/record_standin.py tripod.mjcf -o DIR --friction 0.5

Repeats differ by start, servo zeros and camera errors, drawn from the seed; the same seed gives the same files.
"""

import argparse
import pathlib
import sys

import mujoco
import numpy as np

from standin import Robot


def arguments(words=None):
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("mjcf", type=pathlib.Path, help="file written by `realgap robot export --format mjcf`")
    p.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for the recordings")
    p.add_argument("--friction", type=float, help="friction coefficient robot-floor (default: that of the file)")
    p.add_argument("--repeats", type=int, default=10)
    p.add_argument("--duration", type=float, default=20.0, help="seconds (default 20)")
    p.add_argument("--rate", type=float, default=30.0, help="samples per second (default 30)")
    p.add_argument("--timestep", type=float, help="seconds (default: that of the file)")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--start-position-noise", type=float, default=0.001, help="sd, m (default 0.001)")
    p.add_argument("--start-angle-noise", type=float, default=0.0175, help="sd of tilt and of heading, rad (default 0.0175)")
    p.add_argument("--servo-zero-noise", type=float, default=0.00436, help="sd, rad (default 0.00436)")
    p.add_argument("--camera-noise", type=float, default=0.001, help="sd per axis, m (default 0.001)")
    p.add_argument("--camera-angle-noise", type=float, default=0.005, help="sd, rad (default 0.005)")
    return p.parse_args(words)


def turn_by(rotation_vectors, quaternions):
    """Quaternions rotated by small rotation vectors in the world frame."""
    turned = np.empty_like(quaternions)
    for k, (vector, quat) in enumerate(zip(rotation_vectors, quaternions)):
        angle = np.linalg.norm(vector)
        error = np.array([1.0, 0, 0, 0])
        if angle > 0:
            mujoco.mju_axisAngle2Quat(error, vector / angle, angle)
        mujoco.mju_mulQuat(turned[k], error, quat)
    return turned


def record(robot, a, repeat):
    """One repeat: times, recorded positions and quaternions."""
    # The start and the noise have separate random streams, so that more samples do not change the start.
    start, camera = (np.random.default_rng([a.seed, repeat, stream]) for stream in (1, 2))
    shift_m = start.normal(0, a.start_position_noise, 3)
    azimuth = start.uniform(0, 2 * np.pi)
    tilt, heading = start.normal(0, a.start_angle_noise, 2)
    zero_rad = start.normal(0, a.servo_zero_noise, len(robot.joints))
    turn_rad = np.array([tilt * np.cos(azimuth), tilt * np.sin(azimuth), heading])
    data = robot.place(shift_m, turn_rad, zero_rad)
    if not robot.settle(data, zero_rad):
        print(f"warning: repeat {repeat} did not come to rest before the start", file=sys.stderr)
    times, positions, quaternions = robot.walk(data, a.duration, a.rate, zero_rad)
    positions = positions + camera.normal(0, a.camera_noise, positions.shape)
    error = camera.normal(0, a.camera_angle_noise / np.sqrt(3), positions.shape)
    return times, positions, turn_by(error, quaternions)


def write(path, times, positions, quaternions):
    # Values are rounded to micrometres and microradians, far below the errors of the camera.
    lines = ["t_s,x_m,y_m,z_m,qw,qx,qy,qz"]
    for t, p, q in zip(times, positions, quaternions):
        lines.append(f"{t:.6f}," + ",".join(f"{v:.6f}" for v in (*p, *q)))
    path.write_text("\n".join(lines) + "\n")


def write_all(robot, a, runs):
    """Writes every repeat to a file, and a description of their source."""
    a.output.mkdir(parents=True, exist_ok=True)
    for repeat, run in enumerate(runs):
        write(a.output / f"run_{repeat:02}.csv", *run)
    friction = float(robot.model.geom_friction[robot.floor, 0])
    # Folders are left out, so that the description does not depend on where it was made.
    command = f"tools/record_standin.py {a.mjcf.name} -o {a.output.name} --friction {friction:g} --seed {a.seed}"
    description = (
        f"recorded from MuJoCo, not from hardware: STAND-IN. MuJoCo {mujoco.__version__}, timestep {robot.model.opt.timestep:g} s, "
        f"implicitfast, elliptic cone, floor friction {friction:g}. {a.repeats} repeats of {a.duration:g} s at {a.rate:g} Hz. "
        f"Noise (standard deviations): start {a.start_position_noise:g} m and {a.start_angle_noise:g} rad, servo zero {a.servo_zero_noise:g} rad, "
        f"camera {a.camera_noise:g} m and {a.camera_angle_noise:g} rad. Command: {command}"
    )
    (a.output / "meta.ron").write_text(
        "(\n"
        f'    robot: "{robot.name}",\n'
        "    source: StandIn,\n"
        f'    description: "{description}",\n'
        '    frame: "world, z up; pose of the tracked module\'s centre",\n'
        '    licence: "MIT OR Apache-2.0",\n'
        ")\n"
    )


def main():
    a = arguments()
    robot = Robot(a.mjcf)
    if a.friction is not None:
        robot.set_friction(a.friction)
    if a.timestep is not None:
        robot.model.opt.timestep = a.timestep
    runs, ends = [], []
    for repeat in range(a.repeats):
        runs.append(record(robot, a, repeat))
        positions = runs[-1][1]
        step = np.diff(positions[:, :2], axis=0)
        ends.append(np.linalg.norm(positions[-1, :2] - positions[0, :2]))
        print(f"run_{repeat:02}: displacement {ends[-1]:.4f} m, path {np.linalg.norm(step, axis=1).sum():.3f} m")
    write_all(robot, a, runs)
    print(f"{a.repeats} recordings of {robot.name} in {a.output}: mean displacement {np.mean(ends):.4f} m, sd {np.std(ends, ddof=min(1, a.repeats - 1)):.4f} m")


if __name__ == "__main__":
    main()
