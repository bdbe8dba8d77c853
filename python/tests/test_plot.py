"""Pictures on axes of matplotlib, and the tables that they draw."""

import builtins

import numpy as np
import pytest

import realgap
from conftest import PROJECT

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture(scope="module")
def answer():
    robot = realgap.Robot.read(PROJECT / "morphologies" / "tripod.ron")
    folder = PROJECT / "real_trajectories" / "tripod_standin"
    runs = [realgap.Trajectory.read(folder / f"run_0{k}.csv") for k in range(2)]
    vary = {"floor.friction": (0.2, 0.8, 4), "floor.restitution": (0.0, 0.5, 3)}
    noise = {"start_heading_rad": {"Normal": 0.02}}
    return realgap.Study.of(robot, runs, vary, metric="rms", duration_s=0.5, noise=noise).sweep()


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


def test_a_map_shows_the_expected_score_of_every_cell_and_the_best_point(answer):
    _, axes = pyplot.subplots(1, 2)
    assert answer.plot(ax=axes[0]) is axes[0]
    assert (axes[0].get_xlabel(), axes[0].get_ylabel()) == ("floor.friction", "floor.restitution")
    mesh = axes[0].collections[0]
    low, high = 0.2, 0.8
    row = answer.expected([[x, answer.best["floor.restitution"]] for x in (low, high)])
    shown = np.ma.compressed(mesh.get_array())
    expected = row.numbers("score")
    assert len(shown) > 100 and np.isfinite(expected).all()
    factor = 1e3 if "mm" in axes[0].figure.axes[-1].get_ylabel() else 1.0
    assert shown.min() <= factor * expected.min() and shown.max() >= factor * expected.max() * 0.999
    star = next(line for line in axes[0].lines if line.get_marker() == "*")
    assert star.get_xydata().tolist() == [list(answer.best.values())]
    turned = answer.plot("map", parameters=["floor.restitution", "floor.friction"], ax=axes[1])
    assert turned.get_xlabel() == "floor.restitution"


def test_profiles_are_the_curves_of_the_answer(answer):
    for profile in answer.profiles:
        assert (profile.low <= profile.lowest_score).all() and (profile.lowest_score <= profile.high).all()
        axes = answer.plot("profiles", parameters=profile.parameter)
        x, y = axes.lines[0].get_data()
        assert np.array_equal(x, profile.values)
        assert np.allclose(y / profile.lowest_score, y[0] / profile.lowest_score[0])


def test_the_posterior_is_a_frame_with_a_column_a_parameter(answer):
    frame = answer.posterior.to_pandas()
    assert list(frame.columns) == list(answer.best) and len(frame) >= 100
    assert frame["floor.friction"].between(0.2, 0.8).all() and frame["floor.friction"].nunique() > 50


def test_the_gap_over_time_is_that_of_the_summary(answer):
    gap = answer.fitted.gap(repeats=5, progress=False)
    axes = gap.plot()
    assert axes.get_xlabel() == "time, s"
    labels = [line.get_label() for line in axes.lines]
    assert "mean of the other recordings" in labels
    over = gap.summary.over_time
    y = axes.lines[labels.index("mean of the other recordings")].get_ydata()
    assert len(y) == len(over.times_s) and np.allclose(y / np.max(y), np.array(over.real_mean_m) / max(over.real_mean_m))
    share = gap.plot("confidence").lines[0].get_ydata()
    assert share.tolist() == [one.share for one in gap.summary.confidence.inside]


def test_joints_are_drawn_beside_the_best_point():
    study = realgap.Study.read(PROJECT / "sweeps" / "so101_fit.ron", limit_recordings=1, duration_s=0.5)
    found = study.tune(optimizer="gauss-newton", budget=2 * (len(study.parameters) + 2), audit=False)
    table = found.joints
    assert set(table["unit"]) == {"rad"} and table.rows > 10
    joint = table["joint"][-1]
    axes = found.plot("joints", joint=joint)
    times_s = axes.lines[0].get_xdata()
    assert len(times_s) == sum(name == joint for name in table["joint"]) and joint in axes.get_title()
    with pytest.raises(realgap.UsageError, match="no such joint"):
        found.plot("joints", joint="tail")


@pytest.mark.parametrize(
    "what, options, words",
    [
        ("joints", {}, "no joints"),
        ("profile", {}, "no such picture"),
        ("map", {"parameters": ["floor.friction"]}, "two parameters"),
        ("map", {"parameters": ["floor.friction", "mass"]}, "not a parameter that varies"),
        ("profiles", {"parameters": ["floor.friction", "floor.restitution"]}, "one parameter"),
        ("map", {"joint": "knee"}, "only joints over time"),
        ("map", {"ax": 3}, "not axes"),
    ],
)
def test_a_wrong_wish_is_refused(answer, what, options, words):
    with pytest.raises(realgap.UsageError, match=words):
        answer.plot(what, **options)


def test_without_matplotlib_the_error_says_what_to_install(answer, monkeypatch):
    imported = builtins.__import__

    def refused(name, *rest, **options):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return imported(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", refused)
    with pytest.raises(realgap.UsageError, match="(?s)matplotlib is not installed.*pip install matplotlib"):
        answer.plot("profiles", parameters=["floor.friction"])
