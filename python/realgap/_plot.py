"""Pictures of answers on axes of matplotlib, for figures of your own. The page and the PNG files need no matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, cast

import numpy as np

from ._array import Floats
from ._error import usage
from ._gap import GapSummary
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._answer import Answer, Profile

# Points of a map along each parameter.
CELLS = 41
# Colours that people who do not see red and green tell apart (Okabe and Ito 2008).
SIMULATED, RECORDED, OTHER = "#0072b2", "#d55e00", "#009e73"


def axes_of(ax: Optional["Axes"]) -> "Axes":
    """The given axes, or those of a new figure."""
    if ax is not None:
        if not hasattr(ax, "get_xlim"):
            raise usage("not axes", field="ax", found=type(ax).__name__, allowed="one Axes of matplotlib, or None for a new figure")
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise usage(
            "matplotlib is not installed",
            field="ax",
            hint="pip install matplotlib; answer.pictures() and realgap.report(folder) need no matplotlib",
        ) from error
    made: Any = pyplot.subplots()
    return cast("Axes", made[1])


def small(unit: str, *arrays: Floats) -> Tuple[str, float]:
    """Millimetres or milliradians and the factor for them, where all numbers are small; otherwise the unit itself."""
    finite = [array[np.isfinite(array)] for array in arrays]
    largest = max((float(np.abs(array).max()) for array in finite if array.size), default=0.0)
    names = {"m": "mm", "rad": "mrad"}
    return (names[unit], 1e3) if unit in names and 0.0 < largest < 0.1 else (unit, 1.0)


def labelled(name: str, unit: str) -> str:
    """The label of an axis."""
    return name if unit in ("", "1") else f"{name}, {unit}"


def draw_map(answer: "Answer", parameters: Optional[Sequence[str]], ax: Optional["Axes"]) -> "Axes":
    """See `Answer.plot`."""
    names = answer.study.parameters
    chosen = list(names[:2] if parameters is None else parameters)
    for name in chosen:
        if name not in names:
            raise usage("not a parameter that varies", field="parameters", found=name, allowed=", ".join(names))
    if len(chosen) != 2 or chosen[0] == chosen[1]:
        raise usage(
            "a map has two parameters",
            field="parameters",
            found=", ".join(chosen),
            allowed=", ".join(names),
            hint='plot("profiles") draws one parameter',
        )
    spans = [_span(answer, name) for name in chosen]
    values = [np.linspace(low, high, CELLS) for low, high in spans]
    places = [names.index(name) for name in chosen]
    base = [answer.best[name] for name in names]
    points: List[List[float]] = []
    for y in values[1]:
        for x in values[0]:
            point = list(base)
            point[places[0]], point[places[1]] = float(x), float(y)
            points.append(point)
    scores = answer.expected(points).numbers("score")
    if not np.isfinite(scores).any():
        raise usage("the expected score is not known between the points", field="what", allowed="profiles, joints", hint="answer.points has the scores of the points")
    unit, factor = small(answer.unit, scores)
    axes = axes_of(ax)
    plot: Any = axes
    grid = np.ma.masked_invalid(factor * scores.reshape(CELLS, CELLS))
    drawn = plot.pcolormesh(values[0], values[1], grid, shading="nearest", cmap="viridis_r", rasterized=True)
    label = labelled(f"expected {answer.summary.metric}", unit)
    plot.figure.colorbar(drawn, ax=axes, label=label)
    draws = answer.posterior
    if draws.rows:
        plot.plot(draws.numbers(chosen[0]), draws.numbers(chosen[1]), ".", color="black", alpha=0.25, markersize=3, label="posterior draws")
    best = answer.best
    plot.plot(best[chosen[0]], best[chosen[1]], "*", color="white", markeredgecolor="black", markersize=14, label="best point")
    plot.set_xlim(*spans[0])
    plot.set_ylim(*spans[1])
    plot.set_xlabel(labelled(chosen[0], _unit(answer, chosen[0])))
    plot.set_ylabel(labelled(chosen[1], _unit(answer, chosen[1])))
    plot.set_title(answer.summary.study)
    plot.legend()
    return axes


def draw_profile(answer: "Answer", parameters: Optional[Sequence[str]], ax: Optional["Axes"]) -> "Axes":
    """See `Answer.plot`."""
    known: Dict[str, "Profile"] = {profile.parameter: profile for profile in answer.profiles}
    if not known:
        raise usage("there are no profiles", field="what", hint="too few runs have a score")
    chosen = list(known)[:1] if parameters is None else list(parameters)
    if len(chosen) != 1 or chosen[0] not in known:
        raise usage(
            "a profile is that of one parameter",
            field="parameters",
            found=", ".join(chosen),
            allowed=", ".join(known),
            hint='call plot("profiles", parameters=[NAME], ax=axes[k]) for each',
        )
    profile = known[chosen[0]]
    unit, factor = small(answer.unit, profile.lowest_score, profile.high)
    axes = axes_of(ax)
    plot: Any = axes
    band = (factor * profile.low, factor * profile.high)
    plot.fill_between(profile.values, *band, color=SIMULATED, alpha=0.25, label="90 % interval")
    plot.plot(profile.values, factor * profile.lowest_score, color=SIMULATED, label="lowest expected score")
    inside = np.where(profile.indistinguishable, factor * profile.lowest_score, np.nan)
    plot.plot(profile.values, inside, color=RECORDED, linewidth=3, label="in the confidence set")
    plot.axvline(answer.best[profile.parameter], color="black", linestyle=":", label="best point")
    plot.set_xlabel(labelled(profile.parameter, profile.unit))
    plot.set_ylabel(labelled(answer.summary.metric, unit))
    plot.set_title(answer.summary.study)
    plot.legend()
    return axes


def draw_joint(
    answer: "Answer", joint: Optional[str], recording: Optional[str], ax: Optional["Axes"]
) -> "Axes":
    """See `Answer.plot`."""
    table = answer.joints
    if not table.rows:
        raise usage("the recordings have no joints of the robot", field="what", allowed="map, profiles")
    chosen = {"recording": recording, "joint": joint}
    wanted = np.ones(table.rows, dtype=bool)
    for column, name in chosen.items():
        cells = np.array(table[column])
        found = list(dict.fromkeys(str(cell) for cell in cells[wanted]))
        if name is not None and name not in found:
            raise usage(f"no such {column}", field=column, found=name, allowed=", ".join(found))
        chosen[column] = found[0] if name is None else name
        wanted &= cells == chosen[column]
    times_s, recorded, simulated = (table.numbers(name)[wanted] for name in ("t_s", "recorded", "simulated"))
    first = int(np.argmax(wanted))
    quantity, given_unit = str(table["quantity"][first]), str(table["unit"][first])
    unit, factor = small(given_unit, recorded, simulated)
    axes = axes_of(ax)
    plot: Any = axes
    plot.plot(times_s, factor * recorded, color=RECORDED, label="recorded")
    plot.plot(times_s, factor * simulated, color=SIMULATED, linestyle="--", label="simulated, best point")
    plot.set_xlabel("time, s")
    plot.set_ylabel(labelled(quantity, unit))
    plot.set_title(f"{chosen['joint']}, {chosen['recording']}")
    plot.legend()
    return axes


def draw_gap(gap: GapSummary, what: str, ax: Optional["Axes"]) -> "Axes":
    """See `Gap.plot`."""
    if what == "distance":
        return _draw_distance(gap, ax)
    if what != "confidence":
        raise usage("no such picture", field="what", found=repr(what), allowed="distance, confidence")
    found = gap.confidence
    if found is None:
        raise usage("there is no confidence without repeats under noise", field="what", hint="give the study noise and repeats, or plot(\"distance\")")
    axes = axes_of(ax)
    plot: Any = axes
    low, share, high = (np.array([getattr(one, name) for one in found.inside]) for name in ("low", "share", "high"))
    plot.fill_between(found.times_s, low, high, color=SIMULATED, alpha=0.25, label="95 % interval (Wilson)")
    plot.plot(found.times_s, share, color=SIMULATED, label="share of real runs inside")
    plot.axhline(found.level, color="black", linestyle=":", label=f"what the region promises ({100 * found.level:.0f} %)")
    plot.set_ylim(0.0, 1.05)
    plot.set_xlabel("time, s")
    plot.set_ylabel("share of real runs inside")
    plot.set_title(gap.study)
    plot.legend()
    return axes


def _draw_distance(gap: GapSummary, ax: Optional["Axes"]) -> "Axes":
    over = gap.over_time
    curves = [
        ("run without noise", over.ideal_m, SIMULATED),
        ("mean of the repeats under noise", over.simulated_mean_m, OTHER),
        ("mean of the other recordings", over.real_mean_m, RECORDED),
    ]
    known = [(label, np.array(values), colour) for label, values, colour in curves if values is not None]
    if not known:
        raise usage("nothing was compared over time", field="what", allowed="confidence")
    unit, factor = small("m", *(values for _, values, _ in known))
    axes = axes_of(ax)
    plot: Any = axes
    for label, values, colour in known:
        plot.plot(over.times_s, factor * values, color=colour, label=label)
    plot.set_xlabel("time, s")
    plot.set_ylabel(labelled("RMS distance from the recordings", unit))
    plot.set_title(gap.study)
    plot.legend()
    return axes


def _span(answer: "Answer", name: str) -> Tuple[float, float]:
    varied = cast(List[Dict[str, object]], answer.study.info["parameters"])
    own = next(one for one in varied if one["name"] == name)
    return float(cast(float, own["from"])), float(cast(float, own["to"]))


def _unit(answer: "Answer", name: str) -> str:
    return next((verdict.unit for verdict in answer.verdicts if verdict.parameter == name), "")


def table_of_expected(points: Sequence[Sequence[float]], names: Sequence[str], found: Sequence[Sequence[Optional[float]]]) -> Table:
    """The columns of `Answer.expected`."""
    columns: Dict[str, Any] = {name: [float(point[k]) for point in points] for k, name in enumerate(names)}
    for k, name in enumerate(("score", "low", "high")):
        columns[name] = [row[k] for row in found]
    return Table(columns)
