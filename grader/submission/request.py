"""What is asked of a hand-in: by its exercise, and by who has it graded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from grader.text.message import Message, msg

if TYPE_CHECKING:
    from grader.recording.subject import Role

#: What the challenge asks for.
USUAL_NAME = "turtle_controller"


@dataclass(frozen=True)
class LaunchAsked:
    """A launch file that is asked for.

    Attributes:
        file: its path in the submission, or its name alone.
        given: values of its arguments.
    """

    file: str
    given: Mapping[str, str] = field(default_factory=dict)

    def is_called(self, path: str) -> bool:
        """Whether a launch file has the path, or ends with the name, that is asked for."""
        return bool(self.file) and f"/{path}".endswith(f"/{self.file.removeprefix('./')}")


@dataclass(frozen=True)
class Request:
    """What is to be started of a hand-in, and looked at.

    Attributes:
        executable: chooses among the console scripts or Python files of a folder or zip; where
            nothing is started, among packages. A single .py file leaves no choice.
        launch: the launch file that is asked for.
        is_started: else all of it is inspected.
        programs: those of the exercise, names or patterns of names such as '*talker*', which are
            started where the submission has them.
        name: of what is started where there are several, and the exercise names no programs.
        roles: what the exercise's programs have on the graph.
        inspections: by which the whole package around what is started is inspected at the same
            time; None for not at all.
        interfaces: the exercise's, a type -> its definition.
    """

    executable: str | None = None
    launch: LaunchAsked | None = None
    is_started: bool = True
    programs: tuple[str, ...] = ()
    name: str = USUAL_NAME
    roles: tuple[Role, ...] = ()
    inspections: tuple[str, ...] | None = None
    interfaces: Mapping[str, str] = field(default_factory=dict)

    @property
    def usual(self) -> str:
        """The name, or its pattern, of what is started where there are several; '' for none."""
        return self.programs[0] if self.programs else self.name

    def advice(self, ending: str) -> Message:
        """Say which of several is expected; `ending`: of a file's name."""
        if not self.usual:
            return msg("Choose one with --executable NAME.")
        usual = f"{self.usual}{ending}"
        return msg(
            "Expected one called {usual}; choose another with --executable NAME.", usual=usual
        )

    def is_wanted(self, name: str, package: str = "") -> bool:
        """Whether a program is called as it is asked for, else as the usual one is."""
        if self.executable:
            return self.executable in (name, f"{package}/{name}")
        return fnmatchcase(name, self.usual)
