"""What tests leave behind fails their session; one that leaves nothing is each session itself."""

import os
import re
import sys
from pathlib import Path

import pytest

from tests.programs import ROOT, ran

OWN = f"/dev/shm/left-{os.getpid()}"
LEAVING = {
    "process": "import os; os.posix_spawn('/bin/sleep', ['sleep', '9999'], os.environ)",
    "file": "import tempfile; tempfile.mkdtemp(prefix='left-')",
    "shared memory": f"open({OWN!r}, 'w').close()",
}


@pytest.mark.more("it tries the trial: what nobody changes with the product")
def test_what_a_test_leaves_behind_fails_the_session(tmp_path):
    tests = (f"def test_{number}():\n    {line}\n" for number, line in enumerate(LEAVING.values()))
    (tmp_path / "test_it.py").write_text("".join(tests))
    command = [sys.executable, "-m", "pytest", "-p", "xdist", "-p", "tests.apart", "-n", "1", "-q"]
    try:
        done = ran(
            [*command, "-c", "/dev/null", f"--basetemp={tmp_path / 'its'}", str(tmp_path)],
            cwd=ROOT,
            env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        )
    finally:
        Path(OWN).unlink(missing_ok=True)
    # others may leave shared memory meanwhile
    told = [line for line in done.stdout.splitlines() if "/dev/shm/" not in line or OWN in line]
    found = {each for each in LEAVING if any(map(re.compile(f"{each} .*").match, told))}
    assert (found, done.returncode) == ({*LEAVING}, 1), done.stdout + done.stderr
