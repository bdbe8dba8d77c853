#!/usr/bin/env python3
"""Runs the robots by which `predict --other-engine` is judged: in MuJoCo as `predict` asks it, and in engines that no answer has seen.

    python3 -m pip install -r tools/requirements-engines.txt
    python3 tools/engine_opinions.py results/opinions --realgap target/release/realgap

takes the robots of crates/lab/tests/golden/engines_judged.csv in their order (`--robots` bounds how many). Each of them is run with 12 draws of the
same noise in MuJoCo with the settings of the exported file, as `predict` does, and with two other draws in each of these: MuJoCo as strangers set it
up, in three ways, and PyBullet where it is installed. What MuJoCo does in the file's settings with other draws is in the table of judged robots.
It writes results/opinions/engines_asked.csv, one row a robot, by which crates/lab/tests/third_opinion.rs judges both answers; docs/validation/ensembles.md
holds the result. Robots that the folder contains are not run again.
"""

import argparse
import csv
import pathlib
import subprocess

import mujoco
import numpy as np

import record_standin
from engine_spread import known, said
from standin import Robot

try:
    import pybullet
except ImportError:
    pybullet = None

JUDGED = pathlib.Path(__file__).resolve().parent.parent / "crates/lab/tests/golden/engines_judged.csv"
DURATION_S = 8.0
# Draws by which MuJoCo is asked, as many as in crates/lab/src/prediction/third_opinion/ask.rs, and fresh draws in each of the other engines, with
# their seeds; the runs of the judged table have seed 1.
ASKED, ASKED_SEED = 12, 3
REPEATS, SEED = 2, 2
CONE, SOLVER = mujoco.mjtCone, mujoco.mjtSolver


def softer(m):
    """Contacts of 5 ms instead of 2 ms, and steps four times as long."""
    m.opt.timestep = 1 / 2000
    m.geom_solref[:, 0] = 0.005


def pyramid(m):
    """A friction pyramid and the conjugate gradient solver, contacts of 10 ms."""
    softer(m)
    m.opt.cone, m.opt.solver = CONE.mjCONE_PYRAMIDAL, SOLVER.mjSOL_CG
    m.geom_solref[:, 0] = 0.01


def soft(m):
    """The contacts that MuJoCo has where a file says nothing (solref 0.02 1, solimp 0.9 0.95, a pyramid). Its Euler integrator is left out: it treats
    the damping of these servos explicitly, and shakes the robots."""
    m.opt.timestep = 1 / 2000
    m.opt.cone = CONE.mjCONE_PYRAMIDAL
    m.geom_solref[:, 0] = 0.02
    m.geom_solimp[:, :2] = [0.9, 0.95]


STRANGERS = {"softer": softer, "pyramid": pyramid, "soft": soft}
FIELDS = ["seed", "asked_m", *(f"{name}_m" for name in STRANGERS), "pybullet_m"]


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("output", type=pathlib.Path, help="folder: one below it for every robot")
    p.add_argument("--realgap", default="target/release/realgap", help="the program (default %(default)s)")
    p.add_argument("--robots", type=int, default=80, help="how many of the judged robots (default %(default)s)")
    return p.parse_args()


def developed(a, robot, folder):
    """The robot's file, for `predict`, and in the formats of the other engines."""
    genome, ron = folder / "genome.ron", folder / "robot.ron"
    if not ron.exists():
        said(a, "robot", "genome", "random", "--modules", robot["modules"], "--seed", robot["seed"], "-o", genome, "--force")
        said(a, "robot", "develop", genome, "-o", ron, "--force")
    for kind in ("mjcf", "urdf"):
        if not (folder / f"robot.{kind}").exists():
            export = [a.realgap, "robot", "export", ron, "--format", kind, "-o", folder / f"robot.{kind}", "--force"]
            subprocess.run(export, check=True, capture_output=True)


def draws(robot, seed, count):
    """Start and servo zeros of each draw, as tools/record_standin.py draws them."""
    a = record_standin.arguments(["-", "-o", "-"])
    for repeat in range(count):
        start = np.random.default_rng([seed, repeat, 1])
        shift_m = start.normal(0, a.start_position_noise, 3)
        azimuth = start.uniform(0, 2 * np.pi)
        tilt, heading = start.normal(0, a.start_angle_noise, 2)
        zero_rad = start.normal(0, a.servo_zero_noise, len(robot.joints))
        yield shift_m, np.array([tilt * np.cos(azimuth), tilt * np.sin(azimuth), heading]), zero_rad


def in_mujoco(robot, seed, count):
    """Net displacement of each draw in MuJoCo, metres."""
    far_m = []
    for shift_m, turn_rad, zero_rad in draws(robot, seed, count):
        data = robot.place(shift_m, turn_rad, zero_rad)
        robot.settle(data, zero_rad)
        positions = robot.walk(data, DURATION_S, 1 / DURATION_S, zero_rad)[1]
        far_m.append(float(np.linalg.norm(positions[-1, :2] - positions[0, :2])))
    return far_m


class Bullet:
    """The robot in PyBullet: 1/1000 s, its own contacts, velocity motors of the same gain, speed and torque."""

    TIMESTEP_S = 1 / 1000

    def __init__(self, robot, urdf, friction, turn_rad, zero_rad):
        p, self.robot, self.zero_rad = pybullet, robot, zero_rad
        p.resetSimulation()
        p.setGravity(0, 0, -9.81)
        p.setTimeStep(self.TIMESTEP_S)
        floor = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
        p.changeDynamics(floor, -1, lateralFriction=1.0, restitution=0.0)
        self.body = p.loadURDF(str(urdf), [0, 0, 1], flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_USE_SELF_COLLISION)
        links = range(-1, p.getNumJoints(self.body))
        for link in links:
            p.changeDynamics(self.body, link, lateralFriction=friction, restitution=0.0, linearDamping=0, angularDamping=0, jointDamping=0)
        info = [p.getJointInfo(self.body, j) for j in range(p.getNumJoints(self.body))]
        index = {one[1].decode(): one[0] for one in info}
        self.joints = [index[name] for name in robot.joints]
        self.torque_nm = [float(robot.numbers(f"servo_{name}")[2]) for name in robot.joints]
        m = robot.model
        tracked = m.body(m.site_bodyid[robot.track]).name
        self.link = {one[12].decode(): one[0] for one in info}.get(tracked, -1)
        self.site_m = m.site_pos[robot.track]
        for joint, angle_rad in zip(self.joints, robot.command_rad(0.0) + zero_rad):
            p.resetJointState(self.body, joint, angle_rad)
        angle = float(np.linalg.norm(turn_rad))
        turn = p.getQuaternionFromAxisAngle((turn_rad / angle).tolist(), angle) if angle > 0 else [0, 0, 0, 1]
        p.resetBasePositionAndOrientation(self.body, [0, 0, 1], turn)
        p.performCollisionDetection()
        low_m = min(p.getAABB(self.body, link)[0][2] for link in links)
        base_m, turn = p.getBasePositionAndOrientation(self.body)
        p.resetBasePositionAndOrientation(self.body, [base_m[0], base_m[1], base_m[2] - low_m], turn)

    def track_m(self):
        p = pybullet
        if self.link >= 0:
            place_m, turn = p.getLinkState(self.body, self.link, computeForwardKinematics=True)[4:6]
        else:
            place_m, turn = p.getBasePositionAndOrientation(self.body)
            back = p.invertTransform(*p.getDynamicsInfo(self.body, -1)[3:5])
            place_m, turn = p.multiplyTransforms(place_m, turn, *back)
        return np.array(p.multiplyTransforms(place_m, turn, self.site_m.tolist(), [0, 0, 0, 1])[0])

    def go(self, commands_rad):
        p, robot = pybullet, self.robot
        for command_rad in commands_rad:
            at_rad = np.array([state[0] for state in p.getJointStates(self.body, self.joints)])
            speed = np.clip(robot.gain_1_s * (command_rad + self.zero_rad - at_rad), -robot.max_speed_rad_s, robot.max_speed_rad_s)
            p.setJointMotorControlArray(self.body, self.joints, p.VELOCITY_CONTROL, targetVelocities=speed.tolist(), forces=self.torque_nm)
            p.stepSimulation()

    def far_m(self):
        settle = round(2.0 / self.TIMESTEP_S)
        self.go(np.tile(self.robot.command_rad(0.0), (settle, 1)))
        start_m = self.track_m()
        steps = round(DURATION_S / self.TIMESTEP_S)
        self.go(self.robot.command_rad((np.arange(steps) + 0.5) * self.TIMESTEP_S))
        return float(np.linalg.norm((self.track_m() - start_m)[:2]))


def runs(robot, folder):
    """Net displacements by engine; None where an engine is missing."""
    def model():
        made = Robot(folder / "robot.mjcf")
        made.set_friction(robot["friction"])
        return made

    asked = model()
    asked.hold = 4
    found = {"asked_m": in_mujoco(asked, ASKED_SEED, ASKED)}
    for name, settings in STRANGERS.items():
        stranger = model()
        settings(stranger.model)
        found[f"{name}_m"] = in_mujoco(stranger, SEED, REPEATS)
    if pybullet is not None:
        made = model()
        starts = draws(made, SEED, REPEATS)
        found["pybullet_m"] = [Bullet(made, folder / "robot.urdf", robot["friction"], turn_rad, zero_rad).far_m() for _, turn_rad, zero_rad in starts]
    return found


def main():
    a = arguments()
    a.output.mkdir(parents=True, exist_ok=True)
    if pybullet is None:
        print("PyBullet is not installed: left out (python3 -m pip install pybullet)")
    else:
        pybullet.connect(pybullet.DIRECT)
    print(f"MuJoCo {mujoco.__version__}")
    with open(JUDGED, newline="") as opened:
        rows = list(csv.DictReader(opened))[: a.robots]
    table = []
    for row in rows:
        robot = {"seed": int(row["seed"]), "modules": int(row["modules"]), "friction": float(row["friction"])}
        folder = a.output / f"{robot['seed']:05}"
        folder.mkdir(parents=True, exist_ok=True)
        developed(a, robot, folder)
        found = known(folder / "runs.json", lambda: runs(robot, folder))
        table.append([robot["seed"], *(" ".join(f"{m:.4f}" for m in found.get(name, [])) for name in FIELDS[1:])])
        print(*table[-1], sep=",", flush=True)
        # After every robot, so that a run that is ended leaves what it has.
        with open(a.output / "engines_asked.csv", "w", newline="") as opened:
            csv.writer(opened, lineterminator="\n").writerows([FIELDS, *table])


if __name__ == "__main__":
    main()
