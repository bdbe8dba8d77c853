"""MuJoCo as the simulator of a study: any model that MuJoCo loads, unchanged (`pip install mujoco`).

A study names it as its command, with the parameters that it varies:

    simulator: Command(["python3", "-m", "realgap.mujoco", "scene.xml",
                        "--parameter", "joint.*_hip.damping", "--parameter", "body.trunk.mass"]),

`python3 -m realgap.mujoco scene.xml --list` lists the fields of a model. Fields are called by their place in the model,
`joint.NAME.damping`, `geom.NAME.friction`, `geom.NAME.solref[1]`, `body.NAME.mass`, `actuator.NAME.kp`, `option.timestep`; `*` in
a name ties all that it fits. `command.delay`, and with `--pd` `pd.kp` and `pd.kd`, belong to the controller, and
`joint.NAME.zero` to an encoder: what it reads at coordinate 0.

Recorded commands `NAME_command_rad` (also `_rad_s`, `_nm`) go to the actuator NAME or to that of the joint NAME; a motor that gets
angles needs `--pd KP,KD`. Runs start from the recorded values where the study says so, else from the keyframe of `--keyframe`.
Answers are the pose of the tracked body or site (`x_m` ... `qz`), of every joint `NAME_rad`, `NAME_rad_s` and `NAME_nm` (slides:
`NAME_m`, `NAME_m_s`, `NAME_n`), and every named sensor.
"""

from __future__ import annotations

import argparse
import difflib
import fnmatch
import hashlib
import importlib
import json
import math
import re
import sys
from dataclasses import replace
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ._simulator import Channels, Question, serve

# Fields that are not listed have ranges up to this value.
_LARGE = 1e6
# Largest value of a field that the model leaves at 0.
_UNKNOWN = 100.0
# Centres of mass are this far off their places while a model is compiled in which they move.
_OFF_CENTRE_M = 1e-3
# A parameter that changes no channel by more than this share of the channel's size changes nothing.
_NOTHING = 1e-12


class Field(NamedTuple):
    """A number of a model: its name, unit, allowed range, and how it is read and set."""

    name: str
    unit: str
    low: float
    high: float
    get: Callable[[], float]
    set: Callable[[float], None]
    # Whether constants of the model have to be computed again (`mj_setConst`).
    is_inertial: bool = False


class Parameter(NamedTuple):
    """A declared parameter: one field, or several that are tied."""

    name: str
    fields: List[Field]

    @property
    def default(self) -> float:
        values = sorted(field.get() for field in self.fields)
        return values[len(values) // 2]


class MujocoModel:
    """A model that MuJoCo has loaded, as a simulator of a study: a function from a `Question` to channels.

    `parameters` are names of fields, `*` ties all that fit; without them every field of the model is one. `track` is a body or
    site, by default the body of the first free joint. `pd` are gains of a controller for motors that get angles.
    """

    def __init__(
        self,
        path: str,
        parameters: Sequence[str] = (),
        *,
        track: Optional[str] = None,
        pd: Optional[Tuple[float, float]] = None,
        keyframe: Optional[str] = None,
        settle_s: float = 0.0,
        hold: bool = False,
        probe: bool = True,
    ) -> None:
        self._mj: Any = _mujoco()
        self.model: Any = self._load(path, hold, list(parameters))
        self.data: Any = self._mj.MjData(self.model)
        self._gains = list(pd) if pd is not None else None
        self._delay = [0.0]
        self._settle_s = settle_s
        self._keyframe = self._key(keyframe)
        self._track = self._tracked(track)
        self._joints = self._moving_joints()
        self._qpos = [place for _, place, _, _ in self._joints]
        self._dofs = [speed for _, _, speed, _ in self._joints]
        # What each encoder reads at coordinate 0.
        self._zeros = [0.0 for _ in self._joints]
        self._sensors = self._named_sensors()
        self.fields = {field.name: field for field in self._fields()}
        named = list(parameters)
        self.parameters = [self._parameter(name) for name in named or self.fields]
        # A stated inertia holds whatever the mass is, so that it is set after the mass, which changes it.
        self.parameters.sort(key=lambda p: any(".inertia" in field.name for field in p.fields))
        self._defaults = [[field.get() for field in p.fields] for p in self.parameters]
        self._probes = probe and bool(named)

    def _load(self, path: str, hold: bool, names: List[str]) -> Any:
        spec = self._held(path) if hold else None
        model = spec.compile() if spec is not None else self._mj.MjModel.from_xml_path(path)
        moved = [body for body in range(1, model.nbody) if self._moves_centre(model, body, names)]
        if not moved:
            return model
        # MuJoCo leaves out of its equations what a centre of mass at the origin of its body makes 0. So it compiles the model
        # with these centres off their places, and only then are they put back.
        spec = self._mj.MjSpec.from_file(path) if spec is None else spec
        for body in moved:
            one = spec.body(self._body_name(model, body))
            one.explicitinertial = True
            one.mass, one.inertia = float(model.body_mass[body]), model.body_inertia[body].copy()
            one.ipos, one.iquat = model.body_ipos[body] + _OFF_CENTRE_M, model.body_iquat[body].copy()
        whole = spec.compile()
        whole.body_ipos[:] = model.body_ipos
        self._mj.mj_setConst(whole, self._mj.MjData(whole))
        return whole

    def _body_name(self, model: Any, body: int) -> str:
        return self._mj.mj_id2name(model, self._mj.mjtObj.mjOBJ_BODY, body) or ""

    def _moves_centre(self, model: Any, body: int, names: List[str]) -> bool:
        """Whether a parameter of these names moves the centre of mass of a body."""
        own = self._body_name(model, body)
        if not own or model.body_mass[body] <= 0.0:
            return False
        places = [f"body.{own}.ipos{index}" for index in ("", "[1]", "[2]")]
        return any(place in names or any(_form(name).match(place) for name in names) for place in places)

    def _held(self, path: str) -> Any:
        """The model without its free joints."""
        import numpy as np

        whole = self._mj.MjModel.from_xml_path(path)
        free = int(self._mj.mjtJoint.mjJNT_FREE)
        is_free = [int(kind) == free for kind in whole.jnt_type]
        places = [int(at) for at, gone in zip(whole.jnt_qposadr, is_free) if gone]
        speeds = [int(at) for at, gone in zip(whole.jnt_dofadr, is_free) if gone]
        spec = self._mj.MjSpec.from_file(path)
        for joint in [joint for joint in spec.joints if int(joint.type) == free]:
            # A body on the world touches its own children, which a free one does not.
            for child in joint.parent.bodies:
                spec.add_exclude(bodyname1=joint.parent.name, bodyname2=child.name)
            spec.delete(joint)
        # Keyframes state the coordinates of all joints.
        for key in spec.keys:
            if len(key.qpos) == whole.nq:
                key.qpos = np.delete(key.qpos, [at + k for at in places for k in range(7)])
            if len(key.qvel) == whole.nv:
                key.qvel = np.delete(key.qvel, [at + k for at in speeds for k in range(6)])
        return spec

    # What the model is

    def identity(self) -> str:
        """What decides the answers: the compiled model, and how it is driven."""
        import numpy as np

        size = self._mj.mj_sizeModel(self.model)
        compiled = np.empty(size, np.uint8)
        self._mj.mj_saveModel(self.model, None, compiled)
        names = [parameter.name for parameter in self.parameters]
        how = (names, self._gains, self._keyframe, self._settle_s, self._track)
        digest = hashlib.sha256(compiled.tobytes() + repr(how).encode()).hexdigest()
        return f"{self.version()} {digest}"

    def version(self) -> str:
        """The version of MuJoCo."""
        return str(self._mj.__version__)

    def declares(self) -> Dict[str, Dict[str, Any]]:
        """The parameters as `realgap.serve` declares them."""
        declared: Dict[str, Dict[str, Any]] = {}
        for parameter in self.parameters:
            first, default = parameter.fields[0], parameter.default
            # A field without a natural end: far beyond what the model says.
            most = 100.0 * abs(default) or _UNKNOWN
            declared[parameter.name] = {
                "from": min(max(first.low, -most), default),
                "to": max(min(first.high, most), default),
                "default": default,
                "unit": first.unit,
            }
        return declared

    def settings(self) -> List[Dict[str, float]]:
        """Timesteps that may be exchanged: the model's own, a half and a quarter of it, in whose limit least squares extrapolate;
        none where the timestep is a parameter."""
        if any(p.name == "option.timestep" for p in self.parameters if self._probes):
            return []
        own = float(self.model.opt.timestep)
        return [{"timestep": own}, {"timestep": 0.5 * own}, {"timestep": 0.25 * own}]

    def body_length_m(self) -> Optional[float]:
        """The longest side of the box around what is tracked and all that it carries; around every moving body where nothing is."""
        import numpy as np

        model, data = self.model, self._mj.MjData(self.model)
        self._mj.mj_kinematics(model, data)
        root = None
        if self._track is not None:
            kind, index = self._track
            body = int(model.site_bodyid[index]) if kind == "site" else index
            root = int(model.body_rootid[body])
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for geom in range(model.ngeom):
            own = int(model.body_rootid[model.geom_bodyid[geom]])
            is_moving = int(model.body_weldid[model.geom_bodyid[geom]]) != 0
            if not is_moving or (root is not None and own != root):
                continue
            turn = data.geom_xmat[geom].reshape(3, 3)
            centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
            centre, half = data.geom_xpos[geom] + turn @ centre, np.abs(turn) @ half
            low, high = np.minimum(low, centre - half), np.maximum(high, centre + half)
        length_m = float(np.max(high - low))
        return length_m if math.isfinite(length_m) and length_m > 0.0 else None

    def describe(self) -> Dict[str, Any]:
        """What `realgap start --engine mujoco` asks before it writes a study of this model."""
        model = self.model
        carried = self._carried()
        joints: List[Dict[str, Any]] = []
        for name, _, dof, turns in self._joints:
            own: Dict[str, Any] = {"name": name, "turns": turns, "actuator": None, "drive": None, "limit": None, "gains": None}
            # Every joint feels its own rotor already.
            own["inertia_kg_m2"] = carried[dof] - float(model.dof_armature[dof])
            act = self._drive_of(int(model.dof_jntid[dof]))
            if act is not None:
                own.update(actuator=self._name("actuator", act), drive=self._law(act), limit=self._limit(act))
                own["gains"] = self._gains_at_joint(act)
            joints.append(own)
        touching = [geom for geom in range(model.ngeom) if model.geom_contype[geom] or model.geom_conaffinity[geom]]
        return {
            "version": self.version(),
            "timestep_s": float(model.opt.timestep),
            "joints": joints,
            "keyframes": [name for name in self._names("key", model.nkey) if name],
            "free_joints": sum(self._is(joint, "FREE") for joint in range(model.njnt)),
            "bodies": [name for name in self._names("body", model.nbody)[1:] if name],
            "mass_kg": float(model.body_mass.sum()),
            "body_length_m": self.body_length_m(),
            "unnamed_touching_geoms": sum(not self._name("geom", geom) for geom in touching),
            "fields": {name: {"value": field.get(), "unit": field.unit} for name, field in self.fields.items()},
        }

    def _drive_of(self, joint: int) -> Optional[int]:
        """The first actuator of a joint."""
        of_joints = (int(self._mj.mjtTrn.mjTRN_JOINT), int(self._mj.mjtTrn.mjTRN_JOINTINPARENT))
        for act in range(self.model.nu):
            if int(self.model.actuator_trntype[act]) in of_joints and int(self.model.actuator_trnid[act, 0]) == joint:
                return act
        return None

    def _law(self, act: int) -> str:
        """What the control of an actuator is: a position, a velocity, or a torque (of motors)."""
        bias = self.model.actuator_biasprm[act]
        return "position" if bias[1] != 0.0 else "velocity" if bias[2] != 0.0 else "motor"

    def _carried(self) -> List[float]:
        """The inertia that each degree of freedom feels where the model starts: in its first keyframe, if it has one."""
        import numpy as np

        model, data = self.model, self._mj.MjData(self.model)
        if model.nkey:
            self._mj.mj_resetDataKeyframe(model, data, 0)
        self._mj.mj_forward(model, data)
        # Products with unit vectors: versions of MuJoCo store the mass matrix in different ways.
        product, unit = np.empty(model.nv), np.zeros(model.nv)
        felt: List[float] = []
        for dof in range(model.nv):
            unit[dof] = 1.0
            self._mj.mj_mulM(model, data, product, unit)
            unit[dof] = 0.0
            felt.append(float(product[dof]))
        return felt

    def _gains_at_joint(self, act: int) -> Optional[Tuple[float, float]]:
        """Torque per angle and per speed with which an actuator that follows positions drives its joint."""
        if self._law(act) != "position":
            return None
        bias, gear = self.model.actuator_biasprm[act], float(self.model.actuator_gear[act, 0])
        return 0.0 - float(bias[1]) * gear * gear, 0.0 - float(bias[2]) * gear * gear

    def _limit(self, act: int) -> Optional[float]:
        """The largest torque of an actuator at its joint; `None` without a limit."""
        model = self.model
        gear = abs(float(model.actuator_gear[act, 0]))
        if model.actuator_forcelimited[act]:
            return gear * float(abs(model.actuator_forcerange[act]).max())
        if self._law(act) == "motor" and model.actuator_ctrllimited[act]:
            gain = abs(float(model.actuator_gainprm[act, 0]))
            return gear * gain * float(abs(model.actuator_ctrlrange[act]).max())
        return None

    def _name(self, kind: str, index: int) -> str:
        kinds = self._mj.mjtObj
        return self._mj.mj_id2name(self.model, getattr(kinds, f"mjOBJ_{kind.upper()}"), index) or ""

    def _id(self, kind: str, name: str) -> int:
        kinds = self._mj.mjtObj
        return int(self._mj.mj_name2id(self.model, getattr(kinds, f"mjOBJ_{kind.upper()}"), name))

    def _names(self, kind: str, count: int) -> List[str]:
        return [self._name(kind, index) for index in range(count)]

    def _is(self, joint: int, *kinds: str) -> bool:
        """Whether a joint is of one of these kinds."""
        own = int(self.model.jnt_type[joint])
        return any(own == int(getattr(self._mj.mjtJoint, f"mjJNT_{kind}")) for kind in kinds)

    def _key(self, name: Optional[str]) -> Optional[int]:
        if name is None:
            return None
        known = self._names("key", self.model.nkey)
        if name not in known:
            raise SystemExit(_unknown("keyframe", name, known))
        return known.index(name)

    def _tracked(self, name: Optional[str]) -> Optional[Tuple[str, int]]:
        if name is not None:
            for kind in ("body", "site"):
                if self._id(kind, name) >= 0:
                    return kind, self._id(kind, name)
            known = self._names("body", self.model.nbody) + self._names("site", self.model.nsite)
            raise SystemExit(_unknown("body or site", name, known))
        for joint in range(self.model.njnt):
            if self._is(joint, "FREE"):
                return "body", int(self.model.jnt_bodyid[joint])
        return None

    def _moving_joints(self) -> List[Tuple[str, int, int, bool]]:
        """Name, place of the coordinate, place of the speed, and whether it turns, of every joint with one degree of freedom."""
        found: List[Tuple[str, int, int, bool]] = []
        for joint in range(self.model.njnt):
            if self._is(joint, "HINGE", "SLIDE"):
                name = self._name("joint", joint) or f"joint{joint}"
                places = int(self.model.jnt_qposadr[joint]), int(self.model.jnt_dofadr[joint])
                found.append((name, *places, self._is(joint, "HINGE")))
        return found

    def _named_sensors(self) -> List[Tuple[str, int, int]]:
        names = self._names("sensor", self.model.nsensor)
        at, size = self.model.sensor_adr, self.model.sensor_dim
        return [(name, int(at[i]), int(size[i])) for i, name in enumerate(names) if name]

    # Fields

    def _fields(self) -> List[Field]:
        return [
            *self._joint_fields(),
            *self._geom_fields(),
            *self._body_fields(),
            *self._actuator_fields(),
            *self._option_fields(),
            *self._controller_fields(),
        ]

    def _joint_fields(self) -> List[Field]:
        model = self.model
        found: List[Field] = []
        for joint in range(model.njnt):
            name = self._name("joint", joint)
            if not name:
                continue
            turns = self._is(joint, "HINGE", "BALL")
            dofs = [dof for dof in range(model.nv) if model.dof_jntid[dof] == joint]
            unit = ("N m s/rad", "kg m2", "N m", "N m/rad") if turns else ("N s/m", "kg", "N", "N/m")

            def field(quantity: str, unit: str, row: Any, places: Sequence[int], inertial: bool = False) -> Field:
                return _field(f"joint.{name}.{quantity}", unit, (0.0, _LARGE), row, places, inertial)

            found += [
                field("damping", unit[0], model.dof_damping, dofs),
                field("armature", unit[1], model.dof_armature, dofs, True),
                field("frictionloss", unit[2], model.dof_frictionloss, dofs),
                field("stiffness", unit[3], model.jnt_stiffness, [joint]),
            ]
            if self._is(joint, "HINGE", "SLIDE"):
                place = int(model.jnt_qposadr[joint])
                own = f"joint.{name}.springref"
                angle = "rad" if turns else "m"
                found.append(_field(own, angle, (-1e3, 1e3), model.qpos_spring, [place]))
        return found

    def _geom_fields(self) -> List[Field]:
        model = self.model
        lists = (
            ("friction", model.geom_friction, (0.0, 1e3)),
            ("solref", model.geom_solref, (-_LARGE, _LARGE)),
            ("solimp", model.geom_solimp, (0.0, 1e3)),
        )
        found: List[Field] = []
        for geom, name in enumerate(self._names("geom", model.ngeom)):
            if not name:
                continue
            for quantity, rows, ends in lists:
                for index in range(rows.shape[1]):
                    own = f"geom.{name}.{quantity}" + (f"[{index}]" if index else "")
                    found.append(_field(own, "", ends, rows[geom], [index]))
            found.append(_field(f"geom.{name}.margin", "m", (0.0, 10.0), model.geom_margin, [geom]))
            found.append(_field(f"geom.{name}.gap", "m", (0.0, 10.0), model.geom_gap, [geom]))
        return found

    def _body_fields(self) -> List[Field]:
        model = self.model
        found: List[Field] = []
        for body, name in enumerate(self._names("body", model.nbody)):
            if not name or body == 0:
                continue
            if model.body_mass[body] > 0.0:
                found.append(self._mass(name, body))
                lists = (("inertia", "kg m2", model.body_inertia[body], 0.0), ("ipos", "m", model.body_ipos[body], -_LARGE))
                for quantity, unit, row, low in lists:
                    for index in range(3):
                        own = f"body.{name}.{quantity}" + (f"[{index}]" if index else "")
                        found.append(_field(own, unit, (low, _LARGE), row, [index], True))
            own = f"body.{name}.gravcomp"
            found.append(_field(own, "", (-10.0, 10.0), model.body_gravcomp, [body]))
        return found

    def _mass(self, name: str, body: int) -> Field:
        model = self.model
        mass_kg, inertia = float(model.body_mass[body]), model.body_inertia[body].copy()

        def put(value: float) -> None:
            # The inertia follows the mass, as that of the same shape of another density.
            model.body_mass[body] = value
            model.body_inertia[body] = inertia * (value / mass_kg)

        get = lambda: float(model.body_mass[body])  # noqa: E731
        return Field(f"body.{name}.mass", "kg", 1e-6, _LARGE, get, put, True)

    def _actuator_fields(self) -> List[Field]:
        model = self.model
        found: List[Field] = []
        for act, name in enumerate(self._names("actuator", model.nu)):
            if not name:
                continue
            gain, bias = model.actuator_gainprm[act], model.actuator_biasprm[act]
            is_fixed = int(model.actuator_gaintype[act]) == int(self._mj.mjtGain.mjGAIN_FIXED)
            is_affine = int(model.actuator_biastype[act]) == int(self._mj.mjtBias.mjBIAS_AFFINE)
            for index in range(model.actuator_gear.shape[1]):
                own = f"actuator.{name}.gear" + (f"[{index}]" if index else "")
                gear = model.actuator_gear[act]
                found.append(_field(own, "", (-_LARGE, _LARGE), gear, [index], True))
            if is_fixed and is_affine and bias[1] != 0.0:
                found.append(_gain(f"actuator.{name}.kp", gain, bias, 1))
                found.append(_field(f"actuator.{name}.kv", "", (-_LARGE, _LARGE), bias, [2], sign=-1.0))
            elif is_fixed and is_affine and bias[2] != 0.0:
                found.append(_gain(f"actuator.{name}.kv", gain, bias, 2))
            if model.actuator_forcelimited[act]:
                ends = model.actuator_forcerange[act]
                own = f"actuator.{name}.forcerange"
                found.append(Field(own, "N m", 0.0, _LARGE, *_symmetric(ends)))
        return found

    def _option_fields(self) -> List[Field]:
        option = self.model.opt
        found: List[Field] = []
        for quantity, unit, ends in (
            ("timestep", "s", (1e-6, 1.0)),
            ("density", "kg/m3", (0.0, _LARGE)),
            ("viscosity", "", (0.0, _LARGE)),
            ("impratio", "", (1e-3, _LARGE)),
        ):
            found.append(_option(option, quantity, unit, ends))
        for quantity, unit in (("gravity", "m/s2"), ("wind", "m/s")):
            for index in range(3):
                own = f"option.{quantity}[{index}]"
                row = getattr(option, quantity)
                found.append(_field(own, unit, (-1e3, 1e3), row, [index]))
        return found

    def _controller_fields(self) -> List[Field]:
        found = [_field("command.delay", "s", (0.0, 1.0), self._delay, [0])]
        for index, (name, _, _, turns) in enumerate(self._joints):
            own = f"joint.{name}.zero"
            found.append(_field(own, "rad" if turns else "m", (-10.0, 10.0), self._zeros, [index]))
        if self._gains is not None:
            found.append(_field("pd.kp", "N m/rad", (0.0, _LARGE), self._gains, [0]))
            found.append(_field("pd.kd", "N m s/rad", (0.0, _LARGE), self._gains, [1]))
        return found

    def _parameter(self, name: str) -> Parameter:
        fields = [self.fields[name]] if name in self.fields else []
        fields = fields or [field for own, field in self.fields.items() if _form(name).match(own)]
        if not fields:
            raise SystemExit(_unknown("field", name, list(self.fields)))
        units = sorted({field.unit for field in fields})
        if len(units) > 1:
            raise SystemExit(f"`{name}` ties fields of different units: {', '.join(units)}")
        values = {field.get() for field in fields}
        if len(values) > 1:
            low, high = min(values), max(values)
            print(f"`{name}` ties {len(fields)} fields that the model gives values from {low} to {high}", file=sys.stderr)
        return Parameter(name, fields)

    # Runs

    def __call__(self, question: Question) -> Channels:
        """One run; the first one also looks for parameters that change nothing."""
        values = {p.name: question.parameters.get(p.name) for p in self.parameters}
        if self._probes and question.id == 1:
            self._probe(question, values)
        return self._run(question, values)

    def _probe(self, question: Question, values: Dict[str, Optional[float]]) -> None:
        """Raises where a parameter changes nothing; most show within the first tenth of a run, which costs a tenth."""
        idle = self.parameters
        count = len(question.times_s)
        for shown in (max(2, count // 10), count):
            part = replace(question, times_s=question.times_s[:shown])
            usual = self._run(part, values) if idle else {}
            idle = [parameter for parameter in idle if self._is_idle(parameter, part, values, usual)]
        if idle:
            names = ", ".join(parameter.name for parameter in idle)
            raise ValueError(f"{names}: another value changes no channel of this run (no_probe skips this test)")

    def _is_idle(
        self,
        parameter: Parameter,
        question: Question,
        values: Dict[str, Optional[float]],
        usual: Channels,
    ) -> bool:
        at = values[parameter.name]
        at = parameter.default if at is None else at
        step = 0.1 * abs(at) or 0.01
        other = at + step if at + step <= parameter.fields[0].high else at - step
        try:
            moved = self._run(question, {**values, parameter.name: other})
        except ArithmeticError:
            return False
        for name, before in usual.items():
            size = max(map(abs, before), default=0.0)
            if any(abs(a - b) > _NOTHING * size for a, b in zip(before, moved[name])):
                return False
        return True

    def _apply(self, values: Dict[str, Optional[float]], timestep: Optional[float]) -> None:
        is_inertial = False
        if timestep is not None:
            self.model.opt.timestep = timestep
        for parameter, defaults in zip(self.parameters, self._defaults):
            value = values[parameter.name]
            is_default = value is None or value == sorted(defaults)[len(defaults) // 2]
            if parameter.name == "option.timestep" and timestep is not None and is_default:
                continue
            for field, own in zip(parameter.fields, defaults):
                # A tie of different values keeps them until a value is chosen.
                field.set(own if is_default or value is None else value)
                is_inertial |= field.is_inertial
        if is_inertial:
            self._mj.mj_setConst(self.model, self.data)

    def _run(self, question: Question, values: Dict[str, Optional[float]]) -> Dict[str, List[float]]:
        np: Any = importlib.import_module("numpy")

        mj, model, data = self._mj, self.model, self.data
        self._apply(values, question.setting.get("timestep"))
        self._place(question)
        dt = float(model.opt.timestep)
        settling = round(self._settle_s / dt)
        steps = max(1, math.ceil(question.times_s[-1] / dt - 1e-9))
        drive = self._drive(question, dt, settling, steps)
        # The integrator of fourth order evaluates the state several times in a step, so that what it leaves is not of its start.
        is_left = int(model.opt.integrator) != int(mj.mjtIntegrator.mjINT_RK4)
        asked = np.asarray(question.times_s)
        # Only what is read between needs to be copied: the steps around each asked time.
        place = np.clip(np.floor(asked / dt + 1e-9).astype(int), 0, steps - 1)
        seen = np.unique(np.concatenate([place, place + 1]))
        record = Record(self, len(seen))
        is_seen = np.zeros(steps + 1, bool)
        is_seen[seen] = True
        for step in range(-settling, 0):
            drive(step)
            mj.mj_step(model, data)
        for step, is_copied in enumerate(is_seen.tolist()):
            drive(step)
            if not is_copied:
                mj.mj_step(model, data)
            elif is_left:
                record.copy_state()
                mj.mj_step(model, data)
                # Places, forces and sensors are still those of the state before the step.
                record.copy_derived()
            else:
                mj.mj_forward(model, data)
                record.copy_state()
                record.copy_derived()
                mj.mj_step(model, data)
        rows, names = record.rows(), self._channel_names()
        bad = (mj.mjtWarning.mjWARN_BADQPOS, mj.mjtWarning.mjWARN_BADQVEL, mj.mjtWarning.mjWARN_BADQACC)
        if not np.isfinite(rows).all() or any(data.warning[int(kind)].number for kind in bad):
            raise ArithmeticError("the simulation became unstable")
        times = seen * dt
        return {name: np.interp(asked, times, rows[:, k]).tolist() for k, name in enumerate(names)}

    def _place(self, question: Question) -> None:
        """The state at the start: the keyframe, and over it what the recording states."""
        import numpy as np

        mj, model, data = self._mj, self.model, self.data
        if self._keyframe is None:
            mj.mj_resetData(model, data)
        else:
            mj.mj_resetDataKeyframe(model, data, self._keyframe)
        start = question.start
        for (name, place, speed, turns), zero in zip(self._joints, self._zeros):
            units = ("rad", "rad_s") if turns else ("m", "m_s")
            recorded = start.get(f"{name}_{units[0]}")
            if recorded is not None:
                data.qpos[place] = recorded - zero
            data.qvel[speed] = start.get(f"{name}_{units[1]}", data.qvel[speed])
        root = self._free_root()
        if root is None:
            return
        place, speed = root
        mj.mj_kinematics(model, data)
        position, turn = self._pose()
        wanted = np.array([start.get(f"{axis}_m", position[k]) for k, axis in enumerate("xyz")])
        stated = [start.get(f"q{axis}") for axis in "wxyz"]
        if None not in stated:
            # The root turns with the tracked body.
            change, inverse = np.empty(4), np.empty(4)
            mj.mju_negQuat(inverse, turn)
            mj.mju_mulQuat(change, np.array(stated), inverse)
            turned, own = np.empty(4), data.qpos[place + 3 : place + 7].copy()
            mj.mju_mulQuat(turned, change, own)
            data.qpos[place + 3 : place + 7] = turned
            mj.mj_kinematics(model, data)
            position, _ = self._pose()
        data.qpos[place : place + 3] += wanted - position
        for k, axis in enumerate("xyz"):
            data.qvel[speed + k] = start.get(f"v{axis}_m_s", data.qvel[speed + k])
            data.qvel[speed + 3 + k] = start.get(f"w{axis}_rad_s", data.qvel[speed + 3 + k])

    def quaternion(self, row: Any, matrix: Any) -> None:
        """Writes the quaternion of a matrix of MuJoCo."""
        turn = row.copy()
        self._mj.mju_mat2Quat(turn, matrix)
        row[:] = turn

    def _free_root(self) -> Optional[Tuple[int, int]]:
        """Places of the coordinates and speeds of the free joint that carries what is tracked."""
        if self._track is None:
            return None
        kind, index = self._track
        body = int(self.model.site_bodyid[index]) if kind == "site" else index
        first = int(self.model.body_rootid[body])
        joint = int(self.model.body_jntadr[first])
        if joint < 0 or not self._is(joint, "FREE"):
            return None
        return int(self.model.jnt_qposadr[joint]), int(self.model.jnt_dofadr[joint])

    def _pose(self) -> Tuple[Any, Any]:
        """Position and orientation of what is tracked, in the world."""
        import numpy as np

        kind, index = self._track or ("body", 0)
        if kind == "body":
            return self.data.xpos[index].copy(), self.data.xquat[index].copy()
        turn = np.empty(4)
        self._mj.mju_mat2Quat(turn, self.data.site_xmat[index])
        return self.data.site_xpos[index].copy(), turn

    # Commands

    def _drive(self, question: Question, dt: float, settling: int, steps: int) -> Callable[[int], None]:
        """A function that sets the controls of a step, counted from the start; what is not commanded stays as it starts."""
        np: Any = importlib.import_module("numpy")

        model, data = self.model, self.data
        commands = {name: values for name, values in question.commands.items() if not name.endswith("_on")}
        if not commands:
            return lambda step: None
        stamps = np.asarray(question.command_times_s)
        # A command holds until the next; before the first one it is the first. A step gets the mean of what holds during it, so
        # that a delay which is no multiple of the step counts, too.
        starts = np.arange(-settling, steps + 1) * dt - self._delay[0]
        held = np.clip(np.searchsorted(stamps, starts + 1e-12, side="right") - 1, 0, None)
        following = np.minimum(held + 1, len(stamps) - 1)
        late = np.clip((starts + dt - stamps[following]) / dt, 0.0, 1.0)
        late[(following == held) | (late < 1e-9)] = 0.0
        is_slow = bool(np.any(np.diff(stamps) < dt * (1.0 - 1e-9)))
        total_s = np.concatenate([[0.0], np.cumsum(np.diff(stamps))])

        def average(values: Any) -> Any:
            if not is_slow:
                return values[held] + late * (values[following] - values[held])
            # Several commands within a step: differences of their integral.
            area = np.concatenate([[0.0], np.cumsum(values[:-1] * np.diff(stamps))])

            def until(times: Any) -> Any:
                inside = np.interp(times - stamps[0], total_s, area)
                before = np.minimum(times - stamps[0], 0.0) * values[0]
                return inside + before + np.maximum(times - stamps[-1], 0.0) * values[-1]

            return (until(starts + dt) - until(starts)) / dt

        direct: List[Tuple[int, Any]] = []
        loops: Dict[int, Dict[str, Any]] = {}
        for channel, values in commands.items():
            name, _, unit = channel.partition("_command_")
            act = self._actuator(name)
            numbers = average(np.asarray(values))
            if unit == "rad":
                numbers = numbers - self._zero_of(act)
            gear, gain = float(model.actuator_gear[act, 0]), float(model.actuator_gainprm[act, 0])
            bias = model.actuator_biasprm[act]
            if unit == "rad" and bias[1] != 0.0:
                direct.append((act, numbers * gear))
            elif unit == "rad_s" and bias[1] == 0.0 and bias[2] != 0.0:
                direct.append((act, numbers * gear))
            elif self._gains is not None and unit in ("rad", "rad_s", "nm"):
                loops.setdefault(act, {})[unit] = numbers
            elif unit == "nm":
                direct.append((act, numbers / (gear * gain)))
            else:
                raise ValueError(
                    f"the actuator of {name} is a motor, and {channel} is none of its torques: state the gains of its"
                    " controller, --pd KP,KD"
                )
        direct_at: Any = [self._control(act) for act, _ in direct]
        direct_table = np.array([numbers for _, numbers in direct]).T
        loop_at, loop_step = self._loops(loops, len(starts))
        # Lists of all controls in their order are the whole array.
        direct_at, loop_at = (slice(None) if at == list(range(model.nu)) and at else at for at in (direct_at, loop_at))
        controls, has_direct, has_loops = data.ctrl, bool(direct), bool(loops)

        def drive(step: int) -> None:
            row = step + settling
            if has_direct:
                controls[direct_at] = direct_table[row]
            if has_loops:
                controls[loop_at] = loop_step(row)

        return drive

    def _loops(self, loops: Dict[int, Dict[str, Any]], count: int) -> Tuple[Any, Callable[[int], Any]]:
        """The controllers of motors: torque = kp (angle - q) + kd (speed - v) + torque; their controls, and what they are."""
        import numpy as np

        model, data = self.model, self.data
        kp, kd = self._gains or (0.0, 0.0)
        acts = sorted(loops, key=lambda act: int(model.jnt_dofadr[int(model.actuator_trnid[act, 0])]))
        joints = [int(model.actuator_trnid[act, 0]) for act in acts]
        place, speed = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        per_nm = 1.0 / (model.actuator_gear[acts, 0] * model.actuator_gainprm[acts, 0])
        # What does not depend on the state, and the stiffness of those that get angles.
        fixed = np.zeros((count, len(acts)))
        stiffness = np.array([kp if "rad" in loops[act] else 0.0 for act in acts])
        for k, act in enumerate(acts):
            for unit, gain in (("rad", kp), ("rad_s", kd), ("nm", 1.0)):
                if unit in loops[act]:
                    fixed[:, k] += gain * loops[act][unit]

        fixed *= per_nm
        stiffness, kd_nm = stiffness * per_nm, kd * per_nm
        if acts and (np.diff(place) == 1).all() and (np.diff(speed) == 1).all():
            # Neighbours are read in place, which takes a third of the time of a list of them.
            angles, speeds = data.qpos[place[0] : place[0] + len(acts)], data.qvel[speed[0] : speed[0] + len(acts)]

            def near(row: int) -> Any:
                return fixed[row] - stiffness * angles - kd_nm * speeds

            return [self._control(act) for act in acts], near

        def control(row: int) -> Any:
            return fixed[row] - stiffness * data.qpos[place] - kd_nm * data.qvel[speed]

        return [self._control(act) for act in acts], control

    def _zero_of(self, act: int) -> float:
        place = int(self.model.jnt_qposadr[int(self.model.actuator_trnid[act, 0])])
        return self._zeros[self._qpos.index(place)] if place in self._qpos else 0.0

    def _control(self, act: int) -> int:
        places = getattr(self.model, "actuator_ctrladr", None)
        return act if places is None else int(places[act])

    def _actuator(self, name: str) -> int:
        """The actuator of this name, or that of the joint of this name."""
        model = self.model
        act = self._id("actuator", name)
        if act >= 0:
            return act
        joint = self._id("joint", name)
        drive = self._drive_of(joint) if joint >= 0 else None
        if drive is not None:
            return drive
        known = [n for n in self._names("actuator", model.nu) if n] + [n for n, *_ in self._joints]
        raise ValueError(_unknown("actuator or joint with an actuator", name, known))

    # Channels

    def _channel_names(self) -> List[str]:
        names = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"] if self._track else []
        for units in (("rad", "m"), ("rad_s", "m_s"), ("nm", "n")):
            names += [f"{name}_{units[0] if turns else units[1]}" for name, _, _, turns in self._joints]
        for name, _, size in self._sensors:
            names += [name] if size == 1 else [f"{name}_{k}" for k in range(size)]
        return names

    def columns(self, states: Any, derived: Any) -> Any:
        """The channels, of whole states (coordinates, speeds) and of what is derived (pose, forces, sensors), a row a time."""
        import numpy as np

        nq, nv = self.model.nq, self.model.nv
        pose = 7 if self._track else 0
        parts = [derived[:, :pose], states[:, self._qpos] + np.array(self._zeros), states[:, [nq + at for at in self._dofs]]]
        parts.append(derived[:, [pose + at for at in self._dofs]])
        sensors = [pose + nv + place + k for _, place, size in self._sensors for k in range(size)]
        parts.append(derived[:, sensors])
        return np.concatenate([part for part in parts if part.shape[1]], axis=1)

    def tracked(self) -> Optional[Tuple[Any, Any, bool]]:
        """The arrays of MuJoCo that hold the pose of what is tracked, and whether the second is a matrix."""
        if self._track is None:
            return None
        kind, index = self._track
        if kind == "body":
            return self.data.xpos[index], self.data.xquat[index], False
        return self.data.site_xpos[index], self.data.site_xmat[index], True


class Record:
    """Copies of a run's states; whole arrays are copied, because choosing columns step by step takes longer than the step."""

    def __init__(self, simulator: MujocoModel, count: int) -> None:
        import numpy as np

        model, data = simulator.model, simulator.data
        self._simulator = simulator
        self._qpos, self._qvel, self._forces, self._sensors = data.qpos, data.qvel, data.qfrc_actuator, data.sensordata
        self._tracked = simulator.tracked()
        self._pose = 7 if self._tracked else 0
        self._nq, self._end = model.nq, self._pose + model.nv
        self._states = np.empty((count, model.nq + model.nv))
        self._derived = np.empty((count, self._end + model.nsensordata))
        self._has_sensors = model.nsensordata > 0
        self._at = 0

    def copy_state(self) -> None:
        """Coordinates and speeds of now."""
        row = self._states[self._at]
        row[: self._nq] = self._qpos
        row[self._nq :] = self._qvel

    def copy_derived(self) -> None:
        """What MuJoCo has derived from the state that was copied last."""
        row = self._derived[self._at]
        if self._tracked is not None:
            place, turn, is_matrix = self._tracked
            row[0:3] = place
            if is_matrix:
                self._simulator.quaternion(row[3:7], turn)
            else:
                row[3:7] = turn
        row[self._pose : self._end] = self._forces
        if self._has_sensors:
            row[self._end :] = self._sensors
        self._at += 1

    def rows(self) -> Any:
        """A row a copied time, with a column for each channel."""
        return self._simulator.columns(self._states, self._derived)


def _mujoco() -> Any:
    try:
        return importlib.import_module("mujoco")
    except ImportError as error:
        raise SystemExit(f"MuJoCo is not installed: pip install mujoco ({error})") from error


def _form(name: str) -> "re.Pattern[str]":
    """What a name of a parameter fits; brackets are indices here, and not classes of letters."""
    return re.compile(fnmatch.translate(name.replace("[", "[[]")))


def _unknown(what: str, name: str, known: Sequence[str]) -> str:
    near = difflib.get_close_matches(name, known, n=5, cutoff=0.5) or [one for one in known if one][:8]
    return f"the model has no {what} `{name}`; it has {', '.join(near) or 'none'}"


def _field(
    name: str,
    unit: str,
    ends: Tuple[float, float],
    row: Any,
    places: Sequence[int],
    inertial: bool = False,
    sign: float = 1.0,
) -> Field:
    """A field that is one element of an array, or several that are equal."""

    def put(value: float) -> None:
        for place in places:
            row[place] = sign * value

    return Field(name, unit, *ends, lambda: float(sign * row[places[0]]) + 0.0, put, inertial)


def _option(option: Any, quantity: str, unit: str, ends: Tuple[float, float]) -> Field:
    """A field of MuJoCo's options that is one number."""

    def get() -> float:
        return float(getattr(option, quantity))

    def put(value: float) -> None:
        setattr(option, quantity, value)

    return Field(f"option.{quantity}", unit, *ends, get, put)


def _gain(name: str, gain: Any, bias: Any, place: int) -> Field:
    """A gain that stands in the force of the command and, with the opposite sign, in that of the state."""

    def put(value: float) -> None:
        gain[0], bias[place] = value, -value

    return Field(name, "", 0.0, _LARGE, lambda: float(gain[0]), put)


def _symmetric(ends: Any) -> Tuple[Callable[[], float], Callable[[float], None]]:
    """The larger of two limits; both are set."""

    def put(value: float) -> None:
        ends[0], ends[1] = -value, value

    return lambda: float(max(abs(ends[0]), abs(ends[1]))), put


def _two(text: str) -> Tuple[float, float]:
    kp, kd = (float(word) for word in text.split(","))
    return kp, kd


def main(words: Optional[Sequence[str]] = None) -> None:
    """The program of `Command(["python3", "-m", "realgap.mujoco", "scene.xml", ...])`."""
    parser = argparse.ArgumentParser(prog="python -m realgap.mujoco", description="MuJoCo as the simulator of a study.")
    parser.add_argument("model", help="the model, a file that MuJoCo loads")
    parser.add_argument(
        "--parameter",
        action="append",
        default=[],
        metavar="NAME",
        help="a field that studies may vary, * ties all that it fits (repeatable; without it every field)",
    )
    parser.add_argument("--track", metavar="NAME", help="the body or site whose pose is compared (default: the first free body)")
    parser.add_argument("--pd", type=_two, metavar="KP,KD", help="gains of the controller that turns commanded angles into torques")
    parser.add_argument("--keyframe", metavar="NAME", help="the keyframe in which runs start")
    parser.add_argument("--settle", type=float, default=0.0, metavar="S", help="seconds with the first command before a run")
    parser.add_argument("--hold", action="store_true", help="hold the base: free joints are taken out")
    parser.add_argument("--no-probe", action="store_true", help="no_probe of a study: do not test whether each parameter changes anything")
    parser.add_argument("--describe", action="store_true", help="print joints, actuators, keyframes and fields as JSON and end")
    parser.add_argument("--list", action="store_true", help="list the fields of the model and end")
    given = parser.parse_args(words)
    model = MujocoModel(
        given.model,
        given.parameter,
        track=given.track,
        pd=given.pd,
        keyframe=given.keyframe,
        settle_s=given.settle,
        hold=given.hold,
        probe=not given.no_probe,
    )
    if given.list:
        for name, field in model.fields.items():
            print(f"{name} = {field.get():.6g} {field.unit}".rstrip())
        return
    if given.describe:
        print(json.dumps(model.describe()))
        return
    version = f"MuJoCo {model.version()}"
    serve(
        model,
        model.declares(),
        settings=model.settings(),
        name="mujoco",
        version=version,
        body_length_m=model.body_length_m(),
    )


if __name__ == "__main__":
    main()
