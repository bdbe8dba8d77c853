"""A bicycle with Pacejka tyres for the small car of TU Delft, fitted by least squares to windows of recorded runs: a peer to compare with.

python3 tools/car_bicycle.py FOLDER [ablation]     (needs numpy and scipy; FOLDER holds the CSV files of the runs)

Each window starts every 0.5 s while the motor obeys and the car moves faster than 0.2 m/s. Its start velocity comes from the 0.1 s before it. The
residuals are the position errors after 0.5, 1.0 and 1.5 s. Runs are judged that were not fitted; where a kind has one run, its second
half is judged after a fit to the first. Trim and dead zone move between runs: each fitted run has its own, and a run that was not
fitted takes their median. `ablation` leaves one element out at a time. Prints medians in mm by kind.
"""

import csv
import pathlib
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

HORIZONS_S = (0.5, 1.0, 1.5)
STEP_S = 0.01
PAST_S = 0.1
MASS_KG, WHEELBASE_M, GRAVITY = 1.58, 0.175, 9.81
FRONT_SHARE = 0.847 / 1.58
TO_FRONT_M, TO_REAR_M = WHEELBASE_M * (1 - FRONT_SHARE), WHEELBASE_M * FRONT_SHARE
# The point that motion capture follows, ahead of the centre of mass.
POINT_AHEAD_M = 0.115 - TO_REAR_M

# name: start, lowest, highest. Those of a run begin with "run_".
PARAMETERS = {
    "friction": (0.8, 0.1, 2.0),
    "front_slip_factor": (5.0, 0.5, 40.0),
    "rear_slip_factor": (8.0, 0.5, 40.0),
    "shape": (1.3, 1.0, 1.9),
    "yaw_inertia_kg_m2": (0.0065, 0.002, 0.02),
    "force_n": (23.0, 2.0, 80.0),
    "force_loss_n_s_m": (4.0, 0.0, 20.0),
    "drag_n": (1.4, 0.0, 5.0),
    "drag_n_s_m": (0.4, 0.0, 3.0),
    "front_drive": (0.5, 0.0, 1.0),
    "steering_gain_rad": (0.45, 0.1, 1.5),
    "steering_bend": (1.1, 0.05, 3.0),
    "steering_lag_s": (0.05, 0.002, 0.4),
    "steering_delay_s": (-0.04, -0.12, 0.15),
    "throttle_lag_s": (0.05, 0.002, 0.4),
    "throttle_delay_s": (-0.04, -0.12, 0.15),
    "heading_offset_rad": (0.0, -0.05, 0.05),
    "point_left_m": (0.0, -0.03, 0.03),
    "run_trim_rad": (0.0, -0.1, 0.1),
    "run_dead_zone": (0.16, 0.0, 0.4),
}
SCALES = {name: max(abs(start), 0.02) for name, (start, *_) in PARAMETERS.items()}


class Run:
    """One recorded run with its windows."""

    def __init__(self, path):
        with open(path) as lines:
            rows = list(csv.reader(lines))
        table = np.array(rows[1:], float).T
        columns = dict(zip(rows[0], table))
        self.name = pathlib.Path(path).stem
        self.kind = self.name.rsplit("_", 1)[0]
        self.times_s = columns["t_s"]
        self.point_m = np.stack([columns["x_m"], columns["y_m"]], 1)
        self.heading_rad = columns["heading_rad"]
        self.throttle = columns["throttle"] * columns["enabled"]
        self.steering = columns["steering"]
        self.enabled = columns["enabled"]
        self.windows(HORIZONS_S[-1])

    def at(self, values, times_s):
        return np.interp(times_s, self.times_s, values)

    def windows(self, longest_s):
        """Start times of windows with the velocity of the past 0.1 s, in the frame of the recorded heading."""
        starts, speeds, rates = [], [], []
        time_s = self.times_s[0] + PAST_S
        every = time_s
        while every + longest_s <= self.times_s[-1]:
            # A window begins at a sample; at 20 Hz three samples span 0.1 s and a few milliseconds.
            time_s = self.times_s[np.searchsorted(self.times_s, every - 1e-6)]
            past = (self.times_s >= time_s - PAST_S - 0.008) & (self.times_s <= time_s + 1e-6)
            span = (self.times_s >= time_s - PAST_S - 0.06) & (self.times_s <= time_s + longest_s + 0.06)
            steps = np.diff(self.times_s[span])
            index = min(np.searchsorted(self.times_s, time_s), len(self.times_s) - 1)
            if time_s + longest_s <= self.times_s[-1] and past.sum() >= 3 and steps.max() < 0.1 and self.enabled[index] > 0.5:
                t = self.times_s[past] - self.times_s[past].mean()
                slope = lambda values: (t @ (values - values.mean(0))) / (t @ t)
                velocity = slope(self.point_m[past])
                jump = np.hypot(*np.diff(self.point_m[span], axis=0).T) / steps
                if np.hypot(*velocity) > 0.2 and jump.max() < 8.0:
                    middle_s = self.times_s[past].mean()
                    starts.append((time_s, middle_s))
                    speeds.append(velocity)
                    rates.append(slope(self.heading_rad[past]))
            every += 0.5
        self.starts_s = np.array(starts).reshape(-1, 2)
        self.velocity_m_s = np.array(speeds).reshape(-1, 2)
        self.rate_rad_s = np.array(rates)


class Batch:
    """Windows of several runs, simulated side by side."""

    def __init__(self, runs, half=None):
        self.runs = runs
        keep = []
        for run in runs:
            middle_s = 0.5 * (run.times_s[0] + run.times_s[-1])
            t = run.starts_s[:, 0]
            keep.append(np.full(len(t), True) if half is None else (t + HORIZONS_S[-1] < middle_s if half == 0 else t - PAST_S > middle_s))
        join = lambda of: np.concatenate([of(run)[chosen] for run, chosen in zip(runs, keep)])
        self.run = np.concatenate([np.full(k.sum(), i) for i, k in enumerate(keep)]).astype(int)
        self.starts_s = join(lambda run: run.starts_s)
        self.velocity_m_s = join(lambda run: run.velocity_m_s)
        self.rate_rad_s = join(lambda run: run.rate_rad_s)
        self.steps = int(round((HORIZONS_S[-1] + PAST_S) / STEP_S))
        begin = self.starts_s[:, 1]
        pick = lambda times, of: np.concatenate([run.at(of(run), times[self.run == i]) for i, run in enumerate(runs)])
        self.pick = pick
        self.heading_rad = pick(begin, lambda run: run.heading_rad)
        self.begin_m = self.position(begin)
        self.start_m = self.position(self.starts_s[:, 0])
        self.start_heading_rad = pick(self.starts_s[:, 0], lambda run: run.heading_rad)
        self.real_m = np.stack([self.position(self.starts_s[:, 0] + h) for h in HORIZONS_S], 1)
        self.real_heading_rad = np.stack([pick(self.starts_s[:, 0] + h, lambda run: run.heading_rad) for h in HORIZONS_S], 1)

    def position(self, times_s):
        return np.stack([self.pick(times_s, lambda run, k=k: run.point_m[:, k]) for k in (0, 1)], 1)

    def constant(self):
        """Errors of constant speed and turn rate."""
        errors = []
        for k, h in enumerate(HORIZONS_S):
            angle = self.rate_rad_s * h
            small = np.abs(angle) < 1e-6
            safe = np.where(small, 1.0, angle)
            along = np.where(small, 1.0, np.sin(safe) / safe)
            across = np.where(small, 0.0, (1 - np.cos(safe)) / safe)
            v = self.velocity_m_s * h
            turned = np.stack([v[:, 0] * along - v[:, 1] * across, v[:, 1] * along + v[:, 0] * across], 1)
            # The mean velocity of the past belongs to its middle.
            ahead = self.rate_rad_s * (self.starts_s[:, 0] - self.starts_s[:, 1])
            c, s = np.cos(ahead), np.sin(ahead)
            turned = np.stack([c * turned[:, 0] - s * turned[:, 1], s * turned[:, 0] + c * turned[:, 1]], 1)
            errors.append(np.hypot(*(self.start_m + turned - self.real_m[:, k]).T))
        return np.array(errors)


def filtered(run, command, times_s, lag_s, delay_s):
    """The command, held between samples, after a delay and a lag of first order, on a fine grid."""
    grid = np.arange(run.times_s[0] - 0.3, run.times_s[-1] + 0.3, STEP_S)
    # Commands between two samples are mixed, so that the result is smooth in the delay.
    held = np.interp(grid - delay_s, run.times_s, command)
    share = 1 - np.exp(-STEP_S / lag_s)
    out = lfilter([share], [1, share - 1], held - held[0]) + held[0]
    return np.interp(times_s, grid, out)


def simulate(batch, p, groups=None):
    """Positions of the point after the horizons. `p` holds a number, or one per window, for every parameter."""
    h = STEP_S
    n = len(batch.run)
    times = batch.starts_s[:, 1][:, None] + h * (np.arange(batch.steps) + 0.5)[None, :]
    throttle, steering = np.empty_like(times), np.empty_like(times)
    for i, run in enumerate(batch.runs):
        mine = batch.run == i
        throttle[mine] = filtered(run, run.throttle, times[mine], p["throttle_lag_s"], p["throttle_delay_s"])
        steering[mine] = filtered(run, run.steering, times[mine], p["steering_lag_s"], p["steering_delay_s"])
    angle = p["steering_gain_rad"] * np.tanh(p["steering_bend"] * steering) / np.tanh(p["steering_bend"]) + _column(p["run_trim_rad"])
    pressed = throttle - _column(p["run_dead_zone"])
    pressed = 0.02 * np.logaddexp(0, np.clip(pressed / 0.02, -40, 300))

    offset = p["heading_offset_rad"]
    axis = batch.heading_rad + offset
    c, s = np.cos(axis), np.sin(axis)
    vx = c * batch.velocity_m_s[:, 0] + s * batch.velocity_m_s[:, 1]
    vy = -s * batch.velocity_m_s[:, 0] + c * batch.velocity_m_s[:, 1]
    rate = batch.rate_rad_s.copy()
    left = p["point_left_m"]
    vx = vx + rate * left
    vy = vy - rate * POINT_AHEAD_M
    heading = axis.copy()
    x = batch.begin_m[:, 0] - (c * POINT_AHEAD_M - s * left)
    y = batch.begin_m[:, 1] - (s * POINT_AHEAD_M + c * left)

    mu, shape = p["friction"], p["shape"]
    loads = MASS_KG * GRAVITY * np.array([FRONT_SHARE, 1 - FRONT_SHARE])
    ceilings = mu * loads[0], mu * loads[1]
    # Slip stiffness is load × factor × 1.3: it stays where friction changes.
    stiff = p["front_slip_factor"] / mu / shape, p["rear_slip_factor"] / mu / shape
    share = p["front_drive"]
    inertia = p["yaw_inertia_kg_m2"]

    def push(vx, vy, rate, delta, u):
        low = np.maximum(vx, 0.1)
        drive = np.maximum(p["force_n"] - p["force_loss_n_s_m"] * vx, 0) * u
        drag = p["drag_n"] * np.tanh(vx / 0.05) + p["drag_n_s_m"] * vx
        total = drive - drag
        cd, sd = np.cos(delta), np.sin(delta)
        fy_wheel = vy + rate * TO_FRONT_M
        slip_f = np.arctan2(cd * fy_wheel - sd * vx, np.maximum(cd * low + sd * fy_wheel, 0.1))
        slip_r = np.arctan2(vy - rate * TO_REAR_M, low)
        lon_f = np.clip(share * total, -0.97 * ceilings[0], 0.97 * ceilings[0])
        lon_r = np.clip((1 - share) * total, -0.97 * ceilings[1], 0.97 * ceilings[1])
        lat_f = -np.sqrt(ceilings[0] ** 2 - lon_f**2) * np.sin(shape * np.arctan(stiff[0] * slip_f))
        lat_r = -np.sqrt(ceilings[1] ** 2 - lon_r**2) * np.sin(shape * np.arctan(stiff[1] * slip_r))
        ax = (lon_f * cd - lat_f * sd + lon_r) / MASS_KG
        ay = (lon_f * sd + lat_f * cd + lat_r) / MASS_KG
        ar = ((lon_f * sd + lat_f * cd) * TO_FRONT_M - lat_r * TO_REAR_M) / inertia
        return ax + vy * rate, ay - vx * rate, ar

    def point():
        c, s = np.cos(heading), np.sin(heading)
        return np.stack([x + c * POINT_AHEAD_M - s * left, y + s * POINT_AHEAD_M + c * left], 1), heading - offset

    shape_out = [np.zeros((n, 2)) for _ in range(len(HORIZONS_S) + 1)]
    angles = [np.zeros(n) for _ in range(len(HORIZONS_S) + 1)]
    # Each window lasts a whole number of steps, and its last part is interpolated.
    ends = [batch.starts_s[:, 0] - batch.starts_s[:, 1] + k for k in (0.0, *HORIZONS_S)]
    before = point()
    for k in range(batch.steps):
        delta, u = angle[:, k], pressed[:, k]
        a1, b1, r1 = push(vx, vy, rate, delta, u)
        a2, b2, r2 = push(vx + 0.5 * h * a1, vy + 0.5 * h * b1, rate + 0.5 * h * r1, delta, u)
        mx, my, mr = vx + 0.5 * h * a1, vy + 0.5 * h * b1, rate + 0.5 * h * r1
        mid = heading + 0.5 * h * rate
        x = x + h * (np.cos(mid) * mx - np.sin(mid) * my)
        y = y + h * (np.sin(mid) * mx + np.cos(mid) * my)
        heading = heading + h * mr
        vx, vy, rate = vx + h * a2, vy + h * b2, rate + h * r2
        now = None
        for j, end in enumerate(ends):
            inside = (end >= k * h) & (end < (k + 1) * h)
            if inside.any():
                now = now or point()
                w = ((end - k * h) / h)[inside, None]
                shape_out[j][inside] = (1 - w) * before[0][inside] + w * now[0][inside]
                angles[j][inside] = (1 - w[:, 0]) * before[1][inside] + w[:, 0] * now[1][inside]
        before = now or point()
    # The measured state at the start of the window replaces the simulated one: the path is moved and turned onto it.
    turn = batch.start_heading_rad - angles[0]
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    found = []
    for j in range(len(HORIZONS_S)):
        d = shape_out[j + 1] - shape_out[0]
        found.append(batch.start_m + np.concatenate([c * d[:, :1] - s * d[:, 1:], s * d[:, :1] + c * d[:, 1:]], 1))
    return np.stack(found, 1), np.stack([angles[j + 1] + turn for j in range(len(HORIZONS_S))], 1)


def _column(value):
    return value[:, None] if np.ndim(value) else value


# Position errors of about these sizes are expected after the horizons, in m.
SCALES_M = np.array([0.03, 0.09, 0.16])
# So are errors of the heading, in rad.
SCALES_RAD = np.array([0.06, 0.1, 0.13])


# Derivatives are differences over this part of a parameter's scale: windows in which the car spins are rough on smaller ones.
DIFFERENCE = 1e-2


class Fit:
    """Least squares over the free parameters; those of a run have one value for each."""

    def __init__(self, batch, free, fixed, weights=None, prior=True):
        self.batch, self.free, self.fixed = batch, free, fixed
        self.prior = prior
        count = len(batch.runs)
        self.slots = [(name, r) for name in free for r in (range(count) if name.startswith("run_") else [None])]
        sizes = np.bincount(batch.run, minlength=count)
        # Every run counts as much as any other.
        self.weight = np.sqrt(len(batch.run) / count / np.maximum(sizes, 1))[batch.run]

    def unpack(self, z):
        p = {name: start for name, (start, *_) in PARAMETERS.items()} | self.fixed
        for name in self.free:
            values = np.array([v for (n, r), v in zip(self.slots, z) if n == name])
            p[name] = values if name.startswith("run_") else values[0]
        return p

    def spread(self, p):
        return {n: (v[self.batch.run] if n.startswith("run_") and np.ndim(v) else v) for n, v in p.items()}

    def windows(self, z):
        place, heading = simulate(self.batch, self.spread(self.unpack(z)))
        off = ((place - self.batch.real_m) / SCALES_M[None, :, None]).reshape(len(self.batch.run), -1)
        turned = (heading - self.batch.real_heading_rad) / SCALES_RAD
        return np.concatenate([off, turned], 1) * self.weight[:, None]

    PRIORS = {"run_trim_rad": 0.02, "run_dead_zone": 0.03}

    def residuals(self, z):
        parts = [np.clip(np.nan_to_num(self.windows(z), nan=50.0), -50, 50).ravel()]
        p = self.unpack(z)
        for name, sd in self.PRIORS.items():
            if name in self.free and len(self.batch.runs) > 1:
                parts.append((p[name] - p[name].mean()) / sd * 2.0)
        return np.concatenate(parts)

    def jacobian(self, z):
        base = self.residuals(z)
        wide = self.windows(z)
        out = np.zeros((len(base), len(z)))
        rows = wide.size
        columns = wide.shape[1]
        for name in self.free:
            mine = [i for i, (n, _) in enumerate(self.slots) if n == name]
            step = DIFFERENCE * SCALES[name] * np.where(z[mine] + DIFFERENCE * SCALES[name] > PARAMETERS[name][2], -1, 1)
            moved = z.copy()
            moved[mine] += step
            change = self.windows(moved) - wide
            for i, s in zip(mine, step):
                run = self.slots[i][1]
                part = change if run is None else np.where((self.batch.run == run)[:, None], change, 0.0)
                out[:rows, i] = part.ravel() / s
        tail = rows
        p = self.unpack(z)
        for name, sd in self.PRIORS.items():
            if name in self.free and len(self.batch.runs) > 1:
                mine = [i for i, (n, _) in enumerate(self.slots) if n == name]
                k = len(mine)
                out[tail : tail + k, mine] = (np.eye(k) - 1 / k) / sd * 2.0
                tail += k
        return np.nan_to_num(out)

    def run(self, start=None, evaluations=25):
        start = start or {}
        z0, low, high = [], [], []
        for name, r in self.slots:
            s, a, b = PARAMETERS[name]
            v = start.get(name, self.fixed.get(name, s))
            v = np.mean(v)
            z0.append(np.clip(v, a + 1e-6, b - 1e-6))
            low.append(a)
            high.append(b)
        scale = [SCALES[n] for n, _ in self.slots]
        found = least_squares(
            self.residuals, z0, jac=self.jacobian, bounds=(low, high), x_scale=scale, loss="soft_l1", max_nfev=evaluations, ftol=1e-5
        )
        return self.unpack(found.x), found


TYPICAL = np.median


def errors_mm(batch, p):
    p = {n: (float(TYPICAL(v)) if np.ndim(v) else v) for n, v in p.items()}
    place, _ = simulate(batch, p)
    return 1e3 * np.linalg.norm(place - batch.real_m, axis=2)


def row(errors):
    return " / ".join(f"{np.median(errors[:, k]):.0f}" for k in range(3))


def constant_row(batch):
    return " / ".join(f"{1e3 * np.median(e):.0f}" for e in batch.constant())


ALL = list(PARAMETERS)
GENERAL = [n for n in ALL if n not in ("shape", "front_drive", "yaw_inertia_kg_m2")]
# What a floor changes: its friction, and what moves between any two runs.
FLOOR = ["friction", "run_dead_zone", "run_trim_rad"]
# The cars on the slippery floors were set up differently.
SET_UP = ["force_n", "throttle_delay_s", "steering_gain_rad", "steering_delay_s"]
# The same runs as in sweeps/dart_car_fit.ron, without the tiles.
FITTED = {"rubber_free_02", "rubber_ramps_03", "rubber_ramps_06"}


def experiment(runs, free, fixed, start=None):
    rubber = [r for r in runs if r.kind.startswith("rubber")]
    p, _ = Fit(Batch([r for r in rubber if r.name in FITTED]), free, fixed).run(start)
    return {r.name: (errors_mm(Batch([r]), p), p) for r in rubber if r.name not in FITTED}


def floors(runs, free, fixed, p):
    by = {run.name: run for run in runs}
    base = {n: (float(TYPICAL(v)) if np.ndim(v) else v) for n, v in p.items()}
    again = [n for n in FLOOR if n in free]
    rows = {}
    laps = [r for r in runs if r.kind == "slippery_laps"]
    # The slippery floors have another set-up: its commands come late, and they are recorded on time.
    late = {n: v for n, v in (("steering_delay_s", 0.05), ("throttle_delay_s", 0.05)) if n in free}
    on_slippery = again + [n for n in SET_UP if n in free]
    for judged in laps:
        q, _ = Fit(Batch([r for r in laps if r is not judged]), on_slippery, base | fixed).run(base | late | {"friction": 0.4})
        rows[judged.name] = errors_mm(Batch([judged]), q), q
    for name in ("slippery_notape_01", "tiles_circles_01", "tiles_drift_01"):
        slippery = name.startswith("slippery")
        begin = base | {"friction": 0.4} | (late if slippery else {})
        for half in (0, 1):
            q, _ = Fit(Batch([by[name]], half), on_slippery if slippery else again, base | fixed).run(begin)
            rows[f"{name} half {2 - half}"] = errors_mm(Batch([by[name]], 1 - half), q), q
    return rows


ABLATIONS = {
    "all elements": {},
    "mean in place of the median": "mean",
    "one trim and one dead zone": "pooled",
    "no heading and point offset": {"heading_offset_rad": 0.0, "point_left_m": 0.0},
    "no lag": {"steering_lag_s": 0.002, "throttle_lag_s": 0.002},
    "no delay": {"steering_delay_s": 0.0, "throttle_delay_s": 0.0},
    "steering without bend": {"steering_bend": 0.05},
    "no dead zone": {"run_dead_zone": 0.0},
    "force without loss by speed": {"force_loss_n_s_m": 0.0},
    "rear wheels driven": {"front_drive": 0.0},
    "tyres near Coulomb": {"front_slip_factor": 40.0, "rear_slip_factor": 40.0},
}


def main():
    global TYPICAL
    folder = pathlib.Path(sys.argv[1])
    runs = [Run(path) for path in sorted(folder.glob("*.csv"))]
    for run in runs:
        print(f"constant {run.name:22} {len(run.starts_s):4} windows {constant_row(Batch([run]))}")
    names = ABLATIONS if "ablation" in sys.argv[2:] else ["all elements"]
    for name in names:
        change = ABLATIONS[name]
        fixed = {} if isinstance(change, str) else dict(change)
        TYPICAL = np.mean if change == "mean" else np.median
        free = [n for n in GENERAL if n not in fixed]
        if change == "pooled":
            Fit.PRIORS = {"run_trim_rad": 1e-6, "run_dead_zone": 1e-6}
        rows = experiment(runs, free, fixed)
        best = rows["rubber_free_03"][1]
        rows |= floors(runs, free, fixed, best)
        Fit.PRIORS = {"run_trim_rad": 0.02, "run_dead_zone": 0.03}
        print(f"== {name}")
        for run, (errors, p) in rows.items():
            print(f"  {run:26} {len(errors):4} windows  {row(errors)}   friction {p['friction']:.3f}")
        if name == "all elements":
            for n, v in best.items():
                print(f"    {n} {np.round(v, 4)}")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
