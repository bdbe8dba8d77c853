"""Worlds with hidden truths: robots, recordings and studies from which `realgap` is to find what was hidden.

A world names the parameters that a study varies, how recordings are made for true values, and the kind of each parameter:

- `acts`: it changes the recordings;
- `inert`: it changes nothing (the mass of a box that slides), so that nothing can be said about it;
- `ratio`: only its ratio to other parameters of the world changes the recordings, so that nothing but the ranges bounds it.

Truths are uniform anywhere in the range that is searched; where the study states a prior, they are drawn from it. Recordings of `puck`, `ball`, `pend` and `pendm` come from closed-form
physics in this file. Those of the others come from the program itself with a timestep that is finer than the study's by a random
factor from 2 to 5, with other substeps, and in worlds of cubes and wheels with either engine by chance. A camera errs by 1 mm and
0.3 degrees, an encoder has 4096 steps a turn. The first sample of `puck`, `ball` and `pend` is exact, because runs start from it.

This file is imported by interval_worlds.py, floor_power.py, peers.py, reference_posterior.py
and reference_chain.py.
"""

import csv
import json
import math
import os
import pathlib
import re
import subprocess
import zlib
from dataclasses import dataclass, field

import numpy as np

ROBOTS = pathlib.Path(__file__).resolve().parent.parent / "morphologies"
GRAVITY_M_S2 = 9.81
CAMERA_M, CAMERA_RAD = 0.001, 0.005
ENCODER_RAD = 2 * math.pi / 4096
# Standard deviation of an encoder before it rounds, in its steps. That of the arm is hidden, too: some idle joints hardly ever flicker.
ENCODER_NOISE_STEPS = 0.4
ARM_NOISE_STEPS = (0.1, 0.45)

BALL_RADIUS_M = 0.05
BALL = """(name: "ball", description: "a solid ball", track: "ball", joints: [],
 bodies: [(name: "ball", mass_kg: 0.5, inertia_kg_m2: (xx: 5.0e-4, yy: 5.0e-4, zz: 5.0e-4), shapes: [(form: Sphere(radius_m: 0.05))])])"""
PUCK_HEIGHT_M = 0.04
PUCK = """(name: "plank", description: "a flat box", hinges: [],
 modules: [(name: "box", kind: Passive(sides_m: (0.2, 0.12, 0.04), mass_kg: 0.8))])"""
PENDULUM_ARM_M, PENDULUM_MASS_KG = 0.2, 0.4
PENDULUM_INERTIA_KG_M2 = 0.001 + PENDULUM_MASS_KG * PENDULUM_ARM_M**2
PENDULUM = """(name: "swing", description: "a pendulum that swings freely", mount: (),
 bodies: [(name: "world", mass_kg: 0.0),
  (name: "bob", mass_kg: 0.4, centre_of_mass_m: (0.0, 0.0, -0.2), inertia_kg_m2: (xx: 0.001, yy: 0.001, zz: 0.001),
   shapes: [(form: Sphere(radius_m: 0.04), pose: (at_m: (0.0, 0.0, -0.2)))])],
 joints: [(name: "swing", parent: "world", child: "bob", pose: (at_m: (0.0, 0.0, 1.0)),
  kind: Turn(axis: (0.0, 1.0, 0.0), viscous_nm_s_rad: 0.005, dry_nm: 0.01))])"""

CAMERA = f"camera: (position_m: Normal({CAMERA_M}), angle_rad: Normal({CAMERA_RAD}))"
# What `realgap study record` adds to repeats by default.
REPEATS = f"""start_position_m: Normal(0.001), start_height_m: Normal(0.001), start_tilt_rad: Normal(0.0175),
 start_heading_rad: Normal(0.0175), servo_zero_rad: Normal(0.00436), {CAMERA}"""


@dataclass(frozen=True)
class Parameter:
    """A parameter that a study varies, with its range."""

    name: str
    low: float
    high: float
    points: int = 7
    kind: str = "acts"
    # Mean and standard deviation of the prior that the study states; truths are drawn from it, within the range.
    prior: tuple = ()

    def ron(self):
        prior = f", prior: ({self.prior[0]}, {self.prior[1]})" if self.prior else ""
        return f'(name: "{self.name}", from: {self.low}, to: {self.high}, points: {self.points}{prior})'

    def draw(self, rng):
        """A truth."""
        while self.prior:
            value = rng.normal(*self.prior)
            if self.low <= value <= self.high:
                return value
        return rng.uniform(self.low, self.high)


@dataclass(frozen=True)
class World:
    """How studies of one kind are made. `record(world, truth, rng, folder, program)` writes FOLDER/rec and returns the settings of the
    program with which it did so; None where it was not the program."""

    name: str
    parameters: tuple
    record: object
    # A file in morphologies/, or the text of a robot.
    robot: str
    # Further fields of the study.
    study: str
    # What the study may state about repeats; empty where the words of a study have none for it.
    noise: str = ""
    families: tuple = ("sweep", "walkers")
    repeats: int = 3
    duration_s: float = 4.0
    # Values that are not searched, by name.
    fixed: dict = field(default_factory=dict)
    timestep_s: float = 1 / 480
    # Options with which `realgap start` is asked which timestep the study of these recordings gets; empty: that of `fixed`.
    start: tuple = ()

    def robot_ron(self):
        return self.robot if self.robot.startswith("(") else (ROBOTS / self.robot).read_text()

    def study_ron(self, states_noise, score=""):
        ranges = ", ".join(parameter.ron() for parameter in self.parameters)
        fixed = ", ".join(f'"{name}": {value}' for name, value in self.fixed.items())
        noise = f", noise: Noise({self.noise})" if states_noise and self.noise else ""
        return (f'Study(morphology: "robot.ron", recordings: ["rec/*.csv"], {self.study},\n set: {{{fixed}}},\n'
                f" parameters: [{ranges}]{noise}{score})\n")

    def feasible(self, parameter, truth):
        """The values of a parameter for which the others can make up within their ranges; the whole range unless its kind is `ratio`."""
        if parameter.kind != "ratio":
            return parameter.low, parameter.high
        own = truth[parameter.name]
        factors = [(other.low / truth[other.name], other.high / truth[other.name]) for other in self.parameters if other.kind == "ratio"]
        return own * max(low for low, _ in factors), own * min(high for _, high in factors)


def run_program(command, cwd=None):
    """Runs the program with one thread; its standard output."""
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=cwd, env=environment)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} ended with code {done.returncode}:\n{done.stderr[-2000:]}")
    return done.stdout


def write_csv(path, columns, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in rows:
            writer.writerow([f"{value:.9g}" for value in row])


def camera_rows(rng, times_s, positions_m, start_velocity_m_s, start_tilt_rad=0.0):
    """Poses of a body that does not turn, with the camera's errors in all samples but the first; the first one has its velocity."""
    rows = []
    for k, (t_s, position_m) in enumerate(zip(times_s, positions_m)):
        tilt = np.array([0.0, start_tilt_rad, 0.0])
        if k > 0:
            position_m = position_m + rng.normal(0, CAMERA_M, 3)
            tilt = tilt + rng.normal(0, CAMERA_RAD, 3)
        half = np.linalg.norm(tilt) / 2
        vector = 0.5 * tilt * (math.sin(half) / half if half > 0 else 1.0)
        velocity = start_velocity_m_s if k == 0 else np.zeros(3)
        rows.append([t_s, *position_m, math.cos(half), *vector, *velocity, 0, 0, 0])
    return rows


CAMERA_COLUMNS = "t_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s".split(",")


def puck_path_m(times_s, speed_m_s, friction):
    """Distance of a box that slides on a flat floor; arrays are broadcast."""
    slide_s = np.minimum(times_s, speed_m_s / (friction * GRAVITY_M_S2))
    return speed_m_s * slide_s - 0.5 * friction * GRAVITY_M_S2 * slide_s**2


def record_puck(world, truth, rng, folder, _program):
    times_s = np.arange(43) / 60
    for k in range(5):
        speed_m_s = round(rng.uniform(0.8, 1.5), 6)
        x_m = puck_path_m(times_s, speed_m_s, truth["floor.friction"])
        path_m = np.stack([x_m, 0 * x_m, 0 * x_m + PUCK_HEIGHT_M / 2], axis=1)
        write_csv(folder / "rec" / f"run_{k:02}.csv", CAMERA_COLUMNS, camera_rows(rng, times_s, path_m, [speed_m_s, 0, 0]))


def ball_path_m(times_s, slope_rad, friction):
    """Distance along the slope of a solid ball that starts at rest: it rolls where friction suffices, else it slides."""
    rolling = 5 / 7 * GRAVITY_M_S2 * np.sin(slope_rad)
    sliding = GRAVITY_M_S2 * (np.sin(slope_rad) - friction * np.cos(slope_rad))
    return 0.5 * np.maximum(rolling, sliding) * times_s**2


def record_ball(world, truth, rng, folder, _program):
    slope_rad = truth["floor.slope_rad"]
    times_s = np.arange(31) / 30
    along, normal = np.array([math.cos(slope_rad), 0, -math.sin(slope_rad)]), np.array([math.sin(slope_rad), 0, math.cos(slope_rad)])
    for k in range(3):
        s_m = ball_path_m(times_s, slope_rad, truth["floor.friction"])
        path_m = s_m[:, None] * along + BALL_RADIUS_M * normal
        # The ball turns, but a ball looks the same from all sides, so that its orientation is recorded as if it did not.
        write_csv(folder / "rec" / f"run_{k:02}.csv", CAMERA_COLUMNS, camera_rows(rng, times_s, path_m, [0, 0, 0]))


def pendulum_angles_rad(times_s, start_rad, viscous_nm_s_rad, dry_nm, mass_scale, step_s=5e-4):
    """Angles of the pendulum that is let go at `start_rad`; parameters may be arrays of one shape. Gravity and friction take turns, each
    exact in time (Strang splitting), so that dry friction stops and holds the pendulum."""
    angle = np.broadcast_to(np.asarray(start_rad, float), np.shape(viscous_nm_s_rad)).copy()
    speed = np.zeros_like(angle)
    pull = PENDULUM_MASS_KG * GRAVITY_M_S2 * PENDULUM_ARM_M / PENDULUM_INERTIA_KG_M2
    rate = viscous_nm_s_rad / (mass_scale * PENDULUM_INERTIA_KG_M2)
    dry = dry_nm / (mass_scale * PENDULUM_INERTIA_KG_M2)
    decay = np.exp(-rate * step_s)
    lost = dry * np.where(rate > 1e-9, (1 - decay) / np.maximum(rate, 1e-9), step_s)
    steps = np.rint(np.asarray(times_s) / step_s).astype(int)
    found, at = [], 0
    for goal in steps:
        while at < goal:
            angle = angle + 0.5 * step_s * speed
            speed = speed - pull * np.sin(angle) * step_s
            speed = np.sign(speed) * np.maximum(np.abs(speed) * decay - lost, 0.0)
            angle = angle + 0.5 * step_s * speed
            at += 1
        found.append(angle.copy())
    return np.array(found)


def encoded(rng, angles_rad, noise_steps):
    """What an encoder reads that has this noise before it rounds."""
    return ENCODER_RAD * np.rint(angles_rad / ENCODER_RAD + rng.normal(0, noise_steps, np.shape(angles_rad)))


def record_pendulum(world, truth, rng, folder, _program):
    times_s = np.arange(201) / 50
    # It is let go from a stop on a step of the encoder, so that its first angle is known.
    start_rad = ENCODER_RAD * round(rng.uniform(0.8, 1.2) * rng.choice([-1, 1]) / ENCODER_RAD)
    angles = pendulum_angles_rad(times_s, start_rad, truth["hinge.viscous_nm_s_rad"], truth["hinge.dry_nm"],
                                 truth.get("body.mass_scale", 1.0), 1e-4)
    read = encoded(rng, angles, ENCODER_NOISE_STEPS)
    read[0] = start_rad
    speeds = np.gradient(read, times_s)
    speeds[0] = 0.0
    write_csv(folder / "rec" / "run_00.csv", ["t_s", "swing_rad", "swing_rad_s"], zip(times_s, read, speeds))


ARM_JOINTS = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
ARM_DRIVEN = {"shoulder_lift": (-0.4, 0.4), "elbow_flex": (-0.5, 0.5)}
LEG_JOINTS = ["FL_hip_joint", "FL_thigh_joint", "FL_calf_joint"]
LEG_DRIVEN = {"FL_hip_joint": (-0.4, 0.4), "FL_thigh_joint": (0.4, 1.2), "FL_calf_joint": (-2.3, -1.3)}
JOINT_RATE_HZ = 50


def arm_commands_rad(rng, duration_s):
    """Commands of all joints at 50 Hz: two joints go from goal to goal at constant speeds and rest in between; the others hold still."""
    times_s = np.arange(round(duration_s * JOINT_RATE_HZ) + 1) / JOINT_RATE_HZ
    commands = np.zeros((len(times_s), len(ARM_JOINTS)))
    commands[:, ARM_JOINTS.index("gripper")] = 0.3
    for name, (low, high) in ARM_DRIVEN.items():
        knots_s, goals = [0.0, 0.2], [rng.uniform(low, high)] * 2
        while knots_s[-1] < duration_s:
            knots_s += [knots_s[-1] + rng.uniform(0.2, 0.7), 0]
            knots_s[-1] = knots_s[-2] + rng.uniform(0.1, 0.5)
            goals += [rng.uniform(low, high)] * 2
        commands[:, ARM_JOINTS.index(name)] = np.interp(times_s, knots_s, goals)
    return times_s, commands


def chirps_rad(rng, duration_s, driven):
    """Commands at 50 Hz: each joint follows a sine of a frequency that rises over the run, from and to hidden ones."""
    times_s = np.arange(round(duration_s * JOINT_RATE_HZ) + 1) / JOINT_RATE_HZ
    columns = []
    for low, high in driven.values():
        first_hz, last_hz = rng.uniform(0.2, 0.5), rng.uniform(1.0, 2.5)
        turns = first_hz * times_s + 0.5 * (last_hz - first_hz) / duration_s * times_s**2
        amplitude = rng.uniform(0.3, 1.0) * 0.5 * (high - low)
        columns.append(0.5 * (low + high) + amplitude * np.sin(2 * math.pi * turns + rng.uniform(0, 2 * math.pi)))
    return times_s, np.column_stack(columns)


def joint_table(joints, times_s, commands, angles):
    columns = ["t_s", *(f"{name}_command_rad" for name in joints), *(f"{name}_rad" for name in joints)]
    return columns, np.column_stack([times_s, commands, angles])


def simulated_angles_rad(world, joints, settings, times_s, commands, start_rad, folder, program):
    """What the program simulates for these commands: the file of joints of a tuning of one run, in which nothing is tuned."""
    here = folder / "truth_run"
    write_csv(here / "rec" / "run.csv", *joint_table(joints, times_s, commands, np.tile(start_rad, (len(times_s), 1))))
    (here / "robot.ron").write_text(world.robot_ron())
    fixed = ", ".join(f'"{name}": {value!r}' for name, value in settings.items())
    (here / "study.ron").write_text(f'Study(morphology: "robot.ron", recordings: ["rec/*.csv"], {world.study}, set: {{{fixed}}},'
                                    ' parameters: [(name: "floor.friction", from: 0.4, to: 0.6)])\n')
    run_program([program, "tune", "study.ron", "--optimizer", "random", "--budget", 1, "--jobs", 1, "--no-report", "--restart", "-o", "out"], here)
    found = {name: {} for name in joints}
    with open(here / "out" / "joints.csv") as file:
        for row in csv.DictReader(file):
            found[row["joint"]][round(float(row["t_s"]) * JOINT_RATE_HZ)] = float(row["simulated_rad"])
    kept = sorted(found[joints[0]])
    return np.array(kept), np.array([[found[name][k] for name in joints] for k in kept])


def record_joints(joints, commands_of):
    """A recorder of one log of a robot that is held: it comes to rest under its first command, and then follows `commands_of`."""

    def record(world, truth, rng, folder, program):
        settings = {**world.fixed, **truth, "timestep_s": world.timestep_s / rng.uniform(2, 5)}
        noise_steps = rng.uniform(*ARM_NOISE_STEPS)
        times_s, commands = commands_of(rng, world.duration_s)
        held = np.tile(commands[0], (101, 1))
        _, resting = simulated_angles_rad(world, joints, settings, np.arange(101) / JOINT_RATE_HZ, held, commands[0], folder, program)
        kept, angles = simulated_angles_rad(world, joints, settings, times_s, commands, resting[-1], folder, program)
        if len(kept) < len(times_s) - 1:
            raise RuntimeError(f"joints.csv of {folder} holds {len(kept)} of {len(times_s)} samples: make the recordings of `{world.name}` shorter")
        write_csv(folder / "rec" / "run_00.csv", *joint_table(joints, times_s[kept], commands[kept], encoded(rng, angles, noise_steps)))
        return {**settings, "encoder_noise_steps": noise_steps}

    return record


def leg_ron():
    """The left front leg of the Unitree Go2 of this repository, whose base is held."""
    text = (ROBOTS / "unitree_go2.ron").read_text()
    kept, is_other = [], ('"FR_', '"RL_', '"RR_')
    for line in text.splitlines():
        if not any(name in line for name in is_other):
            kept.append(line)
    return "\n".join(kept[kept.index("("):])


ARM7_JOINTS = [f"j{k}" for k in range(1, 8)]
ARM7_DRIVEN = {name: (-0.8, 0.8) for name in ARM7_JOINTS}
# Length of each link, m; its mass, kg; the effort that its joint is limited to, N m.
ARM7_LINKS = [(0.16, 3.0, 90.0), (0.2, 3.0, 90.0), (0.2, 2.5, 60.0), (0.2, 2.5, 60.0), (0.2, 1.5, 20.0), (0.12, 1.2, 20.0), (0.08, 0.6, 10.0)]


def arm7_ron():
    """An arm of seven joints that turn about z and y by turns, with position loops."""
    bodies, joints, actuators = ['(name: "base", mass_kg: 0.0)'], [], []
    parent, at_m = "base", 0.1
    for number, (length_m, mass_kg, effort_nm) in enumerate(ARM7_LINKS, 1):
        across, along = mass_kg * (3 * 0.04**2 + length_m**2) / 12, mass_kg * 0.04**2 / 2
        bodies.append(f'(name: "l{number}", mass_kg: {mass_kg}, centre_of_mass_m: (0.01, 0.0, {length_m / 2}), '
                      f'inertia_kg_m2: (xx: {across:.6g}, yy: {across:.6g}, zz: {along:.6g}))')
        axis = "(0.0, 0.0, 1.0)" if number % 2 else "(0.0, 1.0, 0.0)"
        joints.append(f'(name: "j{number}", parent: "{parent}", child: "l{number}", pose: (at_m: (0.0, 0.0, {at_m})), '
                      f'kind: Turn(axis: {axis}, limits_rad: (-2.8, 2.8), viscous_nm_s_rad: 0.5, dry_nm: 0.5))')
        actuators.append(f'(joint: "j{number}", servo: (law: Torque(stiffness_nm_rad: 200.0, damping_nm_s_rad: 10.0), '
                         f'max_torque_nm: {effort_nm}, max_speed_rad_s: 2.5))')
        parent, at_m = f"l{number}", length_m
    parts = [f"{what}: [{', '.join(items)}]" for what, items in [("bodies", bodies), ("joints", joints), ("actuators", actuators)]]
    return f'(name: "arm7", description: "an arm of seven joints", {", ".join(parts)}, mount: (at_m: (0.0, 0.0, 1.2)))'


def arm7_parameters():
    """What `realgap start log.csv arm7.urdf --pd 200,10` proposes for this arm as a URDF, with its priors (run on 2026-11-28)."""
    found = []
    for name, (_, _, effort_nm) in zip(ARM7_JOINTS, ARM7_LINKS):
        dry = max(0.15 * effort_nm, 2.5)
        armature = 0.01 * effort_nm
        found += [Parameter(f"hinge.{name}.armature_kg_m2", 0.0, armature, prior=(0.0, armature / 2)),
                  Parameter(f"hinge.{name}.viscous_nm_s_rad", 0.0, dry, prior=(0.5, dry / 2)),
                  Parameter(f"hinge.{name}.dry_nm", 0.0, dry, prior=(0.5, dry / 2)),
                  Parameter(f"joint.{name}.zero_rad", -0.1, 0.1, prior=(0.0, 0.1))]
    return (*found, Parameter("servo.gain", 0.5, 2.0, prior=(1.0, 0.75)), Parameter("servo.latency_s", 0.0, 0.1, prior=(0.0, 0.05)))


def record_repeats(world, truth, rng, folder, program):
    """Repeats by `realgap study record`, with its own noise of starts, servos and camera."""
    settings = {**world.fixed, **truth, "timestep_s": world.timestep_s / rng.uniform(2, 5), "solver.substeps": int(rng.integers(2, 5)),
                "solver.engine": world.fixed.get("solver.engine", int(rng.integers(0, 2)))}
    values = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
    run_program([program, "study", "record", folder / "robot.ron", "-o", folder / "rec", "--repeats", world.repeats, "--duration", world.duration_s,
                 "--rate-hz", 30, "--seed", int(rng.integers(1, 2**31)), *values])
    return settings


def record_rapier(world, truth, rng, folder, program):
    """As `record_repeats`, always by Rapier."""
    return record_repeats(World(**{**world.__dict__, "fixed": {**world.fixed, "solver.engine": 0}}), truth, rng, folder, program)


MASS = Parameter("body.mass_scale", 0.5, 2.0, 5, "inert")
VISCOUS, DRY = ("hinge.viscous_nm_s_rad", 0.0, 0.03, 7), ("hinge.dry_nm", 0.0, 0.05, 7)
WALK = (Parameter("floor.friction", 0.1, 1.0), Parameter("gait.amplitude_scale", 0.6, 1.4))
SETTLED = 'start: Settled, metric: "rms"'
SEEN = 'start: FromRecording, metric: "rms"'
JOINTS = 'start: FromRecording, metric: "joints"'
WITH_LEAST_SQUARES = ("sweep", "walkers", "least squares")


def walker(name, robot=None, **more):
    return World(name, WALK, record_repeats, robot or f"{name}.ron", SETTLED, REPEATS, **more)


WORLDS = {world.name: world for world in [
    World("ball", (Parameter("floor.slope_rad", 0.1, 0.6), Parameter("floor.friction", 0.02, 0.3)), record_ball, BALL, SEEN, CAMERA),
    World("puck", (Parameter("floor.friction", 0.05, 0.6, 12), MASS), record_puck, PUCK, SEEN, CAMERA),
    World("slope", (Parameter("floor.slope_rad", -0.6, 0.6), Parameter("body.mass_scale", 0.5, 2.0, 7, "inert")), record_repeats, PUCK, SETTLED,
          REPEATS, repeats=2, duration_s=0.8, fixed={"floor.friction": 0.2}),
    World("pend", (Parameter(*VISCOUS), Parameter(*DRY)), record_pendulum, PENDULUM, JOINTS, families=WITH_LEAST_SQUARES),
    World("pendm", (Parameter(*VISCOUS, "ratio"), Parameter(*DRY, "ratio"), Parameter("body.mass_scale", 0.5, 2.0, 7, "ratio")), record_pendulum,
          PENDULUM, JOINTS, families=WITH_LEAST_SQUARES),
    World("arm", tuple(Parameter(f"{what}.{joint}.{unit}", low, high) for joint in ARM_DRIVEN for what, unit, low, high in
                       [("servo", "stiffness_nm_rad", 10, 100), ("servo", "damping_nm_s_rad", 0.3, 5.0), ("hinge", "dry_nm", 0.0, 1.5)]),
          record_joints(ARM_JOINTS, arm_commands_rad), "so101_feetech.ron", JOINTS + ", commands: Commands(), score: Single", families=("walkers", "least squares"),
          duration_s=4.8, fixed={"timestep_s": 0.01, "solver.engine": 1}, timestep_s=0.01),
    # A position loop of known gains around the leg of a Go2: what `realgap start --pd` proposes, in ranges of such a leg.
    World("leg", (*(Parameter(f"{what}.{joint}.{unit}", low, high) for joint in LEG_JOINTS for what, unit, low, high in
                    [("hinge", "armature_kg_m2", 0.0, 0.05), ("hinge", "viscous_nm_s_rad", 0.0, 1.0), ("hinge", "dry_nm", 0.0, 1.0),
                     ("joint", "zero_rad", -0.05, 0.05)]),
                  Parameter("servo.gain", 0.8, 1.25), Parameter("servo.latency_s", 0.0, 0.02)),
          record_joints(LEG_JOINTS, lambda rng, duration_s: chirps_rad(rng, duration_s, LEG_DRIVEN)), leg_ron(),
          JOINTS + ", commands: Commands(), score: Single", families=("least squares",), duration_s=4.8,
          fixed={"timestep_s": 0.0025, "solver.engine": 1}, timestep_s=0.0025),
    World("arm7", arm7_parameters(), record_joints(ARM7_JOINTS, lambda rng, duration_s: chirps_rad(rng, duration_s, ARM7_DRIVEN)), arm7_ron(),
          JOINTS + ", commands: Commands(), score: Single", families=("least squares",), duration_s=4.8,
          fixed={"solver.engine": 1}, timestep_s=0.0025, start=("--pd", "200,10")),
    walker("chain3"),
    walker("spider8"),
    walker("two_module"),
    walker("turtle", "turtlebot3_burger.ron"),
    # Two more that the defaults leave out: no rule has seen them. They are looked at once, at the end.
    walker("chain5"),
    walker("tripod"),
    # Floors under two modules that walk for 10 s: floor_power.py.
    World("floor", (Parameter("floor.friction", 0.1, 1.0, 9), Parameter("floor.restitution", 0.0, 0.8, 9)), record_rapier, "two_module.ron",
          SETTLED, REPEATS, repeats=5, duration_s=10.0),
]}
LAST = ("chain5", "tripod")


def timestep_of_start_s(world, folder, program):
    """The timestep that `realgap start` writes into the study of the recordings in FOLDER/rec."""
    recordings = sorted((folder / "rec").glob("*.csv"))
    run_program([program, "start", *recordings, folder / "robot.ron", *world.start, "-o", folder / "started.ron"])
    found = re.search(r"^ *timestep_s: ([0-9.e-]+),", (folder / "started.ron").read_text(), re.MULTILINE)
    return float(found.group(1))


def make(world, seed, folder, program):
    """Writes FOLDER/robot.ron, study.ron, rec/, settings.json and truth.json, unless they are there; returns the truth. Studies of odd seeds
    state no noise."""
    done = folder / "truth.json"
    if done.exists():
        return json.loads(done.read_text())
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([seed, zlib.crc32(world.name.encode())])
    truth = {parameter.name: float(f"{parameter.draw(rng):.7g}") for parameter in world.parameters}
    (folder / "robot.ron").write_text(world.robot_ron())
    study = world.study_ron(seed % 2 == 0)
    settings = world.record(world, truth, rng, folder, program)
    if world.start:
        settings["study_timestep_s"] = timestep_of_start_s(world, folder, program)
        study = study.replace("set: {", f"timestep_s: {settings['study_timestep_s']}, set: {{", 1)
    (folder / "study.ron").write_text(study)
    (folder / "settings.json").write_text(json.dumps(settings) + "\n")
    done.write_text(json.dumps(truth) + "\n")
    return truth
