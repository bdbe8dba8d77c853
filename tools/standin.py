"""Simulates a robot that was exported by `realgap robot export --format mjcf` in MuJoCo, with the servo laws of realgap.

SI units, radians, world z up, quaternions real part first.
"""

import math

import mujoco
import numpy as np


class Robot:
    """Model, gait and servo law, all read from the MJCF file, or from the model of such a file."""

    def __init__(self, file):
        self.model = file if isinstance(file, mujoco.MjModel) else mujoco.MjModel.from_xml_path(str(file))
        # Number of steps for which a control is held; more than one reduces the number of calls of Python.
        self.hold = 1
        m = self.model
        self.name = self.text("robot")
        # In MuJoCo's order of joints; joint 0 is the free one. Passive hinges have neither servo nor gait.
        driven = set(m.actuator_trnid[:, 0])
        self.joints = [m.joint(j).name for j in range(m.njnt) if j in driven]
        self.angle_at = np.array([m.joint(name).qposadr[0] for name in self.joints], dtype=int)
        self.actuator = np.array([m.actuator(name).id for name in self.joints], dtype=int)
        gaits = np.array([self.numbers(f"gait_{name}") for name in self.joints]).reshape(-1, 4)
        self.offset_rad, self.amplitude_rad, self.frequency_hz, self.phase_rad = gaits.T
        laws = [self.text(f"law_{name}") for name in self.joints]
        servos = np.array([self.numbers(f"servo_{name}") for name in self.joints]).reshape(-1, 3)
        self.velocity_law = np.array([law == "velocity" for law in laws], dtype=bool)
        self.gain_1_s = servos[:, 0]
        # -1 says "no limit".
        self.max_speed_rad_s = np.where(servos[:, 1] < 0, np.inf, servos[:, 1])
        # A mounted robot does not move as a whole.
        self.is_free = m.njnt > 0 and m.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
        self.track = m.site("track").id
        self.floor = m.geom("floor").id

    def text(self, name):
        m = self.model
        t = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_TEXT, name)
        if t < 0:
            raise SystemExit(f"error: no <custom><text name={name!r}>; was this file written by `realgap robot export --format mjcf`?")
        start = m.text_adr[t]
        return bytes(m.text_data[start : start + m.text_size[t]]).rstrip(b"\0").decode()

    def numbers(self, name):
        m = self.model
        n = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_NUMERIC, name)
        if n < 0:
            raise SystemExit(f"error: no <custom><numeric name={name!r}>; was this file written by `realgap robot export --format mjcf`?")
        start = m.numeric_adr[n]
        return m.numeric_data[start : start + m.numeric_size[n]]

    def set_friction(self, friction):
        """Pair value robot-floor; module-module is its square, as in realgap."""
        m = self.model
        m.geom_friction[m.geom_bodyid > 0, 0] = friction**2
        m.geom_friction[self.floor, 0] = friction

    def command_rad(self, t_s):
        """Commanded angles at one time, or one row per time."""
        t_s = np.asarray(t_s, dtype=float)[..., None]
        turn = 2 * math.pi * self.frequency_hz * t_s + self.phase_rad
        return self.offset_rad + self.amplitude_rad * np.sin(turn)

    def drive(self, data, target_rad):
        """Sets the controls of the next step."""
        error = target_rad - data.qpos[self.angle_at]
        speed = np.clip(self.gain_1_s * error, -self.max_speed_rad_s, self.max_speed_rad_s)
        data.ctrl[self.actuator] = np.where(self.velocity_law, speed, target_rad)

    def lowest_m(self, data):
        """Smallest distance of a colliding shape to the floor."""
        m = self.model
        normal = data.geom_xmat[self.floor].reshape(3, 3)[:, 2]
        low = math.inf
        for g in range(m.ngeom):
            # The world's own geoms are the floor and what stands on it.
            if m.geom_bodyid[g] == 0 or m.geom_contype[g] == 0:
                continue
            along = data.geom_xmat[g].reshape(3, 3).T @ normal
            centre = (data.geom_xpos[g] - data.geom_xpos[self.floor]) @ normal
            low = min(low, centre - self.reach_m(g, along))
        return low

    def reach_m(self, g, along):
        """How far a shape reaches from its centre against a direction in its own frame."""
        m, kind = self.model, mujoco.mjtGeom
        radius_m, half_m = m.geom_size[g][:2]
        if m.geom_type[g] == kind.mjGEOM_SPHERE:
            return radius_m
        if m.geom_type[g] == kind.mjGEOM_CAPSULE:
            return radius_m + half_m * abs(along[2])
        if m.geom_type[g] == kind.mjGEOM_CYLINDER:
            return radius_m * math.hypot(along[0], along[1]) + half_m * abs(along[2])
        if m.geom_type[g] == kind.mjGEOM_MESH:
            mesh = m.geom_dataid[g]
            first = m.mesh_vertadr[mesh]
            return -(m.mesh_vert[first : first + m.mesh_vertnum[mesh]] @ along).min()
        return np.abs(along) @ m.geom_size[g]

    def place(self, shift_m=(0, 0, 0), turn_rad=(0, 0, 0), servo_zero_rad=0.0):
        """A new state: servos at their first command, the robot turned, shifted and just touching the floor."""
        m, data = self.model, mujoco.MjData(self.model)
        angle = np.linalg.norm(turn_rad)
        quat = np.zeros(4)
        mujoco.mju_axisAngle2Quat(quat, np.asarray(turn_rad) / angle if angle > 0 else np.array([0.0, 0, 1]), angle)
        # The root's centre goes to x = y = 0 before the shift, as in realgap.
        if self.is_free:
            data.qpos[0:3] = [shift_m[0], shift_m[1], 1.0]
            data.qpos[3:7] = quat
        data.qpos[self.angle_at] = self.command_rad(0.0) + servo_zero_rad
        mujoco.mj_forward(m, data)
        if self.is_free:
            normal_z = data.geom_xmat[self.floor].reshape(3, 3)[2, 2]
            data.qpos[2] += -self.lowest_m(data) / normal_z + max(shift_m[2], 0.0)
            mujoco.mj_forward(m, data)
        return data

    def settle(self, data, servo_zero_rad=0.0, limit_s=3.0):
        """Holds the first command until nothing moves; True if the robot came to rest."""
        dt = self.hold * self.model.opt.timestep
        target = self.command_rad(0.0) + servo_zero_rad
        window = max(1, math.ceil(0.1 / dt))
        before = (data.xpos.copy(), data.xquat.copy())
        for _ in range(math.ceil(limit_s / (window * dt))):
            for _ in range(window):
                self.drive(data, target)
                mujoco.mj_step(self.model, data, self.hold)
            moved = np.linalg.norm(data.xpos - before[0], axis=1).max()
            cosine = np.abs((data.xquat * before[1]).sum(axis=1)).clip(max=1.0)
            if moved < 2e-4 and (2 * np.arccos(cosine)).max() < 4e-3:
                return True
            before = (data.xpos.copy(), data.xquat.copy())
        return False

    def pose(self, data):
        """Position and orientation (world from body) of the tracked module's centre."""
        mujoco.mj_kinematics(self.model, data)
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, data.site_xmat[self.track])
        return data.site_xpos[self.track].copy(), quat

    def walk(self, data, duration_s, rate_hz, servo_zero_rad=0.0):
        """Times, positions and quaternions at `rate_hz` from time 0 while the gait runs."""
        m, dt = self.model, self.hold * self.model.opt.timestep
        times = np.arange(int(duration_s * rate_hz + 1e-9) + 1) / rate_hz
        last = [(0.0, *self.pose(data))]
        rows = [last[0]]
        steps = math.ceil(times[-1] / dt - 1e-9)
        # The command at the middle of the hold time is used for all of it.
        commands = self.command_rad((np.arange(steps) + 0.5) * dt) + servo_zero_rad
        following = 1
        for step in range(steps):
            end = (step + 1) * dt
            due = following < len(times) and times[following] <= end + 1e-9
            if due:
                before = self.pose(data)
            self.drive(data, commands[step])
            mujoco.mj_step(m, data, self.hold)
            if due:
                share = min(max((times[following] - step * dt) / dt, 0.0), 1.0)
                after = self.pose(data)
                sign = 1.0 if before[1] @ after[1] >= 0 else -1.0
                quat = (1 - share) * before[1] + share * sign * after[1]
                rows.append((times[following], (1 - share) * before[0] + share * after[0], quat / np.linalg.norm(quat)))
                following += 1
        if not np.isfinite(data.qpos).all():
            raise SystemExit("error: MuJoCo diverged; shorten <option timestep> in the MJCF file")
        return np.array([r[0] for r in rows]), np.array([r[1] for r in rows]), np.array([r[2] for r in rows])
