"""Launch files in YAML: the same entities as in XML, and read as such."""

from __future__ import annotations

import json
from typing import Any
from xml.etree import ElementTree

import yaml

from grader.inspection.examining.xml_launch import action


def entities(path: str) -> list[Any]:
    """The actions of a launch file.

    Raises:
        Exception: it is not what ROS reads.
    """
    with open(path, encoding="utf-8") as file:
        data = yaml.safe_load(file)
    if not isinstance(data, dict) or list(data) != ["launch"]:
        found = ", ".join(map(str, data)) if isinstance(data, dict) else type(data).__name__
        raise RuntimeError(f"expected 'launch' as the one root, found {found:.80}")
    return [action(each) for each in _children(data["launch"])]


def _children(given: Any) -> list[ElementTree.Element]:
    if not isinstance(given, list):
        raise TypeError(f"expected a list of entities, found {type(given).__name__}")
    found = []
    for each in given:
        if not isinstance(each, dict) or len(each) != 1:
            raise RuntimeError(f"expected one entity in each entry, found {each!r:.80}")
        found += [_element(str(name), value) for name, value in each.items()]
    return found


def _element(name: str, given: Any) -> ElementTree.Element:
    made = ElementTree.Element(name)
    if isinstance(given, list):
        made.extend(_children(given))
    elif isinstance(given, dict):
        for key, value in given.items():
            _put(made, str(key), value)
    elif given is not None:
        raise TypeError(f"expected what '{name}' has, found {given!r:.80}")
    return made


def _put(made: ElementTree.Element, name: str, value: Any) -> None:
    """An attribute; or children, where a list of them is given."""
    if name == "children":
        made.extend(_children(value))
    elif isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
        made.extend([_element(name, each) for each in value])
    else:
        made.set(name, value if isinstance(value, str) else json.dumps(value))
