"""Interfaces compiled for a run in real time: what DDS carries, and who may touch it."""

import os
import random
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import pytest
import yaml

from grader.recording.recording import OwnInterfaces
from grader.ros import compiler
from grader.ros.definitions import Definitions, slot_of
from grader.ros.messages import installed
from grader.run import compiling, real_time, run_context
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.run.processes import levels
from grader.scenes.scene import Limits
from grader.system import scratch
from grader.text.message import msg
from tests import runs
from tests.grader.ros.comparing import differences
from tests.grader.run.conftest import at_levels
from turtlesim_py.ros import interfaces

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

FOLDER = runs.SUBMISSIONS / "interfaces"
PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=4))

NUM = OwnInterfaces({"demo_interfaces/msg/Num": "string<=4 name\nfloat64[<=3] num\n"})
HEARD = "demo_interfaces.msg.Num(name='it', num=[2.5])"


def run(path, interfaces=None, plan=PLAN):
    with open_submission(path) as submission:
        return real_time.run(
            replace(submission, interfaces=interfaces or submission.interfaces), plan
        )


@pytest.fixture
def sends(tmp_path):
    path = tmp_path / "sends.py"
    path.write_text(TEXTS["sends"])
    return path


compiles = pytest.mark.more("a compiler is needed, and seconds")


@compiles
def test_dds_carries_messages_services_and_actions_of_ones_own():
    recording = run(FOLDER / "workspace")
    assert "The sum is 6" in recording.output  # a service's answer
    assert "All: [0, 1, 1, 2, 3, 5, 8, 13]" in recording.output  # an action's result
    assert recording.run.time == "real"
    assert recording.run.outcome in ("finished", "time_limit")


@compiles
@pytest.mark.parametrize("level", at_levels(*levels.LEVELS))
def test_they_can_be_imported_not_written_into_and_are_kept(level, sends, monkeypatch):
    is_lowest = level == levels.LIMITS
    package = "lowest_interfaces" if is_lowest else "demo_interfaces"
    sends.write_text(TEXTS["sends"].replace("demo_interfaces", package))
    texts = {f"{package}/msg/Num": NUM.texts["demo_interfaces/msg/Num"]}
    levels.only(level)
    try:
        outputs = [run(sends, OwnInterfaces(texts)).output]
        if not is_lowest:  # where nothing is kept for another run
            monkeypatch.setattr(compiling, "_built", None)
            outputs.append(run(sends, OwnInterfaces(texts)).output)
    finally:
        levels.only("")
    for output in outputs:
        assert HEARD.replace("demo_interfaces", package) in output
        assert ("written into" in output) == is_lowest
    assert is_lowest != any(scratch.home().glob(f"interfaces-*/{package}"))


@compiles
def test_a_definition_with_a_mistake_leaves_the_others():
    faults = {"demo_interfaces/msg/Bad": msg("it is wrong")}
    interfaces = OwnInterfaces({**NUM.texts, "demo_interfaces/msg/Bad": "int count\n"}, faults)
    with run_context.open_context() as context:
        _, theirs = compiling.compile_all({}, interfaces, context)
        place = theirs
        names = {each.name for each in (place / "demo_interfaces" / "msg").iterdir()}
        assert names == {"__init__.py", "_num.py"}


def test_without_a_compiler_nothing_is_judged_and_the_way_out_is_told(sends, monkeypatch):
    monkeypatch.setattr(compiler, "missing", lambda: ["gcc", "Python.h of Python 3.12"])
    recording = run(sends, NUM)
    assert recording.run.outcome == "not_run"
    (flag,) = recording.run.flags
    assert str(flag) == (
        "in real time the interfaces of demo_interfaces have to be compiled, and gcc, Python.h of "
        "Python 3.12 is missing here. In virtual time they need not: have one program graded, "
        "without --time real, and take out what virtual time cannot follow, which a remark names"
    )


@pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="ROS's are compiled")
def test_where_turtlesim_s_are_definitions_only_nothing_is_judged_either(sends, monkeypatch):
    monkeypatch.setattr(interfaces, "installed", tuple)
    recording = run(sends, OwnInterfaces({}))
    assert recording.run.outcome == "not_run"
    assert "installed as definitions only" in str(recording.run.flags[0])


def test_what_an_exercise_has_otherwise_is_not_judged(sends):
    unlike = {"demo_interfaces/msg/Num": msg("Num.msg of demo_interfaces has `int8 num` where ...")}
    recording = run(sends, replace(NUM, unlike=unlike))
    assert recording.run.outcome == "not_run"
    assert "take the messages of one for those of the other: Num.msg" in str(recording.run.flags[0])


@compiles
@pytest.mark.parametrize(
    ("limit", "value", "told"),
    [
        ("CPU_S", 0.5, "that takes more time or memory than is allowed"),
        ("LONGEST_S", 0.5, "that takes more time or memory than is allowed"),
        ("BUILT_BYTES", 1000, "it left nothing that can be read: more than 1000 bytes"),
    ],
)
def test_compiling_has_an_end(sends, monkeypatch, limit, value, told):
    monkeypatch.setattr(compiling, limit, value)
    unseen = OwnInterfaces({f"{limit.lower()}/msg/Num": "int8 num\n"})
    recording = run(sends, unseen)
    assert recording.run.outcome == "not_run"
    assert told in str(recording.run.flags[0])


def test_what_is_left_in_another_place_is_refused(tmp_path):
    for path in ("../x.py", "other/x.py", "demo/sub/x.py", "demo/x.pth", "demo/"):
        with pytest.raises(compiling.NotCompiled, match="it left a module"):
            compiling._keep({path: ""}, b"", {"demo"}, tmp_path / "place")


HOSTILE = r"""
string A="\"; #include \"/etc/passwd\" //"
string B='"; system(\"true\"); //'
string C="??/??' %s %n {0} {{ @(1+1) $"
string D='\\\' */ /* __attribute__((constructor))'
string E="</verbatim> @verbatim(language=\"comment\", text=\"\")"
wstring F="\" L\" é 雪"
string attribute "\"; int main;"
string main "'"
string[] includes ["??/", "*/", "%s"]
"""


@compiles
@pytest.mark.applies(metadata.version("rclpy").startswith("7."), reason="Jazzy's classes")
def test_texts_names_and_comments_reach_the_compiler_as_nothing_else(monkeypatch):
    text = HOSTILE.replace("#include", "include") + "int8 last # */ \" ' \\ ??/ #include <x>\n"
    texts = {"hostile_interfaces/msg/Text": text}
    with run_context.open_context() as context:
        interfaces = OwnInterfaces(texts)
        made = Definitions(texts)
        assert not made.errors
        _, theirs = compiling.compile_all({}, interfaces, context)
    monkeypatch.syspath_prepend(str(theirs))
    name = "hostile_interfaces/msg/Text"
    real = installed(slot_of(name))
    found = list(differences(real, made.type(name), random.Random(1), set()))
    assert not found, found[:5]


@compiles
def test_the_import_path_of_ros_stays(tmp_path):
    with run_context.open_context() as context:
        there = replace(context, env={**context.env, "PYTHONPATH": "/opt/ros/x"})
        _, theirs = compiling.compile_all({}, NUM, there)
    path = compiling.importing(theirs, there)["PYTHONPATH"]
    assert path.split(os.pathsep)[1:] == ["/opt/ros/x"]


def test_what_cannot_be_compiled_is_tried_once_for_all_runs_of_a_grading(sends, monkeypatch):
    monkeypatch.setattr(compiler, "missing", list)
    tries = []

    def fails(texts):
        tries.append(texts)
        raise compiling.NotCompiled("the compiler says: {line}", line="no")

    monkeypatch.setattr(compiling, "_built", fails)
    interfaces = OwnInterfaces({"in_vain/msg/Num": "int8 num\n"})
    told = {str(run(sends, interfaces).run.flags[0]) for _ in range(2)}
    assert len(tries) == len(told) == 1
