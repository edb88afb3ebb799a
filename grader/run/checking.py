"""Runs the check code of an added exercise in one confined process, which answers in lines.

Its author is a stranger: it is confined as a submission is, and may make no socket. It sees our
packages besides, and the folder that it is shown, and may write into neither. What it answers is
bytes, which are bounded here and decoded strictly where they are read.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from grader.errors import UsageError
from grader.limited import WorkLimits
from grader.message import NOTHING, Message, msg
from grader.run import handover, run_context
from grader.run.environment import virtual_environment
from grader.run.limits import CpuBudget
from grader.run.processes import levels
from grader.run.sandbox import view
from grader.run.sandbox.confinement import LANDLOCK
from grader.submission.start import Submission, Whole


def answered(
    program: Path, order: Mapping[str, Any], shown: Path, limits: WorkLimits
) -> tuple[bytes, Message]:
    """Run a program of ours that runs a stranger's code.

    Args:
        order: its argument; the descriptor of the file for its answers is added as `leaves`.
        shown: the folder that it sees besides, readable for all.

    Returns:
        Its answers, and why there are no more of them; NOTHING where it came to its end.

    Raises:
        UsageError: nothing can confine it here.
        GraderFailure: it could not be started.
    """
    with run_context.open_context(CpuBudget(limits.cpu_s)) as context:
        if not context.level.is_at_least(LANDLOCK):
            raise UsageError(
                "the checks of an added exercise run confined alone, and nothing can confine them "
                "here. To get it: {advice}. Or look at its files, and give a copy of their folder: "
                "--exercise FOLDER",
                advice=levels.ADVICE[LANDLOCK],
            )
        empty = context.folder / "empty"
        empty.mkdir()
        words = [sys.executable, str(program)]
        order = {**order, "leaves": context.recording}
        _, process = context.start(
            Submission("", empty, Whole(), NOTHING),
            lambda _: [*words, json.dumps(order)],
            (context.recording,),
            virtual_environment({}),
            more=(shown, *map(Path, sorted(view.system_view().hidden))),
            has_sockets=False,
        )
        with process.ended_at_exit(gently=False):
            code = process.wait(limits.wall_s)
            is_too_much = process.ends_for_excess()
        try:
            data = handover.read_bounded(context.recording, limits.answer_bytes)
        except ValueError:
            size = f"{limits.answer_bytes / 2**20:.0f} MB"
            return b"", msg("answered with more than {size}", size=size)
    if is_too_much:
        return data, msg("used more processor time, memory, processes or output than it may")
    if code is None:
        return data, msg("did not come to an end in {wall_s:g} s", wall_s=limits.wall_s)
    if code < 0:
        signal = str(-code)
        return data, msg("ended the process that it ran in (signal {signal})", signal=signal)
    if code:
        return data, msg("ended the process that it ran in (exit code {code})", code=str(code))
    return data, NOTHING
