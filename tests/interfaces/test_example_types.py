"""example_interfaces and action_tutorials_interfaces: the originals' types, which PyPI lacks."""

import importlib
import json
import os
from pathlib import Path

import pytest
from ament_index_python import get_package_share_directory, get_resource
from example_interfaces import msg

#: As ROS 2 Jazzy publishes it.
ADD_TWO_INTS = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"


def test_the_service_of_the_tutorials_has_the_original_s_type_hash():
    file = Path(get_package_share_directory("example_interfaces"), "srv", "AddTwoInts.json")
    hashes = json.loads(file.read_text())["type_hashes"]
    assert {each["type_name"]: each["hash_string"] for each in hashes}[
        "example_interfaces/srv/AddTwoInts"
    ] == ADD_TWO_INTS


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
