"""Fits the tosses of a real cube in MuJoCo alone, as a peer of a study with `simulator: Mujoco(...)`.

    python tools/toss_mujoco.py FOLDER [--every 4] [--runs 200]      # the bare fit
    python tools/toss_mujoco.py FOLDER --study OUT                   # the same question as studies of realgap
    realgap tune OUT/study.ron --optimizer nelder-mead --budget 200 --allow-command -o OUT/fit
    realgap evaluate OUT/judged.ron --parameters OUT/fit/best.ron --allow-command
    realgap sweep OUT/map.ron --allow-command -o OUT/map             # 441 points over friction and solref

FOLDER holds the tosses of ContactNets (docs/validation/tosses.md). Of these, in order of their names, every N-th of the even-numbered
is fitted, and all odd-numbered are judged. Six parameters: friction, both numbers of solref, the height of the centre of mass, the
moment of inertia, and recorded over true length; the score is the metric `pose`: mean error in body lengths plus mean angle in radians.
The fit is SciPy's Nelder-Mead from the model's own values. Friction is that of an elliptic cone: with MuJoCo's pyramid the nearest of
60 points is 24 % and 18 degrees off, and with the cone 13 % and 13 degrees. Needs numpy, scipy and mujoco; not a part of the tests.
"""

import argparse
import csv
import pathlib
import sys
import time

try:
    import mujoco
    import numpy as np
    from scipy.optimize import minimize
except ImportError as missing:
    sys.exit(f"SKIPPED: {missing}; pip install numpy scipy mujoco")

SIDE_M, MASS_KG, STEP_S = 0.1048, 0.37, 0.0016891891891891893
INERTIA = MASS_KG * SIDE_M**2 / 6
NAMES = ("geom.*.friction", "geom.*.solref", "geom.*.solref[1]", "body.cube.ipos[2]", "body.cube.inertia*", "recording.length_scale")
LOW = np.array([0.1, 0.0035, 0.1, -0.01, 0.8 * INERTIA, 0.95])
HIGH = np.array([0.4, 0.03, 1.5, 0.01, 1.8 * INERTIA, 1.05])
OWN = np.array([0.2, 0.02, 1.0, 0.0, INERTIA, 1.0])
MODEL = f"""<mujoco model="cube">
  <option timestep="{STEP_S!r}" cone="elliptic"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="cube" pos="0 0 1">
      <freejoint/>
      <geom name="cube" type="box" size="{SIDE_M / 2!r} {SIDE_M / 2!r} {SIDE_M / 2!r}" mass="{MASS_KG!r}"/>
    </body>
  </worldbody>
</mujoco>
"""


def read(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    assert rows[0][1:8] == ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]
    return np.array(rows[1:], dtype=float)


class Cube:
    """The cube; its centre of mass is off its middle, so that MuJoCo compiles it as a body of any kind."""

    def __init__(self):
        spec = mujoco.MjSpec.from_string(MODEL)
        body = spec.body("cube")
        body.explicitinertial, body.mass, body.inertia, body.ipos = True, MASS_KG, [INERTIA] * 3, [1e-3] * 3
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.runs = 0

    def errors(self, values, toss):
        """Mean errors of position, in sides of the cube, and of rotation, in radians."""
        friction, time_constant, damping, height, inertia, scale = values
        model, data = self.model, self.data
        model.geom_friction[:, 0], model.geom_solref[:, 0], model.geom_solref[:, 1] = friction, time_constant, damping
        model.body_ipos[1], model.body_inertia[1] = [0.0, 0.0, height], inertia
        mujoco.mj_setConst(model, data)
        mujoco.mj_resetData(model, data)
        data.qpos[:3], data.qpos[3:] = toss[0, 1:4] / scale, toss[0, 4:8] / np.linalg.norm(toss[0, 4:8])
        data.qvel[:3], data.qvel[3:] = toss[0, 8:11] / scale, toss[0, 11:14]
        times = toss[:, 0] - toss[0, 0]
        steps = int(np.ceil(times[-1] / STEP_S - 1e-9)) + 1
        seen = np.empty((steps, 7))
        for step in range(steps):
            seen[step] = data.qpos
            mujoco.mj_step(model, data)
        self.runs += 1
        if not np.isfinite(seen).all():
            return 10.0, np.pi
        own = np.arange(steps) * STEP_S
        place = np.stack([np.interp(times, own, seen[:, k]) for k in range(3)], axis=1)
        turn = np.stack([np.interp(times, own, seen[:, k]) for k in range(3, 7)], axis=1)
        turn /= np.linalg.norm(turn, axis=1, keepdims=True)
        real = toss[:, 4:8] / np.linalg.norm(toss[:, 4:8], axis=1, keepdims=True)
        angle = 2 * np.arccos(np.clip(np.abs(np.sum(turn * real, axis=1)), 0, 1))
        away = np.linalg.norm(place - toss[:, 1:4] / scale, axis=1)
        return away.mean() / SIDE_M, angle.mean()

    def score(self, values, tosses):
        return np.mean([self.errors(values, toss) for toss in tosses], axis=0)


def write_studies(out, fitted, judged):
    out.mkdir(parents=True, exist_ok=True)
    (out / "cube.xml").write_text(MODEL)
    lines = "".join(f'        (name: "{name}", from: {float(a)!r}, to: {float(b)!r}),\n' for name, a, b in zip(NAMES, LOW, HIGH))
    grid = "".join(
        f'        (name: "{name}", from: {float(a)!r}, to: {float(b)!r}, points: 21),\n' for name, a, b in zip(NAMES[:2], LOW, HIGH)
    )
    for name, files, parameters in (("study", fitted, lines), ("judged", judged, lines), ("map", fitted[::5], grid)):
        files = "".join(f'        "{file}",\n' for file in files)
        (out / f"{name}.ron").write_text(f"""Study(
    simulator: MujocoModel(model: "cube.xml", python: "{sys.executable}"),
    recordings: [
{files}    ],
    start: FromRecording,
    parameters: [
{parameters}    ],
    metric: "pose",
    score: Single,
)
""")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder", type=pathlib.Path)
    words.add_argument("--every", type=int, default=4, help="every N-th of the even-numbered tosses is fitted")
    words.add_argument("--runs", type=int, default=200, help="points that the fit may ask")
    words.add_argument("--study", type=pathlib.Path, metavar="OUT", help="write studies of realgap, and fit nothing")
    given = words.parse_args()
    files = sorted(given.folder.resolve().glob("toss_*.csv"))
    fitted, judged = files[::2][:: given.every], files[1::2]
    if given.study:
        return write_studies(given.study, fitted, judged)
    cube = Cube()
    fitted, judged = [read(file) for file in fitted], [read(file) for file in judged]

    def said(values, tosses):
        place, angle = cube.score(values, tosses)
        return f"{100 * place:.2f} % and {np.degrees(angle):.2f} deg"

    print(f"own values: {said(OWN, fitted)} on {len(fitted)} fitted tosses")
    began, scale = time.process_time(), HIGH - LOW
    cube.runs = 0

    def score(shares):
        values = LOW + scale * shares
        return float(sum(cube.score(values, fitted)))

    start = (OWN - LOW) / scale
    simplex = np.vstack([start, *(start + 0.3 * np.eye(6)[k] * (1 if start[k] < 0.5 else -1) for k in range(6))])
    options = {"maxfev": given.runs, "initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-5}
    best = minimize(score, start, method="Nelder-Mead", bounds=[(0, 1)] * 6, options=options)
    values = LOW + scale * best.x
    cpu = time.process_time() - began
    print(f"{best.nfev} points, {cube.runs} runs, {cpu:.0f} CPU s: {said(values, fitted)} on the fitted tosses")
    print(", ".join(f"{name} = {value:.5g}" for name, value in zip(NAMES, values)))
    print(f"held out: {said(values, judged)} on {len(judged)} tosses")


if __name__ == "__main__":
    main()
