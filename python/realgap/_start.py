"""A study of your own files."""

from __future__ import annotations

import glob
import os
from dataclasses import dataclass
from typing import Dict, List, Mapping, Optional, Sequence, Tuple, Type, Union

from . import _native
from ._error import Error, usage
from ._json import Given, asked, made
from ._progress import AnyProgress, shown
from ._run import Path, path_name
from ._study import Study
from ._warning import Warning

# Gains KP (N m/rad) and KD (N m s/rad).
Gain = Tuple[float, float]

# The library's errors name options of the command here, because this work is the command's.
WORDS = (
    ("--own-gait", "own_gait=True"),
    ("--cube SIDE_M MASS_KG", "cube=(SIDE_M, MASS_KG)"),
    ("--cube", "cube="),
    ("--pd KP,KD", "pd=(KP, KD)"),
    ("--pd", "pd="),
    ("--track METRES", "track_m=METRES"),
    ("--track", "track_m="),
    ("--command", "commands="),
    ("--joints NAME,NAME,...", 'joints=["NAME", ...]'),
    ("--joints", "joints="),
    ("--reading FILE", "reading={...}"),
    ("--reading", "reading="),
    ("realgap start runs/*.csv robot.ron", 'realgap.start("runs/*.csv", "robot.ron")'),
)


@dataclass(frozen=True)
class Started:
    """A study that was made of files, where it was written, and how the files were read and why.

    >>> started = realgap.start("real_trajectories/tripod_standin/run_0[01].csv", "morphologies/tripod.ron", output=folder / "own.ron")
    >>> started.study.name, "read as follows" in str(started)
    ('own', True)
    """

    study: Study
    path: str
    lines: Tuple[str, ...]
    warnings: Tuple[Warning, ...]

    def __str__(self) -> str:
        return "\n".join(self.lines)

    __repr__ = __str__


@dataclass(frozen=True)
class _Said:
    lines: Tuple[str, ...]
    warnings: Tuple[Warning, ...]


def start(
    recordings: Union[Path, Sequence[Path]],
    robot: Optional[Path] = None,
    *,
    cube: Optional[Tuple[float, float]] = None,
    joints: Sequence[str] = (),
    pd: Union[Gain, Mapping[str, Gain], None] = None,
    track_m: Optional[float] = None,
    commands: Optional[Mapping[str, str]] = None,
    own_gait: bool = False,
    reading: Optional[Mapping[str, Given]] = None,
    output: Path = "study.ron",
    progress: AnyProgress = None,
) -> Started:
    """Makes a study of your recordings and your robot and writes it to `output`, as `realgap start` does; finds out how files must be read.

    `recordings` are files or globs; `robot` is a RON, URDF or MJCF file, or `cube` is (edge in metres, mass in kilograms). `joints`
    names numbered columns in their order; `pd` are known gains (KP, KD), or these by joint; `track_m` is the distance of the wheels
    for recorded speeds and turn rates; `commands` are recorded columns by the joints that they command, with the column that switches
    these (`{"drive_*": "throttle:enabled"}`), and the path is then fitted in windows; `own_gait` says that the robot ran the gait of its file; `reading` has the fields of a
    study's `reading`, for what the files leave open.

    >>> started = realgap.start("real_trajectories/cube_tosses/toss_0[0-3]*.csv", cube=(0.1, 0.37), output=folder / "tosses.ron")
    >>> started.study.info["robot"]
    'cube'
    """
    files = _files(recordings)
    if robot is not None:
        files.append(path_name(robot, "robot"))
    said = asked(
        "start",
        files=files,
        cube=None if cube is None else list(cube),
        joints=list(joints),
        pd=_gains(pd),
        track_m=track_m,
        commanded=[f"{joints}={columns}" for joints, columns in (commands or {}).items()],
        own_gait=own_gait,
        reading=dict(reading or {}),
        output=path_name(output, "output"),
    )
    try:
        found = made(_Said, _native.start(said, shown(progress)))
    except Error as error:
        raise _in_arguments(error) from error.__cause__
    path = os.fspath(output)
    return Started(Study.read(path), path, found.lines, found.warnings)


def _files(recordings: Union[Path, Sequence[Path]]) -> List[str]:
    named = [recordings] if isinstance(recordings, (str, os.PathLike)) else recordings
    if not isinstance(named, Sequence):
        raise usage("not files", field="recordings", found=repr(named), allowed="a path, a glob, or a list of these")
    files: List[str] = []
    for one in named:
        name = path_name(one, "recordings")
        matching = [name] if os.path.exists(name) else sorted(glob.glob(name))
        if not matching:
            raise usage("no such file", field="recordings", found=name, allowed="files that exist, or a glob of some")
        files.extend(matching)
    return files


def _gains(pd: Union[Gain, Mapping[str, Gain], None]) -> List[str]:
    if pd is None:
        return []
    by_joint: Dict[str, Gain] = dict(pd) if isinstance(pd, Mapping) else {"*": pd}
    texts: List[str] = []
    for joint, gain in by_joint.items():
        numbers = tuple(gain)
        if len(numbers) != 2:
            raise usage("not two gains", field="pd", found=repr(gain), allowed="(KP, KD), in N m/rad and N m s/rad")
        texts.append(f"{joint}={float(numbers[0])!r},{float(numbers[1])!r}")
    return texts


def _in_arguments(error: Error) -> Error:
    """The error with its remedies as arguments of this package."""
    text = str(error)
    for option, argument in WORDS:
        text = text.replace(option, argument)
    kind: Type[Error] = type(error)
    named = kind(text)
    named.message, named.file, named.line = error.message, error.file, error.line
    named.column, named.field = error.column, error.field
    return named
