"""Compares imported robots with Pinocchio (URDF) and MuJoCo (MJCF): mass, centre of mass, poses of the bodies, and the mass matrix
of the joints at ten random configurations; and a passive fall and swing of 0.2 s with MuJoCo.

    pip install example-robot-data pybullet mujoco gymnasium dm_control pin
    python tools/check_robots.py --realgap target/release/realgap [--match NAME] [--swing]

The root is fixed in both programs, which does not change the block of the mass matrix that belongs to the joints. A robot whose import
changed or assumed masses or joints is compared, too, but marked, because its file states other values.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from import_robots import collections

STATES = 10


def usable(name):
    """A name in the form in which realgap writes names."""
    clean = re.sub(r"[^A-Za-z0-9_-]", "_", name[:60])
    return "_" + clean[1:] if clean.startswith("-") else clean or "_"


def realgap_states(realgap, path, ron):
    held = ["--mounted"] if path.suffix == ".urdf" else []
    done = subprocess.run([realgap, "robot", "import", str(path), "-o", str(ron), "--force", *held, "--passive", "--format", "json"],
                          capture_output=True, text=True, timeout=120)
    if done.returncode:
        return None, None
    notes = json.loads(done.stdout)["notes"]
    done = subprocess.run([realgap, "check", str(ron), "--format", "json", "--dynamics", str(STATES)], capture_output=True, text=True)
    return json.loads(done.stdout)[0]["contents"]["dynamics"], notes


def rotation(q):
    w, x, y, z = np.array(q) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def by_pinocchio(path, ours):
    import pinocchio as pin
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    names = {usable(name): index for index, name in enumerate(model.names)}
    order = [names[name] for name in ours["joints"] if name in names]
    if len(order) != len(ours["joints"]):
        return None, "other joints"
    worst = {"mass": 0.0, "centre": 0.0, "pose": 0.0, "matrix": 0.0, "acceleration": 0.0}
    total = sum(inertia.mass for inertia in model.inertias)
    for state in ours["states"]:
        q = pin.neutral(model)
        for joint, value in zip(order, state["coordinates"]):
            start, count = model.joints[joint].idx_q, model.joints[joint].nq
            q[start:start + count] = [value] if count == 1 else [np.cos(value), np.sin(value)]
        matrix = pin.crba(model, data, q)
        matrix = np.triu(matrix) + np.triu(matrix, 1).T
        rows = [model.joints[joint].idx_v for joint in order]
        matrix = matrix[np.ix_(rows, rows)]
        pin.forwardKinematics(model, data, q)
        pin.updateFramePlacements(model, data)
        places = [(inertia.mass, data.oMi[index].act(inertia.lever)) for index, inertia in enumerate(model.inertias)]
        centre = sum(mass * place for mass, place in places) / total
        falling = pin.aba(model, data, q, np.zeros(model.nv), np.zeros(model.nv))[rows]
        compare(worst, state, total, centre, matrix, falling)
        for name, pose in zip(ours["bodies"], state["bodies"]):
            for index, frame in enumerate(model.frames):
                if usable(frame.name) == name and frame.type == pin.FrameType.BODY:
                    at = data.oMf[index]
                    worst["pose"] = max(worst["pose"], np.abs(at.translation - pose[:3]).max(),
                                        np.abs(at.rotation - rotation(pose[3:])).max())
    return worst, ""


def by_mujoco(path, ours):
    import mujoco
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    joints = {usable(model.joint(i).name): i for i in range(model.njnt) if model.joint(i).name}
    order = [joints.get(name) for name in ours["joints"]]
    if any(joint is None for joint in order):
        return None, "other joints"
    if any(model.jnt_type[joint] < 2 for joint in order):
        return None, "ball or free joints"
    worst = {"mass": 0.0, "centre": 0.0, "pose": 0.0, "matrix": 0.0, "acceleration": 0.0}
    free = [i for i in range(model.njnt) if model.jnt_type[i] == 0]
    body_of = {usable(model.body(i).name): i for i in range(1, model.nbody)}
    root = None
    for state in ours["states"]:
        mujoco.mj_resetData(model, data)
        for joint, value in zip(order, state["coordinates"]):
            start = model.jnt_qposadr[joint]
            data.qpos[start] = model.qpos0[start] + value
        if free:
            data.qpos[model.jnt_qposadr[free[0]]:][:3] = 0.0
            data.qpos[model.jnt_qposadr[free[0]] + 3:][:4] = model.body_quat[1]
        mujoco.mj_forward(model, data)
        matrix = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, matrix, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, matrix)
        rows = [model.jnt_dofadr[joint] for joint in order]
        matrix = matrix[np.ix_(rows, rows)]
        weights = model.body_mass[1:]
        centre = (weights[:, None] * data.xipos[1:]).sum(0) / weights.sum()
        compare(worst, state, weights.sum(), centre, matrix, None)
        for name, pose in zip(ours["bodies"], state["bodies"]):
            if name in body_of:
                body = body_of[name]
                worst["pose"] = max(worst["pose"], np.abs(data.xpos[body] - pose[:3]).max(),
                                    np.abs(data.xmat[body].reshape(3, 3) - rotation(pose[3:])).max())
    return worst, ""


def compare(worst, state, mass, centre, matrix, falling):
    ours = np.array(state["mass_matrix"])
    worst["mass"] = max(worst["mass"], abs(state["mass_kg"] / mass - 1))
    worst["centre"] = max(worst["centre"], np.abs(centre - state["centre_m"]).max())
    if matrix.size:
        worst["matrix"] = max(worst["matrix"], np.abs(ours - matrix).max() / np.abs(matrix).max())
        if falling is not None:
            worst["acceleration"] = max(worst["acceleration"], np.abs(falling - state["accelerations"]).max()
                                        / max(np.abs(falling).max(), 1.0))


def swing(realgap, ron, folder):
    """A passive robot with a fixed root swings for 0.2 s in both programs: the largest difference as a share of the largest motion."""
    import mujoco
    # There are no contacts, and joint limits and dry friction, which MuJoCo treats as soft constraints, are left out. So masses, damping
    # and springs are compared.
    text = re.sub(r"shapes: \[.*\]\),$", "),", ron.read_text(), flags=re.M)
    ron.write_text(re.sub(r", (limits_rad|limits_m|dry_nm|dry_n): (\([^)]*\)|[0-9.e+-]+)", "", text))
    xml = folder / "robot.xml"
    done = subprocess.run([realgap, "robot", "export", str(ron), "--format", "mjcf", "-o", str(xml), "--force"], capture_output=True, text=True)
    if done.returncode:
        return None
    text = re.sub(r"<geom ", '<geom contype="0" conaffinity="0" ', re.sub(r' (contype|conaffinity)="0"', "", xml.read_text()))
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep = 1e-4
    data = mujoco.MjData(model)
    names = [model.joint(i).name for i in range(model.njnt)]
    start = {}
    for i in range(model.njnt):
        low, high = model.jnt_range[i] if model.jnt_limited[i] else (-1e9, 1e9)
        data.qpos[model.jnt_qposadr[i]] = start[names[i]] = min(max(0.0, low), high)
    while data.time < 0.2 - 1e-9:
        mujoco.mj_step(model, data)
    run = folder / "run.csv"
    done = subprocess.run([realgap, "simulate", str(ron), "--duration", "0.2", "-o", str(run), "--force", "--set", "timestep_s=0.0005"],
                          capture_output=True, text=True)
    if done.returncode:
        return None
    lines = [line for line in run.read_text().splitlines() if not line.startswith("#")]
    head, last = lines[0].split(","), lines[-1].split(",")
    ours = dict(zip(head, last))
    moved, apart = 0.0, 0.0
    for i, name in enumerate(names):
        key = next((k for k in (f"{name}_rad", f"{name}_angle_rad", f"joint_{name}_rad") if k in ours), None)
        if key is None:
            return None
        q = data.qpos[model.jnt_qposadr[i]]
        moved = max(moved, abs(q - start[name]))
        apart = max(apart, abs(q - float(ours[key])))
    return apart / moved if moved > 1e-6 else 0.0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--realgap", default="realgap")
    parser.add_argument("--match", default="")
    parser.add_argument("--swing", action="store_true", help="compare 0.2 s of passive motion, too")
    options = parser.parse_args()
    largest = {}
    with tempfile.TemporaryDirectory() as folder:
        ron = Path(folder) / "robot.ron"
        for collection, root, path in collections():
            if options.match not in str(path):
                continue
            name = str(path.relative_to(root))
            ours, notes = realgap_states(options.realgap, path, ron)
            if ours is None:
                print(f"{collection:20} {name[:60]:60} not imported")
                continue
            touched = [note for note in notes if note["sort"] in ("changed", "assumed", "doubt")
                       and not re.search("mesh|overlap at the start|hull|name|limits|has no mass: the robot|prefix|XML|collision|servos|motors", note["what"])]
            try:
                worst, why = (by_pinocchio if path.suffix == ".urdf" else by_mujoco)(path, ours)
            except Exception as error:
                worst, why = None, f"the other program: {str(error).splitlines()[0][:80]}"
            if worst is None:
                print(f"{collection:20} {name[:60]:60} {why}")
                continue
            mark = f"changed: {touched[0]['what'][:60]}" if touched else ""
            if options.swing:
                try:
                    worst["swing"] = swing(options.realgap, ron, Path(folder))
                except Exception as error:
                    mark += f" swing: {str(error).splitlines()[0][:60]}"
            numbers = " ".join(f"{key} {value:.1e}" for key, value in worst.items() if value is not None)
            print(f"{collection:20} {name[:60]:60} {numbers} {mark}", flush=True)
            if not mark:
                for key, value in worst.items():
                    if value is not None and value >= largest.get(key, (0.0, ""))[0]:
                        largest[key] = (value, name)
    for key, (value, name) in largest.items():
        print(f"largest {key}: {value:.2e} ({name})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
