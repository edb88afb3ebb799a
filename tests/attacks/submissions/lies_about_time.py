"""Replaces what tells time in its process: clocks, the link's own modules, rclpy's inside."""

import contextlib
import gc
import sys
import time
import types

import rclpy

rclpy.init()
node = rclpy.create_node("attacker")
for module in list(sys.modules.values()) + [
    m for m in gc.get_objects() if isinstance(m, types.ModuleType)
]:
    name = getattr(module, "__name__", "")
    if name.startswith(("grader", "rclpy.clock", "time")):
        for thing, value in list(vars(module).items()):
            if callable(value) and not thing.startswith("__"):
                with contextlib.suppress(Exception):
                    setattr(module, thing, lambda *_, **__: 10**18)
for thing in gc.get_objects():
    with contextlib.suppress(Exception):
        if type(thing).__module__.startswith("grader."):
            for attribute in ("tick", "now_ns", "_foreseen_to", "graph_epoch"):
                with contextlib.suppress(Exception):
                    setattr(thing, attribute, 1 << 60)
print(time.time())
rclpy.spin_once(node, timeout_sec=0.5)
