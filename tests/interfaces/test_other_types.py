"""tf2_msgs and the interfaces of examples, which PyPI lacks: the originals' types.

How those of tf2 travel is tested in tests/tf2.
"""

import importlib
import os

import pytest
from ament_index_python import get_resource
from example_interfaces import msg
from tf2_msgs.msg import TF2Error

from tests.interfaces.test_turtlesim_types import type_hash

#: The first two as ROS 2 Jazzy tells them. The others are what the generator that makes these makes
#: of the original's definitions.
TYPE_HASHES = {
    ("example_interfaces", "srv/AddTwoInts"): (
        "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    ),
    ("tf2_msgs", "msg/TFMessage"): (
        "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
    ),
    ("tf2_msgs", "msg/TF2Error"): (
        "db2485e7d6a0ec75bf087e058ee45df682acc3a621ca7780503d10aac141809a"
    ),
    ("tf2_msgs", "srv/FrameGraph"): (
        "0d1fbc6222c018ba5f33822904a2fdd4063705289956d3fdde07cd8c50fe8067"
    ),
}


@pytest.mark.parametrize(("package", "name"), TYPE_HASHES)
def test_type_hash_is_that_of_the_original(package, name):
    assert type_hash(package, name) == f"RIHS01_{TYPE_HASHES[package, name]}"


def test_errors_of_tf2_have_the_originals_numbers():
    names = ("NO", "LOOKUP", "CONNECTIVITY", "EXTRAPOLATION", "INVALID_ARGUMENT", "TIMEOUT")
    numbers = [getattr(TF2Error, f"{name}_ERROR") for name in (*names, "TRANSFORM")]
    assert numbers == [*range(7)]


@pytest.mark.parametrize("name", [name for name in dir(msg) if name[0].isupper()])
def test_a_message_has_the_fields_of_its_namesake_in_std_msgs(name):
    ours = getattr(msg, name)
    if name == "WString":
        assert ours.get_fields_and_field_types() == {"data": "wstring"}
        return
    theirs = getattr(importlib.import_module("std_msgs.msg"), name)
    fields = str(theirs.get_fields_and_field_types()).replace("std_msgs", "example_interfaces")
    assert str(ours.get_fields_and_field_types()) == fields


@pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="the original's may have more")
def test_the_index_lists_them():
    listed, _ = get_resource("rosidl_interfaces", "example_interfaces")
    assert len([line for line in listed.split() if not line.endswith(".idl")]) == 33
    listed, _ = get_resource("rosidl_interfaces", "action_tutorials_interfaces")
    assert listed.split() == ["action/Fibonacci.action", "action/Fibonacci.idl"]
    listed, _ = get_resource("rosidl_interfaces", "tf2_msgs")
    assert {"msg/TFMessage.msg", "msg/TF2Error.msg", "srv/FrameGraph.srv"} <= {*listed.split()}
