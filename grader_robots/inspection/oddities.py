"""Traces of packages that nobody would hand in, and that an inspection may find all the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from grader.recording import Trace
from grader.submission import (
    Description,
    Include,
    InstalledScript,
    Lacking,
    LaunchedNode,
    LaunchFile,
    NamedMesh,
    Obstacle,
    PackageTrace,
    Parameter,
    Setup,
    Varied,
)
from grader.text import NOTHING, Message

_SETUP: Final = Setup("", "", "", "", NOTHING, (), None, (), (), (), "", (), (), ())
_LAUNCH: Final = LaunchFile("", None, (), (), (), (), (), (), (), "")
_NODE: Final = LaunchedNode("", "", "", "", (), (), (), False)
_ROBOT: Final = Description(0, "", True, "", None, (), True)
_ODD: Final = "\x1b[31m\u202e\ud800 \n"


def _described(text: str, varied: str = "") -> PackageTrace:
    """A package that hands on a description."""
    parameter = Parameter("robot_description", "", 0, False)
    publisher = replace(_NODE, executable="robot_state_publisher", parameters=(parameter,))
    launch = replace(_LAUNCH, nodes=(publisher,))
    more = (Varied(0, "base_length", 1), Varied(0, "base_width", -1))
    return PackageTrace(_SETUP, (), (launch,), (_ROBOT,), more, (text, varied))


def _with_joint(inner: str, kind: str = "revolute") -> str:
    links = "<link name='a'/><link name='b'/>"
    ends = "<parent link='a'/><child link='b'/>"
    return f"<robot name='r'>{links}<joint name='j' type='{kind}'>{ends}{inner}</joint></robot>"


def _spawned(*arguments: str) -> PackageTrace:
    """A package that puts something into Gazebo."""
    node = replace(_NODE, package="ros_gz_sim", executable="create", arguments=arguments)
    return PackageTrace(_SETUP, launches=(replace(_LAUNCH, nodes=(node,)),))


_LIMIT: Final = "<limit lower='nan' upper='inf' effort='1' velocity='1'/>"
TRACES: Final[Mapping[str, PackageTrace]] = {
    "nobody could look at": PackageTrace(),
    "has nothing": PackageTrace(_SETUP),
    "has an odd name": PackageTrace(replace(_SETUP, name=_ODD, absent=(_ODD,))),
    "ends its set-up with nothing to say": PackageTrace(
        replace(_SETUP, problem=Obstacle("", NOTHING))
    ),
    "has an odd manifest": PackageTrace(replace(_SETUP, manifest=Message.of(_ODD))),
    "has an odd script": PackageTrace(
        replace(_SETUP, scripts=(InstalledScript(_ODD, "", "", Message.of(_ODD), "", False),))
    ),
    "starts what has no name": PackageTrace(_SETUP, launches=(replace(_LAUNCH, nodes=(_NODE,)),)),
    "lacks what has no name": PackageTrace(
        _SETUP,
        launches=(
            replace(
                _LAUNCH,
                problem=Obstacle("what", Message.of(_ODD), _ODD, -1),
                includes=(Include("", "", ()),),
                lacking=tuple(Lacking(kind, "", "", "") for kind in ("file", "package", "?")),
                moved=_ODD,
            ),
        ),
    ),
    "describes nothing": _described(""),
    "describes no XML": _described("<robot", "<robot name='r'/>"),
    "describes nonsense": _described("\ud800\x00<robot name='r'>", _ODD),
    "describes a robot without links": _described("<robot name='r'/>", "<robot name='r'/>"),
    "has limits that are no numbers": _described(_with_joint(_LIMIT), _with_joint("", "fixed")),
    "has an endless mass": _described(
        "<robot name='r'><link name='a'><inertial><mass value='1e400'/>"
        "<inertia ixx='nan' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>"
    ),
    "names odd meshes": replace(
        _described(_with_joint(_LIMIT)),
        descriptions=(
            replace(
                _ROBOT,
                meshes=(NamedMesh(_ODD, "scheme", "", True), NamedMesh("", "left", "", False)),
            ),
            replace(_ROBOT, text=-1, problem=Obstacle("error", NOTHING)),
        ),
    ),
    "spawns without arguments": _spawned(),
    "spawns with odd arguments": _spawned("-x", "-y", _ODD, "-topic"),
}


def odd_traces() -> Mapping[str, Trace]:
    """All of them, by what such a package does."""
    return {f"a package that {what}": trace for what, trace in TRACES.items()}
