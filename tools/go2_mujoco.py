"""Fits the legs of a real quadruped in MuJoCo, as a peer of `realgap start --pd` and `realgap tune`.

    python tools/go2_mujoco.py FOLDER [--fit 0 0.5] [--judge 0.5 1] [--runs 500]

    python tools/go2_mujoco.py FOLDER --study OUT     # the same question as a study of MuJoCo's adapter (docs/simulator.md)
    realgap tune OUT/study.ron --optimizer gauss-newton --budget 500 --allow-command -o OUT/fit
    realgap evaluate OUT/study.ron --parameters OUT/fit/best.ron --recordings OUT/second.csv --allow-command

FOLDER holds go2_hang.csv and go2.xml (a Unitree Go2 on a stand, iit-DLSLab/sim2real-robot-identification, BSD-3-Clause).
49 parameters: armature, viscous friction, dry friction and zero of each joint, and one delay. MuJoCo at 5 ms, gains 20 N m/rad
and 1.5 N m s/rad, forward differences, soft-L1 at 5 mrad, start at the file's own values. `--fit` and `--judge` are shares of
the log. Needs numpy, scipy and mujoco; not a part of the tests.
"""

import argparse
import csv
import pathlib
import re
import sys
import time

try:
    import mujoco
    import numpy as np
    from scipy.optimize import least_squares
except ImportError as missing:
    sys.exit(f"SKIPPED: {missing}; pip install numpy scipy mujoco")

KP, KD, STEP_S = 20.0, 1.5, 0.005


def read(folder):
    with open(folder / "go2_hang.csv") as file:
        rows = list(csv.reader(file))
    head, table = rows[0], np.array(rows[1:], dtype=float)
    names = [name[:-4] for name in head[1:] if not name.endswith("_command_rad")]
    columns = {name: index for index, name in enumerate(head)}
    angles = table[:, [columns[f"{name}_rad"] for name in names]]
    commands = table[:, [columns[f"{name}_command_rad"] for name in names]]
    return names, table[:, 0], angles, commands


class Legs:
    def __init__(self, folder, names):
        text = (folder / "go2.xml").read_text().replace("<freejoint/>", "")
        # The poses of the keyframes are those of a free base.
        text = re.sub(r"<keyframe>.*?</keyframe>", "", text, flags=re.DOTALL)
        self.model = mujoco.MjModel.from_xml_string(text)
        self.model.opt.timestep = STEP_S
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in names]
        self.at = np.array([joint.qposadr[0] for joint in joints])
        self.speed_at = np.array([joint.dofadr[0] for joint in joints])
        drives = {self.model.actuator(k).trnid[0]: k for k in range(self.model.nu)}
        self.drive = np.array([drives[joint.id] for joint in joints])
        self.limit = self.model.actuator_ctrlrange[self.drive, 1]
        self.own = np.concatenate([
            self.model.dof_armature[self.speed_at], self.model.dof_damping[self.speed_at],
            self.model.dof_frictionloss[self.speed_at], np.zeros(len(names)), [0.0],
        ])
        self.runs = 0

    def run(self, values, times, angles, commands):
        n = len(self.at)
        armature, viscous, dry, zero = (values[k * n:(k + 1) * n] for k in range(4))
        model, data = self.model, self.data
        model.dof_armature[self.speed_at] = armature
        model.dof_damping[self.speed_at] = viscous
        model.dof_frictionloss[self.speed_at] = dry
        mujoco.mj_resetData(model, data)
        data.qpos[self.at] = angles[0] - zero
        data.qvel[self.speed_at] = (angles[1] - angles[0]) / (times[1] - times[0])
        seen = np.empty_like(angles)
        late = np.clip(times - values[-1], times[0], None)
        # A command is held until the next; between, the delayed command is interpolated, so that the delay has a derivative.
        delayed = np.stack([np.interp(late, times, commands[:, k]) for k in range(n)], axis=1)
        for k in range(len(times)):
            seen[k] = data.qpos[self.at] + zero
            torque = KP * (delayed[k] - zero - data.qpos[self.at]) - KD * data.qvel[self.speed_at]
            data.ctrl[self.drive] = np.clip(torque, -self.limit, self.limit)
            mujoco.mj_step(model, data)
        self.runs += 1
        return seen


def write_study(folder, out, shares, names, low, high):
    """The fitted and the judged part of the log, the model, and a study of them with the same parameters and ranges."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "go2.xml").write_bytes((folder / "go2.xml").read_bytes())
    with open(folder / "go2_hang.csv") as file:
        head, *rows = list(csv.reader(file))
    for share, name in zip(shares, ("first.csv", "second.csv")):
        part = rows[round(share[0] * len(rows)):round(share[1] * len(rows))]
        with open(out / name, "w", newline="") as file:
            csv.writer(file).writerows([head, *part])
    quantities = ("armature", "damping", "frictionloss", "zero")
    places = [f"joint.{joint}.{quantity}" for quantity in quantities for joint in names] + ["command.delay"]
    lines = "".join(
        f'        (name: "{place}", from: {float(a)!r}, to: {float(b)!r}),\n' for place, a, b in zip(places, low, high)
    )
    (out / "study.ron").write_text(f"""Study(
    simulator: MujocoModel(model: "go2.xml", pd: ({KP!r}, {KD!r}), hold: true, python: {sys.executable!r}),
    recordings: ["first.csv"],
    start: FromRecording,
    set: {{"option.timestep": {STEP_S!r}}},
    parameters: [
{lines}    ],
    metric: "joints",
    score: Single,
)
""".replace(repr(sys.executable), f'"{sys.executable}"'))


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder", type=pathlib.Path)
    words.add_argument("--fit", nargs=2, type=float, default=[0.0, 0.5])
    words.add_argument("--judge", nargs=2, type=float, default=[0.5, 1.0])
    words.add_argument("--runs", type=int, default=500)
    words.add_argument("--study", type=pathlib.Path, metavar="OUT", help="write a study of the adapter, and fit nothing")
    given = words.parse_args()
    names, times, angles, commands = read(given.folder)
    legs = Legs(given.folder, names)
    n, count = len(names), len(times)

    def part(share):
        rows = slice(round(share[0] * count), round(share[1] * count))
        return times[rows], angles[rows], commands[rows]

    fitted, judged = part(given.fit), part(given.judge)
    low = np.concatenate([np.full(n, 0.001), np.zeros(2 * n), np.full(n, -0.1), [0.0]])
    high = np.concatenate([np.full(n, 0.2), np.full(2 * n, 3.0), np.full(n, 0.1), [0.05]])
    scale = high - low
    if given.study:
        return write_study(given.folder, given.study, (given.fit, given.judge), names, low, high)

    def mean_error(values, rows):
        return 1e3 * np.mean(np.abs(legs.run(values, *rows) - rows[1]))

    start = np.clip(legs.own, low + 1e-6 * scale, high - 1e-6 * scale)
    print(f"own values: fitted part {mean_error(start, fitted):.2f} mrad, judged part {mean_error(start, judged):.2f} mrad")
    began = time.process_time()
    legs.runs = 0

    def errors(values):
        return (legs.run(values, *fitted) - fitted[1]).ravel()

    def jacobian(values):
        here = errors(values)
        columns = []
        for axis in range(len(values)):
            step = 1e-3 * scale[axis] * (1 if values[axis] < 0.5 * (low + high)[axis] else -1)
            moved = values.copy()
            moved[axis] += step
            columns.append((errors(moved) - here) / step)
        return np.stack(columns, axis=1)

    jacobians = max(given.runs // (len(start) + 2), 1)
    best = least_squares(
        errors, start, jac=jacobian, bounds=(low, high), x_scale=scale, loss="soft_l1", f_scale=0.005, max_nfev=jacobians
    )
    cpu = time.process_time() - began
    print(
        f"{legs.runs} runs, {cpu:.1f} CPU s: fitted part {mean_error(best.x, fitted):.2f} mrad, "
        f"judged part {mean_error(best.x, judged):.2f} mrad; delay {1e3 * best.x[-1]:.1f} ms"
    )


if __name__ == "__main__":
    main()
