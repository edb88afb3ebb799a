"""Isolates a run's network, so that no run on this machine ever receives from another.

Best is a network namespace with nothing but a loopback device: root may make one, others inside a
user namespace, where the system allows that. Else the run reserves a ROS domain. In both cases all
traffic is UDP over loopback: the shared memory of a process that is killed would stay.
"""

from __future__ import annotations

import os
import random
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from grader.errors import GraderFailure, NotNow
from grader.run.processes.refusal import TRIES, Refusal, insist
from grader.system import limited, linux, scratch

#: Fast DDS would use shared memory for discovery range LOCALHOST, whatever its settings say.
RANGE = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
#: Domain ids whose ports stay clear of the ephemeral ones, minus the low ones that people use.
DOMAINS = (*range(40, 102), *range(215, 233))
#: How long making a namespace may take [s].
PATIENCE_S = 20.0
#: Keeps the subnet out where there is no private network.
ONLY_LOOPBACK = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <transport_descriptors>
    <transport_descriptor>
      <transport_id>loopback</transport_id>
      <type>UDPv4</type>
      <interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
    </transport_descriptor>
  </transport_descriptors>
  <participant profile_name="run" is_default_profile="true">
    <rtps>
      <useBuiltinTransports>false</useBuiltinTransports>
      <userTransports><transport_id>loopback</transport_id></userTransports>
    </rtps>
  </participant>
</profiles>
"""


@dataclass(frozen=True)
class Isolation:
    """The isolation of a run's network.

    Attributes:
        name: for the result: "private network", "ROS domain 87".
        env: environment variables of both processes.
        namespaces: the namespaces that both have to enter: kind -> descriptor.
    """

    name: str
    env: Mapping[str, str]
    namespaces: Mapping[str, int] = field(default_factory=dict)


#: Open namespaces: kind -> descriptor. They live as long as these or their processes.
Namespaces = dict[str, int]


@contextmanager
def obtain_isolation(folder: Path) -> Iterator[Isolation]:
    """Isolate a run as well as this system allows.

    Args:
        folder: a place for settings; it must stay as long as the context.

    Raises:
        GraderFailure: there is no private network, and all ROS domains are taken.
        NotNow: there may be a private network, but not now.
    """
    if namespaces := private_network():
        with ExitStack() as held:
            for namespace in namespaces.values():
                held.callback(os.close, namespace)
            env = {**RANGE, "ROS_DOMAIN_ID": "0", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}
            yield Isolation("private network", env, namespaces)
        return
    profile = folder / "loopback.xml"
    profile.write_text(ONLY_LOOPBACK, encoding="utf-8")
    with reserve_domain() as number:
        env = {
            **RANGE,
            "ROS_DOMAIN_ID": str(number),
            "FASTRTPS_DEFAULT_PROFILES_FILE": str(profile),
        }
        yield Isolation(f"ROS domain {number}", env)


@contextmanager
def reserve_domain() -> Iterator[int]:
    """Hold a domain id that no other grader on this machine holds.

    The lock belongs to the open file, so that it vanishes with the process, however that ends.
    """
    with scratch.hold_one("domain", random.sample(DOMAINS, len(DOMAINS))) as domain:
        if domain is None:
            raise GraderFailure(
                "all {domains} ROS domains are in use by other runs; try again later",
                domains=len(DOMAINS),
            )
        yield domain


#: Ways that this system has refused for good.
_refused: set[Callable[[], Namespaces]] = set()


def private_network() -> Namespaces | None:
    """Make a network namespace with a loopback device; None where there can be none.

    Raises:
        NotNow: it failed `refusal.TRIES` times, for a reason that may pass.
    """
    last: Refusal | None = None
    for way in (_as_root, _as_user):
        if way in _refused:
            continue
        made = insist(partial(_attempt, way))
        if not isinstance(made, Refusal):
            return made
        if made.is_final:
            _refused.add(way)
        else:
            last = made
    if last is not None:
        raise NotNow(
            "no network of its own could be made for a run, in {times} tries: {why}",
            times=TRIES,
            why=last.why,
        )
    return None


def _attempt(way: Callable[[], Namespaces]) -> Namespaces | Refusal:
    try:
        return way()
    except (OSError, RuntimeError, limited.LimitHit) as error:  # no more threads, too slow
        return Refusal.of(error)


def _as_root() -> Namespaces:
    found: list[int | OSError] = []

    def make() -> None:
        try:
            linux.unshare(linux.CLONE_NEWNET)
            linux.raise_loopback()
            found.append(os.open("/proc/thread-self/ns/net", os.O_RDONLY))
        except OSError as error:
            found.append(error)

    # A namespace belongs to a thread: this one leaves, and the others stay.
    thread = threading.Thread(target=make)
    thread.start()
    thread.join()
    if isinstance(found[0], OSError):
        raise found[0]
    return {"net": found[0]}


def _as_user() -> Namespaces:
    # Only a process with a single thread may make a user namespace: a copy of this one has one.
    limits = limited.WorkLimits(wall_s=PATIENCE_S)
    with closing(limited.stream(_made_as_user, limits)) as holder:
        answer = next(holder).decode("utf-8", "replace")
        if not answer.isdecimal():
            refusal = Refusal.from_line(answer)
            raise OSError(refusal.number, str(refusal.words), refusal.step)
        spaces = Namespaces()
        with ExitStack() as opened:
            for kind in ("user", "net"):
                spaces[kind] = os.open(f"/proc/{answer}/ns/{kind}", os.O_RDONLY)
                opened.callback(os.close, spaces[kind])
            opened.pop_all()
    return spaces


def _made_as_user() -> Iterator[bytes]:
    """Make both in a copy of this process, yield its process id or why not, and keep them."""
    try:
        proc = os.open("/proc/self", os.O_PATH)
        linux.unshare_user(0, proc, linux.CLONE_NEWNET)
        linux.raise_loopback()
    except OSError as error:
        yield Refusal.of(error).to_line().encode("utf-8", "replace")
        return
    yield str(os.getpid()).encode()
    signal.pause()
