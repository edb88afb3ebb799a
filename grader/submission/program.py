"""A program of a submission: one record, from the launch file that names it to its process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from grader.system.strict_json import STRANGERS
from ros_doubles.launch_time import WITH_THE_LAUNCH

#: In an argument: the folder of all that was handed in, and the prefix of what it installs, which
#: lie elsewhere in each run. No argument of a process has such a character of its own.
BASE: Final = "\0base"
PREFIX: Final = "\0prefix"
#: The most that its arguments take as JSON [characters]: one argument of its process holds them.
LONGEST_ARGUMENTS: Final = 60_000
#: How variables begin that a run sets, or that change how Python and ROS are loaded.
OF_THE_RUN: Final = (
    *("LD_", "DYLD_", "PYTHON", "ROS_", "RMW_", "AMENT_", "COLCON_", "FASTDDS_", "FASTRTPS_"),
)


@dataclass(frozen=True)
class EntryPoint:
    """Import `module`, call `function` without arguments."""

    module: str
    function: str  # may be dotted: "Controller.main"


@dataclass(frozen=True)
class Script:
    """Run the file as `__main__`.

    With a `function`, load the file by its path under another name instead, and call that: the
    file does not start itself, and its name cannot be imported.
    """

    path: Path
    function: str | None = None


@dataclass(frozen=True)
class Program:
    """A program that is started, in a process of its own.

    Attributes:
        name: as `ros2 launch` prints it, 'talker-1'; of a script that of its file.
        package: in which it is; '' for a script.
        executable: its name in the package, or its file; of a command all of it.
        entry: what runs; None where that is not known yet, or is not in Python.
        root: comes first on its sys.path, and is its working directory; absolute.
        arguments: '--ros-args', '-r', '__ns:=/left'; places as `BASE` and `PREFIX`.
        environment: variables that a launch file sets, 'NAME=value', likewise.
        lacking: arguments that it does not get.
        after: the number, among all, of the one at whose end it is started.
        delay_s: how long after that, or after the launch [s].
        respawns: how often it is started again when it ends; below 0: always.
        respawn_s: how long after its end [s].
    """

    name: str
    package: str
    executable: str
    entry: EntryPoint | Script | None = None
    root: Path = Path()
    arguments: Annotated[tuple[str, ...], STRANGERS._replace(characters=LONGEST_ARGUMENTS)] = ()
    environment: tuple[str, ...] = ()
    lacking: tuple[str, ...] = ()
    after: int = WITH_THE_LAUNCH
    delay_s: float = 0.0
    respawns: int = 0
    respawn_s: float = 0.0

    def is_respawned(self, beside: Sequence[Program]) -> bool:
        """Whether it is another of these that is started again."""
        return self.after >= 0 and beside[self.after].name == self.name
