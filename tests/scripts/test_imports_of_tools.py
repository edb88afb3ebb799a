"""Scripts and benchmarks, which hardly anything else runs, fit the code that they use."""

import sys
from pathlib import Path

import pytest

from tests.programs import ran

ROOT = Path(__file__).parents[2]
#: One prints when it is imported, one needs what `make mutate` installs.
LEFT_OUT = {"requirements", "mutate"}
#: pyperf comes with `make bench`.
IMPORT = """
import importlib, sys, types
sys.modules["pyperf"] = types.ModuleType("pyperf")
sys.path.insert(0, sys.argv[1])
for name in sys.argv[2:]:
    importlib.import_module(name)
"""


@pytest.mark.parametrize("folder", ["benchmarks", "scripts"])
def test_every_tool_finds_what_it_imports(folder):
    names = sorted({path.stem for path in (ROOT / folder).glob("*.py")} - LEFT_OUT)
    command = [sys.executable, "-c", IMPORT, str(ROOT / folder), *names]
    done = ran(command, cwd=ROOT)
    assert done.returncode == 0, done.stderr
