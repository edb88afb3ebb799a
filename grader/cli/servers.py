"""Start servers that outlive a call, so that verdicts come sooner; or stop them."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

from grader.errors import GraderFailure, UsageError
from grader.message import Message, msg
from grader.requirements import require_ros
from grader.servers import client, place
from grader.translations import tr, translate

#: After so long without a call they end, if nothing else is said [minutes].
IDLE_MIN = 30.0
MOST_MIN = 10_000
#: What runs as the server of calls.
SCRIPT = Path(__file__).with_name("serving.py")
EXPLAINED = msg(
    "`grader run` is then done by a fork of a process that has loaded all it needs. They do "
    "nothing where {setting}={off} is set."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = tr(EXPLAINED.key, setting=place.SETTING, off=place.OFF[0])
    parser.add_argument("what", choices=("start", "status", "stop"), help=tr("what to do"))
    parser.add_argument(
        "--idle",
        type=minutes,
        default=IDLE_MIN,
        metavar="MINUTES",
        help=tr("of start: after so long without a call they end ({default:g})", default=IDLE_MIN),
    )


def main(args: argparse.Namespace) -> int:
    """Start, stop or show them; 0 where there are some, or none are left after `stop`."""
    if args.what == "start":
        if place.is_off():
            raise UsageError(
                "{setting}={value} is set: no call would use them",
                setting=place.SETTING,
                value=os.environ[place.SETTING],
            )
        require_ros()
        _start(args.idle)
        print(tr("Servers run; `grader servers stop` ends them."))
        return 0
    try:
        known = client.asked(args.what)
    except OSError:  # nobody is there, or has just gone
        print(tr("No servers run."))
        return int(args.what == "status")
    except client.CallRefused as refused:
        raise UsageError(translate(refused.why)) from None
    if args.what == "stop":
        left = known["running"]
        after = tr("They end after the calls that go on: {running}.", running=left)
        print(after if left else tr("They have ended."))
        return 0
    print(_described(known))
    return 0


def minutes(text: str) -> float:
    """Parse the minutes of the command line."""
    with suppress(ValueError):
        if 0.0 < (value := float(text)) <= MOST_MIN:
            return value
    raise argparse.ArgumentTypeError(
        tr("expected minutes, more than 0 and up to {most}, found {text}", most=MOST_MIN, text=text)
    )


def _start(idle_min: float) -> None:
    """Start them, and wait until they are ready.

    Raises:
        UsageError: there are some already, or there can be none here.
        GraderFailure: they end before they are ready.
    """
    words = [sys.executable, "-P", str(SCRIPT), str(60.0 * idle_min)]
    process = subprocess.Popen(
        words,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdout is not None and process.stderr is not None
    line = process.stdout.readline()
    if not line:
        last = process.stderr.read().decode("utf-8", "replace")[-2000:]
        raise GraderFailure("the servers did not start:\n{last}", last=last)
    said: dict[str, Any] = json.loads(line)
    if "refused" in said:
        raise UsageError(Message.parse(said["refused"]))


def _described(known: dict[str, Any]) -> str:
    """Describe running servers."""
    lines = [
        tr(
            "Servers run, process {pid}, for {minutes:.0f} minutes. Calls so far: {calls}; going "
            "on: {running}.",
            pid=known["pid"],
            minutes=known["up_s"] / 60.0,
            calls=known["calls"],
            running=known["running"],
        ),
        tr(
            "Submissions are confined at the level {level}; after {idle:.0f} minutes without a "
            "call they end.",
            level=known["level"],
            idle=known["idle_s"] / 60.0,
        ),
    ]
    if changed := Message.parse(known["changed"]):
        lines.append(tr("The next call starts anew and they end: {why}", why=changed))
    return "\n".join(lines)
