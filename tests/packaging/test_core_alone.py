"""The core needs no extension: without them its rooms work as with them.

A copy of the checkout lacks their folders, a copy of the environment their entry points.
"""

import os
import shutil
import tempfile

import pytest

from tests.programs import ran

from .conftest import ROOT, copy_environment

EXTENSIONS = ("grader_class", "grader_diagnosis", "grader_robots")
#: With EXAMPLES=1000, `make test-all`: the core's suite; else what is soon over.
IS_WHOLE = int(os.environ.get("EXAMPLES") or 0) >= 1000
SOON_OVER = (
    "tests/grader/cli/test_run.py::test_a_right_solution_gets_full_marks",
    "tests/grader/test_fixture_verdicts.py",
)
#: What is no part of a checkout, and what of it is no part of the core.
LEFT_OUT = shutil.ignore_patterns(
    *EXTENSIONS,
    *(".git", ".venv*", "build", "dist", "demo", "*.egg-info", "__pycache__"),
    *(".*_cache", ".hypothesis"),
)


@pytest.fixture
def environment(tmp_path):
    """This environment, but that nothing in it says that there are extensions."""
    place = copy_environment(tmp_path, *EXTENSIONS, "__pycache__")
    (points,) = place.glob("lib/python*/site-packages/turtlesim_py-*.dist-info/entry_points.txt")
    lines = points.read_text().splitlines(keepends=True)
    points.unlink()
    points.write_text(
        "".join(line for line in lines if not any(name in line for name in EXTENSIONS))
    )
    yield place
    shutil.rmtree(place)  # ten thousands of files, which pytest would keep


@pytest.mark.more("runs tests again, in a copy of the checkout")
@pytest.mark.timeout(7200)
def test_the_core_does_without_extensions(environment, tmp_path, shell):
    checkout = tmp_path / "checkout"
    shutil.copytree(ROOT, checkout, ignore=LEFT_OUT, symlinks=True)
    tests = ("tests/grader",) if IS_WHOLE else SOON_OVER
    words = ["-m", "pytest", "-q", "-ra", "-n", "2", "-m", "not more", *tests]
    for name in ("EXAMPLES", "PYTEST_DEBUG_TEMPROOT"):
        shell.pop(name, None)
    with tempfile.TemporaryDirectory(prefix="t") as place:  # short, as sockets have it
        done = ran(
            [environment / "bin/python", *words], cwd=checkout, env=shell | {"TMPDIR": place}
        )
    assert done.returncode == 0, done.stdout[-5000:] + done.stderr[-2000:]
