"""`--error-json FILE`, on every verb: what went wrong, as data.

That the file is there means an error: an old one is removed at the start of a call, and a new
one is written whole or not at all.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NoReturn

from grader import files
from grader.errors import GraderError, UsageError
from grader.language.telling import tell


class Misuse(UsageError):
    """The words of the call are not those of the command line."""

    def __init__(self, message: str, parser: argparse.ArgumentParser) -> None:
        super().__init__(message)
        self.usage = parser.format_usage()
        self.prog = parser.prog


class Parser(argparse.ArgumentParser):
    """A parser that raises what it has to say."""

    def error(self, message: str) -> NoReturn:
        """Raise `Misuse`."""
        raise Misuse(message, self)


def add_argument(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        "--error-json",
        type=Path,
        metavar="FILE",
        help=tell("where to write what went wrong, if it does"),
    )


def look_for(words: Sequence[str]) -> argparse.Namespace:
    """The option, and the exercise, in a call that cannot be parsed; None where they are not.

    Any other word may be meant as a file to read, so it counts as one.
    """
    parser = Parser(add_help=False)
    add_argument(parser)
    parser.add_argument("--exercise")
    try:
        args, others = parser.parse_known_args(words)
    except Misuse:
        return argparse.Namespace(error_json=None, exercise=None)
    args.result = [Path(word) for word in others]
    return args


def inputs(args: argparse.Namespace) -> Iterator[Path]:
    """The files and folders that a call reads."""
    for name in ("submission", "recording", "compare", "result", "exercise", "mutants"):
        given = getattr(args, name, None)
        for one in given if isinstance(given, list) else [given]:
            if one is not None:
                yield Path(one)


def prepare(args: argparse.Namespace) -> None:
    """Remove an old file.

    Raises:
        UsageError: no new one could be written, or what is there is something else.
    """
    if args.error_json is not None:
        from grader.result.error import FAMILY

        files.check_writable(args.error_json)
        files.check_replaceable(args.error_json, FAMILY, inputs(args))
        files.withdraw(args.error_json)


def write(error: GraderError, args: argparse.Namespace) -> None:
    """Write what went wrong, if it was asked for.

    Raises:
        UsageError: it cannot be written.
    """
    if args.error_json is not None:
        from grader.result.error import ErrorResult

        ErrorResult.of(error, _max_score(args)).write(args.error_json)


def _max_score(args: argparse.Namespace) -> float | None:
    name = getattr(args, "exercise", None)
    if name is None:
        return None
    from grader.exercise.loading import load_exercise

    try:
        return round(sum(load_exercise(name).points.values()), 2)
    except Exception:  # it may be this that is reported
        return None
