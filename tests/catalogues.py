"""`scripts/catalogues.py`: which sentences there are, and the catalogues as they lie there."""

from __future__ import annotations

import importlib.util
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]


@cache
def script() -> Any:
    """The script as a module."""
    path = ROOT / "scripts" / "catalogues.py"
    spec = importlib.util.spec_from_file_location("catalogues", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def sentences() -> frozenset[str]:
    """The keys of all sentences in the code, of a plural that for one."""
    found = (*script().of_grader(), *script().of_simulator())
    return frozenset(each if isinstance(each, str) else each[0] for each in found)
