"""Callbacks of users: metrics, optimizers, gaits, objectives, progress; and their errors."""

import math

import numpy as np
import pytest

import realgap
from conftest import PROJECT


def rms(real, simulated):
    return float(np.sqrt(((real - simulated) ** 2).sum(axis=1).mean()))


VARY = {"floor.friction": (0.2, 0.8, 3)}


def study_of(tripod, recordings, metric):
    return realgap.Study.of(tripod, recordings, VARY, metric=metric, duration_s=0.5)


def test_a_metric_in_python_is_as_good_as_one_in_rust(tripod, recordings):
    own = realgap.Metric("own-rms", rms)
    ours = realgap.compare(recordings[0], recordings[1], metric=own)
    theirs = realgap.compare(recordings[0], recordings[1], metric="rms")
    assert float(ours) == pytest.approx(float(theirs), rel=1e-12)
    assert "own_rms_m" in ours.table
    answer = study_of(tripod, recordings, own).sweep(jobs=2)
    expected = study_of(tripod, recordings, "rms").sweep(jobs=1)
    assert answer.points["score"] == pytest.approx(expected.points["score"], rel=1e-12)
    assert answer.report["metric"] == "own-rms"
    assert answer.report == study_of(tripod, recordings, own).sweep(jobs=1).report


def test_a_metric_may_see_whole_trajectories(recordings):
    def later(real, simulated):
        return abs(real.duration_s - simulated.duration_s)

    own = realgap.Metric("later", later, unit="s", whole=True)
    assert float(realgap.compare(recordings[0], recordings[1], metric=own)) == 0.0


@pytest.mark.parametrize(
    "distance, words",
    [
        (lambda a, b: "far", "must give a number, not str 'far'"),
        (lambda a, b: None, "must give a number, not NoneType"),
        (lambda a, b: math.nan, "finite number"),
        (lambda a, b: -1.0, "must not be negative"),
        (lambda a, b: 1 / 0, "raised ZeroDivisionError"),
        (lambda a, b: True, "must give a number, not bool"),
    ],
)
def test_a_metric_that_fails_is_named_with_its_exception(tripod, recordings, distance, words):
    own = realgap.Metric("bad", distance)
    with pytest.raises(realgap.CallbackError, match=f"(?s)the metric `bad`.*{words}") as caught:
        realgap.compare(recordings[0], recordings[1], metric=own)
    assert isinstance(caught.value.__cause__, (TypeError, ValueError, ZeroDivisionError))
    with pytest.raises(realgap.CallbackError, match=words):
        study_of(tripod, recordings, own)


def test_a_metric_that_fails_in_the_middle_of_a_sweep_ends_it(tripod, recordings):
    calls = []

    def fickle(real, simulated):
        calls.append(1)
        if len(calls) > 6:
            raise RuntimeError("enough")
        return rms(real, simulated)

    study = study_of(tripod, recordings, realgap.Metric("fickle", fickle))
    with pytest.raises(realgap.CallbackError, match="RuntimeError: enough") as caught:
        study.sweep(jobs=2)
    assert isinstance(caught.value.__cause__, RuntimeError)


def test_names_that_are_taken_are_refused():
    with pytest.raises(realgap.UsageError, match="already"):
        realgap.Metric("rms", rms)
    with pytest.raises(realgap.UsageError, match="furlong"):
        realgap.Metric("own", rms, unit="furlong")


class Halving:
    """Proposes points on both sides of the best one, with a step that is halved each time."""

    def __init__(self, dimensions, budget, seed):
        self.best, self.step, self.told = (None, math.inf), 0.25, []

    def ask(self):
        centre = self.best[0] or [0.5]
        sides = [[min(1.0, max(0.0, centre[0] + side))] for side in (-self.step, self.step)]
        self.step /= 2
        return sides

    def tell(self, points, scores):
        self.told += list(points)
        for point, score in zip(points, scores):
            if score is not None and score < self.best[1]:
                self.best = (point, score)


def test_an_optimizer_in_python_chooses_the_points(tripod, recordings, tmp_path):
    own = realgap.Optimizer("halving", Halving, batch=2, design=3)
    study = study_of(tripod, recordings, "rms")
    answer = study.tune(optimizer=own, budget=9)
    assert answer.report["tuning"]["optimizer"] == "halving"
    assert answer.report["points"] == 9
    # The bits are the same in a folder, and when a finished tuning is resumed.
    stored = study.tune(optimizer=own, budget=9, folder=tmp_path / "t", jobs=1)
    assert stored.report == answer.report
    again = study.tune(optimizer=own, budget=9, folder=tmp_path / "t", resume=True)
    assert again.report == answer.report


def test_an_optimizer_that_proposes_other_points_on_resuming_is_refused(tripod, recordings, tmp_path):
    rng = np.random.default_rng(1)

    class Dice(Halving):
        def ask(self):
            return [[float(rng.random())], [float(rng.random())]]

    own = realgap.Optimizer("dice", Dice, batch=2, design=2)
    study = study_of(tripod, recordings, "rms")
    study.tune(optimizer=own, budget=6, folder=tmp_path / "t")
    with pytest.raises(realgap.ConflictError, match="not those that the optimizer asks for"):
        study.tune(optimizer=own, budget=6, folder=tmp_path / "t", resume=True)


@pytest.mark.parametrize(
    "asked, words",
    [
        ([[2.0]], "outside"),
        ([[0.1, 0.2]], "outside"),
        ([[math.nan]], "outside"),
        ("text", "could not convert string"),
        (3, "TypeError"),
    ],
)
def test_an_optimizer_that_proposes_invalid_points_is_refused(tripod, recordings, asked, words):
    class Odd(Halving):
        def ask(self):
            return asked

    own = realgap.Optimizer("odd", Odd, batch=2, design=2)
    with pytest.raises(realgap.Error, match=words):
        study_of(tripod, recordings, "rms").tune(optimizer=own, budget=6)


def test_optuna_chooses_the_points(tripod, recordings):
    optuna = pytest.importorskip("optuna")
    optuna.logging.set_verbosity(optuna.logging.WARNING)

    class Tpe:
        def __init__(self, dimensions, budget, seed):
            sampler = optuna.samplers.TPESampler(seed=seed)
            self.study = optuna.create_study(sampler=sampler)
            space = optuna.distributions.FloatDistribution(0.0, 1.0)
            self.space = {str(k): space for k in range(dimensions)}
            self.open = {}

        def ask(self):
            trial = self.study.ask(self.space)
            point = [trial.params[name] for name in self.space]
            self.open[tuple(point)] = trial
            return [point]

        def tell(self, points, scores):
            for point, score in zip(points, scores):
                trial = self.open.pop(tuple(point), None)
                if trial is not None:
                    state = optuna.trial.TrialState.FAIL if score is None else None
                    self.study.tell(trial, score, state=state)
                elif score is not None:
                    params = dict(zip(self.space, point))
                    self.study.add_trial(
                        optuna.trial.create_trial(
                            params=params, distributions=self.space, value=score
                        )
                    )

    own = realgap.Optimizer("optuna-tpe", Tpe, design=4)
    study = study_of(tripod, recordings, "rms")
    answer = study.tune(optimizer=own, budget=8)
    assert answer.report["points"] == 8
    assert answer.report == study.tune(optimizer=own, budget=8, jobs=1).report


def test_a_gait_in_python_moves_the_servos(tripod):
    file = realgap.simulate(tripod, duration_s=0.5)
    still = realgap.simulate(tripod, duration_s=0.5, gait=lambda t: {h: 0.0 for h in tripod.hinges})
    assert file.net_displacement_m != still.net_displacement_m
    assert abs(still.joint_angles_rad).max() < 0.02
    bent = realgap.simulate(
        tripod, duration_s=1.0, gait=lambda t: {tripod.hinges[0]: 0.3 * math.sin(2 * t)}
    )
    assert abs(bent.joint_angles_rad[-1, 0] - 0.3 * math.sin(2.0)) < 0.1


@pytest.mark.parametrize(
    "gait, words",
    [
        (lambda t: {"knee": 0.0}, "no servo of this name"),
        (lambda t: 0.3, "must give a dict"),
        (lambda t: {"leg": "up"}, "must give a number, not str"),
        (lambda t: {"leg": math.nan}, "finite"),
        (lambda t: 1 / 0, "ZeroDivisionError"),
        (lambda t: {"a": 0.0} if t < 0.1 else {"b": 0.0}, "other hinges than at the start"),
    ],
)
def test_a_gait_that_fails_is_refused(tripod, gait, words):
    with pytest.raises(realgap.Error, match=words):
        realgap.simulate(tripod, duration_s=0.5, gait=gait)


SEARCH = {
    "strategy": {"Evolution": {"population": 4, "generations": 2}},
    "duration_s": 0.5,
    "repeats": 2,
    "finalists": {"count": 1, "repeats": 3},
}


def test_a_search_with_an_own_objective(tmp_path):
    search = realgap.Search.from_dict(SEARCH)
    seen = []

    def turning(repeats):
        seen.append(repeats)
        return sum(abs(repeat.turned_rad) for repeat in repeats) / len(repeats)

    found = search.run(objective=turning, jobs=2)
    fitness = [value for value in found.robots["fitness"] if value is not None]
    assert fitness and max(fitness) in [turning(repeats) for repeats in list(seen)]
    assert found.finalists == []
    assert found.best is not None
    for bad, words in ((lambda r: "good", "not str"), (lambda r: math.inf, "finite")):
        with pytest.raises(realgap.CallbackError, match=words):
            search.run(objective=bad)
    with pytest.raises(realgap.UsageError, match="kept in memory"):
        search.run(objective=turning, folder=tmp_path)


def test_a_search_finds_what_the_command_finds(command, tmp_path):
    text = """Search(strategy: Evolution(population: 4, generations: 2), duration_s: 0.5, repeats: 2,
        finalists: (count: 1, repeats: 3))"""
    (tmp_path / "quick.ron").write_text(text)
    command("search", tmp_path / "quick.ron", "-o", tmp_path / "c")
    search = realgap.Search.read(tmp_path / "quick.ron")
    found = search.run(folder=tmp_path / "p")
    for name in ("history.csv", "summary.json", "gallery.png"):
        assert (tmp_path / "p" / name).read_bytes() == (tmp_path / "c" / name).read_bytes(), name
    assert [f.robot.name for f in search.run(jobs=1).finalists] == [
        f.robot.name for f in found.finalists
    ]


def test_the_progress_is_reported_and_changes_no_result(tripod, recordings):
    said = []
    study = study_of(tripod, recordings, "rms")
    answer = study.sweep(progress=lambda *words: said.append(words))
    assert said and all(len(words) == 4 and words[0] <= words[1] for words in said)
    assert answer.report == study.sweep().report


def test_a_progress_that_raises_stops_the_run(tripod, recordings):
    def full(done, total, best, finishing):
        raise OSError("the screen is full")

    with pytest.raises(realgap.CallbackError, match="(?s)progress callback.*screen is full") as caught:
        study_of(tripod, recordings, "rms").sweep(progress=full)
    assert isinstance(caught.value.__cause__, OSError)


def test_every_example_file_of_a_search_is_read():
    found = realgap.Search.read(PROJECT / "sweeps" / "best_robot.ron")
    assert found.info["robots"] > 0
