#!/usr/bin/env python3
"""Runs the finalists of `realgap search` in MuJoCo with the same random draws, to test whether they walk in another engine, too.

    realgap search sweeps/best_robot.ron -o results/best_robot
    python3 -m pip install -r tools/requirements.txt
    python3 tools/rerun_finalists.py results/best_robot

`realgap search --mujoco` does this at the end of a search and uses the result to decide which robots survive.

RESULTS/best/NAME.draws.json contains the random draws of every repeat of a finalist: start, servos, masses, frictions. The first `--draws` of them run in
MuJoCo with contacts so hard and steps so short that neither affects the result (1/16000 s, solref 0.0005; at 1/1000 s these robots move half as far in
MuJoCo). The two distributions are compared by medians, rank correlation over draws, and the largest distance of the distribution functions. A robot agrees
if the medians are within `--tolerance`. If the card of a robot states that only distributions can be compared (a small difference grows by `growth` per
second), the rank correlation is left out, because no two engines agree on single draws. RESULTS/best/mujoco.json contains the same numbers as the table.
"""

import argparse
import json
import math
import pathlib
import tempfile

import mujoco
import numpy as np

from standin import Robot

TIMESTEP_S = 1 / 16000
SOLREF_S = 0.0005
# Interval at which commands change; it is negligible for a servo of gain 30/s.
COMMAND_S = 1 / 2000


class Drawn(Robot):
    """The robot with the parameters of one draw."""

    def __init__(self, draw, folder):
        path = pathlib.Path(folder) / "draw.xml"
        path.write_text(draw["mjcf"])
        super().__init__(path)
        m = self.model
        m.opt.timestep = TIMESTEP_S
        m.geom_solref[:, 0] = SOLREF_S
        # The pair's value is the larger of two equal priorities: the box's own.
        m.geom_priority[self.floor] = 0
        m.geom_friction[self.floor, 0] = 0.0
        for name, friction in draw["friction"].items():
            geom = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_GEOM, name)
            if geom >= 0:
                m.geom_friction[geom, 0] = friction
        self.latency_s = np.array([draw["servo_latency_s"].get(name, 0.0) for name in self.joints])
        self.draw = draw

    def delayed_command_rad(self, t_s):
        turn = 2 * math.pi * self.frequency_hz * np.maximum(t_s - self.latency_s, 0.0) + self.phase_rad
        return self.offset_rad + self.amplitude_rad * np.sin(turn)

    def displacement_m(self, duration_s):
        data = self.place(self.draw["shift_world_m"], self.draw["turn_world_rad"])
        held = self.command_rad(0.0)
        inner = round(COMMAND_S / TIMESTEP_S)
        moving = (data.xpos.copy(), data.xquat.copy())
        for k in range(round(3.0 / COMMAND_S)):
            self.drive(data, held)
            mujoco.mj_step(self.model, data, inner)
            if (k + 1) % 200 == 0:
                moved = np.linalg.norm(data.xpos - moving[0], axis=1).max()
                cosine = np.abs((data.xquat * moving[1]).sum(axis=1)).clip(max=1.0)
                if moved < 2e-4 and (2 * np.arccos(cosine)).max() < 4e-3:
                    break
                moving = (data.xpos.copy(), data.xquat.copy())
        first = self.pose(data)[0]
        for k in range(round(duration_s / COMMAND_S)):
            self.drive(data, self.delayed_command_rad((k + 0.5) * COMMAND_S))
            mujoco.mj_step(self.model, data, inner)
        moved = self.pose(data)[0] - first
        return math.hypot(moved[0], moved[1])


def ranks(values):
    order = np.argsort(values)
    rank = np.empty(len(values))
    rank[order] = np.arange(len(values))
    return rank


def compare(here, there):
    """Medians, Spearman's correlation, largest distance of the two distribution functions."""
    here, there = np.array(here), np.array(there)
    at = np.sort(np.concatenate([here, there]))
    distance = np.abs(np.searchsorted(np.sort(here), at, "right") / len(here) - np.searchsorted(np.sort(there), at, "right") / len(there)).max()
    correlation = float(np.corrcoef(ranks(here), ranks(there))[0, 1]) if len(here) > 2 else math.nan
    return float(np.median(here)), float(np.median(there)), correlation, float(distance)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path, help="folder of a search")
    parser.add_argument("--draws", type=int, default=8, help="repeats of every robot [default: 8]")
    parser.add_argument("--tolerance", type=float, default=0.15, help="largest difference of the medians, as a share [default: 0.15]")
    parser.add_argument("--output", type=pathlib.Path, help="where the table goes as JSON [default: RESULTS/best/mujoco.json]")
    options = parser.parse_args()
    summary = json.loads((options.results / "summary.json").read_text())
    best = options.results / "best"
    print(f"MuJoCo {mujoco.__version__}, 1/{1 / TIMESTEP_S:.0f} s, solref {SOLREF_S}, {summary['duration_s']} s, {options.draws} draws")
    print(f"{'robot':<20} {'realgap':>9} {'MuJoCo':>9} {'ratio':>6} {'growth/s':>8} {'rank r':>7} {'KS':>5}  agrees")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for robot in summary["best"]:
            draws = json.loads((best / f"{robot['file']}.draws.json").read_text())
            card = json.loads((best / f"{robot['file']}.json").read_text())
            growth = math.exp(card["growth"]["rate_1_s"]) if card["growth"] else None
            is_chaotic = any(warning["code"] == "only-distributions" for warning in card["warnings"])
            pairs = []
            for draw in [d for d in draws if d["displacement_m"] is not None][: options.draws]:
                pairs.append((draw["displacement_m"], Drawn(draw, folder).displacement_m(summary["duration_s"])))
            here, there = (list(column) for column in zip(*pairs))
            here_m, there_m, correlation, distance = compare(here, there)
            if is_chaotic:
                correlation = None
            agrees = abs(there_m / here_m - 1) <= options.tolerance
            rows.append({"robot": robot["file"], "modules": robot["modules"], "realgap_median_m": here_m, "mujoco_median_m": there_m, "growth_per_s": growth, "only_distributions": is_chaotic, "rank_correlation": correlation,
                         "ks_distance": distance, "agrees": bool(agrees), "realgap_m": here, "mujoco_m": there})
            print(f"{robot['file']:<20} {here_m:>7.3f} m {there_m:>7.3f} m {there_m / here_m:>6.2f} {growth or math.nan:>8.2f} {'-' if correlation is None else f'{correlation:.2f}':>7} {distance:>5.2f}  {'yes' if agrees else 'NO'}", flush=True)
    text = json.dumps({"mujoco": mujoco.__version__, "numpy": np.__version__, "timestep_s": TIMESTEP_S, "solref_s": SOLREF_S, "tolerance": options.tolerance, "robots": rows}, indent=2)
    (options.output or best / "mujoco.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
