"""What a hand-in's definitions are, and how they are compared with its exercise's."""

from pathlib import Path

import pytest
import yaml

from grader.errors import SubmissionError
from grader.recording.recording import OwnInterfaces
from grader.run.opening import open_submission
from grader.submission.interfaces import MOST, completed
from tests import runs

NODE = "import rclpy\nfrom mine.msg import Num\n\nrclpy.init()\n"
MANIFEST = """<package format="3"><name>{name}</name><version>0.1.0</version>
<description>d</description><maintainer email="a@b.org">a</maintainer><license>MIT</license>
<depend>rosidl_default_runtime</depend>
<member_of_group>rosidl_interface_packages</member_of_group></package>"""
CMAKE = """project({name})
find_package(rosidl_default_generators REQUIRED)
file(GLOB found RELATIVE ${{CMAKE_CURRENT_SOURCE_DIR}} msg/*.msg)
list(APPEND found ${{more}})
rosidl_generate_interfaces(${{PROJECT_NAME}} ${{found}} ADD_LINTER_TESTS)
"""


def package(folder, texts, name="mine"):
    (folder / "msg").mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(name=name))
    (folder / "CMakeLists.txt").write_text(CMAKE.format(name=name))
    for stem, text in texts.items():
        (folder / "msg" / f"{stem}.msg").write_text(text)


def read(folder, theirs=None):
    (folder / "node.py").write_text(NODE)
    with open_submission(folder, interfaces=theirs or {}) as submission:
        return submission.interfaces, [str(note) for note in submission.notes]


def test_what_cmake_globs_is_generated(tmp_path):
    package(tmp_path / "mine", {"Num": "int8 num\n", "Nums": "Num[] nums\n"})
    found, notes = read(tmp_path)
    assert found.texts == {"mine/msg/Num": "int8 num\n", "mine/msg/Nums": "Num[] nums\n"}
    assert (found.faults, found.unlike, notes) == ({}, {}, [])


def test_they_are_no_missing_modules():
    with open_submission(runs.SUBMISSIONS / "interfaces" / "workspace") as submission:
        assert "tutorial_interfaces" not in {**submission.imports.surely}
        assert "rclpy" in submission.imports.surely


def test_a_program_that_imports_none_has_none(tmp_path):
    package(tmp_path / "others", {"Num": "int8 num\n"}, "others")
    assert read(tmp_path)[0] == OwnInterfaces()


def test_a_copy_of_a_package_of_ros_is_none(tmp_path):
    package(tmp_path / "turtlesim", {"Pose": "int8 x\n"}, "turtlesim")
    package(tmp_path / "mine", {"Num": "int8 num\n"})
    assert list(read(tmp_path)[0].texts) == ["mine/msg/Num"]


@pytest.mark.parametrize(("count", "each"), [(MOST + 5, 10), (50, 1500)])
def test_they_are_bounded_in_number_and_length(tmp_path, count, each):
    text = f"int8 num\n{'# more' * (each // 6)}\n"
    package(tmp_path / "mine", {f"N{n:03}": text for n in range(count)})
    found, _ = read(tmp_path)
    assert len(found.texts) < count == len(found.texts) + len(found.faults)
    assert sum(map(len, found.texts.values())) <= 40_000
    why = {str(fault) for fault in found.faults.values()}
    assert why == {"of its interfaces 100 with 40,000 characters in all are used."}


def test_a_file_that_is_too_long_is_not_taken_for_an_empty_one(tmp_path):
    package(tmp_path / "mine", {"Num": f"{'# more' * 500_000}\nint8 num\n"})
    assert "mine/msg/Num" in read(tmp_path)[0].faults


@pytest.mark.parametrize("data", [b"int8 num\n\xff\xfe\x00 a\n", b"int8 num # Gr\xf6\xdfe\n"])
def test_a_file_that_is_no_utf_8_is_refused_as_ros_does(tmp_path, data):
    package(tmp_path / "mine", {"Num": ""})
    (tmp_path / "mine" / "msg" / "Num.msg").write_bytes(data)
    why = str(read(tmp_path)[0].faults["mine/msg/Num"])
    assert why == "mine/msg/Num.msg is not UTF-8: save it as UTF-8."


FIND = "find_package(rosidl_default_generators REQUIRED)"
IN_CMAKE = yaml.safe_load(Path(__file__).with_name("interfaces.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", IN_CMAKE, ids=range(len(IN_CMAKE)))
def test_cmake_is_followed_as_far_as_colcon_would(tmp_path, case):
    package(tmp_path / "mine", {"Num": "int8 num\n"})
    (tmp_path / "mine" / "CMakeLists.txt").write_text(f"project(mine)\n{case['text']}\n")
    found, _ = read(tmp_path)
    assert case["fault"] in str(found.faults.get("mine/msg/Num", ""))
    assert ("mine/msg/Num" in found.texts) == (case["fault"] == "")


def test_what_lies_elsewhere_is_not_told_to_who_lists_it(tmp_path):
    place = tmp_path / "it"
    package(place / "mine", {"Num": "int8 num\n"})
    (tmp_path / "Secret.msg").write_text("int8 secret\n")
    faults = set()
    for listed in ("../../Secret.msg", "../../Secre.msg", "../../Nothing.msg"):
        text = f"{FIND}\nrosidl_generate_interfaces(${{PROJECT_NAME}} {listed} msg/Num.msg)"
        (place / "mine" / "CMakeLists.txt").write_text(f"project(mine)\n{text}\n")
        fault = str(read(place)[0].faults["mine/msg/Num"])
        faults.add(fault.replace(listed, "LISTED"))
    assert faults == {
        "mine/CMakeLists.txt lists LISTED, and there is no such file. Correct its name."
    }


@pytest.mark.parametrize("how", ["in another package", "ignored", "in what is ignored"])
def test_where_colcon_does_not_look_nothing_is_generated(tmp_path, how):
    folder = tmp_path / "src" / "more" / "mine"
    package(folder, {"Num": "int8 num\n"})
    if how == "in another package":
        (tmp_path / "src" / "more" / "package.xml").write_text(MANIFEST.format(name="more"))
    else:
        place = folder if how == "ignored" else tmp_path / "src"
        (place / "COLCON_IGNORE").touch()
    assert "colcon does not look into" in str(read(tmp_path)[0].faults["mine/msg/Num"])


def test_a_link_to_elsewhere_is_refused(tmp_path):
    (tmp_path / "secret").write_text("int8 secret\n")
    place = tmp_path / "it"
    package(place / "mine", {"Num": "int8 num\n"})
    (place / "mine" / "msg" / "More.msg").symlink_to(tmp_path / "secret")
    with pytest.raises(SubmissionError, match="link to a place outside"):
        read(place)


THEIRS = {
    "mine/msg/Num": "int32 num\n",
    "mine/msg/Nums": "Num[] nums # all\n",
    "mine/msg/Name": "string name\n",
    "course/msg/Hint": "string text\n",
}


def test_a_single_file_gets_those_of_the_exercise(tmp_path):
    found, _ = read(tmp_path, THEIRS)
    assert found == OwnInterfaces(THEIRS)


def test_what_the_exercise_has_otherwise_is_named_with_both_forms():
    own = {
        "mine/msg/Num": "int8 LEAST=1\nint64 num 3\n",
        "mine/msg/Nums": "Num[] nums\n",
        "mine/msg/Name": "# the name\nstring    name\n",
    }
    found = completed(OwnInterfaces(own), THEIRS)
    assert found.texts == {"course/msg/Hint": "string text\n", **own}
    assert {name: str(how) for name, how in found.unlike.items()} == {
        "mine/msg/Num": "Num.msg of mine has `int64 num` where the exercise's has `int32 num`",
        "mine/msg/Nums": "Nums.msg of mine contains a type that the exercise has otherwise",
    }


def test_a_package_that_is_handed_in_takes_the_place_of_the_whole_one():
    found = completed(OwnInterfaces({"mine/msg/Num": "int32 num\n"}), THEIRS)
    assert sorted(found.texts) == ["course/msg/Hint", "mine/msg/Num"]
    assert found.unlike == {}
