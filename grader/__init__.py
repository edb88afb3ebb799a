"""Run a submission, record what really happened, judge it, explain the verdict.

What is public stands in the stub of a package, `__init__.pyi`: here, and in the rooms that have
one. It is loaded at its first use: processes of a run import parts of these packages, and must not
wait for what only the grader's own process needs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any


def face(package: str, file: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package.

    Args:
        package: its `__name__`.
        file: its `__file__`.
    """

    @cache
    def modules() -> dict[str, str]:
        import ast  # here: most processes ask for nothing

        stub = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))
        imports = (node for node in stub.body if isinstance(node, ast.ImportFrom))
        names = {alias.name: node.module or "" for node in imports for alias in node.names}
        return {name: module for name, module in names.items() if module.startswith("grader")}

    def load(name: str) -> Any:
        if name == "__all__":
            return list(modules())
        if name.startswith("__"):
            raise AttributeError(name)
        try:  # a module of it, which needs no stub
            return import_module(f"{package}.{name}")
        except ModuleNotFoundError as error:
            if error.name != f"{package}.{name}":
                raise
        if name not in modules():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = import_module(modules()[name])
        if not hasattr(module, name):
            return import_module(f"{module.__name__}.{name}")
        return getattr(module, name)

    return load


__getattr__ = face(__name__, __file__)
