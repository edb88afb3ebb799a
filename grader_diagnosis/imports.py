"""Rules about imports: of modules that are missing, hidden, or have another name."""

from __future__ import annotations

import re
import sys

from grader.exercise import Diagnosis
from grader.recording.observations import Raised
from grader.text import NOTHING, Message, msg, shown
from grader_diagnosis.case import Case, diagnosed, filled, of_kind, words_of
from grader_diagnosis.misspelling import misspelt

#: Python's suffix to some errors, which helps nobody.
_PATH = re.compile(r" \((/[^()]*|unknown location)\)$")
#: Errors where a module was found in place of a package.
_NO_PACKAGE = re.compile(r"No module named '(\w{1,60})\.[\w.]{1,100}'; '\1' is not a package")
_INTERFACES = re.compile(r"No module named '\w{1,60}_(?:interfaces|msgs|srvs)'")
_ROS_1 = re.compile(r"'(?:rospy|roslib|rosmsg|tf)'")
_NO_MODULE = re.compile(r"No module named '([\w.]{1,60})'")
_OTHER_MODULE = re.compile(r"cannot import name '(\w{1,60})' from '([\w.]{1,60})'")
_PACKAGES = ("turtlesim", "turtlesim_msgs", "geometry_msgs", "std_msgs", "std_srvs", "rclpy")
#: Where beginners look for them in vain.
_WHERE = {
    **dict.fromkeys(("Twist", "Vector3", "Point", "Quaternion"), "geometry_msgs.msg"),
    **dict.fromkeys(("String", "Int32", "Float32", "Float64", "Bool", "Header"), "std_msgs.msg"),
    **dict.fromkeys(("Pose", "Color"), "turtlesim.msg"),
    **dict.fromkeys(("SetPen", "Spawn", "Kill", "TeleportAbsolute"), "turtlesim.srv"),
    **dict.fromkeys(("TeleportRelative",), "turtlesim.srv"),
    **dict.fromkeys(("Empty", "Trigger", "SetBool"), "std_srvs.srv"),
    "Node": "rclpy.node",
    "MultiThreadedExecutor": "rclpy.executors",
}
_WORD = re.compile(r"\w{1,100}")
_OF_PYTHON = ("cannot", "import", "name", "from", "No", "module", "named", "as")
_FROM = re.compile(
    r"cannot import name '\w{1,60}' from (?:partially initialized module )?'(\w{1,60})'"
)


def not_importable(case: Case) -> Diagnosis | None:
    """The program imports what is not there."""
    raised = case.raised
    if raised is None or raised.type not in ("ModuleNotFoundError", "ImportError"):
        return None
    hidden = _hides_package(raised) or _lies_beside(case, raised) or _circular(case, raised)
    hidden = hidden or _not_generated(case, raised)
    if hidden is not None:
        return hidden
    text = _PATH.sub("", shown(raised.text))
    cause = msg("Your program cannot import what it needs: {type}: {text}{where}.")
    help_ = msg(
        "Compare the name with the one in the exercise or in ROS's "
        "documentation. A module of your own has to be in what you hand in, "
        "beside the file or in its package."
    )
    if _INTERFACES.match(text):
        help_ = msg(
            "Compare the name. A package of interfaces of your own has to be in what you hand "
            "in, beside your node's, with CMakeLists.txt and package.xml. Any other is not "
            "installed where your node was graded: take std_msgs, std_srvs or geometry_msgs."
        )
    elif advice := _of_own_module(case, raised) or _elsewhere(case, raised) or _better(text):
        help_ = advice
    return diagnosed("not_importable", cause, help_, raised.place, type=raised.type, text=text)


#: In sentences about what is too large here, and not for colcon.
_OUR_LIMITS = ("makes messages too large", "found more than", "characters in all are used")


def _better(text: str) -> Message | None:
    """Return what to import instead, or that the module is not installed."""
    if _ROS_1.search(text):
        return msg(
            "That is of ROS 1. In ROS 2 it is rclpy: import rclpy, from rclpy.node import Node, "
            "and node.create_publisher(Twist, '/topic', 10)."
        )
    if found := _OTHER_MODULE.search(text):
        name = found[1]
        if found[2].rpartition(".")[0] in _PACKAGES and name in _WHERE:
            return msg(
                "{name} is in another module: from {module} import {name}.",
                name=name,
                module=_WHERE[name],
            )
    if (found := _NO_MODULE.fullmatch(text)) and found[1].partition(".")[0] not in _PACKAGES:
        return msg(
            "{name} is not installed where your node is graded: leave it out. A module of your "
            "own has to be in what you hand in. Compare the name.",
            name=shown(found[1]),
        )
    return None


def _elsewhere(case: Case, raised: Raised) -> Message | None:
    """Return where the file of a module lies that is imported from somewhere else."""
    for finding in of_kind(case, "elsewhere"):
        if finding.place.line == getattr(raised.place, "line", 0):
            there = msg("There is no {name}; there is {near}: give it that place and name.")
            return filled(there, words_of(finding))
    return None


def _not_generated(case: Case, raised: Raised) -> Diagnosis | None:
    """An interface of the hand-in's that is not generated, or has another name or module."""
    known = case.recording.interfaces
    texts = raised.text[:1000], raised.place.text if raised.place else ""
    words = [each for each in _WORD.findall(" ".join(texts)) if each not in _OF_PYTHON]
    own = [name for name in {**known.faults, **known.texts} if name.partition("/")[0] in words]
    if not own:
        return None
    types = {name.rpartition("/")[2]: name for name in reversed(own)}
    found = _OTHER_MODULE.search(raised.text)
    asked = words if found is None else [found[1]]
    alike = ((word, each) for word in asked for each in types if misspelt(word, each))
    word, near = next(alike, ("", "" if found else own[0].rpartition("/")[2]))
    said = known.faults.get(types.get(near, ""), NOTHING)
    for inner in _WORD.findall(str(said)):  # what the mistake is in
        others = (each for each in types if each.lower() == inner.lower())
        near = next((e for e in others if known.faults.get(types[e], said) != said), near)
    module, _, name = types.get(near, own[0]).replace("/", ".").rpartition(".")
    values = {"m": module, "n": name, "package": own[0].partition("/")[0]}
    why = known.faults.get(types.get(near, ""), NOTHING)
    cause = msg("Your program imports what your {package} does not have{where}.")
    help_ = msg("Write `from {m} import {n}`.")
    if why:
        cause = msg("Your program cannot import {m}.{n}{where}: {why}", why=why)
        is_ours = any(limit in str(why) for limit in _OUR_LIMITS)
        help_ = msg("Make them shorter, or fewer.")
        if not is_ours:
            help_ = msg(
                "`colcon build` refuses it, too: build your packages before you hand them in."
            )
    elif near and word == near:
        cause = msg("Your program cannot import {m}.{n}{where}.")
    elif not near:
        help_ = msg("It has: {names}.", names=", ".join(sorted(types))[:200])
    return diagnosed("not_importable", cause, help_, raised.place, **values)


def _of_own_module(case: Case, raised: Raised) -> Message | None:
    """Return what a module of the submission's has instead of the name that is imported."""
    found = _OTHER_MODULE.search(raised.text)
    for finding in of_kind(case, "not_defined") if found is not None else ():
        if found is not None and finding.name == found[1]:
            has = msg("Your module {module} has {near}, not {name}: write that.")
            if "," in finding.near:
                has = msg("Your module {module} has no {name}; it has: {near}.")
            return filled(has, words_of(finding) | {"module": shown(found[2])})
    return None


def _circular(case: Case, raised: Raised) -> Diagnosis | None:
    """Two modules of the submission's import each other."""
    if "partially initialized module" not in raised.text:
        return None
    found = sorted(of_kind(case, "circular"), key=lambda each: each.near, reverse=True)
    for finding in found:  # first one that nothing uses
        here, there = shown(finding.place.file), shown(finding.name)
        help_ = msg("Move what both of them need into a third file, and import that in both.")
        if finding.near:
            help_ = msg("Take that import out: {file} uses nothing of it.", file=here)
        cause = msg(
            "Your program cannot import what it needs: {there} imports {here}, and {here} imports "
            "{there}{where}."
        )
        return diagnosed("not_importable", cause, help_, finding.place, here=here, there=there)
    return None


def _hides_package(raised: Raised) -> Diagnosis | None:
    """A file of the submission has the name of the package that it imports."""
    found = _NO_PACKAGE.search(raised.text) or _FROM.search(raised.text)
    if found is None or raised.place is None:
        return None
    name, file = found[1], raised.place.file.rpartition("/")[2]
    is_named_so = file == f"{name}.py"
    if not is_named_so and (found.re is _FROM or name in sys.stdlib_module_names):
        return None
    name = shown(name)
    which = (
        msg("Your file is itself called {name}.py", name=name)
        if is_named_so
        else msg("A file of your own is called {name}.py", name=name)
    )
    return diagnosed(
        "not_importable",
        msg("{which}, and so hides the package {name} from which you import{where}."),
        msg("Give {name}.py another name."),
        raised.place,
        which=which,
        name=name,
    )


def _lies_beside(case: Case, raised: Raised) -> Diagnosis | None:
    """The module that is imported lies in the submission's own package."""
    file = raised.place.file if raised.place else ""
    found = (each for each in of_kind(case, "beside") if each.place.file == file)
    finding = next((each for each in found if f"'{each.name}'" in raised.text), None)
    if finding is None:
        return None
    name, near = shown(finding.name), shown(finding.near)
    package = near.rpartition(".")[0]
    written = shown(finding.place.text)
    instead = f"from {package} import {name}"
    if written.startswith(f"from {name} import "):
        instead = written.replace(f"from {name} ", f"from {near} ", 1)
    return diagnosed(
        "not_importable",
        msg(
            "Your program cannot import {name}: it lies beside, in the package "
            "{package}, and in a package its name is {near}{where}."
        ),
        msg("Write `{instead}` there.", instead=instead),
        raised.place,
        name=name,
        package=package,
        near=near,
    )
