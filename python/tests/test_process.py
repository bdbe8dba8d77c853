"""Ctrl-C, threads and forks: no results are lost, no call hangs, and the bits are the same."""

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import realgap
from conftest import study_text


def python(text, *words, **options):
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(text), *map(str, words)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options,
    )  # fmt: skip


SWEEP = """
    import sys, realgap
    def say(done, total, best, finishing):
        print(done, flush=True)
    study = realgap.Study.read(sys.argv[1])
    try:
        study.sweep(folder=sys.argv[2], progress=say, jobs=1)
        print("whole")
    except realgap.Interrupted as error:
        assert isinstance(error, KeyboardInterrupt)
        print("interrupted:", error)
"""


def test_ctrl_c_in_a_sweep_ends_it_soon_and_loses_nothing(tmp_path):
    path = tmp_path / "long.ron"
    path.write_text(study_text(duration_s=2.0, points=60))
    child = python(SWEEP, path, tmp_path / "cut")
    while True:
        line = child.stdout.readline()
        assert line, child.stderr.read()
        if int(line) >= 2:
            break
    begun = time.monotonic()
    child.send_signal(signal.SIGINT)
    said, errors = child.communicate(timeout=60)
    assert time.monotonic() - begun < 20.0
    assert "interrupted: interrupted after" in said, (said, errors)
    assert "resume=True" in said and child.returncode == 0
    # The finished points are stored.
    assert (tmp_path / "cut" / "points.csv").exists()


def test_an_interrupted_sweep_goes_on_with_the_same_bits(tmp_path, study_file):
    study = realgap.Study.read(study_file, points=6)
    calls = []

    def once(done, total, best, finishing):
        calls.append(done)
        if done >= 3:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        study.sweep(folder=tmp_path / "cut", progress=once, jobs=1)
    assert max(calls) < 6 + 100
    resumed = study.sweep(folder=tmp_path / "cut", resume=True)
    whole = study.sweep(folder=tmp_path / "whole")
    assert resumed.report == whole.report
    for name in ("points.csv", "summary.json", "curve.png"):
        ours, theirs = (tmp_path / f / name for f in ("cut", "whole"))
        assert ours.read_bytes() == theirs.read_bytes(), name


def test_an_interrupted_search_goes_on_with_the_same_robots(tmp_path):
    search = realgap.Search.from_dict(
        {
            "strategy": {"Evolution": {"population": 4, "generations": 3}},
            "duration_s": 0.5,
            "repeats": 2,
            "finalists": {"count": 1, "repeats": 3},
        }
    )

    def once(done, total, best, finishing):
        if done >= 3:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(realgap.Interrupted, match="resume=True"):
        search.run(folder=tmp_path / "cut", progress=once, jobs=1)
    with pytest.raises(realgap.ConflictError, match="resume=True"):
        search.run(folder=tmp_path / "cut")
    resumed = search.run(folder=tmp_path / "cut", resume=True)
    whole = search.run()
    assert resumed.robots.to_dict() == whole.robots.to_dict()
    assert [f.card for f in resumed.finalists] == [f.card for f in whole.finalists]


def test_ctrl_c_reaches_everything_that_takes_long_within_a_second(tripod, study_file):
    study = realgap.Study.read(study_file, set={"floor.friction": 0.4})
    many = {"strategy": {"Evolution": {"population": 50, "generations": 50}}, "duration_s": 2.0}
    wide, search = realgap.Study.read(study_file, points=2000), realgap.Search.from_dict(many)
    for run in (
        lambda: wide.sweep(jobs=1),
        lambda: realgap.predict(tripod, duration_s=2.0, repeats=2000, jobs=1),
        lambda: study.ensemble(repeats=4000, jobs=1),
        lambda: study.gap(repeats=4000, jobs=1),
        lambda: search.run(jobs=1),
    ):
        pressed_cpu_s = []

        def press():
            pressed_cpu_s.append(time.process_time())
            signal.raise_signal(signal.SIGINT)

        timer = threading.Timer(0.5, press)
        timer.start()
        with pytest.raises(realgap.Interrupted, match="interrupted"):
            run()
        # Of the process, which has one thread that works: the machine may be busy with something else.
        ended_cpu_s = time.process_time()
        timer.join()
        assert ended_cpu_s - pressed_cpu_s[0] < 1.0


def test_ctrl_c_in_a_callback_is_not_treated_as_its_error(recordings):
    def pressed(real, simulated):
        signal.raise_signal(signal.SIGINT)
        time.sleep(1.0)
        return 0.0

    with pytest.raises(KeyboardInterrupt):
        realgap.compare(recordings[0], recordings[1], metric=realgap.Metric("pressed", pressed))


def test_ctrl_c_in_a_single_run_is_not_lost(tripod):
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(realgap.Interrupted):
        realgap.simulate(tripod, duration_s=120.0)
    timer.join()


def test_two_threads_get_the_results_of_one(tripod, study_file):
    study = realgap.Study.read(study_file)
    alone = study.sweep(jobs=1).report
    found, slow = [], []

    def work():
        found.append(study.sweep(jobs=2).report)
        found.append(realgap.simulate(tripod, duration_s=0.5).positions_m.tobytes())

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    # The interpreter runs other code meanwhile.
    while any(thread.is_alive() for thread in threads):
        begun = time.monotonic()
        sum(range(1000))
        slow.append(time.monotonic() - begun)
        time.sleep(0.01)
    assert len(slow) > 3
    reports = [report for report in found if isinstance(report, dict)]
    motions = [motion for motion in found if isinstance(motion, bytes)]
    assert reports == [alone, alone] and len(set(motions)) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_fork_does_no_harm(tripod, study_file):
    study = realgap.Study.read(study_file)
    before = study.sweep(jobs=2).report
    motion = realgap.simulate(tripod, duration_s=0.5).positions_m.tobytes()

    def child(queue):
        again = realgap.simulate(tripod, duration_s=0.5).positions_m.tobytes()
        fresh = realgap.Study.read(study_file).sweep(jobs=2).report
        queue.put((study.sweep(jobs=2).report == before == fresh, again == motion))

    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=child, args=(queue,))
    process.start()
    assert queue.get(timeout=120) == (True, True)
    process.join(timeout=30)
    assert process.exitcode == 0


def test_a_spawned_pool_works(tmp_path):
    script = tmp_path / "pool.py"
    script.write_text(
        textwrap.dedent(
            """
            import sys
            from multiprocessing import get_context

            import realgap

            def net(job):
                robot, friction = job
                values = {"floor.friction": friction}
                return realgap.simulate(robot, duration_s=0.3, parameters=values).net_displacement_m

            if __name__ == "__main__":
                robot = realgap.Robot.read(sys.argv[1])
                jobs = [(robot, 0.2), (robot, 0.5)]
                with get_context("spawn").Pool(2) as pool:
                    assert pool.map(net, jobs) == [net(job) for job in jobs]
                print("equal")
            """
        )
    )
    from conftest import TRIPOD

    done = subprocess.run(
        [sys.executable, str(script), str(TRIPOD)], capture_output=True, text=True, timeout=120
    )
    assert done.stdout.strip() == "equal", done.stderr


def test_the_command_of_the_wheel_is_the_command(tmp_path):
    run = "from realgap._command import main; raise SystemExit(main())"

    def said(*words):
        command = [sys.executable, "-c", run, *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    assert said("--version").stdout.split() == ["realgap", realgap.__version__]
    assert said("simulate", "nowhere.ron").returncode == 1
    assert said("no-such-command").returncode == 2
    out = tmp_path / "run.csv"
    robot = tmp_path / "cube.ron"
    robot.write_text('(name: "cube", modules: [(name: "cube", kind: Passive(side_m: 0.1, mass_kg: 0.1))])')
    done = said("simulate", robot, "--duration", "0.1", "-o", out)
    assert done.returncode == 0, done.stderr
    assert out.read_text().startswith("t_s,x_m")
