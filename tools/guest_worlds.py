"""Intervals by least squares with a simulator of one's own: do they hold the truth?

Three hidden worlds: a pendulum with viscous and dry friction; a mass on a spring with viscous and dry friction; and a block that is
launched and slides with friction and drag. Each is recorded with a short timestep and fitted with a longer one, once with the longer
one alone and once with its half and its quarter among the simulator's settings (docs/simulator.md):

    python3 tools/guest_worlds.py target/release/realgap --worlds 30
    python3 tools/guest_worlds.py target/release/realgap --worlds 30 --settings
    python3 tools/guest_worlds.py target/release/realgap --world spring --worlds 100 --settings --jobs 2
"""

import argparse
import concurrent.futures
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path


def swing(values, start, end_s, dt_s):
    """Times and angles of a pendulum that is let go."""
    angle_rad = start["pivot_rad"]
    speed, times, angles = 0.0, [0.0], [angle_rad]
    for step in range(math.ceil(end_s / dt_s - 1e-9)):
        speed += dt_s * (-9.81 / values["length"] * math.sin(angle_rad) - values["damping"] * speed)
        dry = dt_s * values["dry"]
        speed = math.copysign(max(abs(speed) - dry, 0.0), speed)
        angle_rad += dt_s * speed
        times.append((step + 1) * dt_s)
        angles.append(angle_rad)
    return times, {"pivot_rad": angles}


def oscillate(values, start, end_s, dt_s):
    """Times and places of a mass of 1 kg on a spring that is let go; it slips and sticks on a dry floor."""
    place_m = start["slide_rad"]
    speed, times, places = 0.0, [0.0], [place_m]
    for step in range(math.ceil(end_s / dt_s - 1e-9)):
        speed += dt_s * (-values["stiffness"] * place_m - values["damping"] * speed)
        dry = dt_s * values["dry"]
        speed = math.copysign(max(abs(speed) - dry, 0.0), speed)
        place_m += dt_s * speed
        times.append((step + 1) * dt_s)
        places.append(place_m)
    return times, {"slide_rad": places}


def slide(values, start, end_s, dt_s):
    """Times and places of a block that is launched along x and slides until friction has stopped it."""
    place_m = start["slide_rad"]
    speed, times, places = values["launch"], [0.0], [place_m]
    for step in range(math.ceil(end_s / dt_s - 1e-9)):
        speed -= dt_s * values["drag"] * speed
        speed = max(speed - dt_s * 9.81 * values["friction"], 0.0)
        place_m += dt_s * speed
        times.append((step + 1) * dt_s)
        places.append(place_m)
    return times, {"slide_rad": places}


# Of each world: its motion; its column (a slide is a joint whose radians are metres), the noise of it and the range of its first
# value; the metric; of each parameter the declared range with its default and unit, the range of the study, and that of truths.
WORLDS = {
    "pendulum": (swing, "pivot_rad", 0.002, (0.4, 1.0), "joints", {
        "length": ((0.1, 2.0, 0.5, "m"), (0.2, 1.0), (0.3, 0.8)),
        "damping": ((0.0, 2.0, 0.2, "1/s"), (0.0, 1.0), (0.05, 0.5)),
        "dry": ((0.0, 2.0, 0.2, "1/s2"), (0.0, 1.0), (0.05, 0.5)),
    }),
    "spring": (oscillate, "slide_rad", 0.0005, (0.1, 0.3), "joints", {
        "stiffness": ((1.0, 200.0, 30.0, "N/m"), (10.0, 80.0), (20.0, 60.0)),
        "damping": ((0.0, 5.0, 0.3, "N s/m"), (0.0, 2.0), (0.1, 1.0)),
        "dry": ((0.0, 5.0, 0.2, "N"), (0.0, 1.0), (0.05, 0.5)),
    }),
    "block": (slide, "slide_rad", 0.001, (0.0, 0.0), "joints", {
        "launch": ((0.1, 10.0, 2.0, "m/s"), (0.5, 4.0), (1.0, 3.0)),
        "friction": ((0.0, 2.0, 0.2, ""), (0.0, 0.6), (0.05, 0.4)),
        "drag": ((0.0, 5.0, 0.2, "1/s"), (0.0, 2.0), (0.1, 1.0)),
    }),
}
STUDY = """(
    simulator: Command([%s]),
    recordings: ["run_*.csv"], start: FromRecording, metric: "%s",
    parameters: [%s],
)"""


def serve(name, dt_s, with_settings):
    """Answers questions of the protocol; no package is needed."""
    move, _, _, _, _, ranges = WORLDS[name]
    names = ("from", "to", "default", "unit")
    parameters = [{"name": own, **dict(zip(names, declared))} for own, (declared, _, _) in ranges.items()]
    shares = (1.0, 0.5, 0.25) if with_settings else (1.0,)
    settings = [{"dt": dt_s * share} for share in shares]
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["ask"] == "hello":
            answer = {"realgap": 1, "name": name, "parameters": parameters, "settings": settings}
        else:
            times, channels = move(asked["parameters"], asked["start"], asked["times_s"][-1], asked["setting"]["dt"])
            answer = {"id": asked["id"], "times_s": times, "channels": channels}
        print(json.dumps(answer), flush=True)


def world(program, name, seed, true_dt_s, dt_s, with_settings, budget):
    """Of each parameter whether its interval holds the truth, and the lines that say so where it does not, with what the answer says
    of itself."""
    draw = random.Random(seed)
    move, column, noise, first, metric, ranges = WORLDS[name]
    truth = {own: draw.uniform(*true_range) for own, (_, _, true_range) in ranges.items()}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for index in range(2):
            _, channels = move(truth, {column: draw.uniform(*first)}, 149 * 0.02, true_dt_s)
            values = channels[column]
            seen = [values[round(0.02 * k / true_dt_s)] + draw.gauss(0, noise) for k in range(150)]
            rows = [f"{0.02 * k:.3f},{value:.9g}" for k, value in enumerate(seen)]
            (folder / f"run_{index}.csv").write_text(f"t_s,{column}\n" + "\n".join(rows) + "\n")
        words = [sys.executable, str(Path(__file__).resolve()), "--world", name, "--serve", str(dt_s)] + ["--settings"] * with_settings
        varied = ", ".join(f'(name: "{own}", from: {low}, to: {high})' for own, (_, (low, high), _) in ranges.items())
        (folder / "study.ron").write_text(STUDY % (", ".join(json.dumps(word) for word in words), metric, varied))
        command = [program, "tune", "study.ron", "--optimizer", "gauss-newton", "--allow-command"]
        command += ["--budget", str(budget)] if budget else []
        command += ["--no-report", "--format", "json", "--jobs", "1", "-o", "out"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"world {seed}: {done.stderr}")
        answer = json.loads(done.stdout)
    held, said = {}, []
    for verdict in answer["verdicts"]:
        own = verdict["parameter"].removeprefix("sim.")
        parts = [verdict["interval"]] if verdict["interval"] else verdict.get("intervals", [])
        held[own] = any(low <= truth[own] <= high for low, high in parts)
        if not held[own]:
            width = sum(high - low for low, high in parts)
            outside = min(max(low - truth[own], truth[own] - high) for low, high in parts)
            is_told = "determined" if verdict["identified"] else "not determined"
            said.append(f"  world {seed}: {own} is {truth[own]:.5f}, interval {parts}, {outside / width:.1f} widths outside, {is_told}")
    if said:
        words = [claim["word"] for claim in answer["claims"] if claim["about"] == "trust"]
        words += [warning["code"] for warning in answer["warnings"]]
        said.append(f"  world {seed} says: {', '.join(words)}")
    return held, said


def wilson(count, total, z=1.96):
    """The 95 % interval of a share."""
    share, square = count / total, z * z / total
    middle, half = share + square / 2, z * math.sqrt(share * (1 - share) / total + square / (4 * total))
    return (middle - half) / (1 + square), (middle + half) / (1 + square)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", help="the program realgap")
    parser.add_argument("--world", choices=list(WORLDS), default="pendulum")
    parser.add_argument("--first", type=int, default=0, help="seed of the first world")
    parser.add_argument("--jobs", type=int, default=1, help="worlds at once")
    parser.add_argument("--worlds", type=int, default=30)
    parser.add_argument("--true-dt", type=float, default=1e-4, help="timestep of the recordings, seconds")
    parser.add_argument("--dt", type=float, default=1e-3, help="timestep of the simulator, seconds")
    parser.add_argument("--budget", type=int, help="runs of a fit (default: that of the program)")
    parser.add_argument("--settings", action="store_true", help="the simulator declares half and quarter of its timestep")
    parser.add_argument("--serve", type=float, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        return serve(given.world, given.serve, given.settings)
    program = str(Path(given.program).resolve())
    seeds = range(given.first, given.first + given.worlds)
    all_held = []
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        ask = lambda seed: world(program, given.world, seed, given.true_dt, given.dt, given.settings, given.budget)  # noqa: E731
        for seed, (held, said) in zip(seeds, pool.map(ask, seeds)):
            all_held.append(held)
            print(f"world {seed}: {sum(held.values())} of {len(held)} hold", file=sys.stderr, flush=True)
            print("".join(line + "\n" for line in said), end="", flush=True)
    names = list(WORLDS[given.world][5])
    for name in names:
        print(f"{name}: {sum(held[name] for held in all_held)} of {given.worlds}")
    count, total = sum(held[name] for held in all_held for name in names), given.worlds * len(names)
    low, high = wilson(count, total)
    print(f"all: {count} of {total}, {100 * count / total:.1f} % ({100 * low:.1f} to {100 * high:.1f} %)")


if __name__ == "__main__":
    main()
