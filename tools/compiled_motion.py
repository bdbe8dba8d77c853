"""Moves MJCF models in MuJoCo without contacts and with a held root, and prints where their joints end: one line of JSON per model.

    python tools/compiled_motion.py FILE.xml ...
    python tools/compiled_motion.py --wheels

The start is the middle of the range of each joint. In the fall no servo acts; in the step one position servo is commanded 0.2 rad
(0.02 m) further and the others hold. Limits, dry friction and integration are made stiff and fine, because MuJoCo's defaults
soften them; fluid, equalities and contacts are off.
"""

import json
import sys

import mujoco
import numpy as np

from compiled_mjcf import AFFINE, DRIVES_JOINT, HINGE, SLIDE, name, wheels

DURATION_S = 0.2
TIMESTEP_S = 1e-4
MOST_FREEDOMS = 60


def held(path):
    """The model with its root held, and the reason why it is left out."""
    spec = mujoco.MjSpec.from_file(path)
    roots = [body for body in spec.worldbody.bodies]
    free = [j for body in roots for j in body.joints if j.type == mujoco.mjtJoint.mjJNT_FREE]
    if len(roots) == 1:
        for joint in free:
            spec.delete(joint)
        for key in list(spec.keys):
            spec.delete(key)
    elif free:
        return None, "several bodies of which one is free"
    return spec.compile(), None


def joint_name(model, j):
    own = name(model, mujoco.mjtObj.mjOBJ_JOINT, j)
    if own:
        return own
    body = int(model.jnt_bodyid[j])
    label = name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body{body}"
    first = int(model.body_jntadr[body])
    return f"{label}_joint" if model.body_jntnum[body] == 1 else f"{label}_joint{j - first}"


def prepare(model):
    model.opt.timestep = TIMESTEP_S
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.gravity = [0, 0, -9.81]
    model.opt.density = model.opt.viscosity = 0
    model.opt.wind = 0
    model.opt.tolerance = 1e-12
    model.opt.iterations = 200
    off = mujoco.mjtDisableBit
    model.opt.disableflags = int(off.mjDSBL_CONTACT) | int(off.mjDSBL_EQUALITY)
    for reference, impedance in (("jnt_solref", "jnt_solimp"), ("dof_solref", "dof_solimp")):
        getattr(model, reference)[:] = [2 * TIMESTEP_S, 1]
        getattr(model, impedance)[:] = [0.9999, 0.9999, 0.001, 0.5, 2]


def run(model, start, control):
    data = mujoco.MjData(model)
    data.qpos[:] = start
    data.ctrl[:] = control
    limited = np.flatnonzero(model.jnt_limited)
    place, span = model.jnt_qposadr[limited], model.jnt_range[limited]
    for _ in range(round(DURATION_S / TIMESTEP_S)):
        mujoco.mj_step(model, data)
        if ((data.qpos[place] < span[:, 0]) | (data.qpos[place] > span[:, 1])).any():
            # How a joint rebounds from its limit is a matter of the solver.
            return None
    return data.qpos.copy()


def moved(path):
    model, why = held(path)
    if why:
        return dict(left=why)
    if model.nv == 0 or model.nv > MOST_FREEDOMS:
        return dict(left=f"{model.nv} degrees of freedom")
    if model.nflex or (model.tendon_stiffness > 0).any() or (model.tendon_damping > 0).any() or model.tendon_limited.any():
        return dict(left="flex, or tendons with springs or limits")
    if (model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)).any() or (model.jnt_type == int(mujoco.mjtJoint.mjJNT_BALL)).any():
        return dict(left="ball joints or free joints beyond the root")
    prepare(model)
    start = model.qpos0.copy()
    joints = [j for j in range(model.njnt) if model.jnt_type[j] in (HINGE, SLIDE)]
    for j in joints:
        if model.jnt_limited[j]:
            start[model.jnt_qposadr[j]] = model.jnt_range[j].mean()

    def ends(qpos):
        if qpos is None:
            return None
        return {joint_name(model, j): float(qpos[model.jnt_qposadr[j]] - model.qpos0[model.jnt_qposadr[j]]) for j in joints}
    servos = [
        a
        for a in range(model.nu)
        if model.actuator_trntype[a] in DRIVES_JOINT
        and model.actuator_biastype[a] == AFFINE
        and model.actuator_biasprm[a, 1] < 0
    ]
    out = dict(start=ends(start))
    control, commands, first = np.zeros(model.nu), {}, True
    for a in servos:
        j = int(model.actuator_trnid[a, 0])
        q = start[model.jnt_qposadr[j]]
        if first:
            q += 0.2 if model.jnt_type[j] == HINGE else 0.02
            first = False
        bias = model.actuator_biasprm[a]
        control[a] = -(bias[0] + bias[1] * model.actuator_gear[a, 0] * q) / model.actuator_gainprm[a, 0]
        commands[joint_name(model, j)] = float(control[a])
    out["commands"] = commands
    out["step"] = ends(run(model, start, control)) if servos else None
    for a in range(model.nu):
        model.actuator_gainprm[a] = 0
        model.actuator_biasprm[a, :2] = 0
        if a in servos:
            model.actuator_biasprm[a] = 0
    out["fall"] = ends(run(model, start, np.zeros(model.nu)))
    return out


def main():
    todo = wheels() if sys.argv[1:] == ["--wheels"] else (("files", path) for path in sys.argv[1:])
    for _, path in todo:
        if path is None:
            continue
        try:
            line = moved(path)
        except Exception as error:  # MuJoCo refuses the file.
            line = dict(left=str(error).splitlines()[0])
        print(json.dumps(dict(path=path, **line)), flush=True)


if __name__ == "__main__":
    main()
