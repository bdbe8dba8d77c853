#!/usr/bin/env python3
"""Measures the CPU time of realgap, MuJoCo and PyBullet for the same robots: at equal error, and at usual settings.

    cargo build --release
    python3 -m pip install -r tools/requirements-engines.txt
    python3 tools/compare_engines.py --realgap target/release/realgap

The robots are exported by `realgap robot export`. Rounds of all engines are interleaved, so that a busy machine affects all of them in the same way; medians are printed.
`--curves` prints error against cost instead: every engine runs at several timesteps. The error of a run is the rms distance of the tracked module
from the limit of the same engine, which is its finest timestep with contacts hardened to the same natural frequency in all engines. So the table shows
how much CPU time an engine needs to reach a distance from its own limit; `--error MM` adds the cheapest setting of each engine within that distance.

The columns x and y show the net displacement of the tracked module: engines that disagree there did not simulate the same thing.
"""

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tempfile
import time

import mujoco
import numpy as np
from mujoco import rollout

from standin import Robot

try:
    import pybullet
except ImportError:
    pybullet = None

MUJOCO_TIMESTEP_S = 1 / 500
PYBULLET_TIMESTEP_S = 1 / 240
# MuJoCo's own default of the contact time constant, and the hardest that this timestep allows.
MUJOCO_SOLREF_S = 0.02
MUJOCO_HARD_SOLREF_S = 2 * MUJOCO_TIMESTEP_S
FRICTION = 0.5
# Runs whose net displacements differ by more than this, and by more than this share of the reference's, did not simulate the same thing.
AGREEMENT_M, AGREEMENT_SHARE = 0.05, 0.5


class Realgap:
    """The command line of realgap; `cpu_s` is the time of its own thread, including building and settling."""

    def __init__(self, binary, morphology, duration_s, extra):
        self.command = [binary, "simulate", str(morphology), "--duration", str(duration_s), "--format", "json",
                        "--set", f"floor.friction={FRICTION}", "--set", "floor.restitution=0", *extra]
        first = self.run()
        self.name = f"realgap {first['version']} ({first['engine']})"
        self.settings = f"1/{1 / first['timestep_s']:.0f} s, {first['substeps']} substeps"

    def run(self):
        done = subprocess.run(self.command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"error: {' '.join(self.command)} failed:\n{done.stderr}")
        return json.loads(done.stdout)

    def round(self):
        r = self.run()
        simulated_s = (r["steps"] + r["settle_steps"]) * r["timestep_s"]
        x, y, _ = r["net_displacement_world_m"]
        return r["cpu_s"] / simulated_s, r["timestep_s"], (x, y)


class MuJoCo:
    """`mujoco.rollout`: the whole run is one C loop."""

    def __init__(self, mjcf, duration_s, solref_s):
        self.robot = Robot(mjcf)
        if self.robot.velocity_law.any():
            raise SystemExit("error: a velocity servo cannot be driven inside mujoco.rollout; use robots with a torque law")
        m = self.robot.model
        m.opt.timestep = MUJOCO_TIMESTEP_S
        m.geom_solref[:, 0] = solref_s
        m.geom_solimp[:, :2] = [0.95, 0.99] if solref_s < MUJOCO_SOLREF_S else [0.9, 0.95]
        kind = "hardened" if solref_s < MUJOCO_SOLREF_S else "soft"
        self.name = f"MuJoCo {mujoco.__version__} {kind}"
        self.settings = f"1/{1 / MUJOCO_TIMESTEP_S:.0f} s, implicitfast, elliptic cone, solref {solref_s:g} 1, solimp {m.geom_solimp[0, 0]:g} {m.geom_solimp[0, 1]:g}"
        data = self.robot.place()
        self.robot.settle(data)
        self.data, self.duration_s = data, duration_s
        self.start = np.zeros((1, mujoco.mj_stateSize(m, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
        mujoco.mj_getState(m, data, self.start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        steps = round(duration_s / MUJOCO_TIMESTEP_S)
        self.control = np.zeros((1, steps, m.nu))
        self.control[0][:, self.robot.actuator] = self.robot.command_rad((np.arange(steps) + 0.5) * MUJOCO_TIMESTEP_S)
        self.from_m = self.position(self.start[0])

    def position(self, state):
        mujoco.mj_setState(self.robot.model, self.data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        return self.robot.pose(self.data)[0]

    def round(self):
        before = time.process_time()
        states, _ = rollout.rollout(self.robot.model, self.data, self.start, self.control)
        spent = time.process_time() - before
        moved = self.position(states[0, -1]) - self.from_m
        return spent / self.duration_s, MUJOCO_TIMESTEP_S, (moved[0], moved[1])


class PyBullet:
    """One Python call per step: there is no other way to change the servos' targets, so it counts."""

    def __init__(self, urdf, mjcf, duration_s):
        from importlib.metadata import version

        self.name = f"PyBullet {version('pybullet')}"
        self.robot = Robot(mjcf)
        self.urdf, self.duration_s = str(urdf), duration_s
        self.settings = f"1/{1 / PYBULLET_TIMESTEP_S:.0f} s, 50 iterations, position motors of the same gain and torque limit"

    def round(self):
        p, robot, dt = pybullet, self.robot, PYBULLET_TIMESTEP_S
        client = p.connect(p.DIRECT)
        try:
            p.setGravity(0, 0, -9.81)
            p.setTimeStep(dt)
            floor = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
            p.changeDynamics(floor, -1, lateralFriction=1.0, restitution=0.0)
            # The initial height of the MJCF file is just above the floor.
            height_m = robot.model.body(1).pos[2]
            body = p.loadURDF(self.urdf, [0, 0, height_m], flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_USE_SELF_COLLISION)
            index = {p.getJointInfo(body, j)[1].decode(): j for j in range(p.getNumJoints(body))}
            joints = [index[name] for name in robot.joints]
            for link in range(-1, p.getNumJoints(body)):
                p.changeDynamics(body, link, lateralFriction=FRICTION, restitution=0.0, linearDamping=0, angularDamping=0, jointDamping=0)
            steps, settle = round(self.duration_s / dt), round(2.0 / dt)
            # Unloaded, torque = k error - d speed holds at speed = k/d error: the same law for Bullet's motor.
            stiffness, damping, torque = (np.array(column) for column in zip(*(robot.numbers(f"servo_{n}") for n in robot.joints)))
            drive = dict(controlMode=p.POSITION_CONTROL, positionGains=list(stiffness / damping * dt), velocityGains=[1.0] * len(joints), forces=list(torque))
            start = robot.command_rad(0.0).tolist()
            for joint, angle in zip(joints, start):
                p.resetJointState(body, joint, angle)
            # Turned hinges reach below the floor: lift the robot until it just touches.
            p.performCollisionDetection()
            low = min(p.getAABB(body, link)[0][2] for link in range(-1, p.getNumJoints(body)))
            base, turn = p.getBasePositionAndOrientation(body)
            p.resetBasePositionAndOrientation(body, [base[0], base[1], base[2] - min(low, 0.0)], turn)
            for _ in range(settle):
                p.setJointMotorControlArray(body, joints, targetPositions=start, **drive)
                p.stepSimulation()
            commands = robot.command_rad((np.arange(steps) + 0.5) * dt).tolist()
            first = self.position(body)
            before = time.process_time()
            for command in commands:
                p.setJointMotorControlArray(body, joints, targetPositions=command, **drive)
                p.stepSimulation()
            spent = time.process_time() - before
            moved = self.position(body) - first
            return spent / self.duration_s, dt, (moved[0], moved[1])
        finally:
            p.disconnect(client)

    def position(self, body):
        """Origin of the base link's frame, which is the tracked module's centre for these robots."""
        position, turn = pybullet.getBasePositionAndOrientation(body)
        offset, frame = pybullet.getDynamicsInfo(body, -1)[3:5]
        back = pybullet.invertTransform(offset, frame)
        return np.array(pybullet.multiplyTransforms(position, turn, *back)[0])


# Steps per second of the curves; the last is the limit that the others are compared with, with contacts of this natural frequency.
REALGAP_HZ = [120, 180, 240, 300, 360, 420, 480, 600, 720, 840, 960, 1920, 7680]
MUJOCO_HZ = [250, 333, 400, 500, 600, 667, 750, 800, 900, 1000, 2000, 4000, 16000]
LIMIT_HZ = 600
CURVE_RATE_HZ = 20


class RealgapCurve:
    name = "realgap, Rapier"
    rates = REALGAP_HZ
    engine = []

    def __init__(self, binary, morphology, _mjcf, duration_s, extra, folder):
        self.command = [binary, "simulate", str(morphology), "--duration", str(duration_s), "--format", "json", "--set", f"floor.friction={FRICTION}",
                        "--set", "floor.restitution=0", *self.engine, *extra]
        self.path = folder / "curve.csv"
        self.duration_s = duration_s

    def run(self, hertz):
        hard = ["--set", f"contact.natural_frequency_hz={LIMIT_HZ}"] if hertz == self.rates[-1] else []
        self.path.unlink(missing_ok=True)
        done = subprocess.run([*self.command, *hard, "--timestep", repr(1 / hertz), "-o", str(self.path)], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"error: realgap simulate failed:\n{done.stderr}")
        r = json.loads(done.stdout)
        rows = np.genfromtxt(self.path, delimiter=",", names=True)
        at = np.arange(0.0, self.duration_s + 1e-9, 1 / CURVE_RATE_HZ)
        path = np.stack([np.interp(at, rows["t_s"], rows[axis]) for axis in ("x_m", "y_m", "z_m")], axis=1)
        return r["cpu_s"] / ((r["steps"] + r["settle_steps"]) * r["timestep_s"]), path - path[0]


class TreeCurve(RealgapCurve):
    """The engine `tree`, with one solve for each step."""

    name = "realgap, tree"
    engine = ["--engine", "tree", "--substeps", "1"]


class MuJoCoCurve:
    name = "MuJoCo"
    rates = MUJOCO_HZ

    def __init__(self, _binary, _morphology, mjcf, duration_s, _extra, _folder):
        self.mjcf, self.duration_s = mjcf, duration_s

    def run(self, hertz):
        robot = Robot(self.mjcf)
        m = robot.model
        m.opt.timestep = 1 / hertz
        # A speed servo below its speed limit is a spring, which rollout can drive.
        for actuator, gain in zip(robot.actuator, robot.gain_1_s):
            if robot.velocity_law[list(robot.actuator).index(actuator)]:
                damping = m.actuator_gainprm[actuator, 0]
                m.actuator_gainprm[actuator, 0] = gain * damping
                m.actuator_biasprm[actuator, :3] = [0, -gain * damping, -damping]
                m.actuator_ctrllimited[actuator] = 0
        robot.velocity_law[:] = False
        # The hardest contact that the timestep allows, down to the limit's: the time constant is 1 / (2 pi f) at damping ratio 1.
        m.geom_solref[:, 0] = max(2 / hertz, 1 / (2 * math.pi * LIMIT_HZ))
        m.geom_solimp[:, :2] = [0.95, 0.99]
        data = robot.place()
        robot.settle(data)
        start = np.zeros((1, mujoco.mj_stateSize(m, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
        mujoco.mj_getState(m, data, start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        steps, every = round(self.duration_s * hertz), round(hertz / CURVE_RATE_HZ)
        control = np.zeros((1, steps, m.nu))
        control[0][:, robot.actuator] = robot.command_rad((np.arange(steps) + 0.5) / hertz)
        before = time.process_time()
        states, _ = rollout.rollout(m, data, start, control)
        spent = time.process_time() - before

        def position(state):
            mujoco.mj_setState(m, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
            return robot.pose(data)[0]

        path = np.array([position(start[0]), *(position(s) for s in states[0][every - 1 :: every])])
        return spent / self.duration_s, path - path[0]


def curves(binary, robots, duration_s, extra, most_mm):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        print("| robot | engine | steps per s | CPU ms per s | rms distance to its own limit, mm |\n|---|---|---:|---:|---:|")
        for morphology in robots:
            mjcf = export(binary, morphology, folder, "mjcf")
            cheapest = {}
            for kind in (RealgapCurve, TreeCurve, MuJoCoCurve):
                engine = kind(binary, morphology, mjcf, duration_s, extra, folder)
                runs = [engine.run(hertz) for hertz in kind.rates]
                limit = runs[-1][1]
                for hertz, (cost, path) in zip(kind.rates[:-1], runs):
                    samples = min(len(path), len(limit))
                    error = math.sqrt(((path[:samples] - limit[:samples]) ** 2).sum(axis=1).mean())
                    print(f"| {morphology.stem} | {engine.name} | {hertz} | {1e3 * cost:.2f} | {1e3 * error:.1f} |", flush=True)
                    if most_mm is not None and 1e3 * error <= most_mm and cost < cheapest.get(engine.name, (math.inf, 0))[0]:
                        cheapest[engine.name] = (cost, hertz)
            if most_mm is not None:
                said = [f"{name} {1e3 * cost:.2f} ms per s ({hertz} steps per s)" for name, (cost, hertz) in cheapest.items()]
                print(f"cheapest within {most_mm:g} mm: {'; '.join(said)}", flush=True)


def export(binary, morphology, folder, kind):
    path = folder / f"{morphology.stem}.{kind}"
    done = subprocess.run([binary, "export", str(morphology), "--format", kind, "-o", str(path), "--set", f"floor.friction={FRICTION}"],
                          capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"error: realgap export failed:\n{done.stderr}")
    return path


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--realgap", default="target/release/realgap", help="the binary (default target/release/realgap)")
    a.add_argument("--robots", nargs="+", type=pathlib.Path, help="morphologies with torque servos, tracked at their root")
    a.add_argument("--duration", type=float, default=10.0, help="seconds per round (default 10)")
    a.add_argument("--rounds", type=int, default=5)
    a.add_argument("--curves", action="store_true", help="error against cost instead of the table")
    a.add_argument("--error", type=float, metavar="MM", help="with --curves: the cheapest setting within this distance of the own limit")
    a.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="further settings of realgap, e.g. solver.substeps=4")
    a.add_argument("--joint", choices=["impulse", "multibody"], help="joint kind of realgap")
    a = a.parse_args()
    here = pathlib.Path(__file__).resolve().parent.parent / "morphologies"
    robots = a.robots or [here / f"{name}.ron" for name in ("chain3", "spider8", "chain30")]
    extra = [word for value in a.set for word in ("--set", value)] + (["--joint", a.joint] if a.joint else [])
    if a.curves:
        curves(a.realgap, a.robots or [here / f"{name}.ron" for name in ("chain3", "chain5", "spider8")], a.duration, extra, a.error)
        return
    if pybullet is None:
        print("PyBullet is not installed: left out (python3 -m pip install pybullet)")
    rows, notes, doubts = [], {}, []
    with tempfile.TemporaryDirectory() as folder:
        for morphology in robots:
            mjcf = export(a.realgap, morphology, pathlib.Path(folder), "mjcf")
            engines = [MuJoCo(mjcf, a.duration, MUJOCO_HARD_SOLREF_S), MuJoCo(mjcf, a.duration, MUJOCO_SOLREF_S), Realgap(a.realgap, morphology, a.duration, extra)]
            if pybullet is not None:
                urdf = export(a.realgap, morphology, pathlib.Path(folder), "urdf")
                engines.append(PyBullet(urdf, mjcf, a.duration))
            results = [[] for _ in engines]
            for _ in range(a.rounds):
                for engine, result in zip(engines, results):
                    result.append(engine.round())
            # Hardened MuJoCo: its default contacts are so soft that chain30 walks the other way.
            reference = statistics.median(r[0] for r in results[0])
            home = results[0][-1][2]
            for engine, result in zip(engines, results):
                cost = sorted(r[0] for r in result)
                middle = statistics.median(cost)
                x, y = result[-1][2]
                notes[engine.name] = engine.settings
                if math.dist((x, y), home) > max(AGREEMENT_M, AGREEMENT_SHARE * math.hypot(*home)):
                    doubts.append(f"{morphology.stem}: {engine.name} ends {math.dist((x, y), home):.2f} m from {engines[0].name}")
                rows.append([morphology.stem, engine.name, f"{middle * 1e3:.2f}", f"{cost[0] * 1e3:.2f}-{cost[-1] * 1e3:.2f}",
                             f"{middle * result[-1][1] * 1e6:.1f}", f"{middle / reference:.2f}", f"{x:+.3f}", f"{y:+.3f}", f"{math.hypot(x, y):.3f}"])
    head = ["robot", "engine", "CPU ms per s", "range", "us per step", "ratio", "x m", "y m", "displacement m"]
    widths = [max(len(row[k]) for row in [head, *rows]) for k in range(len(head))]
    line = lambda row: "| " + " | ".join(cell.ljust(w) if k < 2 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths))) + " |"
    print(line(head))
    print("|" + "|".join(("-" * (w + 2)) if k < 2 else "-" * (w + 1) + ":" for k, w in enumerate(widths)) + "|")
    for row in rows:
        print(line(row))
    print(f"\n{a.rounds} interleaved rounds of {a.duration:g} s, medians; ratio to the first engine; friction {FRICTION}, restitution 0. Settings:")
    for name, settings in notes.items():
        print(f"- {name}: {settings}")
    for doubt in doubts:
        print(f"DISAGREEMENT {doubt}")


if __name__ == "__main__":
    main()
