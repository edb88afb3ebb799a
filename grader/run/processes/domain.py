"""A ROS domain of one's own, so that two runs on one machine never hear each other."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager

from grader import locks, scratch
from grader.errors import GraderFailure

#: Domain ids whose ports stay clear of the ephemeral ones, minus the low ones that people use.
DOMAINS = (*range(40, 102), *range(215, 233))


@contextmanager
def reserve_domain() -> Iterator[int]:
    """Hold a domain id that no other grader on this machine holds.

    The lock belongs to the open file, so that it vanishes with the process, however that ends.

    Raises:
        GraderFailure: all of them are taken.
    """
    folder = scratch.home()  # the empty lock files stay there for the next run
    for domain in random.sample(DOMAINS, len(DOMAINS)):
        with (folder / f"domain-{domain}.lock").open("w") as lock:
            if locks.take(lock):
                yield domain
                return
    raise GraderFailure(f"all {len(DOMAINS)} ROS domains are in use by other runs; try again later")
