"""What DDS is shown of a made class; in a run, see `messages/made_classes`."""

from ctypes import CFUNCTYPE, c_bool, c_void_p, string_at

import pytest

from grader.ros import handles
from grader.ros.definitions import Definitions

TEXTS = {"mine/msg/Num": "int64 num", "mine/srv/Add": "---\n", "mine/action/Count": "---\n---\n"}


def found(address, form):
    """What Fast DDS finds by a handle."""
    find = handles._Find(form.from_address(address).find)
    return form.from_address(find(address, b"rosidl_typesupport_fastrtps_c"))


def names(data):
    return string_at(data.namespace), string_at(data.name)


def support(name):
    return handles._pointer(handles.capsule(Definitions(TEXTS).type(name)), None)


def test_dds_is_shown_the_name_and_refused_the_bytes():
    data = handles._Callbacks.from_address(found(support("mine/msg/Num"), handles._Message).data)
    assert names(data) == (b"mine::msg", b"Num")
    for function in (data.serialise, data.deserialise):
        assert CFUNCTYPE(c_bool, c_void_p, c_void_p)(function)(None, None) is False


@pytest.mark.parametrize(
    ("name", "action_part", "expected"),
    [("mine/srv/Add", "", b"Add"), ("mine/action/Count", "result", b"Count_GetResult")],
)
def test_services_have_parts_of_their_own(name, action_part, expected):
    address = support(name)
    if action_part:
        address = getattr(handles._Action.from_address(address), action_part)
    data = handles._Parts.from_address(found(address, handles._Service).data)
    assert names(data)[1] == expected
    request = handles._Callbacks.from_address(handles._Message.from_address(data.request).data)
    assert names(request)[1] == expected + b"_Request"


def test_another_layout_is_noticed(monkeypatch):
    monkeypatch.setattr(handles, "_Callbacks", handles._struct("name", "namespace"))
    with pytest.raises(NotImplementedError, match="expected a type support of Empty"):
        support("mine/msg/Num")
