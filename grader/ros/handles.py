"""Type supports for classes without one: copies of std_msgs/Empty's under other names.

rclpy's C++ makes an entity of DDS by them, so that the graph shows it with its type. No message
goes that way: none is converted to C, and these refuse to serialise. The structs are those of
rosidl_runtime_c and rosidl_typesupport_fastrtps_c, Jazzy's.
"""

from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, addressof, c_char_p, c_void_p, py_object, pythonapi
from typing import Any, Final

_FASTRTPS: Final = b"rosidl_typesupport_fastrtps_c"
#: A handle, an identifier -> the handle for that.
_Find: Any = CFUNCTYPE(c_void_p, c_void_p, c_char_p)
_refuse: Final = CFUNCTYPE(ctypes.c_bool, c_void_p, c_void_p)(lambda value, cdr: False)
#: What C points to.
_kept: Final[list[Any]] = []
_new, _pointer = pythonapi.PyCapsule_New, pythonapi.PyCapsule_GetPointer
_new.restype, _new.argtypes = py_object, [c_void_p, c_char_p, c_void_p]
_pointer.restype, _pointer.argtypes = c_void_p, [py_object, c_char_p]


def _struct(*fields: str) -> Any:
    return type(
        "Struct", (ctypes.Structure,), {"_fields_": [(field, c_void_p) for field in fields]}
    )


_Message = _struct("identifier", "data", "find", "hash", "description", "sources")
_Service = _struct(
    *("identifier", "data", "find", "request", "response", "event", "create", "destroy"),
    *("hash", "description", "sources"),
)
_Action = _struct(
    *("goal", "result", "cancel", "feedback", "status", "hash", "description", "sources")
)
#: What `data` of a message and of a service points to.
_Callbacks = _struct("namespace", "name", "serialise", "deserialise", "size", "most", "key")
_Parts = _struct("namespace", "name", "request", "response")


def capsule(kind: Any) -> Any:
    """Return a type support for a message, a service or an action, as `_TYPE_SUPPORT` has it.

    Raises:
        NotImplementedError: this release of ROS has other structs.
    """
    namespace, name = "::".join(kind.__module__.split(".")[:2]), kind.__name__
    if hasattr(kind, "SLOT_TYPES"):
        return _new(_message(namespace, name)[0], None, None)
    if hasattr(kind, "Request"):
        return _new(_service(namespace, name), None, None)
    from action_msgs.msg import GoalStatusArray
    from action_msgs.srv import CancelGoal
    from std_msgs.msg import Empty

    empty = _Message.from_address(_address(Empty))
    made = _Action(
        _service(namespace, f"{name}_SendGoal"),
        _service(namespace, f"{name}_GetResult"),
        _address(CancelGoal),
        _message(namespace, f"{name}_FeedbackMessage")[0],
        _address(GoalStatusArray),
        *(empty.hash, empty.description, empty.sources),
    )
    _kept.append(made)
    return _new(addressof(made), None, None)


def _message(namespace: str, name: str) -> tuple[int, int]:
    """Make the handle of a message; return its address, and that of what it finds."""
    from std_msgs.msg import Empty

    handle, found, data = _copied(Empty, _Message, _Callbacks, namespace, name)
    data.serialise = data.deserialise = ctypes.cast(_refuse, c_void_p)
    return addressof(handle), addressof(found)


def _service(namespace: str, name: str) -> int:
    from std_srvs.srv import Empty

    handle, found, data = _copied(Empty, _Service, _Parts, namespace, name)
    for part in ("request", "response", "event"):
        address, own = _message(namespace, f"{name}_{part.capitalize()}")
        setattr(handle, part, address)
        setattr(found, part, address)
        if part != "event":
            setattr(data, part, own)
    return addressof(handle)


def _copied(empty: Any, form: Any, form_of_data: Any, namespace: str, name: str) -> Any:
    """Copy the handle of an empty type, what it finds for Fast DDS, and that one's data."""
    address = _address(empty)
    handle = form.from_buffer_copy(form.from_address(address))
    theirs = _Find(handle.find)
    found = form.from_buffer_copy(form.from_address(theirs(address, _FASTRTPS)))
    data = form_of_data.from_buffer_copy(form_of_data.from_address(found.data))
    names = ctypes.string_at(found.identifier), ctypes.string_at(data.name)
    if names != (_FASTRTPS, b"Empty"):
        raise NotImplementedError(f"expected a type support of Empty, found {names}")
    texts = [ctypes.create_string_buffer(text.encode()) for text in (namespace, name)]
    data.namespace, data.name = map(addressof, texts)
    found.data, own = addressof(data), addressof(found)
    # Fast DDS also asks for the fields: they stay those of the empty one
    find = _Find(lambda _, wanted: own if wanted == _FASTRTPS else theirs(address, wanted))
    handle.find = found.find = ctypes.cast(find, c_void_p)
    _kept.extend((handle, found, data, find, *texts))
    return handle, found, data


def _address(kind: Any) -> int:
    if type(kind)._TYPE_SUPPORT is None:
        type(kind).__import_type_support__()
    return int(_pointer(type(kind)._TYPE_SUPPORT, None))
