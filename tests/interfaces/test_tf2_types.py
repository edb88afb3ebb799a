"""tf2_msgs: the original's types, so that nodes here and there understand each other.

How they travel is tested in tests/tf2.
"""

import json
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_share_directory, get_resource
from tf2_msgs.msg import TF2Error

#: The first as a robot with ROS's own package tells it. The others are what the generator that
#: makes this one makes of the original's definitions.
TYPE_HASHES = {
    "msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "msg/TF2Error": "db2485e7d6a0ec75bf087e058ee45df682acc3a621ca7780503d10aac141809a",
    "srv/FrameGraph": "0d1fbc6222c018ba5f33822904a2fdd4063705289956d3fdde07cd8c50fe8067",
}


@pytest.mark.parametrize("name", TYPE_HASHES)
def test_type_hash_is_that_of_the_original(name):
    file = Path(get_package_share_directory("tf2_msgs"), f"{name}.json")
    hashes = {
        entry["type_name"]: entry["hash_string"]
        for entry in json.loads(file.read_text())["type_hashes"]
    }
    assert hashes[f"tf2_msgs/{name}"] == f"RIHS01_{TYPE_HASHES[name]}"


def test_errors_have_the_originals_numbers():
    names = ("NO", "LOOKUP", "CONNECTIVITY", "EXTRAPOLATION", "INVALID_ARGUMENT", "TIMEOUT")
    numbers = [getattr(TF2Error, f"{name}_ERROR") for name in (*names, "TRANSFORM")]
    assert numbers == [*range(7)]


def test_the_index_lists_the_interfaces():
    listed, _ = get_resource("rosidl_interfaces", "tf2_msgs")
    files = {"msg/TFMessage.msg", "msg/TF2Error.msg", "srv/FrameGraph.srv"}
    assert files <= set(listed.splitlines())
