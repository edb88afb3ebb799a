"""A network for one run alone, so that no run on this machine ever hears another.

Best is a network namespace that holds nothing but a loopback device: root may make one, others
inside a user namespace, where the system allows that. Else the run reserves a ROS domain. In both
cases all goes by UDP over loopback: the shared memory of a process that is killed would stay.

Where the system is not Linux, the name also says what is less out of a submission's reach.
"""

from __future__ import annotations

import errno
import os
import select
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from grader import linux
from grader.errors import NotNow
from grader.language.phrase import say
from grader.run.processes import domain, hold
from grader.run.processes.refusal import TRIES, Refusal, insist

#: Fast DDS would use shared memory for discovery range LOCALHOST, whatever its settings say.
RANGE = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
#: How long who makes a namespace may take to come up [s].
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
    """What keeps a run to itself.

    Attributes:
        name: for the result: "private network", "ROS domain 87".
        env: environment variables of both processes.
        namespaces: what they have to enter: kind -> descriptor.
    """

    name: str
    env: Mapping[str, str]
    namespaces: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Namespaces:
    """Open namespaces: kind -> file descriptor. They live as long as these or their processes."""

    fds: dict[str, int] = field(default_factory=dict)

    def close(self) -> None:
        """Let them go."""
        for fd in self.fds.values():
            os.close(fd)


@contextmanager
def obtain_isolation(folder: Path) -> Iterator[Isolation]:
    """The best isolation that this system allows.

    Args:
        folder: a place for settings; it must stay as long as the context.

    Raises:
        GraderFailure: there is no private network, and all ROS domains are taken.
        NotNow: there may be a private network, but not now.
    """
    if namespaces := private_network():
        try:
            env = {**RANGE, "ROS_DOMAIN_ID": "0", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}
            name = "private network"
            yield Isolation(name, env, namespaces.fds)
        finally:
            namespaces.close()
        return
    profile = folder / "loopback.xml"
    profile.write_text(ONLY_LOOPBACK, encoding="utf-8")
    with domain.reserve_domain() as number:
        env = {
            **RANGE,
            "ROS_DOMAIN_ID": str(number),
            "FASTRTPS_DEFAULT_PROFILES_FILE": str(profile),
        }
        yield Isolation(f"ROS domain {number}", env)


#: Ways that this system has refused for good.
_refused: set[Callable[[], Namespaces]] = set()


def private_network() -> Namespaces | None:
    """A network namespace with a loopback device; None where there can be none.

    Raises:
        NotNow: what kept it from being made may pass; it was tried `refusal.TRIES` times.
    """
    found: list[Namespaces] = []
    last: Refusal | None = None
    for way in (_as_root, _as_user):
        if way in _refused:
            continue
        refusal = insist(partial(_attempt, way, found))
        if refusal is None:
            return found[0]
        if refusal.is_final:
            _refused.add(way)
        else:
            last = refusal
    if last is not None:
        raise NotNow(
            say(
                "no network of its own could be made for a run, in {times} tries: {why}",
                times=TRIES,
                why=last.why,
            )
        )
    return None


def _attempt(way: Callable[[], Namespaces], found: list[Namespaces]) -> Refusal | None:
    try:
        found.append(way())
    except (OSError, RuntimeError) as error:  # no more threads
        return Refusal.of(error)
    return None


def _as_root() -> Namespaces:
    found: list[int | OSError] = []

    def make() -> None:
        try:
            linux.unshare(linux.CLONE_NEWNET)
            linux.raise_loopback()
            found.append(os.open("/proc/thread-self/ns/net", os.O_RDONLY))
        except OSError as error:
            found.append(error)

    # A namespace belongs to a thread: this one moves out, and the rest of us stay where we are.
    thread = threading.Thread(target=make)
    thread.start()
    thread.join()
    if isinstance(found[0], OSError):
        raise found[0]
    return Namespaces({"net": found[0]})


def _as_user() -> Namespaces:
    # Only a process with a single thread may make a user namespace, so another one does.
    command = [sys.executable, "-I", "-S", hold.__file__]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as holder:
        answer = _first_line(holder)
        if answer != "ready":
            refusal = Refusal.from_line(answer.removeprefix(hold.REFUSED).strip())
            raise OSError(refusal.number, refusal.words, refusal.step)
        spaces = Namespaces()
        try:
            for kind in ("user", "net"):
                spaces.fds[kind] = os.open(f"/proc/{holder.pid}/ns/{kind}", os.O_RDONLY)
        except OSError:
            spaces.close()
            raise
    return spaces


def _first_line(holder: subprocess.Popen[bytes]) -> str:
    """What it says; what does not answer in time is ended.

    Raises:
        OSError: it has not answered.
    """
    assert holder.stdout is not None
    poll = select.poll()
    poll.register(holder.stdout, select.POLLIN)
    if not poll.poll(PATIENCE_S * 1000):
        holder.kill()
        raise TimeoutError(errno.ETIMEDOUT, os.strerror(errno.ETIMEDOUT), "hold")
    line = holder.stdout.readline().decode("utf-8", "replace").strip()
    if not line:
        raise ChildProcessError(errno.ECHILD, "it ended without a word", "hold")
    return line
