"""What is told of robots and of packages can be told in every language, to the last word."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.inspection.error_texts import advice
from grader.inspection.examining.examination import FROM_A_FILE, FROM_A_LAUNCH_FILE
from grader.inspection.examining.steps import (
    _NO_END,
    NONSENSE,
    it,
    not_known,
    not_there,
    problem_of,
)
from grader.inspection.trace import (
    InstalledScript,
    Lacking,
    LaunchedNode,
    LaunchFile,
    Obstacle,
    PackageTrace,
    Parameter,
    Setup,
    decode,
    encode,
)
from grader.message import NOTHING, Message, msg, plain_text
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import load_subject
from grader.recording.view import Table, Tree
from grader.scenes import load_scene
from grader.translations import ENGLISH, LANGUAGES, translate
from grader_robots.exercises.state_publisher.seen import sentence
from grader_robots.inspection.oddities import odd_traces
from grader_robots.scene import trace as robot_trace
from grader_robots.scene.driving import drive, joint_state, tf
from robot_py.robot_state import Placed
from tests.grader.languages.holes import holes

OTHERS = [language for language in LANGUAGES if language != ENGLISH]
WALKER = load_exercise("state_publisher")
PACKAGES = [load_exercise(name) for name in ("description_package", "thymio_package")]
NAMES = ("swivel", "tilt", "periscope")


def verdicts(exercise: Any, recordings: Recordings) -> list[Any]:
    return list(judge(recordings, exercise.checks, exercise.points, exercise.tolerances))


def texts(found: list[Any]) -> Iterator[Message]:
    """What the checks themselves have said."""
    for verdict in found:
        yield from (verdict.rationale, verdict.help)
        yield from (each.note for each in verdict.evidence)
        yield from (each.text for each in verdict.expected)


def assert_told(said: list[Message]) -> None:
    assert all(isinstance(each, Message) for each in said)
    assert sorted({hole for each in said for code in OTHERS for hole in holes(each, code)}) == []


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
@pytest.mark.parametrize("name", odd_traces())
def test_all_that_is_said_of_a_package_can_be_said_in_every_language(exercise, name):
    recordings = Recordings(Recording(odd_traces()[name], scene="package"))
    assert_told(list(texts(verdicts(exercise, recordings))))
    parts = load_subject("package").view(recordings.nominal.trace).parts
    tables = [part for part in parts if isinstance(part, Table)]
    assert_told([text for table in tables for text in (table.title, table.note, *table.headings)])


NO_MODULE = msg("there is no module {module}", module="walker.walk")
INSTALLS = it(msg("installs {name}", name="FILES"))
NAME_ERROR = plain_text("NameError: x")
UNKNOWN = not_known("OpaqueCoroutine").args[0]
SCRIPT = InstalledScript("walk", "walker.walk", "main", NOTHING, "walker/walk.py", True)
SETUP = Setup(
    *("walker", "walker", "", "ament_python", NOTHING, (), None, (), (), (SCRIPT,)),
    *("lib/walker", ("share/walker/a.urdf",), ("urdf/a.urdf",), ()),
)
ROBOT = LaunchedNode("robot_state_publisher", "robot_state_publisher", "", "", (), (), (), False)
LAUNCH = LaunchFile("launch/a.launch.py", None, (ROBOT,), (), (), (), (), (), (), "")
ASKED = ("/home/me/a.urdf", "/somewhere/a.urdf", "/prefix/share/walker/a.urdf")


@pytest.mark.parametrize(
    "setup",
    [
        SETUP,
        replace(SETUP, manifest=msg("there is none")),
        replace(SETUP, manifest=it(msg("has no <{tag}>", tag="name"))),
        replace(SETUP, absent=("urdf/b.urdf",)),
        replace(SETUP, absent=("urdf",), build_type="ament_cmake"),
        replace(SETUP, folders=("meshes",)),
        replace(SETUP, told="strider"),
        replace(SETUP, told="strider", build_type="ament_cmake"),
        replace(SETUP, scripts_folder=""),
        replace(
            SETUP,
            scripts=(replace(SCRIPT, fault=NO_MODULE),),
        ),
        replace(SETUP, scripts=()),
        replace(SETUP, problem=Obstacle("error", msg("there is no {file}", file="setup.py"))),
        replace(SETUP, problem=Obstacle("error", NAME_ERROR, "setup.py", 3)),
        replace(SETUP, problem=Obstacle("limit", it(_NO_END))),
        replace(
            SETUP,
            problem=Obstacle("unknown", INSTALLS, "CMakeLists.txt"),
        ),
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
        replace(LAUNCH, problem=Obstacle("error", NAME_ERROR, "launch/a.launch.py", 3)),
        replace(LAUNCH, problem=Obstacle("argument", plain_text('Required launch argument "x"'))),
        replace(LAUNCH, problem=Obstacle("unknown", not_there("odd").args[0])),
        replace(LAUNCH, problem=Obstacle("unknown", UNKNOWN)),
    ],
)
def test_what_is_wrong_with_a_launch_file_can_be_said_in_every_language(launch):
    assert_told(_of_package(PackageTrace(SETUP, launches=(launch,), texts=("urdf/a.urdf",))))


def _of_package(trace: PackageTrace) -> list[Message]:
    """What every exercise with a package says of one."""
    alone = Recordings(Recording(trace, scene="package"))
    nothing = drive(lambda tick, now_ns: (), 1, WALKER.setting)
    beside = Recordings(Recording(nothing, scene="robot", package=trace))
    found = [each for exercise in PACKAGES for each in verdicts(exercise, alone)]
    of_both = [v for v in verdicts(WALKER, beside) if v.check in ("package", "launch")]
    return [*texts([*found, *of_both]), *load_subject("package").remarks(trace, (), "")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (it(_NO_END), "it did not come to an end in 20 s of processor time, or 40 s"),
        (it(NONSENSE), "it spoils what is taken down of it"),
        (
            it(FROM_A_LAUNCH_FILE[0].given(length="3,000,000", most="2,000,000")),
            "it hands on a text of 3,000,000 characters; 2,000,000 at most are taken",
        ),
        (
            it(FROM_A_FILE[1].given(most=20)),
            "it is more than 20 descriptions and long texts",
        ),
        (
            it(
                msg(
                    "cannot be evaluated: {why}",
                    why=NO_MODULE,
                )
            ),
            "it cannot be evaluated: there is no module walker.walk",
        ),
        (
            UNKNOWN,
            "it uses OpaqueCoroutine, which the grader does not know",
        ),
    ],
)
def test_a_sentence_of_the_process_that_looks_comes_out_of_it_as_a_message(text, said):
    assert str(text) == said
    assert_told([text])
    made = PackageTrace(SETUP, launches=(replace(LAUNCH, problem=Obstacle("limit", text)),))
    back = decode(encode(made))
    assert back == made
    assert back.sha256() == made.sha256()


def test_a_remark_on_what_is_left_out_can_be_said_in_every_language():
    assert_told([robot_trace._NOT_ALL])


def test_what_python_and_others_say_stays_theirs():
    error = NameError("it {has} a name, as we do: there is none")
    problem = problem_of(error, lambda path: "")
    assert problem.text == plain_text("NameError: it {has} a name, as we do: there is none")


def test_what_a_package_uses_and_the_grader_does_not_know_is_a_message():
    problem = problem_of(not_known("launch.Odd"), lambda path: "")
    assert (problem.kind, problem.text) == ("unknown", not_known("launch.Odd").args[0])


def test_advice_about_launch_files_can_be_said_in_every_language():
    assert_told([advice("TypeError: unexpected keyword argument"), advice("")])


def test_a_clause_that_begins_a_sentence_has_a_capital_in_every_language():
    clauses = [msg("its way is no circle"), msg("it jumps along its circle")]
    assert str(sentence(clauses)) == "Its way is no circle; it jumps along its circle."
    french = "Son trajet n'est pas un cercle\N{NO-BREAK SPACE}; il saute le long de son cercle."
    assert translate(sentence(clauses), "fr") == french
    assert translate(sentence(clauses), "zh") == "它的轨迹不是圆；它沿圆跳跃。"
    assert str(sentence([plain_text("setup.py names nothing")])) == "setup.py names nothing."


def test_a_sentence_that_is_the_same_in_another_language_says_its_values_there():
    movement = msg(
        "{joint!r} {movement}", joint="tilt", movement=msg("stays at {position:.4g}", position=0.5)
    )
    assert translate(movement, "fr") == "'tilt' reste à 0,5"
