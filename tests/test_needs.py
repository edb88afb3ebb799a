"""What is missing is left out and told at the end; in CI it is a failure."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.needs import needs
from tests.programs import ROOT

TESTS = """
from tests.needs import needs

@needs("git", "pdftotext")
def test_one(): pass

@needs("git")
def test_two(): pass

def test_three(): pass
"""


def called(folder, **env):
    """Those tests, by two workers, on a machine without a program."""
    (folder / "test_it.py").write_text(TESTS)
    words = ["-p", "tests.needs", "-p", "xdist", "-p", "no:cacheprovider", "-n", "2"]
    bare = {"PYTHONPATH": str(ROOT), "PATH": "/nowhere", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-c", os.devnull, *words, str(folder)],
        cwd=folder,
        env={**bare, **env},
        capture_output=True,
        text=True,
    )


def test_the_last_lines_tell_each_need_how_many_tests_and_the_command(tmp_path):
    done = called(tmp_path)
    *_, git, pdftotext, end = done.stdout.splitlines()
    assert done.returncode == 0, done.stdout
    assert git.startswith("git: 2 tests. To run them: ")
    assert git.endswith("apt-get install -qy git")
    assert pdftotext.startswith("pdftotext: 1 test. ")
    assert "1 passed, 2 skipped" in end


def test_where_ci_is_set_what_is_missing_fails(tmp_path):
    done = called(tmp_path, CI="true")
    assert done.returncode == 1
    assert "missing: git, pdftotext. Install it with: " in done.stdout
    assert "1 passed, 2 errors" in done.stdout.splitlines()[-1]


def test_a_need_that_the_table_has_not_is_a_mistake():
    with pytest.raises(AssertionError, match="pdftotxt"):
        needs("pdftotxt")
