"""The options of every verb: `--lang`, and `--error-json FILE`, where an error is written as data.

The file exists only after an error: an old one is removed at the start of a call, and a new one is
written whole or not at all.
"""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Iterator, Sequence
from datetime import date
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from grader.errors import GraderError, UsageError
from grader.submission.request import LaunchAsked
from grader.system import files
from grader.system.extensions import DEFAULT_EXERCISE
from grader.text.message import msg
from grader.text.translations import LANGUAGES, of_environment, tr, use

if TYPE_CHECKING:
    from grader.exercise.result.visible import View

LANG = "--lang"
#: Of a --seed-file [characters].
SHORTEST_SECRET = 16
#: The sentences of argparse in Python 3.11 to 3.13; here so that they are in the catalogues.
ARGPARSE = (
    msg("usage: "),
    msg("positional arguments"),
    msg("options"),
    msg("show this help message and exit"),
    msg("show program's version number and exit"),
    msg("the following arguments are required: %s"),
    msg("argument %(argument_name)s: %(message)s"),
    msg("invalid choice: %(value)r (choose from %(choices)s)"),
    msg("invalid %(type)s value: %(value)r"),
    msg("unrecognized arguments: %s"),
    msg("ambiguous option: %(option)s could match %(matches)s"),
    msg("not allowed with argument %s"),
    msg("expected one argument"),
    msg("expected at least one argument"),
    msg("expected at most one argument"),
    msg("ignored explicit argument %r"),
    msg("expected %s argument", "expected %s arguments", n=1),
)

#: Those of `grader.run.processes.levels.LEVELS`, which takes long to import.
LEVELS = ("namespaces", "landlock", "limits")
#: The keys of `grader.grading.RUNNERS`, which takes long to import.
CLOCKS = ("real", "virtual")


class Misuse(UsageError):
    """The arguments of a call cannot be parsed."""

    def __init__(self, message: str, parser: argparse.ArgumentParser) -> None:
        super().__init__(message)
        self.usage = parser.format_usage()
        self.prog = parser.prog


class Parser(argparse.ArgumentParser):
    """A parser that raises its errors.

    Attributes:
        make_epilog: makes the text below the help, when the help is printed; None: nothing.
    """

    make_epilog: Callable[[], str] | None = None

    def format_help(self) -> str:
        self.epilog = self.make_epilog() if self.make_epilog else self.epilog
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        """Raise `Misuse`."""
        raise Misuse(message, self)


def choose_language(words: Sequence[str]) -> None:
    """Use the language that a call asks for; else that of the user's locale.

    It is searched before the call is parsed: errors of the call are in this language as well.
    """
    # by which it translates its sentences
    vars(argparse).update(_=tr, ngettext=lambda one, many, n: tr(one, many, n=n))
    for word, after in zip_longest(words, words[1:], fillvalue=""):
        name, _, value = word.partition("=")
        language = value or after
        is_meant = len(name) > 3 and LANG.startswith(name)  # argparse accepts '--la', too
        if is_meant and language in LANGUAGES:
            return use(language)
    return use(of_environment())


def add_arguments(parser: argparse.ArgumentParser) -> None:
    _add_error_file(parser)
    parser.add_argument(
        LANG,
        choices=tuple(LANGUAGES),
        help=tr(
            "the language of what people read (that of your locale: LANG); result files are the "
            "same in all"
        ),
    )


def _add_error_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--error-json",
        type=Path,
        metavar="FILE",
        help=tr("where to write what went wrong, if it does"),
    )


def add_view(parser: argparse.ArgumentParser, whole: str) -> None:
    """Declare the options for the reader of a result; `whole` is the help on a teacher's."""
    who = parser.add_mutually_exclusive_group()
    who.add_argument(
        "--after-due",
        action="store_true",
        help=tr("what students see when the exercise is over; default: what they see before"),
    )
    who.add_argument("--whole", action="store_true", help=whole)


def view_of(args: argparse.Namespace) -> View:
    """Return the reader of a result, by the options of `add_view`."""
    return "whole" if args.whole else "after_due" if args.after_due else "student"


def parse_partly(words: Sequence[str]) -> argparse.Namespace:
    """Parse --error-json and --exercise in a call that cannot be parsed; None where they are not.

    Any other word may be the name of an input file, so it counts as one.
    """
    parser = Parser(add_help=False)
    _add_error_file(parser)
    parser.add_argument("--exercise")
    try:
        args, others = parser.parse_known_args(words)
    except Misuse:
        return argparse.Namespace(error_json=None, exercise=None)
    args.result = [Path(word) for word in others]
    return args


def inputs(args: argparse.Namespace) -> Iterator[Path]:
    """Yield the files and folders that a call reads."""
    for name in (
        "submission",
        "recording",
        "compare",
        "result",
        "exercise",
        "mutants",
        "seed_file",
    ):
        given = getattr(args, name, None)
        for one in given if isinstance(given, list) else [given]:
            if one is not None:
                yield Path(one)


def secret_of(args: argparse.Namespace) -> str:
    """Return the secret that --seed-file holds; '' without one."""
    if args.seed_file is None:
        if args.seed_shown_from is not None:
            raise UsageError(msg("--seed-shown-from is for --seed-file"))
        return ""
    try:
        secret = str(args.seed_file.read_text(encoding="utf-8")).strip()
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(
            "cannot read {path}: {why}", path=str(args.seed_file), why=str(error)
        ) from None
    if len(secret) < SHORTEST_SECRET:
        raise UsageError(
            "{path}: expected {least} characters or more that nobody guesses, found {found}",
            path=str(args.seed_file),
            least=SHORTEST_SECRET,
            found=len(secret),
        )
    return secret


def hides_seed(args: argparse.Namespace) -> bool:
    """Whether results leave out the seed: it is a course's secret, and the day has not come."""
    shown_from: date | None = args.seed_shown_from
    is_shown = shown_from is not None and date.today() >= shown_from
    return args.seed_file is not None and not is_shown


def prepare(args: argparse.Namespace) -> None:
    """Remove an old file of --error-json."""
    if args.error_json is not None:
        from grader.exercise.result.json_file import ERROR_FAMILY

        files.check_writable(args.error_json, ERROR_FAMILY, inputs(args))
        files.withdraw(args.error_json)


def write(error: GraderError, args: argparse.Namespace) -> None:
    """Write an error to the file of --error-json, if there is one."""
    if args.error_json is not None:
        from grader.exercise.result.json_file import ErrorResult

        ErrorResult.of(error, _max_score(args)).write(args.error_json)


def _max_score(args: argparse.Namespace) -> float | None:
    name = getattr(args, "exercise", None) or getattr(args, "named", None)
    if name is None:
        return None
    from grader.exercise.loading import load_exercise

    try:
        return round(sum(load_exercise(name).points.values()), 2)
    except Exception:  # this may be the error that is written
        return None


def add_of_start(parser: argparse.ArgumentParser) -> None:
    """Declare what is started of a submission."""
    starts = parser.add_mutually_exclusive_group()
    starts.add_argument("--executable", metavar="NAME", help=tr("which console script to start"))
    starts.add_argument(
        "--launch",
        nargs="+",
        metavar=("FILE", "ARG:=VALUE"),
        help=tr("which launch file to start, with values of its arguments"),
    )


def launch_asked(words: Sequence[str] | None) -> LaunchAsked | None:
    """Parse FILE ARG:=VALUE ... of --launch."""
    if words is None:
        return None
    file, *given = words
    for each in given:
        if ":=" not in each:
            raise UsageError(
                "--launch: expected ARG:=VALUE behind {file}, found {found}; what is handed in "
                "comes before --launch",
                file=file,
                found=each,
            )
    return LaunchAsked(file, dict(each.split(":=", 1) for each in given))


def processes(text: str) -> int:
    """Parse a number of processes of the command line."""
    if not re.fullmatch(r"[1-9]\d{0,3}", text):
        raise argparse.ArgumentTypeError(
            tr("expected a number of processes, found {text}", text=text)
        )
    return int(text)


def add_of_runs(parser: argparse.ArgumentParser, clock: str, isolation: str) -> None:
    """Declare how submissions are run; the texts are the help on --time and --isolation."""
    parser.add_argument(
        "--exercise",
        metavar="NAME|FOLDER|FILE",
        help=tr(
            "an installed one, the folder of another, or an edited exercise.yaml; default: the one "
            "that the files of a starter name (one for a class), else the challenge"
        ),
    )
    parser.set_defaults(
        named=DEFAULT_EXERCISE
    )  # by what is handed in, where --exercise is left out
    parser.add_argument("--time", choices=CLOCKS, default="virtual", help=clock)
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument(
        "--seed",
        type=int,
        metavar="N",
        help=tr("where the varied runs start (the exercise's own)"),
    )
    seeds.add_argument(
        "--seed-file",
        type=Path,
        metavar="FILE",
        help=tr("a secret, from which each student gets a seed that no result shows"),
    )
    parser.add_argument(
        "--seed-shown-from",
        type=day,
        metavar="DATE",
        help=tr("of --seed-file: from this day on results show the seed (never)"),
    )
    parser.add_argument("--isolation", choices=LEVELS, metavar="LEVEL", help=isolation)


def points(text: str) -> float:
    """Parse a number of points of the command line."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(tr("expected a number of points, found {text}", text=text))
    return value


def day(text: str) -> date:
    """Parse a date of the command line."""
    try:
        return date.fromisoformat(text)
    except ValueError:
        found = tr("expected a date, e.g. 2026-12-31, found {text}", text=text)
        raise argparse.ArgumentTypeError(found) from None
