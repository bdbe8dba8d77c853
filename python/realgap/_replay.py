"""A run in motion, with its recordings."""

from __future__ import annotations

from typing import Optional

from . import _native
from ._robot import Robot, native_robot
from ._run import Path, path_name
from ._simulation import Simulation
from ._trajectory import Trajectories, Trajectory, native_trajectories, native_trajectory


def replay(
    run: Trajectory,
    against: Trajectories = (),
    *,
    robot: Optional[Robot] = None,
    as_recorded: bool = False,
    output: Optional[Path] = None,
) -> Optional[str]:
    """Shows a run in 3D with its recordings, as `realgap replay` does. A simulation is shown with all of its parts, a recorded run
    with those of `robot` that follow from its poses and joints, or as a point.

    Without `output`, the page is returned as HTML. The ending of `output` chooses the format: .html (a page), .png (an animation),
    .mcap (Foxglove) or .glb (glTF). Recordings are moved and turned onto the run, unless `as_recorded`.

    >>> "<html" in realgap.replay(run, recordings)
    True
    >>> realgap.replay(recordings[0], robot=robot, output=folder / "replay.html")
    """
    simulated = run._run if isinstance(run, Simulation) else None
    recorded = None if simulated is not None else native_trajectory(run)
    model = run.robot if isinstance(run, Simulation) and robot is None else robot
    return _native.replay(
        simulated,
        recorded,
        None if model is None else native_robot(model),
        native_trajectories(against),
        not as_recorded,
        None if output is None else path_name(output, "output"),
    )
