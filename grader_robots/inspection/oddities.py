"""Traces of packages that nobody would hand in, and that an inspection may find all the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from grader.recording import Trace
from grader.submission import package_trace
from grader.text import NOTHING, Message

_SETUP: Final = package_trace.Setup("", "", "", "", NOTHING, (), None, (), (), (), "", (), (), ())
_LAUNCH: Final = package_trace.LaunchFile("", None, (), (), (), (), (), (), (), "")
_NODE: Final = package_trace.LaunchedNode("", "", "", "", (), (), (), False)
_ROBOT: Final = package_trace.Description(0, "", True, "", None, (), True)
_ODD: Final = "\x1b[31m\u202e\ud800 \n"


def _described(text: str, varied: str = "") -> package_trace.PackageTrace:
    """A package that hands on a description."""
    parameter = package_trace.Parameter("robot_description", "", 0, False)
    publisher = replace(_NODE, executable="robot_state_publisher", parameters=(parameter,))
    launch = replace(_LAUNCH, nodes=(publisher,))
    more = (package_trace.Varied(0, "base_length", 1), package_trace.Varied(0, "base_width", -1))
    return package_trace.PackageTrace(_SETUP, (), (launch,), (_ROBOT,), more, (text, varied))


def _with_joint(inner: str, kind: str = "revolute") -> str:
    links = "<link name='a'/><link name='b'/>"
    ends = "<parent link='a'/><child link='b'/>"
    return f"<robot name='r'>{links}<joint name='j' type='{kind}'>{ends}{inner}</joint></robot>"


def _spawned(*arguments: str) -> package_trace.PackageTrace:
    """A package that puts something into Gazebo."""
    node = replace(_NODE, package="ros_gz_sim", executable="create", arguments=arguments)
    return package_trace.PackageTrace(_SETUP, launches=(replace(_LAUNCH, nodes=(node,)),))


_LIMIT: Final = "<limit lower='nan' upper='inf' effort='1' velocity='1'/>"
TRACES: Final[Mapping[str, package_trace.PackageTrace]] = {
    "nobody could look at": package_trace.PackageTrace(),
    "has nothing": package_trace.PackageTrace(_SETUP),
    "has an odd name": package_trace.PackageTrace(replace(_SETUP, name=_ODD, absent=(_ODD,))),
    "ends its set-up with nothing to say": package_trace.PackageTrace(
        replace(_SETUP, problem=package_trace.Obstacle("", NOTHING))
    ),
    "has an odd manifest": package_trace.PackageTrace(replace(_SETUP, manifest=Message.of(_ODD))),
    "has an odd script": package_trace.PackageTrace(
        replace(
            _SETUP,
            scripts=(package_trace.InstalledScript(_ODD, "", "", Message.of(_ODD), "", False),),
        )
    ),
    "starts what has no name": package_trace.PackageTrace(
        _SETUP, launches=(replace(_LAUNCH, nodes=(_NODE,)),)
    ),
    "lacks what has no name": package_trace.PackageTrace(
        _SETUP,
        launches=(
            replace(
                _LAUNCH,
                problem=package_trace.Obstacle("what", Message.of(_ODD), _ODD, -1),
                includes=(package_trace.Include("", "", ()),),
                lacking=tuple(
                    package_trace.Lacking(kind, "", "", "") for kind in ("file", "package", "?")
                ),
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
                meshes=(
                    package_trace.NamedMesh(_ODD, "scheme", "", True),
                    package_trace.NamedMesh("", "left", "", False),
                ),
            ),
            replace(_ROBOT, text=-1, problem=package_trace.Obstacle("error", NOTHING)),
        ),
    ),
    "spawns without arguments": _spawned(),
    "spawns with odd arguments": _spawned("-x", "-y", _ODD, "-topic"),
}


def odd_traces() -> Mapping[str, Trace]:
    """All of them, by what such a package does."""
    return {f"a package that {what}": trace for what, trace in TRACES.items()}
