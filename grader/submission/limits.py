"""What the reading of one submission may take, and how a process gets no more."""

from __future__ import annotations

import resource
import signal
from typing import Final

from grader.submission.folder import MAX_BYTES

#: Address space [bytes]. A file of MAX_SOURCE_BYTES of ordinary Python takes some 150 MB.
MEMORY_BYTES: Final = 512_000_000
#: Of a processor [s]. An ordinary submission takes 0.1 s, a zip of MAX_BYTES two.
CPU_S: Final = 10
#: On the clock [s], for what waits instead of computing, or a machine that is too busy.
WALL_S: Final = 120


def take() -> None:
    """Limit this process, for good."""
    signal.alarm(WALL_S + 1)  # who has started us may be no more
    for kind, soft, hard in (
        (resource.RLIMIT_AS, MEMORY_BYTES, MEMORY_BYTES),
        (resource.RLIMIT_CPU, CPU_S, CPU_S + 1),
        (resource.RLIMIT_FSIZE, MAX_BYTES, MAX_BYTES),
        (resource.RLIMIT_CORE, 0, 0),
    ):
        _, ceiling = resource.getrlimit(kind)
        if ceiling != resource.RLIM_INFINITY:
            soft, hard = min(soft, ceiling), min(hard, ceiling)
        resource.setrlimit(kind, (soft, hard))
