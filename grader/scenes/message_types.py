"""The types of a scene's messages for rosbags, made of their definitions alone.

rosbags brings the types of ROS 2 Jazzy, but to import them takes longer than a run's verdict: they
stand on those of each release before.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore


def types_of(definitions: Mapping[str, str]) -> Typestore:
    """The types that are defined, and those of builtin_interfaces.

    Args:
        definitions: ROS type -> the text of its .msg; also of the types of its fields.
    """
    return _store(tuple(definitions.items()))


@cache  # what (de)serializes a type is compiled once a store
def _store(definitions: tuple[tuple[str, str], ...]) -> Typestore:
    types = get_typestore(Stores.EMPTY)
    for msgtype, text in definitions:
        types.register(get_types_from_msg(text, msgtype))
    return types
