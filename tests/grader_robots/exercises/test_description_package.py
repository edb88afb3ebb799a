"""Packages lose what they should, and the first line names why."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from grader.judging import judge
from grader.submission.package_trace import LaunchFile, Obstacle
from grader.text.message import msg
from tests.grader_robots.packages import (
    EXERCISE,
    FOLDER,
    HANDED_IN,
    REFERENCE,
    SOLUTIONS,
    graded,
    looked_at,
    lost,
    recorded,
    written,
)
from tests.tiers import others_are_more

DISPLAY, XACRO = "launch/display.launch.py", "urdf/walker.urdf.xacro"
NO_SPAWN: dict[str, str | None] = {"launch/spawn.launch.py": None}
GRADED, OTHERS = yaml.safe_load(
    Path(__file__).with_name("first_lines.yaml").read_text(encoding="utf-8")
).values()
FIRST_LINES = GRADED | OTHERS


def changed(folder: Path, file: str, old: str, new: str, **more: str | None) -> Path:
    """The reference with a passage of a file replaced, and without other files."""
    text = (REFERENCE / file).read_text()
    assert old in text
    return written(folder, {file: text.replace(old, new), **more})


@pytest.mark.parametrize(
    "name", others_are_more("by the same check as another mistake", FIRST_LINES, *GRADED)
)
def test_the_first_line_of_a_mutant_names_its_mistake(name, tmp_path):
    solution = SOLUTIONS[name]
    result = graded(solution.lay_out(tmp_path))
    assert FIRST_LINES[name] in str(result.diagnosis.cause)
    left = lost(result)
    assert left.keys() == solution.leaves.keys()
    for check, share in solution.leaves.items():
        assert share == "some" or left[check] == pytest.approx(share, abs=0.001)


@pytest.mark.parametrize(
    "name",
    others_are_more(
        "half a second each; the reference is graded by each make test",
        [name for name, each in SOLUTIONS.items() if each.is_right],
        *("xml", "cmake", "description_apart"),
    ),
)
def test_a_right_solution_keeps_all_points(name, tmp_path):
    assert lost(graded(SOLUTIONS[name].lay_out(tmp_path))) == {}


@pytest.mark.parametrize("name", HANDED_IN)
def test_a_tutorial_that_is_followed_keeps_all_points(name):
    assert lost(graded(FOLDER / name)) == {}


def test_a_description_as_an_argument_is_read_with_a_remark(tmp_path):
    files = {"urdf/plain.urdf": "<robot name='r'><link name='a'/></robot>"}
    text = (REFERENCE / DISPLAY).read_text()
    text = text.replace('parameters=[{"robot_description": description}]', "arguments=[model]")
    files[DISPLAY] = text.replace("walker.urdf.xacro", "plain.urdf")
    trace = looked_at(written(tmp_path, files))
    assert lost(judge(recorded(trace), EXERCISE)) == {}
    assert "as a file, which it still reads" in str(trace.launches[0].remarks[0])


def as_it_stands():
    """The reference's launch file, which hands the description on without xacro."""
    return (
        (REFERENCE / DISPLAY)
        .read_text()
        .replace('Command(["xacro ", model])', "open(model).read()")
    )


COMMENT = "<!-- <xacro:include filename='$(find x)/y'/> ${z} <!DOCTYPE -- <link name='n'/> -->"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<link name='a'/>", f"{COMMENT}<link name='a'/>"),  # which only urdfdom takes for one
        ("name='a'", "name='${namespace}a'"),
        ("</robot>", "<gazebo><a:camera b='${c}'/></gazebo></robot>"),  # of an unbound prefix
    ],
)
def test_a_description_that_urdfdom_takes_keeps_all_points(old, new, tmp_path):
    robot = "<robot name='r'><link name='a'/></robot>".replace(old, new)
    without: dict[str, str | None] = {"urdf/plain.urdf": robot, **NO_SPAWN, XACRO: None}
    launch = as_it_stands().replace("walker.urdf.xacro", "plain.urdf")
    assert lost(graded(written(tmp_path / "launched", {**without, DISPLAY: launch}))) == {}
    assert "urdf" not in lost(graded(written(tmp_path / "alone", {**without, DISPLAY: None})))


@pytest.mark.parametrize(
    "left",
    [
        "<xacro:wheel/>",
        "<link name='b'><visual><geometry><mesh filename='${c}'/></geometry></visual></link>",
        "<link name='b'><inertial><mass value='$(arg m)'/></inertial></link>",
    ],
)
def test_what_xacro_should_have_replaced_is_told(left, tmp_path):
    files = {XACRO: f"<robot name='r'><link name='a'/>{left}</robot>", DISPLAY: as_it_stands()}
    result = graded(written(tmp_path, files))
    assert lost(result)["urdf"] == 0
    assert "xacro has not been run on it" in str(result.diagnosis.cause)


def test_launch_files_may_lie_in_a_package_beside(tmp_path):
    folder = tmp_path / "workspace"
    written(folder / "a", {DISPLAY: None, "launch/spawn.launch.py": None})
    manifest = (REFERENCE / "package.xml").read_text()
    for word in ("walker_description", "<exec_depend>rviz2</exec_depend>"):
        manifest = manifest.replace(word, word.replace("description", "bringup"))
    cmake = "project(walker_bringup)\ninstall(DIRECTORY launch DESTINATION share/walker_bringup)\n"
    bringup = folder / "walker_bringup"
    (bringup / "launch").mkdir(parents=True)
    (bringup / "package.xml").write_text(manifest.replace("ament_python", "ament_cmake"))
    (bringup / "CMakeLists.txt").write_text(cmake)
    (bringup / "launch" / "show.py").write_text((REFERENCE / DISPLAY).read_text())
    trace = looked_at(folder)
    assert trace.setup is not None and trace.setup.name == "walker_description"
    assert [launch.file for launch in trace.launches] == ["walker_bringup/launch/show.py"]
    assert lost(judge(recorded(trace), EXERCISE)) == {}


def test_rviz_as_a_plain_program_is_rviz(tmp_path):
    text = (REFERENCE / DISPLAY).read_text()
    node = 'Node(package="rviz2", executable="rviz2", arguments=["-d", settings])'
    head = "from launch.actions import ExecuteProcess\n"
    for words, left in (('["rviz2", "-d", settings]', {}), ('["rviz2"]', {"launch": 0.75})):
        changed = head + text.replace(node, f"ExecuteProcess(cmd={words})")
        assert lost(graded(written(tmp_path / str(len(words)), {DISPLAY: changed}))) == left


def test_a_copy_of_the_package_that_was_left_within_it_costs_nothing(tmp_path):
    package = written(tmp_path, {})
    shutil.copytree(REFERENCE, package / "old", ignore=shutil.ignore_patterns("__pycache__"))
    assert lost(graded(package)) == {}


def test_a_byte_order_mark_is_no_fault_of_a_launch_file(tmp_path):
    text = (REFERENCE / DISPLAY).read_text()
    assert lost(graded(written(tmp_path, {DISPLAY: f"\ufeff{text}"}))) == {}


def test_the_starter_is_told_what_to_begin_with():
    result = graded(EXERCISE.starter)
    assert lost(result)["launch"] == 0
    assert "starts no robot_state_publisher" in str(result.diagnosis.cause)


def test_a_name_of_launch_that_nobody_knows_is_not_judged_and_never_failed(tmp_path):
    names = ("import Command, Launch", "import Wondrous, Command, Launch")
    result = graded(changed(tmp_path, DISPLAY, *names, **NO_SPAWN))
    verdicts = {verdict.check: verdict for verdict in result.verdicts}
    assert verdicts["launch"].status == "not_judged"
    assert "failed" not in {verdict.status for verdict in result.verdicts}
    unknown = "launch.substitutions.Wondrous, which the grader does not know"
    assert unknown in str(verdicts["launch"].rationale)


def test_a_package_whose_launch_files_are_not_known_fails_no_check_for_it():
    whole, failed = looked_at(REFERENCE), {}
    for kind in ("unknown", "argument", "error"):
        obstacle = Obstacle(kind, msg("it ends"))
        launches = tuple(LaunchFile(each.file, obstacle) for each in whole.launches)
        trace = replace(whole, launches=launches, descriptions=())
        verdicts = judge(recorded(trace), EXERCISE).verdicts
        failed[kind] = {v.check for v in verdicts if v.status == "failed"}
    assert failed["unknown"] == failed["argument"] == set()
    assert "launch" in failed["error"]


def test_a_file_of_another_package_is_nobody_s_fault(tmp_path):
    other = 'get_package_share_directory("ur_description"), "urdf", "ur.urdf.xacro"'
    package = changed(tmp_path, DISPLAY, 'share, "urdf", "walker.urdf.xacro"', other, **NO_SPAWN)
    result = graded(package)
    status = {verdict.check: verdict.status for verdict in result.verdicts}
    assert status["launch"] == "not_judged"
    assert status["installed"] == "passed"


MESH = "package://walker_description/meshes/camera.stl"
FIXED = '<joint name="fin" type="fixed"><parent link="base_link"/><child link='
BASE = '<link name="base_link"/>'


@pytest.mark.parametrize(
    ("old", "new", "left", "said"),
    [
        (
            *("</robot>", f'<link name="f"/>{FIXED}"f"/><origin rpy="90 0 0"/></joint></robot>'),
            *({"urdf": 0.5}, "'fin' is turned by 90 rad, as if in degrees"),
        ),
        (
            *("</robot>", f'{FIXED}"camera"/></joint></robot>'),  # of which urdfdom is silent
            *({"urdf": 0.5}, "'camera' hangs on 2 joints"),
        ),
        (MESH, "file:///home/me/meshes/camera.stl", {"meshes": 0}, "a path of one machine"),
        (
            *(MESH, "package://walker_description/camera.stl", {"meshes": 0}),
            f"camera.stl is installed as {MESH}",
        ),
        (
            *(BASE, f"<?xacro?>{BASE}", dict.fromkeys(("urdf", "launch", "meshes", "spawn"), 0)),
            "take the other away",
        ),
    ],
)
def test_a_fault_of_the_description_is_told_as_what_it_is(old, new, left, said, tmp_path):
    result = graded(changed(tmp_path, XACRO, old, new))
    assert lost(result) == left
    assert said in f"{result.diagnosis.cause!s} {result.diagnosis.help!s}"


def test_who_asks_for_what_is_not_there_is_told_with_the_line(tmp_path):
    package = changed(tmp_path, DISPLAY, '"walker.rviz"', '"wolker.rviz"')
    lines = (package / DISPLAY).read_text().splitlines()
    line = 1 + next(number for number, each in enumerate(lines) if "wolker" in each)
    assert f"{DISPLAY} (line {line}) asks for" in str(graded(package).diagnosis.cause)
