"""`open_submission`: what was handed in, and what of it to start.

A single file is found without running anything. What a package has to start, its set-up and launch
files say, so they are evaluated first, by one look in a process of the submission's
(`static.inspect`).
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.run.budget import Budget
from grader.submission import opening
from grader.submission.folder import USUAL_NAME
from grader.submission.opening import Seen, Submission
from grader.submission.set_ups import SETUP_FILES, Inspected, LaunchFile, Node, SetUp

if TYPE_CHECKING:
    from grader.scenes.package import inspection, trace

#: What ROS takes as a name, in the arguments of a program.
_NAME: Final = re.compile(r"[A-Za-z_~/{}][\w~/{}.]*")


@contextmanager
def open_submission(
    path: Path,
    executable: str | None = None,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
    is_whole: bool = False,
    cpu_s: float = math.inf,
) -> Iterator[Submission]:
    """Find what to start, in a copy that is there until the context ends.

    `executable` chooses among the console scripts or Python files of a folder or zip; a single
    .py file leaves no choice. Without it, `usual` is taken where there are several. Where nothing
    is started (`is_started`), all of it is taken, which must be a folder or an archive with a
    package; `executable` then chooses among packages.

    Args:
        is_whole: whether the package around what is started is looked at as well, which is done
            by the same look.
        cpu_s: the processor time that it may take [s].

    Raises:
        SubmissionError: there is nothing to start, no way to tell what, or too much to be read.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: something is wrong with the machine.
        GraderFailure: it could not be read or inspected, for a reason of ours.
    """

    def inspect(submission: Submission, folders: Sequence[str], program: str) -> Seen:
        from grader.run import static  # here: most submissions are a file

        budget = Budget(cpu_s)
        said, remarks = static.inspect(submission, folders, program, budget, is_whole=is_whole)
        told = {each.folder: each for each in said.set_ups}
        set_ups = [_set_up(each, told.get(each)) for each in folders]
        launches = [_launch_file(said, each) for each in said.trace.launches]
        whole = said.trace if is_whole and said.trace.setup is not None else None
        inspected = Inspected(set_ups, launches)
        return Seen(inspected, remarks, budget.spent_s, said.package, whole)

    with opening.opened(
        path, executable, inspect, is_started=is_started, usual=usual
    ) as submission:
        yield submission


def _set_up(folder: str, said: inspection.SetUp | None) -> SetUp:
    from grader.scenes.package.said import how_it_ends

    if said is None:
        return SetUp(folder)
    told, problem = said.told, ""
    if said.problem is not None:
        file = said.problem.file if said.problem.file in SETUP_FILES else "setup.py"
        problem = how_it_ends(file, said.problem)
    return SetUp(
        folder,
        problem=problem,
        name=told.name,
        scripts=told.scripts,
        data_files=[(each.folder, name) for each in told.data_files for name in each.files],
        packages=told.packages,
        package_folders=told.package_folders,
        scripts_folder=told.scripts_folder,
        has_commands=told.has_commands,
    )


def _launch_file(of: inspection.Inspection, launch: trace.Launch) -> LaunchFile:
    from grader.scenes.package.said import said

    if launch.problem is not None:
        return LaunchFile(of.package, launch.file, unread=said(launch.problem))
    words = [_words(node) for node in launch.nodes]
    is_plain = launch.file in of.plain and not any(node.condition for node in launch.nodes)
    return LaunchFile(
        of.package,
        launch.file,
        tuple(
            Node(node.package, node.executable, ("",) if given is None else given)
            for node, given in zip(launch.nodes, words, strict=True)
        ),
        is_plain=is_plain and None not in words and not launch.skipped,
    )


def _words(node: trace.Node) -> tuple[str, ...] | None:
    """What `ros2 launch` gives a program; None where that is not known by what was taken down."""
    name, space = node.name, node.namespace
    space = space if space.startswith("/") or not space else f"/{space}"
    rules = [f"{old}:={new}" for old, new in (("__node", name), ("__ns", space)) if new]
    rules += node.remappings
    names = [part for rule in rules for part in rule.split(":=")]
    names += [each.name for each in node.parameters]
    is_known = all(map(_NAME.fullmatch, names)) and all(e.text < 0 for e in node.parameters)
    if not is_known or any("\0" in word for word in node.arguments):
        return None
    words = [word for rule in rules for word in ("-r", rule)]
    for each in node.parameters:
        words += ["-p", f"{each.name}:={_yaml(each.value)}"]
    return (*node.arguments, *(["--ros-args", *words] if words else []))


def _yaml(value: str) -> str:
    """A value as it was written in JSON, or else a text."""
    try:
        json.loads(value)
    except ValueError:
        return json.dumps(value)
    return value
