"""Replaces what all code stands on, in its process."""

import builtins
import os
import sys

for name in ("len", "isinstance", "print", "getattr", "range", "type"):
    setattr(builtins, name, lambda *_, **__: 100)
for module in ("json", "struct", "socket", "select", "os", "pickle", "threading"):
    sys.modules[module] = None
os.write = lambda *_: 0
os._exit = lambda *_: None
