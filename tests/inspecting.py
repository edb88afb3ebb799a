"""Packages, inspected by one process for all tests, which nothing confines."""

import json
import subprocess
import sys
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest.mock import patch

from grader.submission.answer import Inspection, decode
from grader.submission.examining import steps
from grader.submission.examining.main import inspect
from grader.submission.package_trace import encode
from tests import apart, once


def inspected(
    root: Path,
    cpu_s: float = steps.LIMITS.cpu_s,
    wall_s: float = steps.LIMITS.wall_s,
    **order: object,
) -> Inspection:
    """The answer to an order for an inspection; see `grader.submission.examining.main.inspect`.

    Args:
        cpu_s, wall_s: so much time may a step take.
    """
    process = _looking()
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(json.dumps([str(root), cpu_s, wall_s, order]).encode() + b"\n")
        process.stdin.flush()
        size = int.from_bytes(process.stdout.read(8), "big")
        assert size, "what looks at packages has died"
        return decode(process.stdout.read(size))
    except BaseException:  # a test's time is over: nobody else gets its answer
        process.kill()
        _looking.cache_clear()
        raise


@cache
def _looking() -> subprocess.Popen[bytes]:
    """A process for one package after the other, small and without threads.

    Each step is made by a copy, which the tests' own process has too much memory for, and threads
    whose locks it would wait for.
    """
    words = [sys.executable, "-c", f"from {__name__} import look_without_end as main; main()"]
    process = subprocess.Popen(words, cwd=once.ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    apart.at_the_end(process.communicate)
    return process


def look_without_end() -> None:
    """Look at each package that is named on standard input."""
    import setuptools  # noqa: F401  once, and not by each copy that runs a setup.py

    for line in sys.stdin:
        root, cpu_s, wall_s, order = json.loads(line)
        limits = replace(steps.LIMITS, cpu_s=cpu_s, wall_s=wall_s)
        with patch.object(steps, "LIMITS", limits), tempfile.TemporaryDirectory() as scratch:
            told = encode(inspect(Path(root), Path(scratch).resolve(), **order))
        sys.stdout.buffer.write(len(told).to_bytes(8, "big") + told)
        sys.stdout.buffer.flush()
