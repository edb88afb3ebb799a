"""What a zygote of either side imports beforehand: messages, and the libraries that they need."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable
from contextlib import suppress

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

KINDS = ("msg", "srv", "action")
#: What every node of rclpy's needs.
EVERY_NODE = ("rcl_interfaces", "type_description_interfaces")


def import_messages(packages: Iterable[str]) -> None:
    """Import what there is of these packages' interfaces, and load their type supports."""
    for package in (*EVERY_NODE, *packages):
        for kind in KINDS:
            with suppress(ImportError):
                _load(f"{package}.{kind}")
    _rclpy.rclpy_get_rmw_implementation_identifier()  # loads the middleware
    # rclpy's loggers ask for their caller, which looks up the file of every module, once
    inspect.getmodule(inspect.currentframe())


def _load(module: str) -> None:
    for value in list(vars(importlib.import_module(module)).values()):
        if isinstance(value, type) and hasattr(value, "__import_type_support__"):
            value.__import_type_support__()
