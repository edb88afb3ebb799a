"""A piece of Python in a process that the kernel ends if it takes too much.

No test looks at a clock: what falls back into computing for minutes, or into taking gigabytes, is
killed, and the test fails by that.
"""

import sys
from pathlib import Path

from tests.programs import ran

ROOT = Path(__file__).parents[1]
_LIMITS = """
import resource, sys

def limit(cpu_s, memory_bytes):
    used = resource.getrusage(resource.RUSAGE_SELF)
    cpu_s += int(used.ru_utime + used.ru_stime)
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
"""


def printed_by(code: str, *words: object) -> str:
    """What a piece of Python prints, which can say `limit(seconds, bytes)`; it must not fail."""
    done = ran([sys.executable, "-c", _LIMITS + code, *map(str, words)], cwd=ROOT, errors="replace")
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stderr[-2000:]}"
    return done.stdout
