"""A package that does what none should: a line says what, and nothing of ours fails."""

import json
import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from grader.submission import safe_files
from grader.submission.answer import SetUpFacts
from grader.submission.examining import main, steps
from grader.submission.examining.steps import (
    NONSENSE,
    Ended,
    end_of,
    it,
    problem_of,
    start_of,
    step,
)
from grader.submission.package_trace import FAILED, PackageTrace, decode, encode
from grader.system.strict_json import from_json
from grader_robots.inspection import meshes
from tests.grader_robots.packages import INSPECTORS, REFERENCE, looked_at, written

DISPLAY = "launch/display.launch.py"
SETUP = (REFERENCE / "setup.py").read_text(encoding="utf-8")
LISTS = "data_files=["
ANSWER = {
    "name": "a",
    "data_files": [{"folder": "share/a", "files": ["package.xml"]}],
    "scripts": ["a = a:main"],
    "plain_scripts": [],
    "packages": None,
    "package_folders": [],
    "scripts_folder": "lib/a",
    "has_commands": False,
}


def found(folder: Path, files: dict[str, str]) -> PackageTrace:
    """What is found of the reference with other files, as it comes through to the grader."""
    trace = looked_at(written(folder, files))
    assert decode(encode(trace)) == trace
    return trace


@pytest.mark.parametrize("folder", ["", "/share", "/../empty", "/.."])
def test_a_launch_file_that_takes_away_what_is_installed_is_named(folder, tmp_path):
    code = (
        "import os, shutil\n"
        "shutil.rmtree(os.environ['AMENT_PREFIX_PATH'].split(':')[0] "
        f"+ {folder!r}, ignore_errors=True)\n"
    )
    text = (REFERENCE / DISPLAY).read_text(encoding="utf-8")
    first, then = found(tmp_path, {DISPLAY: f"{code}\n{text}"}).launches
    gone = "~" if "empty" in folder else "share/walker_description/package.xml"
    assert str(first.problem.text) == f"it takes away {gone}"
    assert str(then.problem.text) == f"it cannot be evaluated: {DISPLAY} has taken away {gone}"


def test_names_that_no_file_can_have_are_files_that_are_not_there(tmp_path):
    odd = (
        f'{LISTS}("share/" + "x" * 5000, ["setup.py"]), ("share/y", ["y" * 5000, "a\\0b"]), '
        '("share/walker_description/package.xml/a", ["setup.py"]),'
    )
    scripts = 'scripts=["s" * 5000], entry_points={"console_scripts": ["a = " + "b.c" * 900]} or {'
    text = SETUP.replace(LISTS, odd).replace("entry_points={", scripts)
    trace = found(tmp_path, {"setup.py": text})
    assert trace.setup.problem is None
    assert [name[:1] for name in trace.setup.absent] == ["y", "a"]
    assert trace.setup.scripts[0].fault


DEEP = "/".join(["d" * 200] * 12)  # a path that the system takes, and longer than an answer's


@pytest.mark.parametrize(
    "line",
    [
        f'("share/{DEEP}", ["package.xml"]),',
        f'*(os.makedirs("{DEEP}"), open("{DEEP}/a", "w"), [("share/a", ["{DEEP}/a"])])[2],',
    ],
    ids=["target", "folder"],
)
def test_a_set_up_with_long_paths_is_looked_at(line, tmp_path):
    text = SETUP.replace(LISTS, f"{LISTS}{line}").replace("from glob", "import os\nfrom glob")
    trace = found(tmp_path, {"setup.py": text})
    assert trace.setup.problem is None
    assert [each.problem for each in trace.launches] == [None, None]


def test_a_package_that_lies_three_hundred_folders_deep_is_looked_at(tmp_path):
    folder = tmp_path / Path(*["d" * 7] * 300)
    folder.mkdir(parents=True)
    written(folder, {})
    assert [each.problem for each in looked_at(tmp_path).launches] == [None, None]


def test_a_package_xml_that_is_longer_than_any_is_taken_in_part(tmp_path):
    text = (REFERENCE / "package.xml").read_text(encoding="utf-8")
    more = "".join(f"<depend>d{n}</depend>" for n in range(9000))
    name = f"<name>../../../{'a' * 5000}"
    text = text.replace("</package>", f"{more}</package>")
    trace = found(tmp_path, {"package.xml": text.replace("<name>walker_description", name)})
    assert trace.setup.name.startswith("../../../aaa") and len(trace.setup.depends) <= 1000


def test_a_description_that_is_longer_than_any_is_told_so(tmp_path):
    code = (
        "from launch import LaunchDescription\n"
        "from launch_ros.actions import Node\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([Node(package='robot_state_publisher',\n"
        "        executable='robot_state_publisher',\n"
        "        parameters=[{'robot_description': 'a' * 3_000_000}])])\n"
    )
    problem = found(tmp_path, {DISPLAY: code}).launches[0].problem
    assert "a text of 3,000,000 characters; 2,000,000 at most" in str(problem.text)


ROOT = "/".join([".."] * 40)
#: A name that a description gives a mesh -> what becomes of it.
MESHES = {
    "package://walker_description/meshes/camera.stl": "found",
    "package://walker_description/../walker_description/meshes/camera.stl": "found",
    f"package://walker_description/{ROOT}/etc/passwd": "missing",
    "package://walker_description//etc/passwd": "missing",
    f"file:///opt/ros/jazzy/{ROOT}/etc/passwd": "missing",
    "file:///dev/zero": "missing",
    "file:///opt/ros/jazzy/share/none/a.stl": "foreign",
    "package://../a.stl": "package",
    "package://./a.stl": "package",
    f"package://walker_description/{'a' * 300}.stl": "missing",
    f"package://{'a' * 300}/a.stl": "package",
    "file://meshes/camera.stl": "scheme",
    "http://127.0.0.1:1/a.stl": "scheme",
}


def test_a_mesh_counts_as_found_where_the_package_installs_it(tmp_path):
    shapes = (f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in MESHES)
    robot = f'<robot name="a"><link name="base">{"".join(shapes)}</link></robot>'
    trace = found(tmp_path, {"urdf/walker.urdf.xacro": robot})
    assert [each.problem for each in trace.launches] == [None, None]
    (description,) = trace.descriptions
    assert {uri: mesh.state for uri, mesh in zip(MESHES, description.meshes, strict=True)} == MESHES


def test_meshes_are_read_last_and_by_an_account_of_their_own(tmp_path, monkeypatch):
    monkeypatch.setattr(meshes, "CPU_S", -1.0)
    monkeypatch.setattr(steps, "_account", None)  # as before, afterwards
    trace = main.inspect(REFERENCE, tmp_path, inspectors=INSPECTORS).trace
    assert [each.problem for each in trace.launches] == [None, None]
    assert [each.state for each in trace.descriptions[0].meshes] == ["found"]
    assert trace.surfaces == ()


def open_descriptors() -> set[int]:
    found = set()
    for descriptor in (int(each.name) for each in Path("/proc/self/fd").iterdir()):
        with suppress(OSError):  # the one for this list
            os.fstat(descriptor)
            found.add(descriptor)
    return found


@pytest.mark.parametrize(
    "forged", [b"[1]", b"{}", b'{"problem": {"x": 1}}', b'{"problem": 3}', b"\xff", b"[" * 100_000]
)
def test_an_answer_that_is_forged_is_none(forged):
    others = open_descriptors()  # which are the tests' own

    def forge():
        for descriptor in open_descriptors() - others:
            with suppress(OSError):
                os.write(descriptor, b"=" + len(forged).to_bytes(8, "little") + forged)

    with pytest.raises(Ended) as ended:
        step(forge, str)
    assert ended.value.problem.text == it(NONSENSE)


def test_what_a_step_forks_does_not_answer_for_it():
    def fork():
        child = os.fork()
        if child:
            os.waitpid(child, 0)
        return child > 0

    assert step(fork, str) is True


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("name", 3),
        ("scripts", 5),
        ("scripts", [5]),
        ("packages", 1),
        ("scripts_folder", None),
        ("data_files", [{"folder": "share/a", "files": "package.xml"}]),
        ("data_files", [{"folder": "share/a"}]),
    ],
)
def test_only_what_has_the_form_of_an_answer_is_one(key, value):
    assert from_json(SetUpFacts, ANSWER).scripts == ("a = a:main",)
    for forged in ({**ANSWER, key: value}, []):
        with pytest.raises(ValueError, match="expected"):
            from_json(SetUpFacts, forged)


def test_texts_that_are_cut_have_no_part_of_a_path_and_no_address():
    path = "/tmp/package-abcdefgh/prefix/a.xacro"
    assert start_of(f"in {path} there", 20) == "in"
    assert end_of(f"there in {path} is", 20) == "is"
    assert start_of("a" * 30, 20) == end_of("a" * 30, 20) == "a" * 20
    assert start_of(path, 50) == end_of(path, 50) == path
    problem = problem_of(ValueError(f"found {object()}"), str)
    assert str(problem.text) == "ValueError: found <object object at 0x...>"


def test_a_step_that_waits_in_vain_is_ended_and_after_some_no_other_is_tried(tmp_path, monkeypatch):
    monkeypatch.setattr(steps, "STEP_IDLE_S", 0.1)
    monkeypatch.setattr(steps, "IDLE_S", 0.6)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    steps.open_account()

    def naps_without_end():
        while True:
            time.sleep(0.01)

    def why(work):
        with pytest.raises(Ended) as ended:
            step(work, str)
        return str(ended.value.problem.text)

    assert why(pipe.read_text) == "it waited for what did not come"
    assert step(lambda: sum(range(10**6)) > 0, str)  # which waits for nothing
    assert why(naps_without_end) == "it waited for what did not come"
    assert why(lambda: 1).startswith("it was not tried: the package had taken 120 s")
    steps.open_account()
    assert step(lambda: 1, str) == 1


def test_nothing_is_waited_for_that_is_no_file(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), tmp_path, tmp_path / "none"):
        with pytest.raises(OSError, match=r".+"):
            safe_files.read(path, 10)
    assert not safe_files.is_file(tmp_path / ("a" * 5000))
    assert not safe_files.is_folder(tmp_path / "a\0b")


def test_what_fails_in_the_grader_ends_with_a_code_of_its_own():
    order = json.dumps({"root": str(REFERENCE)})
    ended = subprocess.run([sys.executable, main.__file__, order], capture_output=True, check=False)
    assert ended.returncode == FAILED
