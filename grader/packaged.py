"""What a submission's package says of itself: its program, its launch files; read, never run.

It goes from the process that reads the submission into the recording, and checks judge by it. What
only a run could tell is None, "not known", and nobody's mistake.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Self

#: Of each list, and of each text [characters].
MOST, LONGEST = 50, 1_000


@dataclass(frozen=True)
class LaunchedNode:
    """A node that a launch file names.

    Attributes:
        package, executable: None where they are computed.
        parameters: their names; None where some of them are computed.
    """

    package: str | None
    executable: str | None
    parameters: tuple[str, ...] | None = ()

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """What `asdict` has made; ValueError: anything else."""
        data = _object(data, {"package", "executable", "parameters"})
        given = data["parameters"]
        names = None if given is None else tuple(_text(name) for name in _list(given))
        return cls(_perhaps(data["package"]), _perhaps(data["executable"]), names)


@dataclass(frozen=True)
class LaunchDescription:
    """A launch file.

    Attributes:
        file: as a student calls it.
        fault: what keeps `ros2 launch` from starting anything, as a clause; ''.
        is_installed: whether setup.py names it.
        includes: whether it includes other launch files, of which nothing is known.
        absolute: paths in it that are there at home only.
        nodes: those that it names, whether or not it starts them always.
    """

    file: str
    fault: str = ""
    is_installed: bool = True
    includes: bool = False
    absolute: tuple[str, ...] = ()
    nodes: tuple[LaunchedNode, ...] = ()

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """What `asdict` has made; ValueError: anything else."""
        names = {"file", "fault", "is_installed", "includes", "absolute", "nodes"}
        data = _object(data, names)
        return cls(
            _text(data["file"]),
            _text(data["fault"]),
            _bool(data["is_installed"]),
            _bool(data["includes"]),
            tuple(_text(each) for each in _list(data["absolute"])),
            tuple(LaunchedNode.from_json(each) for each in _list(data["nodes"])),
        )


@dataclass(frozen=True)
class Packaged:
    """A package.

    Attributes:
        name: by its package.xml; '' where it has none that can be used.
        scripts: the console scripts that it names.
        started: the one of them that was started; '' where a file was, for want of one.
        shortcomings: what would keep colcon and `ros2 run` from starting it, a sentence each.
        launches: its launch files.
        not_installed: descriptions of robots in it that setup.py does not name.
    """

    name: str
    scripts: tuple[str, ...] = ()
    started: str = ""
    shortcomings: tuple[str, ...] = ()
    launches: tuple[LaunchDescription, ...] = ()
    not_installed: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """As a file holds it: no longer than may be read."""
        cut: dict[str, Any] = _cut(asdict(self))
        return cut

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """What `to_json` has made.

        Raises:
            ValueError: it is anything else.
        """
        listed = ("scripts", "shortcomings", "not_installed")
        data = _object(data, {"name", "started", "launches", *listed})
        texts = {key: tuple(_text(each) for each in _list(data[key])) for key in listed}
        launches = tuple(LaunchDescription.from_json(each) for each in _list(data["launches"]))
        name, started = _text(data["name"]), _text(data["started"])
        return cls(name=name, started=started, launches=launches, **texts)


def _cut(value: Any) -> Any:
    match value:
        case str():
            return value[:LONGEST]
        case list() | tuple():
            return [_cut(each) for each in value[:MOST]]
        case dict():
            return {key: _cut(each) for key, each in value.items()}
    return value


def _object(data: Any, wanted: set[str]) -> dict[str, Any]:
    if not isinstance(data, dict) or data.keys() != wanted:
        raise ValueError(f"expected an object of {', '.join(sorted(wanted))}, found {data!r:.80}")
    return data


def _list(data: Any) -> list[Any]:
    if not isinstance(data, list) or len(data) > MOST:
        raise ValueError(f"expected a list of {MOST} at most, found {data!r:.80}")
    return data


def _perhaps(data: Any) -> str | None:
    return None if data is None else _text(data)


def _text(data: Any) -> str:
    if type(data) is not str or len(data) > LONGEST:
        raise ValueError(f"expected a text of {LONGEST} characters at most, found {data!r:.80}")
    return data


def _bool(data: Any) -> bool:
    if type(data) is not bool:
        raise ValueError(f"expected true or false, found {data!r:.80}")
    return data
