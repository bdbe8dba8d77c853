"""Results as dicts, frames and pictures, and their display in a notebook."""

import re

import numpy as np
import pytest

import realgap


@pytest.fixture(scope="module")
def answer(tripod, recordings):
    vary = {"floor.friction": (0.2, 0.8, 3), "floor.restitution": (0.0, 0.5, 2)}
    return realgap.Study.of(tripod, recordings, vary, metric="rms", duration_s=0.5).sweep()


@pytest.fixture(scope="module")
def recordings():
    from conftest import STAND_INS

    return [realgap.Trajectory.read(STAND_INS / f"run_0{k}.csv") for k in range(2)]


def test_points_become_frames_with_the_same_numbers(answer):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    points = answer.points
    assert set(points) >= {"floor.friction", "floor.restitution", "score", "indistinguishable"}
    frame = answer.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == points.rows >= 6
    assert frame["score"].tolist() == points["score"]
    other = answer.to_polars()
    assert isinstance(other, polars.DataFrame)
    assert other["score"].to_list() == points["score"]
    # The grid first, then what lies between its points.
    assert sorted(set(frame["floor.friction"][:6])) == [0.2, 0.5, 0.8]
    assert 0.2 <= frame.loc[frame["score"].idxmin(), "floor.friction"] <= 0.8


def test_an_answer_says_what_is_best_and_how_sure(answer):
    assert set(answer.best) == {"floor.friction", "floor.restitution"}
    assert answer.unit == "m" and answer.score > 0.0
    assert [verdict.parameter for verdict in answer.verdicts] == list(answer.best)
    assert "best:" in str(answer)


def images(shown):
    return re.findall(r'src="data:image/png;base64,iVBORw0', shown)


def test_a_notebook_shows_pictures(answer, tripod, recordings):
    run = realgap.simulate(tripod, duration_s=0.5)
    prediction = realgap.predict(tripod, duration_s=0.5, repeats=5, model_error=False)
    comparison = realgap.compare(recordings[0], [recordings[1], run])
    for shown, count in (
        (tripod, 1),
        (recordings[0], 1),
        (run, 1),
        (comparison, 1),
        (prediction, 1),
        (answer, 2),
    ):
        page = shown._repr_html_()
        assert len(images(page)) == count, repr(shown)
        assert "<script" not in page
    assert "<table>" in answer.points._repr_html_()


def test_names_in_a_page_are_harmless(recordings):
    evil = realgap.Trajectory(recordings[0].times_s, recordings[0].positions_m, name="<script>")
    assert "<script>" not in evil._repr_html_()
    assert "<script>" not in realgap.compare(recordings[0], evil)._repr_html_()


def test_stand_ins_are_marked(tripod, recordings):
    run = realgap.simulate(tripod, duration_s=0.5)
    assert run.is_stand_in and recordings[0].is_stand_in
    made = realgap.Trajectory(run.times_s, run.positions_m)
    assert not made.is_stand_in
    said = realgap.Trajectory(run.times_s, run.positions_m, stand_in_of="tripod")
    assert said.is_stand_in


def test_a_prepared_path_begins_at_the_origin_and_runs_along_x(recordings):
    prepared = realgap.prepare(recordings[0])
    assert prepared.xy_m.shape == (182, 2)
    assert np.array_equal(prepared.xy_m[0], [0.0, 0.0])
    assert abs(prepared.xy_m[-1, 1]) < 1e-12
    assert prepared.net_displacement_m == pytest.approx(prepared.xy_m[-1, 0])


def test_the_catalogues_are_those_of_the_library():
    assert "floor.friction" in realgap.parameters()["name"]
    assert "pca" in realgap.metrics()["name"]
    assert "cma-es" in realgap.optimizers()["name"]
    assert realgap.engine().startswith("rapier3d")


def test_a_report_is_one_page(answer, tmp_path):
    answer.write(tmp_path / "folder")
    page = realgap.report(tmp_path / "folder", output=tmp_path / "page.html")
    assert page.startswith("<!") and (tmp_path / "page.html").read_text() == page
    assert realgap.read_parameters(tmp_path / "folder" / "best.ron") == answer.best
