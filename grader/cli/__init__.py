"""The command line `grader`: one file a verb, each an entry point of `grader.verbs`.

Exit codes: 0 judged, whatever the score (1 below --fail-under); 2 the call or the submission
cannot be used; 3 the grader itself failed; 130 interrupted by the caller.
"""

from __future__ import annotations

import atexit
import errno
import os
import sys
import threading
import traceback
from argparse import Namespace
from collections.abc import Sequence
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from grader.text.message import Text, msg

# numpy's worker threads would spin a while after its import, and have nothing to do here
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

try:  # Ctrl-C may come as early as this
    from grader.cli import options
    from grader.errors import CheckFailed, GraderError, GraderFailure, SubmissionError, UsageError
    from grader.system import extensions, requirements
    from grader.system import versions as system
    from grader.text.strings import for_terminal
    from grader.text.translations import tr, translate
except KeyboardInterrupt:
    print("grader: interrupted", file=sys.stderr)
    sys.exit(130)

if TYPE_CHECKING:
    from rich.console import Console

ELSEWHERE = msg(
    "submissions are run on Linux with /proc, which this is not. Take WSL 2, a devcontainer or "
    "Codespaces (docs/your-machine.md); grader check, view, report and new work here."
)
FAILED = msg("The grader failed; this is not the submission's fault:")
JUDGED, BELOW, UNUSABLE, GRADER_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
#: Errors of the machine, as a full disk or a closed folder: they need no traceback.
_OF_THE_MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EROFS)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb, and return the exit code."""
    for stream in (sys.stdout, sys.stderr):  # a terminal may lack the letters of a language
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        return _main(sys.argv[1:] if argv is None else argv)
    except KeyboardInterrupt:  # before a verb has started
        print(tr("{who}: interrupted", who="grader"), file=sys.stderr)
        return INTERRUPTED


def leave(code: int) -> NoReturn:
    """End this process as soon as all is done, and not when Python is taken apart."""
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):  # its reader is gone, or it was closed
            stream.flush()
    os._exit(code)


def load(verb: str) -> Any:
    """Import and return the module of a verb."""
    return extensions.load(extensions.VERBS, verb)


def _main(words: Sequence[str]) -> int:
    options.choose_language(words)  # for help and errors of the call, too
    asked = _asked(words)
    if asked and not system.runs_submissions() and getattr(load(asked), "NEEDS_LINUX", False):
        _print_error(_who(asked), ELSEWHERE)
        return UNUSABLE
    try:
        args = _parser(words).parse_args(words)
    except options.Misuse as error:
        text = tr("{prog}: error: {message}", prog=error.prog, message=error.message)
        print(f"{error.usage}{for_terminal(text)}", file=sys.stderr)
        return _ended(error, options.parse_partly(words))
    if system.runs_submissions():
        from grader.run.processes import started_process

        started_process.adopt_orphans()
        started_process.end_on_signals()
    try:
        options.prepare(args)
    except UsageError as error:
        _print_error(_who(args.verb), error.message)
        return error.exit_code
    try:
        _check_folder()
        return int(load(args.verb).main(args))
    except KeyboardInterrupt:
        print(tr("{who}: interrupted", who=f"grader {args.verb}"), file=sys.stderr)
        return _ended(UsageError(msg("interrupted")), args, INTERRUPTED)
    except GraderError as error:
        _print_error(_heading(error, args.verb), error.message)
        return _ended(error, args)
    except Exception as error:
        if isinstance(error, ImportError) and (missing := requirements.missing_ros()):
            _print_error(_who(args.verb), missing.message)
            return _ended(missing, args)
        what = "".join(traceback.format_exception_only(error)).strip()
        if isinstance(error, OSError) and error.errno in _OF_THE_MACHINE:
            _print_error(FAILED, what)
        else:
            _print_error(
                msg("The grader failed; this is not the submission's fault. Please report:")
            )
            print(for_terminal(traceback.format_exc()), end="", file=sys.stderr)
        return _ended(GraderFailure("unexpected: {what}", what=what), args)


def _check_folder() -> None:
    try:
        Path.cwd()
    except FileNotFoundError:
        raise UsageError(
            msg("the current folder was deleted: change to one that is there, and call again")
        ) from None


def _heading(error: GraderError, verb: str) -> Text:
    if isinstance(error, SubmissionError):  # as the first line of a result
        return msg("Fix this first:")
    if isinstance(error, CheckFailed):
        return msg("The exercise failed; this is not the submission's fault:")
    return FAILED if isinstance(error, GraderFailure) else _who(verb)


def _who(verb: str) -> str:
    return tr("{who}:", who=f"grader {verb}")


def say(console: Console, what: Text, style: str = "") -> None:
    """Print a text, of whatever origin, that the terminal may wrap; nothing where it is empty."""
    from rich import text

    if what:
        console.print(text.Text(for_terminal(translate(what)), style), soft_wrap=True)


def _print_error(heading: Text, message: Text = "") -> None:
    from rich import text
    from rich.console import Console  # here: most calls print no error

    line = text.Text(translate(heading), "red")
    if message:
        line.append(f" {for_terminal(translate(message))}", "default")
    Console(stderr=True, soft_wrap=True, highlight=False).print(line)


def _asked(words: Sequence[str]) -> str:
    """Return the verb of a call; '' where there is none."""
    word = next((word for word in words if not word.startswith("-")), "")
    return word if extensions.is_there(extensions.VERBS, word) else ""


def _parser(words: Sequence[str]) -> options.Parser:
    """Return the parser of a call, with the arguments of its verb alone."""
    asked = _asked(words)
    parser = options.Parser(prog="grader", description=tr("Grade the turtlesim challenge."))
    known = _versions() if "--version" in words else ""
    shows = tr("show program's version number and exit")
    parser.add_argument("--version", action="version", version=known, help=shows)
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    listed = () if known else extensions.points(extensions.VERBS)
    for name in (asked,) if asked else listed:
        summary = translate(msg((load(name).__doc__ or "").partition("\n")[0]))
        verb = verbs.add_parser(name, help=summary, description=summary)
        if asked:
            load(name).add_arguments(verb)
            options.add_arguments(verb)
    return parser


def _versions() -> str:
    """Return the version of the grader, and those that belong into the report of a fault."""
    ros = f", ROS 2 {distro}" if (distro := system.ros_distro()) else ""
    on = f"Python {system.python_version()}, rclpy {system.rclpy_version()}{ros}"
    return f"grader {system.grader_version()} ({on})"


def _ended(error: GraderError, args: Namespace, exit_code: int | None = None) -> int:
    """Write the error as data, if that was asked for, and return the exit code."""
    try:
        if isinstance(error, options.Misuse):  # nothing is prepared yet
            options.prepare(args)
        options.write(error, args)
    except UsageError as unwritten:
        print(f"grader: {for_terminal(translate(unwritten.message))}", file=sys.stderr)
    return error.exit_code if exit_code is None else exit_code
