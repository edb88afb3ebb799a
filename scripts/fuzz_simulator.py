"""Fuzz a simulator's process with what no well-meant program sends, and check that it survives.

    python scripts/fuzz_simulator.py ros|link|cast [--seconds N] [--seed N]

`ros`: every service, topic and part of an action of a `turtlesim_node`, over DDS, with values that
are random, huge, or none. `link`: a graded simulator in virtual time, whose student's side sends
mutated packets and mutated CDR. `cast`: the same beside scripted peers, with readers and writers
that it makes up. `sends_broken_packets` (tests/attacks) fuzzes the layer below DDS.

It prints counts, and ends with 1 if a process has died or does not answer any more.
"""

from __future__ import annotations

import argparse
import importlib
import itertools
import json
import os
import random
import select
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from turtlesim_py.world.floats import float32  # noqa: E402

FLOATS = (0.0, -0.0, 1.0, 5e-324, 1e-38, 1e38, 1e308, -1e308, float("inf"), -float("inf"))
TEXTS = ("", "turtle1", "t2", "a/b", "/", "~", "\0", "\x1b[31m", "ü" * 9, "[/b]", "use_sim_time")
LENGTHS = (0, 1, 255, 256, 300, 300, 3_000, 3_000, 30_000)
_ADD, _COUNT = "example_interfaces/srv/AddTwoInts", "example_interfaces/action/Fibonacci"
CAST: dict[str, Any] = {
    "peer": {
        "publishers": {"data": {"type": "std_msgs/msg/Float64", "rate": 10, "message": "=n * 1.0"}},
        "subscriptions": {"out": {"type": "std_msgs/msg/Float64"}},
        "services": {
            "divide": {"type": _ADD, "response": {"sum": "=a // b"}},
            "slow": {"type": _ADD, "response": {"sum": "=a * b"}, "delay": 0.1},
        },
        "calls": {str(n): {"service": "add", "type": _ADD, "at": n} for n in range(9)},
        "goals": {
            str(n): {"action": "count", "type": _COUNT, "at": n, "cancel_after": n}
            for n in range(9)
        },
        "actions": {
            "fibonacci": {"type": _COUNT, "accepts": "=1 / order", "feedback": [[0]], "result": [0]}
        },
        "parameters": {
            **{f"get {n}": {"node": "fuzz", "at": n, "get": ["p", "q"]} for n in range(9)},
            **{f"set {n}": {"node": "fuzz", "at": n, "set": {"p": 5}} for n in range(9)},
        },
        "frames": {"still": {"parent": "world", "child": "peer", "rate": 5}},
    },
}
#: What a program may have beside it, and what no program has.
CHANNELS = (
    *(f"topic /{name}" for name in ("out", "data", "big", "tf", "rosout", "cast/events")),
    *("request /add", "request /divide", "response /add", "topic /count/_action/feedback"),
    *(f"request /count/_action/{part}" for part in ("send_goal", "get_result", "cancel_goal")),
    *("request /fuzz/get_parameters", "request /fuzz/set_parameters"),
)
TYPES = (
    *("std_msgs/msg/Float64", "std_msgs/msg/String", "tf2_msgs/msg/TFMessage", _ADD, _COUNT),
    *(f"{_COUNT}_{part}" for part in ("SendGoal", "GetResult", "FeedbackMessage")),
    *("action_msgs/srv/CancelGoal", "rcl_interfaces/srv/GetParameters", "rcl_interfaces/msg/Log"),
    *("rcl_interfaces/srv/SetParameters", "no_such/msg/Type", "antigravity/msg/Foo", "os/path/Foo"),
)
#: A right type of some of these.
_RIGHT = {
    **{"topic /out": "std_msgs/msg/Float64", "request /add": _ADD},
    "topic /count/_action/feedback": f"{_COUNT}_FeedbackMessage",
    "request /count/_action/send_goal": f"{_COUNT}_SendGoal",
    "request /count/_action/get_result": f"{_COUNT}_GetResult",
    "request /count/_action/cancel_goal": "action_msgs/srv/CancelGoal",
    "request /fuzz/get_parameters": "rcl_interfaces/srv/GetParameters",
    "request /fuzz/set_parameters": "rcl_interfaces/srv/SetParameters",
}
NAMES = ("background_r", "holonomic", "image_rate", "canvas_folder", "use_sim_time", "interfaces")


def scalar(kind: str, chance: random.Random) -> Any:
    """Return a value of a basic type; mostly one that is likely to break something."""
    if kind in ("float", "double"):
        number = chance.choice((*FLOATS, float("nan"), chance.uniform(-12, 12)))
        return number if kind == "double" else float32(number)
    if kind == "boolean":
        return chance.random() < 0.5
    if kind == "string":
        return chance.choice((*TEXTS, *NAMES, "x" * chance.choice(LENGTHS)))
    if kind == "octet":
        return bytes([chance.randrange(256)])
    bits = int("".join(filter(str.isdigit, kind)))
    low, high = (0, 2**bits - 1) if kind[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return chance.choice((low, high, max(low, -1), 0, 1, 10, chance.randint(low, high)))


def filled(message: Any, chance: random.Random) -> Any:
    """Return a message of this class with a value in each of its fields."""
    made = message()
    for name, kind in message.get_fields_and_field_types().items():
        setattr(made, name, _value(kind, chance))
    return made


def _value(kind: str, chance: random.Random) -> Any:
    element, _, rest = kind.removeprefix("sequence<").partition("<")[0].partition("[")
    if kind.startswith("sequence<"):
        element = kind.removeprefix("sequence<").rstrip(">").partition(",")[0]
        length = chance.choice((0, 1, 2, 50))
        return [_value(element, chance) for _ in range(length)]
    if rest:
        return [_value(element, chance) for _ in range(int(rest.rstrip("]")))]
    if "/" in kind:
        return filled(_class(kind), chance)
    return scalar(kind, chance)


def mutated(data: bytes, chance: random.Random) -> bytes:
    """Change some bytes; also lengths, which are little-endian in 32 bits."""
    changed = bytearray(data)
    for _ in range(chance.choice((0, 1, 1, 2, 8))):
        if not changed:
            break
        at = chance.randrange(len(changed))
        match chance.randrange(5):
            case 0:
                changed[at] = chance.randrange(256)
            case 1:
                number = chance.choice(
                    (0, 1, 0x7FFFFFFF, 0xFFFFFFFF, 0x10000, chance.getrandbits(32))
                )
                changed[at // 4 * 4 : at // 4 * 4 + 4] = struct.pack("<I", number)
            case 2:
                del changed[at:]
            case 3:
                changed[at:at] = chance.randbytes(chance.randrange(1, 40))
            case 4:
                changed[at : at + 3] = b"\xff\xfe\xc0"
    return bytes(changed)


def _class(kind: str) -> Any:
    """Return the class of a ROS type, with its folder or without ("geometry_msgs/Vector3").

    It may be a part of an action, as "turtlesim/action/RotateAbsolute_SendGoal".
    """
    package, *folder, name = kind.split("/")
    action, _, part = name.partition("_")
    if not part:
        return getattr(importlib.import_module(".".join([package, *(folder or ["msg"])])), name)
    whole = getattr(importlib.import_module(f"{package}.action"), action)
    impl = whole.Impl
    return (
        getattr(impl, f"{part}Service", None) or getattr(impl, part, None) or getattr(whole, part)
    )


# Over DDS ---------------------------------------------------------------------------------------


class Caller:
    """A node that finds the topics and services of a simulator, and calls them."""

    def __init__(self, chance: random.Random) -> None:
        import rclpy

        rclpy.init(args=[])
        self.counts: Counter[str] = Counter()
        self._rclpy, self._chance = rclpy, chance
        self._node = rclpy.create_node("fuzzer")
        self._clients: dict[str, Any] = {}
        self._publishers: dict[str, Any] = {}

    def close(self) -> None:
        """Leave the graph."""
        self._rclpy.shutdown()

    def find(self) -> int:
        """Make clients and publishers for what is served now; return the number of clients."""
        with suppress(Exception):  # it is not there yet
            for topic, (kind, *_) in self._node.get_subscriber_names_and_types_by_node(
                "turtlesim", "/"
            ):
                if topic not in self._publishers and len(self._publishers) < 50:
                    made = self._node.create_publisher(_class(kind), topic, 10)
                    self._publishers[topic] = made
            for service, (kind, *_) in self._node.get_service_names_and_types_by_node(
                "turtlesim", "/"
            ):
                if service not in self._clients and len(self._clients) < 200:
                    self._clients[service] = self._node.create_client(_class(kind), service)
        return len(self._clients)

    def send(self) -> None:
        """Send one message or request to each."""
        for topic, publisher in self._publishers.items():
            publisher.publish(filled(publisher.msg_type, self._chance))
            self.counts[_plain(topic)] += 1
        for name, client in self._clients.items():
            if "describe_parameters" in name or client.service_is_ready():
                future = client.call_async(filled(client.srv_type.Request, self._chance))
                future.add_done_callback(lambda _: self.counts.update(["answers"]))
                self.counts[_plain(name)] += 1
        for _ in range(20):
            self._rclpy.spin_once(self._node, timeout_sec=0.001)

    def is_answered(self) -> bool:
        """Whether a harmless question is answered."""
        from rcl_interfaces.srv import ListParameters

        client = self._node.create_client(ListParameters, "/turtlesim/list_parameters")
        until = time.monotonic() + 20.0
        while time.monotonic() < until:
            future = client.call_async(ListParameters.Request())
            self._rclpy.spin_until_future_complete(self._node, future, timeout_sec=2.0)
            if future.done():
                return True
        return False


def _plain(name: str) -> str:
    return "/".join(name.split("/")[2:]) if name.count("/") > 1 else name


def fuzz_ros(seconds: float, chance: random.Random) -> tuple[Counter[str], str]:
    """Call everything of a `turtlesim_node`; return the counts, and what went wrong."""
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "turtlesim_py.ros.node"]
    with (
        tempfile.TemporaryDirectory() as folder,
        (Path(folder) / "log").open("wb") as log,
        subprocess.Popen(command, cwd=folder, env=env, stdout=log, stderr=log) as process,
    ):
        caller = Caller(chance)
        try:
            until = time.monotonic() + 30
            while not caller.find() and time.monotonic() < until:
                time.sleep(0.1)
            until = time.monotonic() + seconds
            while time.monotonic() < until and process.poll() is None:
                caller.find()
                caller.send()
            alive = process.poll() is None and caller.is_answered()
        finally:
            caller.close()
            process.kill()
        said = (Path(folder) / "log").read_text(errors="replace")
    for line in said.splitlines():
        if "Cannot serve [" in line:
            caller.counts[line[line.index("Cannot") :][:150]] += 1
    return caller.counts, "" if alive else f"it died or does not answer: {said[-2000:]}"


# On the link ------------------------------------------------------------------------------------


def fuzz_link(
    seconds: float, chance: random.Random, cast: dict[str, Any] | None = None
) -> tuple[Counter[str], str]:
    """Be the student's side of many runs; return the counts, and what went wrong.

    Args:
        cast: scripted peers that are there.
    """
    counts: Counter[str] = Counter()
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        counts["runs"] += 1
        if wrong := _run_on_link(chance, counts, until, cast):
            return counts, wrong
    return counts, ""


def _run_on_link(
    chance: random.Random, counts: Counter[str], until: float, cast: dict[str, Any] | None
) -> str:
    from grader.message import Message
    from grader.run.handover import Plan
    from grader.run.limits import Patience
    from grader.run.observe import account
    from grader.scenes.scene import Limits

    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    control, controlled = socket.socketpair()
    recording = os.memfd_create("recording")
    page = account.make()
    plan = Plan(Limits(3, 1, 30))
    if cast is not None:
        plan = replace(plan, scene="graph", cast=cast, hears=("/big", "/tf"))
    fds = (controlled.fileno(), theirs.fileno(), recording, page)
    words = [
        *(str(controlled.fileno()), f"/proc/self/fd/{recording}"),
        *(plan.to_json(), str(theirs.fileno()), str(page)),
        *(json.dumps([(os.getpid(), "talker-1", None, 0)]), "-1"),
        json.dumps(asdict(Patience(simulator_cpu_s=20.0, all_asleep_s=2.0, asleep_s=1.0))),
        "",  # no live feed
    ]
    # a pipe that nobody reads would stop it
    log = tempfile.TemporaryFile()  # noqa: SIM115 - the contexts of both are below
    place = tempfile.TemporaryDirectory()  # it is asked to save its canvas, too
    process = subprocess.Popen(
        [sys.executable, "-m", "grader.run.simulator.virtual_main", *words],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=place.name,
        pass_fds=fds,
        stdout=subprocess.DEVNULL,
        stderr=log,
    )
    with log, place, process, ours, control:
        theirs.close()
        controlled.close()
        os.close(recording)
        with suppress(OSError):
            _converse(ours, page, chance, counts, until, has_cast=cast is not None)
        os.close(page)
        ours.close()
        output = b""
        with suppress(OSError):
            control.settimeout(60)
            while chunk := control.recv(65536):
                output += chunk
        code = process.wait()
        log.seek(0)
        complaint = log.read()[-3000:]
    if code != 0 or not output:
        return f"it ended with {code}, sent {output!r}; {complaint.decode(errors='replace')}"
    message = json.loads(output.splitlines()[-1])
    reason = str(Message.parse(message.get("reason", "")))
    silences = [each["silence"] for each in message.get("programs", ())]
    counts[f"{message['say']}, {', '.join(silences) or reason}"] += 1
    flags = [str(Message.parse(flag)) for flag in message.get("flags", ())]
    counts.update(flag for flag in flags if "on request" not in flag)
    if "virtual time itself" in reason:
        return f"{message}; {complaint.decode(errors='replace')}"
    return ""


def _converse(
    link: socket.socket,
    page: int,
    chance: random.Random,
    counts: Counter[str],
    until: float,
    *,
    has_cast: bool,
) -> None:
    from grader.run.lockstep.protocol import (
        SHIFT,
        Advance,
        Mail,
        Parcel,
        Table,
        decode,
        encode,
        pieces,
    )

    data, fds, _, _ = socket.recv_fds(link, 200_000, 1)
    table = decode(data)
    assert isinstance(table, Table)
    requests = _readers(table)
    reading = [e._replace(node="/fuzz", writes=False) for e in table.added if e.type and e.writes]
    numbers, ours = itertools.count(1 << SHIFT), list[int]()
    is_rude = chance.random() < 0.5  # also invalid packets, which end the run
    with socket.socket(fileno=fds[0]) as mail:
        mail.setblocking(False)
        for turn in range(400):
            if time.monotonic() > until:
                break
            parcels = [
                Parcel(
                    *(number, chance.choice((0, 1, 2**32 - 1))),
                    chance.choice((0, 1, 2, 7, 2**64 - 1)),
                    *(0, mutated(_cdr(kind, chance), chance)),
                )
                for number, kind in requests
            ]
            counts["messages"] += len(parcels)
            packet = encode(Mail(parcels))
            if is_rude and chance.random() < 0.02:
                packet = mutated(packet, chance)
            for piece in pieces(packet):
                while not _is_sent(mail, piece):
                    link.send(encode(Advance(0, False, 0, 0, True)))
                    _drain(link)
            os.pwrite(page, chance.randbytes(8), 0)
            if chance.random() < 0.1:
                made = reading[: chance.randrange(len(reading))]
                made += _made_up(chance) if has_cast else []
                gone = chance.sample(ours, chance.randrange(len(ours) + 1))
                made = [each._replace(id=next(numbers)) for each in made]
                ours += [each.id for each in made]
                told = encode(Table(tuple(made), tuple(gone)))
                is_wrong = is_rude and chance.random() < 0.1
                link.send(mutated(told, chance) if is_wrong else told)
            reached = chance.choice((0, turn, 2**64 - 1))
            ask = encode(Advance(2**40, True, reached, chance.choice((0, 2**64 - 1)), True))
            is_wrong = is_rude and chance.random() < 0.01
            link.send(mutated(ask, chance) if is_wrong else ask)
            counts["packets"] += 2
            for reply in map(decode, _drain(link)):
                if isinstance(reply, Table):
                    counts["tables"] += 1
                    requests = [each for each in requests if each[0] not in reply.removed]
                    requests += _readers(reply)


def _is_sent(mail: socket.socket, piece: bytes) -> bool:
    try:
        mail.send(piece)
    except BlockingIOError:
        return False
    return True


def _readers(table: Any) -> list[tuple[int, Any]]:
    """Return the numbers of the readers in a table, and the classes of what they read."""
    found = []
    for entry in table.added:
        if entry.type and not entry.writes:
            kind = _class(entry.type)
            part = "Response" if entry.channel.startswith("response") else "Request"
            found.append((entry.id, getattr(kind, part, kind)))
    return found


def _made_up(chance: random.Random) -> list[Any]:
    """Return endpoints of a program that is not there."""
    from grader.run.lockstep.protocol import EndpointInfo

    made = []
    for channel in chance.sample(CHANNELS, chance.randrange(len(CHANNELS))):
        kind = chance.choice((_RIGHT.get(channel, TYPES[0]), chance.choice(TYPES)))
        node = chance.choice(("/fuzz", "/peer", "/", f"/n{chance.randrange(10**6)}"))
        policies = (chance.randrange(5) for _ in range(2))
        depth = chance.choice((0, 1, 2, 3, 2**32 - 1))
        made.append(EndpointInfo(node, channel, kind, chance.random() < 0.7, *policies, depth))
    return made


def _cdr(kind: Any, chance: random.Random) -> bytes:
    from rclpy.serialization import serialize_message

    try:
        return bytes(serialize_message(filled(kind, chance)))
    except Exception:  # a text that no message can have
        return bytes(serialize_message(kind()))


def _drain(link: socket.socket) -> list[bytes]:
    """Return what is there, without parts of packets; wait a little for the first of it."""
    found, patience_s = [], 0.5
    while select.select([link], [], [], patience_s)[0]:
        data = link.recv(200_000)
        if not data:
            raise ConnectionError
        found += [data] if data[:1] in (b"T", b"R") else []
        patience_s = 0.0
    return found


FUZZERS = {"ros": fuzz_ros, "link": fuzz_link, "cast": partial(fuzz_link, cast=CAST)}


def main(argv: Sequence[str]) -> int:
    """Fuzz for a while; 1 if something went wrong."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("where", choices=FUZZERS)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args(argv)
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    counts, wrong = FUZZERS[args.where](args.seconds, random.Random(args.seed))
    for what, count in sorted(counts.items()):
        print(f"{count:9}  {what}")
    print(wrong or "it lives")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
