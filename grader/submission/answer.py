"""What an inspection answers: what set-ups install, and what a package would launch.

It is asked before anything of a package is started, and comes from a process in which a stranger's
code ran: a claim, which whoever uses it holds against the files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grader.submission import trace
from grader.submission.trace import Obstacle, PackageTrace


@dataclass(frozen=True)
class DataFiles:
    """Files, and the folder that they come into."""

    folder: str
    files: tuple[str, ...]


@dataclass(frozen=True)
class SetUpFacts:
    """What a set-up says.

    Attributes:
        name: of the package; '' where it gives none.
        data_files: what it installs beside Python's packages.
        scripts: lines such as 'talker = pkg.talker:main'.
        plain_scripts: files that are programs.
        packages: Python's; None where nothing lists them.
        package_folders: where they lie, as 'NAME=FOLDER'; without a name, all others.
        scripts_folder: where programs are installed, without `$base/`; '' where nothing says so.
        has_commands: whether classes of its own install it.
    """

    name: str = ""
    data_files: tuple[DataFiles, ...] = ()
    scripts: tuple[str, ...] = ()
    plain_scripts: tuple[str, ...] = ()
    packages: tuple[str, ...] | None = None
    package_folders: tuple[str, ...] = ()
    scripts_folder: str = ""
    has_commands: bool = False


@dataclass(frozen=True)
class SetUp:
    """The set-up files of one folder.

    Attributes:
        folder: where they lie in what was handed in; '.' for its top.
        problem: what ended their evaluation; None where it came to its end.
    """

    folder: str
    told: SetUpFacts
    problem: Obstacle | None


@dataclass(frozen=True)
class LaunchStart:
    """A program that a launch file starts.

    Attributes:
        name: as `ros2 launch` prints it: 'talker-1'.
        package: '' for a command.
        executable: of the package; of a command all of it.
        script: the submission's file that a command runs; '' for none.
        words: its arguments, and ROS's.
        lacking: of these, what it cannot get.
        after: the number of the one at whose end it starts; None: it starts with the launch; -1:
            nobody knows when.
        delay_s: how long after that [s].
        respawns: how often it is started again when it ends; below 0: always.
        respawn_s: how long after its end [s].
    """

    name: str
    package: str
    executable: str
    script: str = ""
    words: tuple[str, ...] = ()
    lacking: tuple[str, ...] = ()
    after: int | None = None
    delay_s: float = 0.0
    respawns: int = 0
    respawn_s: float = 0.0


@dataclass(frozen=True)
class LaunchOrder:
    """What a launch file starts, and when.

    Attributes:
        starts: in the order in which it does.
        included: the submission's own launch files that it includes.
        ignored: actions and options that are not followed, by their names.
    """

    starts: tuple[LaunchStart, ...] = ()
    included: tuple[str, ...] = ()
    ignored: tuple[str, ...] = ()


@dataclass(frozen=True)
class Inspection:
    """All of it.

    Attributes:
        set_ups: in the order in which they were asked for.
        package: the folder of the package that is likely to be started; '' for none.
        trace: what was found of that package; its launch files at least.
        orders: of launch files that came to their end, by their names in the trace.
    """

    set_ups: tuple[SetUp, ...] = ()
    package: str = ""
    trace: PackageTrace = field(default_factory=PackageTrace)
    orders: Mapping[str, LaunchOrder] = field(default_factory=dict)


def decode(data: bytes) -> Inspection:
    """The inspection that bytes mean."""
    made = trace.read(Inspection, data)
    trace.must_agree(made.trace)
    return made
