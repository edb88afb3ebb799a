"""What is told of robots and of packages can be told in every language, to the last word."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercises.state_publisher.seen import sentence
from grader.language.catalogue import ENGLISH, LANGUAGES, knows
from grader.language.phrase import Phrase, say
from grader.language.telling import told
from grader.recording.recording import Recording, Recordings
from grader.scenes import load_scene
from grader.scenes.package.examining.steps import _NO_END, NONSENSE
from grader.scenes.package.launch_errors import advice
from grader.scenes.package.said import phrase_of
from grader.scenes.package.trace import (
    Lacking,
    Launch,
    Node,
    PackageTrace,
    Parameter,
    Problem,
    Script,
    Setup,
)
from grader.scenes.robot.driving import drive, joint_state, tf
from grader.scenes.view import Table, Tree
from grader.testing.odd_packages import odd_packages
from robot_py.robot_state import Placed

OTHERS = [language for language in LANGUAGES if language != ENGLISH]
WALKER = load_exercise("state_publisher")
PACKAGES = [load_exercise(name) for name in ("description_package", "thymio_package")]
NAMES = ("swivel", "tilt", "periscope")


def holes(text: str) -> Iterator[tuple[str, str]]:
    """(language, sentence) that no catalogue has, in a text and in what it is made of."""
    if not isinstance(text, Phrase):
        return
    for part in text.parts:
        yield from holes(part)
    if text.key:
        yield from ((each, text.key) for each in OTHERS if not knows(each, text.key, text.many))
    for value in text.values.values():
        yield from holes(value)


def verdicts(exercise: Any, recordings: Recordings) -> list[Any]:
    return list(judge(recordings, exercise.checks, exercise.points, exercise.tolerances))


def texts(found: list[Any]) -> Iterator[str]:
    """What the checks themselves have said."""
    for verdict in found:
        yield from (verdict.rationale, verdict.help)
        yield from (each.note for each in verdict.evidence)
        yield from (each.text for each in verdict.expected)


def assert_told(said: list[str]) -> None:
    assert [text for text in said if text and not isinstance(text, Phrase)] == []
    assert sorted({hole for text in said for hole in holes(text)}) == []


def walks(
    every: int = 2,
    frames: tuple[str, str] = ("odom", "axis"),
    topic: str = "/tf",
    names: tuple[str, ...] = NAMES,
    turned: tuple[float, ...] | None = None,
    stamp_ns: int | None = None,
    still: bool = False,
) -> Any:
    """Publishes every so many ticks."""

    def controller(tick: int, now_ns: int) -> Any:
        if tick % every:
            return ()
        t, stamp = tick * 0.016, now_ns if stamp_ns is None else stamp_ns
        positions = (1.0, 1.0, 1.0) if still else (0.5 * t, 30 * math.sin(t), 0.1 * math.sin(5 * t))
        half = (0.5 * t + math.pi / 2) / 2
        at = (2 * math.cos(0.5 * t), 2 * math.sin(0.5 * t), 0.7)
        way = turned or (0.0, 0.0, math.sin(half), math.cos(half))
        placed = Placed(stamp, *frames, at, way)  # type: ignore[arg-type]
        return joint_state(stamp, names, positions), tf(placed, topic=topic)

    return controller


@pytest.mark.parametrize(
    "controller",
    [
        walks(),
        walks(every=40),
        walks(frames=("axis", "odom")),
        walks(frames=("map", "base")),
        walks(topic="/tf_static"),
        walks(names=("swivel", "tilt", "mast")),
        walks(names=("swivel", "tilt")),
        walks(turned=(0.0, 0.0, 0.0, 0.0)),
        walks(turned=(0.7, 0.0, 0.0, 0.7)),
        walks(turned=(0.0, 0.0, 0.0, 2.0)),
        walks(stamp_ns=0),
        walks(stamp_ns=5),
        walks(still=True),
        lambda tick, now_ns: (),
    ],
)
def test_all_that_is_said_of_a_robot_can_be_said_in_every_language(controller):
    trace = drive(controller, 300, WALKER.setting)
    found = verdicts(WALKER, Recordings(Recording(trace, scene="robot")))
    assert_told(list(texts(found)))
    view = load_scene("robot").view(trace)
    assert_told([*(curve.title for curve in view.curves), *view.drawn])
    trees = [part for part in view.parts if isinstance(part, Tree)]
    assert_told([text for tree in trees for text in (tree.title, tree.note)])


@pytest.mark.parametrize("exercise", PACKAGES, ids=("description", "thymio"))
@pytest.mark.parametrize("name", list(odd_packages()))
def test_all_that_is_said_of_a_package_can_be_said_in_every_language(exercise, name):
    recordings = odd_packages()[name]
    assert_told(list(texts(verdicts(exercise, recordings))))
    parts = load_scene("package").view(recordings.nominal.trace).parts
    tables = [part for part in parts if isinstance(part, Table)]
    assert_told([text for table in tables for text in (table.title, table.note, *table.headings)])


SCRIPT = Script("walk", "walker.walk", "main", "", "walker/walk.py", True)
SETUP = Setup(
    *("walker", "walker", "", "ament_python", "", (), None, (), (), (SCRIPT,)),
    *("lib/walker", ("share/walker/a.urdf",), ("urdf/a.urdf",), ()),
)
ROBOT = Node("robot_state_publisher", "robot_state_publisher", "", "", (), (), (), False)
LAUNCH = Launch("launch/a.launch.py", None, (ROBOT,), (), (), (), (), (), (), "")
ASKED = ("/home/me/a.urdf", "/somewhere/a.urdf", "/prefix/share/walker/a.urdf")


@pytest.mark.parametrize(
    "setup",
    [
        SETUP,
        replace(SETUP, manifest="there is none"),
        replace(SETUP, manifest="it has no <name>"),
        replace(SETUP, absent=("urdf/b.urdf",)),
        replace(SETUP, absent=("urdf",), build_type="ament_cmake"),
        replace(SETUP, folders=("meshes",)),
        replace(SETUP, told="strider"),
        replace(SETUP, told="strider", build_type="ament_cmake"),
        replace(SETUP, scripts_folder=""),
        replace(SETUP, scripts=(replace(SCRIPT, fault="there is no module walker.walk"),)),
        replace(SETUP, scripts=()),
        replace(SETUP, problem=Problem("error", "there is no setup.py")),
        replace(SETUP, problem=Problem("error", "NameError: x", "setup.py", 3)),
        replace(SETUP, problem=Problem("limit", _NO_END)),
        replace(SETUP, problem=Problem("unknown", "it installs FILES", "CMakeLists.txt")),
    ],
)
def test_what_keeps_a_package_from_being_built_can_be_said_in_every_language(setup):
    assert_told(_of_package(PackageTrace(setup, launches=(LAUNCH,))))


@pytest.mark.parametrize(
    "launch",
    [
        *(
            replace(LAUNCH, lacking=(Lacking("file", path, source, "launch/a.launch.py", 9),))
            for path in ASKED
            for source in ("", "urdf/a.urdf")
        ),
        replace(LAUNCH, lacking=(Lacking("package", "rviz2", "", "launch/a.launch.py"),)),
        replace(LAUNCH, lacking=(Lacking("executable", "rviz2 rviz", "", "launch/a.launch.py"),)),
        replace(LAUNCH, lacking=(Lacking("executable", "walker walk", "", "launch/a.launch.py"),)),
        replace(LAUNCH, lacking=(Lacking("executable", "walker run", "", "launch/a.launch.py"),)),
        replace(LAUNCH, moved="/prefix/share/walker/a.urdf"),
        replace(LAUNCH, nodes=()),
        replace(LAUNCH, nodes=(replace(ROBOT, executable="joint_state_publisher"),)),
        replace(LAUNCH, nodes=(replace(ROBOT, package="rviz2", executable="rviz2"),)),
        replace(LAUNCH, nodes=(replace(ROBOT, package="other", executable="walk"),)),
        replace(LAUNCH, nodes=(replace(ROBOT, package="walker", executable="run"),)),
        replace(
            LAUNCH,
            nodes=(replace(ROBOT, parameters=(Parameter("robot_description", "", 0, True),)),),
        ),
        replace(LAUNCH, problem=Problem("error", "NameError: x", "launch/a.launch.py", 3)),
        replace(LAUNCH, problem=Problem("argument", 'Required launch argument "x"')),
        replace(
            LAUNCH, problem=Problem("unknown", "it imports odd, which the grader does not have")
        ),
    ],
)
def test_what_is_wrong_with_a_launch_file_can_be_said_in_every_language(launch):
    assert_told(_of_package(PackageTrace(SETUP, launches=(launch,), texts=("urdf/a.urdf",))))


def _of_package(trace: PackageTrace) -> list[str]:
    """What every exercise with a package says of one."""
    alone = Recordings(Recording(trace, scene="package"))
    nothing = drive(lambda tick, now_ns: (), 1, WALKER.setting)
    beside = Recordings(Recording(nothing, scene="robot", package=trace))
    found = [each for exercise in PACKAGES for each in verdicts(exercise, alone)]
    of_both = [v for v in verdicts(WALKER, beside) if v.check in ("package", "launch")]
    return [*texts([*found, *of_both]), *load_scene("package").remarks(trace, (), "")]


@pytest.mark.parametrize(
    "text",
    [
        _NO_END,
        f"it {NONSENSE.removeprefix('it ')}",
        "it ended the process that it ran in (exit code 3)",
        "it hands on a text of 3,000,000 characters; 2,000,000 at most are taken",
        "it cannot be evaluated: launch/a.launch.py has taken away urdf/a.urdf",
        "it uses launch.actions.OpaqueCoroutine, which the grader does not know",
        "walker/walk.py has no main",
        "setup.py does not list the package walker, so nothing installs it",
    ],
)
def test_a_sentence_of_the_process_that_looks_is_known_again(text):
    found = phrase_of(text)
    assert isinstance(found, Phrase) and found == text
    assert_told([found])


@pytest.mark.parametrize(
    "text",
    [
        "NameError: name 'x' is not defined",
        "AttributeError: module 'launch' has no attribute 'Node'",
        "it does something else",
        "",
    ],
)
def test_what_python_and_others_say_stays_theirs(text):
    assert phrase_of(text) is text


def test_advice_about_launch_files_can_be_said_in_every_language():
    assert_told([advice("TypeError: unexpected keyword argument"), advice("")])


def test_a_clause_that_begins_a_sentence_has_a_capital_in_every_language():
    clauses = [say("its way is no circle"), say("it jumps along its circle")]
    assert sentence(clauses) == "Its way is no circle; it jumps along its circle."
    french = "Son trajet n'est pas un cercle\N{NO-BREAK SPACE}; il saute le long de son cercle."
    assert told(sentence(clauses), "fr") == french
    assert told(sentence(clauses), "zh") == "它的轨迹不是圆；它沿圆跳跃。"
    assert sentence(["setup.py names nothing"]) == "setup.py names nothing."


def test_a_sentence_that_is_the_same_in_another_language_says_its_values_there():
    movement = say(
        "{joint!r} {movement}", joint="tilt", movement=say("stays at {position:.4g}", position=0.5)
    )
    assert told(movement, "fr") == "'tilt' reste à 0,5"
