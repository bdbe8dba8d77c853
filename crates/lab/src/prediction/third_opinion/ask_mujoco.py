# The text of tools/standin.py stands before this one: its class Robot reads the exported file and drives the servos.
"""Says how far a robot goes in MuJoCo: one question, one answer, each a line of JSON, until the input ends.

realgap starts this where a prediction asks MuJoCo. A question is the file that `realgap robot export --format mjcf` writes for one
draw of the noise, with what that file cannot say: how the robot is put down, the age of commands, the friction of each box. The
contacts and steps are those of the file; controls are set every fourth step, as in tools/engine_spread.py.
"""

import json
import sys
from xml.etree import ElementTree

# Steps for which a control is held.
HOLD = 4


def rubbing(mjcf, friction):
    """The file with the friction of every shape with the floor; two shapes keep the friction that it states for them."""
    root = ElementTree.fromstring(mjcf)
    touching = [geom.get("name") for geom in root.iter("geom") if geom.get("name") and geom.get("contype") != "0"]
    # A pair does not take these from its geoms.
    usual = root.find("default/geom")
    hardness = {key: usual.get(key) for key in ("condim", "solref", "solimp")}
    contact = ElementTree.SubElement(root, "contact")
    for name in touching:
        if name in friction:
            both = f"{friction[name]!r} {friction[name]!r} 0 0 0"
            ElementTree.SubElement(contact, "pair", geom1="floor", geom2=name, friction=both, **hardness)
    return ElementTree.tostring(root, encoding="unicode")


class Drawn(Robot):
    """The robot of one draw."""

    def __init__(self, question):
        super().__init__(mujoco.MjModel.from_xml_string(rubbing(question["mjcf"], question["friction"])))
        self.hold = HOLD
        latency_s = question["servo_latency_s"]
        self.latency_s = np.array([latency_s.get(name, 0.0) for name in self.joints])
        self.question = question

    def delayed_command_rad(self, t_s):
        """The commands on which the servos act: before the first one arrives, the command of time 0."""
        turn = 2 * math.pi * self.frequency_hz * np.maximum(t_s[:, None] - self.latency_s, 0.0) + self.phase_rad
        return self.offset_rad + self.amplitude_rad * np.sin(turn)

    def net_displacement_m(self):
        """From rest to the end of the run, in the plane."""
        data = self.place(self.question["shift_world_m"], self.question["turn_world_rad"])
        self.settle(data)
        start_m = self.pose(data)[0]
        dt_s = self.hold * self.model.opt.timestep
        steps = math.ceil(self.question["duration_s"] / dt_s - 1e-9)
        for command_rad in self.delayed_command_rad((np.arange(steps) + 0.5) * dt_s):
            self.drive(data, command_rad)
            mujoco.mj_step(self.model, data, self.hold)
        # After a state that is no number MuJoCo starts again from the reference pose, and counts a warning.
        bad = [mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC]
        if any(data.warning[kind].number for kind in bad) or not np.isfinite(data.qpos).all():
            raise ValueError("the run diverged in MuJoCo")
        return float(np.linalg.norm((self.pose(data)[0] - start_m)[:2]))


def answer(question):
    if "realgap" in question:
        return {"realgap": 1, "name": "MuJoCo", "version": mujoco.__version__}
    try:
        return {"id": question["id"], "net_displacement_m": Drawn(question).net_displacement_m()}
    except Exception as error:  # Whatever it is, it concerns this question alone.
        return {"id": question["id"], "failed": f"{type(error).__name__}: {error}"}


for line in sys.stdin:
    print(json.dumps(answer(json.loads(line))), flush=True)
