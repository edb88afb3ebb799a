"""A ROS domain of one's own, so that two runs on one machine never hear each other."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager

from grader import scratch
from grader.errors import GraderFailure
from grader.language.phrase import say

#: Domain ids whose ports stay clear of the ephemeral ones, minus the low ones that people use.
DOMAINS = (*range(40, 102), *range(215, 233))


@contextmanager
def reserve_domain() -> Iterator[int]:
    """Hold a domain id that no other grader on this machine holds.

    The lock belongs to the open file, so that it vanishes with the process, however that ends.

    Raises:
        GraderFailure: all of them are taken, or there is no place for locks.
    """
    for domain in random.sample(DOMAINS, len(DOMAINS)):
        if lock := scratch.take_lock(f"domain-{domain}"):
            with lock:
                yield domain
            return
    raise GraderFailure(
        say(
            "all {domains} ROS domains are in use by other runs; try again later",
            domains=len(DOMAINS),
        )
    )
