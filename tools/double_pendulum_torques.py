"""Linear least squares of a double pendulum's torques, to compare a fit of the torque channel with.

The measured torques of a rigid double pendulum with viscous and dry friction and rotor inertia are linear in nine
combinations of its parameters. They are fitted by ordinary least squares, with speeds and accelerations from a
local cubic over the measured angles (Savitzky-Golay), and judged on other runs.

    python tools/double_pendulum_torques.py FOLDER

FOLDER holds the recordings of the double pendulum (real_trajectories/double_pendulum/README.md says whose); runs
numbered 04 and 05 are judged, the others are fitted.
"""

import argparse
import csv
from pathlib import Path

import numpy as np

GRAVITY_M_S2 = 9.81
LENGTH_M = 0.2
JOINTS = ("shoulder", "elbow")
FROM_S, TO_S = 0.5, 9.2


def read(path):
    with path.open() as file:
        rows = csv.DictReader(file)
        table = {name: [] for name in rows.fieldnames}
        for row in rows:
            for name, value in row.items():
                table[name].append(float(value))
    return {name: np.array(values) for name, values in table.items()}


def local_cubic(times_s, values, half):
    """Value, slope and curvature of a cubic through 2 half + 1 samples around each sample."""
    count = len(times_s)
    found = np.full((3, count), np.nan)
    for k in range(half, count - half):
        near = slice(k - half, k + half + 1)
        t = times_s[near] - times_s[k]
        c = np.polynomial.polynomial.polyfit(t, values[near], 3)
        found[:, k] = c[0], c[1], 2 * c[2]
    return found


def regressor(q, v, a):
    """Torques of both joints as a matrix times the nine parameters: the inertia of the upper link with what it
    carries, inertia and first moment of the lower link, first moment of both, rotor inertia of the shoulder is part
    of the first one; rotor inertia of the elbow, viscous and dry friction of both."""
    (q1, q2), (v1, v2), (a1, a2) = q, v, a
    zero = np.zeros_like(q1)
    cos, sin = np.cos(q2), np.sin(q2)
    # Kinetic energy: half J1 v1^2 + half J2 (v1 + v2)^2 + m2 c2 L v1 (v1 + v2) cos q2, half A2 v2^2.
    coupling_1 = LENGTH_M * (cos * (2 * a1 + a2) - sin * (2 * v1 * v2 + v2 * v2))
    coupling_2 = LENGTH_M * (cos * a1 + sin * v1 * v1)
    rows_1 = [a1, a1 + a2, coupling_1 + GRAVITY_M_S2 * np.sin(q1 + q2), GRAVITY_M_S2 * np.sin(q1), zero, v1, zero, np.tanh(v1 / 0.05), zero]
    rows_2 = [zero, a1 + a2, coupling_2 + GRAVITY_M_S2 * np.sin(q1 + q2), zero, a2, zero, v2, zero, np.tanh(v2 / 0.05)]
    return np.stack(rows_1, -1), np.stack(rows_2, -1)


NAMES = (
    "J1 kg m2", "J2 kg m2", "m2 c2 kg m", "m1 c1 + m2 L kg m", "A2 kg m2",
    "viscous shoulder", "viscous elbow", "dry shoulder", "dry elbow",
)


def prepared(path, half):
    table = read(path)
    times_s = table["t_s"]
    q, v, a = zip(*(local_cubic(times_s, table[f"{name}_rad"], half) for name in JOINTS))
    keep = (times_s >= FROM_S) & (times_s <= TO_S) & np.isfinite(a[0]) & np.isfinite(a[1])
    y = [table[f"{name}_measured_nm"][keep] for name in JOINTS]
    command = [table[f"{name}_command_nm"][keep] for name in JOINTS]
    pick = lambda columns: tuple(column[keep] for column in columns)
    return regressor(pick(q), pick(v), pick(a)), y, command


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--half", type=int, default=8, help="samples on either side of the local cubic")
    arguments = parser.parse_args()
    files = sorted(arguments.folder.glob("*.csv"))
    is_judged = lambda path: path.stem[-2:] in ("04", "05")
    fitted = [prepared(path, arguments.half) for path in files if not is_judged(path)]
    judged = [prepared(path, arguments.half) for path in files if is_judged(path)]
    stack = lambda runs, joint: (
        np.concatenate([x[joint] for x, _, _ in runs]),
        np.concatenate([y[joint] for _, y, _ in runs]),
    )
    (x1, y1), (x2, y2) = stack(fitted, 0), stack(fitted, 1)
    theta, *_ = np.linalg.lstsq(np.concatenate([x1, x2]), np.concatenate([y1, y2]), rcond=None)
    for name, value in zip(NAMES, theta):
        print(f"{name:22} {value: .5f}")
    for label, runs in (("fitted", fitted), ("judged", judged)):
        for joint, name in enumerate(JOINTS):
            x, y = stack(runs, joint)
            command = np.concatenate([c[joint] for _, _, c in runs])
            off = x @ theta - y
            print(
                f"{label} {name:9} mean {np.abs(off).mean():.4f} N m, rms {np.sqrt((off**2).mean()):.4f} N m;"
                f" command instead: mean {np.abs(command - y).mean():.4f}; size {np.abs(y).mean():.4f}"
            )


if __name__ == "__main__":
    main()
