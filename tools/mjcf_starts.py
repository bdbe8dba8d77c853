"""Begins and fits studies of public MJCF robots from logs that MuJoCo makes of them, and prints a table.

    python tools/mjcf_starts.py REALGAP FOLDER [--only TEXT] [--each 6] [--no-tune] [--workers 1] [--seed 0]

Of every collection that is installed, up to `--each` robots are taken, evenly spaced in their sorted order: those whose joints turn or
slide, whose root is held or has a free joint (which is removed: the robot hangs, and objects lie), and whose actuators drive joints. In MuJoCo, the
joints follow chirps within their ranges: servos of the file by `ctrl`, motors by a firmware with gains (`--pd`). Six values of two
joints are hidden: armature and dry friction, and the stiffness of a servo or the viscous friction beside a motor; what is added to
those of the file is 5 to 20 % of the torque that the motion needs. Dry friction is hard, contacts are off, angles have a noise of
0.2 mrad.

`realgap start` gets the log and the file as it is. Of the study that it writes, the six hidden parameters are kept with their ranges,
and `realgap tune` says 90 % intervals for them. Needs mujoco and numpy; not a part of the tests.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys
import time
import zlib

try:
    import mujoco
    import numpy as np
except ImportError as missing:
    sys.exit(f"SKIPPED: {missing}; pip install mujoco numpy")

from compiled_mjcf import AFFINE, COLLECTIONS, DRIVES_JOINT, HINGE, SLIDE, wheels
from compiled_motion import joint_name

TIMESTEP_S, SAMPLE_S, DURATION_S = 1e-4, 0.01, 6.0
NOISE = 2e-4
# A joint that goes farther, in radians or metres, is a root that falls.
FARTHEST = 20
MOST_JOINTS = 40
# The firmware of motors: natural frequency (rad/s) and damping ratio of each joint alone, and the error at which it asks for the whole
# torque of a motor, radians (metres for slides) per amplitude.
FIRMWARE_RAD_S, RATIO, FULL = 2 * np.pi * 5, 0.7, 0.5
FIXED, NO_BIAS = int(mujoco.mjtGain.mjGAIN_FIXED), int(mujoco.mjtBias.mjBIAS_NONE)
NO_DYNAMICS = int(mujoco.mjtDyn.mjDYN_NONE)
START_S, TUNE_S = 300, 600


class Refused(Exception):
    """A model that is not one of those that this experiment is about."""


def hung(path):
    """The model without a free root, with hard dry friction and without contacts; and the posture of its first keyframe."""
    spec = mujoco.MjSpec.from_file(path)
    whole = spec.compile()
    # Objects beside a robot that is held lie where the file places them.
    free = [j for body in spec.worldbody.bodies for j in body.joints if j.type == mujoco.mjtJoint.mjJNT_FREE]
    home = {}
    if whole.nkey:
        for j in range(whole.njnt):
            home[joint_name(whole, j)] = float(whole.key_qpos[0, whole.jnt_qposadr[j]])
    for joint in free:
        spec.delete(joint)
    for key in list(spec.keys):
        spec.delete(key)
    model = spec.compile()
    if not 1 <= model.njnt <= MOST_JOINTS:
        raise Refused(f"{model.njnt} joints")
    if not np.isin(model.jnt_type, (HINGE, SLIDE)).all():
        raise Refused("balls or free joints beyond the root")
    if model.nflex:
        raise Refused("flex")
    for a in range(model.nu):
        is_plain = (
            model.actuator_trntype[a] in DRIVES_JOINT
            and model.actuator_gaintype[a] == FIXED
            and model.actuator_biastype[a] in (NO_BIAS, AFFINE)
            and model.actuator_dyntype[a] == NO_DYNAMICS
        )
        if not is_plain:
            raise Refused("actuators that are not motors or servos of joints")
    if not model.nu:
        raise Refused("no actuators")
    model.opt.timestep = TIMESTEP_S
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.density = model.opt.viscosity = 0
    off = mujoco.mjtDisableBit
    # Some files switch off what this experiment is about.
    model.opt.disableflags &= ~(int(off.mjDSBL_CONSTRAINT) | int(off.mjDSBL_FRICTIONLOSS) | int(off.mjDSBL_LIMIT))
    model.opt.disableflags |= int(off.mjDSBL_CONTACT)
    for reference, impedance in (("jnt_solref", "jnt_solimp"), ("dof_solref", "dof_solimp")):
        getattr(model, reference)[:] = [2 * TIMESTEP_S, 1]
        getattr(model, impedance)[:] = [0.9999, 0.9999, 0.001, 0.5, 2]
    return model, home


class Drive:
    """An actuator with the chirp that its joint follows."""

    def __init__(self, model, a, home, inertia):
        self.a, self.joint = a, int(model.actuator_trnid[a, 0])
        self.name = joint_name(model, self.joint)
        self.q, self.dof = int(model.jnt_qposadr[self.joint]), int(model.jnt_dofadr[self.joint])
        self.gear = float(model.actuator_gear[a, 0])
        self.home, self.inertia = home, inertia
        bias = model.actuator_biasprm[a]
        is_affine = model.actuator_biastype[a] == AFFINE
        self.kind = "motor"
        if is_affine and bias[1] < 0:
            self.kind = "servo"
        elif is_affine and bias[2] < 0:
            self.kind = "speed"
        most = 0.3 if model.jnt_type[self.joint] == HINGE else 0.02
        if model.jnt_limited[self.joint]:
            low, high = model.jnt_range[self.joint]
            most = min(most, 0.8 * (high - home), 0.8 * (home - low))
        self.most = max(most, 0.0)
        # The largest torque at the joint.
        ends = [np.inf]
        if model.actuator_ctrllimited[a] and self.kind == "motor":
            ends.append(np.abs(model.actuator_ctrlrange[a] * model.actuator_gainprm[a, 0] * self.gear).min())
        if model.actuator_forcelimited[a]:
            ends.append(np.abs(model.actuator_forcerange[a] * self.gear).min())
        if model.jnt_actfrclimited[self.joint]:
            ends.append(np.abs(model.jnt_actfrcrange[self.joint]).min())
        self.torque = float(min(ends))
        stiffness = min(inertia * FIRMWARE_RAD_S**2, self.torque / (FULL * max(self.most, 1e-3)))
        self.kp = float(f"{stiffness:.3g}")
        self.kd = float(f"{2 * RATIO * np.sqrt(inertia * stiffness):.3g}")

    def target(self, t, phase):
        # From 0.2 to 1.4 Hz.
        turn = 2 * np.pi * (0.2 * t + 0.1 * t * t)
        rate = 2 * np.pi * (0.2 + 0.2 * t)
        wave = np.sin(turn + phase) - np.sin(phase) * np.exp(-t)
        slope = rate * np.cos(turn + phase) + np.sin(phase) * np.exp(-t)
        return self.home + 0.5 * self.most * wave, 0.5 * self.most * slope

    def command(self, model, t, phase):
        """What the log holds at a time, in the unit of its column."""
        angle, speed = self.target(t, phase)
        gain, bias = model.actuator_gainprm[self.a, 0], model.actuator_biasprm[self.a]
        if self.kind == "servo":
            ctrl = -(bias[0] + bias[1] * self.gear * angle) / gain
            return self.limited(model, ctrl)
        if self.kind == "speed":
            return self.limited(model, -bias[2] * self.gear * speed / gain)
        return angle

    def limited(self, model, ctrl):
        low, high = model.actuator_ctrlrange[self.a]
        return float(np.clip(ctrl, low, high)) if model.actuator_ctrllimited[self.a] else float(ctrl)

    def column(self):
        return self.name + ("_command_rad_s" if self.kind == "speed" else "_command_rad")

    def load_firmware(self, model):
        """Makes a servo of a motor: its gains, and the limit of its torque in place of that of its command."""
        if self.kind != "motor":
            return
        a = self.a
        model.actuator_gainprm[a, :3] = [self.kp / self.gear, 0, 0]
        model.actuator_biastype[a] = AFFINE
        model.actuator_biasprm[a, :3] = [0, -self.kp / self.gear**2, -self.kd / self.gear**2]
        model.actuator_ctrllimited[a] = 0
        if np.isfinite(self.torque):
            model.actuator_forcelimited[a] = 1
            model.actuator_forcerange[a] = np.array([-1, 1]) * self.torque / abs(self.gear)


def homes(model, home):
    out = model.qpos0.copy()
    for j in range(model.njnt):
        q, name = int(model.jnt_qposadr[j]), joint_name(model, j)
        value = home.get(name, out[q])
        if model.jnt_limited[j]:
            low, high = model.jnt_range[j]
            if not low + 0.1 * (high - low) <= value <= high - 0.1 * (high - low):
                value = 0.5 * (low + high)
        out[q] = value
    return out


def moved(model, drives, phases, start):
    """Samples of the time, the coordinates and the commands, and the torques and speeds that the motion needs."""
    data = mujoco.MjData(model)
    data.qpos[:] = start
    samples, squares = [], np.zeros((2, model.nv))
    # The first second, in which the joints find their places, is not recorded.
    for sample in range(round((DURATION_S + 1) / SAMPLE_S) + 1):
        t = sample * SAMPLE_S
        commands = [d.command(model, max(t - 1, 0.0), p) for d, p in zip(drives, phases)]
        if t > 1 - SAMPLE_S / 2:
            samples.append((t - 1, data.qpos.copy(), commands))
            squares += [data.qfrc_actuator**2, data.qvel**2]
        for d, command in zip(drives, commands):
            data.ctrl[d.a] = command
        mujoco.mj_step(model, data, round(SAMPLE_S / TIMESTEP_S))
        if not np.isfinite(data.qpos).all():
            raise Refused("MuJoCo itself diverges")
    return samples, np.sqrt(squares / len(samples))


def hide(model, drives, needed, draw):
    """Hides values of two joints, each a share of what their motion needs, and returns those of the parameters."""
    torques, speeds = needed
    moving = [d for d in drives if d.most > 0.01 * (1 if model.jnt_type[d.joint] == HINGE else 0.1) and speeds[d.dof] > 0]
    truth = {}
    for k in draw.permutation(len(moving))[:2]:
        d = moving[k]
        dof = d.dof

        def more(scale):
            return float(scale) * draw.uniform(0.05, 0.2)

        if d.kind == "servo":
            factor = draw.uniform(0.7, 1.4)
            model.actuator_gainprm[d.a, 0] *= factor
            model.actuator_biasprm[d.a, :2] *= factor
            truth[f"servo.{d.name}.stiffness_nm_rad"] = -float(model.actuator_biasprm[d.a, 1]) * d.gear**2
        elif d.kind == "motor":
            model.dof_damping[dof] = model.dof_damping[dof] * draw.uniform(0.5, 2) + more(torques[dof] / speeds[dof])
            truth[f"hinge.{d.name}.viscous_nm_s_rad"] = float(model.dof_damping[dof])
        model.dof_armature[dof] = model.dof_armature[dof] * draw.uniform(1, 2) + more(d.inertia)
        truth[f"hinge.{d.name}.armature_kg_m2"] = float(model.dof_armature[dof])
        model.dof_frictionloss[dof] = model.dof_frictionloss[dof] * draw.uniform(0.5, 2) + more(torques[dof])
        truth[f"hinge.{d.name}.dry_nm"] = float(model.dof_frictionloss[dof])
    return truth


def log(path, folder, seed):
    """Writes the log of a robot; returns its gains as options of `start`, the hidden values, and what drives it."""
    model, home = hung(path)
    draw = np.random.default_rng(zlib.crc32(str(pathlib.Path(path).name).encode()) + seed)
    data = mujoco.MjData(model)
    start = homes(model, home)
    data.qpos[:] = start
    mujoco.mj_forward(model, data)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    drives, seen = [], set()
    for a in range(model.nu):
        joint = int(model.actuator_trnid[a, 0])
        if joint in seen:
            raise Refused("two actuators of one joint")
        seen.add(joint)
        drives.append(Drive(model, a, float(start[model.jnt_qposadr[joint]]), float(whole[model.jnt_dofadr[joint], model.jnt_dofadr[joint]])))
    phases = draw.uniform(0, 2 * np.pi, len(drives))
    for d in drives:
        d.load_firmware(model)
    _, needed = moved(model, drives, phases, start)
    truth = hide(model, drives, needed, draw)
    if not truth:
        raise Refused("no joint has room to move")
    samples, _ = moved(model, drives, phases, start)
    # Objects beside the robot have no encoders.
    root = [int(model.body_rootid[model.jnt_bodyid[j]]) for j in range(model.njnt)]
    driven = {root[d.joint] for d in drives}
    logged = [j for j in range(model.njnt) if root[j] in driven]
    names, places = [joint_name(model, j) for j in logged], model.jnt_qposadr[logged]
    if max(np.abs(qpos[places] - start[places]).max() for _, qpos, _ in samples) > FARTHEST:
        raise Refused("a root of slides that nothing drives falls")
    rows = [[t, *(qpos[places] + draw.normal(0, NOISE, len(places))), *commands] for t, qpos, commands in samples]
    head = ["t_s", *[f"{name}_rad" for name in names], *[d.column() for d in drives]]
    file = folder / "log.csv"
    file.write_text("\n".join([",".join(head), *[",".join(f"{v:.9g}" for v in row) for row in rows]]) + "\n")
    gains = [f"--pd={d.name}={d.kp:.6g},{d.kd:.6g}" for d in drives if d.kind == "motor"]
    kinds = sorted({d.kind for d in drives})
    more = []
    if model.neq:
        more.append(f"{model.neq} couplings")
    if model.ntendon:
        more.append(f"{model.ntendon} tendons")
    return file, gains, truth, dict(kinds=kinds, driven=len(drives), joints=int(model.njnt), beyond=more)


def call(command, folder, limit_s):
    began = time.monotonic()
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=limit_s)
    except subprocess.TimeoutExpired:
        return None, "", f"no end within {limit_s} s", time.monotonic() - began
    return done.returncode, done.stdout, done.stderr, time.monotonic() - began


def plain(name):
    """A name as the import writes it."""
    return re.sub(r"[^A-Za-z0-9_-]", "_", name)


def of_six(study, truth):
    """The study with the hidden parameters alone; the ranges are those that `start` wrote."""
    lines, lost = [], dict(truth)
    for line in study.read_text().splitlines():
        found = re.match(r'\s*\(name: "([^"]+)", from:', line)
        if found and found[1] not in truth:
            continue
        if found:
            lost.pop(found[1])
        lines.append(line)
    six = study.with_name("six.ron")
    six.write_text("\n".join(lines) + "\n")
    return six, sorted(lost)


def judged(realgap, folder, truth):
    truth = {re.sub(r"^(\w+)\.(.+)\.(\w+)$", lambda m: f"{m[1]}.{plain(m[2])}.{m[3]}", name): v for name, v in truth.items()}
    six, lost = of_six(folder / "study.ron", truth)
    options = ["--optimizer", "gauss-newton", "--budget", "64", "--output", "tuned", "--format", "json"]
    code, out, err, took_s = call([realgap, "tune", six.name, *options], folder, TUNE_S)
    (folder / "tune.json").write_text(out)
    (folder / "tune.txt").write_text(err)
    if code is None or not out.strip():
        return dict(tune=err.strip().splitlines()[-1][:200] if err.strip() else "nothing", tune_s=took_s, lost=lost)
    return dict(tune="ended", tune_s=took_s, lost=lost, intervals=intervals(json.loads(out), truth))


def intervals(answer, truth):
    """Of every hidden parameter its true value and the parts of its 90 % interval."""
    out = {}
    for verdict in answer["verdicts"]:
        parts = verdict.get("intervals") or [verdict["interval"]]
        if verdict["parameter"] in truth and parts[0]:
            out[verdict["parameter"]] = [truth[verdict["parameter"]], parts]
    return out


def holds(span):
    true, parts = span
    return any(low <= true <= high for low, high in parts)


def begun(given):
    realgap, root, package, path, is_tuned, seed = given
    short = path.split(f"/{package}/", 1)[-1]
    folder = root / re.sub(r"[^A-Za-z0-9]+", "_", f"{package}_{short}")
    folder.mkdir(parents=True, exist_ok=True)
    line = dict(package=package, path=short)
    try:
        file, gains, truth, about = log(path, folder, seed)
    except Refused as why:
        return dict(line, left=str(why))
    except Exception as error:  # MuJoCo refuses the file.
        return dict(line, left=str(error).splitlines()[0][:120])
    for old in ("study.ron", "tuned"):
        subprocess.run(["rm", "-rf", str(folder / old)], check=True)
    command = [realgap, "start", file.name, path, *gains, "-o", "study.ron"]
    (folder / "command.txt").write_text(" ".join(f"'{word}'" for word in command) + "\n")
    code, out, err, took_s = call(command, folder, START_S)
    (folder / "start.txt").write_text(out + "\n--- errors\n" + err)
    doubts = [text for text in out.splitlines() if text.startswith("doubt:")]
    line.update(about, truth=truth, start_s=took_s, began=code == 0 and not doubts)
    if code != 0:
        line["why"] = " ".join(err.strip().splitlines())[-400:]
        return line
    line["doubts"] = doubts
    if is_tuned and line["began"]:
        line.update(judged(realgap, folder, truth))
    return line


def chosen(each, only):
    """Up to so many models of each collection, evenly spaced, each model once."""
    of, seen = {}, set()
    for package, path in wheels({**COLLECTIONS, "gymnasium_robotics": ["envs/assets"]}):
        if path is None or only not in path:
            continue
        try:
            model, _ = hung(path)
            joints = {int(j) for j in model.actuator_trnid[:, 0]}
            key = (package, model.nu, *(joint_name(model, j) for j in range(model.njnt)))
            if len(joints) < model.nu or key in seen:
                continue
        except Exception:
            continue
        seen.add(key)
        of.setdefault(package, []).append(path)
    for package, paths in of.items():
        places = np.unique(np.linspace(0, len(paths) - 1, min(each, len(paths))).round().astype(int))
        yield from ((package, paths[i]) for i in places)


def told(line):
    if "left" in line:
        return f"| {line['package']} | {line['path']} | - | left out: {line['left']} |"
    inside = line.get("intervals", {})
    said = f"{sum(map(holds, inside.values()))} of {len(inside)}" if inside else line.get("tune", "")
    why = line.get("why") or "; ".join(line.get("doubts", []))
    words = [f"{line['joints']} joints, {line['driven']} {'/'.join(line['kinds'])}", *line["beyond"]]
    return f"| {line['package']} | {line['path']} | {', '.join(words)} | {'yes' if line['began'] else 'no: ' + why} | {line['start_s']:.0f} s | {said} |"


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("realgap")
    words.add_argument("folder", type=pathlib.Path)
    words.add_argument("--only", default="")
    words.add_argument("--each", type=int, default=6)
    words.add_argument("--no-tune", action="store_true")
    words.add_argument("--workers", type=int, default=1)
    words.add_argument("--seed", type=int, default=0)
    given = words.parse_args()
    root = given.folder.resolve()
    root.mkdir(parents=True, exist_ok=True)
    realgap = str(pathlib.Path(given.realgap).resolve())
    todo = [(realgap, root, package, path, not given.no_tune, given.seed) for package, path in chosen(given.each, given.only)]
    print("| collection | model | robot | begins | time | true values in 90 % intervals |\n|---|---|---|---|---|---|", flush=True)
    lines = []
    with concurrent.futures.ThreadPoolExecutor(given.workers) as pool:
        for line in pool.map(begun, todo):
            print(told(line), flush=True)
            lines.append(line)
            (root / "all.json").write_text(json.dumps(lines, indent=1))
    kept = [line for line in lines if "left" not in line]
    spans = [span for line in kept for span in line.get("intervals", {}).values()]
    print(f"{sum(line['began'] for line in kept)} of {len(kept)} begin; {sum(map(holds, spans))} of {len(spans)} intervals hold the true value")


if __name__ == "__main__":
    main()
