"""A bag's types have the hashes that ROS publishes, and the texts and messages of rosbags."""

import json
import re
from pathlib import Path

import pytest
from ament_index_python.packages import get_search_paths
from rosbags.typesys import Stores, get_typestore

from grader.ros.bag_types import OF_ROS, BagTypes
from grader.ros.cdr import MARK
from grader.ros.messages import make, serialise
from grader.scenes.cast.recorder import Types
from tests.grader.recording.slow_bag import plain, types_of

PACKAGES = Path(__file__).parents[3] / "interfaces" / "packages"
FILES = {
    "/".join((*file.parts[-3:-1], file.stem)): file
    for prefix in reversed(get_search_paths())
    for file in Path(prefix, "share").glob("*/msg/*.msg")
    if not re.search(r"(?m)^\s*wstring", file.read_text(encoding="utf-8"))
}
TEXTS = {name: file.read_text(encoding="utf-8") for name, file in FILES.items()}
INSTALLED = BagTypes(TEXTS)


def test_the_hashes_are_those_that_are_published_with_the_installed_interfaces():
    assert len(FILES) > 100
    for name, file in FILES.items():
        published = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
        (expected,) = (
            each["hash_string"] for each in published["type_hashes"] if each["type_name"] == name
        )
        assert INSTALLED.type_hash(name) == expected, name


def test_those_of_ros_are_jazzy_s_and_our_turtlesim_s():
    jazzy, known = get_typestore(Stores.ROS2_JAZZY), BagTypes({})
    for name in OF_ROS:
        if name.startswith("turtlesim/"):
            text = (PACKAGES / f"{name}.msg").read_text(encoding="utf-8")
            assert known.definition(name) == BagTypes({name: text}).definition(name)
        else:
            assert known.type_hash(name) == jazzy.hash_rihs01(name)
            assert known.definition(name) == jazzy.generate_msgdef(name, ros_version=2)[0]


def test_the_definitions_are_those_that_rosbags_writes():
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    compared = 0
    for name in FILES.keys() & jazzy.fielddefs.keys():
        text, _ = jazzy.generate_msgdef(name, ros_version=2)
        # newer releases add fields; of some constants rosbags writes another form
        if jazzy.hash_rihs01(name) == INSTALLED.type_hash(name) and "=" not in text.replace(
            "=" * 80, ""
        ):
            assert INSTALLED.definition(name) == text
            compared += 1
    assert compared > 60


TRANSFORM = {
    "header": {"stamp": {"sec": -1, "nanosec": 2}, "frame_id": "wörld"},
    "transform": {"rotation": {"w": 0.5}},
}
MESSAGES = {
    "tf2_msgs/msg/TFMessage": {"transforms": [TRANSFORM] * 3},
    "sensor_msgs/msg/LaserScan": {"range_max": 0.1, "ranges": [1.0, float("inf")]},
    "sensor_msgs/msg/JointState": {"name": ["a", ""], "position": [1e300]},
    "sensor_msgs/msg/Image": {"data": [0, 255]},
    "geometry_msgs/msg/PoseWithCovariance": {"covariance": [float(n) for n in range(36)]},
    "std_msgs/msg/Byte": {"data": 200},
    "std_msgs/msg/Bool": {"data": True},
}


@pytest.mark.parametrize("name", MESSAGES)
def test_messages_are_read_as_rosbags_reads_them(name):
    types = Types({})
    data = serialise(make(types.use(name), MESSAGES[name]))
    theirs = types_of(types.used).deserialize_cdr(data, name)
    assert BagTypes(types.used).values(data, name) == INSTALLED.values(data, name) == plain(theirs)


def test_the_language_is_read_without_its_comments_and_defaults():
    types = BagTypes(
        {
            "own/msg/All": "# all\nint8 ONE = 1  # one\nfloat64[<=2] few [1., 2.]\n\tInner[3] in\n",
            "own/msg/Inner": "string<=5 brief 'x'\nstring<=5[] many\nother/Empty no\n",
            "other/msg/Empty": "",
        }
    )
    assert types.definition("own/msg/All") == (
        "int8 ONE=1\nfloat64[<=2] few\nown/Inner[3] in\n" + "=" * 80 + "\nMSG: own/Inner\n"
        "string<=5 brief\nstring<=5[] many\nother/Empty no\n" + "=" * 80 + "\nMSG: other/Empty\n"
    )


DAMAGED = {
    "a type that is nowhere": ({"own/msg/A": "B b"}, "there is no definition of own/msg/B"),
    "no type": ({"own/msg/A": "x"}, "expected a type and a name, found 'x'"),
    "each other": ({"own/msg/A": "B[] b", "own/msg/B": "A a"}, "at most 64 messages within each"),
    "more than there is": ({"own/msg/A": "float64[4000000000] a"}, "cut off"),
    "texts without end": ({"own/msg/A": "string[4000000000] a"}, "no end"),
    "a length that is none": ({"own/msg/A": f"int8[{'9' * 5000}] a"}, "a type and a name, found"),
}


@pytest.mark.parametrize("what", DAMAGED)
def test_what_is_damaged_is_told_at_once(what):
    texts, why = DAMAGED[what]
    with pytest.raises(ValueError, match=why):
        BagTypes(texts).values(MARK + bytes(8), "own/msg/A")


@pytest.mark.parametrize("data", [b"", b"\0\0\0\0", MARK, MARK + b"\5\0\0\0abc\0"])
def test_bytes_that_are_no_message_are_refused(data):
    with pytest.raises(ValueError):
        BagTypes({"std_msgs/msg/String": "string data"}).values(data, "std_msgs/msg/String")
